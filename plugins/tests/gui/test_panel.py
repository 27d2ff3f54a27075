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
    window.wait_for("rows", lambda rows: list(rows) == ["along", "widen", "close", "rehang"], 100)
    window.press("EnfiladeAllow")
    assert status(window) == "Tick what may be done with it, name its group, or tick that it must stay."
    window.ask("select_all", ["P", "Tür"])
    window.ask("tick", "x")
    window.press("EnfiladeAllow")
    assert status(window) == "Marked: P. What is ticked is not possible with 'Tür'."
    assert list(window.ask("marks")) == ["P"]
    window.press("EnfiladeUnmark")


def test_02_nothing_marked_nothing_moves(window):
    """What is built is offered all the same."""
    run_study(window)
    panel = window.ask("panel")
    said = "Nothing may move: no wall, column, door or window is marked. The options build."
    assert panel["status"] == said and panel["options"] > 0, panel


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


def test_04b_marks_of_other_storeys_are_listed(window):
    window.ask("house", "Haus")
    window.ask("level", "EG", ["S", "E", "N", "W", "P"])
    window.ask("level", "OG", ["Q"])
    window.click(window.ask("tab", 0))
    window.ask("choose_storey", window.ask("storeys_offered").index("EG"))
    window.ask("select", "Q")
    window.ask("tick", "x")
    window.press("EnfiladeAllow")
    assert "'Q' on another storey: the panel works on 'EG'. Nothing was done" in status(window)
    assert window.ask("marks") == {}
    window.ask("choose_storey", window.ask("storeys_offered").index("OG"))
    window.wait_for("panel", lambda p: p["storey"] == "OG", 100)
    window.press("EnfiladeAllow")
    assert status(window) == "Marked: Q"
    window.ask("choose_storey", window.ask("storeys_offered").index("EG"))
    window.ask("select", "P")
    window.ask("tick", "x")
    window.press("EnfiladeAllow")
    assert window.ask("text", "EnfiladeListed") == "Marked here: P\nOn other storeys, not studied here: 'Q' (OG)"
    window.shot("16-storeys")
    run_study(window)
    assert sorted(window.ask("job_walls")) == ["E", "N", "P", "S", "W"]
    assert "Marked on other storeys and not part of this study: 'Q' (OG)." in window.ask("text", "EnfiladeWarnings")


def test_04c_what_cannot_be_marked_is_named(window):
    window.ask("house", "Haus")
    window.wait_for("panel", lambda p: p["document"] == "Haus" and p["storey"] is None, 100)
    window.click(window.ask("tab", 0))
    label = window.ask("draft_line")
    window.ask("select", label)
    window.ask("tick", "x")
    window.press("EnfiladeAllow")
    said = status(window)
    assert said.startswith(f"'{label}': no wall, column, door or window, so it cannot move. A closed line can be a region")


def test_05_two_documents_are_never_mixed(window):
    _, first = window.ask("house", "Vorn")
    window.wait_for("panel", lambda p: p["document"] == first, 100)
    _, second = window.ask("house", "Hinten", True)
    window.wait_for("panel", lambda p: p["front"] == second, 100)
    window.wait_for("panel", lambda _: window.ask("text", "EnfiladeSwitch") == f"Switch to '{second}'", 100)
    assert window.ask("panel")["document"] == first, "the panel stays with its document"

    # Marked there, run from the other page, whatever view is in front by then.
    window.click(window.ask("view_tab", first))
    window.click(window.ask("tab", 0))
    window.ask("activate", first)
    window.click(window.ask("point", 4000, 4000))
    window.ask("tick", "x")
    window.press("EnfiladeAllow")
    assert status(window) == "Marked: P", status(window)
    window.click(window.ask("tab", 1))
    window.click(window.ask("view_tab", second))
    window.ask("set", "EnfiladeEvaluations", 150)
    window.ask("forget_status")
    window.press("EnfiladeRun")
    panel = window.wait_for("panel", lambda p: p["running"] or p["options"], 200)
    assert f"'{first}'" in panel["status"] and panel["front"] == first, panel
    panel = window.wait_for("panel", lambda p: not p["running"], 90)
    assert panel["options"] >= 1 and panel["document"] == first, panel
    window.shot("17-two-documents")

    # What is selected in the other document is not marked.
    window.click(window.ask("view_tab", second))
    window.ask("activate", second)
    window.ask("clear_selection")
    window.click(window.ask("point", 6000, 2000))
    window.click(window.ask("tab", 0))
    window.press("EnfiladeAllow")
    assert status(window).startswith(f"'Q' is in the document '{second}', but the panel works on '{first}'. Nothing was done")
    window.ask("activate", second)
    assert window.ask("marks") == {}
    window.wait_for("panel", lambda _: window.ask("text", "EnfiladeSwitch"), 100)
    window.shot("18-refused-document")

    # The offer is taken.
    window.press("EnfiladeSwitch")
    panel = window.wait_for("panel", lambda p: p["document"] == second, 100)
    assert panel["options"] == 0 and panel["front"] == second
    window.ask("tick", "x")
    window.press("EnfiladeAllow")
    assert status(window) == "Marked: Q", status(window)
    run_study(window)
    panel = window.ask("panel")
    assert panel["options"] >= 1 and panel["document"] == second, panel
    assert panel["status"].startswith(f"Done: {panel['options']} option")


def test_05b_accept_in_a_document_behind(window):
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
    window.wait_for("panel", lambda _: window.ask("text", "EnfiladeSwitch"), 100)
    window.press("EnfiladeSwitch")
    window.ask("run_command", "Enfilade_Look")
    panel = window.ask("panel")
    assert "There is no study of this document yet" in panel["status"] and panel["options"] == 0
    window.ask("close", other)
    window.wait_for("panel", lambda p: p["document"] == label, 100)


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
    window.wait_for("panel", lambda p: p["running"], 200)
    window.ask("run_command", "Enfilade_Export")
    assert status(window) == "A study is running; stop it first."
    window.press("EnfiladeStop")
    window.wait_for("panel", lambda p: not p["running"], 600)
