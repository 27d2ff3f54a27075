#!/usr/bin/env python3
"""Figures of shapely that `shapely.rs` compares with: halls with columns, a place, a window and an exit.

    python make_shapely.py > shapely.json

Made with shapely 2.x. Another way than the program's: what is seen is the floor less the shadow of every side; ways are
Dijkstra over all pairs of corners that shapely says are joined; circles and boxes are shapely's own.
"""

import heapq
import json
import math
import random

from shapely import LineString, Point, Polygon, maximum_inscribed_circle, unary_union

FAR = 1e4


def hall(rng):
    """An outline of 6 to 9 corners round a centre, with square columns that touch nothing."""
    n = rng.randint(6, 9)
    turn = sorted(2 * math.pi * (k + 0.6 * rng.random()) / n for k in range(n))
    ring = [(round(12 + r * math.cos(t), 3), round(12 + r * math.sin(t), 3))
            for t, r in ((t, rng.uniform(5, 11)) for t in turn)]
    floor = Polygon(ring)
    for _ in range(60):
        if len(floor.interiors) == 3:
            break
        x, y, s = round(rng.uniform(4, 20), 3), round(rng.uniform(4, 20), 3), round(rng.uniform(0.4, 1.5), 3)
        column = Polygon([(x, y), (x + s, y), (x + s, y + s), (x, y + s)])
        if floor.contains(column.buffer(0.4)):
            floor = Polygon(floor.exterior, [*floor.interiors, column.exterior])
    return floor


def seen(floor, p):
    """The floor less what lies behind its sides."""
    out = floor
    rings = [floor.exterior, *floor.interiors]
    shadows = []
    for ring in rings:
        c = list(ring.coords)
        for a, b in zip(c, c[1:]):
            far = [(p[0] + (q[0] - p[0]) * FAR, p[1] + (q[1] - p[1]) * FAR) for q in (b, a)]
            shadow = Polygon([a, b, *far])
            if shadow.is_valid and shadow.area > 0:
                shadows.append(shadow)
    out = floor.difference(unary_union(shadows))
    parts = out.geoms if hasattr(out, "geoms") else [out]
    return unary_union([g for g in parts if g.distance(Point(p)) < 1e-6])


def angle_of(view, a, b, p):
    """Degrees under which the view meets the side from a to b."""
    line = LineString([a, b])
    total = 0.0
    c = list(view.exterior.coords)
    for q, r in zip(c, c[1:]):
        if line.distance(Point(q)) < 1e-6 and line.distance(Point(r)) < 1e-6:
            u, v = ((q[0] - p[0], q[1] - p[1]), (r[0] - p[0], r[1] - p[1]))
            total += abs(math.atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]))
    return math.degrees(total)


def walk(floor, p, exit_at):
    grown = floor.buffer(1e-7)
    nodes = [p, exit_at] + [c for ring in (floor.exterior, *floor.interiors) for c in list(ring.coords)[:-1]]
    joined = lambda a, b: grown.covers(LineString([a, b]))
    dist, heap = {0: 0.0}, [(0.0, 0)]
    while heap:
        d, i = heapq.heappop(heap)
        if d > dist[i]:
            continue
        if i == 1:
            return d
        for j, q in enumerate(nodes):
            e = d + math.dist(nodes[i], q)
            if j != i and e < dist.get(j, math.inf) and joined(nodes[i], q):
                dist[j] = e
                heapq.heappush(heap, (e, j))
    return None


def boxed(floor):
    c = list(floor.minimum_rotated_rectangle.exterior.coords)
    sides = sorted([math.dist(c[0], c[1]), math.dist(c[1], c[2])])
    return sides[1] / sides[0]


def main():
    rng = random.Random(17037)
    cases = []
    while len(cases) < 24:
        floor = hall(rng)
        if not floor.is_valid or floor.area < 40:
            continue
        inside = floor.buffer(-0.3)
        while True:
            p = (round(rng.uniform(2, 22), 3), round(rng.uniform(2, 22), 3))
            if inside.contains(Point(p)):
                break
        ring = list(floor.exterior.coords)[:-1]
        if not floor.exterior.is_ccw:
            ring.reverse()
        view = seen(floor, p)
        k = rng.randrange(len(ring))
        a, b = ring[k], ring[(k + 1) % len(ring)]
        m = (len(ring) // 2 + k) % len(ring)
        cases.append({
            "outline": ring,
            "holes": [list(h.coords)[:-1] for h in floor.interiors],
            "place": p,
            "area_m2": floor.area,
            "circle_m": 2 * maximum_inscribed_circle(floor, tolerance=1e-5).length,
            "proportion": boxed(floor),
            "seen_m2": view.area,
            "window": [a, b],
            "angle_deg": angle_of(view, a, b, p),
            "exit": ring[m],
            "walk_m": walk(floor, p, ring[m]),
        })
    print(json.dumps(cases, indent=1))


main()
