"""Slip by torque, Eq 3.16: its closed form, and the linearised FMU of the drive with a mass on each wheel."""

from contextlib import closing

import control
import numpy as np
import pytest
from carriage import F_N, J_W, M, R

import fmus
from controllers.slip_model import slip_transfer_function
from cosim import DeclarationError
from cosim.linearize import linearize
from plants.tyre import LAWS, slope
from plants.wheel_drive import WheelDrive, tyre_of

V_0, SLIP, K = 2.0, 0.05, 8.0


def test_the_pole_is_the_derived_one_and_not_the_printed_one() -> None:
    """To a unit of the last digit of what is known of them; the printed sign moves the pole by 5 percent."""
    right = slip_transfer_function(V_0, R, J_W, M, F_N, K, SLIP)
    printed = slip_transfer_function(V_0, R, J_W, M, F_N, K, SLIP, as_printed=True)
    assert right.poles()[0].real == pytest.approx(-1542.66, abs=0.01)
    assert printed.poles()[0].real == pytest.approx(-1468.09, abs=0.01)
    assert (right.input_labels, right.output_labels) == (["torque"], ["slip"])


def closed_with_masses(law: str, fmi: int, slip: float, **curve: float) -> tuple[control.StateSpace, float]:
    """Return the linearised FMU, from the first torque to the first slip, with v' = F_a / m around it, and k there."""
    made = WheelDrive(law=law, R=R, J_w=J_W, **curve)
    with closing(fmus.instantiate(made, "drive", fmi=fmi)) as instance:
        instance.enter_initialization(0, 1_000_000_000, 1e-8)
        instance.set("omega", np.full(4, V_0 / (R * (1 - slip))))
        instance.set("contact_velocity", np.array([[V_0, 0.0]] * 4))
        instance.set("normal_force", np.full(4, F_N))
        instance.exit_initialization()
        full = linearize(instance)
    u = [full.input_labels.index(name) for name in ("torque[1]", "contact_velocity[1,1]")]
    y = [full.output_labels.index(name) for name in ("slip[1]", "traction_demand[1]")]
    drive = control.ss(full.A, full.B[:, u], full.C[y], full.D[np.ix_(y, u)])
    return drive.lft(control.ss([[0]], [[1 / M]], [[1]], [[0]])), slope(tyre_of(made), slip)


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_linearised_fmu_has_this_pole(fmi: int) -> None:
    """Dugoff's curve is straight, d mu / d lambda = C_x, as long as the wheel sticks: up to slip 0.0625 with mu = 1.

    The three wheels whose speed is held have the pole -R^2 F_n k V / (J_w (R w)^2); the rest are integrals.
    """
    system, k = closed_with_masses("dugoff", fmi, SLIP, mu=1.0, C_x=K)
    assert k == pytest.approx(K, rel=1e-12)
    held = -(R**2) * F_N * K * V_0 / (J_W * (V_0 / (1 - SLIP)) ** 2)
    poles = np.sort_complex(system.poles())[:5]
    np.testing.assert_allclose(poles, [-1542.655, held, held, held, 0], atol=1e-3)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("slip", [0.01, 0.04, 0.12])
def test_the_transfer_function_is_that_of_the_linearised_fmu(law: str, slip: float) -> None:
    """Over frequency, on straight and bent parts of both curves; cancelled poles leave 1e-9."""
    system, k = closed_with_masses(law, 3, slip)
    H = slip_transfer_function(V_0, R, J_W, M, F_N, k, slip)
    at = 1j * np.geomspace(1.0, 1e5, 11)
    np.testing.assert_allclose(system(at), H(at), rtol=1e-8)


def test_without_positive_stiffness_it_is_refused() -> None:
    tyre = tyre_of(WheelDrive(law="magic"))
    k = slope(tyre, 0.5)
    assert k < 0
    with pytest.raises(DeclarationError) as caught:
        slip_transfer_function(V_0, R, J_W, M, F_N, k, 0.5)
    assert str(caught.value) == (
        f"the friction curve has no positive stiffness at slip 0.5: d mu / d lambda = {k:g} puts the pole of the slip "
        "at 20.37 1/s, where it runs away; choose a slip below the peak of the curve"
    )


def test_the_slip_runs_away_beyond_the_peak_as_that_pole_says() -> None:
    system, k = closed_with_masses("magic", 3, 0.5)
    w_0 = V_0 / (R * 0.5)
    pole = -(V_0 * R + w_0 * J_W / M) * F_N * k / (R * w_0**2 * J_W)
    assert pole > 0
    assert max(system.poles().real) == pytest.approx(pole, rel=1e-9)


@pytest.mark.parametrize(("change", "sentence"), [
    ({"V_0": 0.0}, "the slip transfer function needs a positive V_0, not 0 m/s"),
    ({"slip": 1.0}, "the slip transfer function is that of a driven wheel, 0 <= slip < 1, not 1"),
])  # fmt: skip
def test_values_without_a_meaning_are_refused(change: dict[str, float], sentence: str) -> None:
    values = {"V_0": V_0, "R": R, "J_w": J_W, "m": M, "F_n": F_N, "k": K, "slip": SLIP, **change}
    with pytest.raises(DeclarationError) as caught:
        slip_transfer_function(**values)
    assert str(caught.value) == sentence
