"""One option of a round, as its result says it."""

import math
import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional

from .works import Work

#: Per cents are told in tenths where the interval is narrower than this.
TENTHS_BELOW = 0.01

#: Signs of the verdicts of a brief.
SIGNS = {"pass": "✓", "fail": "✗"}


@dataclass
class BriefLine:
    """An item of the brief of rooms in one layout."""

    #: ``pass``, ``fail`` or ``untold``.
    verdict: str
    #: As it is asked.
    ask: str
    #: The places that do not meet it, or do not say.
    places: List[str] = field(default_factory=list)

    def text(self) -> str:
        """``✗ bedroom area min 10 m2: Bedroom 2: 9.00 m²``."""
        tail = ": " + "; ".join(self.places) if self.places else ""
        return f"{SIGNS.get(self.verdict, '?')} {self.ask}{tail}"


@dataclass
class Option:
    """One option of a round. Numbers as in result.json."""

    number: int
    file: str
    words: str
    mean: Dict[str, float]
    penalty: Dict[str, float]
    score: Optional[float]
    within_threshold: bool
    parameters: List[float]
    changes: List[Dict[str, Any]]
    #: Confirmed gains by measure: ``share``, ``low``, ``high`` (more is better) and ``sense``; empty where none were.
    gain: Dict[str, Dict[str, Any]] = field(default_factory=dict)
    #: Units of the host's document in a metre.
    per_metre: float = 1000.0
    #: Building works; none where it only moves what stands.
    works: List[Work] = field(default_factory=list)
    #: What it has of the brief of rooms.
    brief: List[BriefLine] = field(default_factory=list)

    def change(self, measure: str) -> str:
        """The confirmed change of a measure, as the program writes it: ``+9 % (7 to 11 %)``."""
        gain = self.gain.get(measure)
        if not gain:
            return ""
        low, share, high = (float(gain[k]) for k in ("low", "share", "high"))
        # A score's is a difference.
        times, unit = (1.0, "") if measure == "score" else (100.0, " %")
        is_unsure = low <= 0 <= high
        is_near_none = not is_unsure and min(abs(low), abs(high)) < TENTHS_BELOW
        digits = 2 if measure == "score" else 1 if high - low < TENTHS_BELOW or is_near_none else 0
        turned = 1 if gain["sense"] == "max" else -1
        ends = sorted((turned * low, turned * high))
        # Rounding makes the interval wider, never narrower.
        step = times * 10**digits
        steps = (math.floor(ends[0] * step + 1e-6), math.ceil(ends[1] * step - 1e-6))
        between = " to ".join(_fixed(v / 10**digits, digits) for v in steps)
        if is_unsure:
            return f"unchanged ({between}{unit})"
        sign = "+" if turned * share > 0 else ""
        return f"{sign}{_fixed(times * turned * share, digits)}{unit} ({between}{unit})"

    def picture(self, measure: str) -> str:
        return os.path.splitext(self.file)[0] + f"-{measure}.png"


def _fixed(value: float, digits: int) -> str:
    """As the program writes it: a zero has no sign."""
    text = f"{abs(value):.{digits}f}"
    return "−" + text if value < 0 and float(text) else text
