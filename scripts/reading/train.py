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
# What tells one drawing from another rather than one class from another is withheld from the first pass.
WITHHELD = ("all_", "name_", "group_", "layer_", "comp_share", "usual", "block_length")
LAST = ["length", "nearest", "covered", "thing_pieces", "closed", "thing_long", "thing_short", "group_share", "in_block", "hinge", "free"]
NAMES = []


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


def means(d, p):
    """What the first pass says of the thing, the block, the touching pieces and the other face of every piece."""
    w = d.length.astype(np.float64)
    touch = np.zeros((d.n, K)); count = np.zeros(d.n)
    np.add.at(touch, d.frm, p[d.to]); np.add.at(count, d.frm, 1)
    touch = np.where(count[:, None] > 0, touch / np.maximum(count, 1)[:, None], p)
    partner = np.where((d.partner != NONE)[:, None], p[np.minimum(d.partner, d.n - 1)], p)
    return [mean_by(p, d.thing, w), mean_by(p, d.block, w), touch, partner]


def agreement(p, key, w):
    """Share of the length with one key of which the most likely class is that of them all."""
    whole = mean_by(p, key, w)
    same = (p.argmax(1) == whole.argmax(1)).astype(float)
    return mean_by(np.repeat(same[:, None], K, 1), key, w)[:, :1]


def families(d, x, p):
    """The features of a group of pieces drawn alike: its own, what the first pass says of it, of the things in it and of
    its layer; one row a piece."""
    w = d.length.astype(np.float64)
    own = [i for i, n in enumerate(NAMES) if n.startswith(("group_", "layer_", "name_layer"))]
    blocks = [i for i, n in enumerate(NAMES) if n.startswith("name_block")]
    _, inverse = np.unique(d.group, return_inverse=True)
    mean = np.zeros((inverse.max() + 1, len(blocks))); low = np.zeros(inverse.max() + 1)
    np.add.at(mean, inverse, x[:, blocks] * w[:, None]); np.add.at(low, inverse, w)
    named = (mean / np.maximum(low, 1e-12)[:, None])[inverse]
    parts = [x[:, own], named, mean_by(p, d.group, w), mean_by(p, d.layer, w), agreement(p, d.group, w)]
    return np.concatenate(parts, axis=1).astype(np.float32)


def last(d, x, p, g):
    """The features of the last pass: the first pass's word of the piece and of what is beside it, the group's class, and
    how far the group agrees."""
    w = d.length.astype(np.float64)
    few = [NAMES.index(n) for n in LAST]
    parts = [p, *means(d, p), g, agreement(p, d.group, w), x[:, few]]
    return np.concatenate(parts, axis=1).astype(np.float32)


def weights(d):
    w = np.minimum(d.length, 4.0) + 0.15
    w = np.where(d.y == 255, 0, w)
    share = 1000.0 if not getattr(d, "heavy", False) else 3000.0
    return w * share / max(w.sum(), 1e-9)


def params(leaves, seed):
    return dict(objective="multiclass", num_class=K, num_leaves=leaves, learning_rate=0.12, min_data_in_leaf=60,
                feature_fraction=0.5, bagging_fraction=0.7, bagging_freq=1, lambda_l2=5.0, max_bin=63, verbose=-1,
                seed=seed, deterministic=True, force_row_wise=True, num_threads=2, min_sum_hessian_in_leaf=1.0)


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


def trees(leaves, lowest, share):
    return dict(num_leaves=leaves, min_data_in_leaf=lowest, feature_fraction=share)


