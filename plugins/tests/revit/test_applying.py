"""Options applied to a model: everything where the option says, or nothing changed; one entry to undo."""

import itertools

import pytest
from enfilade_common import job, results
from enfilade_common.model import PluginError, Wishes
from enfilade_common.moves import applied, plan_of
from enfilade_common.plane import distance
from enfilade_common.works import Work
from enfilade_revit import applying, reading
from enfilade_revit.host import Host
from fake import building, elements, walls
from fake.building import MM
from fake.failures import BuiltInCategory, FailureSeverity, PlanViewPlane


def option_of(host, folder, values):
    """A job and the option of chosen parameters, as the program writes it."""
    study, _ = reading.study(host, Wishes())
    made = job.write(study, str(folder))
    plan = plan_of(study)
    values = [values.get((t.name.rsplit(" ", 1)[0], t.clause.kind), 0.0) for t in plan.tables]
    metres = lambda points: [[x / 1000, y / 1000] for x, y in points]  # noqa: E731
    changes = [
        {"host_id": o.host_id, "from": metres(o.written()), "to": metres(o.written(ring))}
        for o, ring in zip(plan.outlines, applied(plan, values))
        if ring != o.points
    ]
    return made, results.Option(1, "candidate-1.dxf", "", {}, {}, None, True, values, changes)


MOVES = {("Partition", "x"): 400.0, ("Door", "along"): 700.0, ("Screen", "y"): 200.0, ("Screen", "rotate"): 15.0, ("Column", "x"): -100.0}


def ends(wall):
    return [pytest.approx(tuple(v / MM for v in wall._at(t)), abs=0.1) for t in wall._s["ends"]]


def place(thing):
    return pytest.approx(tuple(v / MM for v in thing._s["point"]), abs=0.1)


def everything(model):
    return repr({i: e._s for i, e in model.doc._elements.items()})


@pytest.fixture(params=itertools.product(("follow", "stay"), ("start", "place")), ids=lambda h: "-".join(h))
def habits(request, revit):
    """Whatever Revit does with joined walls and with inserts, the outcome is that of the option."""
    revit.doc._habits = dict(zip(("joins", "inserts"), request.param))


def test_an_option_moves_everything_in_one_undo_step(revit, habits, tmp_path):
    made, option = option_of(revit.host(), tmp_path, MOVES)
    before = everything(revit)
    moved = applying.apply(revit.host(), made, option)
    at = revit.at
    assert [label.split()[0] for label in moved] == ["Partition", "Spur", "Screen", "Column"]
    assert [(4400, 0), (4400, 6000)] == ends(at["Partition"])
    assert [(4400, 3000), (7000, 3000)] == ends(at["Spur"]), "the end that was joined follows, the other stays"
    assert (4400, 1700) == place(at["Door"]), "the door slid and went along"
    assert (6000, 0) == place(at["Window"]), "the window of a wall that stays, stays"
    assert (1800, 3000) == place(at["Column"])
    assert sum(at["Screen"]._s["ends"]) / MM == pytest.approx(900, abs=0.1)
    assert at["Partition"]._s["joins"] == at["Spur"]._s["joins"] == (True, True)
    assert [name for name, _ in revit.doc._undo] == ["Enfilade: option 1"] and revit.doc._dialogs == []
    assert revit.doc._undo_last() == "Enfilade: option 1" and everything(revit) == before


def test_a_wall_that_another_drags_is_put_back(revit, habits, tmp_path):
    """A wall that meets the partition askew is no part of the option: it stays, whatever Revit does."""
    askew = revit.wall("Askew", (4000, 5000), (5000, 5800))
    revit.insert("Askew door", askew, (4500, 5400), width=300.0)
    made, option = option_of(revit.host(), tmp_path, {("Partition", "x"): 300.0})
    applying.apply(revit.host(), made, option)
    assert [(4000, 5000), (5000, 5800)] == ends(askew)


def test_a_stretched_wall_keeps_what_stands_in_it(revit, habits, tmp_path):
    """The spur begins elsewhere; its door stays."""
    door = revit.insert("Spur door", revit.at["Spur"], (6000, 3000), width=800.0)
    made, option = option_of(revit.host(), tmp_path, {("Partition", "x"): -500.0})
    applying.apply(revit.host(), made, option)
    assert (6000, 3000) == place(door) and [(3500, 3000), (7000, 3000)] == ends(revit.at["Spur"])


