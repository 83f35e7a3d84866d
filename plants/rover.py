"""The rover: three plants and their wires, with the controller's ports left open, and how it stands when a run starts.

    controller --> (drive) --> wheels --> body --> chassis
         ^           ^           ^---------'
         '-----------'-----------'

Gauss-Seidel order: the controller sees the outputs of t_n, the wheels step on the reduced interface model of t_n, the
body on the wheels' mean forces over [t_n, t_n + h], the chassis on the wheel forces that the body passes on.  A drive
(motors and spinning wheels) turns torques into the tractions that the wheels are asked for; without one the controller
asks for them itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

import numpy as np

from cosim import Component, CouplingError, Variable
from cosim.instance import Instance
from cosim.kept import fingerprint, kept

from .chassis_modal import static_deflection

ORDER = ("controller", "drive", "wheels", "body", "chassis")

# input: output, or several in the order of preference; made where both ends exist
WIRES: dict[str, tuple[str, ...]] = {
    **{f"wheels.{p}": (f"body.{p}",) for p in ("gap", "gap_rate", "contact_velocity", "P", "U", "V", "b_free")},
    "wheels.sideslip_mobility": ("body.sideslip_mobility",),
    **{f"body.{p}": (f"wheels.{p}",) for p in ("normal_force", "traction", "lateral")},
    "body.steer": ("controller.steer",),
    "body.moment": ("drive.reaction",),
    "chassis.wheel_force": ("body.wheel_force",),
    "wheels.traction_demand": ("drive.traction_demand", "controller.traction_demand"),
    "wheels.lateral_demand": ("drive.lateral_demand",),
    "drive.torque": ("controller.torque",),
    "drive.contact_velocity": ("body.contact_velocity",),
    "drive.normal_force": ("wheels.normal_force_end",),
    "controller.normal_force": ("wheels.normal_force_end", "body.normal_force_end"),
    "body.torque": ("controller.torque",),
    "body.traction_demand": ("controller.traction_demand",),
}
# whatever else a controller or a drive reads: the port of the same name of these, the first that has it
_SENSED = {"controller": ("drive", "body", "wheels"), "drive": ("body", "wheels")}

# Stands in for the stiffness of a rigid contact when the start is solved: 1e13 N/m leaves 4e-11 m of penetration under
# a quarter of 170 kg, which the contact law turns into less than 1e-6 m/s at a macro step of 1e-4 s.
_RIGID = 1e13


@dataclass(frozen=True)
class Stance:
    """Where and how the rover stands or moves at the start: position along the road, speed, both in world axes."""

    x: float = 0.0  # m, of the centre of mass
    speed: float = 0.0  # m/s, along +x


def wires(slots: Mapping[str, Mapping[str, Variable]], *, driven: bool = False) -> dict[str, str]:
    """Return the connections among the slots that are filled, by the ports that their components have.

    A controller's input without a wire of its own reads the port of the same name of the drive, the body or the wheels.
    A robot that has its own drive takes what is asked of it once: torques if it is *driven*, as by the drive of the
    analytical robot, else the traction.
    """

    def has(port: str, causality: str) -> bool:
        slot, _, name = port.partition(".")
        return slot in slots and name in slots[slot] and slots[slot][name].causality == causality

    found = {}
    for slot, variables in slots.items():
        for name in (n for n, v in variables.items() if v.causality == "input"):
            target = f"{slot}.{name}"
            sources = WIRES.get(target) or tuple(f"{other}.{name}" for other in _SENSED.get(slot, ()))
            source = next((s for s in sources if has(s, "output")), None)
            if source is not None:
                found[target] = source
    if {"body.torque", "body.traction_demand"} <= set(found):
        found.pop("body.traction_demand" if driven else "body.torque")
    return found


def quaternion(pitch: float, roll: float) -> np.ndarray:
    """Return the attitude (w, x, y, z): nose-up *pitch*, then *roll* to the right about the body's x axis, in rad."""
    p, r = -pitch / 2, roll / 2  # a right-handed turn about y is nose-down
    return np.array([np.cos(p) * np.cos(r), np.cos(p) * np.sin(r), np.sin(p) * np.cos(r), -np.sin(p) * np.sin(r)])


