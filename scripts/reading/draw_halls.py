"""draw_halls.py OUT SEED COUNT: sketches with a label for every entity, to train the reading of small drawings: bare rooms, screens,
columns, frames, a few lines each: OUT/K/plan.{dxf,json}. The label file is that of draw_plans.py. Needs ezdxf and shapely.
"""
import json, math, os, random, sys
import ezdxf
from shapely.geometry import LineString, Polygon


def halls(out, seed, count):
    for k in range(count):
        rng = random.Random(f"{seed}-{k}")
        w, h = rng.choice((rng.uniform(5, 14), rng.uniform(10, 40), rng.uniform(30, 120))), 0
        h = w * rng.uniform(.4, 1)
        t, bare = rng.choice((.1, .12, .2, .24, .3, .36, .5)), rng.random() < .55
        at = [("wall", [(0, 0), (w, 0), (w, h), (0, h)], True)] if rng.random() < .7 else [("wall", [(0, 0), (w, 0), (w, h * .6), (w * .6, h * .6), (w * .6, h), (0, h)], True)]
        if rng.random() < .5:  # an entrance
            d = rng.uniform(.9, min(4, w / 3)); x = rng.uniform(.2, .8) * (w - d); ring = at[0][1]
            at = [("wall", [(x + d, 0)] + ring[1:] + [(0, 0), (x, 0)], False)]
        def split(x0, y0, x1, y1, depth):
            if depth == 0 or min(x1 - x0, y1 - y0) < 3: return
            d = rng.uniform(.8, 1.4)
            if x1 - x0 > y1 - y0:
                x = rng.uniform(.35, .65) * (x1 - x0) + x0; g = rng.uniform(y0 + .1, y1 - d - .1)
                at.extend([("wall", [(x, y0), (x, g)], False), ("wall", [(x, g + d), (x, y1)], False)]); split(x0, y0, x, y1, depth - 1); split(x, y0, x1, y1, depth - 1)
                if rng.random() < swings: at.extend([("door", [(x, g), (x + d, g)], False), ("door", [(x + d * math.cos(a), g + d * math.sin(a)) for a in [i * math.pi / 16 for i in range(9)]], False)])
            else:
                y = rng.uniform(.35, .65) * (y1 - y0) + y0; g = rng.uniform(x0 + .1, x1 - d - .1)
                at.extend([("wall", [(x0, y), (g, y)], False), ("wall", [(g + d, y), (x1, y)], False)]); split(x0, y0, x1, y, depth - 1); split(x0, y, x1, y1, depth - 1)
        swings = rng.choice((0, 0, 1))
        if len(at[0][1]) < 8: split(0, 0, w, h, rng.choice((0, 0, 1, 2, 3, 4, 5)))
        for _ in range(rng.choice((0, 2, 5, 9, 16))):  # screens that stand free
            x, y, l, a = rng.uniform(.1, .9) * w, rng.uniform(.1, .5) * h, rng.uniform(1, max(1.5, w / 6)), rng.choice((0, 0, math.pi / 2, math.pi / 2, rng.uniform(0, math.pi)))
            c, q = math.cos(a), math.sin(a); b = rng.uniform(.05, .3)
            box_ = [(x, y), (x + l * c, y + l * q), (x + l * c - b * q, y + l * q + b * c), (x - b * q, y + b * c)]
            at.append(("wall", box_, True) if rng.random() < .5 else ("wall", box_[:rng.choice((2, 2, 3))], False))
        for _ in range(rng.choice((0, 0, 0, 4, 12))):
            x, y, r = rng.uniform(.1, .9) * w, rng.uniform(.1, .55) * h, rng.uniform(.1, .35)
            at.append(("column", [(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)], True) if rng.random() < .5 else ("column", (x, y, r), True))
        for _ in range(rng.choice((0, 0, 3, 8))):
            x, y, a, b = rng.uniform(.1, .8) * w, rng.uniform(.1, .5) * h, rng.uniform(.4, 2), rng.uniform(.4, 1)
            at.append(("furniture", [(x, y), (x + a, y), (x + a, y + b), (x, y + b)], True))
        unit = rng.choice((1, 1, .001, .001, .01, .0254)); turn = rng.choice((0, 0, 0, rng.uniform(0, math.pi)))
        names = rng.choice(({"wall": "WALLS"}, {"wall": "A-WALL", "door": "A-DOOR", "furniture": "A-FURN"}, {}, {}, {"wall": "L1", "door": "L2", "furniture": "L3", "column": "L1"}))
        ox, oy, loose = rng.uniform(-500, 500), rng.uniform(-500, 500), rng.random() < .5
        place = lambda p: ((p[0] * math.cos(turn) - p[1] * math.sin(turn) + ox) / unit, (p[0] * math.sin(turn) + p[1] * math.cos(turn) + oy) / unit)
        d = ezdxf.new("R2010"); m = d.modelspace(); labels = {}
        if rng.random() < .6: d.header["$INSUNITS"] = {1: 6, .001: 4, .01: 5, .0254: 1}[unit]
        def put(what, pts, closed):
            layer = {"layer": names.get(what, "0")}
            if isinstance(pts[0], float): e = [m.add_circle(place(pts), pts[2] / unit, dxfattribs=layer)]
            elif loose and what == "wall": e = [m.add_line(place(p), place(q), dxfattribs=layer) for p, q in zip(pts, pts[1:] + (pts[:1] if closed else []))]
            else: e = [m.add_lwpolyline([place(p) for p in pts], close=closed, dxfattribs=layer)]
            labels.update({x.dxf.handle: what for x in e})
        for n, (what, pts, closed) in enumerate(at):
            if what != "wall" or bare: put(what, pts, closed); continue
            g = Polygon(pts).exterior.buffer(t / 2, join_style=2) if closed and n == 0 else LineString(pts).buffer(t / 2, cap_style=2, join_style=2) if n == 0 or len(pts) == 2 else Polygon(pts).buffer(0)
            for q in getattr(g, "geoms", [g]):
                for r in [q.exterior, *q.interiors]: put("wall", list(r.coords)[:-1], True)
        folder = f"{out}/{k}"; os.makedirs(folder, exist_ok=True); d.saveas(f"{folder}/plan.dxf")
        json.dump({"unit_m": unit, "views": [], "labels": labels}, open(f"{folder}/plan.json", "w"))


if __name__ == "__main__":
    if len(sys.argv) != 4: sys.exit(__doc__)
    halls(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
