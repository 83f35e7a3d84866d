"""What is drawn into the log of a run: the scene, the chassis, contacts, energy and the block diagram."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosim import Component
from cosim.instance import Instance
from cosim.record import Record
from logs.chassis_map import ChassisMap, Spectra, scales
from logs.diagram import Diagram
from logs.drawing import Drawing, Drawings, nice
from logs.energy import EnergyResidual
from logs.jerk import WINDOW, MeanJerk
from logs.questions import QUESTIONS, Camera, Look
from logs.recorder import Read
from logs.rings import RingScene
from logs.scene import Scene
from logs.states import ContactStates
from plants.full_order import FullOrderRover
from plants.ring_press import resting
from plants.tables import G, Robot

from .assembly import Assembly
from .metrics.metric import GRIP
from .runner import algorithm_of, obstacle_start

FAR = 3.0  # m of way, beyond which a camera that stands still sees the robot leave
FRAMES = 500  # at most
FORCE_ARROW = 3.0  # radii of a wheel: how long the arrow of a quarter of the weight is
NODE_ARROW = 2.0  # how much longer that of a force on one node of a ring is
FLAT = 0.06  # of a radius: how deep the weight presses a tyre in the picture, at least
_PRESSED = 0.02  # of a radius: where the search for the depth of a ring under the weight begins
ASIDE = 2.5  # m of ground beside the tracks of a robot that steers
ROWS, COLUMNS = 5, 4  # of stations on the default chassis


def drawn(assembly: Assembly, instances: dict[str, Instance], record: Record) -> tuple[Drawings, Look]:
    """Return what is drawn into the log of a run whose ports come into *record*, and how the log opens."""
    parts: list[Drawing] = [Diagram(algorithm_of(assembly))]
    captions = {"diagram": "the system: blue components in the order they step, orange wires one step late"}
    view = camera(assembly)
    if view is not None:
        shown = scene(assembly)
        whole = isinstance(assembly.components.get("body"), FullOrderRover)
        adds = "micro steps add" if whole else "the splitting adds"
        arm = 0.0 if shown.at_centre else shown.R
        parts += [shown, ContactStates(limited=shown.limited), EnergyResidual(arm)]
        captions |= {"scene": shown.caption, "contact": "", "energy": f"what {adds}"}
        captions |= {} if shown.limited else {"unlimited": ""}
        if whole:
            parts.append(MeanJerk(lambda: record.time, record.get))
            captions |= {"jerk": f"jerk of the body's components, over {1e3 * WINDOW:g} ms [m/s3]"}
    plate = chassis(assembly)
    if plate is not None:
        top = 1.1 * float(plate.frequency.max())
        parts += [plate, Spectra(lambda: record.time, record.get, top)]
        captions |= {
            **plate.captions,
            "spectrum": "spectra: amplitude [m/s2] over Hz, of the whole run",
        }
    asked = assembly.scenario.view or QUESTIONS[0]
    return Drawings(parts), Look(asked, view, captions)


def camera(assembly: Assembly) -> Camera | None:
    """Return who looks at the foot of the obstacle, or goes along where the way is long; None: there is no scene."""
    if assembly.robot is None or assembly.ground is None:
        return None
    bot, obstacle = assembly.robot, obstacle_start(assembly)
    start, speed = _departure(assembly)
    follow = abs(speed) * assembly.scenario.run.duration > FAR
    x = start if follow or obstacle is None else obstacle - 0.4 * bot.L_f  # the robot, when its front wheels are there
    return Camera((x, 0.0, 0.6 * bot.h), follow)


def _departure(assembly: Assembly) -> tuple[float, float]:
    """Return where the body starts, in m, and how fast, in m/s."""
    r, v = (assembly.starts.get(f"body.{name}") for name in ("r", "v"))
    return float(r[0]) if r is not None else 0.0, float(v[0]) if v is not None else 0.0


def scene(assembly: Assembly) -> Scene:
    """Return the scene of a rover on a known ground."""
    assert assembly.robot is not None
    assert assembly.ground is not None
    bot, run = assembly.robot, assembly.scenario.run
    start, speed = _departure(assembly)
    reach = abs(speed) * run.duration + bot.L_f + 0.8
    x = np.arange(start - bot.L_r - 0.8, start + reach, 0.01)
    left, right = (np.column_stack([x, track.elevation(x)]) for track in (assembly.ground.left, assembly.ground.right))
    scale = FORCE_ARROW * bot.R / (bot.m * G / 4)
    body = assembly.components.get("body")
    rings = isinstance(body, FullOrderRover) and body.structure["seen"] != 0
    return (RingScene if rings else Scene)(
        bot.R, bot.half_track, bot.L_f, bot.L_r, bot.h, left, right, scale * (NODE_ARROW if rings else 1),
        _interval(assembly), flattening=_flattening(assembly, bot), limited=_grip(assembly) < GRIP,
        shoulder=ASIDE if _steers(assembly) else 3 * bot.R, at_centre=_at_centre(body),
    )  # fmt: skip


def _interval(assembly: Assembly) -> float:
    return max(2e-3, assembly.scenario.run.duration / FRAMES)


def _steers(assembly: Assembly) -> bool:
    controller = assembly.components.get("controller")
    return isinstance(controller, Component) and "steer" in controller.declarations


def _grip(assembly: Assembly) -> float:
    """Return the coefficient of friction, 0 where it is not known."""
    body, wheels = assembly.components.get("body"), assembly.components.get("wheels")
    if isinstance(body, FullOrderRover):  # what is laid on has no limit
        return GRIP if body.values["laid_on"] > 0 else float(body.values["mu_s"])
    return float(np.max(wheels.values.get("mu", 0.0))) if isinstance(wheels, Component) else 0.0


def _flattening(assembly: Assembly, bot: Robot) -> float:
    """Return by how much deformations are exaggerated, so that a tyre under its share of the weight looks pressed."""
    body, load = assembly.components.get("body"), bot.m * G / 4
    if isinstance(body, FullOrderRover):
        depth = resting(body.values, body.nodes, body.points, load, _PRESSED * bot.R).depth
        return max(1.0, nice(FLAT * bot.R / depth))
    wheels = assembly.components.get("wheels")
    if not isinstance(wheels, Component) or not {"k_w", "z"} <= set(wheels.declarations):  # rigid ones have no z
        return 1.0
    return max(1.0, nice(FLAT * bot.R * float(np.max(wheels.values["k_w"])) / load))


def chassis(assembly: Assembly) -> ChassisMap | None:
    """Return the map of a flexible chassis with the stations of the default one; None for another."""
    bot = assembly.robot
    held = (assembly.components.get(name) for name in ("chassis", "body"))
    part = next((p for p in held if isinstance(p, Component) and "station_shape" in p.values), None)
    if bot is None or part is None:
        return None
    shape, frequency = part.values["station_shape"], np.ravel(part.values["frequency"])
    if len(shape) != ROWS * COLUMNS:
        return None
    limit, factor = scales(frequency, shape, part.values["wheel_shape"], np.full(4, bot.m * G / 4))
    return ChassisMap(
        ROWS, COLUMNS, bot.L_f + bot.L_r, 2 * bot.half_track, frequency, shape, limit, factor, _interval(assembly)
    )


def _at_centre(body: Component | str | None) -> bool:
    """Return whether traction acts at the wheels' centres, not at the ground."""
    return isinstance(body, Component) and body.structure.get("traction_arm") == "centre"


def gap_mismatch(instances: dict[str, Instance]) -> Any:
    """Compare the deformation that the wheels ended with to the gap of the body: one quantity, computed twice."""
    wheels, body = instances.get("wheels"), instances.get("body")
    if wheels is None or body is None or "deformation" not in wheels.y_at or "gap" not in body.y_at:
        return None

    def health(read: Read) -> dict[str, np.ndarray]:
        mine, its = read("wheels.deformation"), read("body.gap")
        assert mine is not None
        assert its is not None
        return {"gap_mismatch [m]": np.max(np.abs(mine - its), axis=1)}

    return health
