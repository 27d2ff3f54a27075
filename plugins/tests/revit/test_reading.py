"""What of a Revit view becomes a study, and what is said of the rest."""

import os

import pytest
from enfilade_common.model import PluginError, Wishes
from enfilade_revit import reading, work
from enfilade_revit.host import Host
from fake import building, elements
from fake.building import Model, square
from fake.failures import BuiltInCategory, PlanViewPlane, ViewType, WallKind


def studied(model, view=None):
    return reading.study(Host(model.uidoc(view)), Wishes())


def ids(study):
    return {int(e.id) for e in study.movables()}


def near(points, expected):
    return [tuple(round(v, 6) for v in p) for p in points] == expected


def test_the_view_becomes_a_study(revit):
    revit.lines("EF-QUERY", square())
    revit.lines("ef-keep", square(3000.0))
    revit.lines("Thin Lines", square(9000.0))
    study, notes = studied(revit)
    assert notes == [] and len(study.walls) == 7 and study.storey == "Level 1"
    assert [(r.kind, len(r.points)) for r in study.regions] == [("query", 4), ("keep", 4)]
    partition = study.element(str(revit.at["Partition"]._id))
    assert [c.text() for c in partition.clauses] == ["x -1000 1000"]
    assert [(round(o.start), round(o.end), o.clauses[0].lower) for o in partition.openings] == [(550, 1450, -300)]
    window = study.element(str(revit.at["N"]._id)).openings[0]
    assert (round(window.start), round(window.end), window.kind) == (5400, 6600, "window")
    assert near(study.columns[0].ring, [(1800, 3100), (2000, 3100), (2000, 2900), (1800, 2900)]), "above its foot"


def test_line_styles_name_pairs(revit):
    for style, x in (("EF-QUERY-Entrance", 0.0), ("EF-REFERENCE-entrance", 3000.0), ("EF-QUERY-a/b", 9000.0)):
        revit.lines(style, square(x))
    study, notes = studied(revit)
    assert [(r.kind, r.pair) for r in study.regions] == [("query", "entrance"), ("reference", "entrance")]
    assert len(notes) == 1 and "cannot name a pair" in notes[0]


def test_lines_of_another_view_and_open_ones_are_no_regions(revit):
    revit.lines("EF-QUERY", square(), view=revit.view("Another plan"))
    revit.lines("EF-KEEP", square())
    lines = [e for e in revit.doc._elements.values() if isinstance(e, elements.DetailLine)]
    del revit.doc._elements[next(e._id for e in lines if e._s["view"] == revit.plan._id)]
    elements.DetailLine(revit.doc, "Lines", ends=((0, 0), (1, 1)), style=None, view=revit.plan._id)
    elements.Instance(revit.doc, "Filled region", kind=BuiltInCategory.OST_Lines)
    study, notes = studied(revit)
    assert study.regions == [] and notes == ["Detail lines on EF-KEEP do not close; they were left out."]


def test_marks_that_cannot_be_read_are_told():
    notes = []
    assert reading.clauses("x 5 9; up 1 2; rotate -5 5; along -1ft 1ft", 90.0, "W", notes)[1].direction_deg == 90.0
    assert reading.clauses("along 30 -1 1; name Screen; x 1 abc", 0.0, "W", notes)[0].direction_deg == 30.0
    assert reading.clauses("x -1 1 2", 0.0, "W", notes) == []
    assert [n.split("'")[3] for n in notes] == ["x 5 9", "up 1 2", "x 1 abc", "x -1 1 2"]
    assert reading.length_mm("-1.5m") == -1500 and reading.length_mm("2ft") == pytest.approx(609.6)


def test_building_works_stand_beside_the_moves():
    notes = []
    text = "x -1 1; open 900 2.4m; REMOVE; end -1m 0; glaze wide; close 1 2 3"
    assert [w.text() for w in reading.works(text, "W", notes)] == ["open 900mm 2400mm", "remove", "end -1000mm 0"]
    assert [c.kind for c in reading.clauses(text, 0.0, "W", notes)] == ["x"]
    assert notes == [
        "'W': 'glaze wide' is no building work; expected for example 'open 900 2400; remove'.",
        "'W': 'close 1 2 3' is no building work; expected for example 'open 900 2400; remove'.",
    ]


