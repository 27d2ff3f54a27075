"""draw_plans.py: floor plans with known truth and a label for every entity, to train and to test the reading of drawings.

    draw_plans.py cut THINGS IFC...          storeys of IFC models cut at plan height by IfcOpenShell: THINGS/NAME-N.json
    draw_plans.py dxf THINGS FOLDER...       the same from folders that ifc_plans.py has drawn (from their named.dxf)
    draw_plans.py plans THINGS OUT NAME...   four plain styles and the truth: OUT/NAME/{named,one,numbered,blocks}.{dxf,json}, truth.dxf
    draw_plans.py vary THINGS OUT SEED COUNT NAME...   COUNT mixed styles with the noise of real sheets: OUT/NAME-K/{plan.dxf,plan.json,openings.json}, truth.dxf
    draw_plans.py hard THINGS OUT SEED COUNT NAME...   the same, most on one layer and with what looks like walls

The label file: {unit_m, views: [{kind, box}], labels: {handle: class}}, blocks' entities included. Drawings must not be committed.
Needs Python with ezdxf, shapely and numpy; `cut` also ifcopenshell.
"""
import json, math, os, random, re, sys
import xml.etree.ElementTree as ET
import ezdxf
from shapely import affinity
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box
from shapely.ops import unary_union

SCALE = 0.1  # SVG millimetres at 1:100 to metres
WALL = ("IfcWall", "IfcWallStandardCase", "IfcWallElementedCase")
GLASS = ("IfcWindow", "IfcPlate", "IfcMember", "IfcCurtainWall")
OPAQUE = WALL + GLASS + ("IfcColumn",)
LAYER = {"IfcDoor": "DOORS", "IfcWindow": "WINDOWS", "IfcColumn": "COLUMNS", "IfcStair": "STAIRS", "IfcStairFlight": "STAIRS", "IfcFurnishingElement": "FURNITURE", "IfcFurniture": "FURNITURE", "IfcRailing": "RAILING", "IfcSlab": "FLOOR", "IfcFlowTerminal": "SANITARY", "IfcSanitaryTerminal": "SANITARY", "IfcPlate": "GLAZING", "IfcMember": "GLAZING", "IfcCurtainWall": "GLAZING", "IfcBeam": "BEAMS", "IfcRoof": "ROOF", "IfcCovering": "FINISHES"}
KIND = {v: k for k, v in reversed(LAYER.items())} | {"WALLS": "IfcWall", "MISC": "IfcBuildingElementProxy"}

def label(kind):
    if kind in WALL: return "wall"
    if kind in GLASS: return "window"
    for start, name in (("IfcColumn", "column"), ("IfcDoor", "door"), ("IfcStair", "stair"), ("IfcRamp", "stair"), ("IfcFurn", "furniture"), ("IfcSystemFurniture", "furniture"), ("IfcFlowTerminal", "sanitary"), ("IfcSanitary", "sanitary"), ("IfcRailing", "railing")):
        if kind.startswith(start): return name
    return "other"

# ---- storeys as things: [kind, cut, [[points, closed]...]] in metres

def rings(d):
    for part in re.findall(r"M[^M]*", d):
        pts = [(round(float(x) * SCALE, 5), round(-float(y) * SCALE, 5)) for x, y in re.findall(r"(-?[\d.eE+-]+),(-?[\d.eE+-]+)", part)]
        if len(pts) > 1: yield [pts, part.strip().upper().endswith("Z")]

def cut(out, files):
    import ifcopenshell, ifcopenshell.draw as draw
    svg_ns = "{http://www.w3.org/2000/svg}"
    os.makedirs(out, exist_ok=True)
    for f in files:
        name = os.path.splitext(os.path.basename(f))[0]
        try:
            s = draw.draw_settings(auto_floorplan=True, door_arcs=True, width=8000, height=8000, scale=1 / 100, include_projection=False, exclude_entities="IfcOpeningElement,IfcSpace,IfcSite")
            svg = ET.fromstring(draw.main(s, [ifcopenshell.open(f)], merge_projection=False))
        except Exception as e:
            print(name, "not drawn:", type(e).__name__, str(e)[:80], flush=True); continue
        levels = [g for g in svg.iter(svg_ns + "g") if g.get("class") == "IfcBuildingStorey"]
        for n, g in enumerate(levels):
            things = []
            for e in g.findall(svg_ns + "g"):
                words = (e.get("class") or "").split()
                if not words: continue
                shapes = [r for p in e.iter(svg_ns + "path") for r in rings(p.get("d"))]
                closed = [r for r in shapes if words[-1] != "IfcDoor" or r[1]]  # door swings are open paths
                loose = [r for r in shapes if r not in closed]
                if closed: things.append([words[-1], True, closed])
                if loose: things.append([words[-1], False, loose])
            walls = sum(len(s) for k, c, s in things if k in WALL and c)
            if walls >= 6 and any(k == "IfcDoor" for k, _, _ in things):
                storey = next((v for k, v in g.attrib.items() if k.endswith("name")), "?")
                json.dump({"name": storey, "things": things}, open(f"{out}/{name}-{n}.json", "w"))
                print(f"{name}-{n}", repr(storey), walls, "walls", sum(k == "IfcDoor" and c for k, c, _ in things), "doors", flush=True)

def from_dxf(out, folders):
    """Things of a drawn folder: the layers of named.dxf say the class, closed polylines are cut, a LINE and the ARC after it a swing."""
    os.makedirs(out, exist_ok=True)
    for folder in folders:
        things, line = [], None
        for e in ezdxf.readfile(f"{folder}/named.dxf").modelspace():
            layer = e.dxf.layer; kind = KIND.get(layer, "IfcBuildingElementProxy")
            if layer == "EF-QUERY": continue
            if e.dxftype() == "LINE": line = e
            elif e.dxftype() == "ARC" and line:
                c, r, a, b = e.dxf.center, e.dxf.radius, math.radians(e.dxf.start_angle), math.radians(e.dxf.end_angle)
                b += 2 * math.pi if b < a else 0
                arc = [(c.x + r * math.cos(a + (b - a) * i / 16), c.y + r * math.sin(a + (b - a) * i / 16)) for i in range(17)]
                if math.dist(arc[-1], line.dxf.end.vec2) < math.dist(arc[0], line.dxf.end.vec2): arc.reverse()
                things.append([kind, False, [[[(c.x, c.y)] + arc, False]]]); line = None
            elif e.dxftype() == "LWPOLYLINE":
                pts = [tuple(p) for p in e.get_points("xy")]
                things.append([kind, bool(e.closed), [[pts + pts[:1] if e.closed else pts, bool(e.closed)]]])
        json.dump({"name": "?", "things": things}, open(f"{out}/{os.path.basename(folder)}.json", "w"))

def load(things_dir, name):
    return json.load(open(f"{things_dir}/{name}.json"))["things"]

# ---- the four plain styles, as ifc_plans.py draws them

def doc(unit=6):
    d = ezdxf.new("R2010"); d.header["$INSUNITS"] = unit; d.header["$MEASUREMENT"] = 1
    return d

def layer_of(d, name, **more):
    if name not in d.layers: d.layers.add(name, **more)
    return name

def polyline(space, pts, closed, layer, explode=False):
    layer_of(space.doc, layer)
    pts = [tuple(p) for p in pts]; made = []
    if closed and pts[0] == pts[-1]: pts = pts[:-1]
    if explode:
        for a, b in zip(pts, pts[1:] + (pts[:1] if closed else [])):
            if a != b: made.append(space.add_line(a, b, dxfattribs={"layer": layer}))
    elif len(pts) > 1:
        made.append(space.add_lwpolyline(pts, close=closed, dxfattribs={"layer": layer}))
    return made

