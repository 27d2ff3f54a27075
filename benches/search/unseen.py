"""Other optimisers against `run` on two plans that nothing was tuned on: the best found, and how different the options are to
the people in them.

    pip install cma ribs pymoo
    cargo bench --bench search --no-run        # prints the path of BENCH
    python benches/search/unseen.py ENFILADE BENCH [--seeds 10] [--evaluations 1000]

All look for more to see and fewer steps (`degree +1, mean-depth -1`, each relative to the present layout), measured as the mean of
four shifted lattices by the same engine. `run` gets 70 % of the evaluations: the rest is about what it measures besides, on
searches without the moves that hide others and to take back moves that bring nothing. The others spend all on the search;
their options are five of the points they evaluated, far apart in their parameters. An option of any method has at least
half of the best score that any of them found in the plan. Difference of options: 1 − median correlation, over all pairs,
of the maps of what is seen more or less than at present; 0 for a single one.
"""

import argparse
import itertools
import json
import pathlib
import statistics
import subprocess
import tempfile
import warnings

import numpy as np

import peers

BAR = 0.5
SHARE_OF_RUN = 0.7
PEERS = ["pycma", "CMA-ME", "CMA-MAE", "NSGA-II", "NicheGA"]

# Outline, walls, and what moves: a line with what it may do.
STUDIO = (
    (22.0, 13.0),
    [(7, 0, 7, 4), (7, 5.2, 7, 13), (15, 0, 15, 7.6), (15, 8.8, 15, 13), (15, 6, 22, 6)],
    [
        ((1.5, 6.0, 4.5, 6.0), "x -1 1.5; y -2 2; rotate -60 60"),
        ((3.2, 8.8, 3.2, 11.4), "x -1.5 1.5; y -1 1; rotate -45 45"),
        ((8.6, 3.0, 12.6, 3.0), "x -1 1.5; y -1.5 1.5; rotate -30 30"),
        ((10.5, 6.2, 10.5, 9.4), "x -1.5 2; y -1.5 1.5; rotate -90 90"),
        ((12.2, 11.0, 14.2, 11.0), "x -2 0.5; y -1 1"),
        ((17.0, 2.5, 20.0, 2.5), "x -1 1; y -1 1; rotate -40 40"),
        ((18.6, 8.0, 18.6, 11.0), "x -1.5 1.5; y -0.8 0.8"),
    ],
)
WARD = (
    (34.0, 18.0),
    [
        (0, 7.6, 5, 7.6), (6.2, 7.6, 13, 7.6), (14.2, 7.6, 22, 7.6), (23.2, 7.6, 34, 7.6), (9, 0, 9, 7.6),
        (18, 0, 18, 7.6), (27, 0, 27, 7.6), (12, 10.4, 12, 18), (24, 10.4, 24, 18), (0, 10.4, 4, 10.4),
        (5.4, 10.4, 15, 10.4), (16.4, 10.4, 27, 10.4), (28.4, 10.4, 34, 10.4),
    ],
    [
        ((2.5, 3.6, 6.0, 3.6), "x -1 1.5; y -1.5 1.5; rotate -60 60"),
        ((11.0, 3.8, 15.0, 3.8), "x -1 1.5; y -1.5 1.5; rotate -60 60"),
        ((20.0, 3.4, 24.5, 3.4), "x -1 1.5; y -1.5 1.5; rotate -60 60"),
        ((29.0, 3.6, 32.0, 3.6), "x -1 1; y -1.5 1.5; rotate -60 60"),
        ((3.0, 14.0, 7.5, 14.0), "x -1.5 2; y -1.5 1.5; rotate -60 60"),
        ((9.8, 12.0, 9.8, 16.0), "x -1.5 1; y -0.8 0.8; rotate -30 30"),
        ((14.0, 14.0, 18.0, 14.0), "x -1 2; y -1.5 1.5; rotate -60 60"),
        ((20.5, 12.4, 20.5, 16.0), "x -1 1.5; y -0.8 0.8; rotate -30 30"),
        ((26.0, 14.2, 30.0, 14.2), "x -1 1.5; y -1.5 1.5; rotate -60 60"),
        ((31.6, 12.6, 31.6, 16.0), "y -1 1"),
    ],
)
PLANS = {"studio": STUDIO, "ward": WARD}


