"""Other optimisers on the same drawings and budgets as the program's own search.

    pip install cma ribs pymoo
    cargo bench --bench search --no-run        # prints the path of the program
    python benches/search/peers.py PROGRAM [--problem NAME,...] [--evaluations 700,2000] [--seeds 5]

Every method spends the same evaluations of the same measurement (the program with `--serve`). What each returns
is chosen in one way for all: of the points it has evaluated that keep the hard limits and score at least 0.7 of
its own best, five by greedy max-min distance from the best and exchanges as long as they help. "ours" is the
default method with the options that it returns itself; "ours, chosen" is its archive chosen from like the others.
"""

import argparse
import json
import statistics
import subprocess
import sys
import warnings

import numpy as np

MEMBERS = 5
THRESHOLD = 0.7
SIGMA = 0.3
POPULATION = 50
WORST = 1e3


class Drawing:
    """A problem of the bench, measured by the program; remembers everything asked, up to a budget."""

    def __init__(self, program, name):
        command = [program, "--problem", name, "--serve"]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        head = json.loads(self.process.stdout.readline())
        self.bounds = np.array(head["bounds"], float)
        self.width = self.bounds[:, 1] - self.bounds[:, 0]
        self.start = (np.array(head["start"]) - self.bounds[:, 0]) / self.width
        self.forget(0)

    def forget(self, budget):
        self.budget, self.units, self.told = budget, [], []

    def is_spent(self):
        return len(self.units) >= self.budget

    def measure(self, units):
        """[score, violation, parts] of points of the unit cube; those beyond the budget are worth nothing."""
        units = np.clip(np.asarray(units, float), 0.0, 1.0)
        left = self.budget - len(self.units)
        now = units[:left]
        told = []
        if len(now):
            asked = (self.bounds[:, 0] + now * self.width).tolist()
            self.process.stdin.write(json.dumps(asked) + "\n")
            self.process.stdin.flush()
            told = json.loads(self.process.stdout.readline())
        self.units += list(now)
        self.told += told
        return told + [[-WORST, 1.0, [0.0] * 4]] * (len(units) - len(now))

    def costs(self, units):
        return [-worth(t) for t in self.measure(units)]


def worth(told):
    """The score; where a hard limit is broken, far below any score and falling with the violation."""
    score, violation = told[0], told[1]
    if score is None or violation is None:
        return -WORST
    return score if violation <= 0.0 else -WORST * (0.1 + min(violation, 0.9))


def by_cma(drawing, seed):
    import cma

    population, run = None, 0
    while not drawing.is_spent():
        options = {"bounds": [0, 1], "seed": 1000 * seed + run + 1, "verbose": -9}
        if population:
            options["popsize"] = population
        rng = np.random.default_rng(1000 * seed + run)
        start = drawing.start if run == 0 else rng.random(len(drawing.start))
        search = cma.CMAEvolutionStrategy(np.clip(start, 0.02, 0.98), SIGMA, options)
        while not drawing.is_spent() and not search.stop():
            asked = search.ask()
            search.tell(asked, drawing.costs(asked))
        population, run = 2 * search.popsize, run + 1


def by_ribs(drawing, seed, ranker, learning_rate):
    """Measures: the means of two halves of the parameters, 20 by 20 cells."""
    from ribs.archives import GridArchive
    from ribs.emitters import EvolutionStrategyEmitter
    from ribs.schedulers import Scheduler

    dims = len(drawing.start)
    start = np.array([drawing.start])
    at_start = worth(drawing.measure(start)[0])
    settings = {"solution_dim": dims, "dims": [20, 20], "ranges": [(0.1, 0.9)] * 2, "seed": seed}
    if learning_rate is not None:
        settings |= {"learning_rate": learning_rate, "threshold_min": min(0.0, at_start) - 1e-6}
    archive = GridArchive(**settings)
    # An emitter that starts anew takes an elite: where nothing else is stored yet, the present layout.
    archive.add(start, np.array([at_start]), halves(start))
    bounds = [(0.0, 1.0)] * dims
    emitters = [
        EvolutionStrategyEmitter(
            archive, x0=drawing.start, sigma0=SIGMA, ranker=ranker, bounds=bounds, batch_size=10, seed=10 * seed + k
        )
        for k in range(3)
    ]
    scheduler = Scheduler(archive, emitters)
    while not drawing.is_spent():
        asked = scheduler.ask()
        objective = np.array([worth(t) for t in drawing.measure(asked)])
        scheduler.tell(objective, halves(asked))