def test_building_works_of_walls_and_doors(revit, window):
    for name, text in (("Spur", "open 900 2400"), ("Door", "along -300 2000; widen; remove"), ("Window", "close")):
        revit.at[name]._s["params"]["Enfilade Moves"] = text
    study, notes = studied(revit)
    assert notes == [] and study.rebuilt()
    assert [w.text() for w in study.element(str(revit.at["Spur"]._id)).works] == ["open 900mm 2400mm"]
    door = study.element(str(revit.at["Partition"]._id)).openings[0]
    assert [w.kind for w in door.works] == ["widen"] and len(door.clauses) == 1, "a door is not removed like a wall"
    assert study.element(str(revit.at["N"]._id)).openings[0].works == []
    said = window()
    work.describe_marks(revit.host(), said)
    assert "may be rebuilt: open 900mm 2400mm" in said.said[0]


def test_the_location_line_may_lie_on_a_face(revit):
    face = revit.wall("Face", (1000, 1000), (3000, 1000), 200.0, offset=100.0 * building.MM)
    study, _ = studied(revit)
    wall = study.element(str(face._id))
    assert (round(wall.left, 6), round(wall.right, 6)) == (200.0, 0.0)


def test_yes_and_no_are_read_in_every_language(revit):
    for value in (True, False):
        revit.at["Screen"]._s["params"]["Enfilade Keep"] = value
        study, _ = studied(revit)
        assert study.element(str(revit.at["Screen"]._id)).keep is value


def test_only_a_floor_plan_is_read(revit):
    for kind, view_type in ((elements.View3D, ViewType.ThreeD), (elements.ViewPlan, ViewType.CeilingPlan)):
        view = revit.view("Other", kind, view_type)
        with pytest.raises(PluginError, match="'Other' is no floor plan. Open the floor plan of one storey"):
            revit.host(view)
    assert studied(revit, revit.view("Structure", view_type=ViewType.EngineeringPlan))
    with pytest.raises(PluginError, match="Open a project first"):
        Host(None)
    revit.doc._is_family = True
    with pytest.raises(PluginError, match="Open a project first"):
        revit.host()


def test_walls_that_the_cut_plane_does_not_meet_are_left_out(revit):
    low = revit.wall("Low", (500, 500), (900, 500), height=3.5)
    high = revit.wall("High", (500, 700), (900, 700), z=building.LEVEL_FT + 5.0)
    below = revit.wall("Cellar", (500, 900), (900, 900), z=building.LEVEL_FT - 10.0, height=9.5)
    study, notes = studied(revit)
    assert not ids(study) & {low._id, high._id, below._id}
    assert notes == [
        f"Left out (below the cut plane of this view): 'Low {low._id}', 'Cellar {below._id}'.",
        f"Left out (above the cut plane of this view): 'High {high._id}'.",
    ]
    deep = revit.view("Deep", range={**revit.plan._s["range"], PlanViewPlane.CutPlane: 3.0})
    study, _ = studied(revit, deep)
    assert low._id in ids(study), "the view says where it is cut"


def test_what_does_not_stand_in_the_phase_is_left_out(revit):
    old, new = (p for p in range(2))
    gone = revit.wall("Gone", (500, 500), (900, 500), created=old, demolished=new)
    passing = revit.wall("Hoarding", (500, 700), (900, 700), created=new, demolished=new)
    kept = revit.wall("Old", (500, 900), (900, 900), created=old)
    revit.insert("Old door", revit.at["S"], (2000, 6000), created=old, demolished=new)
    study, notes = studied(revit)
    assert not ids(study) & {gone._id, passing._id} and kept._id in ids(study)
    assert notes[0] == f"Left out (not standing in the phase of this view): 'Gone {gone._id}', 'Hoarding {passing._id}'."
    assert notes[1].startswith("Taken as closed (not standing in the phase of this view): 'Old door")


