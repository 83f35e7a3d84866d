"""Algebraic loops are found, shown and solved: known solutions in closed form."""

from typing import Any

import numpy as np
import pytest
from looped import RING, ROUNDING, Curve, Line, initial, lines
from toys import Gain, Mass, Scripted, Spring, port

import fmus
from cosim import Component, Jacobi, Link, Record, System, input, output, parameter, run, state
from cosim.structure import connection_graph, fed_through, loops

MS = 1_000_000  # ns


class Sum(Component):
    """y = A u."""

    A = parameter([[0.0, 2.0], [-1.0, 3.0]], "1", "matrix", shape=(2, 2))
    b = parameter([1.0, 3.0], "1", "offset", shape=(2,))
    u = input("1", "what goes in", shape=(2,))
    y = output("1", "what comes out", shape=(2,))

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.A @ s.u + s.b)


class Source(Component):
    """x' = 1."""

    x = state(3.0, "1", "time that has passed, and 3")
    y = output("1", "that")

    def flow(s: Any) -> dict[str, Any]:
        return dict(x=s.x + s.dt)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.x)


# what there is


def test_a_system_without_a_loop_has_none() -> None:
    system = System({"m": Mass().instance(), "s": Spring().instance()}, {"s.x": "m.pos", "m.F": "s.F"})
    assert loops(system) == []
    assert fed_through(system) == {"m": set(), "s": {"m"}}  # the spring must be fed before its force is worth reading
    assert {k: list(v) for k, v in connection_graph(system).items()} == {"m": ["s"], "s": ["m"]}


def test_a_loop_is_found_with_its_path() -> None:
    (loop,) = loops(System(lines(2, 2), RING))
    assert str(loop) == "a.u -> a.y -> b.u -> b.y -> a.u"
    assert loop.components == ("a", "b")


def test_two_loops_through_the_same_component_are_one() -> None:
    parts = {"s": Sum().instance(), **lines(1, 1)}
    wires = {"a.u": "s.y[1]", "s.u[1]": "a.y", "b.u": "s.y[2]", "s.u[2]": "b.y"}
    (loop,) = loops(System(parts, wires))
    assert str(loop) == "a.u -> a.y -> s.u -> s.y -> a.u (and 2 more ports that depend on it and it on them)"


def test_loops_that_follow_one_another_are_two() -> None:
    parts = lines(2, 2, 3, 3, 1)
    wires = {**RING, "c.u": "d.y", "d.u": "c.y", "e.u": "a.y"}
    assert [set(loop.components) for loop in loops(System(parts, wires))] in ([{"a", "b"}, {"c", "d"}],
                                                                             [{"c", "d"}, {"a", "b"}])  # fmt: skip


# solved at the start


@pytest.mark.parametrize("gains", [(2.0, -3.0), (2.0, 2.0), (0.5, 0.5), (-1e6, 1e3)])
def test_a_linear_loop_has_its_solution_whether_or_not_a_fixed_point_iteration_would_converge(gains: Any) -> None:
    system = initial(lines(*gains), RING)
    k, m = gains
    assert system["a.u"] == pytest.approx((m + 1) / (1 - m * k), rel=ROUNDING)  # u = m (k u + 1) + 1
    rounding = 4 * np.finfo(float).eps * max(1.0, abs(k * system["a.u"]))  # of the terms that are added up
    assert system["b.u"] == pytest.approx(system["a.y"], rel=0, abs=rounding)


@pytest.mark.parametrize(("kind", "root"), [("cosine", 0.7390851332151607), ("cube", 2.0)])
def test_a_nonlinear_loop_finds_its_root(kind: str, root: float) -> None:
    """The roots of cos u = u (the Dottie number) and of 10 - u^3 = u, where a fixed-point iteration diverges."""
    parts = {"a": Curve().instance(), "b": Line(k=1.0, c=0.0).instance()}
    system = initial(parts, {"a.u": "b.y", "b.u": f"a.{kind}"})
    assert system["a.u"] == pytest.approx(root, rel=ROUNDING)
    assert system[f"a.{kind}"] == pytest.approx(root, rel=ROUNDING * 13)  # the slope of the cube is -12 there


def test_coupled_loops_are_solved_together() -> None:
    parts = {"s": Sum().instance(), **lines(0.5, -2.0)}
    system = initial(parts, {"a.u": "s.y[1]", "s.u[1]": "a.y", "b.u": "s.y[2]", "s.u[2]": "b.y"})
    A, b = Sum().values["A"], Sum().values["b"]
    K = np.diag([0.5, -2.0])
    expected = np.linalg.solve(np.eye(2) - A @ K, A @ np.ones(2) + b)  # y = A (K y + 1) + b
    np.testing.assert_allclose(system["s.y"], expected, rtol=ROUNDING)