def test_a_location_line_may_be_turned_and_stretched(revit, habits):
    host, spur = revit.host(), revit.at["Spur"]
    door = revit.insert("Spur door", spur, (6000, 3000), width=800.0)
    with host.transaction("test"):
        host.set_wall_ends(spur._id, (4000.0, 3000.0), (4000.0 + 2400.0, 3000.0 + 1800.0))
    assert [(4000, 3000), (6400, 4800)] == ends(spur)
    assert (5600, 4200) == place(door), "as far from where it is turned about as before"


def test_the_place_of_a_door_off_the_location_line(revit, tmp_path):
    """Families put their zero point anywhere; it goes with the wall, and nothing is shifted across it."""
    face = revit.wall("Face", (5000, 1000), (7000, 1000), 200.0, offset=100 * MM, marks={"Enfilade Moves": "y -300 300"})
    door = revit.insert("Face door", face, (6000, 1000), width=800.0)
    made, option = option_of(revit.host(), tmp_path, {("Face", "y"): 250.0})
    applying.apply(revit.host(), made, option)
    assert [(5000, 1250), (7000, 1250)] == ends(face) and (6000, 1250) == place(door)


def refused(model, made, option, words):
    before, undo = everything(model), len(model.doc._undo)
    with pytest.raises(PluginError, match=words):
        applying.apply(model.host(), made, option)
    assert everything(model) == before and len(model.doc._undo) == undo and model.doc._dialogs == []
    assert model.doc._transaction is None and model.doc._group is None


def test_an_edited_pinned_or_deleted_wall_is_refused(revit, tmp_path):
    made, option = option_of(revit.host(), tmp_path, MOVES)
    screen = revit.at["Screen"]
    screen._s["pinned"] = True
    refused(revit, made, option, "'Screen .*': it is pinned in Revit")
    screen._s["pinned"], screen._s["group"] = False, elements.Group(revit.doc, "Bathroom")._id
    refused(revit, made, option, "it is in the group 'Bathroom'. Nothing was changed")
    screen._s["group"] = None
    revit.at["Door"]._s["pinned"] = True
    refused(revit, made, option, "'Door .*': it is pinned in Revit")
    revit.at["Door"]._s["pinned"] = False
    kept, screen._s["ends"] = screen._s["ends"], (0.0, 2.5)
    refused(revit, made, option, "'Screen .*' was edited")
    screen._s["ends"] = kept
    del revit.doc._elements[screen._id]
    refused(revit, made, option, "'Screen .*' was deleted")


def test_an_option_that_cuts_walls_is_refused(revit, tmp_path):
    made, option = option_of(revit.host(), tmp_path, MOVES)
    option.works = [Work("open", "An opening of 1.8 m between hall and office", ((4000.0, 2000.0), (4000.0, 3800.0)), 1800.0)]
    words = r"cuts or builds walls \(an opening of 1.8 m .*\).*nothing was changed.*the new drawing file.*candidate-1.dxf"
    refused(revit, made, option, words)
    before = everything(revit)
    with pytest.raises(PluginError, match=words):
        applying.apply_drawing(revit.host(), option)
    assert everything(revit) == before
    option.changes = []
    refused(revit, made, option, words)


@pytest.mark.parametrize("name", ["Partition", "Screen", "Column"])
def test_what_revit_holds_rolls_everything_back(revit, tmp_path, name):
    made, option = option_of(revit.host(), tmp_path, MOVES)
    revit.doc._held = {revit.at[name]._id}
    refused(revit, made, option, f"'{name} .*' does not take its new place: Revit holds it; nothing was changed")


def test_a_door_that_does_not_follow_rolls_everything_back(revit, tmp_path):
    made, option = option_of(revit.host(), tmp_path, MOVES)
    revit.doc._held = {revit.at["Door"]._id}
    refused(revit, made, option, "'Door .*' in 'Partition .*' is not where the option says; nothing was changed")


def test_a_door_that_is_lost_rolls_everything_back(revit, tmp_path, monkeypatch):
    made, option = option_of(revit.host(), tmp_path, MOVES)
    carried = walls.Wall._carried

    def losing(wall, motion, turn):
        carried(wall, motion, turn)
        wall._document._elements.pop(revit.at["Door"]._id, None)

    monkeypatch.setattr(walls.Wall, "_carried", losing)
    refused(revit, made, option, "'Door .*' in 'Partition .*' is not where the option says")


