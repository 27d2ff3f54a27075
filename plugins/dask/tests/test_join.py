"""One long search: the seeds as jobs on real workers, then one that begins with what they found; by lines of a file too."""

import json
import subprocess
import sys
from pathlib import Path

from test_dask import PROGRAM, ROOT

SEARCH = ["--raw", "--no-pictures", "--evaluations", "40", "--spacing", "1", "--objective", "degree max 0.5"]


def listed(folder):
    folder.mkdir()
    plan = folder / "maze.dxf"
    plan.write_bytes((ROOT / "samples" / "maze.dxf").read_bytes())
    path = folder / "searches.jsonl"
    command = [PROGRAM, "jobs", plan, "--seeds", "1..3", *SEARCH, "--out", folder / "out", "-o", path, "-q"]
    subprocess.run(command, check=True)
    return path


def joined_of(path):
    ended = subprocess.run([PROGRAM, "join", path], capture_output=True, text=True, check=True)
    return json.loads(ended.stdout)


def finished(path, job):
    return json.loads((path.parent / "out" / job["id"] / "result" / "job.json").read_text(encoding="utf-8"))


def on_workers(path, *more):
    script = Path(__file__).parents[1] / "enfilade_dask.py"
    command = [sys.executable, script, path, "--workers", "2", "--program", PROGRAM, *more]
    return subprocess.run(command, capture_output=True, text=True)


def test_workers_and_lines_join_the_same_search(tmp_path):
    many = listed(tmp_path / "many")
    ended = on_workers(many, "--join", "--no-share")
    assert ended.returncode == 0, ended.stderr
    lines = listed(tmp_path / "lines")
    for line in lines.read_text(encoding="utf-8").splitlines():
        subprocess.run([PROGRAM, "run-job", "-"], input=line, text=True, check=True, capture_output=True)
    by_lines = joined_of(lines)
    subprocess.run([PROGRAM, "run-job", "-"], input=json.dumps(by_lines), text=True, check=True, capture_output=True)
    by_workers = joined_of(many)
    assert by_workers["id"] == by_lines["id"]
    assert finished(many, by_workers)["digest"] == finished(lines, by_lines)["digest"]
    summary = (many.parent / "out" / "summary.csv").read_text(encoding="utf-8").splitlines()
    assert len(summary) == 1 + 3 + 1


def test_parts_are_not_joined(tmp_path):
    plan = tmp_path / "maze.dxf"
    plan.write_bytes((ROOT / "samples" / "maze.dxf").read_bytes())
    path = tmp_path / "parts.jsonl"
    subprocess.run([PROGRAM, "parts", plan, "--parts", "2", "-o", path, "-q"], check=True)
    ended = on_workers(path, "--join")
    assert ended.returncode == 2 and "merged" in ended.stderr
