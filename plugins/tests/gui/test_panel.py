"""What the panel says and does where things are not as in the book, in FreeCAD's own window."""

import os


def status(window):
    return window.ask("panel")["status"]


def run_study(window, evaluations=150, members=2):
    window.click(window.ask("tab", 1))
    window.ask("set", "EnfiladeEvaluations", evaluations)
    window.ask("set", "EnfiladeMembers", members)
    window.ask("forget_status")
    window.press("EnfiladeRun")
    window.wait_for("panel", lambda p: p["status"] and not p["running"] and "Starting" not in p["status"], 90)


def test_01_a_door_is_not_marked_where_it_cannot_move(window):
    window.ask("house", "Haus")
    window.click(window.ask("tab", 0))
    window.ask("select", "Tür")
    window.ask("tick", "x")
    window.press("EnfiladeAllow")
    assert status(window) == "Doors and windows only slide along the wall; 'Tür' was not marked."
    assert window.ask("marks") == {}
    window.ask("tick", "x", False)


def test_02_nothing_marked_nothing_moves(window):
    run_study(window)
    panel = window.ask("panel")
    assert panel["status"].startswith("Nothing may move: no wall, column, door or window is marked."), panel
    assert panel["options"] == 0


def test_03_a_region_loses_its_mark(window):
    window.click(window.ask("tab", 0))
    label = window.ask("draw_rectangle", 200, 200, 3000, 3000)
    window.ask("select", label)
    window.press("EnfiladeRegion_query")
    assert window.ask("regions") == ["query"], status(window)
    window.press("EnfiladeUnmark")
    assert window.ask("regions") == [] and status(window) == f"Marks removed: {label}"
    window.ask("remove", [label])


def test_04_storeys_drawn_later_are_offered(window):
    window.click(window.ask("tab", 1))
    assert window.ask("storeys_offered") == [""] or len(window.ask("storeys_offered")) < 2
    window.ask("level", "EG", ["P"])
    window.click(window.ask("tab", 0))
    window.click(window.ask("tab", 1))
    assert sorted(window.ask("storeys_offered")) == ["EG", "outside any level"]
    outside = window.ask("storeys_offered").index("outside any level")
    assert window.ask("choose_storey", outside) == ""
    run_study(window)
    assert sorted(window.ask("job_walls")) == ["E", "N", "Q", "S", "W"], "the walls outside any level were studied"
    window.ask("remove", ["EG"])


def test_05_accept_in_a_document_behind(window):
    house, label = window.ask("house", "Vorn")
    window.click(window.ask("tab", 0))
    window.ask("select", "P")
    window.ask("tick", "x")
    window.press("EnfiladeAllow")
    assert status(window) == "Marked: P"
    run_study(window)
    # One wall along one way: more layouts may be the same idea.
    assert window.ask("panel")["options"] >= 1, status(window)
    undo = window.ask("undo_of", house)
    other = window.ask("new_document", "Leer")
    window.ask("accept_behind", other)
    said = window.wait_for("panel", lambda p: "Accepted" in p["status"], 20)["status"]
    assert f"This was in the document '{label}', which is not the one in front." in said
    assert window.ask("undo_of", house) == undo + 1 and window.ask("undo_of", other) == 0
    window.ask("activate", other)
    window.ask("run_command", "Enfilade_Look")
    panel = window.ask("panel")
    assert "There is no study of this document yet" in panel["status"] and panel["options"] == 0
    window.ask("close", other)


def test_06_look_shows_the_newest_round(window):
    window.ask("run_command", "Enfilade_Look")
    assert os.path.basename(window.ask("panel")["round"]) == "round-01"
    assert window.ask("run_outside") in (0, 1)
    window.ask("run_command", "Enfilade_Look")
    assert os.path.basename(window.ask("panel")["round"]) == "round-02"


def test_07_nothing_is_exported_during_a_run(window):
    window.click(window.ask("tab", 1))
    window.ask("set", "EnfiladeEvaluations", 5_000_000)
    window.press("EnfiladeRun")
    window.wait_for("panel", lambda p: p["running"], 20)
    window.ask("run_command", "Enfilade_Export")
    assert status(window) == "A study is running; stop it first."
    window.press("EnfiladeStop")
    window.wait_for("panel", lambda p: not p["running"], 20)
