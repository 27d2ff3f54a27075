"""A Revit without Revit: what :mod:`enfilade_revit.host` and ``window`` import, played in Python.

What does not begin with an underscore is Revit's or .NET's own: ``test_fake.py`` compares names, parameters, setters
and values of enumerations with the published stubs. How Revit acts is taken from the documentation of its API; where
that says nothing (what joined walls do, what inserts do under a new location line), the fake does either, as
``Document._habits`` says. Inside it counts in feet. What begins with an underscore is for the tests.
"""
