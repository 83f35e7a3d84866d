"""The master: components, units, time, wiring, algorithms, scenarios.  It knows ports, time and steps, and no robot."""

from .algorithms import Algorithm, GaussSeidel, Jacobi
from .bonds import Bond, Residuals
from .component import Component, event, input, output, parameter, state, structural, table
from .conserving import Conserving, EnergyError
from .consistent import Consistent
from .control import PI, Fixed
from .errors import (
    CosimError,
    CouplingError,
    DeclarationError,
    ExportError,
    ScenarioError,
    StepError,
    WiringError,
)
from .extrapolation import Extrapolated
from .instance import Advance, Capabilities, Instance
from .iterated import Iterated
from .linearize import linearize
from .master import run
from .observer import Observer, Point, RunInfo, Summary
from .record import Record
from .richardson import Richardson
from .step_map import step_map
from .system import System
from .variable import Variable
from .wiring import Connection, Link

__all__ = [
    "PI",
    "Advance",
    "Algorithm",
    "Bond",
    "Capabilities",
    "Component",
    "Connection",
    "Conserving",
    "Consistent",
    "CosimError",
    "CouplingError",
    "DeclarationError",
    "EnergyError",
    "ExportError",
    "Extrapolated",
    "Fixed",
    "GaussSeidel",
    "Instance",
    "Iterated",
    "Jacobi",
    "Link",
    "Observer",
    "Point",
    "Record",
    "Residuals",
    "Richardson",
    "RunInfo",
    "ScenarioError",
    "StepError",
    "Summary",
    "System",
    "Variable",
    "WiringError",
    "event",
    "input",
    "linearize",
    "output",
    "parameter",
    "run",
    "state",
    "step_map",
    "structural",
    "table",
]
