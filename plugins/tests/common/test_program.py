import subprocess

import pytest
from enfilade_common import program
from enfilade_common.model import PluginError


def run_to_end(path):
    """What a run said of its progress, its code, and what a user is told."""
    ended = subprocess.run([path, *program.arguments("plan.dxf")], stderr=subprocess.PIPE, timeout=30)
    listener = program.Listener()
    return listener.feed(ended.stderr), ended.returncode, listener.outcome(ended.returncode)


def test_it_is_found_by_setting_then_environment_then_path(program_that, monkeypatch, tmp_path):
    one = program_that("", "one")
    two = program_that("", "enfilade")
    monkeypatch.setenv("ENFILADE", one)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert program.find(two) == two
    assert program.find() == one
    monkeypatch.delenv("ENFILADE")
    assert program.find() == two


def test_a_missing_program_says_what_helps(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("ENFILADE", raising=False)
    with pytest.raises(PluginError, match="Install it"):
        program.find()
    with pytest.raises(PluginError, match="The settings name"):
        program.find(str(tmp_path / "nothing"))


def test_its_version_is_checked(program_that):
    assert program.version(program_that("print('enfilade 0.1.7 (1f2e3d4c5)')")) == "0.1.7 (1f2e3d4c5)"
    for says, words in (
        ("print('enfilade 0.0.9')", "too old"),
        ("print('enfilade 0.2.0 (1f2e3d4c5)')", "too new .* update the plugin"),
        ("print('something else 3.1.2')", "is not Enfilade: .* says 'something else 3.1.2'"),
        ("print('enfilade')", "is not Enfilade"),
        ("pass", "says nothing"),
    ):
        with pytest.raises(PluginError, match=words + ".* Nothing was started"):
            program.version(program_that(says))


def test_where_the_best_so_far_lies_is_heard():
    listener = program.Listener()
    listener.feed(b'{"stage":"optimise","evaluations":12}\n{"stage":"so-far","evaluations":40,"folder":"/x/so-far"}\n')
    listener.feed(b'{"stage":"write","evaluations":0}\n')
    assert (listener.evaluations, listener.so_far) == (40, "/x/so-far")
    assert program.arguments("plan.dxf", keeps_best=True)[2:4] == ["--write-every", "5"]


def test_progress_and_words_are_told_apart(program_that):
    path = program_that(
        """
        assert sys.argv[1] == "run" and sys.argv[-2:] == ["--progress", "json"]
        sys.stderr.write('{"stage":"optimise: degree","done":3,"total":10,"evaluations":7,"best":1.5,"eta_secs":2}\\n')
        sys.stderr.write('note: something\\n{"stage":"write","done":0,"total":null}\\n{"broken\\n')
        sys.exit(1)
        """
    )
    said, code, words = run_to_end(path)
    assert [(p.stage, p.share, p.best) for p in said] == [("optimise: degree", 0.3, 1.5), ("write", None, None)]
    assert (code, words) == (1, "Done, with something left out; the report says what.")


def test_an_error_is_told_in_the_programs_words(program_that):
    _, code, words = run_to_end(program_that("sys.stderr.write('error: plan.dxf:3: no walls\\n'); sys.exit(2)"))
    assert (code, words) == (2, "The drawing could not be used. error: plan.dxf:3: no walls")


def test_lines_that_come_in_pieces():
    listener = program.Listener()
    assert listener.feed(b'{"stage":"re') == []
    (progress,) = listener.feed(b'ad","done":0}\nno')
    assert progress.stage == "read" and listener.words == []


def test_a_program_is_asked_to_stop(program_that):
    polite = program_that(
        """
        signal.signal(signal.SIGINT, lambda *a: sys.exit(130))
        sys.stderr.write('x'); sys.stderr.flush()
        time.sleep(60)
        """
    )
    with subprocess.Popen([polite], stderr=subprocess.PIPE) as run:
        run.stderr.read(1)
        program.interrupt(run.pid)
        assert run.wait(20) == program.STOPPED


def test_lines_that_are_no_progress_are_passed_over():
    listener = program.Listener()
    said = listener.feed(
        b'{"stage":"a","done":"abc"}\n{"stage":"a","total":"x"}\n{"stage":"a","best":"n"}\n{"done":1}\n'
        b'{"stage":"a","best_parameters":[1,"x"]}\n\xff\xfe{\n[1]\n{"stage":"b","done":4,"total":8}\n'
    )
    assert [(p.stage, p.share) for p in said] == [("b", 0.5)]


def test_a_program_that_hangs_when_asked_its_version(program_that, monkeypatch):
    assert program.VERSION_SECS <= 2.0
    monkeypatch.setattr(program, "VERSION_SECS", 0.2)
    with pytest.raises(PluginError, match="does not say its version within 0.2 s"):
        program.version(program_that("time.sleep(60)"))


def test_a_crash_is_told_with_its_last_words(program_that):
    body = "sys.stderr.write('one\\nlast words\\n'); sys.stderr.flush(); os.kill(os.getpid(), signal.SIGSEGV)"
    _, code, words = run_to_end(program_that(body))
    assert (code, words) == (-11, "The program ended with code -11. last words")
