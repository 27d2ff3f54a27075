#!/usr/bin/env python3
"""Whether `enfilade works` tells the truth, by other programs: openings, wider doors and removals are made in the drawing
by ezdxf (DXF) or IfcOpenShell (IFC), and `analyse` measures what comes of them.

    works.py ENFILADE FILE… [--most N] [--sample N] [--seed N]

Of every file up to N listed works are made (default 6 of each kind), and so many openings anywhere in the walls that the
list names (default 20), on no grid and of any width: no legal one of them may bring more than the list's best. A row for
each file: works made, how many of them measure what was told, the largest miss, the best of the sample against the best of
the list. Needs ezdxf, and ifcopenshell for IFC.
"""

import argparse
import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile

# A face is cut where it runs along the axis to a degree and lies within half a thick wall of it.
ALONG = math.cos(math.radians(1))
FACES_M = 0.45
# An opening keeps so far from a joint.
JOINT_M = 0.1
CUT = ("open", "door", "widen", "remove")
# How far a gain may lie off where the list has no interval: the spread of a single lattice.
ROUGHLY = 0.02
NAMES_M = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "ft": 0.3048}


def enfilade(program, *args):
    done = subprocess.run([program, *args], capture_output=True, text=True, timeout=600)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(args)}: {done.returncode} {done.stderr.strip().splitlines()[-1:]}")
    return done.stdout


def pairs(program, file, spacing, folder):
    """Cells of the drawing as measured, and every pair of them that see each other."""
    cells, edges = os.path.join(folder, "c.csv"), os.path.join(folder, "e.csv")
    enfilade(program, "analyse", file, "--spacing", str(spacing), "--cells", cells, "--edges", edges,
             "--out", os.path.join(folder, "o"), "-q")
    with open(cells) as f:
        where = {row["Ref"]: (round(float(row["x"]), 3), round(float(row["y"]), 3)) for row in csv.DictReader(f)}
    with open(edges) as f:
        rows = csv.reader(f)
        next(rows)
        seen = [(where[r[0]], where[r[1]]) for r in rows if r[0] in where and r[1] in where]
    return set(where.values()), seen


def degree(cells, seen):
    """Mean number of the given cells that one of them sees."""
    return sum(2 for a, b in seen if a in cells and b in cells and a != b) / max(len(cells), 1)


def extents(works):
    """Of each wall in which an opening is allowed: its elements, and the ends of all that the list has there."""
    out = []
    for key in {json.dumps(w["wall"]) for w in works if w["kind"] == "open" and w["is_allowed"]}:
        stretches = [w["stretch"] for w in works if json.dumps(w["wall"]) == key]
        a, b = stretches[0]
        size = math.dist(a, b)
        way = ((b[0] - a[0]) / size, (b[1] - a[1]) / size)
        along = [(p[0] - a[0]) * way[0] + (p[1] - a[1]) * way[1] for s in stretches for p in s]
        first, last = [(a[0] + way[0] * s, a[1] + way[1] * s) for s in (min(along), max(along))]
        if math.dist(first, last) >= 0.9 + 2 * JOINT_M:
            out.append((json.loads(key), first, last))
    return sorted(out, key=lambda wall: wall[1:])


