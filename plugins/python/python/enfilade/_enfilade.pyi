"""The compiled part. Settings, results and findings cross as JSON."""

from pathlib import Path
from typing import Callable, List, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

VERSION: str

_Column = Tuple[str, NDArray[np.float64], str, Tuple[float, float], bytes]
_Progress = Optional[Callable[[str], object]]

class Drawing:
    def __new__(cls, path: Path, named: str) -> Drawing: ...
    def check(self) -> Tuple[str, str, str, str]: ...
    def measure(self, named: str, roots: Optional[int], progress: _Progress) -> Present: ...
    def optimise(
        self, named: str, pin: List[int], like: Optional[int], progress: _Progress
    ) -> Tuple[str, str, Path, Optional[int]]: ...
    def accept(self, round: int, number: int, out: Optional[Path]) -> Tuple[Path, bool]: ...

class Present:
    @property
    def spacing_m(self) -> float: ...
    @property
    def findings(self) -> str: ...
    def cells(
        self,
        measures: List[str],
        radius: Optional[float],
        step_from: Sequence[Tuple[float, float]],
        in_metres: bool,
    ) -> Tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], List[_Column]]: ...
    def views(self) -> Tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int32]]: ...
    def walls(self) -> List[Tuple[List[Tuple[float, float]], bool, bool, bool]]: ...