def swing(space, pts, layer):
    """Leaf and arc of a door from its open path: hinge, then points as far from it; none if it is no swing."""
    rest = pts[1:]; rs = [math.dist(pts[0], p) for p in rest]
    if len(rest) < 5 or not 0.3 < rs[0] < 2 or max(rs) - min(rs) > 0.01: return []
    layer_of(space.doc, layer)
    angle = lambda p: math.degrees(math.atan2(p[1] - pts[0][1], p[0] - pts[0][0]))
    a, b, mid = angle(rest[0]), angle(rest[-1]), angle(rest[len(rest) // 2])
    if (mid - a) % 360 > (b - a) % 360: a, b = b, a
    return [space.add_line(pts[0], rest[0], dxfattribs={"layer": layer}), space.add_arc(tuple(pts[0]), rs[0], a, b, dxfattribs={"layer": layer})]

def footprint(things):
    solid = [Polygon(p).buffer(0.4) for k, c, shapes in things if c and k in OPAQUE + ("IfcDoor",) for p, _ in shapes if len(p) > 3]
    parts = unary_union([g.buffer(0) for g in solid])
    parts = list(getattr(parts, "geoms", [parts]))
    shrunk = [Polygon(p.exterior).buffer(-0.45) for p in parts if not p.is_empty]
    return [r for r in shrunk if not r.is_empty and r.geom_type == "Polygon" and r.area > 8]

def write_labels(path, unit_m, views, labels):
    json.dump({"unit_m": unit_m, "views": views, "walls_labelled": True, "labels": labels}, open(path, "w"), indent=0)

def plans(things_dir, out, names):
    for name in names:
        things = load(things_dir, name); folder = f"{out}/{name}"; os.makedirs(folder, exist_ok=True)
        region = footprint(things)
        every = [p for _, _, shapes in things for pts, _ in shapes for p in pts]
        view = [{"kind": "plan", "box": [round(f(p[i] for p in every), 4) for f in (min, max) for i in (0, 1)]}]
        def mark(d): return [e for r in region for e in polyline(d.modelspace(), list(r.exterior.coords)[:-1], True, "EF-QUERY")]
        t = doc(); mark(t)
        for kind, is_cut, shapes in things:
            if kind in OPAQUE and is_cut:
                for pts, _ in shapes: polyline(t.modelspace(), pts, True, "WALLS")
        t.saveas(f"{folder}/truth.dxf")
        numbers = {k: f"L{n:02d}" for n, k in enumerate(sorted({LAYER.get(k, k) for k, _, _ in things} | {"WALLS"}), 11)}
        for variant in ("named", "one", "numbered", "blocks"):
            d = doc(); n = 0; labels = {}
            for kind, is_cut, shapes in things:
                word = "WALLS" if kind in WALL else LAYER.get(kind, "MISC")
                layer = {"named": word, "one": "0", "numbered": numbers.get(word, "L99"), "blocks": "A-WALL" if kind in WALL else word}[variant]
                space, made = d.modelspace(), []
                if variant == "blocks" and kind in ("IfcDoor", "IfcWindow"):
                    n += 1; space = d.blocks.new(f"{'DR' if kind == 'IfcDoor' else 'WN'}{n}")
                    made.append(d.modelspace().add_blockref(space.name, (0, 0), dxfattribs={"layer": "0"})); layer = "0"
                for pts, closed in shapes:
                    leaf = swing(space, pts, layer) if kind == "IfcDoor" and not is_cut and variant != "numbered" else []
                    made += leaf or polyline(space, pts, closed or is_cut, layer, variant in ("one", "numbered") and len(pts) < 12)
                for e in made: labels[e.dxf.handle] = label(kind)
            for e in mark(d): labels[e.dxf.handle] = "other"
            d.saveas(f"{folder}/{variant}.dxf"); write_labels(f"{folder}/{variant}.json", 1.0, view, labels)
        print(name, flush=True)

# ---- what a storey is made of: openings and rooms found again in its cut lines

def parts(g):
    return [p for p in getattr(g, "geoms", [g]) if p.geom_type == "Polygon" and not p.is_empty]

def frame(geom):
    """Centre, long axis (unit), length and depth of the least rectangle round it."""
    r = geom.minimum_rotated_rectangle
    if r.geom_type != "Polygon": return None
    c = list(r.exterior.coords); a, b = math.dist(c[0], c[1]), math.dist(c[1], c[2])
    (p, q), long, short = ((c[0], c[1]), a, b) if a >= b else ((c[1], c[2]), b, a)
    if long < 1e-6: return None
    return (r.centroid.x, r.centroid.y), ((q[0] - p[0]) / long, (q[1] - p[1]) / long), long, short

def gap(walls, m, u, expect):
    """The opening in the walls at m along u: (centre, u, width, depth), or None."""
    v = (-u[1], u[0]); best = None
    for shift in (0, .06, -.06, .12, -.12, .2, -.2):
        p = (m[0] + v[0] * shift, m[1] + v[1] * shift)
        if walls.intersects(Point(p)): continue
        ends = []
        for s in (-1, 1):
            hit = LineString([p, (p[0] + s * u[0] * (expect / 2 + .5), p[1] + s * u[1] * (expect / 2 + .5))]).intersection(walls)
            ends.append(Point(p).distance(hit) if not hit.is_empty else None)
        if None in ends or not .75 * expect < sum(ends) < 1.35 * expect + .1: continue
        lo, hi = -9., 9.
        for s, d in zip((-1, 1), ends):
            q = (p[0] + s * u[0] * (d + .03), p[1] + s * u[1] * (d + .03))
            inside = LineString([(q[0] - v[0] * .9, q[1] - v[1] * .9), (q[0] + v[0] * .9, q[1] + v[1] * .9)]).intersection(walls)
            spans = [[(c[0] - q[0]) * v[0] + (c[1] - q[1]) * v[1] for c in (g.coords[0], g.coords[-1])] for g in getattr(inside, "geoms", [inside]) if g.geom_type == "LineString" and not g.is_empty]
            spans = [sorted(x) for x in spans if min(x) < .01 and max(x) > -.01]
            if not spans: break
            lo, hi = max(lo, spans[0][0]), min(hi, spans[0][1])
        if not .04 < hi - lo < .75: continue
        along, across = (ends[1] - ends[0]) / 2, (lo + hi) / 2
        c = (p[0] + u[0] * along + v[0] * across, p[1] + u[1] * along + v[1] * across)
        found = (abs(sum(ends) - expect), (c, u, sum(ends), hi - lo))
        if best is None or found[0] < best[0]: best = found
        if shift == 0: break
    return best and best[1]

def rect(c, u, length, depth):
    v = (-u[1], u[0])
    return [(c[0] + u[0] * i * length / 2 + v[0] * j * depth / 2, c[1] + u[1] * i * length / 2 + v[1] * j * depth / 2) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]

def is_swing(pts):
    rest = pts[1:]; rs = [math.dist(pts[0], p) for p in rest]
    return len(rest) >= 5 and .3 < rs[0] < 2 and max(rs) - min(rs) < .01

def from_hinge(pts):
    """The path of a swing from its hinge, wherever it was begun; other paths as they are."""
    if len(pts) < 7 or is_swing(pts): return pts
    ring = pts[:-1] if pts[0] == pts[-1] else pts
    for i, h in enumerate(ring):
        turned = [h] + ring[i + 1:] + ring[:i]
        if is_swing(turned): return turned
    return pts

class Storey:
    def __init__(self, things):
        every = [p for k, c, s in things if c and k in WALL for pts, _ in s for p in pts]
        cx, cy = ((min(p[i] for p in every) + max(p[i] for p in every)) / 2 for i in (0, 1))
        self.things = [[k, c, [[[(x - cx, y - cy) for x, y in pts], closed] for pts, closed in s]] for k, c, s in things]
        poly = lambda s: [g for pts, _ in s if len(pts) > 3 for g in parts(Polygon(pts).buffer(0))]
        self.wall_polys = [g for k, c, s in self.things if c and k in WALL for g in poly(s) if g.area > 1e-4]
        self.walls = unary_union([g.buffer(.001, join_style=2) for g in self.wall_polys])
        self.columns = [g for k, c, s in self.things if c and k == "IfcColumn" for g in poly(s)]
        solid = unary_union([self.walls] + self.columns)
        self.windows, self.panes, self.doors, self.rest, self.taken = [], [], [], [], []
        glass = [g for k, c, s in self.things if c and k == "IfcWindow" for g in poly(s)]
        for g in parts(unary_union([g.buffer(.06) for g in glass])):
            own = unary_union([x for x in glass if x.intersects(g)]); f = frame(own)
            o = f and f[2] > 1.2 * f[3] and gap(solid, f[0], f[1], f[2])
            if o: self.windows.append(o)
            else: self.panes += parts(own)
        self.panes += [g for k, c, s in self.things if c and k in GLASS[1:] for g in poly(s)]
        lines = [from_hinge(pts) for k, _, s in self.things if k == "IfcDoor" for pts, _ in s]
        for g in parts(unary_union([LineString(p).buffer(.08) for p in lines])):
            own = [p for p in lines if g.intersects(LineString(p))]
            self.doors.append(self.door(own, solid))
        self.doors = [d for d in self.doors if d["gap"] or any(not is_swing(p) for p in d["raw"])]  # swings alone are doors of other storeys
        body = [solid] + self.panes + [Polygon(rect(*o)) for o in self.windows] + [Polygon(rect(*d["gap"])) if d["gap"] else unary_union([LineString(p) for p in d["raw"]]).envelope for d in self.doors]
        self.footprint = [r for p in parts(unary_union([g.buffer(.4) for g in body])) for r in parts(Polygon(p.exterior).buffer(-.45)) if r.area > 8]
        for k, c, s in self.things:
            if k not in OPAQUE and k != "IfcDoor": self.rest.append((label(k), s, c))
        shut = [Polygon(rect(*o)).buffer(.02) for o in self.windows] + [Polygon(rect(*d["gap"])).buffer(.02) for d in self.doors if d["gap"]] + [g.buffer(.05) for g in self.panes]
        self.rooms = []
        for region in self.footprint:
            for r in parts(Polygon(region.exterior).buffer(.3).difference(unary_union([solid.buffer(.01)] + shut))):
                r = r.buffer(-.06).buffer(.06)
                for q in parts(r):
                    if q.area > 1.4 and q.within(Polygon(region.exterior).buffer(.2)): self.rooms.append(q.simplify(.02))
        self.box = (min(p[0] for p in every) - cx, min(p[1] for p in every) - cy, max(p[0] for p in every) - cx, max(p[1] for p in every) - cy)

    def door(self, own, solid):
        swings = [p for p in own if is_swing(p)]; still = [p for p in own if not is_swing(p)]
        tries = []
        if still:
            f = frame(unary_union([LineString(p) for p in still]))
            if f and .5 < f[2] < 4: tries.append((f[0], f[1], f[2]))
        if len(swings) == 2:
            a, b = swings[0][0], swings[1][0]; w = math.dist(a, b)
            if w > .7: tries.append((((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), ((b[0] - a[0]) / w, (b[1] - a[1]) / w), w))
        for p in swings[:2]:
            for e in (p[1], p[-1]):
                w = math.dist(p[0], e); tries.append((((p[0][0] + e[0]) / 2, (p[0][1] + e[1]) / 2), ((e[0] - p[0][0]) / w, (e[1] - p[0][1]) / w), w))
        for m, u, w in tries:
            o = gap(solid, m, u, w)
            if o and .45 < o[2] < 4: return {"gap": o, "swings": swings, "raw": own}
        return {"gap": None, "swings": swings, "raw": own}

# ---- layer names by hand of the office

CLASSES = "wall column door window stair furniture sanitary railing annotation dimension hatch grid outside title other area roof".split()
SCHEMES = {
    "aia": "A-WALL S-COLS A-DOOR A-GLAZ A-FLOR-STRS A-FURN A-FLOR-PFIX A-FLOR-HRAL A-ANNO-TEXT A-ANNO-DIMS A-WALL-PATT S-GRID L-SITE A-ANNO-TTLB A-FLOR-OTLN A-AREA A-ROOF",
    "en": "Walls Columns Doors Windows Stairs Furniture Sanitary Railings Text Dimensions Hatch Grid Landscape Titleblock Slab Areas Roof",
    "en2": "WALL COLUMN DOOR WINDOW STAIR FURN PLUMBING HANDRAIL NOTES DIM HATCHING CENTER SITE FRAME FLOOR ROOM-AREA ROOFLINE",
    "de": "Wände Stützen Türen Fenster Treppen Möbel Sanitär Geländer Texte Bemaßung Schraffur Achsen Aussenanlagen Plankopf Decke Raumpolygone Dach",
    "de2": "01_Mauerwerk 02_Stahlbeton 05_Tueren 06_Fenster 07_Treppe 20_Moeblierung 21_Sanitaer 08_Gelaender 30_Beschriftung 31_Massketten 15_Schraffuren 32_Achsraster 40_Gelaende 50_Rahmen 10_Boden 33_Flaechen 11_Dachkante",
    "fr": "MURS POTEAUX PORTES FENETRES ESCALIERS MOBILIER SANITAIRES GARDE-CORPS TEXTES COTATIONS HACHURES AXES EXTERIEURS CARTOUCHE DALLE SURFACES TOITURE",
    "es": "MUROS PILARES PUERTAS VENTANAS ESCALERAS MOBILIARIO SANITARIOS BARANDILLAS TEXTOS COTAS SOMBREADO EJES EXTERIOR CAJETIN FORJADO SUPERFICIES CUBIERTA",
    "it": "Muri Pilastri Porte Finestre Scale Arredi Sanitari Parapetti Testi Quote Campiture Assi Esterno Cartiglio Solaio Aree Copertura",
    "pt": "PAREDES PILARES PORTAS JANELAS ESCADAS MOBILIARIO LOUCAS GUARDA-CORPO TEXTO COTAS HACHURA EIXOS TERRENO CARIMBO LAJE AREAS COBERTURA",
    "zh": "墙体 柱 门 窗 楼梯 家具 洁具 栏杆 文字 标注 填充 轴线 室外 图框 楼板 面积 屋面",
    "tarch": "WALL COLUMN WINDOW WINDOW STAIR LVTRY LVTRY HANDRAIL PUB_TEXT PUB_DIM PUB_HATCH DOTE GROUND PUB_TITLE FLOOR SPACE ROOF",
    "ja": "壁 柱 建具 窓 階段 家具 衛生器具 手摺 文字 寸法 ハッチ 通り芯 外構 図枠 床 面積 屋根",
}
WORDS = {
    "en": (["Bedroom", "Living", "Dining", "Office", "Meeting", "Store", "Hall"], ["Bath", "WC", "Shower"], ["Kitchen"], "{:.1f} m²"),
    "de": (["Zimmer", "Wohnen", "Schlafen", "Büro", "Besprechung", "Abstell", "Flur"], ["Bad", "WC", "Dusche"], ["Küche"], "{:.2f} m²"),
    "fr": (["Chambre", "Séjour", "Bureau", "Salle à manger", "Dégagement", "Rangement"], ["SdB", "WC", "Sanitaires"], ["Cuisine"], "S={:.2f}m2"),
    "es": (["Dormitorio", "Salón", "Oficina", "Comedor", "Pasillo", "Trastero"], ["Baño", "Aseo"], ["Cocina"], "{:.2f} m2"),
    "it": (["Camera", "Soggiorno", "Ufficio", "Pranzo", "Disimpegno", "Ripostiglio"], ["Bagno", "WC"], ["Cucina"], "mq={:.2f}"),
    "zh": (["卧室", "客厅", "办公室", "餐厅", "走廊", "储藏"], ["卫生间", "浴室"], ["厨房"], "{:.2f}㎡"),
}
UNITS = {"mm": (.001, 4), "cm": (.01, 5), "m": (1., 6), "in": (.0254, 1), "ft": (.3048, 2)}
COLOURS = dict(zip(CLASSES, (7, 1, 3, 4, 2, 8, 5, 6, 7, 2, 9, 1, 94, 7, 252, 30, 40)))
WEIGHTS = dict(zip(CLASSES, (50, 50, 18, 25, 18, 13, 13, 13, 18, 13, 9, 9, 13, 35, 13, 13, 18)))

class Hand:
    """How the entities of a class are put on layers."""
    def __init__(self, rng, odds=(50, 13, 13, 9, 15)):
        self.rng = rng; kind = rng.choices(("names", "numbers", "pens", "one", "muddle"), odds)[0]
        self.kind, self.lang = kind, rng.choice(list(SCHEMES))
        self.layers = dict(zip(CLASSES, SCHEMES[self.lang].split()))
        if kind == "names" and rng.random() < .3:
            pre = rng.choice(("EG_", "xref$0$", "ARCH-", "1OG-", "PL_")); self.layers = {k: pre + v for k, v in self.layers.items()}
        if kind == "names" and rng.random() < .25:  # several classes share a layer
            for a, b in rng.sample([("sanitary", "furniture"), ("railing", "stair"), ("column", "wall"), ("area", "annotation"), ("grid", "dimension"), ("roof", "other"), ("hatch", "wall")], 3): self.layers[a] = self.layers[b]
        if kind == "numbers":
            order = CLASSES[:]; rng.shuffle(order); form = rng.choice(("L{:02d}", "{}", "Layer{}", "Ebene {}", "图层{}", "Calque {}", "AUSGABE_{:03d}"))
            self.layers = {k: form.format(n) for n, k in enumerate(order, rng.choice((1, 10, 100)))}
        if kind in ("pens", "one"): self.layers = {k: "0" for k in CLASSES}
        self.small = None
        if kind == "muddle":
            how = rng.randrange(5)
            if how == 0: self.layers["wall"] = "0"; self.small = SCHEMES[self.lang].split()[0]  # most walls on 0, a few on the wall layer
            elif how == 1: self.layers["door"] = self.layers["window"] = self.layers["wall"]
            elif how == 2: self.layers.update(wall="0", door="0", furniture="0", stair="0", window="0")
            elif how == 3: a = ["wall", "furniture", "outside", "annotation", "door", "other"]; b = [self.layers[x] for x in a]; rng.shuffle(b); self.layers.update(zip(a, b))
            else: self.layers.update({k: self.layers["wall"] for k in ("furniture", "sanitary", "stair", "hatch", "other", "door")})
        self.colours = dict(COLOURS)
        if rng.random() < .6:
            for k in CLASSES: self.colours[k] = rng.choice((1, 2, 3, 4, 5, 6, 7, 8, 9, 30, 40, 140, 252))
        if kind == "one" or rng.random() < .1: self.colours = {k: 7 for k in CLASSES}

    def attributes(self, d, what):
        layer = self.layers[what]
        if what == "wall" and self.small and self.rng.random() < .12: layer = self.small
        by_layer = {} if self.kind in ("pens", "one") else {"color": self.colours[what], "lineweight": WEIGHTS[what]}
        if layer not in d.layers: d.layers.add(layer, **by_layer)
        out = {"layer": layer}
        if self.kind == "pens": out |= {"color": self.colours[what], "lineweight": WEIGHTS[what]}
        return out

# ---- the drawing, first in metres about the storey's centre

class Sheet:
    def __init__(self, rng, hand):
        self.rng, self.hand, self.items, self.blocks, self.views = rng, hand, [], {}, []
        self.how = "ring"
    def add(self, what, kind, *data, cls=None, **more):
        self.items.append((what, cls or (what if what not in ("area", "roof") else "other"), kind, data, more))
    def line(self, what, a, b, **m): self.add(what, "line", a, b, **m)
    def pl(self, what, pts, closed=False, **m):
        pts = [tuple(p[:2]) for p in pts]
        if closed and pts[0] == pts[-1]: pts = pts[:-1]
        if len(pts) > 1: self.add(what, "pl", pts, closed, **m)
    def arc(self, what, c, r, a, b, **m): self.add(what, "arc", c, r, a, b, **m)
    def circle(self, what, c, r, **m): self.add(what, "circle", c, r, **m)
    def text(self, what, p, h, s, turn=0., **m): self.add(what, "text", p, h, s, turn, **m)
    def hatch(self, what, polys, pattern, scale=1., **m): self.add(what, "hatch", polys, pattern, scale, **m)
    def edges(self, what, pts, closed, how, **m):
        """A ring or chain as one polyline, as loose lines or as polylines of two points."""
        pts = [tuple(p[:2]) for p in pts]
        if closed and pts[0] == pts[-1]: pts = pts[:-1]
        if how == "ring": return self.pl(what, pts, closed, **m)
        for a, b in zip(pts, pts[1:] + (pts[:1] if closed else [])):
            if math.dist(a, b) > 1e-4: self.line(what, a, b, **m) if how == "lines" else self.pl(what, [a, b], **m)
    def polygon(self, what, g, how, **m):
        for r in [g.exterior, *g.interiors]: self.edges(what, r.coords, True, how, **m)
    def block(self, name, make):
        """A block whose contents make(sheet) draws."""
        if name not in self.blocks:
            inner = Sheet(self.rng, self.hand); make(inner); self.blocks[name] = inner.items
        return name
    def insert(self, what, name, p, turn, mirror=False, **m): self.add(what, "insert", name, p, turn, mirror, **m)

    def bounds(self, start=0):
        pts = []
        for what, cls, kind, data, _ in self.items[start:]:
            if kind == "line": pts += data
            elif kind == "pl": pts += data[0]
            elif kind in ("arc", "circle"): (x, y), r = data[:2]; pts += [(x - r, y - r), (x + r, y + r)]
            elif kind == "text": pts += [data[0], (data[0][0] + data[1] * .7 * len(data[2]), data[0][1] + data[1])]
            elif kind == "insert": pts.append(data[1])
            elif kind == "dim": pts += data[:3]
            elif kind == "hatch": pts += [p[:2] for g in data[0] for p in g.exterior.coords]
        xs, ys = [p[0] for p in pts], [p[1] for p in pts]
        return min(xs), min(ys), max(xs), max(ys)

    def write(self, path, k, turn, offset, code, dxf="R2010", query=()):
        """k drawing units a metre, turned by degrees, moved by offset (drawing units)."""
        d = ezdxf.new(dxf, setup=["linetypes"]); hand = self.hand; labels = {}
        d.header["$INSUNITS"] = code
        cs, sn = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        def world(p): return ((p[0] * cs - p[1] * sn) * k + offset[0], (p[0] * sn + p[1] * cs) * k + offset[1])
        def put(space, item, at, angle, inside):
            what, cls, kind, data, more = item
            att = {"layer": "0"} if inside and more.get("zero", True) and self.zero else hand.attributes(d, what)
            if more.get("dash"): att["linetype"] = more["dash"]; att["ltscale"] = k * .02
            made = []
            if kind == "line": made = [space.add_line(at(data[0]), at(data[1]), dxfattribs=att)]
            elif kind == "pl": made = [space.add_lwpolyline([at(p) for p in data[0]], close=data[1], dxfattribs=att)]
            elif kind == "spline": made = [space.add_spline([at(p) for p in data[0]], dxfattribs=att)]
            elif kind == "arc": made = [space.add_arc(at(data[0]), data[1] * k, data[2] + angle, data[3] + angle, dxfattribs=att)]
            elif kind == "circle": made = [space.add_circle(at(data[0]), data[1] * k, dxfattribs=att)]
            elif kind == "text":
                if more.get("mtext"): made = [space.add_mtext(data[2], dxfattribs=att | {"char_height": data[1] * k, "insert": at(data[0]), "rotation": data[3] + angle})]
                else: made = [space.add_text(data[2], height=data[1] * k, rotation=data[3] + angle, dxfattribs=att | {"insert": at(data[0])})]
            elif kind == "hatch":
                h = space.add_hatch(dxfattribs=att)
                if data[1] != "SOLID": h.set_pattern_fill(data[1], scale=data[2] * k * .01, angle=more.get("angle", 0))
                for g in data[0]:
                    h.paths.add_polyline_path([at(p) for p in g.exterior.coords], is_closed=True)
                    for r in g.interiors: h.paths.add_polyline_path([at(p) for p in r.coords], is_closed=True, flags=16)
                made = [h]
            elif kind == "dim":
                base, a, b, turn_by, h = data
                dim = space.add_linear_dim(base=at(base), p1=at(a), p2=at(b), angle=turn_by + angle, dimstyle="Standard", override={"dimtxt": h * k, "dimasz": h * .6 * k, "dimexe": h * .5 * k, "dimexo": h * k, "dimgap": h * .4 * k, "dimtad": 1, "dimdec": 0 if k > 50 else 2, "dimtsz": h * .4 * k}, dxfattribs=att)
                dim.render(); made = [dim.dimension]
                for e in d.blocks.get(dim.dimension.dxf.geometry): labels[e.dxf.handle] = cls
            elif kind == "insert":
                name, p, r, mirror = data
                if name not in d.blocks:
                    b = d.blocks.new(name)
                    for i in self.blocks[name]: put(b, i, lambda q: (q[0] * k, q[1] * k), 0, True)
                made = [space.add_blockref(name, at(p), dxfattribs=att | {"rotation": r + angle, "yscale": -1 if mirror else 1})]
            for e in made: labels[e.dxf.handle] = cls
        for item in self.items: put(d.modelspace(), item, world, turn, False)
        for r in query:
            for e in polyline(d.modelspace(), [world(p) for p in r.exterior.coords][:-1], True, "EF-QUERY"): labels[e.dxf.handle] = "other"
        d.saveas(path)
        views = []
        for kind, (x0, y0, x1, y1) in self.views:
            c = [world(p) for p in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
            views.append({"kind": kind, "box": [round(f(p[i] for p in c), 6) for f in (min, max) for i in (0, 1)]})
        write_labels(os.path.splitext(path)[0] + ".json", 1 / k, views, labels)
        return world

# ---- drawing the parts of a storey in one of many ways

def draw_walls(s, st, mix):
    how = mix["wall"]; truth = []
    if how == "single":
        for g in st.wall_polys:
            f = frame(g)
            if not f or f[3] > .6: s.polygon("wall", g, "ring"); truth.append(list(g.exterior.coords)); continue
            (x, y), u, l, _ = f; a, b = (x - u[0] * l / 2, y - u[1] * l / 2), (x + u[0] * l / 2, y + u[1] * l / 2)
            s.line("wall", a, b); truth.append([a, b])
        return truth
    merged = parts(st.walls.buffer(.004, join_style=2).buffer(-.005, join_style=2).simplify(.002))
    polys = merged if how.startswith("union") else st.wall_polys
    kind = {"outline": "ring", "lines": "lines", "two": "two", "union": "ring", "union-lines": "lines"}[how]
    for g in polys: s.polygon("wall", g, kind)
    fill = mix["fill"]
    if fill in ("SOLID", "ANSI31", "ANSI32", "AR-CONC"):
        if s.rng.random() < .5: s.hatch("hatch", merged, fill, s.rng.choice((1, 2, 4)))
        else:
            for g in polys: s.hatch("hatch", [g], fill, s.rng.choice((1, 2)))
    elif fill == "strokes":  # masonry hatch drawn as lines
        x0, y0, x1, y1 = st.walls.bounds; step = s.rng.choice((.08, .12, .2)); n = int((x1 - x0 + y1 - y0) / step)
        if n < 1500:
            for i in range(n):
                c = x0 - (y1 - y0) + i * step
                cut_ = LineString([(c, y0), (c + (y1 - y0), y1)]).intersection(st.walls)
                for g in getattr(cut_, "geoms", [cut_]):
                    if g.geom_type == "LineString" and g.length > .03: s.line("hatch", g.coords[0], g.coords[-1])
    if mix["finish"]:
        for g in merged:
            for q in parts(g.buffer(-mix["finish"], join_style=2)):
                s.polygon("wall", q, "ring" if kind == "ring" else "lines")
    return [list(r.coords) for g in st.wall_polys for r in [g.exterior, *g.interiors]]

def draw_columns(s, st, mix):
    for g in st.columns:
        s.polygon("column", g, "ring" if mix["wall"] != "lines" else "lines")
        if mix["column_fill"]: s.hatch("hatch", [g], "SOLID")

def _boxes(s, what, at, boxes):
    for x0, y0, x1, y1 in boxes: s.edges(what, [at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)], True, "ring" if s.how == "ring" else "lines")
def sliding_sashes(s, mix, at, w, t): _boxes(s, "window", at, ((-1, -.25, .04, 0), (-.04, 0, 1, .25)))
def casements(s, mix, at, w, t):
    n = 2 if w > 1 else 1
    _boxes(s, "window", at, [(-1 + 2 * i / n, -.12, -1 + 2 * (i + 1) / n, .12) for i in range(n)])
def frame_box(s, mix, at, w, t):
    e = .1 / w; _boxes(s, "window", at, ((-1, -.3, -1 + e, .3), (1 - e, -.3, 1, .3))); s.line("window", at(-1 + e, 0), at(1 - e, 0))
WINDOWS = {"sashes": sliding_sashes, "casements": casements, "frame": frame_box}

def draw_windows(s, st, mix):
    truth = []
    for c, u, w, t in st.windows:
        truth.append(rect(c, u, w, t)); v = (-u[1], u[0])
        def paint(s, c=(0, 0), u=(1, 0), v=(0, 1)):
            at = lambda i, j: (c[0] + u[0] * i * w / 2 + v[0] * j * t / 2, c[1] + u[1] * i * w / 2 + v[1] * j * t / 2)
            style = mix["window"]
            rows = {"2": (-.2, .2), "2faces": (-1, 1), "3": (-1, 0, 1), "4": (-1, -.25, .25, 1), "rect": (0,)}.get(style, (-1, 1))
            for j in rows: s.line("window", at(-1, j), at(1, j))
            if style in WINDOWS: WINDOWS[style](s, mix, at, w, t)
            if style == "rect": s.pl("window", [at(i, j) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))], True)
            if mix["window_frame"]:
                e = .1 / w
                for i in (-1, 1): s.pl("window", [at(i, -.35), at(i * (1 - e), -.35), at(i * (1 - e), .35), at(i, .35)], True)
        if mix["window_block"]:
            s.insert("window", s.block(f"W{round(w * 1000)}x{round(t * 1000)}", paint), c, math.degrees(math.atan2(u[1], u[0])))
        else: paint(s, c, u, v)
        if mix["sill"]: s.pl("window", [(p[0] + v[0] * d, p[1] + v[1] * d) for p, d in zip(rect(c, u, w + .1, t), (-.05, -.05, -t, -t))][:2])
    for g in st.panes:
        s.polygon("window", g, mix["pane"]); truth.append(list(g.exterior.coords))
    return truth

def leaf(s, mix, h, out, w, sense, length):
    """A leaf at hinge h: `out` is the direction from hinge along the closed leaf, opened by mix angle to the side of sense (+1 left)."""
    ang = mix["angle"]; a0 = math.degrees(math.atan2(out[1], out[0])); a1 = a0 + sense * ang
    tip = lambda a, r=length: (h[0] + r * math.cos(math.radians(a)), h[1] + r * math.sin(math.radians(a)))
    e = tip(a1); th = mix["leaf_thick"]
    if th:
        n = (-math.sin(math.radians(a1)) * th * -sense, math.cos(math.radians(a1)) * th * -sense)
        s.pl("door", [h, e, (e[0] + n[0], e[1] + n[1]), (h[0] + n[0], h[1] + n[1])], True) if mix["leaf_ring"] else s.edges("door", [h, e, (e[0] + n[0], e[1] + n[1]), (h[0] + n[0], h[1] + n[1])], True, "lines")
    else: s.line("door", h, e)
    if mix["swing"] == "none" or (ang == 0 and not mix["arc_when_shut"]): return
    full = a0 + sense * (ang or 90)
    lo, hi = (a0, full) if sense > 0 else (full, a0)
    steps = [tip(lo + (hi - lo) * i / 10) for i in range(11)]
    if mix["swing"] == "arc": s.arc("door", h, length, lo, hi)
    elif mix["swing"] == "spline": s.add("door", "spline", [steps[i] for i in (0, 2, 5, 8, 10)])
    elif mix["swing"] == "chord": s.line("door", steps[0], steps[-1])
    elif mix["swing"] == "lines": s.edges("door", steps[::2], False, "lines")
    else: s.pl("door", steps)

def _leaf(s, at, x0, x1, y0, y1): s.edges("door", [at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)], True, "ring" if s.how == "ring" else "lines")
def pocket(s, at, w, t, side, end):
    """A leaf half in the wall, and the pocket that takes it."""
    x0, x1 = sorted((end * .1 * w, end * 1.1 * w)); _leaf(s, at, x0, x1, -.02, .02)
    for y in (-.05, .05): s.line("door", at(end * w / 2, y), at(end * 1.52 * w, y), dash="DASHED")
