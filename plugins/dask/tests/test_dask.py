"""The driver with a real scheduler and real worker processes, and the program itself."""

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

distributed = pytest.importorskip("distributed")
HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import enfilade_dask  # noqa: E402

ROOT = HERE.parents[2]
PROGRAM = os.environ.get("ENFILADE", str(ROOT / "target" / "debug" / "enfilade"))
N_SEEDS = 5
PATIENCE_SECS = 300

if not Path(PROGRAM).exists():
    pytest.skip(f"no program at {PROGRAM}; cargo build makes one", allow_module_level=True)


class Cluster:
    """A scheduler and workers, each a process."""

    def __init__(self):
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{s.getsockname()[1]}"
        self.scheduler, self.workers = None, []
        self.start_scheduler()

    def _start(self, module, *args):
        command = [sys.executable, "-m", f"distributed.cli.{module}", *args]
        environment = os.environ | {"PYTHONPATH": str(HERE.parent)}
        return subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def start_scheduler(self):
        port = self.address.rsplit(":", 1)[1]
        self.scheduler = self._start("dask_scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard")

    def start_worker(self):
        args = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1", "--death-timeout", "60"]
        self.workers.append(self._start("dask_worker", self.address, *args))

    def kill(self, process):
        process.send_signal(signal.SIGKILL)
        process.wait()

    def close(self):
        for process in [*self.workers, self.scheduler]:
            if process.poll() is None:
                self.kill(process)


@pytest.fixture
def cluster():
    out = Cluster()
    yield out
    out.close()


def client_of(cluster, n_workers):
    client = distributed.Client(cluster.address, timeout=60)
    client.wait_for_workers(n_workers, timeout=60)
    return client


def jobs_below(folder, out, embed=False):
    """A sample with a few seeds, and a drawing that no program can read."""
    poisoned = folder / "poisoned.dxf"
    poisoned.write_text("0\nSECTION\n2\nENTITIES\n0\nLINE\nten\n1,5\n0\nENDSEC\n0\nEOF\n")
    listed = folder / f"{out}.jsonl"
    command = [PROGRAM, "jobs", str(ROOT / "samples" / "gallery.dxf"), str(poisoned), "--seeds", f"1..{N_SEEDS}",
               "--evaluations", "60", "--out", str(folder / out), "-o", str(listed), "-q"]
    subprocess.run([*command, *(["--embed"] if embed else [])], check=True)
    return enfilade_dask.read_jobs(listed)


def run(client, jobs, **more):
    return enfilade_dask.run(client, jobs, program=PROGRAM, threads=1, **more)


def check(rows):
    good = [row for row in rows if row.finished]
    bad = [row for row in rows if not row.finished]
    assert len(good) == N_SEEDS and {row.job["settings"]["seed"] for row in good} == set(range(1, N_SEEDS + 1))
    assert len(bad) == N_SEEDS and all("poisoned.dxf" in row.error for row in bad), [r.error for r in bad]


@pytest.fixture(scope="module")
def on_one_machine(tmp_path_factory):
    """The same jobs one after the other, without Dask: ids and digests."""
    folder = tmp_path_factory.mktemp("one")
    digests = {}
    for job in jobs_below(folder, "out"):
        ended = subprocess.run([PROGRAM, "run-job", "-", "--threads", "1"], input=json.dumps(job), capture_output=True, text=True)
        if "poisoned" in job["drawing"]:
            assert ended.returncode == 2, ended
        else:
            digests[job["id"]] = json.loads(ended.stdout)["digest"]
    assert len(set(digests.values())) > 1
    return digests


def digests_of(rows):
    return {row.job["id"]: row.finished["digest"] for row in rows if row.finished}


def test_one_worker_killed_one_late_and_the_same_hashes(cluster, tmp_path, on_one_machine):
    cluster.start_worker(), cluster.start_worker()
    seen = []

    def disturb(row, n, total):
        seen.append((n, total))
        if n == 2:
            cluster.start_worker()
            cluster.kill(cluster.workers[0])

    with client_of(cluster, 2) as client:
        rows = run(client, jobs_below(tmp_path, "out"), on_row=disturb)
    check(rows)
    assert seen == [(n, 2 * N_SEEDS) for n in range(1, 2 * N_SEEDS + 1)]
    assert digests_of(rows) == on_one_machine
    enfilade_dask.write_summary(rows, tmp_path / "out")
    assert len((tmp_path / "out" / "summary.csv").read_text().splitlines()) == 2 * N_SEEDS + 1
    assert "5 of 10 jobs done" in (tmp_path / "out" / "summary.html").read_text()


def test_a_restarted_scheduler_finishes_the_same_jobs(cluster, tmp_path, on_one_machine):
    cluster.start_worker()

    def disturb(row, n, total):
        if n == 1:
            cluster.kill(cluster.scheduler)
            cluster.start_scheduler()
            cluster.start_worker()

    with client_of(cluster, 1) as client:
        rows = run(client, jobs_below(tmp_path, "out"), on_row=disturb)
    check(rows)
    assert digests_of(rows) == on_one_machine


