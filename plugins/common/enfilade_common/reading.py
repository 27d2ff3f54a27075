"""How the program reads a drawing, as its check says it: unit, walls, doors, and how wide a door is."""

import json
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple

from .model import UNITS, PluginError

CHECK_SCHEMA = "enfilade.check/2"
#: Doors are so wide: the middle one of a plan, m.
DOOR_M = (0.6, 1.3)
#: What is offered as the width of a door, m.
OFFERED_M = (0.5, 2.5)


@dataclass
class DoorQuestion:
    """How wide a door is: the answers with the unit of the drawing that each means, and the place of the door."""

    answers: List[Tuple[float, str]]
    #: In units of the drawing, where known.
    at: Optional[Tuple[float, float]] = None
    #: Handles of what draws the door.
    handles: List[str] = field(default_factory=list)


@dataclass
class Reading:
    """What the program read."""

    unit: str
    walls: int
    doors: int
    rooms: int
    #: Width of the middle door, m; none where there is no door.
    door_m: Optional[float] = None
    question: Optional[DoorQuestion] = None

    @property
    def is_plausible(self) -> bool:
        return self.door_m is None or DOOR_M[0] <= self.door_m <= DOOR_M[1]


def reading_of(text: str) -> Reading:
    """Reads the JSON of a check."""
    try:
        data = json.loads(text)
        if data.get("schema") != CHECK_SCHEMA:
            raise PluginError(f"The check has the schema {data.get('schema')!r}, this plugin reads {CHECK_SCHEMA!r}.")
        return _reading(data["reading"])
    except (ValueError, KeyError, TypeError, AttributeError, IndexError) as e:
        raise PluginError(f"The program's check cannot be read ({type(e).__name__}: {e}).") from e


def _reading(data: Dict[str, Any]) -> Reading:
    doors = sorted((o for o in data["openings"] if o["kind"] == "door"), key=lambda o: float(o["width_m"]))
    unit = data["unit"]
    made = Reading(str(unit["name"]), len(data["walls"]), len(doors), len(data["rooms"]))
    middle = doors[(len(doors) - 1) // 2] if doors else None
    made.door_m = float(middle["width_m"]) if middle else None
    asked = next((q for q in data.get("questions") or [] if q["about"] == "unit"), None)
    if asked is not None and asked["values"].get("witness") == "door":
        length = float(asked["values"]["length"])
        lengths = [float(v) for v in asked["values"]["lengths_m"]]
        units = [str(a["correction"]["unit"]) for a in asked["answers"]]
        near = min(doors, key=lambda o: abs(float(o["width_m"]) / float(unit["metres"]) - length), default=None)
        made.question = _question(length, near, list(zip(lengths, units)))
    elif middle is not None and (asked is not None or not made.is_plausible):
        made.question = _question(float(middle["width_m"]) / float(unit["metres"]), middle, [])
    return made


def _question(length: float, door: Optional[Dict[str, Any]], asked: List[Tuple[float, str]]) -> Optional[DoorQuestion]:
    """A door of so many units of the drawing: widths that doors have, and what the program asks itself."""
    offered = [(length * metres, unit) for unit, metres in UNITS.items()]
    offered = [a for a in offered if OFFERED_M[0] <= a[0] <= OFFERED_M[1]]
    known = {unit for _, unit in offered}
    answers = sorted(offered + [a for a in asked if a[1] not in known])
    if not answers:
        return None
    at = (float(door["at"][0]), float(door["at"][1])) if door else None
    handles = [str(e.get("handle")) for e in door.get("elements") or []] if door else []
    return DoorQuestion(answers, at, handles)
