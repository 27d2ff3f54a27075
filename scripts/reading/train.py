"""train.py DUMP... --out MODEL.txt: trains the classifier of drawn pieces (src/plan/reading) and judges it.

A DUMP is what `cargo run --example reading_features` writes: for every drawing the features of its pieces and the class
that its label says. Drawings of one author (or of one building) are named AUTHOR/DRAWING and are never parted: what is
judged was not trained on. An entity has the mean votes of its pieces. Names are withheld from half of the drawings in
training; the sizes of whole drawings, which tell one drawing from another, from all.
"""
import argparse, struct
import numpy as np
import lightgbm as lgb

CLASSES = ["wall", "window", "door", "stair", "furniture", "note", "other"]
K = len(CLASSES)
WITHHELD = "all_"
TEMPER = 1.2  # by this the trees are too sure of authors that they have not seen; what is judged is as they are


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
        d.thing = take("<u4", d.n); at += 4 * d.n
        d.layer = take("<u4", d.n); at += 4 * d.n
        yield d


def mean_by(p, key, weight):
    """Mean of p over the pieces with one key."""
    _, inverse = np.unique(key, return_inverse=True)
    top = np.zeros((inverse.max() + 1, K)); low = np.zeros(inverse.max() + 1)
    np.add.at(top, inverse, p * weight[:, None]); np.add.at(low, inverse, weight)
    return (top / np.maximum(low, 1e-12)[:, None])[inverse]


def weights(d):
    w = np.minimum(d.length, 4.0) + 0.15
    w = np.where(d.y == 255, 0, w)
    return w / max(w.sum(), 1e-9)


PARAMS = dict(objective="multiclass", num_class=K, num_leaves=24, learning_rate=0.12, min_data_in_leaf=50, max_bin=63,
              feature_fraction=0.5, bagging_fraction=0.7, bagging_freq=1, lambda_l2=5.0, min_sum_hessian_in_leaf=1.0,
              verbose=-1, seed=1, deterministic=True, force_row_wise=True, num_threads=2)


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
    """F1 of walls by length."""
    w = d.length.astype(np.float64)
    of = p.argmax(1)
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
                out.append(f"={node['leaf_value'] / TEMPER:.4g}")
            else:
                out.append(f"{node['split_feature']}:{np.float32(node['threshold']):.7g}")
                walk(node["left_child"]); walk(node["right_child"])
        walk(tree["tree_structure"])
        f.write(" ".join(out) + "\n")


def main():
    a = argparse.ArgumentParser(description=__doc__)
    a.add_argument("dumps", nargs="+", help="files whose name has `real` are of drawn plans, others of plans made from buildings")
    a.add_argument("--out", help="where the table goes; without it the classifier is judged alone")
    a.add_argument("--names", required=True, help="names of the features, one a line")
    a.add_argument("--folds", type=int, default=3); a.add_argument("--rounds", type=int, default=100)
    a.add_argument("--most", type=int, nargs=2, default=(4000, 800), help="most pieces of a drawn and of a made plan")
    o = a.parse_args()
    names = open(o.names).read().split()
    rng = np.random.default_rng(7)
    all_ = []
    for path in o.dumps:
        for d in read(path):
            d.real = "real" in path
            if (d.y != 255).sum() >= 4: all_.append(d)
    authors = sorted({author(d) for d in all_})
    rng.shuffle(authors)
    fold = {w: i % o.folds for i, w in enumerate(authors)}
    of_author = {w: sum(author(d) == w for d in all_) for w in authors}
    picks = [i for i, n in enumerate(names) if not n.startswith(WITHHELD)]
    for d in all_:
        d.named = without_names(d, names, rng)
        d.w = weights(d) / of_author[author(d)] ** 0.5 * (6 if d.real else 1)
        d.pick = np.flatnonzero((d.w > 0) & (rng.random(d.n) < o.most[not d.real] / d.n))
        d.cls = np.minimum(d.y, K - 1)

    def fit(ds):
        x = np.concatenate([d.named[d.pick][:, picks] for d in ds]); y = np.concatenate([d.cls[d.pick] for d in ds])
        w = np.concatenate([d.w[d.pick] for d in ds])
        return lgb.train(PARAMS, lgb.Dataset(x, y, weight=w * len(w) / w.sum()), o.rounds)

    if o.out:
        model = fit(all_)
        with open(o.out, "w") as f:
            f.write("classes " + " ".join(CLASSES) + "\n")
            f.write("features " + " ".join(map(str, picks)) + "\n")
            table(model, f)
        gain = sorted(zip(model.feature_importance("gain"), (names[i] for i in picks)), reverse=True)
        print("strongest:", ", ".join(n for _, n in gain[:25]))
        return
    rows = []
    for k in range(o.folds):
        model = fit([d for d in all_ if fold[author(d)] != k])
        for d in all_:
            if fold[author(d)] == k:
                p, known = mean_by(model.predict(d.x[:, picks]), d.thing, d.length.astype(float)), d.y != 255
                rows.append((d.name, f1(d, p), d.n, d.real, p[known].max(1), p[known].argmax(1) == d.y[known], d.length[known]))
    for r in sorted(rows): print(f"{r[0]}: wall F1 {r[1]:.3f} ({r[2]} pieces)")
    kinds = {}
    for r in rows: kinds.setdefault("drawn" if r[3] else r[0].split("-")[-1], []).append(r[1])
    for k, v in sorted(kinds.items()): print(f"{k}: {len(v)} drawings, mean wall F1 {np.mean(v):.3f}, {np.mean(np.array(v) >= .95):.0%} from 0.95 on")
    by = {}
    for r in rows:
        if r[3]: by.setdefault(r[0].split("/")[0], []).append(r[1])
    if by: print(f"drawn, mean by author: {np.mean([np.mean(v) for v in by.values()]):.3f}")
    c, ok, ln = (np.concatenate([r[i] for r in rows]) for i in (4, 5, 6))
    edges = [0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.01]
    for lo, hi in zip(edges, edges[1:]):
        m = (c >= lo) & (c < hi)
        if m.any(): print(f"confidence from {lo}: right {(ok[m] * ln[m]).sum() / ln[m].sum():.3f} of {ln[m].sum():.0f} m")


if __name__ == "__main__": main()
