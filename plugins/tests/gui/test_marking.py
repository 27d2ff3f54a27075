"""Page 1 with building works: it names what may be done with what is selected, and shows the marks of that alone."""

import json
import os

MOVES = {"x", "y", "along", "rotate"}
OF_OPENINGS = {"widen", "close", "rehang"}


def status(window):
    return window.ask("panel")["status"]


def select(window, *labels):
    window.ask("select_all", labels)
    window.wait_for("panel", lambda _: window.ask("text", "EnfiladeSelected").endswith(", ".join(labels)), 100)


def ticked(window):
    return {kind: row[1:] for kind, row in window.ask("rows").items() if row[0] == 2}


def test_01_what_may_be_done_is_named(window):
    window.ask("furnished", "Haus")
    window.wait_for("panel", lambda p: p["document"] == "Haus", 100)
    window.click(window.ask("tab", 0))
    window.ask("clear_selection")
    assert window.wait_for("rows", lambda rows: set(rows) == MOVES, 100), "nothing is selected"
    select(window, "P")
    assert set(window.ask("rows")) == MOVES | OF_OPENINGS | {"open", "door", "glaze", "end", "remove", "add"}
    assert window.ask("text", "EnfiladeCan") == (
        "P can: move, turn, get an opening, get a door, get glass, get wider doors and openings, "
        "have doors and openings walled up, have doors hung elsewhere in it, end earlier, be removed, "
        "get a new wall across the room."
    )
    window.shot("30-wall-offered")
    select(window, "Q")
    assert set(window.ask("rows")) == MOVES | {"open", "door", "glaze", "end", "remove", "add"}, "no door stands in it"
    select(window, "Tür")
    assert set(window.ask("rows")) == {"along"} | OF_OPENINGS
    select(window, "N")
    assert set(window.ask("rows")) == MOVES | {"add"}
    assert "N: outdoors on one side, so nothing is opened or walled up." in window.ask("text", "EnfiladeCan")
    select(window, "P", "Tür", "Haustür", "Fenster 1")
    said = window.ask("text", "EnfiladeCan").split("\n")
    assert said[0].startswith("P can: move") and said[1:] == [
        "Tür can: slide along the wall, become wider, be walled up, be hung elsewhere in its wall.",
        "Haustür, Fenster 1 can: slide along the wall.",
        "Haustür: outdoors on one side, so nothing is opened or walled up.",
        "Fenster 1: windows are not rebuilt.",
    ]
    window.shot("31-several-offered")


def test_02_ticks_of_the_last_selection_do_not_stay(window):
    select(window, "P")
    for name in ("EnfiladeAllow_x", "EnfiladeWork_open", "EnfiladeWork_remove"):
        window.press(name)
    window.ask("set", "EnfiladeGroup", "left over")
    assert ticked(window) == {"x": [-500, 500], "open": [900, 2400], "remove": []}
    select(window, "Q")
    assert ticked(window) == {} and window.ask("text", "EnfiladeGroup") == ""
    select(window, "P")
    assert ticked(window) == {}, "it was not allowed"
    window.press("EnfiladeAllow")
    assert status(window) == "Tick what may be done with it, name its group, or tick that it must stay."
    assert window.ask("marks") == {}


