"""How far a co-simulated rover is from the same rover in one ODE, for several ways of coupling body and wheels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import casadi as ca
import numpy as np

import fmus
from cosim import Component, input, output, parameter, state
from cosim.algorithms import GaussSeidel, Jacobi
from cosim.clock import NS, tick_at_or_after, ticks
from cosim.master import run
from cosim.record import Record
from cosim.system import System
from plants import rover
from plants.ground import Ground
from plants.monolithic import MonolithicRover
from plants.rigid_body import RigidBody
from plants.tables import Robot
from plants.wheel_deformation import WheelDeformation

Coupling = Literal["reduced", "classical", "classical-jacobi", "reduced-jacobi"]


class SpringWheel(Component):
    """The classical partner of a displacement/force coupling: F_n = max(0, -k_w gap - c_w gap'), held over the step."""

    k_w = parameter([1e5, 1e5, 1e5, 1e5], "N/m", "radial stiffness of each wheel")
    c_w = parameter([0.0, 0.0, 0.0, 0.0], "N.s/m", "radial damping of each wheel")
    gap = input("m", "signed distance of each wheel from the ground", shape=4)
    gap_rate = input("m/s", "its time derivative", shape=4)
    z = state([0.0, 0.0, 0.0, 0.0], "m", "deformation, compression negative")
    z_rate = state([0.0, 0.0, 0.0, 0.0], "m/s", "its time derivative")
    normal_force = output("N", "normal force of each wheel", shape=4)

    def sync(s: Any) -> dict[str, Any]:
        return {"z": s.gap, "z_rate": s.gap_rate}

    def outputs(s: Any) -> dict[str, Any]:
        return {"normal_force": ca.if_else(s.z < 0, ca.fmax(0, -s.k_w * s.z - s.c_w * s.z_rate), 0)}


@dataclass(frozen=True)
class Case:
    """One rover on one ground, uncontrolled: robot, wheels (per wheel), start and duration."""

    robot: Robot
    ground: Ground
    k_w: float  # N/m
    c_w: float = 0.0  # N.s/m
    speed: float = 2.0  # m/s
    x: float = 0.0  # m
    lift: float = 0.0  # m above the static height at the start
    duration: float = 0.3  # s

    def wheels(self) -> WheelDeformation:
        """The wheel plant of the case."""
        return WheelDeformation(k_w=np.full(4, self.k_w), c_w=np.full(4, self.c_w))

    def body_values(self) -> dict[str, Any]:
        """Parameters and tables of the body."""
        return {**self.robot.body_parameters(), **self.ground.tables(self.robot.R)}

    def starts(self) -> dict[str, np.ndarray]:
        """Start values: static equilibrium, then lifted."""
        body = RigidBody(**self.body_values())
        found = rover.start_values({"body": body, "wheels": self.wheels()}, rover.Stance(self.x, self.speed))
        lift = np.array([0.0, 0.0, self.lift])
        return {**found, "body.r": found["body.r"] + lift, "wheels.z": found["wheels.z"] + self.lift}


@dataclass(frozen=True)
class Trace:
    """World vertical speed of the centre of mass and total energy at whole macro steps."""

    ns: np.ndarray
    vertical_speed: np.ndarray  # m/s
    energy: np.ndarray  # J: kinetic, potential, elastic


@lru_cache(maxsize=32)
def _reference(key: tuple[Any, ...], step_ns: int) -> Trace:
    case: Case = key[0]
    return exactly(case, np.arange(0, round(case.duration * NS) + 1, step_ns))


def exactly(case: Case, ns: np.ndarray) -> Trace:
    """Integrate the case as one ODE at relative tolerance 1e-12, sampled at the ticks *ns*, ascending from 0."""
    whole = MonolithicRover(**case.body_values(), k_w=np.full(4, case.k_w), c_w=np.full(4, case.c_w))
    instance = fmus.instantiate(whole, "reference")
    for name, value in case.starts().items():
        slot, _, variable = name.partition(".")
        if slot == "body":
            instance.set(variable, value)
    instance.enter_initialization(0, None, 1e-12)
    instance.exit_initialization()
    speeds, energies, now = [], [], 0
    for tick in ns.tolist():
        if tick > now:
            instance.step(now, tick)
        now = tick
        speeds.append(instance.get("velocity")[2])
        energies.append(sum(instance.get(n) for n in ("kinetic_energy", "potential_energy", "elastic_energy")))
    instance.close()
    return Trace(ns, np.array(speeds), np.array(energies))


def kink(case: Case, angle: float) -> int:
    """Return the first tick at or after the instant at which the fronts meet a slope of *angle* (rad), in closed form.

    They roll at a constant speed, sunk by their static deflection, on a body pitched by the difference of both: the
    faces of level and slope are equally near on the bisector of the kink.
    """
    robot, starts = case.robot, case.starts()
    at, nose_up, sunk = case.ground.departure(robot.R), -2 * starts["body.q"][2], -starts["wheels.z"][0]
    assert at is not None
    front = starts["body.r"][0] + robot.L_f * np.cos(nose_up) + robot.h * np.sin(nose_up)
    return tick_at_or_after(float((at + sunk * np.tan(angle / 2) - front) / case.speed))


def reference(case: Case, step: float) -> Trace:
    """Integrate the case as one ODE at relative tolerance 1e-12, sampled every *step* seconds."""
    return _reference((case,), ticks(step, "the sampling step"))


def coupled(case: Case, coupling: Coupling = "reduced", *, smooth: bool = False) -> System:
    """Return the body and the wheels of the case as FMUs, coupled; the wheels first.  *smooth* as for ``fmus.load``."""
    reduced = coupling.startswith("reduced")
    body = fmus.instantiate(RigidBody(**case.body_values()), "body", smooth=smooth)
    spring = SpringWheel(k_w=np.full(4, case.k_w), c_w=np.full(4, case.c_w))
    wheels = fmus.instantiate(case.wheels() if reduced else spring, "wheels", smooth=smooth)
    instances = {"wheels": wheels, "body": body}
    rover.apply(case.starts(), instances)
    connections = rover.wires({name: instance.variables for name, instance in instances.items()})
    if not reduced:
        connections = {
            t: s for t, s in connections.items() if t in ("wheels.gap", "wheels.gap_rate", "body.normal_force")
        }
    return System(instances, connections)


def cosimulate(case: Case, step: float, coupling: Coupling = "reduced", *, locate: bool = True) -> Trace:
    """Co-simulate the case and return its trace at whole macro steps."""
    record = Record()
    with coupled(case, coupling) as system:
        algorithm = Jacobi() if coupling.endswith("jacobi") else GaussSeidel(("wheels", "body"))
        run(system, algorithm, step=ticks(step, "step"), stop=ticks(case.duration, "duration"), observers=[record],
            locate_events=locate)  # fmt: skip
    whole = record.time_ns % ticks(step, "step") == 0
    gap = np.minimum(record["body.gap"], 0)
    energy = record["body.kinetic_energy"] + record["body.potential_energy"] + case.k_w / 2 * np.sum(gap**2, axis=1)
    return Trace(record.time_ns[whole], record["body.velocity"][whole, 2], energy[whole])


def worst_error(case: Case, step: float, coupling: Coupling = "reduced", *, locate: bool = True) -> float:
    """Return the largest error of the vertical speed against the monolithic reference over the run, in m/s."""
    found, exact = cosimulate(case, step, coupling, locate=locate), reference(case, step)
    return float(np.max(np.abs(found.vertical_speed - exact.vertical_speed)))
