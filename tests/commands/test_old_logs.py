"""Old logs from the command line: set side by side, told apart, compared to the bit, run again."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from commandline import Command
from rerun.chunk import RrdReader

from logs.read import properties, signals
from studies.recall import labels, recall

BRIEF = ("--duration", "0.02")


@pytest.fixture
def logs(wmr: Command, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return logs of 20 ms by name; they are made once."""
    folder = tmp_path_factory.getbasetemp() / "old"
    wanted = {
        "pd": ("ramp-impact", "pd-friction"), "coarse": ("ramp-impact", "pd-friction", "--step", "2e-4"),
        "free": ("ramp-impact", "uncontrolled"), "soft": ("ramp-impact-realistic", "pd"),
        "few": ("ramp-impact", "uncontrolled", "--set", 'run.signals=["wheels.normal_force","body.pitch"]'),
    }  # fmt: skip
    for name, (scenario, variant, *more) in wanted.items():
        if not (folder / name).exists():
            said = wmr("run", scenario, "--variant", variant, *BRIEF, *more, "--out", folder / name)
            assert said.code == 0, said
    return {name: folder / name / f"{scenario}-{variant}.rrd" for name, (scenario, variant, *_) in wanted.items()}


def test_two_old_logs_are_compared_as_two_new_runs(wmr: Command, logs: dict[str, Path], tmp_path: Path) -> None:
    new = json.loads(wmr("compare", "ramp-impact", "--variants", "uncontrolled,pd-friction", *BRIEF, "--out",
                         tmp_path / "new", "--baseline", "pd-friction", "--json").out)  # fmt: skip
    said = wmr("compare", "--logs", logs["free"], logs["pd"], "--baseline", "pd-friction", "--out", tmp_path / "old",
               "--report", tmp_path / "r.html", "--json")  # fmt: skip
    assert (said.code, said.err) == (0, "")
    old = json.loads(said.out)
    assert old["baseline"] == "pd-friction"
    assert (old["rows"], old["in_words"]) == (new["rows"], new["in_words"])
    assert [run["log"] for run in old["runs"]] == [str(logs["pd"]), str(logs["free"])]
    a, b = (signals(Path(document["combined"])) for document in (old, new))
    assert set(a) == set(b)
    for port in (p for p in a if "wall" not in p):
        np.testing.assert_array_equal(a[port].values, b[port].values, err_msg=port)
    assert Path(old["picture"]).read_bytes().startswith(b"\x89PNG")
    report = Path(old["report"]).read_text()
    assert "wmr-cosim compare --logs" in report
    assert "data:image/png;base64," in report  # the sketches
    tables = properties(Path(old["combined"]))
    assert tables["compare"]["base"] == "pd-friction"


def test_one_variant_at_two_step_sizes(wmr: Command, logs: dict[str, Path], tmp_path: Path) -> None:
    """The names tell them apart, and the differences are taken at every time of either."""
    said = wmr("compare", "--logs", logs["pd"], logs["coarse"], "--out", tmp_path, "--json")
    document = json.loads(said.out)
    assert [run["variant"] for run in document["runs"]] == [
        "pd/ramp-impact-pd-friction",
        "coarse/ramp-impact-pd-friction",
    ]
    found = signals(Path(document["combined"]))
    fine, coarse = (signals(logs[n])["body.pitch"] for n in ("pd", "coarse"))
    difference = found["diff.coarse/ramp-impact-pd-friction.plant.body.pitch"]
    assert difference.ns.tolist() == np.union1d(fine.ns, coarse.ns).tolist()
    both = np.isin(difference.ns, coarse.ns) & np.isin(difference.ns, fine.ns)
    exact = coarse.values[np.isin(coarse.ns, fine.ns)] - fine.values[np.isin(fine.ns, coarse.ns)]
    np.testing.assert_array_equal(difference.values[both], exact)
    assert np.any(exact)


def test_different_scenarios_are_compared_with_a_note(wmr: Command, logs: dict[str, Path], tmp_path: Path) -> None:
    said = wmr("compare", "--logs", logs["pd"], logs["soft"], "--out", tmp_path)
    assert said.code == 0
    assert said.err == (
        "note: these are runs of different scenarios (pd-friction of ramp-impact, pd of ramp-impact-realistic): what "
        "differs is not only what is compared\n"
    )
    assert said.out.splitlines()[0] == "Runs of ramp-impact, ramp-impact-realistic"
    assert "Claim" not in said.out
    (document,) = RrdReader(str(tmp_path / "logs-all.rrd")).stream().filter(content="/report")
    text = str(document.to_record_batch().to_pylist())
    assert "Runs of ramp-impact, ramp-impact-realistic" in text
    assert "Note: these are runs of different scenarios" in text


def test_a_run_that_broke_off_is_compared_as_far_as_it_goes(
    wmr: Command, logs: dict[str, Path], tmp_path: Path
) -> None:
    """A log as a killed run leaves it has no outcome: it says so, and what there is of it is compared."""
    cut = tmp_path / "ramp-impact-killed.rrd"
    RrdReader(str(logs["free"])).stream().drop(content="/__properties/outcome").write_rrd(
        str(cut), application_id="wmr_cosim", recording_id="killed"
    )
    said = wmr("compare", "--logs", logs["pd"], cut, "--out", tmp_path)
    assert said.code == 0
    assert said.err == "note: uncontrolled did not reach its end: the log breaks off: the run was killed\n"


