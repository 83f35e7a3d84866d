"""The run in space: tracks as driven over, the body, wheels that turn, steer and flatten, forces, where wheels flew.

Read from the ports of a rover; a run without them has no scene.  Drawn at a reduced rate: plots show every step.
Nothing is kept but the last frame, however long the run is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import rerun as rr

from cosim.system import System

from . import tyre
from .drawing import Drawing, Frames, Read, summed
from .ports import index
from .rotation import matrices, quaternions
from .style import WHEELS, Colour, pale

LEFT = np.array([1.0, -1.0, 1.0, -1.0])  # which side of the body a wheel is on, y to the left
LONGEST = 8.0  # arrow, in radii of a wheel
MARK_EVERY = 5e-3  # m of way between two marks below a flying wheel
_AHEAD = 128  # steps that are looked at for the next one
GROUND, TYRE, SPOKE = (150, 138, 118), (48, 48, 54), (220, 220, 225)
BODY, DECK, NOSE = (90, 140, 190), (70, 74, 80), (250, 240, 170)
NORMAL, TRACTION, FLIGHT = (70, 200, 95), (250, 150, 40), (230, 45, 45)
LIMIT = (250, 220, 160)


Send = Callable[[str, Any], None]


@dataclass
class Scene(Drawing):
    """What is drawn: dimensions in m, and the ground of both tracks as points (n, 2) of x and height.

    *L_f*, *L_r* are the distances of the axles from the centre of mass, *h* its height above the ground;
    *force_scale* is the length of a force's arrow in m per N; no arrow is longer than LONGEST radii of a wheel.
    *flattening* exaggerates the deformation of the tyres (see `tyre`), *shoulder* is the ground beside the tracks in m;
    *limited* tells whether friction has a limit worth drawing, *at_centre* whether what acts along the ground acts at
    the centres of the wheels.
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
    flattening: float = 1.0
    limited: bool = True
    at_centre: bool = False
    shoulder: float = 0.3
    root: str = "world"
    _frames: Frames = field(init=False, repr=False)
    _spin: np.ndarray = field(default_factory=lambda: np.zeros(4), repr=False)
    _spin_ns: int = field(default=0, repr=False)
    _marked: np.ndarray = field(default_factory=lambda: np.full(4, -np.inf), repr=False)

    def started(self, recording: Any, system: System) -> None:
        """Draw what does not move."""

        def log(path: str, *what: Any) -> None:
            recording.log(f"{self.root}/{path}", *what, static=True)

        self._frames = Frames(self.interval)
        recording.log(self.root, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for side, sign, points in (("left", 1, self.left), ("right", -1, self.right)):
            inner, outer = sign * 0.02, sign * (self.half_track + self.shoulder)
            log(f"ground/{side}", _strip(points, min(inner, outer), max(inner, outer), band=self.R))
        for part, (centre, half, paint) in self._body().items():
            log(
                f"robot/body/{part}", rr.Boxes3D(half_sizes=[half], centers=[centre], colors=[paint], fill_mode="solid")
            )
        half = [self.R * 0.75, self._width * 0.57, self.R * 0.1]
        for wheel in WHEELS:
            log(f"robot/wheel_{wheel}/spoke", rr.Boxes3D(half_sizes=[half], colors=[SPOKE], fill_mode="solid"))
        self._tyres(log)

    def _tyres(self, log: Any) -> None:
        """Draw what of the tyres does not change."""
        mesh = rr.Mesh3D.from_fields(
            triangle_indices=tyre.triangles(), vertex_normals=tyre.normals(), albedo_factor=TYRE
        )
        for wheel in WHEELS:
            log(f"robot/wheel_{wheel}/tyre", mesh)

    @property
    def caption(self) -> str:
        """What a reader of the scene must know to read it."""
        longest = LONGEST * self.R / self.force_scale / 1e3  # kN
        colours = f"normal green, along ground orange, limit pale, to {longest:.2g} kN; flew red"
        return colours if self.flattening == 1 else f"{colours}; tyre flats x{self.flattening:g}"

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
        normals = read("body.contact_normal")
        if position is None or q is None or centres is None or normals is None:
            return
        spin = self._turned(ns, read("body.contact_velocity"))
        self._flights(recording, ns, step, centres, read("body.gap"))
        frames = self._frames.of(ns)
        if not len(frames):
            return

        def send(path: str, columns: Any) -> None:
            recording.send_columns(f"{self.root}/{path}", index(ns[frames], step[frames]), columns)

        quaternion = q[frames]
        send("robot/body", rr.Transform3D.columns(translation=position[frames], quaternion=_scalar_last(quaternion)))
        steer = read("body.steer")
        axles = _axles(quaternion, None if steer is None else steer[frames])
        self._wheels(send, centres[frames], _upright(axles, normals[frames]), spin[frames], _at(frames, read))
        self._forces(send, centres[frames], axles, _at(frames, read))

    def _wheels(self, send: Send, centres: np.ndarray, upright: np.ndarray, spin: np.ndarray, read: Read) -> None:
        """Draw the wheels: the frame of each along its ground, in it the flattened tyre and the turning spoke."""
        for k, wheel in enumerate(WHEELS):
            turned = _scalar_last(quaternions(upright[:, k]))
            send(f"robot/wheel_{wheel}", rr.Transform3D.columns(translation=centres[:, k], quaternion=turned))
            about = np.zeros((len(spin), 4))
            about[:, 1], about[:, 3] = np.sin(spin[:, k] / 2), np.cos(spin[:, k] / 2)
            send(f"robot/wheel_{wheel}/spoke", rr.Transform3D.columns(quaternion=about))
            self._shape(send, k, len(centres), read)

    def _shape(self, send: Send, wheel: int, n: int, read: Read) -> None:
        """Draw a tyre in *n* frames."""
        deformation = read("wheels.deformation")
        pressed = np.zeros(n) if deformation is None else np.maximum(0.0, -deformation[:, wheel])
        vertices = tyre.shape(self.R, self._width, pressed, self.flattening)
        columns = rr.Mesh3D.columns(vertex_positions=vertices.reshape(-1, 3))
        send(f"robot/wheel_{WHEELS[wheel]}/tyre", columns.partition(np.full(n, vertices.shape[1])))

    def _turned(self, ns: np.ndarray, velocity: np.ndarray | None) -> np.ndarray:
        """Return the angles the wheels have rolled, (n, 4), as if without slip."""
        if velocity is None:
            return np.zeros((len(ns), 4))
        dt = np.diff(ns, prepend=self._spin_ns) * 1e-9
        angles = summed(self._spin, velocity[:, :, 0] / self.R * dt[:, None])
        self._spin, self._spin_ns = angles[-1], int(ns[-1])
        return angles

    def _forces(self, send: Send, centres: np.ndarray, axles: np.ndarray, read: Read) -> None:
        """Draw the forces of the ground on the wheels, from where they act, beside the tyre that would hide them."""
        normals, ahead = np.asarray(read("body.contact_normal")), read("body.traction_direction")
        beside = centres + LEFT[None, :, None] * axles * (0.6 * self._width)
        foot = beside - self.R * normals
        n = len(foot)

        def arrows(what: str, force: np.ndarray, paint: Colour, radius: float, aside: float = 0.0) -> None:
            vectors = self.force_scale * force
            size = np.linalg.norm(vectors, axis=2, keepdims=True)
            vectors = vectors * np.minimum(1.0, LONGEST * self.R / np.maximum(size, 1e-12))
            origins = (beside if self.at_centre and what != "normal" else foot) + LEFT[None, :, None] * axles * aside
            send(f"forces/{what}", rr.Arrows3D.columns(
                origins=origins.reshape(-1, 3), vectors=vectors.reshape(-1, 3), colors=[paint] * (4 * n),
                radii=[radius * self.R] * (4 * n),
            ).partition(np.full(n, 4)))  # fmt: skip

        normal, traction, lateral, limit = (
            read(f"wheels.{port}") for port in ("normal_force", "traction", "lateral", "friction_limit")
        )
        if normal is not None:
            arrows("normal", normal[:, :, None] * normals, NORMAL, 0.14)
        if traction is None or ahead is None:
            return
        along = traction[:, :, None] * ahead
        if lateral is not None:
            along = along + lateral[:, :, None] * np.cross(normals, ahead)
        arrows("traction", along, TRACTION, 0.14)
        if limit is not None and self.limited:
            size = np.linalg.norm(along, axis=2, keepdims=True)
            way = np.where(size > 1e-9, along / np.maximum(size, 1e-9), ahead)  # where it would act
            arrows("limit", limit[:, :, None] * way, LIMIT, 0.06, aside=0.3 * self.R)

    def _flights(
        self, recording: Any, ns: np.ndarray, step: np.ndarray, centres: np.ndarray, gap: np.ndarray | None
    ) -> None:
        """Mark the ground below a wheel in the air, once per so much way; one mark at least for every flight."""
        if gap is None:
            return
        found = sorted((i, k) for k in range(len(WHEELS)) for i in self._marks(k, gap[:, k] > 1e-9, centres[:, k, 0]))
        rows, wheels = (np.array(n, int) for n in zip(*found, strict=True)) if found else (np.zeros(0, int),) * 2
        points = centres[rows, wheels] - np.array([0, 0, 1]) * (self.R + gap[rows, wheels])[:, None]
        if len(points):
            marks = rr.Points3D.columns(
                positions=points, colors=[FLIGHT] * len(points), radii=[0.1 * self.R] * len(points)
            )
            recording.send_columns(f"{self.root}/flights", index(ns[rows], step[rows]), marks)

    def _marks(self, k: int, flying: np.ndarray, x: np.ndarray) -> Iterator[int]:
        """Yield the rows at which wheel *k* is marked, and keep where it was last: -inf while it is on the ground."""
        edges = np.flatnonzero(np.diff(flying, prepend=False, append=False))
        for begin, end in edges.reshape(-1, 2):
            if begin:  # else the flight may have begun in the rows before
                self._marked[k] = -np.inf
            while begin < end:
                far = np.abs(x[begin : min(end, begin + _AHEAD)] - self._marked[k]) >= MARK_EVERY
                if far.any():
                    begin += int(np.argmax(far))
                    self._marked[k] = x[begin]
                    yield begin
                else:
                    begin += len(far)
        if not flying[-1]:
            self._marked[k] = -np.inf


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
            wheels[f"robot/wheel_{wheel}/tyre"] = rr.Mesh3D.columns(
                albedo_factor=[(*colour, 0)]
            )  # two discs in one place would flicker
            wheels[f"robot/wheel_{wheel}/spoke"] = rr.Boxes3D.columns(colors=[colour])
    for wheel in WHEELS:
        wheels[f"robot/ring_{wheel}"] = rr.LineStrips3D.columns(colors=[colour])
    forces = {f"forces/{what}": rr.Arrows3D.columns(colors=[colour]) for what in ("normal", "traction", "friction")}
    forces["forces/limit"] = rr.Arrows3D.columns(colors=[pale(colour)])
    return {**body, **wheels, **forces, "flights": rr.Points3D.columns(colors=[colour])}


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


def _at(frames: np.ndarray, read: Read) -> Read:
    """Return what *read* gives, at *frames* only."""

    def chosen(port: str) -> np.ndarray | None:
        values = read(port)
        return None if values is None else values[frames]

    return chosen


def _scalar_last(quaternion: np.ndarray) -> np.ndarray:
    """Return quaternions (n, 4) as Rerun writes them."""
    return quaternion[:, [1, 2, 3, 0]]


def _axles(quaternion: np.ndarray, steer: np.ndarray | None) -> np.ndarray:
    """Return the axle of each wheel in the world, (n, 4, 3), to the left, for attitudes (n, 4)."""
    angle = np.zeros((len(quaternion), 4)) if steer is None else steer
    local = np.stack([-np.sin(angle), np.cos(angle), np.zeros_like(angle)], axis=2)
    turned: np.ndarray = np.einsum("nij,nkj->nki", matrices(quaternion), local)
    return turned


def _upright(axles: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return rotations (n, 4, 3, 3) that turn y to the axle and z to the normal of the ground, across the axle."""
    up = normals - np.sum(normals * axles, axis=2, keepdims=True) * axles
    up /= np.linalg.norm(up, axis=2, keepdims=True)
    return np.stack([np.cross(axles, up), axles, up], axis=3)
