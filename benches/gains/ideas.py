#!/usr/bin/env python3
"""Are options ideas of their own? Correlates the maps of what changes, and counts the moves.

usage: ideas.py ENFILADE DRAWING... [--seed 1] [--option=--view=1]

Each drawing is run, then every option's file and the drawing are measured by `analyse --cells` on the lattice of the round. The
map of an option is the change of Connectivity at the cells that both have; pairs of options are told by the correlation
of their maps. Needs Python alone.
"""

import argparse
import csv
import json
import pathlib
import statistics
import subprocess
import tempfile


def run(exe, *args):
    done = subprocess.run([exe, *map(str, args)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr.strip()[-300:])
    return done.stdout


def cells(exe, drawing, result, folder):
    centre = result["lattice_centre"]
    table = folder / "cells.csv"
    run(exe, "analyse", drawing, "--unit", result["input"]["unit"], "--spacing", result["spacing_m"],
        f"--lattice-centre={centre[0]},{centre[1]}", "--cells", table, "--out", folder / "again", "--quiet")
    with open(table, encoding="utf-8") as file:
        return {(r["x"], r["y"]): float(r["Connectivity"]) for r in csv.DictReader(file) if float(r["Connectivity"]) > 0}


def correlation(a, b):
    both = [k for k in a if k in b]
    if len(both) < 3:
        return 0.0
    x, y = [a[k] for k in both], [b[k] for k in both]
    try:
        return statistics.correlation(x, y)
    except statistics.StatisticsError:
        return 0.0


def judge(exe, drawing, seed, extra):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        text = run(exe, "run", drawing, "--seed", seed, "--out", folder, "--quiet", "--json", "-", *extra)
        result = json.loads(text)
        made = next(folder.glob("*.enfilade/round-01"))
        present = cells(exe, drawing, result, folder)
        maps, moves = [], []
        for option in result["candidates"]:
            now = cells(exe, made / option["file"], result, folder)
            maps.append({k: v - present[k] for k, v in now.items() if k in present})
            still = [1.0 if m["kind"] == "scale" else 0.0 for m in result["moves"]]
            moved = {m["name"] for m, p, s in zip(result["moves"], option["parameters"], still) if p != s}
            moves.append(len(moved))
    pairs = [correlation(maps[i], maps[j]) for i in range(len(maps)) for j in range(i)]
    shown = " ".join(f"{c:.2f}" for c in sorted(pairs))
    median = f"{statistics.median(pairs):.2f}" if pairs else "–"
    print(f"{pathlib.Path(drawing).name}: {len(maps)} options, median {median} ({shown}), groups moved {moves}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("exe")
    parser.add_argument("drawings", nargs="+")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--option", action="append", default=[])
    args = parser.parse_args()
    for drawing in args.drawings:
        try:
            judge(args.exe, drawing, args.seed, args.option)
        except (RuntimeError, StopIteration) as error:
            print(f"{pathlib.Path(drawing).name}: {error!r}", flush=True)


if __name__ == "__main__":
    main()
