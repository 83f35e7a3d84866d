"""The state space of 6.4: poles of the robot on its wheels with the equations right and as printed."""

from __future__ import annotations

import numpy as np

from controllers.state_space import impact_model
from plants.planar import Bicycle, Posture

from .claim import Claim, graded
from .impact_case import H0, H1, HARD, ROBOT, SLOPE, axles
from .printed import PrintedBicycle
from .sheet import LINES, Sheet, panels


def open_loop() -> tuple[np.ndarray, np.ndarray]:
    """Return the poles (4,), rad/s, of the wheels without control: of 6.16 with the right signs, and as printed."""
    model = axles()
    right = impact_model(model.P, model.U, HARD).poles()
    printed = impact_model(-model.P, model.U, HARD).poles()
    return np.asarray(right), np.asarray(printed)


def printed_loop() -> np.ndarray:
    """Return the poles (4,), rad/s, of the law 6.9 on the plant 6.8, both as printed: z'' + K z = v, v = ... - K z."""
    P = axles().P * HARD
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [2 * P - H0 * np.eye(2), -H1 * np.eye(2)]])
    return np.linalg.eigvals(A)


def poles_figure() -> Sheet:
    """Return the poles of the wheels: without control, controlled, and as printed."""
    right, printed = open_loop()
    groups = {
        "without control": right,
        "without control, 6.16 as printed": printed,
        "under the law 6.9": np.repeat(np.roots([1, H1, H0]), 2),
        "6.9 on 6.8, both as printed": printed_loop(),
    }
    figure, axes = panels("Poles of the wheels of Table 6.1, k = 5.6e6 N/m per axle", figsize=(8.5, 4.4))
    for (name, poles), colour, mark in zip(groups.items(), LINES, "ox^d", strict=False):
        axes[0, 0].plot(poles.real, poles.imag, mark, color=colour, label=name, fillstyle="none")
    axes[0, 0].axvline(0, color="black", linewidth=0.8)
    axes[0, 0].set(xlabel="real part / (1/s)", ylabel="imaginary part / (rad/s)")
    axes[0, 0].legend(frameon=False, fontsize=8)
    columns = {"which": np.repeat(list(groups), 4)}
    for name, part in (("real [1/s]", np.real), ("imaginary [rad/s]", np.imag)):
        columns[name] = np.concatenate([part(poles) for poles in groups.values()])
    return Sheet("Poles of the wheels of Table 6.1", columns, figure, ("right of the line a motion grows",))


def poles_claims() -> list[Claim]:
    """Return what chapter 6 says about the plant and the law of Table 6.1."""
    frequencies = Bicycle(ROBOT, "centre").frequencies(Posture(SLOPE), HARD)
    printed, loop = open_loop()[1], printed_loop()
    worst, grows = float(np.max(printed.real)), float(np.max(loop.real))
    wrong, right = PrintedBicycle(ROBOT).P(Posture(front=SLOPE)), axles().P
    return [
        Claim(
            "6.6-6.8, 6.16",
            "z'' + K z = v with K = -P k_w is the contact of a wheel of stiffness k_w",
            f"a spring that pushes has K = +P k_w and swings at {frequencies[0]:.1f} and {frequencies[1]:.1f} rad/s",
            graded(worst < 1e-6),
            {"low": float(frequencies[0]), "high": float(frequencies[1]), "as printed": worst},
            as_printed=f"it repels: real poles up to +{worst:.1f} 1/s",
        ),
        Claim(
            "6.9",
            "the control law stabilises 6.8 about the desired reference",
            f"with + K z in place of - K z: e'' + {H1:g} e' + {H0:g} e = 0",
            graded(grows < 0),
            {"as printed": grows},
            as_printed=f"the law printed on the plant printed grows with {grows:.1f} 1/s; with K = -P k_w in the law "
            "alone the two errors cancel in F_a",
        ),
        Claim(
            "4.44, used in 6.3",
            f"P_12 = {wrong[0, 1]:.5f} and P_21 = {wrong[1, 0]:.5f} 1/kg, with the fronts on 0.3 rad",
            f"{right[0, 1]:.5f} 1/kg, both: P is symmetric",
            graded(bool(np.allclose(wrong, right))),
            {"P_12": float(right[0, 1]), "P_12 as printed": float(wrong[0, 1]),
             "P_21 as printed": float(wrong[1, 0])},
        ),
    ]  # fmt: skip