def test_what_cannot_be_compared(wmr: Command, logs: dict[str, Path], tmp_path: Path) -> None:
    assert wmr("compare", "--logs", logs["pd"], logs["free"], "--out", tmp_path).code == 0
    combined = tmp_path / "ramp-impact-logs-all.rrd"
    said = wmr("compare", "--logs", logs["pd"], combined)
    assert (said.code, said.err) == (
        1,
        f"error: {combined} is a comparison, not the log of a run; name one of its runs' (pd-friction, uncontrolled)\n",
    )
    said = wmr("compare", "--logs", logs["pd"], logs["pd"])
    assert said.err == f"error: the log {logs['pd']} is named twice; a run cannot be compared with itself\n"
    said = wmr("inspect", combined, "--rerun")
    assert said.err.startswith(f"error: {combined} is a comparison, not the log of a run")


def test_a_log_of_few_signals_keeps_the_verdict_that_it_states(logs: dict[str, Path]) -> None:
    """Where the signals are there, the verdict computed afresh is the one stated, to the bit."""
    for name in ("free", "few"):
        stated = properties(logs[name])["metrics"]
        metrics = recall(logs[name], name).result.metrics
        assert {m.key: m.value for m in metrics if m.value is not None} == {
            k: v for k, v in stated.items() if v is not None
        }
    assert recall(logs["few"], "few").result.signal("wheels.traction") is None
    assert recall(logs["free"], "free").result.assembly.ground is not None


def test_names_tell_runs_apart(logs: dict[str, Path]) -> None:
    assert labels([logs["pd"], logs["free"]]) == ["pd-friction", "uncontrolled"]
    assert labels([logs["free"], logs["few"]]) == ["free/ramp-impact-uncontrolled", "few/ramp-impact-uncontrolled"]


def test_signals_are_exported(wmr: Command, logs: dict[str, Path], tmp_path: Path) -> None:
    said = wmr("inspect", logs["pd"], "--signals", "body.pitch", "--mcap", tmp_path / "x.mcap", "--csv",
               tmp_path / "x.csv")  # fmt: skip
    assert said.code == 0
    assert said.out.splitlines()[-2:] == [f"wrote {tmp_path / name}" for name in ("x.csv", "x.mcap")]
    assert (tmp_path / "x.mcap").read_bytes().startswith(b"\x89MCAP")
    assert (tmp_path / "x.csv").read_text().startswith('"time [s]","body.pitch [rad]"')


# inspect --diff and --rerun


def test_a_log_differs_from_another(wmr: Command, logs: dict[str, Path]) -> None:
    said = wmr("inspect", logs["pd"], "--diff", logs["free"], "--signals", "body.in.*,wheels.normal_force")
    assert (said.code, said.err) == (1, "")
    head, _, *rows = said.out.splitlines()
    assert head == f"{logs['pd']} and {logs['free']}: 4 of 7 signals are the same to the bit"
    assert [row.split()[0] for row in rows] == ["body.in.normal_force", "body.in.traction", "wheels.normal_force"]


def test_a_log_is_itself(wmr: Command, logs: dict[str, Path]) -> None:
    said = wmr("inspect", logs["pd"], "--diff", logs["pd"], "--json")
    assert said.code == 0
    document = json.loads(said.out)
    assert document["identical"] is True
    assert {s["port"] for s in document["signals"]} == set(signals(logs["pd"])) - {"master.wall"}


def test_a_log_is_reproduced(wmr: Command, logs: dict[str, Path]) -> None:
    said = wmr("inspect", logs["pd"], "--rerun")
    assert (said.code, said.err) == (0, "")
    assert said.out.startswith(f"{logs['pd']}: reproduced: the same bits in all ")
    document = json.loads(wmr("inspect", logs["pd"], "--rerun", "--json").out)
    assert (document["identical"], document["reasons"]) == (True, [])


def test_inspect_tells_configuration_and_health(wmr: Command, logs: dict[str, Path]) -> None:
    said = wmr("inspect", logs["coarse"])
    rows = {line.split()[0]: line.split()[1:] for line in said.out.splitlines() if line.split()}
    assert rows["run.step"] == ["0.0002"]
    assert rows["components.controller.type"] == ['"PdImpact"']
    assert rows["gap_mismatch"][1] == "to"
    steps = len(signals(logs["coarse"])["master.wall"].ns) - 1
    assert " ".join(rows["wall"]).split(" s for ")[1].startswith(f"{steps} steps, ")
    health = json.loads(wmr("inspect", logs["coarse"], "--json").out)["health"]
    assert health["master.step_size"]["max"] == pytest.approx(2e-4)


def test_logs_are_listed(wmr: Command, logs: dict[str, Path]) -> None:
    folder = logs["pd"].parents[1]
    said = wmr("logs", folder, "--where", "scenario=ramp-impact", "--sort", "-step_s", "--show", "step_s,front_off")
    assert (said.code, said.err) == (0, "")
    rows = [line.split() for line in said.out.splitlines()]
    assert rows[0] == ["scenario", "variant", "status", "started_utc", "step_s", "front_off", "file"]
    assert [row[4] for row in rows[1:]] == ["0.0002", "0.0001", "0.0001", "0.0001"]
    document = json.loads(wmr("logs", folder, "--where", "scenario!=ramp-impact", "--json").out)
    assert [row["path"] for row in document] == [str(logs["soft"])]