def barn(s, at, w, t, side, end): y = side * (t / 2 + .04); _leaf(s, at, -w * .55, w * .55, y - .02, y + .02); s.line("door", at(-w * .6, y + side * .04), at(w * 1.4 * end, y + side * .04))
def barn_aside(s, at, w, t, side, end): y = side * (t / 2 + .05); x0, x1 = sorted((end * .45 * w, end * 1.5 * w)); _leaf(s, at, x0, x1, y - .02, y + .02)
def folding(s, at, w, t, side, end):
    n = 4 if w > 1.2 else 2; pts = [at(-end * w / 2 + end * i * w * .2, side * (t / 2 if i % 2 == 0 else t / 2 + w * .35)) for i in range(n + 1)]; s.pl("door", pts)
def triple(s, at, w, t, side, end):
    for i in range(3): _leaf(s, at, -w / 2 + i * w / 3, -w / 2 + (i + 1.15) * w / 3 if i < 2 else w / 2, -.06 + i * .04, -.03 + i * .04)
SLIDES = {"pocket": pocket, "barn": barn, "aside": barn_aside, "folding": folding, "triple": triple}

def draw_doors(s, st, mix):
    for d in st.doors:
        if not d["gap"] or mix["door"] == "raw":
            for p in d["raw"]:
                if is_swing(p) and mix["swing"] == "arc":
                    a, b, m = (math.degrees(math.atan2(q[1] - p[0][1], q[0] - p[0][0])) for q in (p[1], p[-1], p[len(p) // 2]))
                    if (m - a) % 360 > (b - a) % 360: a, b = b, a
                    s.line("door", p[0], p[1]); s.arc("door", p[0], math.dist(p[0], p[1]), a, b)
                else: s.pl("door", p, p[0] == p[-1])
            continue
        c, u, w, t = d["gap"]; v = (-u[1], u[0])
        side = s.rng.choice((-1, 1)); end = s.rng.choice((-1, 1))
        if d["swings"]:  # as in the model
            p = d["swings"][0]; far = max(p, key=lambda q: abs((q[0] - c[0]) * v[0] + (q[1] - c[1]) * v[1]))
            side = 1 if (far[0] - c[0]) * v[0] + (far[1] - c[1]) * v[1] > 0 else -1
            end = 1 if (p[0][0] - c[0]) * u[0] + (p[0][1] - c[1]) * u[1] > 0 else -1
        else:
            for _ in range(4):
                h = (c[0] + u[0] * end * w / 2 + v[0] * side * (t / 2 + .1), c[1] + u[1] * end * w / 2 + v[1] * side * (t / 2 + .1))
                tip = (h[0] - u[0] * end * .08 + v[0] * side * (w - .2), h[1] - u[1] * end * .08 + v[1] * side * (w - .2))
                if not LineString([(h[0] - u[0] * end * .08, h[1] - u[1] * end * .08), tip]).intersects(st.walls): break
                side, end = (side, -end) if s.rng.random() < .5 else (-side, end)
        double = len(d["swings"]) == 2 or w > 1.45
        shape = "slide" if s.rng.random() < mix["slides"] else "swing"
        jamb = mix["jamb"]
        def paint(s, c=(0, 0), u=(1, 0)):
            v = (-u[1], u[0])
            at = lambda x, y: (c[0] + u[0] * x + v[0] * y, c[1] + u[1] * x + v[1] * y)
            if jamb:
                for i in (-1, 1): s.pl("door", [at(i * w / 2, -t / 2), at(i * (w / 2 - jamb), -t / 2), at(i * (w / 2 - jamb), t / 2), at(i * w / 2, t / 2)], True)
            for y in mix["threshold"]: s.line("door", at(-w / 2, y * t / 2), at(w / 2, y * t / 2))
            if shape == "slide" and mix.get("slide") in SLIDES: return SLIDES[mix["slide"]](s, at, w, t, side, end)
            if shape == "slide":
                for x, y in ((-w / 4, .02), (w / 4, -.02)): s.pl("door", [at(x + i * w / 4 * 1.08, y + j * .018) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))], True)
                return
            y = side * t / 2 * mix["hinge_at"]
            for e in ((-1, 1) if double else (end,)):
                length = (w - 2 * jamb) / (2 if double else 1)
                h = at(e * (w / 2 - jamb), y); out = (-u[0] * e, -u[1] * e)
                leaf(s, mix, h, out, w, side * -e, length)
        if mix["door_block"]:
            name = s.block(f"D{round(w * 1000)}_{round(t * 1000)}{'LR'[end > 0]}{'IO'[side > 0]}{2 if double else 1}{shape[1]}", paint)
            s.insert("door", name, c, math.degrees(math.atan2(u[1], u[0])))
        else: paint(s, c, u)

# ---- furniture: each draws in its own frame, back at y = 0, looking to +y, centre x = 0

def _rect(s, what, x0, y0, x1, y1): s.pl(what, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)], True)
def bed(s):
    _rect(s, "furniture", -.8, 0, .8, 2.05)
    for x in (-.75, .1): _rect(s, "furniture", x, .08, x + .65, .45)
    s.line("furniture", (-.8, .6), (.8, .6)); s.line("furniture", (-.8, .6), (-.3, 1.0)); s.line("furniture", (-.3, 1.0), (.8, 1.0))
