"""continue.py MODEL DUMP... --names NAMES --out OUT: boosts a table of trees further on drawings that it reads badly.

The trees of MODEL stay as they are; what they say of the new drawings is where LightGBM begins. A DUMP is what
`cargo run --example reading_features` writes, of AUTHOR/DRAWING. As in train.py: names are withheld from half of the
drawings, authors weigh by the root of how many drawings they have, what is drawn by people (`real` in the file's name) more.
"""
import argparse, os, sys
import numpy as np
import lightgbm as lgb
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from train import CLASSES, K, TEMPER, author, read, table, weights, without_names

PARAMS = dict(objective="multiclass", num_class=K, num_leaves=12, min_data_in_leaf=400, max_bin=63, feature_fraction=0.5,
              bagging_fraction=0.7, bagging_freq=1, lambda_l2=30.0, min_sum_hessian_in_leaf=20.0, boost_from_average=False,
              verbose=-1, seed=2, deterministic=True, force_row_wise=True, num_threads=2)


def tree_text(number, line):
    """A line of the table as LightGBM writes a tree."""
    split, threshold, left, right, leaves = [], [], [], [], []
    words = iter(line.split())
    def walk():
        word = next(words)
        if word[0] == "=":
            leaves.append(float(word[1:]) * TEMPER)
            return -len(leaves)
        own = len(split)
        feature, at = word.split(":")
        split.append(feature); threshold.append(repr(float(np.float32(at)))); left.append(0); right.append(0)
        left[own] = walk(); right[own] = walk()
        return own
    walk()
    n, row = len(split), lambda values: " ".join(map(str, values))
    zeros = row([0] * n)
    return (f"Tree={number}\nnum_leaves={len(leaves)}\nnum_cat=0\nsplit_feature={row(split)}\nsplit_gain={zeros}\n"
            f"threshold={row(threshold)}\ndecision_type={row([2] * n)}\nleft_child={row(left)}\nright_child={row(right)}\n"
            f"leaf_value={row(leaves)}\nleaf_weight={row([1] * len(leaves))}\nleaf_count={row([1] * len(leaves))}\n"
            f"internal_value={zeros}\ninternal_weight={zeros}\ninternal_count={zeros}\nis_linear=0\nshrinkage=1\n\n\n")


def load(path):
    """The table's features, its trees as lines and as a LightGBM model."""
    lines = open(path).read().splitlines()
    picks = [int(w) for w in lines[1].split()[1:]]
    trees = lines[3:]
    head = (f"tree\nversion=v4\nnum_class={K}\nnum_tree_per_iteration={K}\nlabel_index=0\nmax_feature_idx={len(picks) - 1}\n"
            f"objective=multiclass num_class:{K}\nfeature_names={' '.join(f'f{i}' for i in range(len(picks)))}\n"
            f"feature_infos={' '.join(['none'] * len(picks))}\n\n")
    text = head + "".join(tree_text(i, t) for i, t in enumerate(trees)) + "end of trees\n\nparameters:\nend of parameters\n"
    return picks, trees, lgb.Booster(model_str=text)


def append(picks, trees, model, out, temper):
    """The old trees and the new ones as one table."""
    with open(out + ".new", "w") as f: table(model, f)
    soft = lambda w: f"={float(w[1:]) / temper:.4g}" if w[0] == "=" else w
    new = [" ".join(map(soft, line.split())) for line in open(out + ".new").read().splitlines()[1:]]
    os.remove(out + ".new")
    with open(out, "w") as f:
        f.write("classes " + " ".join(CLASSES) + "\nfeatures " + " ".join(map(str, picks)) + "\n")
        f.write(f"trees {len(trees) + len(new)} features {len(picks)}\n" + "\n".join(trees + new) + "\n")


def gather(dumps, names, picks, old, o):
    """x, y, weights and what the old trees say, of all drawings but of authors left out."""
    rng = np.random.default_rng(7)
    all_ = [(d, "real" in path) for path in dumps for d in read(path)]
    all_ = [(d, real) for d, real in all_ if (d.y != 255).sum() >= 4 and author(d) not in o.without]
    count = {}
    for d, _ in all_: count[author(d)] = count.get(author(d), 0) + 1
    xs, ys, ws = [], [], []
    for d, real in all_:
        w = weights(d) / count[author(d)] ** 0.5 * (o.real if real else 1)
        named = without_names(d, names, rng)
        pick = np.flatnonzero((w > 0) & (rng.random(d.n) < (4000 if real else o.most) / d.n))
        if not len(pick): continue
        xs.append(named[pick][:, picks]); ys.append(np.minimum(d.y[pick], K - 1)); ws.append(w[pick] * w.sum() / w[pick].sum())
    x = np.concatenate(xs)
    return x, np.concatenate(ys), np.concatenate(ws), old.predict(x, raw_score=True, num_threads=2)


def main():
    a = argparse.ArgumentParser(description=__doc__)
    a.add_argument("model"); a.add_argument("dumps", nargs="+")
    a.add_argument("--names", required=True); a.add_argument("--out", required=True)
    a.add_argument("--rounds", type=int, default=20); a.add_argument("--rate", type=float, default=0.1)
    a.add_argument("--most", type=int, default=1200, help="most pieces of a made plan")
    a.add_argument("--real", type=float, default=2, help="weight of a plan drawn by people")
    a.add_argument("--temper", type=float, default=1, help="by this the new trees count less")
    a.add_argument("--without", nargs="*", default=[], help="authors that are left out, to be judged")
    o = a.parse_args()
    names = open(o.names).read().split()
    picks, trees, old = load(o.model)
    x, y, w, start = gather(o.dumps, names, picks, old, o)
    w = w * len(w) / w.sum()
    def loss(raw):
        p = np.exp(raw - raw.max(1, keepdims=True)); p /= p.sum(1, keepdims=True)
        return -(w * np.log(np.maximum(p[np.arange(len(y)), y], 1e-9))).sum() / w.sum()
    model = lgb.train(PARAMS | dict(learning_rate=o.rate), lgb.Dataset(x, y, weight=w, init_score=start), o.rounds)
    print(f"{len(y)} pieces, loss {loss(start):.4f}, then {loss(start + model.predict(x, raw_score=True)):.4f}")
    append(picks, trees, model, o.out, o.temper)


if __name__ == "__main__": main()
