"""The full-order robot in plain NumPy: the equations of `plants.full_order` once more, vectorised over all nodes.

Written from their description, not from their code, for two uses: as the straightforward way that the compiled FMU is
timed against, and as a second opinion on what the FMU computes.  Arrays are (wheels, nodes, 3).  Traction is along the
wheels on level ground, whatever the profile.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from plants.full_order import FullOrderRover
from plants.full_order_ports import NAMES

Values = dict[str, Any]
UP, AXLE, STRAIGHT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]), np.zeros(4)


@dataclass
class NumpyRover:
    """Body, rims, rings and modes of *component*; ``state`` holds what its states hold, wheels in one array."""

    component: FullOrderRover
    state: Values

    def __post_init__(self) -> None:
        self.N, self.P = self.component.nodes, self.component.points
        self.p = {n: v if v.ndim else float(v) for n, v in self.component.values.items()}
        p, N, each = self.p, self.N, self.P // self.N
        self.length = 2 * p["R"] * np.sin(np.pi / N)
        self.mass, self.cell = p["ring_mass"] / N, self.length / each
        self.k = self.length * np.array([p["k_radial"], p["k_tangential"], p["k_tangential"]])
        self.c = self.length * np.array([p["c_radial"], p["c_tangential"], p["c_tangential"]])
        self.around = 2 * np.pi * np.arange(N) / N
        self.corners = np.array([[p["L_f"] if k < 2 else -p["L_r"], p["half_track"] * (1 - 2 * (k % 2)), -p["h"]]
                                 for k in range(4)])  # fmt: skip
        self.weights = np.array([_weights(N, m / each) for m in range(each)])

    def attitude(self, q: np.ndarray, H: np.ndarray, spin: np.ndarray, Z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return rotation (3, 3) and angular velocity (3,) in body axes, for wheels with the axes *Z* (4, 3, 3)."""
        R = Rotation.from_quat(q[[1, 2, 3, 0]]).as_matrix()
        return R, (R.T @ H - self.p["J_w"] * spin @ Z[:, :, 1]) / self.p["inertia"]

    def begin(self, steer: np.ndarray = STRAIGHT, span: float = 1.0) -> None:
        """Do what happens first thing in a communication step of *span* (s): wheels set out for *steer* (4,)."""
        s = self.state
        sums = ("normal_sum", "traction_sum", "lateral_sum", "sliding_sum", "axle_sum", "elapsed")
        most = self.p["steer_speed"]
        s |= {n: np.zeros_like(s[n]) for n in sums} | {
            "steer_rate": np.clip((steer - s["steered"]) / span, -most, most)
        }
        s |= {"q": s["q"] / np.linalg.norm(s["q"]), "v_begun": s["v"], "modal_begun": s["modal_rate"]}
        s["rate_begun"] = self.attitude(s["q"], s["H"], s["spin"], _axes(s["steered"]))[1]

    def step(self, t: float, dt: float, torque: np.ndarray) -> None:
        """Take one micro step of *dt* from *t* (s) with *torque* (4,) on the rims."""
        s, p, h = self.state, self.p, dt / 2
        w = 2 * np.pi * p["frequency"]
        _, omega = self.attitude(s["q"], s["H"], s["spin"], _axes(s["steered"]))
        q = _turned(s["q"], omega * h)
        r, bend, x = s["r"] + h * s["v"], s["modal_q"] + h * s["modal_rate"], s["x"] + h * s["v_ring"]
        angle = s["angle"] + h * (s["spin"] - _axes(s["steered"])[:, :, 1] @ omega)

        Z = _axes(s["steered"] + h * s["steer_rate"])
        R, omega = self.attitude(q, s["H"], s["spin"], Z)
        arms = self.corners + np.outer(p["wheel_shape"] @ bend, UP)
        hub_v = s["v"] + (np.cross(omega, arms) + np.outer(p["wheel_shape"] @ s["modal_rate"], UP)) @ R.T
        d, f, f_c = self._ring(R @ Z, omega @ Z, r + arms @ R.T, hub_v, s["spin"], angle, x, s["v_ring"])
        normal, tangential, z, sums = self.on_nodes(x, s["v_ring"], s["z"], dt)
        moment = -np.cross(d, f).sum(axis=1)
        hub, on_body = (np.einsum("wij,wj->wi", Z, a) for a in (-f.sum(axis=1), moment))
        risen = np.clip(t + h, 0, p["gravity_time"]) / p["gravity_time"] if p["gravity_time"] else 1.0
        down = -UP * p["g"] * (1 - np.cos(np.pi * risen)) / 2

        v = s["v"] + dt * (R @ hub.sum(axis=0) / p["m"] + down)
        H = s["H"] + dt * R @ (np.cross(arms, hub) + on_body).sum(axis=0)
        spin = s["spin"] + dt * (torque + moment[:, 1]) / p["J_w"]
        rate = s["modal_rate"] + dt * (p["wheel_shape"].T @ hub[:, 2] - 2 * p["damping"] * w * s["modal_rate"]
                                       - w**2 * bend)  # fmt: skip
        v_ring = s["v_ring"] + dt * ((f @ np.swapaxes(R @ Z, 1, 2) + normal + tangential) / self.mass + down)

        _, end = self.attitude(q, H, spin, Z)
        self._account(dt, R, Z, arms, omega, end, r, x, (v, v_ring, spin, rate), z, (f_c, d, moment), normal,
                      tangential, torque, down)  # fmt: skip
        s |= {"r": r + h * v, "q": _turned(q, end * h), "v": v, "H": H, "spin": spin, "x": x + h * v_ring,
              "v_ring": v_ring, "z": z, "angle": angle + h * (spin - Z[:, :, 1] @ end), "modal_q": bend + h * rate,
              "modal_rate": rate, "pressing": sums[:, 0], "elapsed": s["elapsed"] + dt,
              "steered": s["steered"] + dt * s["steer_rate"],
              "push": np.linalg.norm(normal, axis=2), "pull": np.linalg.norm(tangential, axis=2)}  # fmt: skip
        sums[:, 1:3] = _headed(R @ Z, sums[:, 1:3])
        for i, name in enumerate(("normal_sum", "traction_sum", "lateral_sum", "sliding_sum")):
            s[name] = s[name] + dt * sums[:, i]
        s["axle_sum"] = s["axle_sum"] + dt * hub

    def _ring(self, W: Any, omega: Any, hub: Any, hub_v: Any, spin: Any, angle: Any, x: Any, v: Any) -> tuple:
        """Return places of the nodes from the hubs, forces on them, and those of dampers, in the axes *W* of wheels."""
        p = self.p
        d = (x - hub[:, None]) @ W
        turning = np.stack([omega[:, 0], spin, omega[:, 2] + self.state["steer_rate"]], 1)
        rate = (v - hub_v[:, None]) @ W - np.cross(turning[:, None], d)
        sine, cosine = (g(angle[:, None] + self.around) for g in (np.sin, np.cos))
        zero = np.zeros_like(sine)
        axes = np.stack([np.stack([sine, zero, cosine], 2), np.stack([cosine, zero, -sine], 2),
                         np.broadcast_to(AXLE, (4, self.N, 3))], 2)  # fmt: skip
        off = np.einsum("wnai,wni->wna", axes, d) - np.array([p["R"], 0, 0])
        f_c = -np.einsum("wna,wnai->wni", self.c * np.einsum("wnai,wni->wna", axes, rate), axes)
        f = f_c - np.einsum("wna,wnai->wni", self.k * off, axes)
        f[:, :, [0, 2]] += self._bent(d[:, :, [0, 2]])
        return d, f, f_c

    def _bent(self, plane: np.ndarray) -> np.ndarray:
        """Return the forces (4, N, 2) of stretching and bending."""
        l0, p = self.length, self.p
        on = np.roll(plane, -1, axis=1) - plane
        back = np.roll(on, 1, axis=1)
        length = np.linalg.norm(on, axis=2, keepdims=True)
        tension = p["EA"] / l0 * (length - l0) / length * on
        sine = (back[..., 1] * on[..., 0] - back[..., 0] * on[..., 1]) / l0**2
        moment = (p["EI"] / l0 * (sine - np.sin(2 * np.pi / self.N)) / l0**2)[..., None]
        by_back = moment * np.stack([-on[..., 1], on[..., 0]], 2)
        by_on = moment * np.stack([back[..., 1], -back[..., 0]], 2)
        here = tension - by_back + by_on
        return here + np.roll(by_back, -1, axis=1) + np.roll(-tension - by_on, 1, axis=1)

    def on_nodes(self, x: np.ndarray, v: np.ndarray, z: np.ndarray, dt: float) -> tuple:
        """Return normal forces and friction (4, N, 3) on the nodes, the bristles at the end, and sums per wheel."""
        p = self.p
        four = [np.stack([np.roll(a, -i, axis=1) for i in (-1, 0, 1, 2)], 2) for a in (x, v)]
        at, rate = (np.einsum("mi,wnij->wnmj", self.weights, a).reshape(4, self.P, 3) for a in four)
        rows = np.stack([self._rows(k, at[k, :, 0]) for k in range(4)])
        (a, ra), (b, rb), (c, rc) = (_distance(rows[..., i : i + 4], at) for i in (1, 5, 9))
        bc, rbc = np.maximum(b, c), np.where(b > c, rb, rc)
        gap, slope = np.minimum(a, bc), np.where(a < bc, ra, rbc)
        root = np.sqrt(1 + slope**2)
        normal = np.stack([-slope / root, 0 * slope, 1 / root], 2)
        along = np.stack([1 / root, 0 * slope, slope / root], 2)
        F = self.cell * p["k_contact"] * np.maximum(0, -gap)
        slip = np.stack([np.einsum("wpi,wpi->wp", along, rate), rate[..., 1]], 2)
        mu = p["mu_d"] + (p["mu_s"] - p["mu_d"]) * np.exp(-np.linalg.norm(slip, axis=2) / p["v_slip"])
        wish = z + slip * dt
        pull = self.cell * p["k_bristle"] * np.linalg.norm(wish, axis=2)
        new = wish * np.minimum(1, mu * F / np.maximum(pull, 1e-300))[..., None]
        slides = np.where(mu * F < pull, F, 0.0)
        f = -self.cell * p["k_bristle"] * new
        friction = f[..., :1] * along + f[..., 1:] * AXLE
        sums = np.stack([F.sum(axis=1), f[..., 0].sum(axis=1), f[..., 1].sum(axis=1), slides.sum(axis=1)], 1)
        return self._shared(F[..., None] * normal), self._shared(friction), new, sums

    def _shared(self, force: np.ndarray) -> np.ndarray:
        """Return forces (4, P, 3) on the points as forces (4, N, 3) on the nodes."""
        by = np.einsum("mi,wnmj->wnij", self.weights, force.reshape(4, self.N, -1, 3))
        total: np.ndarray = sum(np.roll(by[:, :, j], i, axis=1) for j, i in enumerate((-1, 0, 1, 2)))
        return total

    def _rows(self, k: int, x: np.ndarray) -> np.ndarray:
        table = self.p["ground_left" if k % 2 == 0 else "ground_right"]
        return np.asarray(table[np.maximum(0, np.searchsorted(table[:, 0], x, side="right") - 1)])

    def _account(self, dt: float, R: Any, Z: Any, arms: Any, omega: Any, end: Any, r: Any, x: Any, after: tuple, z: Any,
                 inside: tuple, normal: Any, tangential: Any, torque: Any, down: Any) -> None:  # fmt: skip
        """Add work and impulse of this step to those since the start."""
        s, p, (v, v_ring, spin, modal_rate), (f_c, d, moment) = self.state, self.p, after, inside
        turns, rate, mean = (omega + end) / 2, (s["v"] + v) / 2, (s["v_ring"] + v_ring) / 2
        lift = p["wheel_shape"] @ (s["modal_rate"] + modal_rate) / 2
        hub = np.einsum("wj,wji->wi", R.T @ rate + np.cross(turns, arms) + np.outer(lift, UP), Z)
        aside, axle = turns @ Z[:, :, 0].T, turns @ Z[:, :, 1].T  # along the heading of each wheel, and its axle
        rim = np.stack([aside, (s["spin"] + spin) / 2, turns[2] + s["steer_rate"]], 1)
        damped = -np.sum(f_c * (mean @ R @ Z)) + np.sum(f_c.sum(1) * hub) + np.sum(np.cross(d, f_c).sum(1) * rim)
        w = 2 * np.pi * p["frequency"]
        damped += np.sum(2 * p["damping"] * w * s["modal_rate"] * (s["modal_rate"] + modal_rate) / 2)
        stored = self.cell * p["k_bristle"] * (np.sum(z**2) - np.sum(s["z"] ** 2)) / 2
        outside = normal + tangential + self.mass * down
        s["damped"] += dt * damped
        s["slid"] -= dt * np.sum(tangential * mean) + stored
        s["fallen"] += dt * (down @ (p["m"] * rate + self.mass * mean.sum((0, 1))))
        s["worked"] += dt * np.sum(torque * ((s["spin"] + spin) / 2 - axle))
        held = p["J_w"] * (s["spin"] + spin) / 2 * aside - moment[:, 2]  # torque that holds the steering angle
        s["worked"] += dt * np.sum(held * s["steer_rate"])
        s["impulse"] = s["impulse"] + dt * (p["m"] * down + outside.sum((0, 1)))
        s["twist"] = s["twist"] + dt * (np.cross(r, p["m"] * down) + np.cross(x, outside).sum((0, 1)))


