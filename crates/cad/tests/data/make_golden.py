"""Makes the drawings of this folder that need a second opinion, and what ezdxf says they show.

    python make_golden.py            (needs: pip install ezdxf)
    python make_golden.py FILE.dxf   prints what ezdxf draws for one file

A line of an .expected.txt is one curve seen from above: x,y pairs, dense enough for 0.1 % of its size.
"""
import os
import sys

import ezdxf
from ezdxf.math import Matrix44
from ezdxf.path import make_path

HERE = os.path.dirname(os.path.abspath(__file__))
KINDS = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"}


def curves(entities, fineness, outer=Matrix44()):
    for e in entities:
        kind = e.dxftype()
        if kind == "INSERT":
            copies = e.multi_insert() if e.mcount > 1 else [e]
            for copy in copies if e.block() is not None else []:
                yield from curves(e.block(), fineness, copy.matrix44() * outer)
        elif kind in KINDS and not (kind == "POLYLINE" and (e.is_poly_face_mesh or e.is_polygon_mesh)):
            if e.dxf.invisible:
                continue
            path = make_path(e)
            if len(path) == 0:
                continue
            path = path.transform(outer)
            size = max(max(abs(c) for c in (v - path.start)) for v in path.control_vertices()) or 1.0
            yield [(v.x, v.y) for v in path.flattening(size * fineness, segments=4)]


def model(doc):
    try:
        return doc.modelspace()
    except KeyError:
        return doc.blocks.get("*Model_Space")


def text(filename, fineness, digits):
    doc = ezdxf.readfile(filename)
    lines = [" ".join(f"{x:.{digits}g},{y:.{digits}g}" for x, y in curve) for curve in curves(model(doc), fineness)]
    return "\n".join(lines) + "\n"


def draw(target, scale=1.0):
    """One of each kind, unsymmetrical on purpose."""
    target.add_line((0, 0), (4 * scale, 1))
    target.add_lwpolyline([(0, 0, 0, 0, 0.4), (3, 0, 0, 0, 0), (3, 2, 0, 0, -0.7), (1, 2.5)], format="xyseb", close=True)
    target.add_polyline2d([(5, 0, 0.3), (6, 1, 0), (7, 0, -1)], format="xyb")
    target.add_arc((1, 4), 1.5, 20, 200)
    target.add_circle((4, 4), 0.75)
    target.add_ellipse((6, 4), (1.2, 0.5), 0.4, 0.3, 4.0)
    target.add_open_spline([(0, 6), (1, 8), (3, 5), (5, 7.5), (6, 6)])
    target.add_polyline3d([(7, 6, 1), (8, 7, 2), (9, 6, 3)])


def shapes():
    doc = ezdxf.new("R2010")
    doc.header["$INSUNITS"] = 6
    msp = doc.modelspace()
    draw(msp)
    for extrusion in ((0, 0, -1), (0, 0.6, 0.8), (1, 0, 0)):
        a = {"extrusion": extrusion}
        msp.add_lwpolyline([(20, 0, 0, 0, 0.4), (23, 0, 0, 0, 0), (23, 2, 0, 0, -0.7), (21, 2.5)], format="xyseb",
                           close=True, dxfattribs=a | {"elevation": 2})
        msp.add_polyline2d([(25, 0, 0.3), (26, 1, 0), (27, 0, -1)], format="xyb", dxfattribs=a)
        msp.add_arc((21, 4), 1.5, 20, 200, dxfattribs=a)
        msp.add_arc((21, 9), 1.5, 300, 40, dxfattribs=a)
        msp.add_circle((24, 4, 3), 0.75, dxfattribs=a)
    msp.add_ellipse((46, 4), (1.2, 0.5), 0.4, 0.3, 4.0, dxfattribs={"extrusion": (0, 0, -1)})
    msp.add_rational_spline([(40, 0), (41, 2), (43, -1), (44, 1)], [1, 3, 2, 1])
    msp.add_open_spline([(50, 0), (52, 2), (54, 0), (52, -2)], degree=2)
    msp.add_spline([(60, 0), (61, 2), (63, -1), (66, 1), (66, 3)])
    return doc


def blocks():
    doc = ezdxf.new("R2010")
    doc.header["$INSUNITS"] = 6
    msp = doc.modelspace()
    draw(doc.blocks.new("A", base_point=(1, 2)))
    middle = doc.blocks.new("B", base_point=(0, -1))
    middle.add_blockref("A", (3, 1), dxfattribs={"rotation": 30})
    middle.add_blockref("A", (-3, 1), dxfattribs={"xscale": -0.5, "yscale": 0.5})
    middle.add_line((0, 0), (1, 0), dxfattribs={"layer": "OWN"})
    top = doc.blocks.new("C")
    top.add_blockref("B", (0, 0), dxfattribs={"extrusion": (0, 0, -1), "rotation": 15})
    cases = [
        {}, {"rotation": 77}, {"xscale": -1}, {"yscale": -2, "xscale": 2, "rotation": 10},
        {"xscale": 2, "yscale": 0.5, "rotation": 20}, {"extrusion": (0, 0, -1), "rotation": 40},
        {"extrusion": (0, 0, -1), "xscale": -1.5, "yscale": 1.5},
        {"column_count": 3, "row_count": 2, "column_spacing": 12, "row_spacing": 9, "rotation": 5},
        {"column_count": 2, "row_count": 2, "column_spacing": 12, "row_spacing": 9, "xscale": 0.5, "yscale": 0.5,
         "extrusion": (0, 0, -1)},
    ]
    for i, attributes in enumerate(cases):
        for k, name in enumerate("AC"):
            msp.add_blockref(name, (60 * i, 90 * k), dxfattribs=attributes)
    return doc


def main():
    if len(sys.argv) > 1:
        sys.stdout.write(text(sys.argv[1], 1e-4, 14))
        return
    for name, make in (("shapes", shapes), ("blocks", blocks)):
        target = os.path.join(HERE, name + ".dxf")
        make().saveas(target)
        with open(os.path.join(HERE, name + ".expected.txt"), "w") as out:
            out.write(text(target, 1e-3, 7))


main()
