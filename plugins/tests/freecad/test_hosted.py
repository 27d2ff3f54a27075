"""What stands in a wall goes with it, whether it is a gap in the plan or not."""

import math

import Arch
import FreeCAD as App
import Part
import pytest
from conftest import V, door_in, wall_on
from enfilade import accept, document, hosted, marks
from enfilade_common.model import PluginError
from test_accepting import option_with, state


def window(wall, at, sill, label, turn=0.0, height=500, width=800):
    place = App.Placement(V(*at, sill), App.Rotation(V(0, 0, 1), turn).multiply(App.Rotation(V(1, 0, 0), 90)))
    sizes = dict(width=width, height=height, h1=50, h2=50, h3=0, w1=100, w2=50, o1=0, o2=50)
    made = Arch.makeWindowPreset("Open 1-pane", placement=place, **sizes)
    made.Hosts, made.Label = [wall], label
    return made


def settled(doc):
    doc.recompute()
    doc.recompute()
    doc.clearUndos()


def gaps(doc, label):
    return [o.label for e in document.read(doc).elements() if e.label == label for o in e.openings]


def corners(obj):
    return [(round(p.x, 1), round(p.y, 1), round(p.z, 1)) for p in hosted.corners(obj)]


def went(before, obj, motion):
    """Corners of an object after a motion ``(angle, about, dx, dy)`` of the plan."""
    angle, (cx, cy), dx, dy = motion
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    moved = [(c * (x - cx) - s * (y - cy) + cx + dx, s * (x - cx) + c * (y - cy) + cy + dy, z) for x, y, z in before]
    return all(math.dist(p, q) < 0.3 for p, q in zip(moved, corners(obj)))


def accepted(doc, wishes, folder, values, things, motions):
    """Accepts an option and looks whether things went as they should, with undo."""
    made, found, option = option_with(doc, wishes, folder, values)
    whole, before = state(doc), [corners(t) for t in things]
    accept.accept(doc, made, found, option)
    for thing, old, motion in zip(things, before, motions):
        assert went(old, thing, motion), (thing.Label, old, corners(thing))
    doc.undo()
    doc.recompute()
    assert state(doc) == whole and [corners(t) for t in things] == before
    doc.redo()
    doc.recompute()


def test_the_door_of_a_composite_wall(doc, wishes, tmp_path):
    wall = wall_on(doc, "draft", (4000, 125), (4000, 4800), label="P")
    layers = Arch.makeMultiMaterial()
    stone = Arch.makeMaterial("Stone")
    layers.Names, layers.Materials, layers.Thicknesses = ["a", "b"], [stone, stone], [115.0, 60.0]
    wall.Material = layers
    doc.recompute()
    door = door_in(wall, (4000, 700), 90, label="Tür")
    settled(doc)
    volume = wall.Shape.Volume
    marks.mark(wall, {"x": (-500, 500)})
    accepted(doc, wishes, tmp_path, {("P", "x"): 321.5}, [door], [(0, (0, 0), 321.5, 0)])
    assert wall.Shape.Volume == pytest.approx(volume, rel=1e-6), "the hole went along"


def test_windows_above_and_below_the_eye(doc, wishes, tmp_path):
    wall = wall_on(doc, "draft", (4000, 125), (4000, 5875), label="P")
    doc.recompute()
    door = door_in(wall, (4000, 700), 90, label="Tür")
    high = window(wall, (4000, 3000), 2200, "Oberlicht", 90)
    low = window(wall, (4000, 4500), 100, "Klappe", 90)
    settled(doc)
    assert gaps(doc, "P") == ["Tür"], "what is no gap at eye height is none in the plan"
    volume = wall.Shape.Volume
    marks.mark(wall, {"x": (-1500, 1500)})
    motion = (0, (0, 0), -700, 0)
    accepted(doc, wishes, tmp_path, {("P", "x"): -700.0}, [door, high, low], [motion] * 3)
    assert wall.Shape.Volume == pytest.approx(volume, rel=1e-6)


def test_a_high_window_in_a_turned_wall(doc, wishes, tmp_path):
    wall = wall_on(doc, "draft", (4000, 2000), (6000, 2000), label="P")
    doc.recompute()
    high = window(wall, (4500, 2000), 2200, "Oberlicht")
    settled(doc)
    marks.mark(wall, {"rotate": (-45, 45)})
    accepted(doc, wishes, tmp_path, {("P", "rotate"): 30.0}, [high], [(30, (5000, 2000), 0, 0)])


def test_the_door_of_an_arc(doc, wishes, tmp_path):
    base = doc.addObject("Part::Feature", "Arc")
    base.Shape = Part.Arc(V(2000, 2000, 0), V(3500, 2600, 0), V(5000, 2000, 0)).toShape()
    wall = Arch.makeWall(base, width=200, height=3000)
    wall.Label = "bow"
    doc.recompute()
    door = door_in(wall, (3050, 2550), label="Tür")
    settled(doc)
    volume = wall.Shape.Volume
    marks.mark(wall, {"y": (-1000, 1500)})
    accepted(doc, wishes, tmp_path, {("bow", "y"): 640.0}, [door], [(0, (0, 0), 0, 640)])
    assert wall.Shape.Volume == pytest.approx(volume, rel=1e-4)


