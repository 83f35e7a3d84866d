"""What a scenario can name: components, grounds, and the scenario files that come with the package."""

from __future__ import annotations

from dataclasses import fields
from importlib.resources import files
from pathlib import Path
from typing import Any

from controllers.actuator import Actuator
from controllers.force_profile import ForceProfile
from controllers.jerk_traction import JerkTraction
from controllers.open_loop_torque import OpenLoopTorque
from controllers.pd_impact import PdImpact
from controllers.pitch_trajectory import PitchTrajectory
from controllers.playback import Playback
from controllers.pole_placement import PolePlacement
from controllers.sensor import Sensor
from controllers.slip_control import SlipControl
from controllers.steered import Steered
from controllers.uncontrolled import Uncontrolled
from cosim import Component
from cosim.errors import ScenarioError, nearest
from cosim.scenario import ScenarioFile, Slot
from plants import ground
from plants.chassis_modal import ChassisModal
from plants.full_order import FullOrderRover
from plants.manoeuvre import PitchManoeuvre
from plants.rigid_body import RigidBody
from plants.rigid_contact import RigidContact
from plants.wheel_deformation import WheelDeformation
from plants.wheel_drive import WheelDrive

from .designs import DESIGNS, Context

PLANTS: dict[str, type[Component]] = {
    c.__name__: c for c in (RigidBody, WheelDeformation, RigidContact, ChassisModal, WheelDrive, FullOrderRover)
}
CONTROLLERS: dict[str, type[Component]] = {
    c.__name__: c
    for c in (
        Uncontrolled,
        OpenLoopTorque,
        SlipControl,
        Steered,
        PdImpact,
        PolePlacement,
        PitchTrajectory,
        Playback,
        JerkTraction,
        ForceProfile,
    )
}
ELEMENTS: dict[str, type[Component]] = {c.__name__: c for c in (Sensor, Actuator)}  # what stands in connections
COMPONENTS = {**PLANTS, **CONTROLLERS, **ELEMENTS}

GROUNDS: dict[str, type] = {
    "flat": ground.Flat,
    "ramp": ground.Ramp,
    "step": ground.Step,
    "hump": ground.Hump,
    "half-sine": ground.HalfSine,
    "rough-road": ground.RoughRoad,
    "csv": ground.CsvProfile,
    "pitch-manoeuvre": PitchManoeuvre,
}


def component(type_name: str, parameters: dict[str, Any], where: str, context: Context | None = None) -> Component:
    """Make a component of the catalog, by its design where it has one and there is a *context* to design it for.

    Raises ScenarioError naming *where* it was asked for.
    """
    if type_name not in COMPONENTS:
        raise ScenarioError(f"{where}: there is no component {type_name!r}; {nearest(type_name, COMPONENTS)}")
    try:
        if type_name == "ChassisModal" and "frequency" not in parameters:
            from plants.chassis import chassis  # the finite-element library takes a second to import

            return chassis(**parameters)
        if context is not None and type_name in DESIGNS:
            return DESIGNS[type_name](dict(parameters), context)
        return COMPONENTS[type_name](**parameters)
    except Exception as error:
        raise ScenarioError(f"{where}: {error}") from error


def fill(slot: Slot, where: str, more: dict[str, Any], context: Context | None = None) -> Component | str:
    """Return the component that a *slot* asks for, *more* its parameters unless it gives them, or the path of its FMU.

    Raises ScenarioError naming *where* it was asked for.
    """
    if slot.fmu is not None:
        if slot.type is not None or slot.parameters():
            raise ScenarioError(f"{where} names an fmu, so it cannot have a type or parameters beside it")
        return slot.fmu
    if slot.type is None:
        raise ScenarioError(f"{where} needs a type of the catalog or the path of an fmu")
    return component(slot.type, {**more, **slot.parameters()}, where, context)


def profile(spec: Any, where: str) -> Any:
    """Make a ground profile from ``{kind = "ramp", angle = 0.3, ...}``; raises ScenarioError naming the key."""
    if not isinstance(spec, dict) or "kind" not in spec:
        raise ScenarioError(f"{where} needs a kind; known: {', '.join(GROUNDS)}")
    values = {k.replace("-", "_"): v for k, v in spec.items() if k != "kind"}
    if spec["kind"] not in GROUNDS:
        raise ScenarioError(f"{where}.kind: there is no ground {spec['kind']!r}; {nearest(str(spec['kind']), GROUNDS)}")
    cls = GROUNDS[spec["kind"]]
    known = {f.name for f in fields(cls) if f.init}
    for name, value in values.items():
        if name not in known:
            raise ScenarioError(f"{where}.{name} is not known for a {spec['kind']}; {nearest(name, sorted(known))}")
        if isinstance(value, (dict, list)):
            raise ScenarioError(f"{where}.{name} must be a single value, not {value!r}")
    try:
        return cls(**values)
    except TypeError as error:
        raise ScenarioError(f"{where}: {error}") from None


def scenario_files() -> dict[str, Path]:
    """Return the scenarios that come with the package, by name."""
    folder = Path(str(files("studies")))
    return {p.stem: p for p in sorted(folder.glob("*.toml"))}


def find_scenario(name: str) -> ScenarioFile:
    """Return a scenario by its name or by the path of its file; raises ScenarioError naming the nearest one."""
    known = scenario_files()
    if name in known:
        return ScenarioFile(known[name])
    if name.endswith(".toml") or "/" in name:
        return ScenarioFile(Path(name))
    raise ScenarioError(f"there is no scenario {name!r}; {nearest(name, known)}")
