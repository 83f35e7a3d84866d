"""Wheel-centre paths written by hand, and rigid bodies placed on them, without any ground profile."""

import numpy as np

from cosim.twin import PythonInstance
from plants.contact import COLUMNS
from plants.planar import Posture
from plants.rigid_body import RigidBody

R = 0.1  # m, radius of the wheels and height of the level path
TIGHT = 1e-12  # relative tolerance of the integration wherever differences of its results are taken


def curve(*coefficients: float) -> list[list[float]]:
    """Return the table of one smooth path, the polynomial with the given coefficients in world x."""
    return [_row(-1e9, 0.0, coefficients, coefficients, 0.0)]


def kink(x: float, before: float, after: float, height: float = R) -> list[list[float]]:
    """Return the table of two straight faces that meet at x (m) with the given angles (rad)."""
    return [_row(-1e9, x, (height, np.tan(before)), (height, np.tan(after)), 1.0)]


def _row(start: float, x: float, a: tuple[float, ...], b: tuple[float, ...], parity: float) -> list[float]:
    row = [start, *(v for face in (a, b) for v in (x, *face, *[0.0] * (6 - len(face)))), parity]
    assert len(row) == COLUMNS
    return row


def turned(angle: float, axis: int) -> np.ndarray:
    """Return the quaternion of a rotation by *angle* (rad) about a body axis."""
    q = np.zeros(4)
    q[0], q[1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
    return q


def matrix(q: np.ndarray) -> np.ndarray:
    """Return the rotation of a unit quaternion, body to world, element by element as in the textbooks."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def placed(component: RigidBody, tolerance: float = TIGHT, **values: object) -> PythonInstance:
    """Return an instance ready to step, with the given states and inputs."""
    instance = component.instance("body")
    for name, value in values.items():
        instance.set(name, np.asarray(value, float))
    instance.enter_initialization(0, None, tolerance)
    instance.exit_initialization()
    return instance


def on_two_slopes(at: Posture, twist: np.ndarray, **parameters: object) -> PythonInstance:
    """Return a body whose front and rear wheels are over the two faces of a kink, moving in the plane."""
    path = kink(0.05, float(at.rear), float(at.front))
    component = RigidBody(left=path, right=path, **parameters)
    q = turned(-float(at.pitch), axis=1)
    velocity = matrix(q) @ [twist[0], 0.0, twist[1]]
    return placed(component, r=[0.0, 0.0, 0.5], q=q, v=velocity, omega=[0.0, twist[2], 0.0])


def sampled(instance: PythonInstance, names: tuple[str, ...], steps: int, step: float) -> dict[str, np.ndarray]:
    """Step with held inputs and return outputs at every communication point, the first included."""
    rows: dict[str, list[np.ndarray]] = {name: [] for name in names}
    ticks = round(step * 1e9)
    for k in range(steps + 1):
        if k:
            instance.step((k - 1) * ticks, k * ticks)
        for name in names:
            rows[name].append(np.array(instance.get(name)))
    return {name: np.array(values) for name, values in rows.items()}


def slope_of(samples: np.ndarray, step: float) -> np.ndarray:
    """Return the time derivative at all but the first and last two samples; the error is step^4/30 times the fifth."""
    return (samples[:-4] - 8 * samples[1:-3] + 8 * samples[3:-1] - samples[4:]) / (12 * step)
