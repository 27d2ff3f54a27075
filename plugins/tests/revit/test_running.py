"""The program as a detached process: started by one click, asked by the next."""

import json
import os
import stat
import subprocess
import sys
import time

import pytest
from conftest import LIB, ROOT
from enfilade_common import job, results
from enfilade_common.model import PluginError, Wishes
from enfilade_revit import reading, running, work
from fake import dotnet
from fake.failures import FailureSeverity


@pytest.fixture
def made(revit, tmp_path):
    study, _ = reading.study(revit.host(), Wishes(members=2, evaluations=150))
    return job.write(study, str(tmp_path / "job"))


@pytest.fixture
def program_that(tmp_path):
    """A program that says its version and then does what ``body`` says."""

    def make(body, name="enfilade"):
        path = tmp_path / name
        head = f"#!{sys.executable}\nimport os, sys, time\nif '--version' in sys.argv: print('enfilade 0.1.9 (abc)'); sys.exit()\n"
        path.write_text(head + body)
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return str(path)

    return make


def until(true, secs=300.0):
    end = time.monotonic() + secs
    while not true():
        assert time.monotonic() < end, "it took too long"
        time.sleep(0.02)


def ended(folder):
    return lambda: not running.state(folder).is_running


PROGRESS = '{"stage":"optimise","done":45,"total":100,"evaluations":9,"best":1.0,"eta_secs":170}'


def test_a_run_goes_on_when_python_does_not(made, program_that):
    """More words than any pipe holds, while nobody reads; then the last of them is how far it is."""
    path = program_that(
        f"for i in range(3000): sys.stderr.write('{PROGRESS}\\n')\n"
        f"sys.stderr.flush(); open('{made.folder}/all', 'w').close(); time.sleep(60)"
    )
    running.start(made, path, "0.1.9 (abc)")
    until(lambda: os.path.exists(os.path.join(made.folder, "all")))
    now = running.state(made.folder)
    assert (now.is_running, now.words) == (True, "optimise, 45 %, about 3 min left")
    with pytest.raises(PluginError, match="The study still runs: optimise, 45 %, about 3 min left. Look again later"):
        running.result(made)
    running.stop(made.folder)
    until(ended(made.folder))
    running.stop(made.folder)