def test_a_stretched_wall_keeps_its_high_window(doc, wishes, tmp_path):
    mover = wall_on(doc, "draft", (4000, 125), (4000, 5875), label="P")
    spur = wall_on(doc, "draft", (4050, 3000), (7000, 3000), label="spur")
    doc.recompute()
    high = window(spur, (5000, 3000), 2200, "Oberlicht")
    settled(doc)
    marks.mark(mover, {"x": (-1500, 1500)})
    accepted(doc, wishes, tmp_path, {("P", "x"): 400.0}, [high], [(0, (0, 0), 0, 0)])
    doc.undo()
    doc.recompute()
    made, found, option = option_with(doc, wishes, tmp_path, {("P", "x"): 1400.0})
    before = state(doc)
    with pytest.raises(PluginError, match="'Oberlicht' would no longer stand in 'spur'"):
        accept.accept(doc, made, found, option)
    assert state(doc) == before


def test_a_window_that_is_held_is_named(doc, wishes, tmp_path):
    wall = wall_on(doc, "draft", (4000, 125), (4000, 5875), label="P")
    doc.recompute()
    high = window(wall, (4000, 3000), 2200, "Oberlicht", 90)
    settled(doc)
    marks.mark(wall, {"x": (-1500, 1500)})
    made, found, option = option_with(doc, wishes, tmp_path, {("P", "x"): 700.0})
    high.setExpression("Placement.Base.x", "0 mm")
    doc.recompute()
    before = state(doc)
    with pytest.raises(PluginError, match="'Oberlicht' in it cannot go along: an expression decides"):
        accept.accept(doc, made, found, option)
    assert state(doc) == before


def test_what_freecad_moves_by_itself_is_not_moved_twice(doc, wishes, tmp_path):
    wall = wall_on(doc, "bare", (2000, 2000), (6000, 2000), label="P")
    doc.recompute()
    high = window(wall, (4500, 2000), 2200, "Oberlicht")
    high.MoveWithHost = True
    settled(doc)
    marks.mark(wall, {"y": (-500, 500)})
    accepted(doc, wishes, tmp_path, {("P", "y"): 300.0}, [high], [(0, (0, 0), 0, 300)])


def test_the_door_of_a_wall_on_a_rectangle(doc, wishes, tmp_path):
    import Draft

    base = Draft.make_rectangle(2000, 2000, App.Placement(V(3000, 2000, 0), App.Rotation()), False)
    doc.recompute()
    wall = Arch.makeWall(base, width=120, height=3000)
    wall.Label = "room"
    doc.recompute()
    door = door_in(wall, (3500, 2000), label="Tür")
    settled(doc)
    volume = wall.Shape.Volume
    marks.mark(wall, {"x": (-500, 500)})
    accepted(doc, wishes, tmp_path, {("room", "x"): 140.0}, [door], [(0, (0, 0), 140, 0)])
    assert wall.Shape.Volume == pytest.approx(volume, rel=1e-6)


def box(doc, label, x, y, z, length, width, height):
    made = doc.addObject("Part::Box", label)
    made.Label, made.Length, made.Width, made.Height = label, length, width, height
    made.Placement.Base = V(x, y, z)
    return made


def test_a_niche_and_an_addition_go_with_their_wall(doc, wishes, tmp_path):
    wall = wall_on(doc, "draft", (4000, 125), (4000, 5875), 300, label="P")
    doc.recompute()
    niche = box(doc, "niche", 3850, 2000, 300, 150, 800, 700)
    shelf = box(doc, "shelf", 4100, 3500, 2000, 300, 500, 100)
    doc.recompute()
    Arch.removeComponents(niche, wall)
    Arch.addComponents(shelf, wall)
    settled(doc)
    volume = wall.Shape.Volume
    marks.mark(wall, {"x": (-500, 500)})
    accepted(doc, wishes, tmp_path, {("P", "x"): 411.0}, [niche, shelf], [(0, (0, 0), 411, 0)] * 2)
    assert wall.Shape.Volume == pytest.approx(volume, rel=1e-6)


def test_a_niche_that_is_held_holds_its_wall_and_a_shared_one_is_said(doc, wishes):
    walls = [wall_on(doc, "draft", (x, 125), (x, 5875), 300, label=f"P{x}") for x in (2000, 4000)]
    doc.recompute()
    held, shared = box(doc, "held", 3850, 2000, 300, 150, 800, 700), box(doc, "shared", 1000, 4000, 0, 4000, 500, 500)
    held.setExpression("Placement.Base.x", "3850 mm")
    doc.recompute()
    Arch.removeComponents(held, walls[1])
    for wall in walls:
        wall.Subtractions = [*wall.Subtractions, shared]
        marks.mark(wall, {"x": (-500, 500)})
    settled(doc)
    reading = document.read(doc)
    assert [e.locked for e in reading.elements()] == ["", "'held' in it cannot go along: an expression decides where 'held' stands"]
    assert any("'shared' belongs to 'P2000' and to other walls" in n for n in reading.notes), reading.notes


def test_a_door_that_cannot_slide_in_its_wall_is_said(doc):
    base = doc.addObject("Part::Feature", "Arc")
    base.Shape = Part.Arc(V(2000, 2000, 0), V(3500, 2600, 0), V(5000, 2000, 0)).toShape()
    wall = Arch.makeWall(base, width=200, height=3000)
    doc.recompute()
    door = door_in(wall, (3050, 2550), label="Tür")
    settled(doc)
    marks.mark(door, {"along": (-200, 200)})
    assert any("'Tür' does not slide" in n for n in document.read(doc).notes)