def test_03_works_are_marked_edited_and_taken_away(window):
    undo = window.ask("document")["undo"]
    for name in ("EnfiladeWork_open", "EnfiladeWork_remove"):
        window.press(name)
    window.ask("set", "EnfiladeBound_open_1", 1200)
    window.press("EnfiladeAllow")
    assert status(window) == "Marked: P" and window.ask("allowed") == {"P": "open 1200mm 2400mm; remove"}
    assert window.ask("document")["undo"] == undo + 1
    select(window, "Tür")
    for name in ("EnfiladeWork_widen", "EnfiladeWork_rehang"):
        window.press(name)
    window.press("EnfiladeAllow")
    assert window.ask("allowed")["Tür"] == "widen 1200mm 2400mm; rehang"

    # Read back from the document, and edited.
    select(window, "P")
    assert ticked(window) == {"open": [1200, 2400], "remove": []}
    window.shot("32-works-marked")
    window.press("EnfiladeWork_remove")
    window.press("EnfiladeWork_glaze")
    window.press("EnfiladeAllow")
    assert window.ask("allowed")["P"] == "open 1200mm 2400mm; glaze 1200mm 2400mm"
    window.ask("undo")
    window.wait_for("rows", lambda rows: rows["remove"][0] == 2 and rows["glaze"][0] == 0, 100)
    assert window.ask("allowed")["P"] == "open 1200mm 2400mm; remove"

    # Of several, half a tick leaves each as it was.
    select(window, "P", "Q")
    assert window.ask("rows")["open"] == [1, 1200, 2400]
    window.press("EnfiladeWork_end")
    window.press("EnfiladeAllow")
    assert window.ask("allowed")["P"] == "open 1200mm 2400mm; end -1000mm 0; remove", status(window)
    assert window.ask("allowed")["Q"] == "end -1000mm 0"

    # All ticks away, all marks away.
    select(window, "Q")
    window.press("EnfiladeWork_end")
    window.press("EnfiladeAllow")
    assert status(window) == "Marks removed: Q" and "Q" not in window.ask("allowed")


def test_04_marks_are_saved_and_read_again(window):
    path = os.path.join(window.folder, "Haus.FCStd")
    window.ask("save_and_reload", path)
    marked = {"P": "open 1200mm 2400mm; end -1000mm 0; remove", "Tür": "widen 1200mm 2400mm; rehang"}
    assert window.ask("allowed") == marked
    window.wait_for("panel", lambda p: p["document"] == "Haus", 100)
    select(window, "Tür")
    assert ticked(window) == {"widen": [1200, 2400], "rehang": []}
    assert window.ask("panel")["overlay"]["marks"], "what may be rebuilt is shown in the view"


def test_05_options_build_what_is_marked(window):
    window.click(window.ask("tab", 1))
    window.ask("set", "EnfiladeEvaluations", 150)
    window.ask("set", "EnfiladeMembers", 3)
    window.ask("forget_status")
    window.press("EnfiladeRun")
    panel = window.wait_for("panel", lambda p: p["status"] and not p["running"] and "Starting" not in p["status"], 120)
    assert panel["status"].startswith("Done: ") and panel["options"] >= 1, panel
    with open(os.path.join(panel["round"], "result.json")) as f:
        works = [w for c in json.load(f)["candidates"] for w in c["works"]]
    assert works and {w["kind"] for w in works} <= {"open", "end", "remove", "widen", "rehang"}, works
    window.shot("33-marked-works-built")
    before, undo = window.ask("state"), window.ask("document")["undo"]
    window.click(window.ask("item", 1))
    window.press("EnfiladeAccept")
    window.wait_for("panel", lambda p: p["status"].startswith("Accepted "), 200)
    assert window.ask("state") != before and window.ask("document")["undo"] == undo + 1


def test_06_lines_of_a_plan(window):
    window.ask("plan", "Skizze")
    window.wait_for("panel", lambda p: p["document"] == "Skizze", 100)
    window.click(window.ask("tab", 0))
    places = [(x, y) for y in (475, 3675) for x in (3850, 4150)] + [(4000, 700), (4000, 1600)]
    lines = window.ask("labels_at", places)
    window.ask("select_all", lines)
    window.wait_for("rows", lambda rows: "open" in rows, 100)
    window.press("EnfiladeWork_open")
    window.press("EnfiladeAllow")
    assert window.ask("allowed") == {label: "open 900mm 2400mm" for label in lines}, status(window)
    assert window.ask("document")["undo"] == 1
    window.shot("34-lines-works")
    window.click(window.ask("tab", 1))
    window.ask("forget_status")
    window.press("EnfiladeRun")
    panel = window.wait_for("panel", lambda p: p["status"] and not p["running"] and "Starting" not in p["status"], 120)
    assert panel["options"] >= 1, panel
    with open(os.path.join(panel["round"], "result.json")) as f:
        kinds = {w["kind"] for c in json.load(f)["candidates"] for w in c["works"]}
    assert kinds == {"open"}
