"""A round of options, as `Plan.optimise` makes it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional

from ._needed import needed

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Gain:
    """A gain over the present layout, measured on lattices that the search has not used.

    Attributes:
        share: gain as a share of the present value (of a score: the difference); more is better.
        low: lower end of its 95 % interval.
        high: upper end.
        sense: ``"max"`` where more of the measure is wanted, ``"min"`` where less is.
    """

    share: float
    low: float
    high: float
    sense: str


@dataclass(frozen=True)
class Option:
    """A layout that is better.

    Attributes:
        number: from 1; 0 is the best layout found, with all its moves.
        file: the drawing with the moved walls, a file in the folder of the round.
        words: what moves and what it gains, in plain words.
        gains: confirmed gains by measure (``"degree"``, ``"depth"`` …); empty where nothing was confirmed.
        data: all that ``result.json`` says of it.
    """

    number: int
    file: Path
    words: str
    gains: Dict[str, Gain]
    data: Dict[str, Any] = field(repr=False)
    _accept: Callable[[int], Path] = field(repr=False, compare=False)

    def accept(self) -> Path:
        """Makes it the new drawing beside the old one, with its moves and settings for the next round.

        Returns:
            The new drawing. Where the option was accepted before, the one that was written then.

        Raises:
            enfilade.Error: where the drawing has changed since, or nothing may be written there.
        """
        return self._accept(self.number)


@dataclass(frozen=True)
class Round:
    """What a search found. Its files are written.

    Attributes:
        options: really different layouts, all better, the best first; empty where there is none.
        best: the best layout found; ``None`` where there is none.
        folder: where the files of the round are: drawings, pictures, ``report.html``, ``result.json``.
        number: of the round, from 1.
        files: every file in the folder.
        findings: what was left out or assumed, as in `Plan.findings`.
        data: all that ``result.json`` says.
    """

    options: List[Option]
    best: Optional[Option]
    folder: Path
    number: Optional[int]
    findings: List[Dict[str, Any]] = field(repr=False)
    data: Dict[str, Any] = field(repr=False)

    @property
    def files(self) -> List[Path]:
        """Every file in the folder of the round, in order of name."""
        return sorted(path for path in self.folder.rglob("*") if path.is_file())

    def gains(self) -> pd.DataFrame:
        """Gains of all options: one row an option and measure, with ``share``, ``low`` and ``high``."""
        pandas = needed("pandas", "gains()")
        rows = [
            {"option": o.number, "measure": name, "share": g.share, "low": g.low, "high": g.high}
            for o in self.options
            for name, g in o.gains.items()
        ]
        columns = ["option", "measure", "share", "low", "high"]
        return pandas.DataFrame(rows, columns=columns).set_index(["option", "measure"])


def round_of(
    data: Dict[str, Any],
    findings: List[Dict[str, Any]],
    folder: Path,
    number: Optional[int],
    accept: Callable[[int, int], Path],
) -> Round:
    """A round from what ``result.json`` says."""

    def option(at: int, entry: Dict[str, Any]) -> Option:
        gains = {name: Gain(**gain) for name, gain in entry.get("gain", {}).items()}
        return Option(at, folder / entry["file"], entry["words"], gains, entry, lambda n: accept(number or 0, n))

    best = data["best"]
    return Round(
        options=[option(i, entry) for i, entry in enumerate(data["candidates"], 1)],
        best=option(0, best) if best and best["file"] else None,
        folder=folder,
        number=number,
        findings=findings,
        data=data,
    )
