"""Rounds whose first option is made by hand: a real round of the program with building works in it."""

import json
import os

from enfilade import document
from enfilade_common import job, results


def quad(a, b, thickness):
    """An outline along the right face from ``a`` to ``b``, back along the left, metres."""
    (ax, ay), (bx, by) = a, b
    length = ((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5
    x, y = -(by - ay) / length * thickness / 2, (bx - ax) / length * thickness / 2
    return [[ax - x, ay - y], [bx - x, by - y], [bx + x, by + y], [ax + x, ay + y]]


def work(kind, a, b, thickness=0.1, demolished=None, built=None, filling="nothing", opening=None, owners=()):
    gone = demolished if demolished is not None else [(a, b)]
    return {
        "kind": kind,
        "words": f"A work of the kind {kind}",
        "stretch": [list(a), list(b)],
        "width_m": round(((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5, 6),
        "rooms": [1, None],
        "elements": list(owners),
        "demolished": [quad(p, q, thickness) for p, q in gone],
        "built": [{"ends": [list(p), list(q)], "thickness_m": thickness} for p, q in built or []],
        "filling": filling,
        "opening": opening,
    }


def named(made, *labels):
    """Elements of the drawing by the labels of the objects they stand for."""
    return [{"handle": h, "record": 0} for h, label in made.labels().items() if label in labels]


def written(doc, wishes, folder, template, works, names=(), changes=(), parameters=()):
    """The job of a document with a round beside it whose first option has the works."""
    study, _ = document.study(doc, wishes)
    made = job.write(study, str(folder))
    data = json.loads(json.dumps(template))
    data["input"]["sha256"] = made.sha256
    option = data["candidates"][0]
    option.update(changes=list(changes), parameters=list(parameters), words="")
    option["works"] = [dict(w, elements=named(made, *names)) for w in works]
    data["candidates"] = [option]
    there = os.path.join(made.results_folder, "round-01")
    os.makedirs(there, exist_ok=True)
    with open(os.path.join(there, "result.json"), "w") as f:
        json.dump(data, f)
    found = results.latest(job.read(str(folder)))
    return made, found, found.options[0]
