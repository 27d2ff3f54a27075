"""train.py DUMP... --out MODEL.txt: trains the classifier of drawn pieces (src/plan/reading) and judges it.

A DUMP is what `cargo run --example reading_features` writes: for every drawing the features of its pieces and the class
that its label says. Drawings of one author (or of one building) are named AUTHOR/DRAWING and are never parted: what is
judged was not trained on. Two passes: the second also sees what the first said of a piece's neighbours, of its entity, of
all that is drawn alike, of its layer and of its block. Names are withheld from half of the drawings in training.
"""
import argparse, struct, sys
import numpy as np
import lightgbm as lgb

CLASSES = ["wall", "window", "door", "stair", "furniture", "note", "other"]
K = len(CLASSES)
NONE = 0xFFFFFFFF


class Drawing:
    pass


def read(path):
    data = open(path, "rb").read()
    at = 0
    while at < len(data):
        d = Drawing()
        n, = struct.unpack_from("<I", data, at); at += 4
        d.name = data[at:at + n].decode(); at += n
        d.n, width = struct.unpack_from("<II", data, at); at += 8
        take = lambda kind, count: np.frombuffer(data, kind, count, at)
        d.x = take("<f4", d.n * width).reshape(d.n, width); at += 4 * d.n * width
        d.y = take("u1", d.n); at += d.n
        d.length = take("<f4", d.n); at += 4 * d.n
        for key in ("thing", "group", "layer", "block", "partner"):
            setattr(d, key, take("<u4", d.n)); at += 4 * d.n
        lists = []
        touching = []
        for i in range(d.n):
            m, = struct.unpack_from("<I", data, at); at += 4
            if m:
                touching.append(np.frombuffer(data, "<u4", m, at)); at += 4 * m
                lists.append(np.full(m, i, dtype=np.uint32))
        d.to = np.concatenate(touching) if touching else np.zeros(0, np.uint32)
        d.frm = np.concatenate(lists) if lists else np.zeros(0, np.uint32)
        yield d


def mean_by(p, key, weight):
    """Mean of p over the pieces with one key; their own where they have none."""
    has = key != NONE
    _, inverse = np.unique(key, return_inverse=True)
    top = np.zeros((inverse.max() + 1, K)); low = np.zeros(inverse.max() + 1)
    np.add.at(top, inverse, p * weight[:, None]); np.add.at(low, inverse, weight)
    return np.where(has[:, None], (top / np.maximum(low, 1e-12)[:, None])[inverse], p)


def second(d, p):
    """The features of the second pass: those of the first, and what it said of the piece and of others."""
    w = d.length.astype(np.float64)
    touch = np.zeros((d.n, K)); count = np.zeros(d.n)
    np.add.at(touch, d.frm, p[d.to]); np.add.at(count, d.frm, 1)
    touch = np.where(count[:, None] > 0, touch / np.maximum(count, 1)[:, None], p)
    partner = np.where((d.partner != NONE)[:, None], p[np.minimum(d.partner, d.n - 1)], p)
    parts = [d.x, p, mean_by(p, d.thing, w), mean_by(p, d.group, w), mean_by(p, d.layer, w), mean_by(p, d.block, w), touch, partner]
    return np.concatenate(parts, axis=1).astype(np.float32)


def weights(d):
    w = np.minimum(d.length, 4.0) + 0.15
    w = np.where(d.y == 255, 0, w)
    share = 1000.0 if not getattr(d, "heavy", False) else 3000.0
    return w * share / max(w.sum(), 1e-9)


def params(leaves, seed):
    return dict(objective="multiclass", num_class=K, num_leaves=leaves, learning_rate=0.12, min_data_in_leaf=60,
                feature_fraction=0.5, bagging_fraction=0.7, bagging_freq=1, lambda_l2=5.0, max_bin=127, verbose=-1,
                seed=seed, deterministic=True, force_row_wise=True, num_threads=2, min_sum_hessian_in_leaf=1.0)


def fit(xs, ys, ws, rounds, leaves, seed=1):
    x, y, w = np.concatenate(xs), np.concatenate(ys), np.concatenate(ws)
    keep = w > 0
    return lgb.train(params(leaves, seed), lgb.Dataset(x[keep], y[keep], weight=w[keep] * keep.sum() / w.sum()), rounds)


def without_names(d, names, rng):
    """Features of a drawing whose names may be withheld."""
    mode = rng.random()
    x = np.array(d.x)
    cols = [i for i, n in enumerate(names) if n.startswith("name_")]
    if mode < 0.45:
        x[:, cols] = 0
    elif mode < 0.6:  # half of its layers
        gone = rng.random(int(d.layer.max()) + 1) < 0.5
        x[np.ix_(gone[d.layer], cols)] = 0
    return x


def f1(d, p):
    """F1 of walls by length, entity by entity."""
    w = d.length.astype(np.float64)
    of = mean_by(p, d.thing, w).argmax(1)
    known = d.y != 255
    got, true = (of == 0) & known, (d.y == 0) & known
    hit = w[got & true].sum()
    return 2 * hit / max(w[got].sum() + w[true].sum(), 1e-9)


def author(d):
    return d.name.split("/")[0]


