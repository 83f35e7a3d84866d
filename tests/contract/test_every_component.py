"""What every component of the project must be: declared as computed, finite, pure, exact to go back to.

Components are found by importing every module of ``plants`` and ``controllers``; a new one is covered by existing.
"""

import importlib
import pkgutil
from typing import Any

import numpy as np
import pytest
import toys

import controllers
import plants
from cosim import Component
from cosim.twin import PythonInstance

STEP = 100_000  # ns: the macro step that the studies use


def components() -> dict[str, type[Component]]:
    """Return the components by ``package.Class``; the toys of the tests keep the suite honest when it is empty."""
    found: dict[str, type[Component]] = {}
    modules = [toys]
    for package in (plants, controllers):
        modules += [
            importlib.import_module(m.name) for m in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
        ]
    for module in modules:
        for thing in vars(module).values():
            own = isinstance(thing, type) and issubclass(thing, Component) and thing.__module__ == module.__name__
            if own and not shared_ports_only(thing):
                found[f"{module.__name__.split('.')[0]}.{thing.__name__}"] = thing
    return found


def shared_ports_only(kind: type[Component]) -> bool:
    """Whether a class only declares what its subclasses share, and leaves the law for states or outputs to them."""
    lawless = not any(hasattr(kind, law) for law in ("derivatives", "flow", "sync"))
    left_open = any(d.role == "state" for d in kind.declarations.values()) or not hasattr(kind, "outputs")
    return bool(kind.__subclasses__()) and lawless and left_open


ALL = components()


@pytest.fixture(params=ALL, scope="module")
def kind(request: Any) -> type[Component]:
    """Every component class in turn."""
    return ALL[request.param]


def started(component: Component) -> PythonInstance:
    instance = component.instance()
    instance.enter_initialization(0, 1_000_000_000, 1e-8)
    instance.push()
    instance.pull()
    instance.exit_initialization()
    return instance


def shaken(instance: PythonInstance, seed: int) -> None:
    """Put inputs a thousandth off their start values, the same ones for the same seed."""
    noise = np.random.default_rng(seed).uniform(0.5, 1.0, len(instance.u))
    instance.u[:] = [1e-3 * n if u == 0 else u * (1 + 1e-3 * n) for u, n in zip(instance.u, noise, strict=True)]
    instance.push()


def stepped(instance: PythonInstance, first: int, n: int) -> np.ndarray:
    rows = []
    for k in range(first, first + n):
        instance.push()
        instance.step(k * STEP, (k + 1) * STEP)
        instance.pull()
        rows.append(instance.y.copy())
    return np.array(rows)


def test_it_says_what_it_is(kind: type[Component]) -> None:
    assert (kind.__doc__ or "").strip()
    assert kind.__doc__ != Component.__doc__


def test_its_equations_fit_its_declarations(kind: type[Component]) -> None:
    """Building them checks names, roles and shapes; here, that every output and state is really there."""
    component = kind()
    equations = component.equations
    assert {b.name for b in equations.outputs} == set(component.declared("output"))
    assert equations.out.numel_out() == sum(v.size for v in component.instance().outputs)
    if equations.ode is not None:
        assert equations.ode.numel_out() == sum(np.prod(b.shape, dtype=int) for b in equations.states)


def test_its_start_values_and_first_steps_are_finite(kind: type[Component]) -> None:
    instance = started(kind())
    assert np.all(np.isfinite(instance.y))
    assert np.all(np.isfinite(stepped(instance, 0, 3)))


def test_its_declared_dependencies_are_all_there_are(kind: type[Component]) -> None:
    """An output without a feedthrough from an input does not change, to the bit, when that input does."""
    instance = started(kind())
    shaken(instance, 1)
    instance.pull()
    before = instance.y.copy()
    for v in instance.inputs:
        kept = instance.u.copy()
        instance.u[instance.u_at[v.name]] += 0.1
        instance.push()
        instance.pull()
        for output in instance.outputs:
            if v.name not in (output.depends_on or ()):
                at = instance.y_at[output.name]
                np.testing.assert_array_equal(instance.y[at], before[at], err_msg=f"{output.name} depends on {v.name}")
        instance.u[:] = kept
        instance.push()


def test_it_is_pure(kind: type[Component]) -> None:
    """Two instances of one component, stepped in turn, do not see each other and do the same, to the bit."""
    component = kind()
    one, other = started(component), started(component)
    shaken(one, 2)
    first = stepped(one, 0, 3)
    shaken(other, 2)
    np.testing.assert_array_equal(stepped(other, 0, 3), first)
    assert not np.shares_memory(one.u, other.u)
    assert not np.shares_memory(one.y, other.y)


def test_it_can_be_taken_back_to_the_bit(kind: type[Component]) -> None:
    instance = started(kind())
    shaken(instance, 3)
    stepped(instance, 0, 2)
    saved = instance.snapshot()
    ahead = stepped(instance, 2, 2)
    shaken(instance, 4)
    stepped(instance, 4, 1)
    for _ in range(2):  # a snapshot may be restored any number of times
        instance.restore(saved)
        np.testing.assert_array_equal(stepped(instance, 2, 2), ahead)


def test_a_serialised_snapshot_moves_to_another_instance(kind: type[Component]) -> None:
    component = kind()
    one, other = started(component), started(component)
    shaken(one, 5)
    stepped(one, 0, 2)
    other.restore(other.deserialize(one.serialize(one.snapshot())))
    np.testing.assert_array_equal(stepped(other, 2, 2), stepped(one, 2, 2))