def single_bed(s): _rect(s, "furniture", -.45, 0, .45, 2.); _rect(s, "furniture", -.35, .06, .35, .4); s.line("furniture", (-.45, .5), (.45, .5))
def wardrobe(s): _rect(s, "furniture", -.9, 0, .9, .6); s.line("furniture", (-.9, .6), (.9, 0)); s.line("furniture", (0, 0), (0, .6))
def sofa(s):
    _rect(s, "furniture", -1.05, 0, 1.05, .9); _rect(s, "furniture", -.85, .25, .85, .9); s.line("furniture", (0, .25), (0, .9))
def chair(s, x=0., y=0., a=0.):
    r = lambda p: (x + p[0] * math.cos(a) - p[1] * math.sin(a), y + p[0] * math.sin(a) + p[1] * math.cos(a))
    s.pl("furniture", [r(p) for p in ((-.21, -.21), (.21, -.21), (.21, .21), (-.21, .21))], True); s.line("furniture", r((-.21, -.16)), r((.21, -.16)))
def table(s):
    _rect(s, "furniture", -.8, .55, .8, 1.4)
    for x in (-.4, .4): chair(s, x, .35); chair(s, x, 1.6, math.pi)
def round_table(s):
    s.circle("furniture", (0, .95), .5)
    for i in range(4): a = i * math.pi / 2; chair(s, .72 * math.sin(a), .95 - .72 * math.cos(a), a)
