"""The run in space: both tracks as driven over, the body, four turning wheels, contact forces, and where wheels flew.

Read from the ports of a rover; a run without them has no scene.  Drawn at a reduced rate: plots show every step.
Nothing is kept but the last frame, however long the run is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import rerun as rr

from .style import WHEELS, Colour

Read = Callable[[str], "np.ndarray | None"]
LEFT = np.array([1.0, -1.0, 1.0, -1.0])  # which side of the body a wheel is on, y to the left
LONGEST = 15.0  # arrow, in radii of a wheel
SHOULDER = 3.0  # ground beside the track, in radii of a wheel
MARK_EVERY = 5e-3  # m of way between two marks below a flying wheel
GROUND, TYRE, SPOKE = (150, 138, 118), (48, 48, 54), (220, 220, 225)
BODY, DECK, NOSE = (90, 140, 190), (70, 74, 80), (250, 240, 170)
NORMAL, TRACTION, FLIGHT = (70, 200, 95), (250, 150, 40), (230, 45, 45)


@dataclass
class Scene:
    """What is drawn: dimensions in m, and the ground of both tracks as points (n, 2) of x and height.

    *L_f*, *L_r* are the distances of the axles from the centre of mass, *h* its height above the ground;
    *force_scale* is the length of a force's arrow in m per N; no arrow is longer than LONGEST radii of a wheel.
    """

    R: float
    half_track: float
    L_f: float
    L_r: float
    h: float
    left: np.ndarray
    right: np.ndarray
    force_scale: float = 5e-4
    interval: float = 2e-3  # s between frames
    root: str = "world"
    _last: int = field(default=-(2**62), repr=False)
    _spin: np.ndarray = field(default_factory=lambda: np.zeros(4), repr=False)
    _spin_ns: int = field(default=0, repr=False)
    _marked: np.ndarray = field(default_factory=lambda: np.full(4, -np.inf), repr=False)

    def started(self, recording: Any) -> None:
        """Draw what does not move."""

        def log(path: str, *what: Any) -> None:
            recording.log(f"{self.root}/{path}", *what, static=True)

        recording.log(self.root, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for side, sign, points in (("left", 1, self.left), ("right", -1, self.right)):
            inner, outer = sign * 0.02, sign * (self.half_track + SHOULDER * self.R)
            log(f"ground/{side}", _strip(points, min(inner, outer), max(inner, outer), band=self.R))
        for part, (centre, half, paint) in self._body().items():
            log(
                f"robot/body/{part}", rr.Boxes3D(half_sizes=[half], centers=[centre], colors=[paint], fill_mode="solid")
            )
        for wheel in WHEELS:
            tyre = rr.Cylinders3D(lengths=[self._width], radii=[self.R], colors=[TYRE], fill_mode="solid")
            half = [self.R * 0.9, self.R * 0.12, self._width * 0.57]
            log(f"robot/wheel_{wheel}/tyre", tyre)
            log(f"robot/wheel_{wheel}/spoke", rr.Boxes3D(half_sizes=[half], colors=[SPOKE], fill_mode="solid"))

    @property
    def _width(self) -> float:
        return 0.6 * self.R  # of a tyre

    def _body(self) -> dict[str, tuple[list[float], list[float], Colour]]:
        """Return the boxes in the frame of the body: a deck at the axles, a hull up to the centre of mass, a nose."""
        inside = max(self.half_track - self._width, 0.1 * self.half_track)
        middle, length, low = (self.L_f - self.L_r) / 2, (self.L_f + self.L_r) / 2, self.R - self.h
        top = max(0.0, low + self.R)
        hull = [middle - 0.15 * length, 0.0, (low + top) / 2 + 0.1 * self.R]
        return {
            "deck": ([middle, 0.0, low], [length + 0.3 * self.R, inside, 0.2 * self.R], DECK),
            "hull": (hull, [0.7 * length, 0.9 * inside, (top - low) / 2], BODY),
            "nose": ([self.L_f + 0.3 * self.R, 0.0, low], [0.12 * self.R, inside, 0.25 * self.R], NOSE),
        }

    def emit(self, recording: Any, ns: np.ndarray, step: np.ndarray, read: Read) -> None:
        """Draw the frames of one chunk; *read* gives a port's values in it, (n, ...)."""
        position, q, centres = read("body.position"), read("body.orientation"), read("body.wheel_centre")
        if position is None or q is None or centres is None:
            return
        spin = self._turned(ns, read("body.contact_velocity"))
        self._flights(recording, ns, step, centres, read("body.gap"))
        frames = self._frames(ns)
        if not len(frames):
            return

        def send(path: str, columns: Any) -> None:
            recording.send_columns(f"{self.root}/{path}", _index(ns[frames], step[frames]), columns)

        q = q[frames]
        send("robot/body", rr.Transform3D.columns(translation=position[frames], quaternion=_xyzw(q)))
        upright = np.tile([np.sqrt(0.5), np.sqrt(0.5), 0, 0], (len(frames), 1))  # the cylinder's z axis to the axle's y
        for k, wheel in enumerate(WHEELS):
            turned = _product(_product(q, _about_y(spin[frames, k])), upright)
            send(
                f"robot/wheel_{wheel}",
                rr.Transform3D.columns(translation=centres[frames, k], quaternion=_xyzw(turned)),
            )
        self._forces(send, frames, q, centres, read)

    def _turned(self, ns: np.ndarray, velocity: np.ndarray | None) -> np.ndarray:
        """Return the angles the wheels have rolled, (n, 4), as if without slip."""
        if velocity is None:
            return np.zeros((len(ns), 4))
        dt = np.diff(ns, prepend=self._spin_ns) * 1e-9
        angles = self._spin + np.cumsum(velocity[:, :, 0] / self.R * dt[:, None], axis=0)
        self._spin, self._spin_ns = angles[-1], int(ns[-1])
        return angles

    def _frames(self, ns: np.ndarray) -> np.ndarray:
        chosen = []
        for i, t in enumerate(ns):
            if t - self._last >= self.interval * 1e9:
                chosen.append(i)
                self._last = int(t)
        return np.array(chosen, int)

    def _forces(self, send: Callable[[str, Any], None], frames: np.ndarray, q: np.ndarray, centres: np.ndarray,
                read: Read) -> None:  # fmt: skip
        """Draw the forces of the ground on the wheels, from the contact, beside the tyre that would hide them."""
        normals = read("body.contact_normal")
        if normals is None:
            return
        n, axle = len(frames), _y_axis(q)
        beside = LEFT[None, :, None] * axle[:, None, :] * (0.6 * self._width)
        origins = centres[frames] - self.R * normals[frames] + beside
        for what, size, direction, paint in (
            ("normal", read("wheels.normal_force"), normals, NORMAL),
            ("traction", read("wheels.traction"), read("body.traction_direction"), TRACTION),
        ):
            if size is None or direction is None:
                continue
            length = np.clip(self.force_scale * size[frames], -LONGEST * self.R, LONGEST * self.R)
            arrows = length[:, :, None] * direction[frames]
            send(f"forces/{what}", rr.Arrows3D.columns(
                origins=origins.reshape(-1, 3), vectors=arrows.reshape(-1, 3), colors=[paint] * (4 * n),
                radii=[0.14 * self.R] * (4 * n),
            ).partition(np.full(n, 4)))  # fmt: skip

    def _flights(
        self, recording: Any, ns: np.ndarray, step: np.ndarray, centres: np.ndarray, gap: np.ndarray | None
    ) -> None:
        """Mark the ground below a wheel in the air, once per so much way; one mark at least for every flight."""
        if gap is None:
            return
        flying = gap > 1e-9
        rows, points = [], []
        for i in np.flatnonzero(flying.any(axis=1)):
            self._marked[~flying[i]] = -np.inf
            for k in np.flatnonzero(flying[i]):
                x, y, z = centres[i, k]
                if abs(x - self._marked[k]) >= MARK_EVERY:
                    self._marked[k] = x
                    rows.append(i)
                    points.append([x, y, z - self.R - gap[i, k]])
        if points:
            marks = rr.Points3D.columns(
                positions=points, colors=[FLIGHT] * len(points), radii=[0.1 * self.R] * len(points)
            )
            recording.send_columns(f"{self.root}/flights", _index(ns[rows], step[rows]), marks)


