"""A house, a plan of Draft lines and an imported DXF with real clicks: mark, run, stop, look, accept, undo, again."""

import json
import os
import shutil

import pytest
from conftest import ROOT

ROOMS = os.path.join(ROOT, "..", "shared", "data", "dxf", "roomsize_two_rooms.dxf")


def status(window):
    return window.ask("panel")["status"]


def press_run(window, evaluations=300, members=2):
    window.click(window.ask("tab", 1))
    window.ask("set", "EnfiladeEvaluations", evaluations)
    window.ask("set", "EnfiladeMembers", members)
    window.ask("forget_status")
    window.press("EnfiladeRun")
    window.wait_for("panel", lambda p: p["running"] or "Starting" not in p["status"] and p["status"], 200)


def run_study(window, *sizes):
    press_run(window, *sizes)
    return window.wait_for("panel", lambda p: p["status"] and not p["running"] and "Starting" not in p["status"], 120)


def tick_only(window, kind):
    for other in {"x", "y", "along", "rotate"} & set(window.ask("rows")):
        if window.ask("checked", "EnfiladeAllow_" + other) != (other == kind):
            window.press("EnfiladeAllow_" + other)


def take(window, row, question):
    """Looks at a layout, accepts it, takes it back with one undo, accepts it again."""
    before = window.ask(question)
    undo = window.ask("document")["undo"]
    window.click(window.ask("item", row))
    window.press("EnfiladeAccept")
    window.wait_for("panel", lambda p: p["status"].startswith("Accepted "), 200)
    after = window.ask(question)
    assert after != before and window.ask("document")["undo"] == undo + 1
    window.click(window.ask("empty"))
    window.key("ctrl+z")
    window.ask("recompute")
    assert window.ask(question) == before, "one undo takes all of it back"
    window.click(window.ask("item", row))
    window.press("EnfiladeAccept")
    # The panel says so of the first time already.
    window.wait_for(question, lambda now: now == after)


def within_bounds(window):
    return all(low - 0.1 <= way <= high + 0.1 for _, _, way, low, high in window.ask("used"))


def mark_lines(window, labels, kind):
    window.click(window.ask("tab", 0))
    window.click(window.ask("empty"))
    for i, label in enumerate(labels):
        window.click(window.ask("middle", label), *(["ctrl"] if i else []))
    assert sorted(window.ask("document")["selection"]) == sorted(labels)
    window.wait_for("panel", lambda _: window.ask("text", "EnfiladeSelected").count(",") == min(len(labels), 6) - 1, 100)
    tick_only(window, kind)
    window.press("EnfiladeAllow")
    assert status(window).startswith("Marked: ") and "They move together" in status(window), status(window)


def test_01_a_house_from_the_first_mark_to_the_second_round(window):
    window.ask("furnished", "Wohnhaus")
    window.wait_for("panel", lambda p: p["document"] == "Wohnhaus", 100)
    window.click(window.ask("tab", 0))
    window.click(window.ask("point", 4000, 4000))
    window.wait_for("panel", lambda _: window.ask("text", "EnfiladeSelected") == "Selected: P", 100)
    tick_only(window, "x")
    window.press("EnfiladeAllow")
    assert status(window) == "Marked: P"
    window.ask("select", "Tür")
    tick_only(window, "along")
    window.press("EnfiladeAllow")
    assert status(window) == "Marked: Tür"

    # Stopped, and what it had found is shown and can be accepted.
    stop = window.ask("find", "EnfiladeStop")
    press_run(window, 5_000_000)
    window.wait_for("panel", lambda p: p["overlay"].get("best"), 600)
    # A line of another font may be a pixel or two higher; the mouse still is on the button.
    now = window.ask("find", "EnfiladeStop")
    assert max(abs(a - b) for a, b in zip(now, stop)) <= 4, "no button jumps away from the mouse"
    window.press("EnfiladeStop")
    panel = window.wait_for("panel", lambda p: not p["running"], 90)
    assert panel["status"].startswith("Stopped. Best so far: ") and panel["options"] >= 1, panel

    panel = run_study(window)
    assert panel["status"].startswith("Done: ") and panel["options"] >= 1, panel
    window.shot("20-house")
    take(window, 1, "state")
    window.shot("21-house-accepted")
    state = window.ask("state")
    assert state["P"][0] - 60 <= state["Tür"][0] and state["Tür"][2] <= state["P"][2] + 60, "the door is in its wall"
    panel = run_study(window)
    assert os.path.basename(panel["round"]) == "round-02", panel
    if panel["options"]:
        window.press("EnfiladeAccept")
        window.wait_for("panel", lambda p: p["status"].startswith("Accepted "), 200)
    assert window.ask("used") and within_bounds(window)
    x = (window.ask("state")["P"][0] + window.ask("state")["P"][2]) / 2
    assert 3500 - 0.1 <= x <= 4500 + 0.1, "two rounds, and the first bounds"


