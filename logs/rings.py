"""The scene of a robot on rubber rings: the rings as they are bent, and what the ground does to every node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import rerun as rr

from .drawing import Read
from .scene import LONGEST, NORMAL, TRACTION, Scene, Send
from .style import WHEELS

RING = (225, 205, 90)
_LEAST = 1.0  # N, an arrow is worth drawing


@dataclass
class RingScene(Scene):
    """A scene whose tyres are the rings of ``body.ring_nodes``; *flattening* exaggerates how far they are from round.

    Arrows stand at the nodes: *force_scale* is for the force on one of them.
    """

    @property
    def caption(self) -> str:
        """What a reader of the scene must know to read it."""
        longest = LONGEST * self.R / self.force_scale / 1e3  # kN
        colours = f"per node: pressure green, friction orange, to {longest:.2g} kN; flew red"
        return colours if self.flattening == 1 else f"rings bent x{self.flattening:g}; {colours}"

    def _tyres(self, log: Any) -> None:
        """Draw nothing that stands."""

    def _shape(self, send: Send, wheel: int, n: int, read: Read) -> None:
        """Draw nothing in the frame of the wheel: rings are drawn in the world."""

    def _forces(self, send: Send, centres: np.ndarray, axles: np.ndarray, read: Read) -> None:
        nodes = read("body.ring_nodes")
        if nodes is None:
            return
        at = np.stack([self._bent(nodes[:, :, 3 * k : 3 * k + 3], centres[:, k]) for k in range(4)], axis=1)
        for k, wheel in enumerate(WHEELS):
            aside = 0.5 * self._width * axles[:, k, None]
            edges = [np.concatenate([at[:, k], at[:, k, :1]], axis=1) + side * aside for side in (-1, 1)]
            strips = np.stack(edges, axis=1).reshape(-1, nodes.shape[1] + 1, 3)
            columns = rr.LineStrips3D.columns(
                strips=list(strips), colors=[RING] * len(strips), radii=[0.03 * self.R] * len(strips)
            )
            send(f"robot/ring_{wheel}", columns.partition(np.full(len(nodes), 2)))
        for what, port, paint in (("normal", "ring_normal", NORMAL), ("friction", "ring_friction", TRACTION)):
            force = read(f"body.{port}")
            if force is not None:
                self._arrows(send, f"forces/{what}", at, force, paint)

    def _bent(self, nodes: np.ndarray, centre: np.ndarray) -> np.ndarray:
        """Return nodes (n, nodes, 3) with their distance from round exaggerated."""
        away = nodes - centre[:, None]
        radius = np.linalg.norm(away, axis=2, keepdims=True)
        shown: np.ndarray = centre[:, None] + away / radius * (self.R + self.flattening * (radius - self.R))
        return shown

    def _arrows(self, send: Send, path: str, at: np.ndarray, force: np.ndarray, paint: Any) -> None:
        """Draw forces (n, nodes, 12) where the nodes *at* (n, 4, nodes, 3) are; as many arrows as there are forces."""
        vectors = force.reshape(*force.shape[:2], 4, 3).swapaxes(1, 2)
        size = np.linalg.norm(vectors, axis=3)
        shown = size > _LEAST
        length = np.minimum(self.force_scale * size, LONGEST * self.R)[shown]
        drawn = vectors[shown] * (length / size[shown])[:, None]
        columns = rr.Arrows3D.columns(origins=at[shown], vectors=drawn, colors=[paint] * len(drawn),
                                      radii=[0.04 * self.R] * len(drawn))  # fmt: skip
        send(path, columns.partition(shown.sum(axis=(1, 2))))