def test_errors_roll_back_without_a_dialog_and_warnings_are_told(revit, tmp_path):
    made, option = option_of(revit.host(), tmp_path, MOVES)
    overlap = (FailureSeverity.Warning, "Highlighted walls overlap.")
    revit.doc._trouble = [overlap, (FailureSeverity.Error, "Can't keep elements joined.")]
    refused(revit, made, option, "Revit refuses the new places: Highlighted walls overlap. Can't keep elements joined.")
    revit.doc._trouble = [overlap]
    host = revit.host()
    applying.apply(host, made, option)
    assert set(host.warnings) == {"Highlighted walls overlap."} and revit.doc._dialogs == []


def test_what_revit_throws_is_a_sentence(revit, tmp_path):
    made, option = option_of(revit.host(), tmp_path, {("Screen", "y"): 200.0})
    host = revit.host()
    before = everything(revit)
    with pytest.raises(PluginError, match="Revit refuses: Pinned elements cannot be moved. Nothing was changed"):
        with host.transaction("test"):
            revit.at["Screen"].Pinned = True
            host.move(revit.at["Screen"]._id, applying.Rigid(0.0, 1.0, 0.0), (0.0, 0.0))
    assert everything(revit) == before
    with host.transaction("open"):
        with pytest.raises(PluginError, match="Starting a new transaction is not permitted"):
            with host.transaction("nested"):
                pass
    assert made and option


def test_an_option_that_moves_nothing(revit, tmp_path):
    made, option = option_of(revit.host(), tmp_path, {})
    refused(revit, made, option, "leaves everything as it is")


def test_walls_are_read_through_the_view_of_the_study(revit, tmp_path):
    """Another view is open, in which nothing of it is shown: nothing counts as deleted."""
    made, option = option_of(revit.host(), tmp_path, MOVES)
    deep = {**revit.plan._s["range"], PlanViewPlane.CutPlane: 9.5}
    other = revit.view("Furniture", hidden=[e._id for e in revit.at.values()], range=deep)
    assert revit.host(other).walls() == []
    revit.plan._s["hidden"] = (revit.at["Screen"]._id,)
    applying.apply(revit.host(other), made, option)
    assert [(4400, 0), (4400, 6000)] == ends(revit.at["Partition"])
    assert revit.host(other).document_id() != revit.host().document_id()


def test_another_model_and_a_view_that_is_gone_are_refused(revit, tmp_path):
    made, option = option_of(revit.host(), tmp_path, MOVES)
    copy, _ = building.house()
    copy.host = lambda: Host(copy.uidoc())
    copy.doc._guid = "99999999-2222-3333-4444-555555555555"
    refused(copy, made, option, "The study is of another model than 'Haus Süd'. Open that model")
    other = revit.view("Other")
    del revit.doc._elements[revit.plan._id]
    before = everything(revit)
    with pytest.raises(PluginError, match="The plan view of the study is gone. Export again"):
        applying.apply(revit.host(other), made, option)
    assert everything(revit) == before


def test_a_curved_wall_moves_as_a_whole(revit, tmp_path):
    marks = {"Enfilade Moves": "x -100 100; rotate -10 10"}
    bow = revit.wall("Bow", arc=((10.0, 5.0), 3.0, 0.2, 1.0), marks=marks)
    made, option = option_of(revit.host(), tmp_path, {("Bow", "x"): 50.0, ("Bow", "rotate"): 5.0})
    before = [p for p in bow._curve().Tessellate()]
    applying.apply(revit.host(), made, option)
    after = [p for p in bow._curve().Tessellate()]
    assert distance(before[0]._p[:2], before[8]._p[:2]) == pytest.approx(distance(after[0]._p[:2], after[8]._p[:2]))
    assert distance(before[4]._p[:2], after[4]._p[:2]) == pytest.approx(50 * MM, rel=0.2)


