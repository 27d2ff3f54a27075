"""The fake offers nothing that Revit's API does not: compared with the published stubs, by their text."""

import ast
import enum
import glob
import inspect
import os

import pytest
from check_types import repaired
from conftest import ROOT
from fake import install

#: Namespaces that the stubs know.
SPACES = [space for space in install.SPACES if space.startswith("Autodesk.")]

#: The stubs put the classes inside ``SpecTypeId`` beside it.
INNER = {("SpecTypeId", "String"), ("SpecTypeId", "Boolean")}

#: Known to pythonnet and .NET: sequences, and the text of any exception.
DOTNET = {"Message"}


@pytest.fixture(scope="module")
def stubs():
    """Every class of the stubs: its bases and its members, each with what is said of it."""
    found = glob.glob(os.path.join(ROOT, ".venv", "lib", "python3*", "site-packages", "Autodesk"))
    assert found, "pyrevit-stubs-25 is not in .venv; scripts/setup installs it"
    out = {}
    for space in SPACES:
        with open(os.path.join(found[0], *space.split(".")[1:], "__init__.pyi"), encoding="utf-8-sig") as f:
            tree = ast.parse(repaired(f.read()))
        out[space] = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    return out


def members(classes, name):
    """Members of a class and its bases by name: every ``def`` and value."""
    out, todo = {}, [name]
    while todo:
        node = classes.get(todo.pop())
        for item in node.body if node else ():
            if isinstance(item, ast.FunctionDef):
                out.setdefault(item.name, []).append(item)
            elif isinstance(item, ast.Assign):
                out.setdefault(item.targets[0].id, []).append(item)
        todo += [base.id for base in node.bases if isinstance(base, ast.Name)] if node else []
    return out


def is_property(item):
    return any(isinstance(d, ast.Name) and d.id == "property" for d in item.decorator_list)


def is_setter(item):
    return any(isinstance(d, ast.Attribute) and d.attr == "setter" for d in item.decorator_list)


def arguments(item):
    return [a.arg for a in item.args.args if a.arg != "self"]


def own_members(cls):
    return {n: v for n, v in vars(cls).items() if not n.startswith("_")}


def differences(classes, name, cls):
    """What a class of the fake has that its stub has not, in words."""
    if name not in classes:
        return [f"there is no class {name}"]
    there, out = members(classes, name), []
    for base in cls.__mro__[1:-1]:
        known, todo = set(), [name]
        while todo:
            node = classes.get(todo.pop())
            bases = [b.id for b in node.bases if isinstance(b, ast.Name)] if node else []
            known.update(bases)
            todo += bases
        if base not in (enum.Enum, Exception, BaseException) and base.__name__ not in known:
            out.append(f"{name} is no {base.__name__}")
    if issubclass(cls, enum.Enum):
        for label, member in cls.__members__.items():
            values = [ast.literal_eval(i.value) for i in there.get(label, []) if isinstance(i, ast.Assign)]
            if values != [member.value]:
                out.append(f"{name}.{label} is {values}, not {member.value}")
        return out
    for label, value in own_members(cls).items():
        if label in DOTNET or (name, label) in INNER:
            continue
        indexed = label.startswith("get_")
        items = there.get(label[4:] if indexed else label, [])
        if not items:
            out.append(f"there is no {name}.{label}")
        elif isinstance(value, property):
            if not any(is_property(i) and not arguments(i) for i in items):
                out.append(f"{name}.{label} is no property")
            if value.fset and not any(is_setter(i) for i in items):
                out.append(f"{name}.{label} cannot be set")
        elif isinstance(value, (staticmethod, type(own_members))):
            said = list(inspect.signature(getattr(value, "__func__", value)).parameters)
            said = said if isinstance(value, staticmethod) else said[1:]
            known = [arguments(i) for i in items if is_property(i) == indexed and not is_setter(i)]
            # Document.Export has many forms; the fake takes what is handed on.
            if said not in known and not (label == "Export" and [*said[:2]] == known[0][:2]):
                out.append(f"{name}.{label}({said}) is none of {known}")
    return out


@pytest.mark.parametrize("space", SPACES)
def test_the_fake_offers_only_what_the_api_has(stubs, space):
    wrong = [w for name, cls in install.SPACES[space].items() for w in differences(stubs[space], name, cls)]
    assert wrong == []


def test_inner_classes_and_constructors_are_the_apis(stubs):
    classes = stubs["Autodesk.Revit.DB"]
    assert "Text" in members(classes, "String") and "YesNo" in members(classes, "Boolean")
    takes = {
        name: [arguments(i) for i in members(classes, name).get("__init__", [])]
        for name in ("Transaction", "TransactionGroup", "FilteredElementCollector", "XYZ", "InstanceBinding",
                     "ExternalDefinitionCreationOptions", "DXFExportOptions", "IFCExportOptions", "CategorySet",
                     "Options")
    }
    for name, known in takes.items():
        made = list(inspect.signature(install.DB[name]).parameters)
        assert made in known or made == ["args", "kwargs"] and [] in known, (name, made, known)
    assert [["id"]] == [k for k in [arguments(i) for i in members(classes, "ElementId")["__init__"]] if k == ["id"]][:1]


def test_the_comparison_sees_a_difference(stubs):
    """It would find a member, a parameter, a setter, a base and a value that are not there."""

    class Element:
        pass

    class Wall(Element):
        Width = property(lambda self: 0.0, lambda self, v: None)

        def Levitate(self):
            pass

        def FindInserts(self, addRectOpenings):
            pass

        def Pinned(self):
            pass

    class Level(Wall):
        pass

    class WallKind(enum.Enum):
        Basic = 1

    classes = stubs["Autodesk.Revit.DB"]
    said = " ".join(differences(classes, "Wall", Wall))
    for word in ("no Wall.Levitate", "Wall.FindInserts(['addRectOpenings']) is none", "Wall.Width cannot be set", "Wall.Pinned"):
        assert word in said
    assert differences(classes, "Level", Level) == ["Level is no Wall"]
    assert differences(classes, "WallKind", WallKind) == ["WallKind.Basic is [0], not 1"]
    assert differences(classes, "Nonsense", Wall) == ["there is no class Nonsense"]