def wheels_apart(state: Values) -> Values:
    """Return *state* under the names of the component's states."""
    found = {n: v for n, v in state.items() if n not in ("x", "v_ring", "z")}
    for k, name in enumerate(NAMES):
        found |= {f"x_{name}": state["x"][k], f"v_{name}": state["v_ring"][k], f"z_{name}": state["z"][k]}
    return found


def numpy_rover(component: FullOrderRover, starts: Values) -> NumpyRover:
    """Return *component* in NumPy with the start values *starts*, under the names of the component's states."""
    full = {
        b.name: np.array(np.broadcast_to(starts.get(b.name, component.variables[b.name].start), b.shape), float)
        for b in component.equations.states
    }
    state = {n: v for n, v in full.items() if n[:2] not in ("x_", "z_") and n[-3:] not in [f"_{k}" for k in NAMES]}
    for many, one in (("x", "x"), ("v_ring", "v"), ("z", "z")):
        state[many] = np.stack([full[f"{one}_{name}"] for name in NAMES])
    return NumpyRover(component, state)


def _weights(nodes: int, at: float) -> np.ndarray:
    """Return weights (4,) of the nodes -1, 0, 1, 2: exact for lines and for the circle through the nodes."""
    angles = 2 * np.pi / nodes * np.array([-1, 0, 1, 2, at])
    shapes = np.array([np.ones(5), angles, np.cos(angles), np.sin(angles)])
    return np.asarray(np.linalg.solve(shapes[:, :4], shapes[:, 4]))


