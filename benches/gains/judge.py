#!/usr/bin/env python3
"""Do claimed gains hold? Measures every option again, on lattices that the run has not used.

usage: judge.py ENFILADE DRAWING... [--seeds 3] [--evaluations N] [--rows OUT.csv]

Each drawing is run with each seed. Every option and the best layout are then measured by `analyse` on the files that were
written, and so is the drawing: on two lattices of the spacing used and on two of half of it, at centres drawn anew. A
claim holds if the mean gain over the four lies in its interval; its sign is right if an interval that excludes 0 lies on
the side of that mean. Needs Python alone.
"""

import argparse
import csv
import json
import pathlib
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor


def run(exe, *args):
    done = subprocess.run([exe, *map(str, args)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{args}: {done.stderr.strip()[-300:]}")
    return done.stdout


def measured(exe, drawing, settings, lattice, out):
    """Means of a drawing on one lattice."""
    spacing, centre = lattice
    args = ["analyse", drawing, "--spacing", spacing, f"--lattice-centre={centre[0]},{centre[1]}"]
    text = run(exe, *args, *settings, "--out", out, "--quiet", "--json", "-")
    return json.loads(text)["mean"]


def judge(exe, drawing, seed, evaluations, extra):
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        args = ["run", drawing, "--seed", seed, "--out", folder, "--quiet", "--json", "-", *extra]
        if evaluations:
            args += ["--evaluations", evaluations]
        result = json.loads(run(exe, *args))
        spacing = result["spacing_m"]
        rng = random.Random(f"{pathlib.Path(drawing).name} {seed}")
        lattices = []
        for s in (spacing, spacing, spacing / 2, spacing / 2):
            lattices.append((s, (round(rng.uniform(0, s), 6), round(rng.uniform(0, s), 6))))
        settings = ["--unit", result["input"]["unit"]]
        present = [measured(exe, drawing, settings, l, folder / "again") for l in lattices]
        made = next(folder.glob("*.enfilade/round-01"))
        options = [(f"option {i}", c) for i, c in enumerate(result["candidates"], 1)]
        options += [("best", b) for b in [result.get("best")] if b and b.get("file")]
        for name, option in options:
            now = [measured(exe, made / option["file"], settings, l, folder / "again") for l in lattices]
            for key, gain in option.get("gain", {}).items():
                sign = 1 if gain["sense"] == "max" else -1
                found = [sign * (n[key] - p[key]) / (abs(p[key]) or 1) for n, p in zip(now, present) if key in n and key in p]
                if len(found) < 4:
                    continue
                rows.append({
                    "drawing": pathlib.Path(drawing).name, "seed": seed, "option": name, "measure": key,
                    "share": gain["share"], "low": gain["low"], "high": gain["high"],
                    "found": sum(found) / 4, **{f"found_{i}": f for i, f in enumerate(found, 1)},
                })
        print(f"{pathlib.Path(drawing).name} seed {seed}: {len(result['candidates'])} options, {result['seconds']:.1f} s",
              file=sys.stderr, flush=True)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("exe")
    parser.add_argument("drawings", nargs="+")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--evaluations", type=int)
    parser.add_argument("--rows")
    parser.add_argument("--option", action="append", default=[], help="passed on to `run`, as --option=--view=1")
    args = parser.parse_args()
    jobs = [(d, s) for d in args.drawings for s in range(1, args.seeds + 1)]
    rows = []

    def one(job):
        try:
            return judge(args.exe, *job, args.evaluations, args.option)
        except (RuntimeError, json.JSONDecodeError, StopIteration) as error:
            print(f"{job}: {error!r}", file=sys.stderr, flush=True)
            return []

    with ThreadPoolExecutor(2) as pool:
        for found in pool.map(one, jobs):
            rows += found
    if args.rows and rows:
        with open(args.rows, "w", newline="", encoding="utf-8") as file:
            out = csv.DictWriter(file, rows[0].keys())
            out.writeheader()
            out.writerows(rows)
    print(f"{'measure':12} claims  covered  single  sign wrong  half-width")
    for key in sorted({r["measure"] for r in rows}):
        own = [r for r in rows if r["measure"] == key]
        covered = sum(r["low"] <= r["found"] <= r["high"] for r in own)
        single = sum(r["low"] <= r[f"found_{i}"] <= r["high"] for r in own for i in (1, 2, 3, 4))
        wrong = sum((r["low"] > 0 and r["found"] < 0) or (r["high"] < 0 and r["found"] > 0) for r in own)
        half = sum((r["high"] - r["low"]) / 2 for r in own) / len(own)
        print(f"{key:12} {len(own):6} {covered / len(own):8.3f} {single / len(own) / 4:7.3f} {wrong:11} {half:11.4f}")


if __name__ == "__main__":
    main()