def test_without_a_common_folder_results_come_back(cluster, tmp_path, on_one_machine):
    cluster.start_worker()
    jobs = jobs_below(tmp_path, "out", embed=True)
    hidden = [job | {"drawing": "/nowhere/" + Path(job["drawing"]).name} for job in jobs]
    with client_of(cluster, 1) as client:
        rows = run(client, hidden, share=False)
        check(rows)
        assert digests_of(rows) == on_one_machine
        start = time.monotonic()
        again = run(client, [job for job in hidden if "gallery" in job["drawing"]], share=False)
    assert digests_of(again) == on_one_machine, time.monotonic() - start
    one = next(row for row in rows if row.finished)
    assert (tmp_path / "out" / one.job["id"] / "result" / "result.json").is_file()


def test_names_in_tables_are_neither_formulas_nor_markup(tmp_path):
    job = {"id": "0", "drawing": "/x/=HYPERLINK(1)<b>.dxf", "out": str(tmp_path), "settings": {"seed": 1}}
    enfilade_dask.write_summary([enfilade_dask.Row(job, error="@bad <img onerror=x>")], tmp_path)
    assert "'=HYPERLINK" in (tmp_path / "summary.csv").read_text()
    page = (tmp_path / "summary.html").read_text()
    assert "<img" not in page and "&lt;b&gt;" in page
    assert enfilade_dask.plain("+1.50 %") == "+1.50 %" and enfilade_dask.plain("-x") == "'-x"


def test_files_that_leave_the_folder_are_refused(tmp_path):
    job = {"id": "0", "out": str(tmp_path)}
    with pytest.raises(ValueError):
        enfilade_dask.store(job, {"../../evil": b""})
    assert not (tmp_path / "0" / "result").exists()


def test_workers_of_this_machine_share_its_cores():
    def threads(**said):
        return enfilade_dask.threads_of(argparse.Namespace(**{"threads": None, "scheduler": None, "workers": None} | said))

    assert threads() == 1
    assert threads(workers=1) == os.cpu_count()
    assert threads(threads=3) == 3
    assert threads(scheduler="tcp://host:8786") is None, "a worker elsewhere knows its own cores"


@pytest.mark.parametrize("content", [None, "no json\n", "[1]\n", '{"id": "a"}\n', b"\xff\xfe"])
def test_what_is_no_list_of_jobs_is_one_sentence(tmp_path, capsys, content):
    listed = tmp_path / "jobs.jsonl"
    if content is not None:
        listed.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert enfilade_dask.main([str(listed)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "jobs.jsonl" in said, said


def test_no_workers_and_no_scheduler_are_one_sentence(tmp_path, capsys, monkeypatch):
    listed = tmp_path / "jobs.jsonl"
    listed.write_text(json.dumps({"id": "a", "drawing": "plan.dxf", "out": str(tmp_path)}) + "\n")
    monkeypatch.setattr(enfilade_dask, "SCHEDULER_SECS", 1)
    for more in (["--workers", "0"], ["--scheduler", "tcp://127.0.0.1:9"], ["--scheduler", "nonsense://x"]):
        assert enfilade_dask.main([str(listed), *more]) == 2, more
        said = capsys.readouterr().err
        assert said.count("\n") == 1 and more[1] in said, said


@pytest.mark.parametrize("option", [
    "--resource=GPU=x", "--resource=GPU", "--resource==1", "--resource=GPU=-1", "--resource=GPU=0", "--resource=GPU=nan",
    "--resource=GPU=inf", "--threads=0", "--threads=-2", "--retries=-1", "--workers=0",
])
def test_options_that_make_no_sense_are_one_sentence(tmp_path, capsys, option):
    listed = tmp_path / "jobs.jsonl"
    listed.write_text(json.dumps({"id": "a", "drawing": "plan.dxf", "out": str(tmp_path)}) + "\n")
    # No scheduler is looked for.
    assert enfilade_dask.main([str(listed), option, "--scheduler", "tcp://127.0.0.1:9"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and option.replace("=", " ", 1) in said and "expected" in said, said


def test_resources_are_names_with_numbers():
    assert enfilade_dask.resources_of(["GPU=1", "memory=2.5e9"]) == {"GPU": 1, "memory": 2.5e9}
    assert enfilade_dask.resources_of([]) is None


def test_what_lies_beside_a_scene_travels_with_its_job(tmp_path):
    import hashlib
    import zipfile

    def beside(kind, data, **more):
        return {"kind": kind, "sha256": hashlib.sha256(data).hexdigest(), **more}

    (tmp_path / "house.glb").write_bytes(b"scene")
    (tmp_path / "walls.bin").write_bytes(b"data")
    (tmp_path / "other.ifc").write_bytes(b"another")
    with zipfile.ZipFile(tmp_path / "house.ifczip", "w") as packed:
        packed.writestr("house.ifc", b"building")
    files = [beside("twin", b"building"), beside("buffer", b"data", name="walls.bin"), beside("picture", b"", name="no.png")]
    job = {"drawing": str(tmp_path / "house.glb"), "beside": files}
    carried = enfilade_dask.with_content(job)
    contents = [file.get("content") for file in carried["beside"]]
    # What is gone is left for `run-job` to name.
    assert contents == ["YnVpbGRpbmc=", "ZGF0YQ==", None]
    assert all("content" not in file for file in files)


@pytest.mark.parametrize("text", ["", "\n", " \n\n"])
def test_a_list_without_a_job_is_refused(tmp_path, capsys, text):
    jobs = tmp_path / "jobs.jsonl"
    jobs.write_text(text)
    assert enfilade_dask.main([str(jobs), "--workers", "1"]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and "no job" in err and err.count("nothing was done") == 1
