"""Revit's exceptions, failures and enumerations."""

import enum


class ApplicationException(Exception):
    """``Message`` is .NET's, from the root of all exceptions."""

    @property
    def Message(self):
        return str(self.args[0])


class ArgumentException(ApplicationException):
    pass


class InvalidOperationException(ApplicationException):
    pass


class InvalidObjectException(InvalidOperationException):
    pass


class ModificationOutsideTransactionException(InvalidOperationException):
    pass


class FailureSeverity(enum.Enum):
    Warning = 1
    Error = 2
    DocumentCorruption = 3


class FailureProcessingResult(enum.Enum):
    Continue = 0
    ProceedWithCommit = 1
    ProceedWithRollBack = 2
    WaitForUserInput = 3


class TransactionStatus(enum.Enum):
    Uninitialized = 0
    Started = 1
    RolledBack = 2
    Committed = 3
    Pending = 4
    Error = 5
    Proceed = 6


class FailureMessageAccessor:
    def __init__(self, severity, text):
        self._severity, self._text = severity, text

    def GetSeverity(self):
        return self._severity

    def GetDescriptionText(self):
        return self._text


class FailuresAccessor:
    def __init__(self, messages):
        self._messages = messages

    def GetFailureMessages(self):
        return list(self._messages)

    def DeleteWarning(self, failure):
        if failure.GetSeverity() is not FailureSeverity.Warning:
            raise ArgumentException("Only warnings can be deleted.")
        self._messages.remove(failure)


class IFailuresPreprocessor:
    """pythonnet makes a .NET type of every class that implements it; two of one name are an error."""

    _made = set()

    def __init_subclass__(cls):
        name = (cls.__dict__["__namespace__"], cls.__name__)
        if name in IFailuresPreprocessor._made:
            raise TypeError("Duplicate type name within an assembly.")
        IFailuresPreprocessor._made.add(name)

    def PreprocessFailures(self, failuresAccessor):
        raise NotImplementedError


class FailureHandlingOptions:
    def __init__(self):
        self._preprocessor, self._clear = None, False

    def SetFailuresPreprocessor(self, preprocessor):
        if not isinstance(preprocessor, IFailuresPreprocessor):
            raise TypeError("no IFailuresPreprocessor")
        self._preprocessor = preprocessor
        return self

    def SetClearAfterRollback(self, bFlag):
        self._clear = bFlag
        return self


class WallKind(enum.Enum):
    Basic = 0
    Curtain = 1
    Stacked = 2
    Unknown = -1


class StorageType(enum.Enum):
    Integer = 1
    Double = 2
    String = 3
    ElementId = 4


class ElementOnPhaseStatus(enum.Enum):
    Past = 1
    Existing = 2
    Demolished = 3
    New = 4
    Temporary = 5
    Future = 6


class ViewType(enum.Enum):
    FloorPlan = 1
    CeilingPlan = 2
    ThreeD = 4
    EngineeringPlan = 115


class PlanViewPlane(enum.Enum):
    CutPlane = 0
    TopClipPlane = 1
    BottomClipPlane = 2
    ViewDepthPlane = 3


class ExportUnit(enum.Enum):
    Default = 0
    Millimeter = 3


class IFCVersion(enum.Enum):
    Default = 0
    IFC4 = 23


class BuiltInCategory(enum.Enum):
    OST_Walls = -2000011
    OST_Windows = -2000014
    OST_Doors = -2000023
    OST_Lines = -2000051
    OST_Columns = -2000100
    OST_GenericModel = -2000151
    OST_RvtLinks = -2001352
    OST_StructuralColumns = -2001330


class BuiltInParameter(enum.Enum):
    DOOR_WIDTH = -1001301
    FAMILY_ROUGH_WIDTH_PARAM = -1001305
    VIEW_PHASE = -1012102
