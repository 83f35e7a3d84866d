"""An FMU in a process of its own: the same bits, and nothing of it is left when it or its importer ends."""

from __future__ import annotations

import zipfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from odd import odd
from toys import Mass
from typer.testing import CliRunner

import fmus
from cosim import ExportError, Instance, ScenarioError, WiringError
from cosim.clock import NS
from fmus import FmuInstance, IsolatedFmu
from plants.wheel_deformation import WheelDeformation
from studies.catalog import find_scenario
from studies.cli import app
from studies.runner import Result, execute

H = NS // 1000
ROOT = Path(__file__).parents[2]


def rover_run(**wheels: Any) -> Result:
    changes: dict[str, Any] = {"run": {"duration": 0.02}, "components": {"wheels": wheels}}
    return execute(find_scenario("ramp-impact").load("uncontrolled", [changes]))


def test_the_rover_on_isolated_wheels_is_the_same_to_the_bit() -> None:
    here, there = rover_run(), rover_run(isolated=True, time_limit=10.0)
    assert there.error is None
    assert np.array_equal(here.record.time, there.record.time)
    names = here.record.ports()
    assert len(names) > 20
    for name in names:
        assert here.record[name].tobytes() == there.record[name].tobytes(), name


def pair(fmi: int) -> tuple[FmuInstance, IsolatedFmu]:
    found = [fmus.instantiate(WheelDeformation(), "wheels", fmi=fmi, isolated=isolated) for isolated in (False, True)]
    for instance in found:
        instance.u[instance.u_at["gap"]] = [-2e-3, -2e-3, -1e-3, 1e-3]
        instance.u[instance.u_at["P"]] = np.ravel(0.01 + 0.02 * np.eye(4))
        instance.enter_initialization(0, NS)
        instance.push()
        instance.exit_initialization()
        instance.pull()
    return found[0], found[1]  # type: ignore[return-value]


def stepped(instance: Instance, first: int, last: int) -> bytes:
    found = b""
    for k in range(first, last):
        instance.u[instance.u_at["gap_rate"]] = -0.1 * np.cos(k + np.arange(4))
        instance.push()
        instance.step(k * H, (k + 1) * H)
        instance.pull()
        found += instance.y.tobytes()
    return found


def test_it_can_do_what_the_fmu_can(fmi: int) -> None:
    """Steps, values, snapshots through bytes, derivatives, states, reset: each as in this process, to the bit."""
    here, there = pair(fmi)
    assert isinstance(there, IsolatedFmu)
    assert here.can == there.can
    assert here.y.tobytes() == there.y.tobytes()
    assert stepped(here, 0, 5) == stepped(there, 0, 5)
    assert here.time == there.time
    saved, kept = here.snapshot(), there.snapshot()
    data = there.serialize(kept)
    assert here.serialize(saved) == data
    went_on = stepped(here, 5, 9)
    assert stepped(there, 5, 9) == went_on
    there.restore(kept)
    assert stepped(there, 5, 9) == went_on
    there.forget(kept)
    loaded = there.deserialize(data)
    there.restore(loaded)
    assert stepped(there, 5, 9) == went_on
    seed = np.arange(1.0, 17.0)
    derivatives = [i.directional_derivative(["normal_force_end"], ["P"], seed) for i in (here, there)]
    assert np.array_equal(*derivatives)
    for instance in (here, there):
        instance.move("z", [1e-3, 0, 0, 2e-3])
    assert stepped(here, 9, 12) == stepped(there, 9, 12)
    assert all(np.array_equal(here.get(n), there.get(n), equal_nan=True) for n in ("k_w", "normal_force_end", "gap"))
    for instance in (here, there):
        instance.reset()
        instance.enter_initialization(0, NS)
        instance.push()
        instance.exit_initialization()
    assert stepped(here, 0, 5) == stepped(there, 0, 5)
    here.close()
    there.close()