def desk(s): _rect(s, "furniture", -.8, 0, .8, .8); s.arc("furniture", (0, 1.05), .28, 0, 180); s.circle("furniture", (0, 1.05), .22); _rect(s, "furniture", -.25, .1, .25, .35)
def shelf(s): _rect(s, "furniture", -.6, 0, .6, .35); s.line("furniture", (-.6, 0), (.6, .35))
def toilet(s): _rect(s, "sanitary", -.19, 0, .19, .18); s.pl("sanitary", [(.18 * math.cos(a), .42 + .24 * math.sin(a)) for a in [i * math.pi / 8 for i in range(16)]], True)
def basin(s): _rect(s, "sanitary", -.3, 0, .3, .48); s.circle("sanitary", (0, .25), .18); s.circle("sanitary", (0, .1), .02)
def bath(s): _rect(s, "sanitary", -.85, 0, .85, .75); s.pl("sanitary", [(-.75, .1), (.6, .1), (.75, .25), (.75, .5), (.6, .65), (-.75, .65)], True); s.circle("sanitary", (-.6, .37), .03)
def shower(s): _rect(s, "sanitary", -.45, 0, .45, .9); s.line("sanitary", (-.45, 0), (.45, .9)); s.line("sanitary", (-.45, .9), (.45, 0)); s.circle("sanitary", (0, .45), .04)
def kitchen(s):
    _rect(s, "furniture", -1.2, 0, 1.2, .6); _rect(s, "sanitary", -.9, .1, -.4, .5); _rect(s, "furniture", .3, .06, .88, .54)
    for x, y in ((.45, .2), (.73, .2), (.45, .4), (.73, .4)): s.circle("furniture", (x, y), .09)
SIZE = {bed: (1.6, 2.1), single_bed: (.9, 2.), wardrobe: (1.8, .6), sofa: (2.1, .9), table: (1.6, 1.9), round_table: (2., 1.95), desk: (1.6, 1.35), shelf: (1.2, .35), toilet: (.4, .68), basin: (.6, .5), bath: (1.7, .75), shower: (.9, .9), kitchen: (2.4, .6)}

def stairs(s, n=12):
    for i in range(n + 1): s.line("stair", (-.5, i * .27), (.5, i * .27))
    s.line("stair", (-.5, 0), (-.5, n * .27)); s.line("stair", (.5, 0), (.5, n * .27))
    s.line("stair", (0, .1), (0, n * .27 - .2)); s.line("stair", (0, n * .27 - .2), (-.1, n * .27 - .4)); s.line("stair", (0, n * .27 - .2), (.1, n * .27 - .4))
SIZE[stairs] = (1., 3.24)

def place(room, taken, size, rng, wall=True):
    """Where a thing with its back to a wall of the room fits: point, degrees."""
    ring = list(room.exterior.coords); inner = room.buffer(-.02)
    edges = [(a, b) for a, b in zip(ring, ring[1:]) if math.dist(a, b) > size[0]]
    for _ in range(14):
        if not edges: return None
        if wall:
            a, b = rng.choice(edges); l = math.dist(a, b); f = rng.uniform(size[0] / 2 + .04, l - size[0] / 2 - .04) if l > size[0] + .1 else l / 2
            u = ((b[0] - a[0]) / l, (b[1] - a[1]) / l); inwards = (-u[1], u[0])
            p = (a[0] + u[0] * f + inwards[0] * .03, a[1] + u[1] * f + inwards[1] * .03)
            if not room.contains(Point(p[0] + inwards[0] * .1, p[1] + inwards[1] * .1)): inwards = (-inwards[0], -inwards[1]); p = (a[0] + u[0] * f + inwards[0] * .03, a[1] + u[1] * f + inwards[1] * .03)
        else:
            x0, y0, x1, y1 = room.bounds; p = (rng.uniform(x0, x1), rng.uniform(y0, y1)); inwards = rng.choice(((1, 0), (0, 1), (-1, 0), (0, -1)))
        body = Polygon(rect((p[0] + inwards[0] * size[1] / 2, p[1] + inwards[1] * size[1] / 2), (inwards[1], -inwards[0]), size[0], size[1]))
        if inner.contains(body) and not any(body.intersects(t) for t in taken):
            taken.append(body.buffer(.05)); return p, math.degrees(math.atan2(inwards[1], inwards[0])) - 90
    return None

def furnish(s, st, mix):
    blocks = mix["furniture_block"]; st.taken = taken = []
    for d in st.doors:
        if d["gap"]: c, u, w, t = d["gap"]; taken.append(Polygon(rect(c, u, w, t + 2 * min(w, 1.1))))
    for cls, shapes, _ in st.rest: taken += [LineString(p).buffer(.05) for p, _ in shapes if len(p) > 1]
    def put(make, room, wall=True):
        where = place(room, taken, SIZE[make], s.rng, wall)
        if not where: return False
        p, turn = where; what = "stair" if make is stairs else "sanitary" if make in (toilet, basin, bath, shower) else "furniture"
        if blocks and make is not stairs: s.insert(what, s.block(mix["block_names"].format(make.__name__.replace("_", "-").upper(), abs(hash_(make.__name__)) % 900), make), p, turn)
        else:
            inner = Sheet(s.rng, s.hand); make(inner); paste(s, inner.items, p, turn)
        return True
    uses = {}
    if mix["stairs"] and not any(c == "stair" for c, _, _ in st.rest):
        for room in sorted(st.rooms, key=lambda r: -r.area)[:4]:
            if room.area > 10 and put(stairs, room): break
    for n, room in enumerate(st.rooms):
        a = room.area; wet = a < 8 and s.rng.random() < .5
        cook = not wet and 6 < a < 25 and s.rng.random() < .25
        uses[n] = "wet" if wet else "cook" if cook else "dry"
        if s.rng.random() > mix["furnished"]: continue
        if wet: todo = [toilet, basin] + ([bath] if a > 4 else [shower] if a > 2.5 else []) + ([toilet, basin] if a > 6 else [])
        elif cook: todo = [kitchen, s.rng.choice((table, round_table))]
        elif a < 5: todo = [shelf] if s.rng.random() < .5 else []
        elif a < 18: todo = s.rng.choice(([bed, wardrobe, desk], [single_bed, desk, shelf], [desk, desk, shelf], [sofa, shelf], [table]))
        elif a < 45: todo = s.rng.choice(([sofa, sofa, table, shelf], [desk] * 4 + [shelf], [table, round_table, kitchen]))
        else: todo = s.rng.choice(([desk] * 10, [table] * 6, [round_table] * 5, []))
        for make in todo: put(make, room, wall=not (make in (table, round_table) or (a > 45)))
    return uses

def hash_(s):  # the same in every run
    n = 7
    for c in s: n = (n * 31 + ord(c)) % 99991
    return n

def paste(s, items, p, turn):
    c, n = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    at = lambda q: (p[0] + q[0] * c - q[1] * n, p[1] + q[0] * n + q[1] * c)
    for what, cls, kind, data, more in items:
        if kind == "line": data = (at(data[0]), at(data[1]))
        elif kind in ("pl", "spline"): data = ([at(q) for q in data[0]], *data[1:])
        elif kind == "arc": data = (at(data[0]), data[1], data[2] + turn, data[3] + turn)
        elif kind in ("circle",): data = (at(data[0]), data[1])
        elif kind == "text": data = (at(data[0]), data[1], data[2], data[3] + turn)
        s.items.append((what, cls, kind, data, more))

# ---- what stands round a plan on the sheet

def rooms_text(s, st, mix, uses):
    dry, wet, cook, area = WORDS[mix["words"]]
    for n, room in enumerate(st.rooms):
        name = s.rng.choice({"wet": wet, "cook": cook}.get(uses.get(n), dry)); h = mix["text"]; p = room.representative_point()
        if room.area < 2.5 and s.rng.random() < .5: continue
        x, y = p.x - .3 * h * len(name), p.y
        if mix["mtext"]: s.text("annotation", (x, y + h), h, name + ("\\P" + area.format(room.area) if mix["areas"] else ""), mtext=True)
        else:
            s.text("annotation", (x, y), h, name)
            if mix["areas"]: s.text("annotation", (x, y - 1.5 * h), h * .8, area.format(room.area))
        if mix["tags"]: s.circle("annotation", (p.x, y + 2.6 * h), 1.1 * h); s.text("annotation", (p.x - .5 * h, y + 2.2 * h), .7 * h, f"{n + 1:02d}")
        if mix["outlines"]: s.pl("area", list(room.exterior.coords), True)

