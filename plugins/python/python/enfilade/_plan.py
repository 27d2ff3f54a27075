"""A plan, and what can be asked of it."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

from . import _draw
from ._enfilade import Drawing, Present
from ._needed import needed
from ._round import Round, round_of

if TYPE_CHECKING:
    import networkx as nx
    import pandas as pd
    import scipy.sparse as sp
    from matplotlib.axes import Axes

#: Called with what is known: ``stage``, ``done``, ``total``, ``evaluations``, ``best``, ``eta_secs``.
Progress = Callable[[Dict[str, Any]], object]
Measures = Union[str, Sequence[str], None]
Point = Tuple[float, float]

def read(path: Union[str, os.PathLike[str]], **settings: Any) -> Plan:
    """Reads a drawing (DXF, IFC, glTF) and finds its walls, doors and rooms.

    Args:
        path: the drawing. It is never written.
        settings: of the command line's names, as ``unit="m"``, ``storey="1"``, ``wall_layer=["A-WALL"]``.

    Returns:
        The plan.

    Raises:
        enfilade.Error: where the file cannot be read, or a setting is wrong.
    """
    return Plan(path, **settings)


class Plan:
    """A drawing as it was understood; `read` makes it.

    Attributes:
        path: the drawing.
        unit: name of its unit, as ``"mm"``.
        metres_per_unit: metres in one unit of the drawing.
        area_m2: floor that is measured, m².
        walls: walls understood, from joint to joint.
        confidence: how sure the reading is in all, 0 to 1.
        findings: what was left out or assumed: dicts with ``code``, ``severity`` (``"info"``, ``"warning"``),
            ``file``, ``line``, ``entity`` and ``text``.
        questions: what a person should decide: dicts with ``text`` and ``answers``.
        data: all that ``enfilade check --json`` says.
    """

    def __init__(self, path: Union[str, os.PathLike[str]], **settings: Any) -> None:
        self.path = Path(path)
        self._drawing = Drawing(self.path, _named(settings))
        checked, findings, self._graph, self._graphml = self._drawing.check()
        self._present: Tuple[Optional[Tuple[str, Optional[int]]], Optional[Present]] = (None, None)
        self.data: Dict[str, Any] = json.loads(checked)
        self.findings: List[Dict[str, Any]] = json.loads(findings)
        reading = self.data["reading"]
        self.unit: str = self.data["unit"]["name"]
        self.metres_per_unit: float = self.data["unit"]["metres"]
        self.walls: int = self.data["walls_understood"]
        self.confidence: float = reading["confidence"]
        self.questions: List[Dict[str, Any]] = reading["questions"]
        drawn = [r["area_m2"] for r in self.data["regions"] if r["kind"] == "query" and not r.get("pair")]
        self.area_m2: float = sum(drawn or [room["area_m2"] for room in reading["rooms"]])

    def __repr__(self) -> str:
        found = len(self.findings)
        return (
            f"Plan({self.path.name!r}: {self.unit}, {self.area_m2:.1f} m², {self.walls} walls, "
            f"{self.confidence:.0%} confidence, {found} finding{'' if found == 1 else 's'})".replace("%", " %")
        )

    def analyse(
        self,
        measures: Measures = None,
        *,
        radius: Optional[float] = None,
        roots: Optional[int] = None,
        step_from: Sequence[Point] = (),
        coordinates: str = "metres",
        progress: Optional[Progress] = None,
        **settings: Any,
    ) -> pd.DataFrame:
        """Measures the layout as drawn.

        Args:
            measures: families (``graph``, ``isovist``, ``metric``, ``angular``, ``through``), ``all``, or names of
                columns; a list, or one text with commas. By default ``graph``.
            radius: nothing farther counts: steps of the graph measures (whole), right angles of the angular, metres
                of the metric ones.
            roots: estimate depth, entropy and integration from about so many cells, for huge plans.
            step_from: points (x, y) in drawing units, from which steps are counted.
            coordinates: ``"metres"`` of the drawing, or ``"drawing"``: drawing units, as ``--cells`` writes them.
            progress: called with a dict; what it raises ends the call.
            settings: of the command line's names, as ``spacing=0.1`` (m), ``level="knee"``.

        Returns:
            One row a cell. The index ``Ref`` is depthmapX's number of the cell. ``x`` and ``y`` are its centre. The
            other columns have depthmapX's names; ``Degree``, ``Depth`` and ``Entropy`` are always there. NaN: the
            cell has no value (``--cells`` writes −1 or nothing there). ``attrs`` has ``spacing_m``, ``units`` by
            column and ``findings``. The columns are the program's own memory.

        Raises:
            enfilade.Error: for a measure that there is none of, a setting that is wrong, no floor to measure.
            KeyboardInterrupt: on Ctrl-C, within a second.
        """
        pandas = needed("pandas", "analyse()")
        present = self._measured(roots, progress, settings)
        reference, x, y, columns = present.cells(
            _measures(measures), radius, [(px, py) for px, py in step_from], _in_metres(coordinates)
        )
        index = pandas.Index(reference, name="Ref", copy=False)
        named = {"x": x, "y": y, **{name: values for name, values, *_ in columns}}
        frame = pandas.DataFrame(named, index=index, copy=False)
        frame.attrs = {
            "file": self.path.name,
            "spacing_m": present.spacing_m,
            "units": {name: unit for name, _, unit, *_ in columns},
            "findings": json.loads(present.findings),
        }
        return frame

    def graph(self) -> nx.MultiGraph:
        """The architectural graph.

        Returns:
            Joints (``n0`` …), openings (``o0`` …) and rooms (``r0`` is the outside) are nodes with ``kind``, ``x``
            and ``y`` in drawing units; rooms have ``name`` and ``area_m2``, openings ``width_m``. Edges of the kind
            ``wall`` join joints and have ``thickness_m`` and ``axis``; those of the kind ``leads`` join an opening
            with a room. ``graph`` has ``metres_per_unit``.
        """
        networkx = needed("networkx", "graph()")
        graph = networkx.parse_graphml(self._graphml, force_multigraph=True)
        data = json.loads(self._graph)
        for i, wall in enumerate(data["walls"]):
            a, b = (f"n{n}" for n in wall["nodes"])
            graph.edges[a, b, f"w{i}"]["axis"] = wall["axis"]
        graph.graph.update(file=data["file"], metres_per_unit=data["metres_per_unit"])
        return graph

    def visibility(self, *, progress: Optional[Progress] = None, **settings: Any) -> sp.csr_matrix:
        """Who sees whom.

        Args:
            progress: as in `analyse`.
            settings: as in `analyse`; with the same ones the rows are the rows of its table.

        Returns:
            A symmetric n × n matrix of booleans: cell i sees cell j, if the line between their centres meets no
            wall. The diagonal is empty. ``matrix @ matrix`` says who is two steps away.
        """
        sparse = needed("scipy.sparse", "visibility()")
        numpy = needed("numpy", "visibility()")
        _, start, seen = self._measured(None, progress, settings).views()
        size = len(start) - 1
        return sparse.csr_matrix((numpy.ones(len(seen), bool), seen, start), shape=(size, size), copy=False)

    def optimise(
        self,
        *,
        pin: Sequence[int] = (),
        like: Optional[int] = None,
        progress: Optional[Progress] = None,
        **settings: Any,
    ) -> Round:
        """Moves the walls that may move, and writes the options into the result folder beside the drawing.

        Args:
            pin: numbers of options of the newest round that stay; the others are found unlike them.
            like: look near this option of the newest round.
            progress: as in `analyse`; ``best_parameters`` is the best layout so far.
            settings: of the command line's names: ``evaluations``, ``seconds``, ``seed``, ``members``,
                ``objective="degree max, depth min"``, ``limit``, ``out`` and so on.

        Returns:
            The round: options with confirmed gains, files.

        Raises:
            enfilade.Error: for a setting that is wrong, a drawing without floor, results that cannot be written.
            KeyboardInterrupt: on Ctrl-C, within a second; no half-written round is left.
        """
        data, findings, folder, number = self._drawing.optimise(
            _named(settings), list(pin), like, _as_lines(progress)
        )
        out = settings.get("out")

        def accept(round: int, option: int) -> Path:
            return Path(self._drawing.accept(round, option, None if out is None else Path(out))[0])

        return round_of(json.loads(data), json.loads(findings), Path(folder), number, accept)

    def accept(self, round: int, option: int) -> Path:
        """Makes an option of an earlier round the new drawing beside this one; 0 is the best layout.

        Returns:
            The new drawing.

        Raises:
            enfilade.Error: where there is no such round or option, or the drawing has changed since.
        """
        return Path(self._drawing.accept(round, option, None)[0])

    def show(
        self,
        measure: Optional[str] = "Degree",
        *,
        radius: Optional[float] = None,
        ax: Optional[Axes] = None,
        progress: Optional[Progress] = None,
        **settings: Any,
    ) -> Axes:
        """Draws walls and a measure of every cell, in the program's colours, with a scale bar.

        Args:
            measure: name of a column of `analyse`; ``None`` draws the walls alone.
            radius: as in `analyse`.
            ax: axes of matplotlib to draw in; by default those of a new figure.
            progress: as in `analyse`.
            settings: as in `analyse`; ``colours="blue-to-red"`` takes the paper's.

        Returns:
            The axes, in metres of the drawing.
        """
        pyplot = needed("matplotlib.pyplot", "show()")
        present = self._measured(None, progress, settings)
        if ax is None:
            ax = pyplot.figure(layout="constrained").add_subplot()
        if measure is not None:
            _draw.cells(ax, present, measure, radius)
        _draw.walls(ax, present)
        ax.set_title(self.path.name)
        return ax

    def _measured(
        self, roots: Optional[int], progress: Optional[Progress], settings: Dict[str, Any]
    ) -> Present:
        """The layout as drawn, measured; the last one is kept."""
        asked = (_named(settings), roots)
        known, present = self._present
        if present is None or known != asked:
            present = self._drawing.measure(*asked, _as_lines(progress))
            self._present = (asked, present)
        return present


def _named(settings: Dict[str, Any]) -> str:
    return json.dumps(settings, default=_plain, sort_keys=True)


def _plain(value: Any) -> Any:
    """Paths as text, numbers and arrays of NumPy as Python's."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a setting is text, a number, a list or true or false, found {type(value).__name__}")


def _measures(measures: Measures) -> List[str]:
    named = measures.split(",") if isinstance(measures, str) else measures or ()
    return [name.strip() for name in named if name.strip()]


def _in_metres(coordinates: str) -> bool:
    if coordinates not in ("metres", "drawing"):
        raise ValueError(f"coordinates: found {coordinates!r}, expected 'metres' or 'drawing'")
    return coordinates == "metres"


def _as_lines(progress: Optional[Progress]) -> Optional[Callable[[str], object]]:
    return None if progress is None else lambda line: progress(json.loads(line))
