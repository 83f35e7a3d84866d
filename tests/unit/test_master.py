"""The master: who sees which values when, what observers are told, initialisation, failures."""

from typing import Any

import numpy as np
import pytest
from toys import Gain, Journal, Mass, Scripted, Spring, Watch, port, silent

from cosim import (
    Advance,
    Component,
    CouplingError,
    GaussSeidel,
    Jacobi,
    Link,
    Observer,
    Record,
    StepError,
    System,
    input,
    output,
    run,
)

MS = 1_000_000  # ns


def pair(**every: int) -> System:
    """Return two watches that look at each other."""
    parts = {"a": Watch().instance(), "b": Watch().instance()}
    return System(parts, {"a.u": "b.y", "b.u": "a.y"}, every=every)


def recorded(system: System, algorithm: Any, **how: Any) -> Record:
    record = Record()
    run(system, algorithm, observers=[record], **{"step": MS, "stop": 4 * MS, **how})
    return record


# who sees which values when: ``saw`` is what a component held as its input over its last step


def test_jacobi_everybody_sees_the_start_of_the_step() -> None:
    record = recorded(pair(), Jacobi())
    for name in "ab":
        np.testing.assert_allclose(record[f"{name}.saw"][1:], [0, 1e-3, 2e-3, 3e-3], atol=1e-15)


def test_gauss_seidel_those_behind_see_the_end_of_the_step() -> None:
    record = recorded(pair(), GaussSeidel(("b", "a")))
    np.testing.assert_allclose(record["b.saw"][1:], [0, 1e-3, 2e-3, 3e-3], atol=1e-15)
    np.testing.assert_allclose(record["a.saw"][1:], [1e-3, 2e-3, 3e-3, 4e-3], atol=1e-15)


def test_a_slow_component_steps_once_over_all_its_macro_steps_when_the_last_is_done() -> None:
    record = recorded(pair(b=2), GaussSeidel(), stop=5 * MS)
    np.testing.assert_allclose(record["b.y"], [0, 0, 2e-3, 2e-3, 4e-3, 5e-3], atol=1e-15)  # the rest at the stop time
    np.testing.assert_allclose(record["b.since"][1:], [-1, 0, 0, 2e-3, 4e-3], atol=1e-15)
    np.testing.assert_allclose(record["b.saw"][1:], [-1, 2e-3, 2e-3, 4e-3, 5e-3], atol=1e-15)  # a, at the end
    np.testing.assert_allclose(record["a.saw"][1:], [0, 0, 2e-3, 2e-3, 4e-3], atol=1e-15)  # b, held in between


def test_a_slow_component_in_jacobi_sees_the_start_of_its_own_step() -> None:
    record = recorded(pair(b=2), Jacobi())
    np.testing.assert_allclose(record["b.saw"][1:], [-1, 0, 0, 2e-3], atol=1e-15)
    np.testing.assert_allclose(record["a.saw"][1:], [0, 0, 2e-3, 2e-3], atol=1e-15)


def test_values_that_are_no_float64_travel_too() -> None:
    kinds = {"flag": "Boolean", "n": "Int32", "word": "String"}
    sender = Scripted(
        [port(n, "input", t) for n, t in kinds.items()] + [port(n + "_", "output", t) for n, t in kinds.items()]
    )
    receiver = Scripted([port(n, "input", t) for n, t in kinds.items()])
    for name, value in (("flag", True), ("n", 7), ("word", "gear")):
        sender.set(name, value)
    system = System({"s": sender, "r": receiver}, {f"r.{n}": f"s.{n}_" for n in kinds})
    record = recorded(system, GaussSeidel())
    assert receiver.values == {"flag": True, "n": 7, "word": "gear"}
    assert record["r.n"].tolist() == [7] * 5
    assert record["r.word"].tolist() == ["gear"] * 5


def test_a_float32_is_converted_as_well() -> None:
    sender = Scripted([port("x", "input", "Float32"), port("y", "output", "Float32", unit="mm")])
    receiver = Scripted([port("u", "input", "Float32", unit="m")])
    sender.set("x", 1500.0)
    system = System({"s": sender, "r": receiver}, {"r.u": Link("s.y", convert=True)})
    recorded(system, Jacobi())
    assert receiver.values["u"] == pytest.approx(1.5)


# time


def test_the_last_step_is_what_is_left() -> None:
    record = recorded(pair(), GaussSeidel(), step=1.5e-3, stop=4e-3)
    assert record.points == [(0, 0), (0, 1_500_000), (1_500_000, 3_000_000), (3_000_000, 4_000_000)]