class Dxf:
    def __init__(self, file):
        import ezdxf
        self.file, self.ezdxf = file, ezdxf

    def cut(self, stretch, unit_m, out, elements):
        """The faces along the stretch end at its ends, and jambs join them."""
        doc = self.ezdxf.readfile(self.file)
        space, handles = doc.modelspace(), {e["handle"] for e in elements}
        a, b = [(p[0] / unit_m, p[1] / unit_m) for p in stretch]
        length = math.dist(a, b)
        d = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
        across = lambda p: (p[0] - a[0]) * -d[1] + (p[1] - a[1]) * d[0]  # noqa: E731
        along = lambda p: (p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]  # noqa: E731
        at = lambda s, t: (a[0] + d[0] * s - d[1] * t, a[1] + d[1] * s + d[0] * t)  # noqa: E731
        faces, layer = [], None
        layers = {e.dxf.layer for e in space if e.dxf.handle in handles}
        for entity in list(space):
            kind = entity.dxftype()
            if entity.dxf.handle not in handles and kind not in ("LINE",):
                continue
            if kind == "LINE":
                points, closed = [entity.dxf.start, entity.dxf.end], False
            elif kind == "LWPOLYLINE":
                if any(abs(bulge) > 1e-9 for *_, bulge in entity.get_points("xyb")):
                    continue
                points, closed = list(entity.get_points("xy")), entity.closed
            elif kind == "POLYLINE" and entity.is_2d_polyline:
                points, closed = [v.dxf.location for v in entity.vertices], entity.is_closed
            else:
                continue
            points = [(p[0], p[1]) for p in points]
            pieces = list(zip(points, points[1:] + points[:1])) if closed else list(zip(points, points[1:]))
            kept, touched = [], False
            for p, q in pieces:
                size = math.dist(p, q)
                runs = size > 0 and abs((q[0] - p[0]) * d[0] + (q[1] - p[1]) * d[1]) / size > ALONG
                near = max(abs(across(p)), abs(across(q))) * unit_m < FACES_M
                s, e = sorted((along(p), along(q)))
                inside = size > 0 and s > -1e-6 and e < length + 1e-6 and near
                if inside and not runs:
                    touched = True  # a line across within the stretch: the end of a face
                    continue
                if not (runs and near and s < length - 1e-6 and e > 1e-6):
                    kept.append((p, q))
                    continue
                touched = True
                t = across(p)
                faces += [(0.0, t)] if s < -1e-6 else []
                faces += [(length, t)] if e > length + 1e-6 else []
                kept += [(at(s, t), at(0.0, t))] if s < -1e-6 else []
                kept += [(at(length, t), at(e, t))] if e > length + 1e-6 else []
            if not touched or not (entity.dxf.handle in handles or entity.dxf.layer in layers):
                continue
            layer = entity.dxf.layer
            for p, q in kept:
                space.add_line(p, q, dxfattribs={"layer": layer})
            space.delete_entity(entity)
        for s in (0.0, length):
            ends = sorted(t for at_s, t in faces if at_s == s)
            if len(ends) > 1:
                space.add_line(at(s, ends[0]), at(s, ends[-1]), dxfattribs={"layer": layer})
        doc.saveas(out)
        return layer is not None


class Ifc:
    def __init__(self, file):
        import ifcopenshell
        self.file, self.shell = file, ifcopenshell

    def cut(self, stretch, unit_m, out, elements):
        """The walls are voided by a box along the stretch, from below the floor to above the ceiling."""
        model = self.shell.open(self.file)
        guids = {e["global_id"] for e in elements if e.get("global_id")}
        import ifcopenshell.guid
        import ifcopenshell.util.placement
        import ifcopenshell.util.unit
        scale = ifcopenshell.util.unit.calculate_unit_scale(model)
        (ax, ay), (bx, by) = [(p[0] / scale, p[1] / scale) for p in stretch]
        length = math.dist((ax, ay), (bx, by))
        made = 0
        for guid in guids:
            wall = model.by_guid(guid)
            z = ifcopenshell.util.placement.get_local_placement(wall.ObjectPlacement)[2][3]
            point = model.createIfcCartesianPoint(((ax + bx) / 2, (ay + by) / 2, float(z) - 0.5 / scale))
            axis = model.createIfcDirection((0.0, 0.0, 1.0))
            way = model.createIfcDirection(((bx - ax) / length, (by - ay) / length, 0.0))
            place = model.createIfcLocalPlacement(None, model.createIfcAxis2Placement3D(point, axis, way))
            flat = model.createIfcAxis2Placement2D(model.createIfcCartesianPoint((0.0, 0.0)), None)
            profile = model.createIfcRectangleProfileDef("AREA", None, flat, length, 2 * FACES_M / scale)
            body = model.createIfcExtrudedAreaSolid(
                profile, model.createIfcAxis2Placement3D(model.createIfcCartesianPoint((0.0, 0.0, 0.0)), None, None),
                axis, 4.0 / scale)
            context = next(c for c in model.by_type("IfcGeometricRepresentationContext") if c.ContextType == "Model")
            shape = model.createIfcProductDefinitionShape(
                None, None, [model.createIfcShapeRepresentation(context, "Body", "SweptSolid", [body])])
            owner = wall.OwnerHistory
            new = ifcopenshell.guid.new
            hole = model.create_entity("IfcOpeningElement", new(), owner, "Opening", None, None, place, shape, None)
            model.create_entity("IfcRelVoidsElement", new(), owner, None, None, wall, hole)
            made += 1
        model.write(out)
        return made > 0


