"""Building works in walls without an axis, as IFC files bring them."""

import Arch
import pytest
from conftest import V, door_in
from enfilade import document, openings
from rounds import work
from test_works import accepted, refused, walls_of

JAMBS = [[2, 0], [2.9, 0]]


@pytest.fixture
def solid(doc):
    """A wall of 6 m on a solid, with a door from 2 to 2.9 m."""
    box = doc.addObject("Part::Box", "Box")
    box.Length, box.Width, box.Height = 6000, 150, 2800
    box.Placement.Base = V(0, -75, 0)
    doc.recompute()
    wall = Arch.makeWall(box)
    wall.Label = "solid"
    doc.recompute()
    door = door_in(wall, (2000, 0), label="Tür")
    doc.recompute()
    doc.recompute()
    assert walls_of(doc)["solid"].rings, "it is read by its outline"
    return wall, door


def windows(doc):
    return [o for o in doc.Objects if document.kind_of(o) == "Window"]


@pytest.mark.parametrize("filling", ("nothing", "door", "glass"))
def test_an_opening_is_cut(doc, wishes, tmp_path, template, solid, filling):
    wall, door = solid
    volume = wall.Shape.Volume

    def look():
        (new,) = (o for o in windows(doc) if o.Name != door.Name)
        height = 2100 - (openings.GLASS_SILL_MM if filling == "glass" else 0)
        assert wall.Shape.Volume == pytest.approx(volume - 1500 * 150 * height, rel=1e-6)
        assert len(walls_of(doc)["solid"].rings) == 3 and new.Hosts == [wall]

    kind = {"nothing": "open", "door": "door", "glass": "glaze"}[filling]
    accepted(doc, wishes, tmp_path, template, [work(kind, (3.8, 0), (5.3, 0), 0.15, filling=filling)], ["solid"], look)


def test_its_door_is_widened_walled_up_and_hung_elsewhere(doc, wishes, tmp_path, template, solid):
    wall, door = solid
    volume = wall.Shape.Volume
    built = [((2, 0), (2.9, 0))]
    works = {
        "widen": (work("widen", (2, 0), (4, 0), 0.15, opening=JAMBS), volume - 1100 * 150 * 2100),
        "close": (work("close", (2, 0), (2.9, 0), 0.15, demolished=[], built=built, opening=JAMBS), volume + 900 * 150 * 2100),
        "rehang": (work("rehang", (4, 0), (5, 0), 0.15, built=built, opening=JAMBS, filling="door"), volume - 100 * 150 * 2100),
    }
    for name, (made, wanted) in works.items():

        def look():
            assert wall.Shape.Volume == pytest.approx(wanted, rel=1e-6), name
            assert len(windows(doc)) == (0 if name == "close" else 1)

        accepted(doc, wishes, tmp_path / name, template, [made], ["solid"], look)
        doc.undo()
        doc.recompute()


def test_it_goes_as_a_whole_or_not_at_all(doc, wishes, tmp_path, template, solid):
    wall, door = solid
    names = [wall.Name, door.Name, "Box"]
    part = work("remove", (3.5, 0), (6, 0), 0.15)
    refused(doc, wishes, tmp_path / "1", template, [part], "'solid': only the whole wall could be removed here", ["solid"])
    Arch.makeWall(None, length=3000, width=100, height=2800).Label = "other"
    doc.recompute()

    def look():
        assert [doc.getObject(n) for n in names] == [None] * 3

    accepted(doc, wishes, tmp_path / "2", template, [work("remove", (0, 0), (6, 0), 0.15)], ["solid"], look)


def test_a_new_wall_is_as_high(doc, wishes, tmp_path, template, solid):
    made = work("add", (3, 0.075), (3, 2), 0.1, demolished=[], built=[((3, 0.075), (3, 2))])

    def look():
        new = walls_of(doc)["New wall"]
        assert (new.thickness, new.height) == (100, 2800)

    accepted(doc, wishes, tmp_path, template, [made], ["solid"], look)