def test_a_long_run_does_not_drift() -> None:
    step, n = 333_333, 20_000  # ns; adding 333.333e-6 s up in floats would be off by some 1e-12 s by then
    record = recorded(System({"a": silent()}, {}), Jacobi(), step=step, stop=n * step)
    np.testing.assert_array_equal(record.time_ns, np.arange(n + 1) * step)
    np.testing.assert_array_equal(record.time, np.arange(n + 1) * step / 1e9)


def test_a_run_may_start_later() -> None:
    record = recorded(pair(), Jacobi(), start=2.0, stop=2.003, step=1e-3)
    np.testing.assert_array_equal(record.time_ns, [2_000_000_000 + k * MS for k in range(4)])
    np.testing.assert_array_equal(record["a.y"], record.time)


def test_the_components_learn_the_span_and_the_tolerance() -> None:
    part = silent()
    recorded(System({"a": part}, {}), Jacobi(), tolerance=1e-5)
    assert part.span == (0, 4 * MS, 1e-5)


# observers


def test_observers_are_told_everything_in_order() -> None:
    journal = Journal()
    summary = run(pair(), Jacobi(), step=MS, stop=2 * MS, observers=[journal])
    kinds = [entry[0] for entry in journal.entries]
    assert kinds == ["started", "accepted", "accepted", "accepted", "finished"]
    info = journal.entries[0][1]
    assert (info.step_ns, info.start_ns, info.stop_ns, info.algorithm) == (MS, 0, 2 * MS, "Jacobi()")
    assert journal.entries[1:4] == [("accepted", 0, 0, 0), ("accepted", 1, 0, MS), ("accepted", 2, MS, 2 * MS)]
    assert (summary.steps, summary.rejected, summary.events, summary.simulated) == (2, 0, 0, 2e-3)


def test_a_failure_keeps_what_was_accepted_and_names_component_and_time() -> None:
    parts = {"fine": silent(), "broken": Scripted([], {3: ValueError("no such gear")})}
    journal, record = Journal(), Record()
    with pytest.raises(StepError) as caught:
        run(System(parts, {}), Jacobi(), step=MS, stop=5 * MS, observers=[journal, record])
    assert str(caught.value) == "broken failed at t = 0.002 s: ValueError: no such gear (step 3)"
    assert (caught.value.component, caught.value.time) == ("broken", 0.002)
    assert journal.entries[-2:] == [("accepted", 2, MS, 2 * MS), ("failed", str(caught.value))]
    assert record.time_ns.tolist() == [0, MS, 2 * MS]
    assert record.error is caught.value


def test_the_component_of_a_step_error_is_its_name_in_the_system() -> None:
    class Root(Component):
        """x' = -1 / x: ends where x reaches 0."""

        u = input("1", "a number")
        y = output("1", "its logarithm")

        def outputs(s: Any) -> dict[str, Any]:
            return dict(y=s.u)

    instance = Root().instance("its own name")
    system = System({"root": instance}, {})
    instance.u[0] = np.nan
    with pytest.raises(StepError) as caught:
        run(system, Jacobi(), step=MS, stop=MS)
    assert str(caught.value) == "root failed at t = 0 s: input u is nan (step 1)"


def test_an_observer_that_fails_stops_the_run_and_the_others_hear_of_it() -> None:
    class Full(Observer):
        def accepted(self, point: Any) -> None:
            raise OSError("disk full")

        def failed(self, error: BaseException) -> None:
            raise OSError("still full")

    journal = Journal()
    with pytest.raises(OSError, match="disk full") as caught:
        run(pair(), Jacobi(), step=MS, stop=MS, observers=[Full(), journal])
    assert journal.entries[-1] == ("failed", "disk full")
    assert caught.value.__notes__ == ["Full.failed raised OSError: still full"]


def test_an_interrupt_is_told_too() -> None:
    journal = Journal()
    with pytest.raises(KeyboardInterrupt):
        run(
            System({"a": Scripted([], {2: KeyboardInterrupt()})}, {}),
            Jacobi(),
            step=MS,
            stop=9 * MS,
            observers=[journal],
        )
    assert journal.entries[-1][0] == "failed"


# initialisation


def test_outputs_travel_along_the_feedthroughs_whatever_the_order_of_declaration() -> None:
    parts = {"third": Gain(k=5).instance(), "second": Gain(k=3).instance(), "first": Gain(k=2).instance()}
    parts["first"].set("u", 1.0)
    record = Record()
    run(System(parts, {"third.u": "second.y", "second.u": "first.y"}), Jacobi(), step=MS, stop=MS, observers=[record])
    assert [record[f"{name}.y"][0] for name in ("first", "second", "third")] == [2, 6, 30]


