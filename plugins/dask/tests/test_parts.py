"""One analysis in parts: by a real scheduler and real workers, by lines of a file, and the program itself on one machine."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from test_dask import PROGRAM, ROOT, client_of, cluster, enfilade_dask  # noqa: F401

N_PARTS = 6
MEASURES = ["--measures", "all", "--spacing", "0.4"]


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "plan.dxf"
    path.write_bytes((ROOT / "samples" / "gallery.dxf").read_bytes())
    return path


@pytest.fixture
def on_one_machine(plan):
    """All files of the analysis that one machine makes, and the table of its cells."""
    out = plan.parent / "one"
    command = [PROGRAM, "analyse", plan, *MEASURES, "--backend", "cpu", "--cells", out / "cells.csv", "--out", out, "-q"]
    out.mkdir()
    subprocess.run(command, check=True)
    return files_below(out)


def files_below(folder):
    files = (p for p in folder.rglob("*") if p.is_file() and p.name != ".lock")
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in files}


def listed(plan, *more):
    path = plan.parent / "parts.jsonl"
    command = [PROGRAM, "parts", plan, "--parts", str(N_PARTS), *MEASURES, "--out", plan.parent / "parts", "-o", path, "-q"]
    subprocess.run([*command, *more], check=True)
    return path


def merged(plan, path, *more):
    """What `merge` made, and how it ended."""
    out = plan.parent / "many"
    out.mkdir(exist_ok=True)
    command = [PROGRAM, "merge", path, "--cells", out / "cells.csv", "--out", out, "-q", *more]
    ended = subprocess.run(command, capture_output=True, text=True)
    return files_below(out), ended


def run(client, jobs, **more):
    return enfilade_dask.run(client, jobs, program=PROGRAM, threads=1, **more)


def test_a_worker_killed_in_the_middle_and_the_same_bytes(cluster, plan, on_one_machine):  # noqa: F811
    cluster.start_worker(), cluster.start_worker()

    def disturb(row, n, total):
        if n == 2:
            cluster.start_worker()
            cluster.kill(cluster.workers[0])

    path = listed(plan)
    with client_of(cluster, 2) as client:
        rows = run(client, enfilade_dask.read_jobs(path), on_row=disturb)
    assert [row.finished["number"] for row in rows] == list(range(1, N_PARTS + 1)), [row.error for row in rows]
    files, ended = merged(plan, path)
    assert ended.returncode == 0, ended
    assert files == on_one_machine


def test_without_a_common_folder_parts_come_back_and_are_merged(cluster, plan, on_one_machine):  # noqa: F811
    cluster.start_worker()
    path = listed(plan, "--embed")
    jobs = [job | {"drawing": "/nowhere/plan.dxf"} for job in enfilade_dask.read_jobs(path)]
    with client_of(cluster, 1) as client:
        rows = run(client, jobs, share=False)
    assert all(row.finished for row in rows), [row.error for row in rows]
    files, ended = merged(plan, path)
    assert ended.returncode == 0 and files == on_one_machine, ended


def test_the_command_does_the_parts_and_merges_them(plan, on_one_machine, tmp_path):
    path = listed(plan)
    out = tmp_path / "many"
    out.mkdir()
    command = [sys.executable, enfilade_dask.__file__, path, "--workers", "2", "--program", PROGRAM, "--"]
    ended = subprocess.run([*command, "--cells", out / "cells.csv", "--out", out, "-q"], capture_output=True, text=True)
    assert ended.returncode == 0, ended
    assert files_below(out) == on_one_machine


@pytest.mark.skipif(sys.platform == "win32", reason="limits of a process are the system's own")
def test_a_full_disk_of_one_worker_leaves_nothing_half_and_another_does_it(plan, on_one_machine):
    path = listed(plan)
    lines = path.read_text().splitlines()

    def full():
        # A file may grow to a kilobyte, as on a disk with no more room.
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))

    ended = subprocess.run([PROGRAM, "run-job", "-"], input=lines[0], capture_output=True, text=True, preexec_fn=full)
    assert ended.returncode == enfilade_dask.TRY_AGAIN and ended.stderr.startswith("error: "), ended
    assert not (plan.parent / "parts" / json.loads(lines[0])["id"] / "result").exists()
    job = json.loads(lines[0])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(enfilade_dask, "PAUSES_SECS", ())
        patch.setattr(subprocess, "run", with_full_disk(subprocess.run, full))
        with pytest.raises(enfilade_dask.TryAgain):
            enfilade_dask.work(job, PROGRAM, 1, False)
    by_lines(path, lines)
    files, ended = merged(plan, path)
    assert ended.returncode == 0 and files == on_one_machine, ended


def with_full_disk(run_, full):
    return lambda *args, **more: run_(*args, **more, preexec_fn=full)


def by_lines(path, lines):
    """As an array of a batch system: a line a task, in any order, one of them twice, another killed at first."""
    killed = subprocess.Popen([PROGRAM, "run-job", "-"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    killed.stdin.write(lines[-1]), killed.stdin.close()
    time.sleep(0.05)
    killed.send_signal(signal.SIGKILL), killed.wait()
    for task in [*range(len(lines), 0, -1), 1]:
        command = f'sed -n "${{SLURM_ARRAY_TASK_ID}}p" "{path}" | "{PROGRAM}" run-job -'
        environment = os.environ | {"SLURM_ARRAY_TASK_ID": str(task)}
        subprocess.run(["bash", "-c", command], env=environment, check=True, stdout=subprocess.DEVNULL)


def test_two_sites_do_halves_of_the_lines_and_one_merges(plan, on_one_machine, tmp_path):
    path = listed(plan)
    sites = tmp_path / "site-1", tmp_path / "site-2"
    for i, line in enumerate(path.read_text().splitlines()):
        subprocess.run([PROGRAM, "run-job", "-", "--out", sites[i % 2]], input=line, text=True, check=True, stdout=subprocess.DEVNULL)
    files, ended = merged(plan, path, "--parts", str(sites[0]), "--missing", str(tmp_path / "left.jsonl"))
    assert ended.returncode == 75 and "parts 2, 4, 6 of 6 are not done" in ended.stderr, ended
    assert (tmp_path / "left.jsonl").read_text().splitlines() == path.read_text().splitlines()[1::2]
    for folder in sites[1].iterdir():
        folder.rename(sites[0] / folder.name)
    files, ended = merged(plan, path, "--parts", str(sites[0]))
    assert ended.returncode == 0 and files == on_one_machine, ended


def test_parts_and_rounds_are_lists_of_their_own(tmp_path, capsys):
    path = tmp_path / "jobs.jsonl"
    job = {"id": "a", "drawing": "plan.dxf", "out": str(tmp_path)}
    path.write_text("".join(json.dumps(j) + "\n" for j in (job, job | {"id": "b", "part": {"number": 1, "count": 1}})))
    assert enfilade_dask.main([str(path)]) == 2
    assert "parts of an analysis beside other jobs" in capsys.readouterr().err
    path.write_text(json.dumps(job) + "\n")
    assert enfilade_dask.main([str(path), "--workers", "1", "--", "--cells", "x.csv"]) == 2
    assert "are not merged" in capsys.readouterr().err