def _turned(q: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Return *q* (w, x, y, z) after turning by *angle* (3,) in body axes."""
    turned = Rotation.from_quat(q[[1, 2, 3, 0]]) * Rotation.from_rotvec(angle)
    found: np.ndarray = turned.as_quat()[[3, 0, 1, 2]]
    return found if found @ q > 0 else -found


def _headed(W: np.ndarray, friction: np.ndarray) -> np.ndarray:
    """Return *friction* (4, 2) along the road and across as along the wheels with the axes *W*, and to their left."""
    way = W[:, :2, 0] / np.linalg.norm(W[:, :2, 0], axis=1, keepdims=True)
    return np.stack([np.sum(way * friction, axis=1), way[:, 0] * friction[:, 1] - way[:, 1] * friction[:, 0]], 1)


def _axes(steered: np.ndarray) -> np.ndarray:
    """Return the axes (4, 3, 3) of steered wheels, as columns in body axes."""
    return Rotation.from_rotvec(np.outer(steered, UP)).as_matrix()


def _distance(face: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return signed distance (m) of points (..., 3) from parabolas (..., 4), and their slope there."""
    u = at[..., 0] - face[..., 0]
    slope = face[..., 2] + 2 * face[..., 3] * u
    return (at[..., 2] - face[..., 1] - face[..., 2] * u - face[..., 3] * u**2) / np.sqrt(1 + slope**2), slope
