"""Every sentence of the workbench has its German, with the same values in it."""

import ast
import os
import re

from conftest import ROOT

FOLDER = os.path.join(ROOT, "plugins", "freecad", "freecad", "enfilade")


def trees():
    for name in sorted(os.listdir(FOLDER)):
        if name.endswith(".py"):
            with open(os.path.join(FOLDER, name), encoding="utf-8") as f:
                yield name, ast.parse(f.read())


def german():
    tree = dict(trees())["wording.py"]
    table = next(n for n in ast.walk(tree) if isinstance(n, ast.Assign) and n.targets[0].id == "GERMAN")
    return ast.literal_eval(table.value)


def test_what_is_said_is_translated():
    known = german()
    calls = (n for _, tree in trees() for n in ast.walk(tree) if isinstance(n, ast.Call))
    said = {
        arg.value
        for call in calls
        for arg in {"say": call.args[:1], "count": call.args[1:]}.get(getattr(call.func, "id", ""), [])
        if isinstance(arg, ast.Constant)
    }
    assert len(said) > 40 and sorted(said - known.keys()) == []


def test_titles_in_tables_are_translated():
    known = german()
    tables = {"MOVE_ROWS", "WORK_ROWS", "REGIONS", "MEASURES", "WORDS", "OPENING_WORDS", "WHY_WORDS"}
    titles = set()
    for _, tree in trees():
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") in tables:
                for text in (n.value for n in ast.walk(node.value) if isinstance(n, ast.Constant)):
                    if isinstance(text, str) and (" " in text or text in known):
                        titles.add(text)
    assert len(titles) > 8 and sorted(titles - known.keys()) == []


def test_translations_keep_their_values():
    wrong = [k for k, v in german().items() if re.findall(r"\{\}", k) != re.findall(r"\{\}", v)]
    assert wrong == []
