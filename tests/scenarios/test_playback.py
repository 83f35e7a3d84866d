"""Off-line impact control (thesis 6.6): forces of an earlier run or of the analytical model, played back."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim.errors import ScenarioError
from logs.inspect import export
from logs.recorder import RerunRecorder
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.metrics import as_mapping
from studies.runner import Result, execute

FILE = find_scenario("ramp-impact")
HARD = {"type": "WheelDeformation", "k_w": 2.8e6, "c_w": 0.0, "mu": 0.8}
PD = {"type": "PdImpact", "h0": 1500.0, "h1": 70.0, "k_w": 2.8e6, "limits": "friction", "mu": 0.8, "period": 1e-4}
PRINTED = {"h0": 1500.0, "h1": 70.0, "z_target": [-0.02, -0.02, -0.01, -0.01]}


def run(controller: dict[str, Any], wheels: dict[str, Any] = HARD, duration: float = 0.3, *observers: Any) -> Result:
    """Return a finished run of the ramp with another controller and other wheels."""
    changes = {"components": {"controller": controller, "wheels": wheels}, "run": {"duration": duration}}
    result = execute(FILE.load(None, [changes]), lambda *_: observers)
    assert result.error is None
    return result


@cache
def verdict(source: str, mu: float) -> dict[str, float]:
    """Return the metrics of the ramp with no control, or with off-line forces to a given or to the static end."""
    off_line = PRINTED if source == "printed" else {"h0": 1500.0, "h1": 70.0}
    controller = {"type": "Uncontrolled"} if source == "none" else {"type": "Playback", "off_line": off_line}
    metrics = as_mapping(run(controller, {**HARD, "mu": mu}).metrics)
    return {key: value for key, value in metrics.items() if value is not None}


def test_the_forces_of_a_log_repeat_its_run(tmp_path: Path) -> None:
    """A recorded demand held from the tick at which it was decided: the same forces, so the same motion, to the bit."""
    log = tmp_path / "pd.rrd"
    first = run(PD, HARD, 0.03, RerunRecorder(log, "pd"))
    assert np.max(np.abs(first.record["controller.traction_demand"])) > 100  # the law was at work
    csv = export(log, tmp_path / "pd.csv", ["controller.traction_demand"])
    for source in ({"log": str(log)}, {"file": str(csv), "port": "controller.traction_demand"}):
        again = run({"type": "Playback", "period": 1e-4, **source}, HARD, 0.03)
        for port in ("wheels.normal_force", "wheels.traction", "body.position", "body.orientation"):
            np.testing.assert_array_equal(again.record[port], first.record[port])


def test_off_line_forces_prevent_the_rebound_if_friction_lets_them_through() -> None:
    """To the static deflection, which needs no traction to stay at: as the thesis finds on its finite-element model."""
    free, held = verdict("none", 0.8), verdict("static", 1e6)
    assert free["front_rebounds"] >= 1
    assert (held["front_rebounds"], held["front_off"]) == (0, 0)
    assert held["demand_peak"] > 100 * 170 * 9.81 / 4  # of a quarter of the weight


@pytest.mark.parametrize(("k_w", "works"), [(2.8e6 * 1.02, True), (2.8e6 * 1.1, False), (2.8e6 * 0.9, False)])
def test_off_line_forces_need_an_accurate_model(k_w: float, works: bool) -> None:
    """As the thesis says: 2 % in the stiffness of the wheels is forgiven, 10 % is not."""
    off_line = {"h0": 1500.0, "h1": 70.0, "k_w": k_w}
    metrics = as_mapping(run({"type": "Playback", "off_line": off_line}, {**HARD, "mu": 1e6}).metrics)
    assert (metrics["front_off"] == metrics["rear_off"] == 0) == works


def test_with_the_printed_final_deformations_they_do_not() -> None:
    """To press the wheels in by 20 mm takes 377 times the weight, for ever; nothing notices what the robot does."""
    held = verdict("printed", 1e6)
    assert held["front_off"] > 100  # ms of 300
    assert held["speed_max"] > 20  # m/s, of a robot that came with 2


def test_with_the_friction_there_is_they_change_little() -> None:
    free, clipped = verdict("none", 0.8), verdict("static", 0.8)
    assert clipped["front_off"] > 0.9 * free["front_off"]


@pytest.mark.parametrize(
    ("controller", "sentence"),
    [
        ({}, "playback needs one of file, log, off_line, not none"),
        ({"file": "a.csv", "log": "b.rrd"}, "playback needs one of file, log, off_line, not file and log"),
        ({"log": "nowhere.rrd"}, r"there is no log nowhere.rrd"),
        ({"file": "nowhere.csv"}, r"cannot read the forces nowhere.csv"),
        ({"off_line": {"T": 0.1, "z_targets": 1.0}}, r"off_line.z_targets is not known; did you mean 'z_target'"),
        ({"off_line": 0.1}, r"off_line must be a table of h0"),
        ({"off_line": {"T": 0.0}}, r"off_line.T is 0, but off-line forces need a positive one"),
    ],
)
def test_what_cannot_be_played_is_said(controller: dict[str, Any], sentence: str) -> None:
    changes = {"components": {"controller": {"type": "Playback", **controller}}}
    with pytest.raises(ScenarioError, match=sentence):
        assemble(FILE.load(None, [changes]))


def test_off_line_forces_need_an_impact() -> None:
    off_line = {"components": {"controller": {"type": "Playback", "off_line": {"T": 0.1}}}}
    smooth = {"ground": {"kind": "hump", "start": 0.7, "length": 1.0, "height": 0.05}}
    with pytest.raises(ScenarioError, match="off-line forces need the same sharp foot under both tracks"):
        assemble(FILE.load(None, [off_line, smooth]))
    rigid = {"components": {"wheels": {"type": "RigidContact"}}}
    with pytest.raises(ScenarioError, match="off_line needs k_w, the stiffness of a wheel in N/m"):
        assemble(FILE.load(None, [off_line, rigid]))
    with pytest.raises(ScenarioError, match=r"the front wheels meet the obstacle at t = 0.0\d* s, outside the run"):
        assemble(FILE.load(None, [off_line, {"run": {"duration": 0.005}}]))


def test_a_log_needs_four_forces(tmp_path: Path) -> None:
    log = tmp_path / "short.rrd"
    run({"type": "Uncontrolled"}, HARD, 0.003, RerunRecorder(log, "short"))
    for port, sentence in (
        ("wheels.tractions", "has no signal 'wheels.tractions'; did you mean 'wheels.traction'"),
        ("body.velocity", "body.velocity of the log .* has 3 values, but there are 4 wheels"),
        ("wheels.deformation", "'wheels.deformation' is in m, which is another quantity; playback needs N"),
    ):
        with pytest.raises(ScenarioError, match=sentence):
            run({"type": "Playback", "log": str(log), "port": port}, HARD, 0.003)
