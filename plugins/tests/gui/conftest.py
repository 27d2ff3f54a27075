"""A real FreeCAD window on a virtual screen, and a hand that clicks in it."""

import json
import os
import shutil
import subprocess
import time

import pytest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
SCREEN = (1600, 1000)

CONFIG = """<?xml version="1.0" encoding="UTF-8" standalone="no" ?>
<FCParameters><FCParamGroup Name="Root"><FCParamGroup Name="BaseApp"><FCParamGroup Name="Preferences">
<FCParamGroup Name="General"><FCText Name="AutoloadModule">ArchWorkbench</FCText>
<FCText Name="Language">English</FCText></FCParamGroup>
<FCParamGroup Name="View"><FCBool Name="UseVBO" Value="0"/><FCBool Name="ShowNaviCube" Value="0"/></FCParamGroup>
<FCParamGroup Name="Mod"><FCParamGroup Name="Start"><FCBool Name="closeStart" Value="1"/></FCParamGroup>
<FCParamGroup Name="Draft"><FCBool Name="dxfShowDialog" Value="0"/></FCParamGroup></FCParamGroup>
</FCParamGroup></FCParamGroup></FCParamGroup></FCParameters>
"""


class Window:
    """FreeCAD as someone sees it: asks, clicks, types, looks."""

    def __init__(self, folder, display, shots):
        self.folder, self._display, self._shots = folder, display, shots

    def ask(self, name, *values, secs=300):
        answer = os.path.join(self.folder, "answer.json")
        with open(os.path.join(self.folder, "question.part"), "w") as f:
            json.dump({"name": name, "values": values}, f)
        os.replace(os.path.join(self.folder, "question.part"), os.path.join(self.folder, "question.json"))
        end = time.monotonic() + secs
        while not os.path.exists(answer):
            assert time.monotonic() < end, f"FreeCAD does not answer {name!r}"
            time.sleep(0.02)
        with open(answer) as f:
            said = json.load(f)
        os.remove(answer)
        assert "error" not in said, said.get("error")
        return said["value"]

    def _xdotool(self, *words):
        subprocess.run(["xdotool", *map(str, words)], check=True, env={**os.environ, "DISPLAY": self._display})

    def click(self, at, *modifiers):
        assert at, "nothing to click on"
        for key in modifiers:
            self._xdotool("keydown", key)
        self._xdotool("mousemove", at[0], at[1])
        time.sleep(0.3)
        self._xdotool("click", 1)
        for key in modifiers:
            self._xdotool("keyup", key)
        time.sleep(0.35)

    def press(self, name):
        """Clicks a widget by its object name, once it stands still: rows come and go above it."""
        at = None
        while at != (now := self.ask("find", name)):
            at = now
            time.sleep(0.2)
        self.click(at)

    def key(self, *keys):
        self._xdotool("key", *keys)
        time.sleep(0.4)

    def wait_for(self, question, condition, secs=600):
        end = time.monotonic() + secs
        while True:
            value = self.ask(question)
            if condition(value):
                return value
            assert time.monotonic() < end, f"{question}: {value}"
            time.sleep(0.1)

    def shot(self, name):
        """A picture of the whole screen, kept beside the test's other results."""
        os.makedirs(self._shots, exist_ok=True)
        path = os.path.join(self._shots, name + ".png")
        time.sleep(0.4)
        subprocess.run(["import", "-window", "root", path], check=True, env={**os.environ, "DISPLAY": self._display})
        return path


def shots_folder():
    return os.environ.get("ENFILADE_SHOTS") or os.path.join(ROOT, "target", "plugin-screenshots")


@pytest.fixture(scope="module")
def screen():
    """A virtual screen; gives its display."""
    for tool in ("Xvfb", "xdotool", "import", "convert"):
        assert shutil.which(tool), f"{tool} is missing; scripts/setup installs it"
    read, write = os.pipe()
    size = f"{SCREEN[0]}x{SCREEN[1]}x24"
    process = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", size, "-dpi", "96", "-nolisten", "tcp"],
        pass_fds=[write],
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    with os.fdopen(read) as f:
        display = ":" + f.readline().strip()
    yield display
    process.kill()
    process.wait()


@pytest.fixture(scope="module")
def window(tmp_path_factory, screen):
    folder = str(tmp_path_factory.mktemp("gui"))
    home = os.path.join(folder, "home")
    mods = os.path.join(home, ".local", "share", "FreeCAD", "Mod")
    os.makedirs(mods)
    os.makedirs(os.path.join(home, ".config", "FreeCAD"))
    with open(os.path.join(home, ".config", "FreeCAD", "user.cfg"), "w") as f:
        f.write(CONFIG)
    os.symlink(os.path.join(ROOT, "plugins", "freecad"), os.path.join(mods, "Enfilade"))
    assert shutil.which("freecad"), "freecad is missing; scripts/setup installs it"
    assert os.path.exists(os.environ.get("ENFILADE", "")), "ENFILADE names no built program; run scripts/test-plugins"
    env = {
        **os.environ,
        "HOME": home,
        "DISPLAY": screen,
        "LANG": "C.UTF-8",
        "LIBGL_ALWAYS_SOFTWARE": "1",
        "QT_QPA_PLATFORM": "xcb",
        "QTWEBENGINE_DISABLE_SANDBOX": "1",
        "ENFILADE_GUI_TEST": folder,
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "PYTHONPATH"):
        env.pop(name, None)
    log = open(os.path.join(folder, "freecad.log"), "w")
    freecad = subprocess.Popen(
        ["freecad", os.path.join(HERE, "session.py")], env=env, stdin=subprocess.DEVNULL, stdout=log, stderr=log
    )
    try:
        end = time.monotonic() + 600  # FreeCAD on a busy machine
        while not os.path.exists(os.path.join(folder, "ready")):
            failed = os.path.join(folder, "failed")
            said = open(failed).read() if os.path.exists(failed) else ""
            assert not said, said
            assert freecad.poll() is None, open(log.name).read()[-3000:]
            assert time.monotonic() < end, "FreeCAD does not start: " + open(log.name).read()[-3000:]
            time.sleep(0.1)
        time.sleep(1.0)
        yield Window(folder, screen, shots_folder())
    finally:
        freecad.kill()
        freecad.wait()
        log.close()