def test_a_loop_is_solved_after_what_it_depends_on_and_before_what_depends_on_it() -> None:
    parts = {"last": Gain(k=10).instance(), "s": Sum().instance(), "a": Line().instance(), "first": Source().instance()}
    system = initial(parts, {"last.u": "a.y", "a.u": "s.y[1]", "s.u[1]": "a.y", "s.u[2]": "first.y"})
    # y1 = 2 * 3 + 1 = 7 (its own input does not reach it, but the description knows whole ports only)
    assert (system["s.u"].tolist(), system["last.y"]) == ([15.0, 3.0], 150.0)


def test_the_conversion_of_a_wire_is_inside_the_loop() -> None:
    system = initial(lines(2.0, 3.0), {"a.u": Link("b.y", factor=0.1, offset=5.0), "b.u": "a.y"})
    assert system["a.u"] == pytest.approx((0.1 * (3 + 1) + 5) / (1 - 0.1 * 3 * 2), rel=ROUNDING)


def test_small_values_are_solved_to_their_own_size() -> None:
    """The nominal values are 1, the default; the solution is 1e-9 and still exact to rounding."""
    parts = {"a": Line(k=2.0, c=1e-9).instance(), "b": Line(k=-3.0, c=0.0).instance()}
    for part in parts.values():
        part.set("u", 0.0)
    assert initial(parts, RING)["a.y"] == pytest.approx(1e-9 / 7, rel=ROUNDING, abs=0)  # y = 2 (-3 y) + c


def test_a_curve_through_small_values_is_solved_to_their_size() -> None:
    """With u = c v, u = c - u^2 / c is v = 1 - v^2, the golden ratio; the first residual is below the tolerance."""

    class Tiny(Component):
        """y = c - u^2 / c."""

        c = parameter(1e-11, "1", "size of it all")
        u = input("1", "what goes in")
        y = output("1", "what comes out")

        def outputs(s: Any) -> dict[str, Any]:
            return dict(y=s.c - s.u**2 / s.c)

    system = initial({"t": Tiny().instance()}, {"t.u": "t.y"})
    assert system["t.u"] == pytest.approx(1e-11 * (5**0.5 - 1) / 2, rel=ROUNDING, abs=0)


def test_without_derivatives_differences_do() -> None:
    class Plain(Scripted):
        """Shows its input minus a cube of it, as a foreign FMU without derivatives might."""

        def pull(self) -> None:
            self.y[0] = 10 - self.held[0] ** 3

    parts = {"a": Plain([port("u", "input"), port("y", "output", depends_on=("u",))]), "b": Line(k=1, c=0).instance()}
    assert initial(parts, RING)["a.u"] == pytest.approx(2.0, rel=ROUNDING)


def test_wrong_derivatives_do_not_mislead() -> None:
    class Wrong(Scripted):
        """Declares derivatives and gives them with the wrong sign."""

        def pull(self) -> None:
            self.y[0] = 10 - self.held[0] ** 3

        def directional_derivative(self, unknowns: list[str], knowns: list[str], seed: np.ndarray) -> np.ndarray:
            return 3 * self.held**2 * seed

    ports = [port("u", "input", start=1.0), port("y", "output", depends_on=("u",))]
    parts = {"a": Wrong(ports, directional_derivatives=True), "b": Line(k=1, c=0).instance()}
    assert initial(parts, RING)["a.u"] == pytest.approx(2.0, rel=ROUNDING)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_loop_through_fmus_is_solved(fmi: int) -> None:
    parts = {"a": fmus.instantiate(Curve(), "a", fmi=fmi), "b": fmus.instantiate(Line(k=1.0, c=0.0), "b", fmi=5 - fmi)}
    with System(parts, {"a.u": "b.y", "b.u": "a.cosine"}) as system:
        system.initialize()
        assert system["a.u"] == pytest.approx(0.7390851332151607, rel=ROUNDING)
        assert system["b.y"] == pytest.approx(system["a.u"], rel=ROUNDING)


def test_the_run_goes_on_from_the_solution() -> None:
    record = Record()
    run(System(lines(2.0, -3.0), RING), Jacobi(), step=MS, stop=3 * MS, observers=[record])
    np.testing.assert_allclose(record["a.u"], -2 / 7, rtol=4 * ROUNDING)  # rounding is passed round by a gain of 6