def halves(units):
    return np.stack([units[:, ::2].mean(1), units[:, 1::2].mean(1)], 1)


def by_cma_me(drawing, seed):
    by_ribs(drawing, seed, "2imp", None)


def by_cma_mae(drawing, seed):
    by_ribs(drawing, seed, "imp", 0.01)


def pymoo_problem(drawing, outputs, parts):
    from pymoo.core.problem import Problem

    class OnDrawing(Problem):
        def __init__(self):
            super().__init__(n_var=len(drawing.start), n_obj=outputs, n_ieq_constr=1, xl=0.0, xu=1.0)

        def _evaluate(self, x, out, *_, **__):
            told = drawing.measure(x)
            out["F"] = np.array([parts(t) for t in told])
            out["G"] = np.array([[t[1] if t[1] is not None else WORST] for t in told])

    return OnDrawing()


def by_pymoo(drawing, seed, algorithm, outputs, parts):
    from pymoo.optimize import minimize

    problem = pymoo_problem(drawing, outputs, parts)
    minimize(problem, algorithm, ("n_eval", drawing.budget), seed=seed, verbose=False)


def by_nsga2(drawing, seed):
    """The measures and the penalty as objectives of their own."""
    from pymoo.algorithms.moo.nsga2 import NSGA2

    signs = drawing.signs
    parts = lambda t: [s * v for s, v in zip(signs, t[2])]
    by_pymoo(drawing, seed, NSGA2(pop_size=POPULATION), 4, parts)


def by_niche_ga(drawing, seed):
    """A genetic algorithm with clearing, which keeps distant solutions."""
    from pymoo.algorithms.soo.nonconvex.ga_niching import NicheGA

    by_pymoo(drawing, seed, NicheGA(pop_size=POPULATION), 1, lambda t: [-t[0] if t[0] is not None else WORST])


PEERS = {
    "pycma": by_cma,
    "CMA-ME": by_cma_me,
    "CMA-MAE": by_cma_mae,
    "NSGA-II": by_nsga2,
    "NicheGA": by_niche_ga,
}


def distances(units, to):
    return np.sqrt(((units - to) ** 2).sum(1))


def smallest(units):
    pairs = [(np.linalg.norm(a - b), i, j) for i, a in enumerate(units) for j, b in enumerate(units[:i])]
    return min(pairs, default=(0.0, 0, 0))


def choose(units, scores, feasible):
    """Indices of up to five points far apart among those good enough; the first is the best."""
    if not feasible.any():
        return []
    best = np.flatnonzero(feasible)[np.argmax(scores[feasible])]
    pool = np.flatnonzero(feasible & (scores >= THRESHOLD * scores[best]))
    chosen, near = [best], distances(units[pool], units[best])
    while len(chosen) < MEMBERS and len(pool) and near.max() > 0:
        chosen.append(pool[np.argmax(near)])
        near = np.minimum(near, distances(units[pool], units[chosen[-1]]))
    if len(chosen) < 2:
        return chosen
    for _ in range(100):
        least, *pair = smallest(units[chosen])
        gains = []
        for m in pair:
            others = [c for k, c in enumerate(chosen) if k != m]
            near = np.min([distances(units[pool], units[c]) for c in others], axis=0)
            gains.append((near.max(), m, pool[np.argmax(near)]))
        reach, m, candidate = max(gains)
        if reach <= least + 1e-12:
            break
        chosen[m] = candidate
    return chosen


def figures(units, scores, violations, members=None):
    """Best score, options, smallest distance, mean score of the options."""
    units, scores = np.asarray(units, float), np.asarray(scores, float)
    feasible = (np.asarray(violations, float) <= 0.0) & np.isfinite(scores)
    if not feasible.any():
        return [float("nan"), 0, 0.0, float("nan")]
    best = scores[feasible].max()
    if members is None:
        chosen = choose(units, scores, feasible)
        members = units[chosen], scores[chosen]
    inside = sum(s >= THRESHOLD * best for s in members[1])
    return [best, inside, smallest(members[0])[0], float(np.mean(members[1]))]