def judge(program, file, most, sample, seed):
    said = json.loads(enfilade(program, "works", file, "--json"))
    spacing, unit = said["spacing_m"], NAMES_M.get(said["input"].get("unit"), 1.0)
    is_dxf = said["input"]["format"] == "dxf"
    maker = (Dxf if is_dxf else Ifc)(file)
    unit_m = unit if is_dxf else 1.0
    with tempfile.TemporaryDirectory() as folder:
        cells, seen = pairs(program, file, spacing, folder)
        before = degree(cells, seen)

        def made(stretch, elements):
            out = os.path.join(folder, "edited" + os.path.splitext(file)[1])
            if not maker.cut(stretch, unit_m, out, elements):
                return None
            found, seen = pairs(program, out, spacing, folder)
            if len(cells & found) < 0.9 * len(cells):
                return None
            return degree(cells, seen) / before - 1

        counts, misses, told = {}, [], 0
        for work in said["works"]:
            kind = work["kind"]
            if kind not in CUT or counts.get(kind, 0) >= most:
                continue
            counts[kind] = counts.get(kind, 0) + 1
            gain = work["gain"]["visibility"]
            share = made(work["stretch"], work["wall"])
            if share is None:
                print(f"    {kind} {work['stretch']}: could not be made", file=sys.stderr)
                continue
            low, high = (gain["low"], gain["high"]) if gain["low"] is not None else (gain["share"], gain["share"])
            miss = max(low - share, share - high, 0.0)
            told += 1
            misses.append((miss, kind, work["stretch"], gain["share"], share))
        draw, best_drawn = random.Random(seed), (-1.0, None)
        walls = extents(said["works"])
        for _ in range(sample if walls else 0):
            elements, a, b = draw.choice(walls)
            size = math.dist(a, b) - 2 * JOINT_M
            width = draw.choice([w for w in (0.9, 1.2, 1.8, 2.4) if w <= size])
            way = ((b[0] - a[0]) / math.dist(a, b), (b[1] - a[1]) / math.dist(a, b))
            start = JOINT_M + draw.uniform(0, size - width)
            stretch = [(a[0] + way[0] * s, a[1] + way[1] * s) for s in (start, start + width)]
            share = made(stretch, elements)
            if share is not None:
                best_drawn = max(best_drawn, (share, stretch))
        allowed = [w["gain"]["visibility"]["share"] for w in said["works"] if w["kind"] == "open" and w["is_allowed"]]
    within = sum(1 for m in misses if m[0] <= ROUGHLY)
    worst = max(misses, default=(0.0, "", None, 0.0, 0.0))
    print(f"{os.path.basename(file):38} made {told:3}  as told {within:3}  largest miss {100 * worst[0]:.1f} % "
          f"({worst[1]} {worst[2]}: told {100 * worst[3]:+.1f}, measured {100 * worst[4]:+.1f})  "
          f"best opening told {100 * max(allowed, default=0):+.1f} %, of the sample {100 * best_drawn[0]:+.1f} %", flush=True)
    return misses


def main():
    of = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    of.add_argument("program")
    of.add_argument("files", nargs="+")
    of.add_argument("--most", type=int, default=6)
    of.add_argument("--sample", type=int, default=20)
    of.add_argument("--seed", type=int, default=1)
    args = of.parse_args()
    misses = []
    for file in args.files:
        try:
            misses += judge(args.program, file, args.most, args.sample, args.seed)
        except Exception as error:  # noqa: BLE001  (one drawing that fails does not end the others)
            print(f"{os.path.basename(file):38} {type(error).__name__}: {error}", flush=True)
    within = sum(1 for m in misses if m[0] <= ROUGHLY)
    print(f"in all: {within} of {len(misses)} works measure what was told")


if __name__ == "__main__":
    main()
