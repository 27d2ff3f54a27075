"""judge_openings.py ENFILADE PLANS [--json OUT]: doors and windows that `check --json` finds, against openings.json of draw_plans.py vary and hard.

Found: its middle lies within half the width of the true one, or 0.25 m. Prints for each kind: true ones, found as such, found as
something else, missed, and found where none is. A wrong unit is a miss of all. Two processes at a time.
"""
import glob, json, math, os, subprocess, sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

def judge(exe, folder):
    true = json.load(open(f"{folder}/openings.json"))
    unit = json.load(open(f"{folder}/plan.json"))["unit_m"]
    run = subprocess.run(["timeout", "120", exe, "check", f"{folder}/plan.dxf", "--json"], capture_output=True, text=True)
    try: said = json.loads(run.stdout)
    except ValueError: return {"folder": folder, "counts": Counter({(t["kind"], "missed"): 1 for t in true}), "confidence": None, "lost": [t["kind"] for t in true]}
    found = said["reading"]["openings"]
    counts, taken, lost = Counter(), set(), []
    for t in true:
        reach = max(t["width_m"] / 2, .25)
        near = [(math.dist(o["at"], t["at"]) * unit, i) for i, o in enumerate(found) if math.dist(o["at"], t["at"]) * unit <= reach]
        own = [n for n in near if found[n[1]]["kind"] == t["kind"]]
        counts[t["kind"], "true"] += 1
        best = min(own or near, default=None)
        taken.update(i for _, i in near)
        if own: counts[t["kind"], "right"] += 1
        elif near: counts[t["kind"], "as " + found[best[1]]["kind"]] += 1
        else: counts[t["kind"], "missed"] += 1
        if not own: lost.append((t["kind"], [round(v, 3) for v in t["at"]], found[best[1]]["kind"] if best else None))
    false = [(o["kind"], [round(v, 3) for v in o["at"]], o.get("width_m")) for i, o in enumerate(found) if i not in taken]
    for o in false: counts[o[0], "false"] += 1
    sure = said["reading"].get("sure"), said["reading"].get("confidence")
    return {"folder": os.path.basename(folder), "counts": counts, "sure": sure, "lost": lost, "false": false}

def main(exe, plans, out=None):
    folders = sorted(os.path.dirname(f) for f in glob.glob(f"{plans}/*/openings.json"))
    with ThreadPoolExecutor(2) as pool: rows = list(pool.map(lambda f: judge(exe, f), folders))
    total = sum((r["counts"] for r in rows), Counter())
    for kind in ("door", "window", "passage"):
        print(kind, {what: n for (k, what), n in sorted(total.items()) if k == kind})
    good = lambda c: sum(c[k, "right"] for k in ("door", "window")) >= .9 * sum(c[k, "true"] for k in ("door", "window")) and c["door", "false"] + c["window", "false"] <= .1 * sum(c[k, "true"] for k in ("door", "window"))
    print("drawings", len(rows), "with nine of ten right and few false:", sum(good(r["counts"]) for r in rows))
    if out: json.dump([{**r, "counts": {" ".join(k): n for k, n in r["counts"].items()}} for r in rows], open(out, "w"), indent=0)

if __name__ == "__main__":
    args = sys.argv[1:]; out = None
    if "--json" in args: i = args.index("--json"); out = args[i + 1]; del args[i:i + 2]
    if len(args) != 2: sys.exit(__doc__)
    main(*args, out)