def painted(colour: Colour, *, ghost: bool) -> dict[str, Any]:
    """Return static columns, by entity below the scene's root, that give one robot of several its own colour.

    A *ghost* is drawn as wires, so that the robots behind it stay visible.
    """
    mode = {"fill_mode": ["majorwireframe" if ghost else "solid"]}
    body = {f"robot/body/{part}": rr.Boxes3D.columns(colors=[colour], **mode) for part in ("hull", "deck")}
    if not ghost:
        del body["robot/body/deck"]
    else:
        body["robot/body/nose"] = rr.Boxes3D.columns(colors=[colour], **mode)
    wheels: dict[str, Any] = {}
    if ghost:
        for wheel in WHEELS:
            wheels[f"robot/wheel_{wheel}/tyre"] = rr.Cylinders3D.columns(colors=[colour], **mode)
            wheels[f"robot/wheel_{wheel}/spoke"] = rr.Boxes3D.columns(colors=[colour])
    forces = {f"forces/{what}": rr.Arrows3D.columns(colors=[colour]) for what in ("normal", "traction")}
    return {**body, **wheels, **forces, "flights": rr.Points3D.columns(colors=[colour])}


def _index(ns: np.ndarray, step: np.ndarray) -> list[Any]:
    return [rr.TimeColumn("sim_time", duration=ns.astype("timedelta64[ns]")), rr.TimeColumn("step", sequence=step)]


def _strip(points: np.ndarray, y0: float, y1: float, band: float) -> rr.Mesh3D:
    n = len(points)
    vertices = np.empty((2 * n, 3))
    vertices[0::2] = np.column_stack([points[:, 0], np.full(n, y0), points[:, 1]])
    vertices[1::2] = np.column_stack([points[:, 0], np.full(n, y1), points[:, 1]])
    first = np.arange(0, 2 * n - 2, 2)
    triangles = np.concatenate(
        [np.column_stack([first, first + 2, first + 1]), np.column_stack([first + 1, first + 2, first + 3])]
    )
    bands = np.where(np.floor(vertices[:, 0] / band) % 2 == 0, 1.0, 0.88)  # give a sense of distance
    colours = (np.array(GROUND)[None] * bands[:, None]).astype(np.uint8)
    return rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles, vertex_colors=colours)


def _about_y(angle: np.ndarray) -> np.ndarray:
    zero = np.zeros_like(angle)
    return np.column_stack([np.cos(angle / 2), zero, np.sin(angle / 2), zero])


def _y_axis(q: np.ndarray) -> np.ndarray:
    """Return the body's y axis in the world, (n, 3), for quaternions (n, 4), scalar first."""
    w, x, y, z = q.T
    return np.column_stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)])


def _xyzw(q: np.ndarray) -> np.ndarray:
    return q[:, [1, 2, 3, 0]]


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    w, v, s, u = a[:, :1], a[:, 1:], b[:, :1], b[:, 1:]
    return np.column_stack([w * s - np.sum(v * u, axis=1, keepdims=True), w * u + s * v + np.cross(v, u)])
