#!/usr/bin/env python3
"""Would a builder accept the options? Reads each with a library that is not ours and holds it against the drawing.

usage: judge.py ENFILADE DRAWING... [--seeds 3] [--evaluations 60] [--rows OUT.csv] [-- MORE ARGUMENTS OF run]

DXF is read by ezdxf, IFC by IfcOpenShell, glTF by trimesh (`pip install ezdxf ifcopenshell trimesh shapely`). From
Enfilade come the unit and, of a DXF, what each line is taken for; every place is measured anew. Counted are, over all
options of a drawing:

  open      joints of walls that were closed and have parted by more than 1 cm
  through   walls that run through each other only now
  bearing   walls that the file calls load-bearing or fire-resisting, and that are changed
  doors     doors that a wall now stands in or before, or that have left their wall
  narrow    ways between a moved wall and another wall that are below 0.9 m only now
  things    columns, stairs, furniture and fixtures that a wall stands in only now
  rooms     rooms of a building that a wall stands in only now: their outline did not follow
"""

import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field

import shapely
import shapely.ops
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box

FAULTS = ("open", "through", "bearing", "doors", "narrow", "things", "rooms")
JOINT_M = 0.02   # what is nearer is joined
OPEN_M = 0.01    # a joint that parts by more is open
THROUGH_M = 0.02  # what stands out on the far side
PASSAGE_M = 0.9
BEFORE_DOOR_M = 0.6
DOOR_M = 0.3     # a door's leaf may stand so far from the faces of its wall
STEP_M = 0.05    # along a wall it is asked so often how wide the way to another one is
TOUCH_M = 1e-3   # a wall that a line crosses by less does not stand across it
AREA_M2 = 0.01
ROOM_M2 = 0.02


