"""Documents, transactions, collectors, shared parameters, exports."""

import copy
import os

from .dotnet import Guid, List
from .elements import ElementId, ElementType, View
from .failures import (
    ArgumentException,
    FailureHandlingOptions,
    FailureMessageAccessor,
    FailureProcessingResult,
    FailuresAccessor,
    FailureSeverity,
    InvalidOperationException,
    ModificationOutsideTransactionException,
    TransactionStatus,
)


class Document:
    def __init__(self, application, title, path, guid):
        self._application, self._title, self._path, self._guid = application, title, path, guid
        self._elements, self._last, self._bindings = {}, 100, {}
        self._phases, self._active_option, self._is_family = [], None, False
        self._transaction = self._group = None
        self._posted, self._dialogs, self._undo, self._exports = [], [], [], []
        #: What the documentation leaves open: joined walls ``follow`` or ``stay``; inserts keep their distance from
        #: the ``start`` of a new location line or their ``place``.
        self._habits = {"joins": "follow", "inserts": "start"}
        #: Elements that something holds in their place.
        self._held = set()
        #: Failures that every next transaction meets.
        self._trouble = []
        self._writes = True
        #: Where walls stood that were moved since the model was regenerated.
        self._stale = {}
        #: Transactions and groups that are still open or not disposed of.
        self._open = []

    def _add(self, element):
        self._last += 1
        self._elements[self._last] = element
        return self._last

    def _modify(self):
        if self._transaction is None:
            raise ModificationOutsideTransactionException("Attempt to modify the model outside of transaction.")

    def _post(self, severity, text):
        self._posted.append(FailureMessageAccessor(severity, text))

    def _snapshot(self):
        return dict(self._elements), {i: copy.deepcopy(e._s) for i, e in self._elements.items()}, dict(self._bindings)

    def _restore(self, kept):
        self._stale = {}
        self._elements, self._bindings = dict(kept[0]), dict(kept[2])
        for id, state in kept[1].items():
            self._elements[id]._s = copy.deepcopy(state)

    def _undo_last(self):
        name, kept = self._undo.pop()
        self._restore(kept)
        return name

    @property
    def Application(self):
        return self._application

    @property
    def Title(self):
        return self._title

    @property
    def PathName(self):
        return self._path

    @property
    def CreationGUID(self):
        return Guid(self._guid)

    @property
    def IsFamilyDocument(self):
        return self._is_family

    @property
    def ParameterBindings(self):
        return BindingMap(self)

    def GetElement(self, id):
        if isinstance(id, str):
            return next((e for e in self._elements.values() if e.UniqueId == id), None)
        return self._elements.get(id.Value)

    def Regenerate(self):
        self._modify()
        self._stale = {}

    def Export(self, folder, name, *rest):
        """With views and their options, or with IFC's, which want an open transaction."""
        options = rest[-1]
        if isinstance(options, IFCExportOptions):
            self._modify()
        elif not isinstance(rest[0], List):
            raise TypeError("no ICollection[ElementId]")
        self._exports.append((folder, name, rest[0], options))
        return self._writes


class UIDocument:
    def __init__(self, document, view):
        self._document, self._view = document, view

    @property
    def Document(self):
        return self._document

    @property
    def ActiveView(self):
        return self._view