def test_design_options(revit):
    primary = elements.DesignOption(revit.doc, "Open plan", primary=True)
    other = elements.DesignOption(revit.doc, "Cells", primary=False)
    mine = {"Enfilade Moves": "x -100 100"}
    first = revit.wall("First", (500, 500), (900, 500), option=primary._id, marks=mine)
    second = revit.wall("Second", (500, 700), (900, 700), option=other._id, marks=mine)
    revit.plan._s["options"] = (other._id,)
    study, notes = studied(revit)
    assert first._id in ids(study) and second._id not in ids(study)
    assert study.element(str(first._id)).locked == "it is in the design option 'Open plan', which is not being edited"
    assert f"Left out (in a design option that is neither primary nor being edited): 'Second {second._id}'." in notes
    revit.doc._active_option = other._id
    study, _ = studied(revit)
    assert study.element(str(second._id)).locked == "", "what is being edited may move"


def test_what_is_pinned_or_in_a_group_stays(revit):
    group = elements.Group(revit.doc, "Bathroom")
    revit.at["Screen"]._s["group"] = group._id
    revit.at["Column"]._s["pinned"] = revit.at["Door"]._s["pinned"] = True
    study, notes = studied(revit)
    locked = {e.label.split()[0]: e.locked for e in study.movables() if e.locked}
    assert locked == {"Screen": "it is in the group 'Bathroom'", "Column": "it is pinned in Revit"}
    assert notes == [f"'Door {revit.at['Door']._id}' is marked to move but stays: it is pinned in Revit."]
    assert all(not o.clauses for w in study.walls for o in w.openings)


def test_curtain_walls_links_and_families_in_place_are_left_out(revit):
    glass = revit.wall("Storefront", (500, 500), (900, 500), kind=WallKind.Curtain)
    elements.RevitLinkInstance(revit.doc, "Engineers.rvt")
    lump = revit.column("Lump", (700, 700), kind=BuiltInCategory.OST_Walls)
    ghost = revit.wall("Ghost", (500, 900), (900, 900), z=None)
    revit.column("Low post", (700, 900), height=3.0)
    _, notes = studied(revit)
    assert notes == [
        f"Left out (curtain wall): 'Storefront {glass._id}'.",
        f"Left out (built in place): 'Lump {lump._id}'.",
        f"Left out (without a body): 'Ghost {ghost._id}'.",
        f"Left out (below the cut plane of this view): 'Low post {ghost._id + 1}'.",
        "Left out (linked model): 'Engineers.rvt'.",
    ]


def test_many_that_are_left_out_make_one_sentence(revit):
    walls = [revit.wall("Low", (500, 500 + i), (900, 500 + i), height=3.0) for i in range(8)]
    _, notes = studied(revit)
    assert notes == [
        "Left out (below the cut plane of this view): " + ", ".join(f"'Low {w._id}'" for w in walls[:5]) + " and 3 more."
    ]


def test_a_stacked_wall_is_its_parts(revit):
    whole = revit.wall("Stacked", (500, 500), (900, 500), kind=WallKind.Stacked)
    low, cut = (
        revit.wall(name, (500, 500), (900, 500), member_of=whole._id, z=building.LEVEL_FT + z, height=h)
        for name, z, h in (("Base", 0.0, 3.0), ("Upper", 3.0, 7.0))
    )
    study, _ = studied(revit)
    assert ids(study) & {whole._id, low._id, cut._id} == {cut._id}
    assert study.element(str(cut._id)).locked == "it is part of a stacked wall"


def test_openings_come_from_the_wall_not_from_what_the_view_shows(revit):
    revit.plan._s["hidden"] = (revit.at["Door"]._id, revit.at["Window"]._id)
    study, _ = studied(revit)
    assert [o.label.split()[0] for w in study.walls for o in w.openings] == ["Window", "Door"]


