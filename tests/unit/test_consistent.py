"""Communication points with all outputs brought up to date: loops solved there, nothing left a step behind."""

from typing import Any

import numpy as np
import pytest
from toys import Alarm, Gain, Mass, Scripted, Spring, port

import fmus
from cosim import (
    Advance,
    Algorithm,
    Component,
    CouplingError,
    GaussSeidel,
    Instance,
    Jacobi,
    Record,
    System,
    input,
    output,
    parameter,
    run,
    state,
)
from cosim.consistent import Consistent

MS = 1_000_000  # ns


class Decay(Component):
    """x' = y with y = w - 2 z - x, where z is fed back from y: y = (w - x) / 3."""

    x = state(1.0, "1", "what decays")
    z = input("1", "y, once around")
    y = output("1", "rate of x per second, if the loop is closed")

    def flow(s: Any) -> dict[str, Any]:
        return dict(x=s.x + s.dt * (-2 * s.z - s.x))

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=-2 * s.z - s.x)


class Clock(Component):
    """Shows the time that has passed."""

    x = state(0.0, "1", "time that has passed")
    y = output("1", "that")

    def flow(s: Any) -> dict[str, Any]:
        return dict(x=s.x + s.dt)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.x)


class Held(Scripted):
    """A gain of 1 that shows, as some FMUs do, the input of its last step whatever was set since."""

    seen = np.zeros(1)

    def __init__(self, **can: bool) -> None:
        super().__init__([port("u", "input"), port("y", "output", depends_on=("u",))], **can)

    def exit_initialization(self) -> None:
        self.seen = self.held.copy()

    def pull(self) -> None:
        self.y[:] = self.seen if self.seen.any() or self.steps else self.held

    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        self.seen = self.held.copy()
        return super().step(start, end)


def recorded(system: System, algorithm: Algorithm, steps: int = 10, step: int = MS) -> Record:
    """Return the record of a run of some steps."""
    record = Record()
    with system:
        run(system, algorithm, step=step, stop=steps * step, observers=[record])
    return record


def decay(fmi: int | None = None) -> System:
    """Return the decay with a gain of 1 around it: a loop whose own iteration has a gain of -2."""
    kinds = {"d": Decay(), "g": Gain(k=1.0)}
    if fmi is None:
        parts: dict[str, Instance] = {name: c.instance() for name, c in kinds.items()}
    else:
        parts = {name: fmus.instantiate(c, name, fmi=fmi) for name, c in kinds.items()}
    return System(parts, {"d.z": "g.y", "g.u": "d.y"})


@pytest.mark.parametrize("algorithm", [Jacobi(), GaussSeidel(), GaussSeidel(("g", "d"))])
def test_a_loop_is_solved_at_every_point(algorithm: Algorithm) -> None:
    """The rate held over a step is -x / 3, so that x shrinks by 1 - h / 3 in each, to rounding."""
    h, n = 0.1, 20
    expected = (1 - h / 3) ** np.arange(n + 1)
    record = recorded(decay(), Consistent(algorithm), n, round(h * 1e9))
    np.testing.assert_allclose(-3 * record["d.y"], expected, rtol=1e-13)  # 20 steps of a few roundings each
    np.testing.assert_allclose(record["g.u"], record["d.y"], rtol=1e-15)
    without = recorded(decay(), algorithm, n, round(h * 1e9))["d.y"]
    assert np.max(np.abs(without)) > 10 / 3  # once round the loop is a factor of -2, and takes a step or two


def test_a_loop_through_fmus_is_solved_at_every_point() -> None:
    record = recorded(decay(fmi=3), Consistent(GaussSeidel()), 20, 100 * MS)
    expected = (1 - 0.1 / 3) ** np.arange(21)
    np.testing.assert_allclose(-3 * record["d.y"], expected, rtol=1e-13)


def test_fmi_2_takes_part_where_it_is_trusted_and_passes_the_trial() -> None:
    with decay(fmi=2) as system, pytest.raises(CouplingError) as caught:
        run(system, Consistent(Jacobi()), step=MS, stop=MS)
    assert str(caught.value) == (
        "the algebraic loop d.z -> d.y -> g.u -> g.y -> d.z cannot be solved at communication points: d does not "
        "promise outputs for inputs that are set between steps (FMI 2.0 forbids to ask); name it in "
        "trusted to have it tried; without Consistent each of its connections is delayed instead"
    )
    record = recorded(decay(fmi=2), Consistent(Jacobi(), trusted=("d", "g")), 20, 100 * MS)
    np.testing.assert_allclose(-3 * record["d.y"], (1 - 0.1 / 3) ** np.arange(21), rtol=1e-13)