def chain(s, mix, a, b, stops, away, h):
    """A chain of dimensions from a to b: stops are distances from a, away the unit vector off the building."""
    l = math.dist(a, b); u = ((b[0] - a[0]) / l, (b[1] - a[1]) / l)
    for off, marks in ((mix["dim_off"], stops), (mix["dim_off"] + 3.2 * h, [0, l])):
        at = lambda f, o=off: (a[0] + u[0] * f + away[0] * o, a[1] + u[1] * f + away[1] * o)
        if mix["dims"] == "entity":
            for i, j in zip(marks, marks[1:]): s.add("dimension", "dim", at(i), at(i, .15), at(j, .15), math.degrees(math.atan2(u[1], u[0])), h)
            continue
        s.line("dimension", at(marks[0] - h), at(marks[-1] + h))
        for i in marks:
            s.line("dimension", at(i, off - 1.2 * h), at(i, off + .6 * h))
            if mix["ticks"]: p = at(i); s.line("dimension", (p[0] - .3 * h, p[1] - .3 * h), (p[0] + .3 * h, p[1] + .3 * h))
        for i, j in zip(marks, marks[1:]):
            value = j - i; word = {"m": f"{value:.2f}", "cm": f"{value * 100:.0f}", "mm": f"{value * 1000:.0f}", "ft": f"{int(value / .3048)}'-{round(value / .0254) % 12}\""}[mix["dim_words"]]
            p = at((i + j) / 2, off); turn = math.degrees(math.atan2(u[1], u[0])) % 180; back = .28 * h * len(word); r = math.radians(turn)
            s.text("dimension", (p[0] - back * math.cos(r) - .3 * h * math.sin(r), p[1] - back * math.sin(r) + .3 * h * math.cos(r)), h, word, turn)

def dimensions(s, st, mix):
    x0, y0, x1, y1 = st.box; h = mix["text"]; corners = [p for g in st.wall_polys for p in g.exterior.coords]
    def stops(i, lo, hi, near, at):
        vals = sorted({round(p[i] - lo, 2) for p in corners if abs(p[1 - i] - at) < near})
        out = [0.]
        for x in vals:
            if x - out[-1] > .3 and hi - lo - x > .3: out.append(x)
        return out + [round(hi - lo, 3)]
    for side in mix["dim_sides"]:
        if side == "S": chain(s, mix, (x0, y0), (x1, y0), stops(0, x0, x1, .5, y0), (0, -1), h)
        if side == "N": chain(s, mix, (x0, y1), (x1, y1), stops(0, x0, x1, .5, y1), (0, 1), h)
        if side == "W": chain(s, mix, (x0, y0), (x0, y1), stops(1, y0, y1, .5, x0), (-1, 0), h)
        if side == "E": chain(s, mix, (x1, y0), (x1, y1), stops(1, y0, y1, .5, x1), (1, 0), h)

def grid(s, st, mix):
    x0, y0, x1, y1 = st.box; out = 2.2 + 6 * mix["text"]; r = .4
    centres = [(g.centroid.x, g.centroid.y) for g in st.columns] or [frame(g)[0] for g in st.wall_polys if g.area > .6 and frame(g)]
    for i in (0, 1):
        found = []
        for x in sorted(c[i] for c in centres):
            if not found or x - found[-1] > 2.2: found.append(x)
        for n, x in enumerate(found[:14]):
            lo, hi = ((x, y0 - out), (x, y1 + out)) if i == 0 else ((x0 - out, x), (x1 + out, x))
            s.line("grid", lo, hi, dash="DASHDOT"); word = str(n + 1) if i == 0 else chr(65 + n)
            for p, sgn in ((lo, -1), (hi, 1)):
                if sgn > 0 and not mix["grid_both"]: continue
                c = (p[0], p[1] + sgn * r) if i == 0 else (p[0] + sgn * r, p[1])
                s.circle("grid", c, r); s.text("grid", (c[0] - .12, c[1] - .15), .3, word)

def tree(s):
    s.circle("outside", (0, 0), 1.2)
    for i in range(9): a = i * 2 * math.pi / 9; s.line("outside", (.15 * math.cos(a), .15 * math.sin(a)), (1.1 * math.cos(a + .2), 1.1 * math.sin(a + .2)))
def car(s):
    s.pl("outside", [(-.8, 0), (.8, 0), (.9, .4), (.9, 4.0), (.7, 4.4), (-.7, 4.4), (-.9, 4.0), (-.9, .4)], True)
    for y0, y1 in ((1.2, 1.7), (3.5, 3.9)): s.pl("outside", [(-.7, y0), (.7, y0), (.6, y1), (-.6, y1)], True)

def outside(s, st, mix):
    x0, y0, x1, y1 = st.box; rng = s.rng; far = max(4., .25 * max(x1 - x0, y1 - y0))
    hull = box(x0 - far, y0 - far, x1 + far, y1 + far)
    if mix["terrain"]:
        pts = [(x0 - far * rng.uniform(.9, 1.5), y0 - far * rng.uniform(.9, 1.4)), (x1 + far * rng.uniform(.9, 1.5), y0 - far * rng.uniform(.9, 1.4)), (x1 + far * rng.uniform(.9, 1.5), y1 + far * rng.uniform(.9, 1.4)), (x0 - far * rng.uniform(.9, 1.5), y1 + far * rng.uniform(.9, 1.4))]
        s.pl("outside", pts, True, dash=rng.choice((None, "DASHDOT")))
    near = unary_union([g.buffer(.8) for g in st.footprint])
    for make, n in ((tree, mix["trees"]), (car, mix["cars"])):
        for _ in range(n):
            p = (rng.uniform(x0 - far, x1 + far), rng.uniform(y0 - far, y1 + far)); q = Point(p).buffer(4.6 if make is car else 1.3)
            if near.intersects(q): continue
            near = near.union(q)
            if mix["tree_block"]: s.insert("outside", s.block(make.__name__.upper(), make), p, rng.choice((0, 90, 180, 30)))
            else: inner = Sheet(rng, s.hand); make(inner); paste(s, inner.items, p, rng.choice((0, 90)))
    if mix["paving"] and st.footprint:
        g = max(st.footprint, key=lambda r: r.area); ring = g.buffer(1.5).difference(g.buffer(.46))
        for q in parts(ring.intersection(box(x0 - 2, y0 - 2, x1 + 2, y0 + (y1 - y0) * .3))):
            bx = q.bounds; step = rng.choice((.4, .5, .6)); s.polygon("outside", q, "ring")
            for i in range(int((bx[2] - bx[0]) / step)):
                x = bx[0] + i * step; cut_ = LineString([(x, bx[1]), (x, bx[3])]).intersection(q)
                for l in getattr(cut_, "geoms", [cut_]):
                    if l.geom_type == "LineString" and l.length > .05: s.line("outside", l.coords[0], l.coords[-1])

def elevation(s, mix, at, width, height, section):
    """A front or a section of so many storeys, standing on at (left foot)."""
    x, y = at; start = len(s.items); rng = s.rng; n = rng.choice((1, 2, 3)); h = height / n
    lookalike = lambda what, *a, **k: s.pl(what, *a, cls="other", **k)
    s.line("other", (x - 2, y), (x + width + 2, y), cls="other"); roof = rng.choice((0, .25))
    if section:
        t = .3
        for i in range(n + 1): lookalike("wall", [(x, y + i * h - t), (x + width, y + i * h - t), (x + width, y + i * h), (x, y + i * h)], True)
        for f in (0, .35, .7, 1):
            xx = x + f * (width - t); lookalike("wall", [(xx, y), (xx + t, y), (xx + t, y + height), (xx, y + height)], True)
        if rng.random() < .5: s.hatch("hatch", [box(x - 2, y - .8, x + width + 2, y - t)], "ANSI31", 3, cls="other")
    else: lookalike("wall", [(x, y), (x + width, y), (x + width, y + height), (x, y + height)], True)
    if roof: lookalike("roof", [(x - .5, y + height), (x + width / 2, y + height + width * roof), (x + width + .5, y + height)], True)
    for i in range(n):
        for j in range(max(2, int(width / 3))):
            wx, wy = x + (j + .25) * width / max(2, int(width / 3)), y + i * h + .9
            lookalike("window", [(wx, wy), (wx + 1.2, wy), (wx + 1.2, wy + 1.3), (wx, wy + 1.3)], True)
            s.line("window", (wx + .6, wy), (wx + .6, wy + 1.3), cls="other")
        s.text("dimension", (x - 3, y + i * h), mix["text"], f"+{i * h:.2f}", cls="other")
    b = s.bounds(start); s.views.append(("section" if section else "elevation", b))
    s.text("title", (x, y - 2), mix["text"] * 1.6, rng.choice(("Schnitt A-A", "SECTION A-A", "COUPE AA", "Sezione A-A")) if section else rng.choice(("Ansicht Süd", "SOUTH ELEVATION", "FACADE SUD", "Prospetto Sud", "南立面图")))

def title(s, mix):
    x0, y0, x1, y1 = s.bounds(); m = .05 * max(x1 - x0, y1 - y0); w, h = max(.22 * (x1 - x0), 5), max(.13 * (y1 - y0), 3)
    x0, y0, x1, y1 = x0 - m, y0 - m - h, x1 + m, y1 + m
    for e in ((0, .01) if s.rng.random() < .6 else (0,)):
        d = e * (x1 - x0); s.pl("title", [(x0 - d, y0 - d), (x1 + d, y0 - d), (x1 + d, y1 + d), (x0 - d, y1 + d)], True)
    start = len(s.items); s.pl("title", [(x1 - w, y0), (x1, y0), (x1, y0 + h), (x1 - w, y0 + h)], True)
    for i in range(1, 5): s.line("title", (x1 - w, y0 + h * i / 5), (x1, y0 + h * i / 5))
    s.line("title", (x1 - w * .4, y0), (x1 - w * .4, y0 + h * 2 / 5))
    for i, word in enumerate(("Index  Datum", "Plan-Nr. A-101", "M 1:100", "Grundriss / Floor plan", "Project")): s.text("title", (x1 - w * .97, y0 + h * (i + .3) / 5), h / 13, word)
    s.views.append(("title", s.bounds(start)))

# ---- what is taken for walls by mistake

def along(room, rng, least=.8):
    """An edge of a room's outline: its start, its direction, the way inwards, its length."""
    ring = list(room.exterior.coords); edges = [(a, b) for a, b in zip(ring, ring[1:]) if math.dist(a, b) > least]
    if not edges: return None
    a, b = rng.choice(edges); l = math.dist(a, b); u = ((b[0] - a[0]) / l, (b[1] - a[1]) / l); n = (-u[1], u[0])
    if not room.contains(Point(a[0] + u[0] * l / 2 + n[0] * .05, a[1] + u[1] * l / 2 + n[1] * .05)): n = (-n[0], -n[1])
    return a, u, n, l

def lines_in(area, step, turn, rng):
    """Parallel lines through an area."""
    x, y = area.centroid.x, area.centroid.y; r = math.dist(area.bounds[:2], area.bounds[2:]) / 2 + step; c, n = math.cos(turn), math.sin(turn)
    if 2 * r / step > 400: return
    at = lambda i, j: (x + i * c - j * n, y + i * n + j * c); j = -r + rng.uniform(0, step)
    while j < r:
        g = LineString([at(-r, j), at(r, j)]).intersection(area); j += step
        for l in getattr(g, "geoms", [g]):
            if l.geom_type == "LineString" and l.length > .03: yield l.coords[0], l.coords[-1]

def gaps(s, what, a, b, dash, cls=None):
    """A line with gaps: as a line type, or as short lines where the drawing was exported so."""
    l = math.dist(a, b)
    if not dash: return s.line(what, a, b, cls=cls)
    if s.rng.random() < .5 or l > 30: return s.line(what, a, b, dash=dash, cls=cls)
    at = lambda f: (a[0] + (b[0] - a[0]) * f / l, a[1] + (b[1] - a[1]) * f / l); f = 0
    while f < l: s.line(what, at(f), at(min(f + .3, l)), cls=cls); f += .45