def test_all_that_opens_a_wall(revit):
    south = revit.at["S"]
    far_door = revit.at["Door"]._id
    passage = revit.opening("Passage", south, (1000, 6000), 800.0)
    hatch = revit.opening("Hatch", south, (2500, 6000), 600.0, sill=3.0)
    round_ = revit.opening("Bull's eye", south, (3500, 6000), 600.0, rectangular=False)
    void = revit.insert("Void", south, (4500, 6000), BuiltInCategory.OST_GenericModel, 500.0)
    edge = revit.insert("Edge", south, (4800, 6000), width=100.0, is_placed_by_line=True)
    revit.insert("Shadow", south, (4900, 6000), width=100.0, shadow=True)
    revit.insert("Leaf of a door", south, (4900, 6000), width=100.0, part_of=far_door)
    thin = revit.insert("No width", south, (5200, 6000), type=revit.plain_type._id)
    clerestory = revit.insert("Clerestory", south, (6000, 6000), BuiltInCategory.OST_Windows, 700.0, sill=6.0)
    far = revit.insert("Beyond", south, (7900, 6000), width=900.0)
    glass = revit.wall("Glass", (6500, 6000), (7300, 6000), kind=WallKind.Curtain, host=south._id, point=(0.0, 0.0))
    study, notes = studied(revit)
    found = {o.label.split()[0]: (round(8000 - o.end), round(8000 - o.start), o.kind) for o in study.element(str(south._id)).openings}
    assert found == {"Passage": (600, 1400, "door"), "Hatch": (2200, 2800, "window"), "Glass": (6500, 7300, "window")}
    assert glass._id not in ids(study) and passage._id and hatch._id
    assert notes == [
        f"Taken as closed (neither rectangle nor door nor window): 'Bull's eye {round_._id}', 'Edge {edge._id}'.",
        f"Taken as closed (no door or window): 'Void {void._id}'.",
        f"Taken as closed (without a width): 'No width {thin._id}'.",
        f"Taken as closed (above the cut plane of this view): 'Clerestory {clerestory._id}'.",
        f"Taken as closed (reaches beyond 'S {south._id}'): 'Beyond {far._id}'.",
    ]


def test_a_curved_wall_is_its_outline(revit):
    bow = revit.wall("Bow", arc=((3.0, 10.0), 5.0, 0.2, 1.0), marks={"Enfilade Moves": "x -100 100"})
    revit.insert("Round door", bow, (1000, 1000), width=800.0)
    study, notes = studied(revit)
    wall = study.element(str(bow._id))
    assert len(wall.rings) == 1 and len(wall.rings[0]) == 18 and notes == [] and wall.openings == []
    radii = [((x * building.MM - 3.0) ** 2 + (y * building.MM - 10.0) ** 2) ** 0.5 for x, y in wall.rings[0]]
    assert min(radii) == pytest.approx(4.75) and max(radii) == pytest.approx(5.25)


def test_a_hollow_column_is_its_outer_outline_and_one_without_a_body_is_left_out(revit):
    pipe = revit.column("Pipe", (700, 700), side=300.0, hole=200.0)
    nothing = revit.column("Nothing", (900, 900), ring=[], foot=[])
    nothing.get_Geometry = lambda options: None
    study, notes = studied(revit)
    xs = [x for x, _ in study.element(str(pipe._id)).ring]
    assert (round(min(xs)), round(max(xs))) == (550, 850)
    assert notes == [f"Left out (without an outline): 'Nothing {nothing._id}'."]


def test_a_wall_without_an_outline(revit):
    bow = revit.wall("Bow", arc=((3.0, 10.0), 5.0, 0.2, 1.0))
    flat = revit.wall("Flat", (500, 500), (900, 500))
    bow.get_Geometry = flat.get_Geometry = lambda options: None
    study, notes = studied(revit)
    assert notes == [f"Left out (neither a straight location line nor an outline): 'Bow {bow._id}'."]
    assert round(study.element(str(flat._id)).left, 6) == 50.0


def test_a_view_without_walls(tmp_path):
    with pytest.raises(PluginError, match="The view shows no wall of the plan"):
        studied(Model())


def test_where_the_document_is(revit, tmp_path):
    host = revit.host()
    assert host.document_folder() == str(tmp_path) and host.document_name() == "Haus Süd"
    for path in (os.path.join(str(tmp_path), "gone", "a.rvt"), ""):
        assert Host(Model(path=path).uidoc()).document_folder() == ""
