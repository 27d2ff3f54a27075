"""Doors, glass and openings without a leaf as FreeCAD's own objects in a wall; what they look like in it."""

import math
from typing import Optional

import Arch
import Draft
import FreeCAD as App

from enfilade_common.model import Wall
from enfilade_common.plane import Point, direction, left_of, plus

from . import document, hosted
from .wording import say

Vector = App.Vector

#: Head of a door where no other tells, mm (DIN 18100: 2.125 m and less).
DOOR_MM = 2100.0
#: Glass begins above a base: whatever begins lower is read as a door, mm.
GLASS_SILL_MM = 150.0
#: Frames of doors and glass, mm.
FRAME_MM = 50.0
#: The hole reaches so far beyond both faces, so that the cut is clean, mm.
BEYOND_MM = 1.0


def head_of(obj, foot: float) -> float:
    """Height of an object's upper edge above the foot of its wall, mm."""
    return max(p.z for p in hosted.corners(obj)) - foot


def head_in(reading: document.Reading, wall: Wall) -> Optional[float]:
    """Head of the other doors of a wall."""
    foot = document.foot_of(wall, reading)
    doors = [reading.openings[o.id] for o in wall.openings if o.kind == "door"]
    doors += [o for o in reading.hosted.get(wall.id, ()) if getattr(o, "IfcType", "") == "Door"]
    return max((head_of(door, foot) for door in doors), default=None)


def head_anywhere(reading: document.Reading) -> float:
    """Head of the doors of a plan, the lowest; the usual one where it has none."""
    walls = [f.element for f in reading.found.values() if isinstance(f.element, Wall)]
    return min((h for h in (head_in(reading, w) for w in walls) if h), default=DOOR_MM)


def heights(reading: document.Reading, wall: Wall, filling: str, like=None) -> tuple:
    """Sill and head of a new opening above the foot of its wall: as the opening ``like`` or the doors of the wall
    have it. One without a leaf goes to the top where the wall has no door."""
    if like is not None:
        head: Optional[float] = head_of(like, document.foot_of(wall, reading))
    else:
        head = head_in(reading, wall)
    if head is None and filling != "nothing":
        head = head_anywhere(reading)
    sill = GLASS_SILL_MM if filling == "glass" else 0.0
    return sill, min(head or wall.height, wall.height)


def make(wall_obj, wall: Wall, ends: tuple, z: tuple, filling: str):
    """An opening in a wall between two points of its axis and two heights of the document."""
    obj = _window(wall, ends, z, filling) if filling != "nothing" else _hole(wall, ends, z)
    obj.HoleDepth = max(wall.left, wall.right) + BEYOND_MM if filling == "nothing" else wall.thickness + BEYOND_MM
    obj.Hosts = [wall_obj]
    return obj


def _turned(u: Point) -> App.Rotation:
    """A sketch that stands upright along ``u``; it is thickened to the left."""
    upright = App.Rotation(Vector(1, 0, 0), 90)
    return App.Rotation(Vector(0, 0, 1), math.degrees(math.atan2(u[1], u[0]))).multiply(upright)


def _window(wall: Wall, ends: tuple, z: tuple, filling: str):
    u = direction(*ends)
    x, y = plus(ends[0], left_of(u), -wall.right)
    frame = min(FRAME_MM, wall.thickness / 2.0)
    width = math.dist(*ends)
    sizes = dict(width=width, height=z[1] - z[0], h1=frame, h2=frame, h3=0, w1=wall.thickness, w2=frame, o1=0, o2=0)
    place = App.Placement(Vector(x, y, z[0]), _turned(u))
    made = Arch.makeWindowPreset("Simple door" if filling == "door" else "Fixed", placement=place, **sizes)
    made.Label = say("Door") if filling == "door" else say("Glass")
    if filling == "glass":
        made.WindowParts = _pane_within(made.WindowParts, wall.thickness, frame)
    return made


def _pane_within(parts, thickness: float, frame: float):
    """The pane in the middle of its frame; FreeCAD's preset lets it stand out of a thin wall."""
    out = list(parts)
    pane = frame / 5.0
    out[-2], out[-1] = str(pane), str((thickness - pane) / 2.0)
    return out


def _hole(wall: Wall, ends: tuple, z: tuple):
    (ax, ay), (bx, by) = ends
    corners = [Vector(ax, ay, z[0]), Vector(bx, by, z[0]), Vector(bx, by, z[1]), Vector(ax, ay, z[1])]
    base = Draft.make_wire(corners, closed=True, face=False)
    base.Document.recompute([base])
    made = Arch.makeWindow(base, math.dist(*ends), z[1] - z[0])
    # Without parts it is a hole and nothing else.
    made.WindowParts = []
    made.Normal = Vector(*left_of(direction(*ends)), 0)
    made.Label = say("Opening")
    if "Opening Element" in made.getEnumerationsOfProperty("IfcType"):
        made.IfcType = "Opening Element"
    return made


def remove(obj) -> None:
    """Takes a door, a window or an opening out of its wall, with the sketch that only it stands on."""
    hosts, base = list(getattr(obj, "Hosts", None) or []), getattr(obj, "Base", None)
    holders = [o for o in obj.InList if obj in getattr(o, "Subtractions", [])]
    obj.Document.removeObject(obj.Name)
    drop_unused(base)
    for host in [*hosts, *holders]:
        host.touch()


def drop_unused(base) -> None:
    """Removes a base that nothing stands on any more; groups do not count."""
    if base is None or any(not hasattr(o, "Group") for o in base.InList):
        return
    base.Document.removeObject(base.Name)
