"""Many drawings, storeys and seeds, or one large analysis, on many machines: `enfilade run-job` under Dask distributed.

The jobs are those of `enfilade jobs` or the parts of `enfilade parts`: each carries an id that is the hash of everything
that decides its result, so that a job which is done twice, by a worker that died or came late, leaves the same bytes once.
"""

from __future__ import annotations

import argparse
import base64
import csv
import hashlib
import html
import json
import math
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

RETRIES = 3
"""How often a job is tried again after `run-job` asked for it or its worker died."""
DONE, LEFT_OUT, BAD_INPUT, ENVIRONMENT, TRY_AGAIN = 0, 1, 2, 4, 75
SCHEDULER_SECS = 20
"""A scheduler must take calls within this time at the start; one that is restarted later gets longer."""
# A worker that was killed leaves its program at work on the job: it is waited for, and what it finishes is taken.
PAUSES_SECS = (0.5, 1, 2, 4, 8, 16, 32)


class TryAgain(RuntimeError):
    """The machine failed, not the job: Dask tries it again, perhaps elsewhere."""


@dataclass
class Row:
    """How one job ended."""

    job: dict
    finished: dict = field(default_factory=dict)
    error: str = ""


def read_jobs(path: str | os.PathLike) -> list[dict]:
    """The lines of a file of `enfilade jobs`, each id once. `OSError`, `ValueError` where it is none."""
    jobs = {}
    for number, line in enumerate(Path(path).read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip():
            continue
        try:
            job = json.loads(line)
        except ValueError as error:
            raise ValueError(f"line {number} is no JSON: {error}") from error
        if not isinstance(job, dict) or not all(isinstance(job.get(key), str) for key in ("id", "drawing", "out")):
            raise ValueError(f"line {number} is no job of `enfilade jobs` or `enfilade parts`")
        jobs[job["id"]] = job
    if len({bool(job.get("part")) for job in jobs.values()}) > 1:
        raise ValueError("it has parts of an analysis beside other jobs, expected a list of each")
    return list(jobs.values())


def are_parts(jobs: list[dict]) -> bool:
    """Whether the jobs are the parts of one analysis, which are merged when all are done."""
    return bool(jobs and jobs[0].get("part"))


def with_content(job: dict) -> dict:
    """The same job carrying its drawing's bytes, for machines that share no folder."""
    if job.get("content"):
        return job
    drawing = Path(job["drawing"])
    carried = job | {"content": base64.b64encode(drawing.read_bytes()).decode("ascii")}
    if job.get("beside"):
        carried["beside"] = [file | beside_content(file, drawing) for file in job["beside"]]
    return carried


def beside_content(file: dict, drawing: Path) -> dict:
    """The bytes of a file beside a scene, known by their hash; none where they are no longer there: `run-job` says so."""
    if file["kind"] == "twin":
        found = (data for path in sorted(drawing.parent.iterdir()) for data in buildings_in(path))
    else:
        path = drawing.parent / file["name"]
        found = iter([path.read_bytes()] if path.is_file() else [])
    for data in found:
        if hashlib.sha256(data).hexdigest() == file["sha256"]:
            return {"content": base64.b64encode(data).decode("ascii")}
    return {}


def buildings_in(path: Path) -> list[bytes]:
    """An IFC, or those that a packed one holds."""
    if path.suffix.lower() not in (".ifc", ".ifczip") or not path.is_file():
        return []
    if not zipfile.is_zipfile(path):
        return [path.read_bytes()]
    with zipfile.ZipFile(path) as packed:
        return [packed.read(name) for name in packed.namelist() if name.lower().endswith(".ifc")]


def work(job: dict, program: str, threads: int | None, hand_back: bool) -> dict:
    """Runs on a worker. Returns `{"finished": …, "files": {name: bytes}}` or `{"error": text}`.

    A bad input is an answer, so that one poisoned drawing never stops the others; what the machine is to
    blame for raises `TryAgain`.
    """
    with tempfile.TemporaryDirectory(prefix="enfilade-") as scratch:
        out = scratch if hand_back else job["out"]
        command = [program, "run-job", "-", "--out", out, "--progress", "none"]
        if threads:
            command += ["--threads", str(threads)]
        ended = _ended(command, job)
        for pause in PAUSES_SECS:
            if ended.returncode != TRY_AGAIN:
                break
            time.sleep(pause)
            ended = _ended(command, job)
        said = ended.stderr.strip()
        if ended.returncode == TRY_AGAIN or ended.returncode < 0 or ended.returncode in (4, 130):
            raise TryAgain(said or f"ended by signal {-ended.returncode}")
        if ended.returncode not in (DONE, LEFT_OUT):
            return {"error": said or f"exit code {ended.returncode}"}
        files = {}
        if hand_back:
            result = Path(scratch) / job["id"] / "result"
            files = {p.relative_to(result).as_posix(): p.read_bytes() for p in sorted(result.rglob("*")) if p.is_file()}
        return {"finished": json.loads(ended.stdout), "files": files}


def _ended(command: list[str], job: dict) -> subprocess.CompletedProcess:
    try:
        return subprocess.run(command, input=json.dumps(job), capture_output=True, text=True, encoding="utf-8")
    except OSError as error:
        raise TryAgain(f"{command[0]}: {error}") from error


def store(job: dict, files: dict[str, bytes]) -> None:
    """Puts handed back results where `run-job` puts them: whole or not at all."""
    target = Path(job["out"]) / job["id"] / "result"
    if target.exists():
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    scratch = Path(tempfile.mkdtemp(prefix=".tmp-", dir=target.parent))
    try:
        for name, content in files.items():
            path = scratch / name
            if not path.resolve().is_relative_to(scratch.resolve()):
                raise ValueError(f"a worker handed back {name!r}, which leaves the folder of the results")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        try:
            scratch.rename(target)
        except OSError:
            if not target.exists():
                raise
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def already_done(job: dict) -> dict | None:
    """What an earlier run left of the same job here."""
    try:
        finished = json.loads((Path(job["out"]) / job["id"] / "result" / "job.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return finished if finished.get("id") == job["id"] else None


def run(client, jobs, *, program="enfilade", share=True, threads=None, resources=None, retries=RETRIES, on_row=None):
    """Does all jobs on the client's workers; a `Row` each, in the order of the jobs.

    `share`: drawings and results lie in folders that all machines see; without it both travel with the jobs.
    `resources`: what a worker must offer, as `{"GPU": 1}`. `on_row(row, n_done, n_jobs)` is called as jobs end.
    """
    rows, waiting = {}, []

    def ended(row):
        rows[row.job["id"]] = row
        if on_row:
            on_row(row, len(rows), len(jobs))

    for job in jobs:
        finished = already_done(job)
        if finished:
            ended(Row(job, finished))
            continue
        try:
            waiting.append((job, job if share else with_content(job)))
        except OSError as error:
            ended(Row(job, error=str(error)))
    for attempt in range(retries + 1):
        if attempt:
            _wait_for_scheduler(client)

        def submit(job, task):
            return client.submit(
                work, task, program, threads, not share, key=f"enfilade-{job['id']}-{attempt}", retries=retries,
                resources=resources,
            )

        waiting = _gather([(job, task, submit(job, task)) for job, task in waiting], ended)
        if not waiting:
            break
    for job, _ in waiting:
        ended(Row(job, error="lost with the scheduler, again and again"))
    return [rows[job["id"]] for job in jobs]


def _gather(submitted, ended) -> list[tuple[dict, dict]]:
    """Tells what ended; returns what was lost with the scheduler."""
    from distributed import as_completed

    by_key = {future.key: (job, task) for job, task, future in submitted}
    lost = []
    for future in as_completed([future for _, _, future in submitted]):
        job, task = by_key[future.key]
        if future.status in ("cancelled", "lost"):
            lost.append((job, task))
        else:
            ended(_row(job, future))
            future.release()
    return lost


def _wait_for_scheduler(client) -> None:
    """Until a restarted scheduler has a worker again; the client itself gives up after its own time-out."""
    while True:
        try:
            return client.wait_for_workers(1, timeout=5)
        except OSError:
            if client.status == "closed":
                raise


def _row(job, future) -> Row:
    if future.status != "finished":
        return Row(job, error=str(future.exception()))
    answer = future.result()
    if answer.get("error"):
        return Row(job, error=answer["error"])
    if answer["files"]:
        store(job, answer["files"])
    return Row(job, answer["finished"])


COLUMNS = ["drawing", "storey", "seed", "state", "options", "degree", "depth", "entropy", "evaluations", "seconds", "digest"]


def table(rows: list[Row]) -> list[list[str]]:
    """One line a job; gains of the first option over the present layout in per cent."""

    def gain(finished, name):
        before, after = (finished.get("initial") or {}).get(name), (finished.get("best") or {}).get(name)
        return f"{100 * (after - before) / abs(before):+.2f} %" if before and after is not None else ""

    def line(row):
        f = row.finished
        settings = row.job.get("settings", {})
        state = row.error or ("done" if f.get("exit_code") == DONE else "done, something left out")
        start = [Path(row.job["drawing"]).name, settings.get("storey") or "", settings.get("seed", 0), state]
        gains = [gain(f, name) for name in ("degree", "depth", "entropy")]
        end = [f.get("evaluations", ""), f"{f['seconds']:.1f}" if f else "", f.get("digest", "")]
        return [str(v) for v in [*start, f.get("options", ""), *gains, *end]]

    return [line(row) for row in rows]


def plain(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula; signed numbers stay numbers."""
    is_number = cell.lstrip("+-").rstrip(" %").replace(".", "", 1).isdigit()
    return f"'{cell}" if cell[:1] in ("=", "+", "-", "@", "\t", "\r") and not is_number else cell


def write_summary(rows: list[Row], folder: str | os.PathLike) -> None:
    """`summary.csv` and `summary.html` over all jobs."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    lines = table(rows)
    with open(folder / "summary.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([COLUMNS, *([plain(c) for c in line] for line in lines)])

    def cells(line, tag):
        return "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in line)

    def linked(row, line):
        name = html.escape(line[0])
        if row.finished:
            name = f'<a href="{row.job["id"]}/result/report.html">{name}</a>'
        return f"<tr><td>{name}</td>{cells(line[1:], 'td')}</tr>"

    body = "\n".join(linked(row, line) for row, line in zip(rows, lines))
    done = sum(bool(row.finished) for row in rows)
    (folder / "summary.html").write_text(
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>Enfilade: all jobs</title>'
        "<style>:root{color-scheme:light dark;font-family:system-ui}td,th{padding:.2em .6em;text-align:left}</style>"
        f"<h1>{done} of {len(rows)} jobs done</h1><table><tr>{cells(COLUMNS, 'th')}</tr>\n{body}\n</table></html>\n",
        encoding="utf-8",
    )


def digest_of(rows: list[Row]) -> str:
    """One hash over all results, equal for any number of workers."""
    text = "\n".join(sorted(f"{row.job['id']} {row.finished.get('digest', 'none')}" for row in rows))
    return hashlib.sha256(text.encode()).hexdigest()


def merge(listed: str | os.PathLike, program: str, options: list[str]) -> int:
    """`enfilade merge` on this machine, what it says included; its exit code."""
    try:
        return subprocess.run([program, "merge", os.fspath(listed), *options]).returncode
    except OSError as error:
        print(f"enfilade_dask: {program}: {error}; all parts are done, and none is merged", file=sys.stderr)
        return ENVIRONMENT


def joined(listed: str | os.PathLike, program: str) -> list[dict]:
    """The jobs of `enfilade join`: each begins with what the searches of one drawing found. `ValueError` with its words."""
    try:
        ended = subprocess.run([program, "join", os.fspath(listed)], capture_output=True, text=True, encoding="utf-8")
    except OSError as error:
        raise ValueError(f"{program}: {error}") from error
    if ended.returncode:
        raise ValueError(ended.stderr.strip())
    return [json.loads(line) for line in ended.stdout.splitlines()]


def reach(address: str, secs: float) -> None:
    """Returns once the scheduler takes calls. `OSError` where it does not in that time, `ValueError` for no address."""
    from distributed.comm import get_address_host_port

    end = time.monotonic() + secs
    host, port = get_address_host_port(address)
    while True:
        try:
            return socket.create_connection((host, port), timeout=max(0.1, end - time.monotonic())).close()
        except OSError:
            if time.monotonic() + 0.5 >= end:
                raise
            time.sleep(0.5)


def _refused(text: str) -> int:
    print(f"enfilade_dask: {text}; nothing was done", file=sys.stderr)
    return BAD_INPUT


def _client(args):
    import dask
    from distributed import Client, LocalCluster
    from distributed.security import Security

    # A scheduler may be restarted: the client looks for it this long.
    dask.config.set({"distributed.comm.timeouts.connect": "300s"})
    if not args.scheduler:
        n_workers = args.workers or os.cpu_count() or 1
        return Client(LocalCluster(n_workers=n_workers, threads_per_worker=1, dashboard_address=None))
    security = None
    if args.tls_ca:
        security = Security(
            tls_ca_file=args.tls_ca, tls_client_cert=args.tls_cert, tls_client_key=args.tls_key, require_encryption=True
        )
    return Client(args.scheduler, security=security)


def threads_of(args) -> int | None:
    """Threads a job: as asked; workers of this machine share its cores, others know their own."""
    if args.threads or args.scheduler:
        return args.threads
    cores = os.cpu_count() or 1
    return max(1, cores // (args.workers or cores))


def resources_of(texts: list[str]) -> dict[str, float] | None:
    """What workers must offer, by `--resource NAME=N`. `ValueError` with a sentence where a text says no such thing."""
    resources = {}
    for text in texts:
        name, _, number = text.partition("=")
        try:
            amount = float(number)
        except ValueError:
            amount = math.nan
        if not name.strip() or not 0 < amount < math.inf:
            raise ValueError(f"--resource {text}: expected NAME=N with a number above 0, such as GPU=1")
        resources[name.strip()] = amount
    return resources or None


def _wrong_number(args) -> str | None:
    """Which option has a number that makes no sense."""
    for name, least in (("workers", 1), ("threads", 1), ("retries", 0)):
        found = getattr(args, name)
        if found is not None and found < least:
            return f"--{name} {found}: expected {least} or more"
    return None


def main(argv: list[str] | None = None) -> int:
    """The command: `python -m enfilade_dask jobs.jsonl --scheduler tcp://…`."""
    what = "Does the jobs of `enfilade jobs` with Dask, or the parts of `enfilade parts`, which it merges."
    after = "After --: options of `enfilade merge`, such as -- --cells cells.csv"
    parser = argparse.ArgumentParser(prog="enfilade_dask", description=what, epilog=after)
    parser.add_argument("jobs", help="the file that `enfilade jobs … -o` or `enfilade parts … -o` wrote")
    parser.add_argument("--scheduler", help="tcp://HOST:PORT or tls://HOST:PORT; workers on this machine without it")
    parser.add_argument("--join", action="store_true", help="at last one search more, which begins with what all found")
    parser.add_argument("--workers", type=int, default=None, help="how many, on this machine; one a core without it")
    parser.add_argument("--program", default="enfilade", help="the program on the workers")
    parser.add_argument("--no-share", action="store_true", help="machines share no folder: bytes travel with the jobs")
    parser.add_argument("--threads", type=int, default=None, help="threads a job; workers on this machine share its cores")
    parser.add_argument("--resource", action="append", default=[], metavar="NAME=N", help="what a worker must offer")
    parser.add_argument("--retries", type=int, default=RETRIES, help=f"how often a job is tried again; {RETRIES} without it")
    parser.add_argument("--tls-ca"), parser.add_argument("--tls-cert"), parser.add_argument("--tls-key")
    argv = sys.argv[1:] if argv is None else list(argv)
    end = argv.index("--") if "--" in argv else len(argv)
    args, merging = parser.parse_args(argv[:end]), argv[end + 1 :]
    try:
        jobs = read_jobs(args.jobs)
    except (OSError, ValueError) as error:
        return _refused(f"{args.jobs} cannot be read as a list of jobs: {error}")
    if not jobs:
        return _refused(f"{args.jobs} has no job in it, expected one a line, as `enfilade jobs` writes them")
    if args.join and are_parts(jobs):
        return _refused("--join: parts of an analysis are merged, searches are joined")
    wrong = _wrong_number(args) or (merging and not are_parts(jobs) and f"{merging[0]}: these jobs are not merged")
    if wrong:
        return _refused(wrong)
    try:
        resources = resources_of(args.resource)
    except ValueError as error:
        return _refused(str(error))
    if args.scheduler:
        try:
            reach(args.scheduler, SCHEDULER_SECS)
        except (OSError, ValueError) as error:
            return _refused(f"no scheduler takes calls at {args.scheduler} within {SCHEDULER_SECS} s: {error}")

    def show(row, n, total):
        words = row.error or row.finished.get("words", "")
        print(f"{n}/{total} {Path(row.job['drawing']).name}: {words}", file=sys.stderr, flush=True)

    with _client(args) as client:

        def done(jobs):
            return run(
                client, jobs, program=args.program, share=not args.no_share, threads=threads_of(args),
                resources=resources, retries=args.retries, on_row=show,
            )

        rows = done(jobs)
        not_joined = args.join and not all(row.finished for row in rows) and "some searches are not done"
        if args.join and not not_joined:
            try:
                rows += done(joined(args.jobs, args.program))
            except ValueError as error:
                not_joined = str(error)
    if are_parts(jobs):
        if all(row.finished for row in rows):
            return merge(args.jobs, args.program, merging)
        left = sum(not row.finished for row in rows)
        print(f"enfilade_dask: {left} of {len(rows)} parts are not done; the same command does what is left", file=sys.stderr)
        return LEFT_OUT
    write_summary(rows, jobs[0]["out"])
    print(Path(jobs[0]["out"]) / "summary.html")
    print(digest_of(rows))
    if not_joined:
        print(f"enfilade_dask: nothing was joined: {not_joined}", file=sys.stderr)
    return DONE if all(row.finished for row in rows) and not not_joined else LEFT_OUT


if __name__ == "__main__":
    sys.exit(main())
