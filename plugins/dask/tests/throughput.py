"""Throughput of one and of two workers on this machine, beside what the machine itself gives two processes.

    python plugins/dask/tests/throughput.py PROGRAM DRAWING [JOBS] [LAYOUTS]

Every job is one process with one thread. Each manner is measured with 1, 2, 2 and 1 workers, so that a machine that
grows busier or quieter meanwhile favours neither; `xargs` starts the same processes with nothing in between, and is
what no driver can beat. Processor time is that of the jobs alone.
"""

import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import enfilade_dask

ORDER = (1, 2, 2, 1)


def listed(program: str, drawing: Path, folder: Path, n_jobs: int, n_layouts: int) -> Path:
    path = folder / "jobs.jsonl"
    shutil.rmtree(folder / "out", ignore_errors=True)
    subprocess.run(
        [program, "jobs", drawing, "--seeds", f"1..{n_jobs}", "--evaluations", str(n_layouts), "--out", folder / "out", "-o", path, "-q"],
        check=True,
    )
    return path


def by_xargs(program: str, path: Path, workers: int) -> str:
    command = ["xargs", "-d", "\n", "-n", "1", "-P", str(workers), program, "run-job", "--threads", "1", "--progress", "none"]
    with open(path, encoding="utf-8") as lines:
        subprocess.run(command, stdin=lines, stdout=subprocess.DEVNULL, check=True)
    jobs = enfilade_dask.read_jobs(path)
    return enfilade_dask.digest_of([enfilade_dask.Row(job, enfilade_dask.already_done(job)) for job in jobs])


def by_dask(program: str, path: Path, workers: int, client) -> str:
    return enfilade_dask.digest_of(enfilade_dask.run(client, enfilade_dask.read_jobs(path), program=program, threads=1))


def busy_secs() -> float:
    """Processor time that all processes of the machine have had."""
    fields = Path("/proc/stat").read_text(encoding="ascii").split("\n", 1)[0].split()[1:]
    return sum(int(fields[i]) for i in (0, 1, 2, 5, 6)) / os.sysconf("SC_CLK_TCK")


def once(manner: str, workers: int, program: str, drawing: Path, n_jobs: int, n_layouts: int) -> tuple[float, str]:
    from distributed import Client, LocalCluster

    with tempfile.TemporaryDirectory() as scratch:
        path = listed(program, drawing, Path(scratch), n_jobs, n_layouts)
        client = None
        if manner == "dask":
            client = Client(LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None))
            client.wait_for_workers(workers)
        began, busy, own = time.monotonic(), busy_secs(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        digest = by_dask(program, path, workers, client) if client else by_xargs(program, path, workers)
        took, busy = time.monotonic() - began, busy_secs() - busy
        own = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - own
        if client:
            client.shutdown()
    others = f", {own / n_jobs:.2f} s of processor time a job" if not client else ""
    print(
        f"{manner}, {workers} at a time: {took:.1f} s, the machine busy {busy / took:.2f} cores{others}, "
        f"load {os.getloadavg()[0]:.1f}, {digest[:12]}",
        flush=True,
    )
    return took, digest


def main() -> int:
    program, drawing = sys.argv[1], Path(sys.argv[2])
    given = [int(a) for a in sys.argv[3:5]]
    n_jobs, n_layouts = given + [12, 1000][len(given) :]
    digests = set()
    for manner in ("xargs", "dask"):
        took = {1: 0.0, 2: 0.0}
        for workers in ORDER:
            secs, digest = once(manner, workers, program, drawing, n_jobs, n_layouts)
            took[workers] += secs
            digests.add(digest)
        print(f"{manner}: two do {took[1] / took[2]:.2f} times the work of one", flush=True)
    return 0 if len(digests) == 1 else 1


if __name__ == "__main__":
    sys.exit(main())
