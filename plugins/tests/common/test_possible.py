"""What may be done with an element, by its kind and where it stands."""

import pytest
from conftest import wall
from enfilade_common import possible
from enfilade_common.model import Opening, Region, Study
from enfilade_common.possible import Possible, Site

MOVES = ["x", "y", "along", "rotate"]


def test_what_a_house_offers(house):
    site = Site(house)
    assert site.of("S") == Possible(MOVES, ["add"], [possible.OUTER])
    doors = ["widen", "close", "rehang"]
    assert site.of("P1") == Possible(MOVES, ["open", "door", "glaze", *doors, "remove", "add"])
    assert site.of("P2") == Possible(MOVES, ["open", "door", "glaze", "end", "remove", "add"]), "its right end is free"
    assert site.of("P3") == Possible(MOVES, ["end", "remove", "add"], [possible.SHORT])
    assert site.of("C") == Possible(["x", "y", "rotate"], [], [possible.COLUMN])
    assert site.of("D1") == Possible(["along"], doors)
    assert site.of("D2") == Possible(["along"], [], [possible.OUTER]), "the front door"
    assert site.of("F") == Possible(["along"], [], [possible.WINDOW])
    assert site.of("nothing") is None


def test_a_passage_is_changed_like_a_door(house):
    house.element("P2").openings = [Opening("gap", "gap", 1000, 2000, "passage")]
    assert Site(house).of("gap").works == ["widen", "close", "rehang"]


def test_what_stays_is_offered_nothing(house):
    house.element("P1").locked = "it is pinned"
    house.element("P2").keep = True
    house.regions = [Region("keep", [(5800, 4300), (7000, 4300), (7000, 4700), (5800, 4700)])]
    site = Site(house)
    assert site.of("P1") == site.of("D1") == Possible([], [], [possible.LOCKED])
    assert site.of("P2") == Possible(MOVES, [], [possible.KEPT])
    assert site.of("P3") == Possible([], [], [possible.REGION])


def test_what_is_not_straight_is_only_removed(house):
    house.element("P3").rings = [[(6000, 4450), (6900, 4450), (6900, 4550), (6000, 4550)]]
    assert Site(house).of("P3") == Possible(MOVES, ["remove"], [possible.ROUND])


def test_a_wall_in_the_open_has_no_room():
    alone = Study("test", "doc", [wall("W", (0, 0), (5000, 0))])
    assert Site(alone).of("W") == Possible(MOVES, [], [possible.OUTER])


@pytest.mark.parametrize("doors, longest", [((), 5750), (((500, 1400),), 4350), (((500, 1400), (3000, 3900)), 1850)])
def test_the_longest_stretch_without_an_opening(doors, longest):
    made = wall("W", (0, 0), (0, 5750))
    made.openings = [Opening(str(i), str(i), *ends) for i, ends in enumerate(doors)]
    assert possible.longest_free(made) == longest


def test_a_bent_wall_is_asked_piece_by_piece():
    made = wall("W", (0, 0), (1000, 0))
    made.axis = [(0, 0), (1000, 0), (1000, 3000)]
    made.openings = [Opening("D", "D", 1200, 2100)]
    assert possible.longest_free(made) == 1900
