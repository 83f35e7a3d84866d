"""Anybody's FMU can be loaded: all scalar types, other units, early ends, warnings and failures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foreign import FMI2, FMI3, foreign

import fmus
from cosim import ExportError, StepError, WiringError, units
from cosim.clock import NS
from fmus import FmuInstance

DESCRIPTIONS = {2: FMI2, 3: FMI3}


@pytest.fixture
def thing(fmi: int, tmp_path: Path) -> FmuInstance:
    """Return the foreign FMU, instantiated."""
    return fmus.load(foreign(tmp_path, fmi, DESCRIPTIONS[fmi]), "thing")


def run(instance: FmuInstance, script: int) -> Any:
    instance.set("script", script)
    instance.enter_initialization(0, NS)
    instance.push()
    instance.exit_initialization()
    return instance.step(0, NS // 10)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("single", 0.25), ("i8", -100), ("u16", 65535), ("i32", -(2**31)), ("i64", 2**53 + 1), ("u64", 2**64 - 1),
        ("flags", [False, True, True]), ("text", "grüße"), ("blob", b"\x00\x01\xff\x00"), ("gear", 2),
        ("sized", [4.0, 5.0]),
    ],
)  # fmt: skip
def test_every_type_of_fmi3(name: str, value: Any, tmp_path: Path) -> None:
    instance = fmus.load(foreign(tmp_path, 3, FMI3))
    instance.set(name, value)
    assert np.array_equal(instance.get(name), value)
    assert type(instance.get(name)) is type(value) or instance.variables[name].shape


@pytest.mark.parametrize(
    ("name", "value"), [("count", -5), ("on", True), ("on", False), ("text", "grüße"), ("gear", 2)]
)
def test_every_type_of_fmi2(name: str, value: Any, tmp_path: Path) -> None:
    instance = fmus.load(foreign(tmp_path, 2, FMI2))
    instance.set(name, value)
    assert instance.get(name) == value
    assert type(instance.get(name)) is type(value)


def test_the_description_of_fmi3(tmp_path: Path) -> None:
    instance = fmus.load(foreign(tmp_path, 3, FMI3))
    v = instance.variables
    assert instance.name == "Foreign thing"
    assert {n: (x.type, x.shape) for n, x in v.items()}["flags"] == ("Boolean", (3,))
    assert v["sized"].shape == (2,)  # from the start value of n
    assert (v["text"].start, v["gear"].type, v["u64"].start) == ("hello", "Enumeration", 2**64 - 1)
    assert v["speed_out"].depends_on == ("speed",)
    assert v["speed"].unit == "km per hour"  # no spelling of ours, but the FMU says what it is
    assert v["speed"].unit_definition is not None
    assert v["speed"].unit_definition.equals(units.parse("km/h"))
    assert instance.can.directional_derivatives  # FMPy reports false
    assert instance.can.early_return
    assert not instance.can.rollback


def test_the_description_of_fmi2(tmp_path: Path) -> None:
    v = fmus.load(foreign(tmp_path, 2, FMI2)).variables
    assert (v["count"].type, v["on"].type, v["gear"].type) == ("Int32", "Boolean", "Enumeration")
    assert (v["count"].start, v["on"].start) == (7, True)
    assert "odd[1]" in v  # odd[2] is missing: no array
    assert "odd" not in v


def test_start_values_and_steps(thing: FmuInstance) -> None:
    advance = run(thing, 0)
    thing.pull()
    assert (advance.reached, advance.early, advance.terminated) == (NS // 10, False, False)
    assert thing.y[thing.y_at["speed_out"]] == 3.5


def test_the_end_of_the_simulation(thing: FmuInstance) -> None:
    advance = run(thing, 2)
    assert (advance.reached, advance.terminated) == (NS // 20, True)


def test_warnings_are_kept(thing: FmuInstance, fmi: int) -> None:
    assert run(thing, 3).reached == NS // 10
    assert thing.warnings == [{2: "slow at 0.00 s", 3: "this is a warning"}[fmi]]


def test_a_failure_without_a_word(thing: FmuInstance, fmi: int) -> None:
    with pytest.raises(StepError) as found:
        run(thing, 4)
    assert str(found.value) == f"thing failed at t = 0 s: it said nothing (fmi{fmi}DoStep returned error)"


def test_a_failure_with_a_word(thing: FmuInstance, fmi: int) -> None:
    with pytest.raises(StepError) as found:
        run(thing, 5)
    word = {2: "the speed 3.500 is too much for me", 3: "the speed is too much for me"}[fmi]
    assert str(found.value) == f"thing failed at t = 0 s: {word} (fmi{fmi}DoStep returned error)"


def test_messages_reach_their_own_instance(fmi: int, tmp_path: Path) -> None:
    path = foreign(tmp_path, fmi, DESCRIPTIONS[fmi])
    one, other = fmus.load(path, "one"), fmus.load(path, "other")
    run(one, 3)
    assert len(one.warnings) == 1
    assert other.warnings == []


def test_early_return_is_taken_or_continued(tmp_path: Path) -> None:
    path = foreign(tmp_path, 3, FMI3)
    taken, continued = fmus.load(path), fmus.load(path)
    for instance in (taken, continued):
        instance.set("script", 1)
        instance.enter_initialization()
        instance.push()
        instance.exit_initialization()
    advance = taken.step(0, NS, early_return=True)
    assert (advance.reached, advance.early) == (NS // 2, True)
    advance = continued.step(0, NS)
    assert (advance.reached, advance.early) == (NS, False)


def test_early_return_without_progress_is_an_error(tmp_path: Path) -> None:
    instance = fmus.load(foreign(tmp_path, 3, FMI3), "thing")
    with pytest.raises(StepError, match="returns early again and again without reaching the end"):
        run(instance, 6)


def test_a_discarded_step_is_an_error(tmp_path: Path) -> None:
    instance = fmus.load(foreign(tmp_path, 2, FMI2), "thing")
    with pytest.raises(StepError, match="fmi2DoStep returned discard"):
        run(instance, 6)


def test_missing_functions_are_met_when_they_are_needed(tmp_path: Path) -> None:
    """The foreign FMU promises directional derivatives and does not export the function."""
    instance = fmus.load(foreign(tmp_path, 3, FMI3))
    with pytest.raises(ExportError, match="does not export fmi3GetDirectionalDerivative"):
        instance.directional_derivative(["speed_out"], ["speed"], np.ones(1))


def test_closed_is_closed(thing: FmuInstance) -> None:
    run(thing, 0)
    thing.close()
    thing.close()
    for act in (thing.push, thing.pull, lambda: thing.get("speed"), lambda: thing.step(NS, 2 * NS)):
        with pytest.raises(WiringError, match="thing was closed and cannot be used any more"):
            act()


def test_after_a_fatal_error_nothing_is_called(thing: FmuInstance) -> None:
    with pytest.raises(StepError, match=r"it said nothing \(fmi.DoStep returned fatal\)"):
        run(thing, 7)
    with pytest.raises(WiringError, match="thing failed fatally and cannot be used any more"):
        thing.pull()
    thing.close()


def test_wrong_values_are_refused(thing: FmuInstance) -> None:
    with pytest.raises(WiringError, match=r"thing.speed has shape \[\], but was given \[2\]"):
        thing.set("speed", [1.0, 2.0])
    with pytest.raises(WiringError, match="thing has no variable 'sped'; did you mean 'speed'"):
        thing.set("sped", 1.0)
    with pytest.raises(WiringError, match="takes"):
        thing.set("text", 5)