class Transaction:
    def __init__(self, document, name):
        self._document, self._name = document, name
        self._options, self._status = FailureHandlingOptions(), TransactionStatus.Uninitialized
        document._open.append(self)

    def Start(self):
        if self._document._transaction is not None:
            raise InvalidOperationException("Starting a new transaction is not permitted.")
        self._kept, self._status = self._document._snapshot(), TransactionStatus.Started
        self._document._transaction, self._document._posted = self, []
        for severity, text in self._document._trouble:
            self._document._post(severity, text)
        return self._status

    def GetFailureHandlingOptions(self):
        return copy.copy(self._options)

    def SetFailureHandlingOptions(self, options):
        self._options = options

    def HasStarted(self):
        return self._status is not TransactionStatus.Uninitialized

    def HasEnded(self):
        return self._status in (TransactionStatus.Committed, TransactionStatus.RolledBack)

    def Commit(self):
        """Failures go to the preprocessor, what it leaves to the user, who cancels."""
        messages, result = list(self._document._posted), FailureProcessingResult.Continue
        if messages and self._options._preprocessor is not None:
            result = self._options._preprocessor.PreprocessFailures(FailuresAccessor(messages))
        if result is FailureProcessingResult.ProceedWithRollBack:
            if not self._options._clear:
                self._document._dialogs += [m._text for m in messages]
            return self.RollBack()
        self._document._dialogs += [m._text for m in messages]
        if any(m._severity is not FailureSeverity.Warning for m in messages):
            return self.RollBack()
        self._end(TransactionStatus.Committed)
        if self._document._group is None:
            self._document._undo.append((self._name, self._kept))
        return self._status

    def RollBack(self):
        if self._status is not TransactionStatus.Started:
            raise InvalidOperationException("The transaction has not been started.")
        self._document._restore(self._kept)
        self._end(TransactionStatus.RolledBack)
        return self._status

    def _end(self, status):
        self._document._transaction, self._document._stale, self._status = None, {}, status

    def Dispose(self):
        """Revit rolls back what is still open, and writes a complaint into its journal."""
        if self._status is not TransactionStatus.Started:
            self._document._open.remove(self)


class TransactionGroup:
    def __init__(self, document, transGroupName):
        self._document, self._name = document, transGroupName
        document._open.append(self)

    def Start(self):
        self._document._group, self._kept = self, self._document._snapshot()
        return TransactionStatus.Started

    def Assimilate(self):
        self._end()
        self._document._undo.append((self._name, self._kept))
        return TransactionStatus.Committed

    def RollBack(self):
        self._end()
        self._document._restore(self._kept)
        return TransactionStatus.RolledBack

    def _end(self):
        if self._document._transaction is not None or self._document._group is not self:
            raise InvalidOperationException("A transaction of the group is still open, or the group is none.")
        self._document._group = None

    def Dispose(self):
        if self._document._group is not self:
            self._document._open.remove(self)


class FilteredElementCollector:
    def __init__(self, document, viewId=None):
        self._document, self._filters = document, []
        view = None if viewId is None else document.GetElement(viewId)
        if viewId is not None and not isinstance(view, View):
            raise ArgumentException("viewId is not a view.")
        self._view = view

    def OfCategory(self, category):
        self._filters.append(lambda e: e._s["kind"] is category)
        return self

    def WhereElementIsNotElementType(self):
        self._filters.append(lambda e: not isinstance(e, ElementType))
        return self

    def ToElements(self):
        if not self._filters:
            raise InvalidOperationException("The collector does not have a filter applied.")
        shown = (e for e in self._document._elements.values() if self._view is None or self._view._shows(e))
        return [e for e in shown if all(f(e) for f in self._filters)]


# -- shared parameters


class Application:
    def __init__(self, shared):
        self._shared = shared

    @property
    def SharedParametersFilename(self):
        return self._shared

    @SharedParametersFilename.setter
    def SharedParametersFilename(self, filename):
        self._shared = filename

    def OpenSharedParameterFile(self):
        return DefinitionFile(self._shared) if os.path.isfile(self._shared) else None


class DefinitionFile:
    def __init__(self, path):
        self._path = path

    @property
    def Groups(self):
        return DefinitionGroups(self._path)

    @property
    def Filename(self):
        return self._path


class DefinitionGroups:
    def __init__(self, path):
        self._path = path

    def Create(self, name):
        return DefinitionGroup(self._path, name)


class DefinitionGroup:
    def __init__(self, path, name):
        self._path, self._name = path, name

    @property
    def Name(self):
        return self._name

    @property
    def Definitions(self):
        return Definitions(self)


