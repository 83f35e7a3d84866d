"""Runs on rigid wheels, and what every one of them must keep: bounds by which the stepping scheme errs, derived."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

import fmus
from cosim.algorithms import GaussSeidel
from cosim.clock import ticks
from cosim.master import run
from cosim.record import Record
from cosim.system import System
from plants import rover
from plants.ground import Ground
from plants.rigid_body import RigidBody
from plants.tables import ROBOTS, Robot
from plants.wheels import Wheels

ROBOT = ROBOTS["thesis_6_1"]


def drive(
    ground: Ground,
    wheels: Wheels,
    speed: float,
    duration: float,
    step: float,
    *,
    held: Mapping[str, Any] | None = None,
    moved: Mapping[str, Any] | None = None,
    robot: Robot = ROBOT,
) -> Record:
    """Co-simulate the FMUs of body and wheels: *held* inputs and *moved* start values by "slot.port"."""
    body = RigidBody(**robot.body_parameters(), **ground.tables(robot.R))
    starts = rover.start_values({"body": body, "wheels": wheels}, rover.Stance(0.0, speed))
    instances = {"wheels": fmus.instantiate(wheels, "wheels"), "body": fmus.instantiate(body, "body")}
    rover.apply({**starts, **(moved or {})}, instances)
    rover.apply({port: np.asarray(value, dtype=float) for port, value in (held or {}).items()}, instances)
    record = Record()
    with System(instances, rover.wires({n: i.variables for n, i in instances.items()})) as system:
        run(
            system,
            GaussSeidel(("wheels", "body")),
            step=ticks(step, "step"),
            stop=ticks(duration, "stop"),
            observers=[record],
        )
    return record


def depths(record: Record, step: float, part: slice = slice(None)) -> tuple[np.ndarray, np.ndarray]:
    """Return how deep each wheel sank into the ground (4,), and how deep it may at most, m.

    A wheel that closes at v from the gap g gets the impulse that lets it end the step at the velocity -g/h, and the
    next one brings that to 0: both at constant force, so it stops at (g - h v)/2 - g/2 = -h v / 2, wherever in a step
    it lands, and from there only rises.  A touching wheel is stepped on the gap acceleration of the start of the step,
    which misses the gap by at most h^2 times its change, as much again while that is undone.  Contacts give by F over
    their stiffness, and by 1e-5 of the velocities that impulses make.
    """
    gap, approach = record["body.gap"][part], -record["body.gap_rate"][part]
    pushes, b, F = (record[port][part] for port in ("wheels.contact", "body.b_free", "wheels.normal_force"))
    held = (pushes[1:] > 0.5) & (pushes[:-1] > 0.5)
    late = np.max(np.where(held, np.abs(np.diff(b, axis=0)), 0.0), axis=0)
    given = np.max(F, axis=0) / 1e13 + 1e-5 * step * np.max(approach)
    return np.max(-gap, axis=0), step * np.max(approach, axis=0) / 2 + 2 * step**2 * late + given


def assert_keeps_the_laws_of_contact(record: Record, step: float) -> None:
    """No wheel pulls, sinks in beyond its bound, exceeds its friction, or sticks."""
    F, limit = record["wheels.normal_force"], record["wheels.friction_limit"]
    assert np.min(F) >= 0
    used = np.hypot(record["wheels.traction"], record["wheels.lateral"])
    assert np.all(used <= limit * (1 + 1e-12))  # both are computed from the same F_n: rounding only
    deep, bound = depths(record, step)
    assert np.all(deep <= bound), (deep, bound)
    # a wheel is pushed in a step only if it would close its gap in it, so it cannot end farther off than it came
    away = np.max(np.where(F > 0, record["body.gap"], 0.0), axis=0)
    assert np.all(away <= 2 * bound), (away, bound)


def touchdowns(record: Record) -> np.ndarray:
    """Return how often each wheel regained the ground, (4,)."""
    pushes = record["wheels.contact"] > 0.5
    return np.count_nonzero(~pushes[:-1] & pushes[1:], axis=0)


def chatter(record: Record) -> np.ndarray:
    """Return for each wheel the share of steps in the midst of an on-off-on-off of four steps, (4,)."""
    changes = np.diff(record["wheels.contact"] > 0.5, axis=0)
    return np.mean(changes[:-2] & changes[1:-1] & changes[2:], axis=0)


def mechanical_energy(record: Record) -> np.ndarray:
    """Return kinetic and potential energy of the body, J."""
    return record["body.kinetic_energy"] + record["body.potential_energy"]