def test_a_run_outlives_the_python_that_started_it(made, program_that, tmp_path):
    """As a click in Revit does it: start, and the script ends."""
    path = program_that(f"time.sleep(1); open('{made.folder}/late', 'w').close()")
    script = (
        f"import sys; sys.path[:0] = {[os.path.dirname(__file__), os.path.join(ROOT, 'plugins', 'common'), LIB]!r}\n"
        "from fake import install; install.install()\n"
        "from enfilade_common import job; from enfilade_revit import running\n"
        f"running.start(job.read({made.folder!r}), {path!r}, '0.1.9 (abc)')"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
    assert running.state(made.folder).words == "it has just begun" and running.state(made.folder).is_running
    until(lambda: os.path.exists(os.path.join(made.folder, "late")))
    until(ended(made.folder))


def test_what_stopped_a_run_is_told(made, program_that):
    running.start(made, program_that("sys.stderr.write('note: x\\nerror: plan.dxf:3: no walls\\n'); sys.exit(2)"), "0.1.9 (abc)")
    until(ended(made.folder))
    with pytest.raises(PluginError, match="^The study ended without options. error: plan.dxf:3: no walls$"):
        running.result(made)
    running.start(made, program_that("sys.stderr.write('{\"stage\":\"read\"}\\nlast words\\n'); os.abort()"), "0.1.9 (abc)")
    until(ended(made.folder))
    with pytest.raises(PluginError, match="last words"):
        running.result(made)


def test_what_cannot_be_started_is_said(made, tmp_path):
    with pytest.raises(PluginError, match="does not start: .* Nothing was started"):
        running.start(made, str(tmp_path), "0.1.9 (abc)")


def test_no_run_and_a_broken_note_of_one(made, tmp_path):
    assert running.state(made.folder) is None
    running.stop(made.folder)
    with pytest.raises(PluginError, match="There are no options yet"):
        running.result(made)
    for text in ("", "{}", "[1]", '{"pid": "x"}'):
        (tmp_path / "job" / running.RUN).write_text(text)
        assert running.state(made.folder) is None


def test_a_later_process_of_the_same_number_is_another(made):
    """Windows gives numbers of processes again: what began at another time is not ours, and is not ended."""
    other = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    try:
        run = {"pid": other.pid, "begun": 1, "version": "0.1.9", "before": []}
        with open(os.path.join(made.folder, running.RUN), "w") as f:
            json.dump(run, f)
        assert running.state(made.folder) == running.State(False, "")
        running.stop(made.folder)
        assert other.poll() is None
    finally:
        other.kill()
        other.wait()


def test_the_fake_says_of_processes_what_dotnet_does():
    with pytest.raises(dotnet.SystemException, match="is not running"):
        dotnet.Process.GetProcessById(2**22 + 1)
    done = subprocess.Popen(["true"])
    until(lambda: dotnet.Process(done.pid).HasExited)
    done.wait()
    assert running._begun(os.getpid()) > 0 and running._begun(done.pid) == 0


def test_a_second_run_waits_for_the_first_and_can_be_stopped(revit, window, program_that, monkeypatch):
    monkeypatch.setenv("ENFILADE", program_that("time.sleep(60)"))
    said, folder = window(0, 1), work.job_folder(revit.host())
    work.export_study(revit.host(), said)
    assert "the study runs" in said.said[0]
    work.guarded(said, lambda: work.export_study(revit.host(), said))
    assert "The study of this storey still runs: it has just begun. 'Candidates' can stop it" in said.said[1]
    work.guarded(said, lambda: work.apply_option(revit.host(), said))
    assert "The study still runs" in said.said[2]
    work.candidates(revit.host(), said)
    assert running.state(folder).is_running and said.asked[0][:2] == (
        "Enfilade: Haus Süd, Level 1", "The study runs: it has just begun")
    work.candidates(revit.host(), said)
    until(ended(folder))


def test_each_storey_and_model_has_a_folder_of_its_own(revit, window, program_that, monkeypatch):
    monkeypatch.setenv("ENFILADE", program_that(""))
    said = window()
    work.export_study(revit.host(), said)
    assert os.path.isfile(os.path.join(revit.host().document_folder(), "Haus Süd-enfilade", "Level 1", "plan.dxf"))
    until(ended(work.job_folder(revit.host())))
    kept, revit.doc._guid = revit.doc._guid, "99999999-2222-3333-4444-555555555555"
    work.guarded(said, lambda: work.candidates(revit.host(), said))
    assert "The study is of another model than 'Haus Süd'" in said.said[-1], "before any option is shown"
    revit.doc._guid = kept
    revit.level._s["name"] = 'Attic: "north"/south?'
    assert os.path.basename(work.job_folder(revit.host())) == "Attic_ _north__south_"
    work.guarded(said, lambda: work.candidates(revit.host(), said))
    assert "There is no study of this document yet" in said.said[-1]
    revit.level._s["name"] = ". "
    assert os.path.basename(work.job_folder(revit.host())) == "_"


def test_the_buttons_from_marks_to_undo(revit, window, real_program, monkeypatch):
    monkeypatch.setenv("ENFILADE", real_program)
    said, host = window(), revit.host()
    revit.at["Spur"]._s["params"]["Enfilade Group"] = "pair"
    revit.lines("EF-QUERY", [(500, 500), (3500, 500), (3500, 5500), (500, 5500)])
    work.describe_marks(host, said)
    for words in ("7 walls, 1 columns", "x -1000 1000", "(group pair)", "slides -300 to 2000 mm", "Region: query, 4 corners"):
        assert words in said.said[0]
    work.guarded(said, lambda: work.candidates(host, said))
    assert "run one first" in said.said[-1]
    del revit.at["Spur"]._s["params"]["Enfilade Group"]
    work.export_study(host, said, Wishes(members=2, evaluations=150))
    folder = work.job_folder(host)
    until(ended(folder), 240.0)
    asked = window(0)
    work.candidates(revit.host(), asked)
    assert all(os.path.exists(picture) for _, _, picture in asked.rows), running.state(folder).words
    assert len(revit.doc._undo) == 1 and "Undo takes all of it back" in asked.said[-1]
    revit.doc._undo_last()
    revit.doc._trouble = [(FailureSeverity.Warning, "Walls overlap.")]
    asked = window(0)
    work.apply_option(revit.host(), asked)
    assert len(revit.doc._undo) == 1 and asked.said[-1].endswith("Revit warns: Walls overlap.")
    for answer in (window(None), window(None)):
        work.guarded(answer, lambda: work.candidates(revit.host(), answer))
        work.guarded(answer, lambda: work.apply_option(revit.host(), window(None)))
    assert len(revit.doc._undo) == 1


def test_a_round_without_options(revit, window, made, monkeypatch):
    monkeypatch.setattr(work, "job_folder", lambda host: made.folder)
    empty = results.Round("", 1, made.sha256, {}, [], [], "", 0.1, (0.0, 0.0))
    monkeypatch.setattr(running, "result", lambda job: empty)
    said = window()
    work.guarded(said, lambda: work.apply_option(revit.host(), said))
    assert said.said == ["No layout improves the present one, or nothing may move: the present layout was measured."]


def test_nothing_marked_is_said(revit, window):
    for thing in revit.at.values():
        thing._s["params"] = {}
    said = window()
    work.describe_marks(revit.host(), said)
    assert "Nothing is marked" in said.said[0]


def test_an_option_of_a_drawing_by_its_folder(revit, window, monkeypatch, tmp_path):
    id = str(revit.at["Screen"]._id)
    line = [[6.0, 4.5], [6.9, 4.5]]
    option = results.Option(1, "", "better", {}, {}, None, True, [], [{"host_id": id, "from": line, "to": [[x, 4.7] for x, _ in line]}])
    found = results.Round("", 1, "", {}, [option], [], "", 0.1, (0.0, 0.0))
    monkeypatch.setattr(results, "read", lambda folder: found)
    said = window(str(tmp_path), 0, str(tmp_path), None, "")
    for _ in range(3):
        work.apply_drawing(revit.host(), said)
    assert said.said == [f"Option 1: Screen {id} moved. Undo takes all of it back."]
    assert len(revit.doc._undo) == 1
