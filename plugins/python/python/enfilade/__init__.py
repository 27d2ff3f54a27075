"""Measure how the space of a plan works, and find better layouts of the walls that may move.

>>> import enfilade
>>> plan = enfilade.read("plan.dxf")
>>> plan
Plan('plan.dxf': m, 182.4 m², 31 walls, 97 % confidence, 2 findings)
>>> cells = plan.analyse(measures="isovist")        # pandas: one row a cell
>>> graph = plan.graph()                            # networkx: rooms, doors, walls
>>> sight = plan.visibility()                       # scipy.sparse: who sees whom
>>> plan.show("Isovist Area")                       # matplotlib
>>> best = plan.optimise(evaluations=2000).options[0]
>>> best.accept()                                   # a new drawing beside plan.dxf

Settings have the names of the command line's options, with ``_`` for ``-``: ``unit="m"``, ``spacing=0.1``,
``wall_layer=["A-WALL"]``, ``not_wall=["layer:A-FURN"]``. Those given to :func:`read` hold for all that is asked of
the plan; those given to a method hold for that call. The settings beside the drawing hold where you say nothing.

Lengths are metres, areas square metres, unless a name says otherwise. pandas, networkx, scipy and matplotlib are
imported when they are needed.
"""

from ._enfilade import VERSION as __version__
from ._error import Error
from ._plan import Plan, read
from ._round import Gain, Option, Round

__all__ = ["Error", "Gain", "Option", "Plan", "Round", "__version__", "read"]