class Definitions:
    def __init__(self, group):
        self._group = group

    def Create(self, option):
        """Written to the file at once."""
        with open(self._group._path, "a", encoding="utf-8") as f:
            f.write(f"PARAM\t{option.GUID}\t{option.Name}\t{self._group.Name}\n")
        return ExternalDefinition(option)


class ForgeTypeId:
    def __init__(self, typeId):
        self._id = typeId


class _Spec:
    def __init__(self, **ids):
        self.__dict__.update(ids)


class SpecTypeId:
    """``String`` and ``Boolean`` are classes inside it, which the stubs put beside it."""

    String = _Spec(Text=ForgeTypeId("autodesk.spec:spec.string-2.0.0"))
    Boolean = _Spec(YesNo=ForgeTypeId("autodesk.spec:spec.bool-1.0.0"))


class GroupTypeId:
    Data = ForgeTypeId("autodesk.parameter.group:data-1.0.0")


class ExternalDefinitionCreationOptions:
    def __init__(self, name, dataType):
        self._name, self._type, self._guid, self._description = name, dataType, None, ""

    @property
    def Name(self):
        return self._name

    @property
    def GUID(self):
        return self._guid

    @GUID.setter
    def GUID(self, guid):
        self._guid = guid

    @property
    def Description(self):
        return self._description

    @Description.setter
    def Description(self, description):
        self._description = description


class Definition:
    @property
    def Name(self):
        return self._name


class ExternalDefinition(Definition):
    def __init__(self, option):
        self._name, self._guid = option.Name, option.GUID

    @property
    def GUID(self):
        return self._guid


class InternalDefinition(Definition):
    def __init__(self, name):
        self._name = name


class CategorySet:
    def __init__(self):
        self._items = []

    def Insert(self, item):
        self._items.append(item.BuiltInCategory)
        return True


class InstanceBinding:
    def __init__(self, categories):
        self._categories = tuple(categories._items)


class DefinitionBindingMapIterator:
    def __init__(self, names):
        self._names, self._at = names, -1

    def MoveNext(self):
        self._at += 1
        return self._at < len(self._names)

    @property
    def Key(self):
        return InternalDefinition(self._names[self._at])


class BindingMap:
    def __init__(self, document):
        self._document = document

    def ForwardIterator(self):
        return DefinitionBindingMapIterator(list(self._document._bindings))

    def Insert(self, key, item, groupTypeId):
        self._document._modify()
        if key.Name in self._document._bindings:
            return False
        self._document._bindings[key.Name] = (item._categories, str(key.GUID))
        return True


# -- exports


class DXFExportOptions:
    def __init__(self):
        self._values = {}

    @property
    def LayerMapping(self):
        return self._values.get("LayerMapping")

    @LayerMapping.setter
    def LayerMapping(self, layerMapping):
        self._values["LayerMapping"] = layerMapping

    @property
    def SharedCoords(self):
        return self._values.get("SharedCoords")

    @SharedCoords.setter
    def SharedCoords(self, sharedCoords):
        self._values["SharedCoords"] = sharedCoords

    @property
    def TargetUnit(self):
        return self._values.get("TargetUnit")

    @TargetUnit.setter
    def TargetUnit(self, targetUnit):
        self._values["TargetUnit"] = targetUnit


class IFCExportOptions:
    def __init__(self):
        self._version, self._view, self._more = None, ElementId.InvalidElementId, {}

    @property
    def FileVersion(self):
        return self._version

    @FileVersion.setter
    def FileVersion(self, FileVersion):
        self._version = FileVersion

    @property
    def FilterViewId(self):
        return self._view

    @FilterViewId.setter
    def FilterViewId(self, FilterViewId):
        self._view = FilterViewId

    def AddOption(self, name, value):
        if not isinstance(value, str):
            raise TypeError("no string")
        self._more[name] = value
