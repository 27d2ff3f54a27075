#!/usr/bin/env python3
"""Whether a written work changes the drawing where it stands and nowhere else, by other programs.

    kept.py ENFILADE FILE… [--most N]

Of every file up to N listed works of each kind (default 2) are written by `enfilade works FILE --make`, and the new file is
held against the old one:
DXF: no record is gone, none but the layer of a demolished one and geometry changes; what is drawn differs only round the
work; ezdxf finds no error that was not there.
IFC: no instance is gone or changed, but what is added; IfcOpenShell finds no error that was not there.
glTF: scenes leave out nodes, meshes of the wall have other vertices; all else, and the bytes of all buffers, stay.
A row for each file: works written, how many are clean. Exit 1 where one is not. Needs ezdxf and shapely, ifcopenshell.
"""

import argparse
import json
import logging
import os
import re
import shutil
import struct
import sys
import tempfile
from collections import Counter

from works import NAMES_M, enfilade

# What lies so far from a stretch of wall is not of the work: a thick wall and what is drawn at it.
BESIDE_M = 0.7
# What differs less is rounding, metres.
ROUNDING_M = 1e-4
# Group codes of points, bulges, lengths and angles; counts of vertices.
GEOMETRY = set(range(10, 19)) | set(range(20, 29)) | set(range(30, 39)) | {40, 41, 42, 43, 49, 50, 51, 71, 72, 73, 90, 93}
# Kinds with which a door may go, and how far its leaf reaches.
WITH_A_DOOR, LEAF_M = ("remove", "close", "widen", "rehang", "end", "door"), 1.5
OWN = "EF-"


def records(path):
    """Pairs of every record of a text DXF that has a handle."""
    with open(path, "rb") as f:
        lines = f.read().split(b"\n")
    out, now = {}, []

    def close():
        handle = next((v for c, v in now if c in (5, 105)), None)
        if handle is not None:
            out.setdefault(handle, now)

    for code, value in zip(lines[::2], lines[1::2]):
        code, value = int(code), value.strip()
        if code == 0:
            close()
            now = []
        now.append((code, value))
    close()
    return out


def drawn(path):
    """What the model space shows beside our layers, as straight pieces, and what ezdxf finds wrong."""
    import ezdxf
    from ezdxf import disassemble, recover

    doc, auditor = recover.readfile(path)
    pieces = Counter()
    shown = [e for e in doc.modelspace() if not e.dxf.layer.startswith(OWN)]
    for part in disassemble.to_primitives(disassemble.recursive_decompose(shown), max_flattening_distance=0.01):
        if part.entity.dxf.layer.startswith(OWN):
            continue
        vertices = [(round(v.x, 6), round(v.y, 6)) for v in part.vertices()]
        for a, b in zip(vertices, vertices[1:]):
            pieces[(min(a, b), max(a, b))] += 1
    return pieces, {(e.code, str(e.entity)) for e in auditor.errors}


def dxf(before, after, work, unit_m):
    from shapely.geometry import LineString
    from shapely.ops import unary_union

    old, new = records(before), records(after)
    for handle, pairs in old.items():
        now = new.get(handle)
        if now is None:
            yield f"record {handle.decode()} is gone"
        elif pairs[0][1] in (b"TABLE", b"DICTIONARY", b"SECTION") or pairs == now:
            continue
        else:
            # Of an outline that is cut the flag that closes it goes too.
            free = GEOMETRY | ({70} if pairs[0][1] == b"LWPOLYLINE" else set())
            is_demolished = (8, b"EF-DEMOLISHED") in now
            free |= {8} if is_demolished else set()
            if [p for p in pairs if p[0] not in free] != [p for p in now if p[0] not in free]:
                yield f"{pairs[0][1].decode()} {handle.decode()} changed in more than its geometry"
    try:
        was, errors = drawn(before)
    except Exception:  # noqa: BLE001  (what ezdxf does not read as it was tells nothing)
        return
    is_now, found = drawn(after)
    lines = lambda pieces: unary_union([LineString(p) for p in pieces if p[0] != p[1]])  # noqa: E731
    gone, came = lines((was - is_now).keys()), lines((is_now - was).keys())
    near = BESIDE_M + (LEAF_M if work["kind"] in WITH_A_DOOR else 0.0)
    zone = LineString([[c / unit_m for c in p] for p in work["stretch"]]).buffer(near / unit_m)
    hair = ROUNDING_M / unit_m
    for what, kind in ((gone.difference(came.buffer(hair)), "gone"), (came.difference(gone.buffer(hair)), "new")):
        outside = what.difference(zone)
        if outside.length > hair:
            yield f"{kind} beside the work: {outside.length * unit_m:.3f} m at {[round(v) for v in outside.bounds]}"
    for error in sorted(found - errors)[:3]:
        yield f"ezdxf: {error}"


def instances(path):
    with open(path, "rb") as f:
        text = f.read()
    token = re.compile(rb"'(?:\\S\\.|''|[^'])*'|/\*.*?\*/|;", re.S)
    out, start = {}, 0
    for m in token.finditer(text):
        if m.group() == b";":
            one = re.match(rb"\s*(?:/\*.*?\*/\s*)*#\s*(\d+)\s*=", text[start:m.end()], re.S)
            if one:
                out[int(one.group(1))] = text[start:m.end()].strip()
            start = m.end()
    return out