@pytest.mark.parametrize("is_drawing", [False, True])
def test_what_stands_in_walls_that_stay_stays(revit, tmp_path, monkeypatch, is_drawing):
    """Revit takes the window of a wall along that is to stay; and openings without a place of their own are no trouble."""
    for name in ("Partition", "N"):
        revit.opening("Bull's eye", revit.at[name], (4000, 5500) if name == "Partition" else (7000, 0), 300.0, rectangular=False)
    made, option = option_of(revit.host(), tmp_path, {("Partition", "x"): 300.0})
    carried = walls.Wall._carried

    def dragging(wall, motion, turn):
        carried(wall, motion, turn)
        revit.at["Window"]._s["point"] = (6300 * MM, 0.0)

    monkeypatch.setattr(walls.Wall, "_carried", dragging)
    if is_drawing:
        applying.apply_drawing(revit.host(), drawing_option(revit))
    else:
        applying.apply(revit.host(), made, option)
    assert (6000, 0) == place(revit.at["Window"]) and [(4300, 0), (4300, 6000)] == ends(revit.at["Partition"])


# -- drawings of Revit's own


def drawing_option(revit, dx=0.3):
    id = str(revit.at["Partition"]._id)
    faces = [[[3.95, 0.125], [3.95, 5.875]], [[4.05, 0.125], [4.05, 5.875]]]
    changes = [{"host_id": id, "from": f, "to": [[x + dx, y] for x, y in f]} for f in faces]
    return results.Option(2, "", "", {}, {}, None, True, [], changes)


def test_a_drawing_of_revits_own_is_matched_by_element_id(revit, habits):
    option = drawing_option(revit)
    ring = [[1.8, 2.9], [2.0, 2.9], [2.0, 3.1]]
    option.changes.append(
        {"host_id": str(revit.at["Column"]._id), "from": ring, "to": [[x, y + 0.1] for x, y in ring]}
    )
    option.changes.append({"host_id": "7", "follows": "115", "from": [], "to": []})
    assert [label.split()[0] for label in applying.apply_drawing(revit.host(), option)] == ["Partition", "Column"]
    assert [(4300, 0), (4300, 6000)] == ends(revit.at["Partition"]) and (4300, 1000) == place(revit.at["Door"])
    assert (1900, 3100) == place(revit.at["Column"])
    assert [(4000, 3000), (7000, 3000)] == ends(revit.at["Spur"]), "the drawing says nothing of it"
    assert [name for name, _ in revit.doc._undo] == ["Enfilade: option 2"]


def test_drawings_that_do_not_fit_the_model_are_refused(revit):
    before = everything(revit)

    def refuses(option, words):
        with pytest.raises(PluginError, match=words + ".*nothing was changed"):
            applying.apply_drawing(revit.host(), option)
        assert everything(revit) == before

    option = drawing_option(revit)
    option.changes[1]["to"] = option.changes[1]["from"]
    refuses(option, "does not keep its shape")
    option = drawing_option(revit)
    option.changes[1]["host_id"] = None
    refuses(option, "without Revit's id")
    option = drawing_option(revit)
    option.changes[1]["host_id"] = "99999"
    refuses(option, "Not in the plan of this view: 99999")
    option = drawing_option(revit)
    for change in option.changes:
        change["from"] = [[x + 100.0, y] for x, y in change["from"]]
        change["to"] = [[x + 100.0, y] for x, y in change["to"]]
    refuses(option, "stands elsewhere in the drawing")


def test_a_drawing_that_moves_what_is_fixed_is_refused(revit):
    revit.at["Partition"]._s["pinned"] = True
    before = everything(revit)
    with pytest.raises(PluginError, match="'Partition .*': it is pinned in Revit. Nothing was changed"):
        applying.apply_drawing(revit.host(), drawing_option(revit))
    assert everything(revit) == before


def test_a_curved_wall_of_a_drawing(revit):
    bow = revit.wall("Bow", arc=((10.0, 5.0), 3.0, 0.2, 1.0))
    points = [[v / MM / 1000 for v in p._p[:2]] for p in bow._curve().Tessellate()[::4]]
    change = {"host_id": str(bow._id), "from": points, "to": [[x + 0.1, y] for x, y in points]}
    applying.apply_drawing(revit.host(), results.Option(3, "", "", {}, {}, None, True, [], [change]))
    assert bow._s["arc"][0] == pytest.approx((10.0 + 100 * MM, 5.0))


def test_generic_models_in_a_wall_go_along_too(revit, tmp_path):
    niche = revit.insert("Niche", revit.at["Partition"], (4000, 5000), BuiltInCategory.OST_GenericModel, 500.0)
    made, option = option_of(revit.host(), tmp_path, {("Partition", "x"): 400.0})
    applying.apply(revit.host(), made, option)
    assert (4400, 5000) == place(niche)