def stand(body: Component, wheels: Component, stance: Stance) -> dict[str, np.ndarray]:
    """Solve for the static equilibrium of height, pitch and roll on the wheel springs.

    Returns the start values ``body.r``, ``body.q``, ``body.v``, ``wheels.z`` (m, compression negative) and
    ``normal_force`` (4,) in N.  On a slope only the vertical force and two moments vanish: nothing brakes the robot.
    Raises CouplingError if no equilibrium is found, for instance with a wheel over a gap.
    """
    from scipy.optimize import least_squares, root  # takes half a second to import

    k = wheels.values["k_w"] if "k_w" in wheels.values else np.full(4, _RIGID)
    m, h, R, g = (float(body.values[n]) for n in ("m", "h", "R", "g"))
    instance = body.instance("body")
    instance.enter_initialization(0)
    sag = m * g / np.sum(k)

    def place(unknowns: np.ndarray) -> np.ndarray:
        z, pitch, roll = unknowns
        instance.set("r", np.array([stance.x, 0.0, z]))
        instance.set("q", quaternion(pitch, roll))
        instance.set("normal_force", np.maximum(0, -k * instance.get("gap")))
        return np.array([instance.get("der(v)")[2], *instance.get("der(omega)")[:2]])

    def clearance(unknowns: np.ndarray) -> np.ndarray:
        place(unknowns)
        return instance.get("gap")

    height = h + R - float(np.min(clearance(np.array([h + R, 0, 0]))))  # level, with the lowest clearance closed
    laid = least_squares(clearance, [height, 0.0, 0.0], xtol=1e-12).x  # tilted, with all clearances as small as can be
    for guess in ([height, 0.0, 0.0], laid):
        first = guess - np.array([sag, 0, 0])
        found = root(place, first, method="hybr", options={"xtol": 1e-15, "eps": 1e-7 * sag / height})
        unknowns = _polish(place, found.x, sag)
        residual = place(unknowns)
        if np.max(np.abs(residual)) < 1e-6:
            break
    if np.max(np.abs(residual)) > 1e-6 * max(1.0, np.max(k) / _RIGID * 1e4):
        raise CouplingError(
            f"the rover finds no static equilibrium at x = {stance.x:g} m: {residual[0]:.2g} m/s2 and "
            f"{residual[2]:.2g} rad/s2 are left; start it where all four wheels meet the ground, as on a flat stretch"
        )
    gap = instance.get("gap")
    return {
        "body.r": instance.get("r"), "body.q": instance.get("q"), "body.v": np.array([stance.speed, 0.0, 0.0]),
        "wheels.z": gap, "normal_force": np.maximum(0, -k * gap),
    }  # fmt: skip


def _polish(residual: Any, x: np.ndarray, sag: float) -> np.ndarray:
    """Newton with a difference quotient, until rounding: a standing robot must not drift for seconds."""
    step = 1e-3 * sag
    for _ in range(6):
        f = residual(x)
        columns = [(residual(x + d) - residual(x - d)) / (2 * step) for d in step * np.eye(3)]
        jacobian = np.column_stack(columns)
        if np.linalg.matrix_rank(jacobian) < 3:
            break
        trial = x - np.linalg.solve(jacobian, f)
        if not np.max(np.abs(residual(trial))) < np.max(np.abs(f)):
            break
        x = trial
    return x


def start_values(components: dict[str, Component], stance: Stance) -> dict[str, np.ndarray]:
    """Return every start value of a standing or rolling rover as ``slot.state``, static chassis modes included."""
    known = [fingerprint(component, values=True) for component in components.values()]
    key = None if None in known else sha256(repr((list(components), known, stance)).encode()).hexdigest()
    return kept("starts", key, lambda: _start_values(components, stance))


def _start_values(components: dict[str, Component], stance: Stance) -> dict[str, np.ndarray]:
    body, wheels = components["body"], components["wheels"]
    found = stand(body, wheels, stance)
    forces = found.pop("normal_force")
    if "z" not in wheels.declarations:  # rigid wheels have a force where deformable ones have a deformation
        found.pop("wheels.z")
        found["wheels.force"] = forces
    drive = components.get("drive")
    if drive is not None and "omega" in drive.declarations:
        found["drive.omega"] = np.full(4, stance.speed / float(drive.values["R"]))  # rolling
    chassis = components.get("chassis")
    if chassis is not None:
        found["chassis.modal_q"] = static_deflection(chassis, forces)
    return found


def apply(starts: Mapping[str, np.ndarray], instances: Mapping[str, Instance]) -> None:
    """Set start values on the instances they belong to; a slot filled by a foreign FMU keeps its own."""
    for target, value in starts.items():
        slot, _, variable = target.partition(".")
        if slot in instances and variable in instances[slot].variables:
            instances[slot].set(variable, value)