def own_runs(program, name, evaluations, seeds, paper):
    command = [program, "--problem", name, "--evaluations", str(evaluations), "--seeds", str(seeds), "--batch", "2"]
    command += ["--points"] + (["--paper"] if paper else [])
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return [json.loads(line) for line in out.splitlines() if line.startswith("{")]


def number(values):
    return np.array([np.nan if v is None else v for v in values], float)


def own_figures(run, own):
    bounds = np.array(run["bounds"], float)
    unit = lambda rows: (np.array([r[0] for r in rows]) - bounds[:, 0]) / (bounds[:, 1] - bounds[:, 0])
    rows, members = run["points"], run["members"]
    given = (unit(members), number([m[1] for m in members])) if own and members else None
    return figures(unit(rows), number([r[1] for r in rows]), number([r[2] for r in rows]), given)


def row(name, evaluations, method, runs):
    columns = list(zip(*runs))
    spread = lambda v: f"{statistics.median(v):.3f} [{min(v):.3f}, {max(v):.3f}]"
    full = f"{sum(i >= MEMBERS for i in columns[1])} of {len(runs)}"
    print(
        f"| {name} | {evaluations} | {method} | {spread(columns[0])} | {full} | {spread(columns[2])} "
        f"| {statistics.median(columns[3]):.3f} |",
        flush=True,
    )


def compare(program, name, budgets, seeds, peers):
    drawing = Drawing(program, name)
    drawing.signs = [-1, 1, 1 if name == "maze_a" else -1, 1]
    for budget in budgets:
        runs = own_runs(program, name, budget, seeds, False)
        row(name, budget, "ours", [own_figures(r, True) for r in runs])
        row(name, budget, "ours, chosen", [own_figures(r, False) for r in runs])
        paper = own_runs(program, name, budget, seeds, True)
        row(name, budget, "paper", [own_figures(r, True) for r in paper])
        row(name, budget, "paper, chosen", [own_figures(r, False) for r in paper])
    for peer in peers:
        found = {budget: [] for budget in budgets}
        for seed in range(1, seeds + 1):
            drawing.forget(max(budgets))
            PEERS[peer](drawing, seed)
            for budget in budgets:
                told = drawing.told[:budget]
                scores, violations = number([t[0] for t in told]), number([t[1] for t in told])
                found[budget].append(figures(drawing.units[:budget], scores, violations))
        for budget in budgets:
            row(name, budget, peer, found[budget])


def cma_alone(seeds):
    """Evaluations pycma needs to 1e-8 in 10 dimensions from 2 with sigma 0.5; `--cma` of the bench is the other side."""
    import cma

    functions = {
        "rosenbrock": lambda x: sum(100 * (b - a * a) ** 2 + (1 - a) ** 2 for a, b in zip(x, x[1:])),
        "ellipsoid": lambda x: sum(1e6 ** (i / (len(x) - 1)) * v * v for i, v in enumerate(x)),
    }
    for name, function in functions.items():
        counts = []
        for seed in range(1, seeds + 1):
            search, count, arrived = cma.CMAEvolutionStrategy([2.0] * 10, 0.5, {"seed": seed, "verbose": -9}), 0, False
            while not arrived and not search.stop():
                asked = search.ask()
                costs = [function(x) for x in asked]
                search.tell(asked, costs)
                hit = next((k for k, c in enumerate(costs) if c < 1e-8), None)
                arrived = hit is not None
                count += len(costs) if hit is None else hit + 1
            counts.append(count)
        print(f"{name:10} {statistics.median(counts):.0f} [{min(counts)}, {max(counts)}]")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", nargs="?")
    parser.add_argument("--cma", action="store_true", help="CMA-ES alone on two standard functions")
    parser.add_argument("--problem", default="maze_a,simple_room,large_room,art_gallery,gallery,library")
    parser.add_argument("--evaluations", default="700,2000")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--peers", default=",".join(PEERS))
    options = parser.parse_args()
    warnings.filterwarnings("ignore")
    if options.cma:
        return cma_alone(options.seeds)
    print("| study | evaluations | method | best score | five inside 0.7 of it | smallest distance | mean score |")
    print("|---|---|---|---|---|---|---|", flush=True)
    budgets = [int(e) for e in options.evaluations.split(",")]
    for name in options.problem.split(","):
        compare(options.program, name, budgets, options.seeds, [p for p in options.peers.split(",") if p])


if __name__ == "__main__":
    sys.exit(main())