def test_02_a_plan_of_draft_lines(window):
    window.ask("plan", "Skizze")
    window.wait_for("panel", lambda p: p["document"] == "Skizze", 100)
    window.click(window.ask("tab", 0))
    window.press("EnfiladeAllow")
    assert status(window) == "Nothing selected. Select all lines of a wall in the view."
    places = [(x, y) for y in (475, 3675) for x in (3850, 4150)] + [(4000, 700), (4000, 1600)]
    mark_lines(window, window.ask("labels_at", places), "x")
    window.shot("22-lines-marked")
    panel = run_study(window)
    assert panel["status"].startswith("Done: ") and panel["options"] >= 1, panel
    window.wait_for("panel", lambda p: p["overlay"]["heat"] and p["overlay"]["ghost"], 300)
    window.shot("23-lines-options")
    take(window, 1, "ends")
    window.shot("24-lines-accepted")
    panel = run_study(window)
    assert os.path.basename(panel["round"]) == "round-02", panel
    if panel["options"]:
        window.press("EnfiladeAccept")
        window.wait_for("panel", lambda p: p["status"].startswith("Accepted "), 200)
    assert window.ask("used") and within_bounds(window)


def test_03_an_imported_drawing(window):
    if not os.path.exists(ROOMS):
        pytest.skip("the drawings of shared/data are not here")
    window.ask("imported", ROOMS)
    window.wait_for("panel", lambda p: p["document"] == "Imported", 100)
    # Once it is read the row with its question is there, and nothing jumps away from the mouse.
    window.wait_for("read", lambda words: words.startswith("Read in"), 100)
    mark_lines(window, ["Shape047", "Shape051"], "x")
    panel = run_study(window, 200, 1)
    assert panel["status"].startswith("Done: ") and panel["options"] >= 1, panel
    window.wait_for("panel", lambda p: p["overlay"]["heat"], 300)
    window.shot("25-imported")
    take(window, 1, "ends")
    assert window.ask("used") and within_bounds(window)


def with_works(folder, works):
    """A next round whose only option has building works and moves nothing."""
    next_round = os.path.join(os.path.dirname(folder), "round-99")
    shutil.copytree(folder, next_round)
    path = os.path.join(next_round, "result.json")
    with open(path) as f:
        data = json.load(f)
    option = {**data["candidates"][0], "changes": [], "parameters": [], "words": "Visibility +8 %.", "works": works}
    data.update(candidates=[option], best=None)
    with open(path, "w") as f:
        json.dump(data, f)


def opening(kind, words, a, b, **rest):
    stretch = [[4, a], [4, b]]
    gone = [[[4.05, a], [4.05, b], [3.95, b], [3.95, a]]]
    return {"kind": kind, "words": words, "stretch": stretch, "width_m": b - a, "demolished": gone, **rest}


def test_04_an_option_that_cuts_and_builds(window):
    window.ask("house", "Umbau")
    window.wait_for("panel", lambda p: p["document"] == "Umbau", 100)
    window.click(window.ask("tab", 0))
    window.click(window.ask("point", 4000, 4000))
    window.wait_for("panel", lambda _: window.ask("text", "EnfiladeSelected") == "Selected: P", 100)
    tick_only(window, "x")
    window.press("EnfiladeAllow")
    panel = run_study(window, 100, 1)
    assert panel["options"] >= 1, panel
    passage = opening("open", "An opening of 1.2 m between kitchen and hall", 2.2, 3.4)
    built = [{"ends": [[1.5, 0.125], [1.5, 4.0]], "thickness_m": 0.1}]
    new = {"kind": "add", "words": "A wall of 3.9 m in kitchen", "stretch": built[0]["ends"], "width_m": 3.9, "built": built}
    door = opening("door", "A door of 0.9 m between kitchen and hall", 3.6, 4.5, filling="door")
    with_works(panel["round"], [passage, new, door])
    window.ask("run_command", "Enfilade_Look")
    panel = window.wait_for("panel", lambda p: p["round"].endswith("round-99"), 200)
    window.click(window.ask("item", 1))
    words = window.ask("panel")["words"]
    assert words.split("\n") == ["Visibility +8 %.", "• An opening of 1.2 m between kitchen and hall", "• A wall of 3.9 m in kitchen", "• A door of 0.9 m between kitchen and hall"]
    window.wait_for("panel", lambda p: p["overlay"]["ghost"], 300)
    window.shot("26-works")
    take(window, 1, "state")
    said = "Accepted option 1: an opening of 1.2 m between kitchen and hall; a wall of 3.9 m in kitchen; a door of 0.9 m"
    assert status(window).startswith(said), status(window)
    window.ask("isometric")
    window.shot("27-works-accepted")
    assert window.ask("state")["New wall"][:4] == [1450, 125, 1550, 4000]
