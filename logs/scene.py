"""The run in space: both tracks as driven over, the body, four turning wheels, contact forces, and where wheels flew.

Read from the ports of a rover; a run without them has no scene.  Drawn at a reduced rate: plots show every step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import rerun as rr

Read = Callable[[str], "np.ndarray | None"]
WHEELS = ("fl", "fr", "rl", "rr")
FORCE_SCALE = 5e-4  # m per N: 1 kN is half a metre
MARKS_BELOW = 4000  # marks of contact loss that a scene holds
GROUND, TYRE, BODY = (120, 110, 95), (45, 45, 50), (90, 140, 190)
NORMAL, TRACTION, FLIGHT = (60, 170, 80), (240, 128, 32), (214, 40, 40)


@dataclass
class Scene:
    """What is drawn: dimensions in m, and the ground of both tracks as points (n, 2) of x and height."""

    R: float
    half_track: float
    L_f: float
    L_r: float
    h: float
    left: np.ndarray
    right: np.ndarray
    interval: float = 2e-3  # s between frames
    root: str = "world"
    tint: tuple[int, int, int] | None = None  # colour of the body, to tell robots apart
    _last: int = field(default=-(2**62), repr=False)
    _spin: np.ndarray = field(default_factory=lambda: np.zeros(4), repr=False)
    _spin_ns: int = field(default=0, repr=False)
    _marks: int = field(default=0, repr=False)

    def started(self, recording: Any) -> None:
        """Draw what does not move."""
        log = lambda path, *what: recording.log(f"{self.root}/{path}", *what, static=True)  # noqa: E731
        recording.log(self.root, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for side, sign, points in (("left", 1, self.left), ("right", -1, self.right)):
            inner, outer = sign * 0.02, sign * (self.half_track + 0.12)
            log(f"ground/{side}", _strip(points, min(inner, outer), max(inner, outer)))
        size = [(self.L_f + self.L_r) / 2 + 0.05, max(self.half_track - 0.06, 0.05), max(self.h / 3, 0.05)]
        middle = [(self.L_f - self.L_r) / 2, 0, -self.h / 3]
        log(
            "robot/body/hull",
            rr.Boxes3D(half_sizes=[size], centers=[middle], colors=[self.tint or BODY], fill_mode="solid"),
        )
        for wheel in WHEELS:
            log(
                f"robot/wheel_{wheel}/tyre",
                rr.Cylinders3D(lengths=[0.06], radii=[self.R], colors=[TYRE], fill_mode="solid"),
            )
            log(
                f"robot/wheel_{wheel}/spoke",
                rr.Boxes3D(half_sizes=[[self.R * 0.9, 0.012, 0.034]], colors=[(220, 220, 225)], fill_mode="solid"),
            )

    def emit(self, recording: Any, ns: np.ndarray, step: np.ndarray, read: Read) -> None:
        """Draw the frames of one chunk; *read* gives a port's values in it, (n, ...)."""
        position, q, centres = read("body.position"), read("body.orientation"), read("body.wheel_centre")
        if position is None or q is None or centres is None:
            return
        spin = self._turned(ns, read("body.contact_velocity"))
        frames = self._frames(ns)
        if not len(frames):
            return
        index = [rr.TimeColumn("sim_time", duration=ns[frames].astype("timedelta64[ns]")),
                 rr.TimeColumn("step", sequence=step[frames])]  # fmt: skip
        send = lambda path, columns: recording.send_columns(f"{self.root}/{path}", index, columns)  # noqa: E731
        xyzw = q[frames][:, [1, 2, 3, 0]]
        send("robot/body", rr.Transform3D.columns(translation=position[frames], quaternion=xyzw))
        for k, wheel in enumerate(WHEELS):
            turned = _quaternion_product(q[frames], _about_y(spin[frames, k]))
            axle = _quaternion_product(
                turned, np.tile([np.sqrt(0.5), np.sqrt(0.5), 0, 0], (len(frames), 1))
            )  # axis z to y
            send(
                f"robot/wheel_{wheel}",
                rr.Transform3D.columns(translation=centres[frames, k], quaternion=axle[:, [1, 2, 3, 0]]),
            )
        self._forces(send, frames, centres, read)
        self._flights(recording, ns, centres, read)

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

    def _forces(self, send: Callable[[str, Any], None], frames: np.ndarray, centres: np.ndarray, read: Read) -> None:
        for what, size, direction, colour in (
            ("normal", read("wheels.normal_force"), read("body.contact_normal"), NORMAL),
            ("traction", read("wheels.traction"), read("body.traction_direction"), TRACTION),
        ):
            normals = read("body.contact_normal")
            if size is None or direction is None or normals is None:
                continue
            n = len(frames)
            origins = centres[frames] - self.R * normals[frames]
            arrows = FORCE_SCALE * size[frames][:, :, None] * direction[frames]
            send(f"forces/{what}", rr.Arrows3D.columns(
                origins=origins.reshape(-1, 3), vectors=arrows.reshape(-1, 3), colors=[colour] * (4 * n),
                radii=[0.012] * (4 * n),
            ).partition(np.full(n, 4)))  # fmt: skip

    def _flights(self, recording: Any, ns: np.ndarray, centres: np.ndarray, read: Read) -> None:
        """Mark the ground below a wheel in the air."""
        gap = read("body.gap")
        if gap is None or self._marks > MARKS_BELOW:
            return
        frame, wheel = np.nonzero(gap > 1e-9)
        keep = slice(None, None, max(1, len(frame) // 200))
        points = centres[frame[keep], wheel[keep]]
        if not len(points):
            return
        points = points - np.array([0, 0, 1]) * (self.R + gap[frame[keep], wheel[keep]][:, None])
        self._marks += len(points)
        recording.log(
            f"{self.root}/flights/{int(ns[0])}", rr.Points3D(points, colors=[FLIGHT], radii=[0.008]), static=True
        )


def _strip(points: np.ndarray, y0: float, y1: float) -> rr.Mesh3D:
    n = len(points)
    vertices = np.empty((2 * n, 3))
    vertices[0::2] = np.column_stack([points[:, 0], np.full(n, y0), points[:, 1]])
    vertices[1::2] = np.column_stack([points[:, 0], np.full(n, y1), points[:, 1]])
    first = np.arange(0, 2 * n - 2, 2)
    triangles = np.concatenate(
        [np.column_stack([first, first + 2, first + 1]), np.column_stack([first + 1, first + 2, first + 3])]
    )
    bands = np.where(np.floor(vertices[:, 0] / 0.1) % 2 == 0, 1.0, 0.88)  # 10 cm bands give a sense of distance
    colours = (np.array(GROUND)[None] * bands[:, None]).astype(np.uint8)
    return rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles, vertex_colors=colours)


def _about_y(angle: np.ndarray) -> np.ndarray:
    zero = np.zeros_like(angle)
    return np.column_stack([np.cos(angle / 2), zero, np.sin(angle / 2), zero])


def _quaternion_product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    w, v, s, u = a[:, :1], a[:, 1:], b[:, :1], b[:, 1:]
    return np.column_stack([w * s - np.sum(v * u, axis=1, keepdims=True), w * u + s * v + np.cross(v, u)])