def test_a_push_counts_before_whatever_follows(fmi: int, odd_fmus: dict[int, Path]) -> None:
    """Inputs are handed over late, but a pull, a snapshot or a reading after a push sees them."""
    instance = fmus.load(odd_fmus[fmi], "odd", isolated=True)
    instance.enter_initialization()
    instance.exit_initialization()
    instance.u[0] = 3.0
    instance.push()
    instance.u[0] = 4.0  # not pushed
    assert instance.get("u") == 3.0
    kept = instance.snapshot()
    instance.set("u", 5.0)
    instance.step(0, NS)
    instance.pull()
    assert instance.y[0] == 5.0
    instance.restore(kept)
    assert (instance.get("u"), instance.u[0]) == (3.0, 4.0)
    instance.close()


def test_mistakes_are_said_as_in_this_process(fmi: int, odd_fmus: dict[int, Path]) -> None:
    said = []
    for isolated in (False, True):
        instance = fmus.load(odd_fmus[fmi], isolated=isolated)
        instance.name = "renamed"
        for act in (
            partial(instance.set, "y", [1.0, 2.0]),
            partial(instance.get, "z"),
            partial(instance.move, "x", 1.0),
            partial(instance.directional_derivative, ["y"], ["u"], np.ones(1)),
        ):
            with pytest.raises(WiringError) as found:
                act()
            said.append(str(found.value))
        instance.close()
        instance.close()
        for late in (instance.push, instance.pull, instance.snapshot, partial(instance.step, 0, NS)):
            with pytest.raises(WiringError, match="renamed was closed and cannot be used any more"):
                late()
    assert said[:4] == said[4:]
    assert said[0].startswith("renamed.y has shape")


def test_only_one_in_this_process(fmi: int, tmp_path: Path) -> None:
    path = odd(tmp_path, fmi, 'canBeInstantiatedOnlyOncePerProcess="true"')
    first, second = fmus.load(path), fmus.load(path)
    assert (type(first) is IsolatedFmu, type(second) is IsolatedFmu) == (False, True)
    first.close()
    third = fmus.load(path)
    assert isinstance(third, FmuInstance)
    second.close()
    third.close()


def test_an_fmu_that_needs_its_tool(fmi: int, tmp_path: Path) -> None:
    instance = fmus.load(odd(tmp_path, fmi, 'needsExecutionTool="true"'))
    assert isinstance(instance, IsolatedFmu)
    instance.close()


def test_what_lies_in_the_working_folder_is_not_imported(
    odd_fmus: dict[int, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "pickle.py").write_text("raise SystemExit('somebody else's pickle')")
    monkeypatch.chdir(tmp_path)
    fmus.load(odd_fmus[2], isolated=True).close()


def test_a_crash_while_it_is_checked_is_a_problem(fmi: int, tmp_path: Path) -> None:
    path = odd(tmp_path, fmi, oddity="crash at the start")
    done = CliRunner().invoke(app, ["fmu", "check", str(path)])
    assert done.exit_code == 1
    assert f"Odd failed at t = 0 s: it crashed in fmi{fmi}EnterInitializationMode: SIGABRT (aborted)" in done.output


def test_a_time_limit_needs_a_process(fmi: int, odd_fmus: dict[int, Path]) -> None:
    with pytest.raises(ExportError, match="can have a time limit only in a process of its own"):
        fmus.load(odd_fmus[fmi], isolated=False, time_limit=1.0)
    with pytest.raises(ExportError, match=r"the time limit of odd.*is 0 s; it must be positive"):
        fmus.load(odd_fmus[fmi], time_limit=0.0)


def test_what_cannot_be_instantiated_is_said(fmi: int, tmp_path: Path) -> None:
    path = fmus.build(Mass(), fmi=fmi)
    broken = tmp_path / path.name
    token = str(fmus.info(path)["token"])
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(broken, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, data.replace(token.encode(), b"{x}") if name.endswith("Description.xml") else data)
    with pytest.raises(ExportError, match=r"cannot be instantiated: the .* is \{x\}, but this binary was built for"):
        fmus.load(broken, isolated=True)


@pytest.mark.parametrize("key", ["isolated", "time_limit", "retry"])
def test_a_scenario_with_something_else(key: str) -> None:
    with pytest.raises(ScenarioError, match=rf"components\.wheels\.{key}"):
        find_scenario("ramp-impact").load(None, [{"components": {"wheels": {key: "maybe"}}}])