def grew(was, now):
    """Whether a relation only names more instances in its list."""
    lists = re.compile(rb"\(((?:#\d+,)*#\d+)\)")
    old, new = lists.findall(was), lists.findall(now)
    more = len(old) == len(new) and all(n.split(b",")[: len(o.split(b","))] == o.split(b",") for o, n in zip(old, new))
    return b"IFCREL" in was and more and lists.sub(b"()", was) == lists.sub(b"()", now)


def ifc(before, after, _work, _unit_m):
    import ifcopenshell
    import ifcopenshell.validate

    old, new = instances(before), instances(after)
    for number, text in old.items():
        if new.get(number) != text and not grew(text, new.get(number, b"")):
            yield f"#{number} {'is gone' if number not in new else 'changed'}"

    def errors(path):
        logger = ifcopenshell.validate.json_logger()
        ifcopenshell.validate.validate(ifcopenshell.open(path), logger)
        # Without the instance: one that had an error may name more.
        return Counter(re.sub(r"#\d+=.*", "", str(s.get("message")), flags=re.S)[:90] for s in logger.statements)

    for message, count in (errors(after) - errors(before)).items():
        yield f"IfcOpenShell: {count} × {message}"


def scene(path):
    with open(path, "rb") as f:
        data = f.read()
    if data[:4] != b"glTF":
        return json.loads(data), b""
    length = struct.unpack_from("<I", data, 12)[0]
    body = 20 + length
    return json.loads(data[20:body]), data[body + 8 : body + 8 + struct.unpack_from("<I", data, body)[0]] if body < len(data) else b""


def gltf(before, after, work, _unit_m):
    (old, old_bytes), (new, new_bytes) = scene(before), scene(after)
    if not new_bytes.startswith(old_bytes.rstrip(b"\0")):
        yield "bytes of the buffer changed"
    for was, now in zip(old.get("scenes", []), new["scenes"]):
        shown = iter(was.get("nodes", []))
        kept = [n for n in now.get("nodes", []) if n < len(old["nodes"])]
        if not all(any(n == m for m in shown) for n in kept):
            yield "a scene shows its nodes in another order"
    named = [int(w["path"].split("/")[2]) for w in work["wall"] if w.get("path", "").startswith("/nodes/")]
    own = {old["nodes"][n].get("mesh") for n in named}
    for key, items in old.items():
        if not isinstance(items, list) or key in ("scenes", "buffers", "extensionsUsed"):
            continue
        if len(new.get(key, [])) < len(items):
            yield f"{key} vanished"
        for i, (was, now) in enumerate(zip(items, new.get(key, []))):
            if key == "meshes" and i in own:
                strip = lambda m: [{k: v for k, v in p.items() if k not in ("attributes", "indices")} for p in m["primitives"]]  # noqa: E731
                if strip(was) != strip(now) or {**was, "primitives": 0} != {**now, "primitives": 0}:
                    yield f"mesh {i} changed in more than its vertices"
            elif key == "nodes" and was != now:
                # A node below another is taken out of its list; a demolished one says so.
                free = {"children": 0, "extras": {k: v for k, v in was.get("extras", {}).items() if k != "enfilade"}}
                bare = {**now.get("extras", {})}
                bare.pop("enfilade", None)
                if {**was, **free} != {**now, "children": 0, "extras": bare}:
                    yield f"node {i} changed"
            elif was != now:
                yield f"{key} {i} changed"


JUDGES = {".dxf": dxf, ".ifc": ifc, ".glb": gltf, ".gltf": gltf}


def judge(program, file, most):
    said = json.loads(enfilade(program, "works", file, "--json"))
    suffix = os.path.splitext(file)[1].lower()
    unit_m = NAMES_M.get(said["input"].get("unit"), 1.0)
    counts, rows = Counter(), []
    for work in sorted(said["works"], key=lambda w: not w["is_allowed"]):
        kind = work["kind"]
        if counts[kind] >= most:
            continue
        counts[kind] += 1
        with tempfile.TemporaryDirectory() as folder:
            here = os.path.join(folder, os.path.basename(file))
            shutil.copy(file, here)
            side_car = os.path.splitext(file)[0] + ".enfilade.toml"
            if os.path.exists(side_car):
                shutil.copy(side_car, os.path.splitext(here)[0] + ".enfilade.toml")
            enfilade(program, "works", here, "--make", str(work["id"]))
            made = [f for f in os.listdir(folder) if f.endswith(suffix) and f != os.path.basename(file)]
            wrong = list(JUDGES[suffix](here, os.path.join(folder, made[0]), work, unit_m)) if made else ["not written"]
        rows.append((kind, work["id"], wrong))
    clean = sum(1 for r in rows if not r[2])
    print(f"{os.path.basename(file):38} written {len(rows):3}  clean {clean:3}  {dict(counts)}", flush=True)
    for kind, number, wrong in rows:
        for text in wrong[:4]:
            print(f"    {kind} {number}: {text}", flush=True)
    return rows


def main():
    of = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    of.add_argument("program")
    of.add_argument("files", nargs="+")
    of.add_argument("--most", type=int, default=2)
    args = of.parse_args()
    logging.disable(logging.CRITICAL)
    rows = []
    for file in args.files:
        try:
            rows += judge(args.program, file, args.most)
        except Exception as error:  # noqa: BLE001  (one drawing that fails does not end the others)
            print(f"{os.path.basename(file):38} {type(error).__name__}: {error}", flush=True)
            rows.append(("", 0, [str(error)]))
    clean = sum(1 for r in rows if not r[2])
    print(f"in all: {clean} of {len(rows)} works change nothing else")
    sys.exit(clean < len(rows))


if __name__ == "__main__":
    main()