def test_an_input_keeps_its_start_value_until_its_source_is_known() -> None:
    """A component may not take a 0 that nobody has computed: here 1 / b would fail."""

    class Strict(Scripted):
        def pull(self) -> None:
            assert self.u[1] in (5.0, 6.0)
            super().pull()

    ports = [port("a", "input"), port("b", "input", start=5.0), port("y", "output", depends_on=("a",))]
    parts = {"strict": Strict(ports), "one": Gain(k=3).instance(), "two": Gain(k=2).instance()}
    parts["one"].set("u", 1.0)
    run(System(parts, {"strict.a": "one.y", "two.u": "one.y", "strict.b": "two.y"}), Jacobi(), step=MS, stop=MS)
    assert parts["strict"].u.tolist() == [3, 6]


def test_a_loop_through_one_component_is_no_loop_if_its_ports_are_independent() -> None:
    class Two(Component):
        """Two independent gains."""

        a = input("1", "first in", start=1.0)
        b = input("1", "second in")
        c = output("1", "first out")
        d = output("1", "second out")

        def outputs(s: Any) -> dict[str, Any]:
            return dict(c=2 * s.a, d=3 * s.b)

    record = Record()
    run(System({"two": Two().instance()}, {"two.b": "two.c"}), Jacobi(), step=MS, stop=MS, observers=[record])
    assert record["two.d"][0] == 6


def test_a_system_runs_once() -> None:
    system = pair()
    run(system, Jacobi(), step=MS, stop=MS)
    with pytest.raises(CouplingError) as caught:
        run(system, Jacobi(), step=MS, stop=MS)
    assert str(caught.value) == "this system has been initialised before; build a new one from new instances"


# the end


def test_a_component_may_end_the_run() -> None:
    parts = {"a": Scripted([], {2: lambda start, end: Advance(end, terminated=True)}), "b": silent()}
    journal = Journal()
    summary = run(System(parts, {}), Jacobi(), step=MS, stop=9 * MS, observers=[journal])
    assert (summary.steps, summary.simulated, summary.terminated_by) == (2, 2e-3, "a")
    assert journal.entries[-1] == ("finished", 2, 0, 0)
    assert parts["b"].steps == 2


def test_a_component_that_ends_inside_a_step_ends_the_run_where_everybody_was() -> None:
    parts = {"a": Scripted([], {2: lambda start, end: Advance(start + 10, terminated=True)}), "b": silent()}
    summary = run(System(parts, {}), Jacobi(), step=MS, stop=9 * MS)
    assert (summary.steps, summary.simulated, summary.terminated_by) == (1, 1e-3, "a")


def test_close_closes_every_instance_also_after_a_failure() -> None:
    parts = {"a": silent(), "b": silent()}

    def fails() -> None:
        raise OSError("busy")

    parts["a"].close = fails  # type: ignore[method-assign]
    with pytest.raises(OSError, match="busy"), System(parts, {}):
        pass
    assert parts["b"].closed


def test_a_mass_on_a_spring_keeps_its_energy_to_the_order_of_the_step() -> None:
    system = System(
        {"mass": Mass().instance(), "spring": Spring().instance()}, {"mass.F": "spring.F", "spring.x": "mass.pos"}
    )
    record = recorded(system, GaussSeidel(), step=1e-3, stop=0.5)
    energy = record["mass.vel"] ** 2 / 2 + 4 * record["mass.pos"] ** 2 / 2
    # Force held over the step: x'' = -w^2 x(t - ~h/2) feeds energy at the rate h w^2 v^2 / 2 <= h w^2 E: 0.002 here.
    assert 0 < energy[-1] / 2 - 1 < 1e-3 * 4 * 0.5


def test_record_keeps_what_it_was_asked_to_keep() -> None:
    record = Record(["mass.pos"])
    system = System(
        {"mass": Mass().instance(), "spring": Spring().instance()}, {"mass.F": "spring.F", "spring.x": "mass.pos"}
    )
    run(system, Jacobi(), step=MS, stop=3 * MS, observers=[record])
    assert record.ports() == ("mass.pos",)
    data = record.to_xarray()
    assert data["mass.pos"].attrs == {"long_name": "position", "causality": "output", "units": "m"}
    assert data["time"].attrs["units"] == "s"
    np.testing.assert_array_equal(data["mass.pos"].sel(time=0.002), record["mass.pos"][2])
