"""What goes with a wall: its doors and windows, also those that are no gap at eye height, its niches and
additions. None of it decides where the wall stands; all of it must stand in it as before once it has moved."""

from dataclasses import dataclass
from typing import Any, List

import FreeCAD as App

from enfilade_common.model import PluginError
from enfilade_common.plane import Rigid, fit_rigid

Vector = App.Vector

#: What went with a wall stands in it as before to this, mm.
STAND_MM = 0.1


@dataclass
class Going:
    """An object that goes with a wall: its motion, and where its corners stood."""

    object: Any
    motion: Rigid
    before: List[Vector]

    def targets(self) -> List[Vector]:
        return [Vector(*self.motion((p.x, p.y)), p.z) for p in self.before]

    def stands(self) -> bool:
        now, targets = corners(self.object), self.targets()
        return len(now) == len(targets) and all((p - q).Length <= STAND_MM for p, q in zip(now, targets))


def placement(motion: Rigid) -> App.Placement:
    """A motion of the plan as FreeCAD's placement."""
    turn = App.Rotation(Vector(0, 0, 1), motion.angle_rad * 180.0 / 3.141592653589793)
    return App.Placement(Vector(motion.dx, motion.dy, 0), turn)


def outer_placement(obj) -> App.Placement:
    """Where the parts an object lies in stand: from its own coordinates to those of the document."""
    if not hasattr(obj, "getGlobalPlacement"):
        return App.Placement()
    return obj.getGlobalPlacement().multiply(obj.Placement.inverse())


def corners(obj) -> List[Vector]:
    """Corners of an object in the document; those of its base line where it has no shape of its own, as an
    opening without a frame."""
    outer = outer_placement(obj)
    for part in (obj, getattr(obj, "Base", None)):
        shape = getattr(part, "Shape", None)
        if shape is not None and not shape.isNull() and shape.Vertexes:
            return [outer.multVec(v.Point) for v in shape.Vertexes]
    return []


def move(going: List[Going]) -> None:
    for one in going:
        one.object.Placement = placement(one.motion).multiply(one.object.Placement)


def settle(doc, going: List[Going]) -> None:
    """Puts right what FreeCAD moved along by itself, so that it went twice; refuses what stands elsewhere."""
    astray = [one for one in going if not one.stands()]
    if not astray:
        return
    for one in astray:
        now, targets = corners(one.object), one.targets()
        if len(now) == len(targets) and now:
            back, _ = fit_rigid([(p.x, p.y) for p in now], [(p.x, p.y) for p in targets])
            one.object.Placement = placement(back).multiply(one.object.Placement)
    doc.recompute()
    held = [f"'{one.object.Label}'" for one in astray if not one.stands()]
    if held:
        words = ", ".join(held) + " does not go with its wall: something holds it"
        raise PluginError(words + "; nothing was changed.")