def beams(s, st, mix):
    dash = mix["beams"] if mix["beams"] != "drawn" else None; wide = s.rng.choice((.2, .24, .3, .4))
    for room in st.rooms:
        e = s.rng.random() < .5 and along(room, s.rng, 1.2)
        if not e: continue
        a, u, n, l = e; step = s.rng.choice((0, 0, 1.5, 2.4)); f = s.rng.uniform(.25, .75) * l
        for k in range(6 if step else 1):
            g = f + k * step
            if g > l - .2: break
            for d in (-wide / 2, wide / 2) if s.rng.random() < .85 else (0,):
                p = (a[0] + u[0] * (g + d), a[1] + u[1] * (g + d)); ray = LineString([(p[0] + n[0] * .01, p[1] + n[1] * .01), (p[0] + n[0] * 60, p[1] + n[1] * 60)]).intersection(room)
                ray = getattr(ray, "geoms", [ray])[0]
                if ray.geom_type == "LineString" and ray.length > .5: gaps(s, "other", ray.coords[0], ray.coords[-1], dash)

def roof_lines(s, st, mix):
    """Eaves, ridge, hips and valleys of a roof above the storey."""
    for g in st.footprint:
        m = g.minimum_rotated_rectangle
        if m.geom_type != "Polygon": continue
        f = frame(m); (x, y), u, l, d = f; v = (-u[1], u[0]); o = s.rng.choice((.5, .8, 1.2)); l += 2 * o; d += 2 * o; hip = s.rng.choice((0, d / 2)); dash = s.rng.choice((None, "DASHED", "DASHED"))
        at = lambda i, j: (x + u[0] * i + v[0] * j, y + u[1] * i + v[1] * j); c = [at(-l / 2, -d / 2), at(l / 2, -d / 2), at(l / 2, d / 2), at(-l / 2, d / 2)]; r = [at(-l / 2 + hip, 0), at(l / 2 - hip, 0)]
        for a, b in zip(c, c[1:] + c[:1]): gaps(s, "roof", a, b, dash, "other")
        gaps(s, "roof", r[0], r[1], dash, "other")
        if hip:
            for a, b in ((c[0], r[0]), (c[3], r[0]), (c[1], r[1]), (c[2], r[1])): gaps(s, "roof", a, b, dash, "other")
        if s.rng.random() < .4:
            for off in (.08, .2): s.pl("roof", g.buffer(o - off, join_style=2).simplify(.05).exterior.coords, True, dash=dash, cls="other")

def contours(s, st, mix):
    """Lines of equal height, a plot with its neighbours, a path and a fence."""
    x0, y0, x1, y1 = st.box; far = max(6., .5 * max(x1 - x0, y1 - y0)); rng = s.rng; ground = unary_union([g.buffer(.3) for g in st.footprint])
    tilt, bend, wave = rng.uniform(0, math.pi), rng.uniform(.2, 1.2), rng.uniform(.1, .4); c, n = math.cos(tilt), math.sin(tilt); cx, cy = (x0 + x1) / 2, (y0 + y1) / 2; r = far + max(x1 - x0, y1 - y0) / 2
    through = rng.random() < .35; step = rng.choice((1., 1.6, 2.5)); q = -r
    while q < r and mix["contours"] in ("contours", "both"):
        pts = [(i * r / 12, q + bend * math.sin(i * wave + q * .1)) for i in range(-12, 13)]; pts = [(cx + i * c - j * n, cy + i * n + j * c) for i, j in pts]; g = LineString(pts) if through else LineString(pts).difference(ground); q += step * rng.uniform(.8, 1.2)
        for l in getattr(g, "geoms", [g]):
            if l.length > .5: s.edges("outside", l.coords, False, rng.choice(("ring", "lines")))
    if mix["contours"] in ("plot", "both"):
        k = lambda: far * rng.uniform(.3, .9); p = [(x0 - k(), y0 - k()), (x1 + k(), y0 - k()), (x1 + k(), y1 + k()), (x0 - k(), y1 + k())]
        s.edges("outside", p, True, rng.choice(("ring", "lines")), dash=rng.choice((None, "DASHDOT")))
        if rng.random() < .5: s.edges("outside", Polygon(p).buffer(-rng.choice((.15, .2, 3.)), join_style=2).exterior.coords, True, "ring")
        for a in p: s.line("outside", a, (a[0] + (a[0] - cx) * .6, a[1] + (a[1] - cy) * .6)); s.circle("outside", a, .15)
        w = rng.choice((.9, 1.2, 3.)); x = rng.uniform(x0, x1)
        for d in (0, w): s.line("outside", (x + d, y0 - .6), (x + d, min(q[1] for q in p)))

def strips(s, st, mix):
    """What stands along walls and is as deep as one: counters of units, wardrobes with doors, shelves, radiators, ducts."""
    rng = s.rng; shut = unary_union([Polygon(rect(d["gap"][0], d["gap"][1], d["gap"][2], d["gap"][3] + 1.4)) for d in st.doors if d["gap"]])
    for room in st.rooms:
        for _ in range(rng.choice((0, 1, 1, 2))):
            e = along(room, rng, 1.0)
            if not e: continue
            a, u, n, l = e; kind = rng.choice(mix["strips"]); deep = {"units": .6, "wardrobe": .62, "shelf": rng.choice((.2, .3, .35)), "radiator": .12, "lining": rng.choice((.08, .12, .2))}[kind]; length = l if kind in ("wardrobe", "lining") and rng.random() < .6 else min(l, rng.uniform(.8, 3.6)); f = rng.choice((0, l - length, rng.uniform(0, l - length)))
            at = lambda i, j: (a[0] + u[0] * (f + i) + n[0] * j, a[1] + u[1] * (f + i) + n[1] * j); off = rng.choice((0, .02)); body = [at(0, off), at(length, off), at(length, deep), at(0, deep)]; g = Polygon(body)
            if g.intersects(shut) or any(g.intersects(t) for t in st.taken) or not room.buffer(.08).contains(g): continue
            how = "ring" if s.how == "ring" else "lines"; s.edges("furniture", body, True, how); cell = rng.choice((.5, .6, .9))
            if kind in ("units", "wardrobe", "shelf"):
                for i in range(1, int(length / cell) + 1):
                    if i * cell < length - .1: s.line("furniture", at(i * cell, off), at(i * cell, deep))
            if kind == "units": s.line("furniture", at(0, .35), at(length, .35), dash="DASHED")
            if kind == "wardrobe":
                s.line("furniture", at(0, deep / 2), at(length, deep / 2))
                if rng.random() < .5: s.line("furniture", at(0, deep - .04), at(length, deep - .04))
            if kind == "radiator": s.line("furniture", at(0, deep / 2), at(length, deep / 2))
    if rng.random() < .5:
        for room in [r for r in st.rooms if r.area < 9][:3]:  # a duct crossed out
            e = along(room, rng, .7)
            if e: a, u, n, l = e; q = [(a[0] + u[0] * i + n[0] * j, a[1] + u[1] * i + n[1] * j) for i, j in ((.02, .02), (.42, .02), (.42, .32), (.02, .32))]; s.edges("other", q, True, "ring"); s.line("other", q[0], q[2]); s.line("other", q[1], q[3])

def floors(s, st, mix):
    """Tiles, planks and hatches of floors, line by line."""
    for room in st.rooms:
        small = room.area < 10
        if s.rng.random() > (.8 if small else .25) or room.area > 60: continue
        step = s.rng.choice((.2, .3, .3, .6)) if small else s.rng.choice((.15, .3, .6)); turn = s.rng.choice((0, 0, math.pi / 4))
        for t in (turn, turn + math.pi / 2) if small else (turn,):
            for a, b in lines_in(room.buffer(-.01), step, t, s.rng): s.line("hatch", a, b)

def filled(s, st, mix):
    """Walls hatched line by line; in some drawings only the new ones."""
    turn = s.rng.choice((math.pi / 4, -math.pi / 4, 0)); step = s.rng.choice((.05, .08, .12)); share = s.rng.choice((.3, .6, 1)); n = 0
    for g in st.wall_polys:
        if s.rng.random() > share: continue
        for a, b in lines_in(g, step, turn, s.rng):
            n += 1
            if n > 2500: return
            s.line("hatch", a, b)

def chains_inside(s, st, mix):
    """Chains of dimensions through rooms, levels, section marks, leaders: loose lines."""
    rng = s.rng; h = mix["text"]; x0, y0, x1, y1 = st.box
    for room in st.rooms:
        if rng.random() > .35: continue
        bx = room.bounds; p = room.representative_point()
        a, b = ((bx[0], p.y + .3), (bx[2], p.y + .3)) if rng.random() < .5 else ((p.x + .3, bx[1]), (p.x + .3, bx[3]))
        if math.dist(a, b) > .8: s.line("dimension", a, b); [s.line("dimension", (q[0] - .08, q[1] - .08), (q[0] + .08, q[1] + .08)) for q in (a, b)]; s.text("dimension", ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), h * .7, f"{math.dist(a, b):.2f}", 0 if a[1] == b[1] else 90)
        if rng.random() < .3: q = (p.x, p.y - .6); s.pl("annotation", [q, (q[0] - .12, q[1] + .2), (q[0] + .12, q[1] + .2)], True); s.line("annotation", (q[0] - .4, q[1] + .2), (q[0] + .7, q[1] + .2)); s.text("annotation", (q[0] + .1, q[1] + .25), h * .6, f"+{rng.uniform(0, 9):.2f}")
    if rng.random() < .5:  # where it is cut
        y = rng.uniform(y0, y1); gaps(s, "annotation", (x0 - 2, y), (x1 + 2, y), "DASHDOT")
        for x in (x0 - 2, x1 + 2): s.circle("annotation", (x, y), .35); s.line("annotation", (x, y), (x, y + .8))

def legend(s, mix):
    """Samples of walls, doors and windows with words beside them."""
    x0, y0, x1, y1 = s.bounds(); rng = s.rng; x = x1 + 2; y = y1; start = len(s.items)
    for word in ("Mauerwerk 24 cm", "New wall", "Demolished", "D1 0.90x2.10", "W1 1.20x1.40", "Beton"):
        deep = rng.choice((.12, .2, .3)); s.pl("title", [(x, y), (x + 1.5, y), (x + 1.5, y - deep), (x, y - deep)], True); s.text("title", (x + 1.8, y - deep), .2, word)
        if rng.random() < .5:
            for a, b in lines_in(box(x, y - deep, x + 1.5, y), .08, math.pi / 4, rng): s.line("title", a, b)
        if word[0] in "DW": s.line("title", (x + .3, y), (x + .3, y + .7)); s.arc("title", (x + .3, y), .7, 0, 90)
        y -= 1.1
    b = s.bounds(start); s.pl("title", [(b[0] - .5, b[1] - .5), (b[2] + .5, b[1] - .5), (b[2] + .5, b[3] + .5), (b[0] - .5, b[3] + .5)], True); s.views.append(("legend", b))