def test_who_shows_old_outputs_is_found_out() -> None:
    system = System({"d": Decay().instance(), "g": Held()}, {"d.z": "g.y", "g.u": "d.y"})
    with pytest.raises(CouplingError) as caught:
        run(system, Consistent(Jacobi()), step=MS, stop=2 * MS)
    assert "g goes on showing the outputs of its last step after its inputs were set" in str(caught.value)


def chain(middle: Instance) -> System:
    """Return clock -> middle -> gain, declared against the order of the signal."""
    parts = {"last": Gain(k=1.0).instance(), "middle": middle, "clock": Clock().instance()}
    return System(parts, {"middle.u": "clock.y", "last.u": "middle.y"})


def test_nothing_is_a_step_behind() -> None:
    points = np.arange(11) * 1e-3
    record = recorded(chain(Gain(k=1.0).instance()), Consistent(Jacobi()))
    np.testing.assert_allclose(record["last.y"], points, atol=1e-16)
    plain = recorded(chain(Gain(k=1.0).instance()), Jacobi())
    np.testing.assert_allclose(plain["last.y"][2:], points[:-2], atol=1e-16)


def test_who_cannot_be_read_is_left_as_it_is_where_it_closes_no_loop() -> None:
    record = recorded(chain(Held()), Consistent(Jacobi()))
    np.testing.assert_allclose(record["middle.y"][2:], np.arange(1, 10) * 1e-3, atol=1e-16)  # one step behind
    np.testing.assert_array_equal(record["last.y"], record["middle.y"])  # and nothing is added to that


def test_the_trial_leaves_no_trace() -> None:
    """Every bit is what it is without, where the order brings everything up to date by itself."""
    wires = {"spring.x": "mass.pos", "spring.v": "mass.vel", "mass.F": "spring.F"}
    order = GaussSeidel(("mass", "spring"))
    records = []
    for algorithm in (order, Consistent(order)):
        parts = {"mass": Mass().instance(), "spring": Spring(d=0.3).instance()}
        records.append(recorded(System(parts, wires), algorithm, 50))
    for name in ("mass.pos", "mass.vel", "spring.F"):
        np.testing.assert_array_equal(records[0][name], records[1][name])


def test_who_is_in_the_midst_of_a_long_step_is_not_touched() -> None:
    clock, pushed = Clock().instance(), []

    class Watched(Scripted):
        """Writes down when it is given inputs."""

        def push(self) -> None:
            pushed.append(round(clock.get("x") * 1e3))
            super().push()

    slow = Watched([port("u", "input"), port("y", "output", depends_on=("u",))])
    parts = {"clock": clock, "slow": slow, "last": Gain(k=1.0).instance()}
    system = System(parts, {"slow.u": "clock.y", "last.u": "slow.y"}, every={"slow": 4})
    record = recorded(system, Consistent(Jacobi()), 8)
    np.testing.assert_allclose(record["last.y"], [0, 0, 0, 0, 4e-3, 4e-3, 4e-3, 4e-3, 8e-3], atol=1e-16)
    assert set(pushed) == {0, 4, 8}


def test_points_at_events_are_brought_up_to_date_too() -> None:
    parts = {"alarm": Alarm(at=0.35e-3).instance(), "g": Gain(k=1.0).instance()}
    record = recorded(System(parts, {"g.u": "alarm.total"}), Consistent(Jacobi()), 3)
    assert len(record.time) > 4
    np.testing.assert_array_equal(record["g.y"], record["alarm.total"])


def test_a_trusted_component_must_exist() -> None:
    with pytest.raises(CouplingError, match="Consistent trusts no component 'dd'; did you mean 'd'"):
        run(decay(), Consistent(Jacobi(), trusted=("dd",)), step=MS, stop=MS)


def test_it_says_what_it_is() -> None:
    assert repr(Consistent(Jacobi())) == "Consistent(algorithm=Jacobi(), trusted=())"
    assert Consistent(Jacobi()) == Consistent(Jacobi())


class Stuck(Component):
    """y = max(u, k) - k: stands still below k."""

    k = parameter(10.0, "1", "threshold")
    u = input("1", "what goes in")
    y = output("1", "what is above the threshold")

    def outputs(s: Any) -> dict[str, Any]:
        import casadi as ca

        return dict(y=ca.fmax(s.u, s.k) - s.k)


def test_an_output_that_stands_still_for_good_reason_is_believed() -> None:
    parts = {"clock": Clock().instance(), "s": Stuck(k=4.5e-3).instance()}
    record = recorded(System(parts, {"s.u": "clock.y"}), Consistent(Jacobi()), 8)
    np.testing.assert_allclose(record["s.y"], np.maximum(np.arange(9) * 1e-3 - 4.5e-3, 0), atol=1e-16)
