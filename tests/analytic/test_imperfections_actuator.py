"""The actuator's lag and limited rate against closed forms and an independent integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from controllers.actuator import Actuator
from cosim.clock import NS

STEP = 1e-3


def response(component: Actuator, demand: np.ndarray, step: float = STEP) -> np.ndarray:
    instance = component.instance()
    instance.enter_initialization()
    instance.exit_initialization()
    rows = []
    for k, u in enumerate(demand):
        instance.u[:] = u
        instance.push()
        instance.step(round(k * step * NS), round((k + 1) * step * NS))
        instance.pull()
        rows.append(instance.y[0])
    return np.array(rows)


def test_the_step_response_is_the_exponential_whatever_the_step() -> None:
    lag = 4e-3
    for step, n in ((1e-3, 20), (5e-3, 4)):
        t = step * np.arange(1, n + 1)
        found = response(Actuator(lag=lag), np.full(n, 3.0), step)
        # exact, so rounding of n products remains
        np.testing.assert_allclose(found, 3 * (1 - np.exp(-t / lag)), rtol=1e-14 * n)


def test_saturation_comes_before_the_lag() -> None:
    t = STEP * np.arange(1, 11)
    found = response(Actuator(lag=4e-3, limit=2.0), np.full(10, 50.0))
    np.testing.assert_allclose(found, 2 * (1 - np.exp(-t / 4e-3)), rtol=1e-13)


def test_a_sine_comes_out_smaller_and_later() -> None:
    """Steady response of 1/(1 + j w lag), here to a demand held over short steps, which delays it by half a step."""
    lag, w, step = 5e-3, 200.0, 1e-4
    t = step * np.arange(1, 1001)
    found = response(Actuator(lag=lag), np.sin(w * (t - step)), step)
    gain = np.exp(-1j * w * step / 2) / (1 + 1j * w * lag)
    late = t > 15 * lag  # the transient is below exp(-15) = 3e-7
    expected = np.abs(gain) * np.sin(w * t + np.angle(gain))
    # besides the delay, w step / 2 = 1e-2, holding changes the gain by (w step)^2 / 12 = (step / lag)^2 / 12 = 3e-5
    assert np.max(np.abs(found - expected)[late]) < 1e-4


@pytest.mark.parametrize("step", [1e-3, 7e-3])
def test_a_limited_rate_and_a_lag_together(step: float) -> None:
    lag, rate = 3e-3, 150.0
    demand = np.repeat([1.0, -0.4, -0.3, 0.9], round(21e-3 / step))

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        k = min(int(t / step + 1e-9), len(demand) - 1)
        return np.clip((demand[k] - y) / lag, -rate, rate)

    reference, y = [], np.zeros(1)
    for k in range(len(demand)):
        span = (k * step + 1e-12, (k + 1) * step - 1e-12)
        y = solve_ivp(slope, span, y, rtol=1e-10, atol=1e-12, max_step=1e-4).y[:, -1]
        reference.append(y[0])
    # the reference keeps its 1e-10 at the kinks of the slope, too, by choosing small steps there
    np.testing.assert_allclose(response(Actuator(lag=lag, rate_limit=rate), demand, step), reference, atol=1e-8)