def exploded(s, items):
    """Everything as loose lines: blocks and polylines taken apart, arcs kept."""
    out = Sheet(s.rng, s.hand)
    for item in items:
        what, cls, kind, data, more = item
        if kind == "insert":
            inner = Sheet(s.rng, s.hand); paste(inner, s.blocks[data[0]], data[1], data[2]); out.items += exploded(s, inner.items)
        elif kind == "pl":
            pts = list(data[0]) + ([data[0][0]] if data[1] else [])
            for a, b in zip(pts, pts[1:]):
                if math.dist(a, b) > 1e-4: out.items.append((what, cls, "line", (a, b), more))
        else: out.items.append(item)
    return out.items

HARD = (22, 15, 18, 25, 20)  # names, numbers, pens, one, muddle
def harder(rng, mix):
    """A mixture with what the reader takes for walls: each is drawn in a part of the drawings."""
    pick = rng.choice; p = lambda q: rng.random() < q
    if p(.6): mix["window"] = pick(("sashes", "casements", "frame", "3", "4", "4")); mix["window_block"] = p(.2)
    if p(.5): mix["slides"] = pick((.3, 1)); mix["slide"] = pick(list(SLIDES) + ["two"])
    if p(.45): mix |= {"swing": "none", "angle": pick((90, 90, 45, 30, 60)), "leaf_thick": pick((.04, .04, .05, .06)), "leaf_ring": p(.5), "hinge_at": pick((1, 0))}
    if p(.4): mix["fill"] = None
    if p(.06): mix["wall"] = "single"
    mix |= {"beams": pick((None, None, "drawn", "DASHED", "DASHED")), "roofing": p(.25), "contours": pick((None, None, None, "contours", "plot", "both")),
            "strips": pick((None, ("units", "wardrobe", "shelf"), ("units", "wardrobe", "shelf", "radiator", "lining"))), "floors": p(.25), "filled": mix["fill"] is None and p(.3),
            "inside": p(.35), "legend": p(.15), "exploded": p(.3)}
    return mix

def draw_harder(s, st, mix):
    for key, draw in (("beams", beams), ("roofing", roof_lines), ("strips", strips), ("floors", floors), ("filled", filled), ("inside", chains_inside)):
        if mix[key]: draw(s, st, mix)

def mixture(rng, st):
    small = max(st.box[2] - st.box[0], st.box[3] - st.box[1]) < 40
    pick = rng.choice; p = lambda q: rng.random() < q
    swing_ = rng.choices(("arc", "pl", "spline", "chord", "lines", "none"), (55, 15, 8, 6, 6, 10))[0]
    return {
        "wall": rng.choices(("outline", "lines", "two", "union", "union-lines", "single"), (18, 18, 8, 28, 24, 4))[0],
        "fill": rng.choices((None, "SOLID", "ANSI31", "ANSI32", "AR-CONC", "strokes"), (55, 16, 14, 4, 3, 8))[0], "finish": pick((.015, .02, .05)) if p(.15) else 0,
        "column_fill": p(.5), "window": pick(("2", "2faces", "3", "3", "4", "rect", "rect")), "window_frame": p(.2), "window_block": p(.35), "sill": p(.15), "pane": pick(("ring", "lines", "two")),
        "door": "raw" if p(.12) else "new", "swing": swing_, "angle": rng.choices((90, 45, 0, 30), (70, 10, 14, 6))[0], "arc_when_shut": p(.5), "leaf_thick": pick((0, 0, .04, .05)), "leaf_ring": p(.7), "hinge_at": pick((1, 1, 0, -1)),
        "jamb": pick((0, 0, .04, .06)), "threshold": pick(((), (), (), (-1, 1), (-1,), (0,))), "slides": pick((0, 0, .15)), "door_block": p(.45),
        "furniture_block": p(.6), "furnished": pick((0, .5, .8, 1)), "block_names": pick(("{}", "{}", "A$C{1:03X}7F2", "BLK-{1}", "Möbel_{}")), "stairs": p(.5),
        "words": pick(list(WORDS)), "text": pick((.15, .2, .25)) if small else pick((.25, .35, .5)), "mtext": p(.4), "areas": p(.6), "tags": p(.2), "outlines": p(.25), "names": p(.75),
        "dims": pick(("entity", "exploded", "exploded")), "dim_off": pick((1., 1.5, 2.)), "ticks": p(.7), "dim_words": pick(("m", "cm", "mm", "ft")), "dim_sides": "".join(x for x in "SNWE" if p(.6)) if p(.65) else "",
        "grid": p(.3), "grid_both": p(.5), "terrain": p(.3), "trees": pick((0, 0, 3, 8)), "cars": pick((0, 0, 1, 3)), "tree_block": p(.7), "paving": p(.15),
        "slab": p(.15), "roof": p(.15), "title": p(.4), "elevation": p(.2), "section": p(.12), "second": p(.12),
    }

def draw_storey(s, st, mix):
    start = len(s.items)
    truth = draw_walls(s, st, mix); draw_columns(s, st, mix); truth += [list(g.exterior.coords) for g in st.columns]
    truth += draw_windows(s, st, mix); draw_doors(s, st, mix)
    how = "ring" if mix["wall"] in ("outline", "union") else "lines"
    for cls, shapes, is_cut in st.rest:
        for pts, closed in shapes: s.edges(cls, pts, closed or is_cut, how if len(pts) < 14 else "ring")
    uses = furnish(s, st, mix) if mix["furnished"] else {}
    if mix["names"]: rooms_text(s, st, mix, uses)
    if mix["slab"]:
        for g in st.footprint: s.pl("other", g.buffer(.46, join_style=2).simplify(.05).exterior.coords, True)
    if mix["roof"]:
        for g in st.footprint: s.pl("roof", g.buffer(.95, join_style=2).simplify(.1).exterior.coords, True, dash="DASHED")
    return truth, s.bounds(start)

def vary(things_dir, out, seed, count, names, hard=False):
    """The side for testing (EF-QUERY and truth.dxf) is drawn where OUT ends in `dev`; a second plan on the sheet only where it does not."""
    query = os.path.basename(out.rstrip("/")).endswith("dev"); ready = {}
    def storey(name):
        if name not in ready: ready[name] = Storey(load(things_dir, name))
        return ready[name]
    for name in names:
        ready.clear()
        for n in range(count):
            rng = random.Random(f"{seed}/{name}/{n}"); st = storey(name)
            if not st.footprint or len(st.rooms) < 2 or not any(d["gap"] for d in st.doors): print(name, "has no rooms", flush=True); break
            mix = mixture(rng, st); hand = Hand(rng, HARD) if hard else Hand(rng)
            if hard: mix = harder(rng, mix); how = rng.choice(("ring", "lines"))
            s = Sheet(rng, hand); s.zero = rng.random() < .6
            if hard: s.how = how
            truth, where = draw_storey(s, st, mix)
            if hard: draw_harder(s, st, mix)
            x0, y0, x1, y1 = st.box
            if mix["dim_sides"]: dimensions(s, st, mix)
            if mix["grid"]: grid(s, st, mix)
            s.views.append(("plan", s.bounds()))
            outside(s, st, mix)
            if hard and mix["contours"]: contours(s, st, mix)
            x0, y0, x1, y1 = s.bounds()
            others = [x for x in sorted(os.listdir(things_dir)) if x[:-5] != name and x[:-5].rsplit("-", 1)[0] == name.rsplit("-", 1)[0]]
            if mix["second"] and others and not query:
                other = storey(rng.choice(others)[:-5]); t = Sheet(rng, hand); t.zero = s.zero; t.blocks = s.blocks
                draw_storey(t, other, mix); b = t.bounds(); dx = x1 - b[0] + 5
                moved = (dx, 0.); shifted(s, t.items, moved); s.views.append(("plan", (b[0] + dx, b[1], b[2] + dx, b[3])))
            if mix["elevation"]: b = s.bounds(); elevation(s, mix, (b[0] + 3, b[1] - 14 - rng.uniform(0, 4)), min(x1 - x0, rng.uniform(9, 24)), rng.uniform(5, 9), False)
            if mix["section"]: b = s.bounds(); elevation(s, mix, (b[2] + 7, b[1] + 3), rng.uniform(8, 16), rng.uniform(5, 9), True)
            if hard and mix["legend"]: legend(s, mix)
            if mix["title"]: title(s, mix)
            if hard and mix["exploded"]: s.items = exploded(s, s.items)
            unit = rng.choices(list(UNITS), (40, 12, 25, 13, 10))[0]; metres, code = UNITS[unit]; k = 1 / metres
            u = rng.random(); said = code if u < .5 else 0 if u < .8 else rng.choice([c for c in (1, 2, 4, 5, 6) if c != code])
            turn = rng.choice((90., 180., 270., rng.uniform(0, 360), rng.uniform(0, 360), rng.uniform(-12, 12))) if rng.random() < .3 else 0.
            offset = (rng.uniform(-1, 1) * 60 * k, rng.uniform(-1, 1) * 60 * k)
            if rng.random() < .25: offset = tuple(min(rng.uniform(1e5, top) * k, 5e8 * rng.uniform(.5, 1)) for top in (6e5, 5e6))
            folder = f"{out}/{name}-{n}"; os.makedirs(folder, exist_ok=True)
            world = s.write(f"{folder}/plan.dxf", k, turn, offset, said, rng.choice(("R2000", "R2007", "R2010", "R2013")), st.footprint if query else ())
            json.dump({"mix": mix, "layers": hand.kind, "lang": hand.lang, "unit": unit, "insunits": said, "turn": turn, "zero": s.zero}, open(f"{folder}/mix.json", "w"))
            gaps_ = [("door", d["gap"]) for d in st.doors if d["gap"]] + [("window", g) for g in st.windows]
            json.dump([{"kind": what, "at": world(g[0]), "width_m": g[2]} for what, g in gaps_], open(f"{folder}/openings.json", "w"))
            if query:
                t = doc(code)
                for r in st.footprint: polyline(t.modelspace(), [world(p) for p in r.exterior.coords][:-1], True, "EF-QUERY")
                for ring in truth: polyline(t.modelspace(), [world(p) for p in ring], len(ring) > 2, "WALLS")
                t.saveas(f"{folder}/truth.dxf")
        print(name, flush=True)

def shifted(s, items, by):
    for what, cls, kind, data, more in items:
        m = lambda q: (q[0] + by[0], q[1] + by[1])
        if kind == "line": data = (m(data[0]), m(data[1]))
        elif kind in ("pl", "spline"): data = ([m(q) for q in data[0]], *data[1:])
        elif kind in ("arc", "circle", "text"): data = (m(data[0]), *data[1:])
        elif kind == "insert": data = (data[0], m(data[1]), *data[2:])
        elif kind == "hatch": data = ([affinity.translate(g, *by) for g in data[0]], *data[1:])
        elif kind == "dim": data = (m(data[0]), m(data[1]), m(data[2]), *data[3:])
        s.items.append((what, cls, kind, data, more))


if __name__ == "__main__":
    verb, rest = sys.argv[1], sys.argv[2:]
    if verb == "cut": cut(rest[0], rest[1:])
    elif verb == "dxf": from_dxf(rest[0], rest[1:])
    elif verb == "plans": plans(rest[0], rest[1], rest[2:])
    elif verb in ("vary", "hard"): vary(rest[0], rest[1], int(rest[2]), int(rest[3]), rest[4:], verb == "hard")
    else: sys.exit(__doc__)