def main():
    a = argparse.ArgumentParser(description=__doc__)
    a.add_argument("dumps", nargs="+"); a.add_argument("--out"); a.add_argument("--names", required=True)
    a.add_argument("--folds", type=int, default=3); a.add_argument("--rounds", type=int, default=40)
    a.add_argument("--leaves", type=int, default=16); a.add_argument("--max", type=int, default=2500, help="most pieces of one drawing that are trained on")
    a.add_argument("--max-made", type=int, default=600, help="the same of a drawing made from a building")
    o = a.parse_args()
    NAMES.extend(open(o.names).read().split())
    rng = np.random.default_rng(7)
    all_ = []
    for path in o.dumps:
        for d in read(path):
            d.heavy = "real" in path
            if (d.y != 255).sum() >= 4: all_.append(d)
    authors = sorted({author(d) for d in all_})
    rng.shuffle(authors)
    fold = {w: i % o.folds for i, w in enumerate(authors)}
    drawings = {w: sum(author(d) == w for d in all_) for w in authors}
    print(len(all_), "drawings of", len(authors), "authors,", sum(d.n for d in all_), "pieces", flush=True)
    first = [i for i, n in enumerate(NAMES) if not n.startswith(WITHHELD)]
    for d in all_:
        d.named = without_names(d, NAMES, rng)
        d.w = weights(d) / drawings[author(d)] ** 0.5
        most = o.max if d.heavy else o.max_made
        d.pick = np.flatnonzero((d.w > 0) & (rng.random(d.n) < most / d.n))
        d.cls = np.minimum(d.y, K - 1)

    def train(rows_of, ds, kind, rounds):
        x = np.concatenate([rows_of(d)[d.pick] for d in ds]); y = np.concatenate([d.cls[d.pick] for d in ds])
        w = np.concatenate([d.w[d.pick] for d in ds])
        return lgb.train({**params(16, 1), **kind}, lgb.Dataset(x, y, weight=w * len(w) / w.sum()), rounds)

    piece, group, final = trees(o.leaves, 80, 0.4), trees(6, 40, 0.3), trees(8, 80, 0.5)
    r1, r2, r3 = o.rounds, 25, 25
    for k in range(o.folds):
        rest = [d for d in all_ if fold[author(d)] != k]
        m = train(lambda d: d.x[:, first], rest, piece, r1)
        for d in all_:
            if fold[author(d)] == k: d.p1 = m.predict(d.x[:, first])
        print("fold", k, "pieces", flush=True)
    for d in all_:
        d.xg = families(d, d.named, d.p1); d.xgn = families(d, d.x, d.p1)
    for k in range(o.folds):
        m = train(lambda d: d.xg, [d for d in all_ if fold[author(d)] != k], group, r2)
        for d in all_:
            if fold[author(d)] == k: d.g = m.predict(d.xg); d.gn = m.predict(d.xgn)
    for d in all_: d.xl = last(d, d.x, d.p1, d.g); d.xln = last(d, d.x, d.p1, d.gn)
    rows = []
    for k in range(o.folds):
        m = train(lambda d: d.xl, [d for d in all_ if fold[author(d)] != k], final, r3)
        for d in all_:
            if fold[author(d)] == k:
                p2 = m.predict(d.xln); known = d.y != 255
                conf = mean_by(p2, d.thing, d.length.astype(float))
                rows.append((d.name, f1(d, d.p1), f1(d, d.gn), f1(d, p2), d.n, d.heavy, conf[known].max(1), conf[known].argmax(1) == d.y[known], d.length[known]))
    for r in sorted(rows): print(f"{r[0]}: pieces {r[1]:.3f} groups {r[2]:.3f} last {r[3]:.3f} ({r[4]})")
    kinds = {}
    for r in rows: kinds.setdefault("real" if r[5] else r[0].split("-")[-1], []).append(r)
    say = lambda v: " ".join(f"{n} {np.mean([r[i] for r in v]):.3f}" for i, n in ((1, "pieces"), (2, "groups"), (3, "last")))
    for k, v in sorted(kinds.items()): print(f"== {k}: {len(v)} drawings, mean wall F1 {say(v)}, from 0.95 {np.mean([r[3] >= .95 for r in v]):.2f}")
    by = {}
    for r in rows:
        if r[5]: by.setdefault(r[0].split("/")[0], []).append(r)
    if by: print("real, mean by author:", " ".join("%.3f" % np.mean([np.mean([r[i] for r in v]) for v in by.values()]) for i in (1, 2, 3)))
    c, ok, ln = (np.concatenate([r[i] for r in rows]) for i in (6, 7, 8))
    edges = [0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.01]
    for lo, hi in zip(edges, edges[1:]):
        m = (c >= lo) & (c < hi)
        if m.any(): print(f"confidence from {lo}: right {(ok[m] * ln[m]).sum() / ln[m].sum():.3f} of {ln[m].sum():.0f} m")
    if o.out:
        models = [train(lambda d: d.x[:, first], all_, piece, r1), train(lambda d: d.xg, all_, group, r2), train(lambda d: d.xl, all_, final, r3)]
        with open(o.out, "w") as f:
            f.write("classes " + " ".join(CLASSES) + "\n")
            f.write("first " + " ".join(map(str, first)) + "\n")
            for m in models: table(m, f)
        for m, names in zip(models, ([NAMES[i] for i in first],)):
            gain = sorted(zip(m.feature_importance("gain"), names), reverse=True)
            print("strongest:", ", ".join(n for _, n in gain[:25]))


if __name__ == "__main__": main()