def table(model, f):
    """A model as text: a line a tree, nodes in pre-order; `f:t` splits (to the left up to t), `=v` leaves."""
    info = model.dump_model()
    f.write(f"trees {len(info['tree_info'])} features {model.num_feature()}\n")
    for tree in info["tree_info"]:
        out = []
        def walk(node):
            if "leaf_value" in node and "split_feature" not in node:
                out.append(f"={node['leaf_value']:.4g}")
            else:
                out.append(f"{node['split_feature']}:{np.float32(node['threshold']):.7g}")
                walk(node["left_child"]); walk(node["right_child"])
        walk(tree["tree_structure"])
        f.write(" ".join(out) + "\n")


def main():
    a = argparse.ArgumentParser(description=__doc__)
    a.add_argument("dumps", nargs="+"); a.add_argument("--out"); a.add_argument("--names", required=True)
    a.add_argument("--folds", type=int, default=4); a.add_argument("--rounds", type=int, default=60)
    a.add_argument("--leaves", type=int, default=24); a.add_argument("--judge-only-real", action="store_true")
    a.add_argument("--max", type=int, default=12000, help="most pieces of one drawing")
    o = a.parse_args()
    names = open(o.names).read().split()
    rng = np.random.default_rng(7)
    all_ = []
    for path in o.dumps:
        for d in read(path):
            d.heavy = "real" in path
            if (d.y != 255).sum() >= 4: all_.append(d)
    authors = sorted({author(d) for d in all_})
    rng.shuffle(authors)
    fold = {w: i % o.folds for i, w in enumerate(authors)}
    print(len(all_), "drawings of", len(authors), "authors,", sum(d.n for d in all_), "pieces")
    xs = [without_names(d, names, rng) for d in all_]
    ws = [weights(d) for d in all_]
    for w, d in zip(ws, all_):  # of huge drawings a sample
        if d.n > o.max: w[rng.random(d.n) > o.max / d.n] = 0
    ys = [np.minimum(d.y, K - 1) for d in all_]
    pick = lambda k, seq, inside: [s for s, d in zip(seq, all_) if (fold[author(d)] == k) == inside]
    firsts, p1, p1n = [], {}, {}
    for k in range(o.folds):
        m = fit(pick(k, xs, False), pick(k, ys, False), pick(k, ws, False), o.rounds, o.leaves)
        firsts.append(m)
        for d, x in zip(all_, xs):
            if fold[author(d)] == k:
                p1[id(d)] = m.predict(x); p1n[id(d)] = m.predict(d.x)
        print("fold", k, "first pass", flush=True)
    x2 = []
    for d, x in zip(all_, xs):
        s = second(d, p1[id(d)]); s[:, :x.shape[1]] = x; x2.append(s)
    rows = []
    for k in range(o.folds):
        m = fit(pick(k, x2, False), pick(k, ys, False), pick(k, ws, False), o.rounds, o.leaves)
        for d in all_:
            if fold[author(d)] == k:
                p2 = m.predict(second(d, p1n[id(d)]))
                known = d.y != 255
                conf = mean_by(p2, d.thing, d.length.astype(float))
                rows.append((d.name, f1(d, p1n[id(d)]), f1(d, p2), d.n, d.heavy, conf[known].max(1), (conf[known].argmax(1) == d.y[known]), d.length[known]))
    for r in sorted(rows): print(f"{r[0]}: first {r[1]:.3f} second {r[2]:.3f} ({r[3]} pieces)")
    kinds = {}
    for r in rows: kinds.setdefault("real" if r[4] else r[0].split("/")[-1].split("-")[-1].split(".")[-1], []).append(r)
    for k, v in sorted(kinds.items()): print(f"== {k}: {len(v)} drawings, mean wall F1 first {np.mean([r[1] for r in v]):.3f}, second {np.mean([r[2] for r in v]):.3f}, median {np.median([r[2] for r in v]):.3f}")
    real = [r for r in rows if r[4]]
    if real:
        by = {}
        for r in real: by.setdefault(r[0].split("/")[0], []).append(r)
        print("real, mean by author: first %.3f second %.3f" % tuple(np.mean([np.mean([r[i] for r in v]) for v in by.values()]) for i in (1, 2)))
    c, ok, ln = (np.concatenate([r[i] for r in rows if len(r[5])]) for i in (5, 6, 7))
    for lo in (0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99):
        m = (c >= lo) & (c < {0.3: .5, .5: .6, .6: .7, .7: .8, .8: .9, .9: .95, .95: .99, .99: 2}[lo])
        if m.any(): print(f"confidence from {lo}: right {(ok[m] * ln[m]).sum() / ln[m].sum():.3f} of {ln[m].sum():.0f} m")
    if o.out:
        m1 = fit(xs, ys, ws, o.rounds, o.leaves)
        m2 = fit(x2, ys, ws, o.rounds, o.leaves)
        with open(o.out, "w") as f:
            f.write("classes " + " ".join(CLASSES) + "\n"); table(m1, f); table(m2, f)
        gain = sorted(zip(m2.feature_importance("gain"), names + [f"{w}_{c}" for w in ("own", "thing", "group", "layer", "block", "touching", "partner") for c in CLASSES]), reverse=True)
        print("strongest:", ", ".join(n for _, n in gain[:25]))


if __name__ == "__main__": main()