def run(exe, *args):
    done = subprocess.run([exe, *map(str, args)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{args}: {done.stderr.strip()[-300:]}")
    return done.stdout


@dataclass
class Body:
    """Something that stands: its ground in metres, from where to where it reaches, and what it is."""
    kind: str
    ground: object
    low: float = 0.0
    high: float = 0.0
    bearing: bool = False

    def meets(self, other):
        return min(self.high, other.high) - max(self.low, other.low) > 0.1


# --- readers: key -> Body -------------------------------------------------------------------------------------------

def ground_of(points, triangles):
    """The shadow of a mesh on the floor."""
    if len(triangles) > 400:
        return shapely.MultiPoint(points[:, :2]).convex_hull
    corners = points[triangles][:, :, :2]
    polygons = shapely.polygons(corners)
    polygons = polygons[shapely.area(polygons) > 1e-7]
    return shapely.union_all(polygons, grid_size=1e-5).buffer(0) if len(polygons) else Polygon()


KINDS_IFC = {"IfcSpace": "room", "IfcWall": "wall", "IfcColumn": "thing", "IfcDoor": "door", "IfcStair": "thing", "IfcStairFlight": "thing",
             "IfcFurnishingElement": "thing", "IfcFlowTerminal": "thing", "IfcRamp": "thing", "IfcTransportElement": "thing"}


def ifc(path):
    import ifcopenshell
    import ifcopenshell.geom
    import ifcopenshell.util.element as element
    import numpy
    file = ifcopenshell.open(str(path))
    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    settings.set("disable-opening-subtractions", True)
    out = {}
    for kind, name in KINDS_IFC.items():
        try:
            found = file.by_type(kind)
        except RuntimeError:
            continue
        for product in found:
            try:
                shape = ifcopenshell.geom.create_shape(settings, product)
            except RuntimeError:
                continue
            points = numpy.array(shape.geometry.verts).reshape(-1, 3)
            if not len(points):
                continue
            common = element.get_psets(product).get("Pset_WallCommon", {})
            rating = str(common.get("FireRating") or "").strip()
            bearing = common.get("LoadBearing") is True or any(c in "123456789" for c in rating)
            triangles = numpy.array(shape.geometry.faces).reshape(-1, 3)
            out[product.GlobalId] = Body(name, ground_of(points, triangles), points[:, 2].min(), points[:, 2].max(),
                                         name == "wall" and bearing)
    return out


def gltf(path):
    import numpy
    import trimesh
    scene = trimesh.load(str(path), process=False, force="scene")
    out = {}
    for node in sorted(scene.graph.nodes_geometry):
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not hasattr(mesh, "faces") or "enfilade" in node.lower() or "EF-" in node:
            continue
        mesh = mesh.copy()
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        mesh.apply_transform(transform)
        parts = trimesh.graph.connected_components(mesh.face_adjacency, nodes=numpy.arange(len(mesh.faces)), min_len=1)
        parts = sorted(parts, key=min) if len(parts) < 1500 else [numpy.arange(len(mesh.faces))]
        points = numpy.column_stack([mesh.vertices[:, 0], -mesh.vertices[:, 2], mesh.vertices[:, 1]])
        for i, faces in enumerate(parts):
            triangles = mesh.faces[faces]
            own = points[numpy.unique(triangles)]
            ground = ground_of(points, triangles)
            if ground.is_empty:
                continue
            low, high = own[:, 2].min(), own[:, 2].max()
            word = node.lower()
            kind = next((k for w, k in (("wall", "wall"), ("door", "door"), ("slab", ""), ("roof", ""), ("window", ""),
                                        ("space", "")) if w in word), None)
            if kind is None:
                kind = "wall" if high - low > 1.8 and ground.area < 0.6 * ground.length / 2 else "thing"
            if kind:
                out[(node, i)] = Body(kind, ground, low, high)
    return out


@dataclass
class Lines:
    """A drawing by its pieces: kind and segment, always in the same order; doors by hinge, leaf and swing."""
    pieces: list = field(default_factory=list)
    swings: list = field(default_factory=list)


ROLES = {"wall": "wall", "column": "thing", "stair": "thing", "furniture": "thing"}


def dxf(path, unit_m, roles):
    import ezdxf
    from ezdxf import recover
    try:
        doc = ezdxf.readfile(path)
    except Exception:  # whatever it is, the other reader of ezdxf mends it
        doc, _ = recover.readfile(path)
    out = Lines()

    def visit(entity, handle, depth=0):
        if entity.dxf.get("layer", "").upper().startswith("EF-"):
            return
        kind = entity.dxftype()
        if kind == "INSERT" and depth < 8:
            role = roles.get(handle)
            for inner in entity.virtual_entities():
                source = getattr(inner, "source_of_copy", None)
                own = source.dxf.handle if source is not None else None
                visit(inner, own if own in roles else handle if role else own, depth + 1)
            return
        role = ROLES.get(roles.get(handle, ""), "")
        try:
            if kind == "LINE":
                chain = [entity.dxf.start, entity.dxf.end]
            elif kind in ("LWPOLYLINE", "POLYLINE"):
                chain = [p for p in (entity.vertices_in_wcs() if kind == "LWPOLYLINE" else entity.points())]
                if entity.is_closed if kind == "POLYLINE" else entity.closed:
                    chain.append(chain[0])
            elif kind == "ARC":
                sweep = (entity.dxf.end_angle - entity.dxf.start_angle) % 360
                radius = entity.dxf.radius * unit_m
                if 0.5 <= radius <= 1.6 and 25 < sweep < 120:
                    ends = [Point(p.x * unit_m, p.y * unit_m) for p in (entity.start_point, entity.end_point)]
                    hinge = entity.ocs().to_wcs(entity.dxf.center)
                    out.swings.append((Point(hinge.x * unit_m, hinge.y * unit_m), ends))
                return
            else:
                return
        except (AttributeError, ValueError, IndexError):
            return
        points = [(p[0] * unit_m, p[1] * unit_m) for p in chain]
        out.pieces += [(role, LineString([a, b])) for a, b in zip(points, points[1:])]

    for entity in doc.modelspace():
        visit(entity, entity.dxf.handle)
    return out


# --- judges ---------------------------------------------------------------------------------------------------------

def differs(a, b):
    return a.kind != b.kind or a.ground.hausdorff_distance(b.ground) > 1e-3 or abs(a.low - b.low) > 1e-3


def parts_beyond(a, b):
    """Into how many parts of note b cuts a."""
    rest = a.difference(b.buffer(1e-3))
    parts = rest.geoms if isinstance(rest, MultiPolygon) else [rest]
    return sum(1 for p in parts if not p.is_empty and not p.buffer(-THROUGH_M / 2).is_empty)


def bodies_judged(old, new):
    faults = {f: [] for f in FAULTS}
    moved = {k for k in old if k in new and differs(old[k], new[k])}
    faults["open"] += [(k, "gone") for k in old if k not in new and old[k].kind == "wall"]
    both = [k for k in old if k in new and not old[k].ground.is_empty and not new[k].ground.is_empty]
    tree = shapely.STRtree([old[k].ground for k in both] + [new[k].ground for k in both])
    faults["bearing"] = [(k,) for k in moved if old[k].bearing]
    seen = set()
    for k in sorted(moved & set(both), key=str):
        near = {both[i % len(both)] for g in (old[k].ground, new[k].ground) for i in tree.query(g.buffer(1.5))}
        for o in sorted(near - {k}, key=str):
            if (o, k) in seen or not old[k].meets(old[o]):
                continue
            seen.add((k, o))
            a, b, c, d = old[k], old[o], new[k], new[o]
            kinds = {a.kind, b.kind}
            was, now = a.ground.distance(b.ground), c.ground.distance(d.ground)
            if kinds == {"wall"}:
                if was <= JOINT_M and now > max(JOINT_M, was + OPEN_M):
                    faults["open"].append((k, o, round(now, 3)))
                before = parts_beyond(a.ground, b.ground) + parts_beyond(b.ground, a.ground)
                after = parts_beyond(c.ground, d.ground) + parts_beyond(d.ground, c.ground)
                more = c.ground.intersection(d.ground).area - a.ground.intersection(b.ground).area
                if after > before and after > 2 and more > 1e-3:
                    faults["through"].append((k, o))
            if kinds == {"wall", "thing"}:
                more = c.ground.intersection(d.ground).area - a.ground.intersection(b.ground).area
                if more > AREA_M2:
                    faults["things"].append((k, o, round(more, 3)))
            if kinds == {"wall", "room"}:
                more = c.ground.intersection(d.ground).area - a.ground.intersection(b.ground).area
                if more > ROOM_M2:
                    faults["rooms"].append((k, o, round(more, 3)))
            if kinds == {"wall"} and 0 < now < PASSAGE_M - 1e-3 <= was:
                free = narrowest(c.ground, d.ground, standing(new, between(tree, both, c.ground, d.ground) - {k, o}, c, d))
                if free < PASSAGE_M - 1e-3:
                    faults["narrow"].append((k, o, round(free, 3)))
            if kinds == {"wall", "door"}:
                (w, d0), (w1, d1) = ((a, b), (c, d)) if a.kind == "wall" else ((b, a), (d, c))
                held = d0.ground.intersection(w.ground).area
                if held > 0.3 * d0.ground.area and d1.ground.intersection(w1.ground).area < 0.7 * held:
                    faults["doors"].append((k, o, "left its wall"))
                elif held <= 0.3 * d0.ground.area:
                    before, after = (way(x.ground).intersection(y.ground).area for x, y in ((d0, w), (d1, w1)))
                    if after - before > AREA_M2:
                        faults["doors"].append((k, o, round(after - before, 3)))
    return faults, len(moved)


def between(tree, both, a, b):
    """What is near enough to stand between two walls that are no further apart than a way."""
    return {both[i % len(both)] for i in tree.query(a.buffer(PASSAGE_M).intersection(b.buffer(PASSAGE_M)))}


def standing(bodies, keys, a, b):
    """The ground of walls as high as two others; where a door is in them one goes through."""
    of = [bodies[k] for k in keys if bodies[k].meets(a) and bodies[k].meets(b)]
    walls = shapely.union_all([o.ground for o in of if o.kind == "wall"])
    return walls.difference(shapely.union_all([o.ground.buffer(DOOR_M) for o in of if o.kind == "door"]))


def narrowest(a, b, walls):
    """How wide the narrowest way between two grounds is across which no wall stands; beyond a passage it is infinite.

    >>> a, b = box(0, 0, 1, 0.2), box(1.5, 0.5, 1.7, 3)
    >>> round(narrowest(a, b, Polygon()), 3)
    0.583
    >>> narrowest(a, b, box(-1, 0.2, 3, 0.5))
    inf
    >>> 0.6 < narrowest(a, b, box(1.2, 0.1, 1.3, 0.42)) < 0.9
    True
    """
    found = math.inf
    for of, to in ((a, b), (b, a)):
        near = shapely.segmentize(of.boundary.intersection(to.buffer(PASSAGE_M)), STEP_M)
        for at in shapely.points(shapely.get_coordinates(near)):
            link = shapely.shortest_line(at, to)
            if link.length < found and link.intersection(walls).length < TOUCH_M:
                found = link.length
    return found


def way(door):
    """The ground on which one stands who goes through a door."""
    ring = list(door.minimum_rotated_rectangle.exterior.coords) if door.area > 1e-6 else []
    if not ring:
        return Polygon()
    sides = sorted((math.dist(a, b), a, b) for a, b in zip(ring, ring[1:]))
    (_, a, b), middle = sides[-1], door.minimum_rotated_rectangle.centroid
    along = LineString([a, b])
    shift = (middle.x - along.centroid.x, middle.y - along.centroid.y)
    line = shapely.transform(along, lambda p: p + shift)
    return line.interpolate(0.1).union(line.interpolate(line.length - 0.1)).convex_hull.buffer(BEFORE_DOOR_M, cap_style="flat")


def runs_through(a, b):
    if not a.crosses(b):
        return False
    at = a.intersection(b)
    ends = [Point(p) for s in (a, b) for p in s.coords]
    return at.geom_type == "Point" and all(at.distance(e) > THROUGH_M for e in ends)


def lines_judged(old, new):
    faults = {f: [] for f in FAULTS}
    if len(old.pieces) != len(new.pieces):
        faults["open"].append(("pieces", len(old.pieces), len(new.pieces)))
        return faults, 0
    a, b = [p[1] for p in old.pieces], [p[1] for p in new.pieces]
    kind = [p[0] for p in old.pieces]
    moved = {i for i in range(len(a)) if a[i].hausdorff_distance(b[i]) > 1e-4}
    trees = [shapely.STRtree(a), shapely.STRtree(b)]

    def near(i, by):
        return {int(j) for t, g in zip(trees, (a, b)) for j in t.query(g[i].buffer(by))} - {i}

    ends = [[Point(s.coords[0]), Point(s.coords[-1])] for s in a], [[Point(s.coords[0]), Point(s.coords[-1])] for s in b]
    for i in (i for i in range(len(a)) if kind[i] == "wall"):
        for j in near(i, 0.003):
            if kind[j] != "wall" or not {i, j} & moved:
                continue
            for e in (0, 1):
                if ends[0][i][e].distance(a[j]) <= 0.002 and ends[1][i][e].distance(b[j]) > OPEN_M + 0.002:
                    faults["open"].append((i, j, round(ends[1][i][e].distance(b[j]), 3)))
            if i < j and runs_through(b[i], b[j]) and not runs_through(a[i], a[j]):
                faults["through"].append((i, j))
    walls = [i for i in moved if kind[i] == "wall" and b[i].length > 0.3]
    for i in walls:
        for j in near(i, 1.0):
            if kind[j] == "thing" and j not in moved and runs_through(b[i], b[j]) and not runs_through(a[i], a[j]):
                faults["things"].append((i, j))
            gap, was = b[i].distance(b[j]), a[i].distance(a[j])
            if kind[j] != "wall" or b[j].length < 0.3 or not 0 < gap < PASSAGE_M - 1e-3 or was < PASSAGE_M:
                continue
            link = LineString(shapely.ops.nearest_points(b[i], b[j]))
            between = (k for k in map(int, trees[1].query(link)) if k not in (i, j) and kind[k] == "wall")
            if not any(link.intersects(b[k]) for k in between):
                faults["narrow"].append((i, j, round(gap, 3)))
    wall_ids = [i for i in range(len(a)) if kind[i] == "wall"]
    if not wall_ids:
        return faults, len(moved)
    grounds = [shapely.STRtree([g[i] for i in wall_ids]) for g in (a, b)]
    for n, (s, t) in enumerate(zip(old.swings, new.swings)):
        torn = [far(s[0], grounds[0]), far(t[0], grounds[1])]
        if torn[0] < 0.15 and torn[1] > torn[0] + 0.02:
            faults["doors"].append((n, "left its wall", round(torn[1], 3)))
        sector = [Polygon([h.coords[0], *(p.coords[0] for p in e)]).buffer(-0.03) for h, e in (s, t)]
        hit = [sum(1 for k in g.query(z) if g.geometries[k].intersects(z)) for g, z in zip(grounds, sector)]
        if hit[1] > hit[0]:
            faults["doors"].append((n, "a wall in its swing"))
    return faults, len(moved)


def far(point, tree):
    return tree.geometries[tree.nearest(point)].distance(point)


def reader(exe, path):
    if path.suffix == ".ifc":
        return ifc, bodies_judged
    if path.suffix in (".glb", ".gltf"):
        return gltf, bodies_judged
    check = json.loads(run(exe, "check", path, "--json"))
    roles = {e["element"].get("handle"): e["role"] for e in check["reading"]["entities"]}
    return (lambda p: dxf(p, check["unit"]["metres"], roles)), lines_judged


def judge(exe, path, seeds, evaluations, extra):
    read, judged = reader(exe, path)
    old, rows = read(path), []
    for seed in range(1, seeds + 1):
        with tempfile.TemporaryDirectory() as folder:
            args = ["run", path, "--seed", seed, "--evaluations", evaluations, "--out", folder, "--quiet", "--json", "-"]
            result = json.loads(run(exe, *args, *extra))
            made = next(pathlib.Path(folder).glob("*.enfilade/round-01"))
            options = [c["file"] for c in result["candidates"]]
            options += [b["file"] for b in [result.get("best")] if b and b.get("file")]
            row = {"drawing": path.name, "seed": seed, "moves": len(result["moves"]), "options": len(result["candidates"])}
            found = {f: {} for f in FAULTS}
            for option in options:
                faults, moved = judged(old, read(made / option))
                row["moved"] = row.get("moved", 0) + moved
                for f in FAULTS:
                    found[f].update({fault[:2]: fault for fault in faults[f]})
            row |= {f: len(found[f]) for f in FAULTS}
            rows.append(row)
            worst = {f: list(v.values())[:3] for f, v in found.items() if v}
            print(f"{path.name} seed {seed}: {row['moves']} moves, {row['options']} options {worst or 'clean'}", file=sys.stderr, flush=True)
    return rows


def main():
    ask = argparse.ArgumentParser()
    ask.add_argument("enfilade")
    ask.add_argument("drawings", nargs="+", type=pathlib.Path)
    ask.add_argument("--seeds", type=int, default=3)
    ask.add_argument("--evaluations", type=int, default=60)
    ask.add_argument("--rows", type=pathlib.Path)
    own, extra = (sys.argv[1:], [])
    if "--" in own:
        at = own.index("--")
        own, extra = own[:at], own[at + 1:]
    args = ask.parse_args(own)
    rows = []
    for path in args.drawings:
        try:
            rows += judge(args.enfilade, path, args.seeds, args.evaluations, extra)
        except Exception as error:  # one drawing that fails is told and the rest is judged
            print(f"{path.name}: {type(error).__name__} {str(error)[:300]}", file=sys.stderr, flush=True)
    names = ["drawing", "seed", "moves", "options", "moved", *FAULTS]
    if args.rows:
        with args.rows.open("w", newline="") as out:
            table = csv.DictWriter(out, names, restval=0)
            table.writeheader()
            table.writerows(rows)
    print("drawings", len({r["drawing"] for r in rows}), "runs", len(rows), "moves", sum(r["moves"] for r in rows),
          "options", sum(r["options"] for r in rows), *(f"{f} {sum(r[f] for r in rows)}" for f in FAULTS))


if __name__ == "__main__":
    main()