def drawing(plan):
    """A plan as DXF: walls as lines, a box on EF-MOVE round what moves."""
    (w, h), walls, movers = plan
    outline = [(0, 0, w, 0), (w, 0, w, h), (w, h, 0, h), (0, h, 0, 0)]
    out = ["0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"]
    line = lambda layer, a: f"0\nLINE\n8\n{layer}\n10\n{a[0]}\n20\n{a[1]}\n11\n{a[2]}\n21\n{a[3]}\n"
    out += [line("A-WALL", a) for a in outline + walls + [m[0] for m in movers]]
    for k, ((x0, y0, x1, y1), clauses) in enumerate(movers):
        box = [(x0 - 0.3, y0 - 0.3), (x1 + 0.3, y0 - 0.3), (x1 + 0.3, y1 + 0.3), (x0 - 0.3, y1 + 0.3)]
        out.append("0\nPOLYLINE\n8\nEF-MOVE\n66\n1\n70\n1\n")
        out += [f"0\nVERTEX\n8\nEF-MOVE\n10\n{x}\n20\n{y}\n" for x, y in box] + ["0\nSEQEND\n"]
        text = f"name screen-{k + 1}; {clauses}"
        out.append(f"0\nTEXT\n8\nEF-MOVE\n10\n{x0 - 0.2}\n20\n{y0 - 0.2}\n40\n0.2\n1\n{text}\n")
    return "".join(out + ["0\nENDSEC\n0\nEOF\n"])


def by_ea(asked, seed):
    """A plain (1+1)-EA: every parameter disturbed, the step by the rule of one success in five."""
    rng = np.random.default_rng(seed)
    best, sigma = asked.start, 0.15
    cost = asked.costs([best])[0]
    while not asked.is_spent():
        child = np.clip(best + sigma * rng.standard_normal(len(best)), 0.0, 1.0)
        now = asked.costs([child])[0]
        if now <= cost:
            best, cost, sigma = child, now, sigma * 1.5
        else:
            sigma = max(sigma * 1.5**-0.25, 1e-3)


def maps(asked, points):
    asked.process.stdin.write(json.dumps({"maps": [list(map(float, p)) for p in points]}) + "\n")
    asked.process.stdin.flush()
    return np.array(json.loads(asked.process.stdout.readline()), float)


def difference(asked, points, present):
    if len(points) < 2:
        return 0.0
    changes = maps(asked, points) - present
    def correlation(a, b):
        both = np.isfinite(a) & np.isfinite(b)
        a, b = a[both], b[both]
        return np.corrcoef(a, b)[0, 1] if a.std() > 0 and b.std() > 0 else 0.0
    return 1.0 - statistics.median(correlation(a, b) for a, b in itertools.combinations(changes, 2))


def ours(program, path, asked, seed, evaluations):
    """The best found, and the options with their scores."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", path, "--out", folder, "--quiet", "--json", "-", "--seed", str(seed)]
        command += ["--objective", f"score max {BAR}", "--score", "degree +1, mean-depth -1", "--penalty", "none"]
        command += ["--evaluations", str(int(evaluations * SHARE_OF_RUN))]
        result = json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout)
    layouts = [c["parameters"] for c in result["candidates"] + [result["best"]]]
    units = (np.array(layouts) - asked.bounds[:, 0]) / asked.width
    asked.forget(100)
    scores = np.array([peers.worth(t) for t in asked.measure(units)])
    return scores.max(), lambda bar: units[:-1][scores[:-1] >= bar]


def theirs(asked):
    units = np.array(asked.units)
    scores, violations = peers.number([t[0] for t in asked.told]), peers.number([t[1] for t in asked.told])
    feasible = (violations <= 0.0) & np.isfinite(scores)
    best = scores[feasible].max() if feasible.any() else float("nan")
    return best, lambda bar: units[peers.choose(units, scores, feasible & (scores >= bar))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("enfilade")
    parser.add_argument("bench")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--evaluations", type=int, default=1000)
    options = parser.parse_args()
    warnings.filterwarnings("ignore")
    methods = {"(1+1)-EA": by_ea} | {name: peers.PEERS[name] for name in PEERS}
    print("| plan | method | best score | options | difference |\n|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name, plan in PLANS.items():
            path = pathlib.Path(folder) / f"{name}.dxf"
            path.write_text(drawing(plan), encoding="ascii")
            asked = peers.Drawing(options.bench, str(path))
            asked.signs = [-1, 1, -1, 1]
            present = maps(asked, [asked.bounds[:, 0] + asked.start * asked.width])[0]
            seeds = range(1, options.seeds + 1)
            rows = {"run": [ours(options.enfilade, path, asked, seed, options.evaluations) for seed in seeds]}
            for method, search in methods.items():
                rows[method] = []
                for seed in seeds:
                    asked.forget(options.evaluations)
                    search(asked, seed)
                    rows[method].append(theirs(asked))
            bar = BAR * max(best for runs in rows.values() for best, _ in runs)
            for method, runs in rows.items():
                chosen = [of(bar) for _, of in runs]
                differences = [difference(asked, asked.bounds[:, 0] + c * asked.width, present) for c in chosen]
                spread = lambda v: f"{statistics.median(v):.3f} [{min(v):.3f}, {max(v):.3f}]"
                count = statistics.median(len(c) for c in chosen)
                best = spread([best for best, _ in runs])
                print(f"| {name}, {len(asked.start)} parameters | {method} | {best} | {count:g} | {spread(differences)} |", flush=True)


if __name__ == "__main__":
    main()
