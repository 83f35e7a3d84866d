"""A log is run again from what it says about itself: the same bits, or the reason why not."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import Chunk, RrdReader
from toys import Fading

import fmus
from cosim import Component, output, parameter
from cosim.errors import ScenarioError
from cosim.scenario import ScenarioFile
from logs.read import properties, signals
from studies.catalog import find_scenario
from studies.inputs import digest
from studies.recall import recall
from studies.reproduce import reproduce
from studies.session import run_scenario


class Steady(Component):
    """y = k."""

    k = parameter(1.0, "m", "value")
    y = output("m", "value")

    def outputs(s):  # type: ignore[no-untyped-def]
        return dict(y=s.k)


class Rising(Steady):
    """y = k (1 + t): the same ports, another behaviour."""

    def outputs(s):  # type: ignore[no-untyped-def]
        return dict(y=s.k * (1 + s.time))


class FadingSoon(Fading):
    """The same, ending at 0.055 s: in the step that begins at 0.05 s."""

    end = parameter(0.055, "s", "when it ends")


class Renamed(Component):
    """z = 1: another port."""

    z = output("m", "value")

    def outputs(s):  # type: ignore[no-untyped-def]
        return dict(z=1.0)


def impact(folder: Path, *changes: str) -> Path:
    """Log 20 ms of the ramp impact."""
    file = find_scenario("ramp-impact")
    log = run_scenario(file.load("pd-friction", file.overrides(["run.duration=0.02", *changes])), folder).log
    assert log is not None
    return log


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return impact(tmp_path_factory.mktemp("reproduce"))


def tampered(log: Path, out: Path, title: str, change: Callable[[dict], object]) -> Path:
    """Copy a log with one table of its properties changed."""
    table = properties(log)[title]
    change(table)
    kept = RrdReader(str(log)).stream().drop(content=f"/__properties/{title}")
    other = RrdReader(str(log)).recordings()[0]
    new = Chunk.from_property(title, rr.AnyValues(**{k: v for k, v in table.items() if v is not None}))
    kept.merge(kept, type(kept).from_iter([new])).write_rrd(
        str(out), application_id=other.application_id, recording_id=other.recording_id
    )
    return out


def test_a_run_is_reproduced_bit_for_bit(log: Path) -> None:
    done = reproduce(log)
    assert done.exact
    assert done.reasons == []
    assert len(done.differences) == len(signals(log)) - 1  # all but the wall clock
    assert done.sentence() == f"reproduced: the same bits in all {len(done.differences)} signals at the same times"


def test_a_log_that_gives_another_configuration_is_not(log: Path, tmp_path: Path) -> None:
    def softer(run: dict) -> None:
        config = json.loads(run["config_json"])
        config["components"]["wheels"]["k_w"] *= 1 + 1e-12
        run["config_json"] = json.dumps(config)

    done = reproduce(tampered(log, tmp_path / "a.rrd", "run", softer))
    assert not done.exact
    assert done.sentence().startswith("not reproduced: ")
    assert done.sentence().endswith("nothing that the log names has changed, so it is not deterministic here")


@pytest.mark.parametrize(
    ("title", "key", "reason"),
    [
        ("provenance", "numpy", "numpy was 0.0.1 and is {}"),
        ("provenance", "token_wheels", "the token of the FMU of wheels was 0.0.1 and is {}"),
        ("provenance", "sources", "the hash of the sources was 0.0.1 and is {}"),
        ("host", "cpu", "cpu was 0.0.1 and is {}"),
    ],
)
def test_another_version_is_named_but_does_no_harm(
    log: Path, tmp_path: Path, title: str, key: str, reason: str
) -> None:
    now = properties(log)[title][key]
    done = reproduce(tampered(log, tmp_path / "a.rrd", title, lambda t: t.update({key: "0.0.1"})))
    assert done.exact
    assert done.reasons == [reason.format(now)]
    assert done.sentence().endswith(f"at the same times, though {reason.format(now)}")


def foreign(folder: Path, component: Component) -> Path:
    """Put an FMU called thing.fmu and a scenario with it into *folder*."""
    shutil.copy(fmus.build(component, folder=folder / "built"), folder / "thing.fmu")
    path = folder / "foreign.toml"
    path.write_text(
        'title = "t"\nclaim = "c"\n[run]\nstep = 0.01\nduration = 0.1\n'
        f'[components.thing]\nfmu = "{folder / "thing.fmu"}"\n'
    )
    return path


def test_a_foreign_fmu_that_changed_is_the_reason(tmp_path: Path) -> None:
    done = run_scenario(ScenarioFile(foreign(tmp_path, Steady())).load(), tmp_path)
    assert done.log is not None
    assert reproduce(done.log).exact
    foreign(tmp_path, Rising())
    again = reproduce(done.log)
    assert not again.exact
    assert again.reasons[0] == f"the file {tmp_path / 'thing.fmu'} has changed"
    assert again.reasons[1].startswith("the token of the FMU of thing was {")
    (off,) = (d for d in again.differences if not d.identical)
    assert (off.port, off.since) == ("thing.y", pytest.approx(0.01))
    foreign(tmp_path, Renamed())
    found = {d.port: d.only for d in reproduce(done.log).differences if not d.identical}
    assert found == {"thing.y": "one", "thing.z": "other"}
    (tmp_path / "thing.fmu").unlink()
    with pytest.raises(ScenarioError, match=r"cannot be run again: the file .*thing\.fmu that it read is gone"):
        reproduce(done.log)
    (tmp_path / "thing.fmu").write_text("no FMU")
    with pytest.raises(ScenarioError, match=r"cannot be run again \(the file .* has changed\): .* is not an FMU"):
        reproduce(done.log)


def test_a_run_that_failed_fails_again_at_the_same_bit(tmp_path: Path) -> None:
    folder = tmp_path / "a"
    folder.mkdir()
    done = run_scenario(ScenarioFile(foreign(folder, FadingSoon())).load(), folder)
    assert done.result.error is not None
    assert done.log is not None
    assert properties(done.log)["outcome"]["status"] == "failed"
    again = reproduce(done.log)
    assert again.exact
    assert again.sentence() == "reproduced: the same bits in all 2 signals at the same times"
    foreign(folder, Fading())  # lasts for the whole 0.1 s and more
    longer = reproduce(done.log)
    assert not longer.exact
    assert longer.sentence().startswith("not reproduced: 2 of 2 signals differ, first thing.y at 0.01 s: the file ")


def test_a_ground_from_a_file_that_moved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The file is named relative to the folder that the run was begun in; the log knows it in full."""
    monkeypatch.chdir(tmp_path)
    x = np.linspace(0, 3, 31)
    rows = "\n".join(f"{a!r},{float(0.01 * np.sin(a) ** 2)!r}" for a in x.tolist())
    Path("road.csv").write_text(f"x,height\n{rows}\n")
    own = tmp_path / "own.toml"
    text = Path(find_scenario("ramp-impact").path).read_text()
    section = text[text.index("[ground]") : text.index("[", text.index("[ground]") + 1)]
    own.write_text(text.replace(section, '[ground]\nkind = "csv"\npath = "road.csv"\n\n'))
    file = ScenarioFile(own)
    log = run_scenario(file.load(None, file.overrides(["run.duration=0.01"])), tmp_path).log
    assert log is not None
    assert properties(log)["files"] == {
        "name": "road.csv", "path": str(tmp_path / "road.csv"), "sha256": digest(Path("road.csv")),
    }  # fmt: skip
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert reproduce(log).exact
    assert recall(log, "x").result.assembly.ground is not None
    moved = (tmp_path / "road.csv").rename(tmp_path / "street.csv")
    with pytest.raises(ScenarioError, match=r"the file .*/road\.csv \(called road\.csv there\) that it read is gone"):
        reproduce(log)
    lost = recall(log, "x").result.assembly
    assert lost.ground is None
    assert "there is no ground to draw" in lost.notes[0]
    (tmp_path / "road.csv").write_text(moved.read_text().replace("0.0,0.0\n", "0.0,1e-9\n"))
    again = reproduce(log)
    assert not again.exact
    assert again.reasons[0] == f"the file {tmp_path / 'road.csv'} has changed"


def test_an_unfinished_log_is_compared_as_far_as_it_goes(log: Path, tmp_path: Path) -> None:
    """As one that was stopped leaves it: 20 of the 30 ms that its configuration asks for."""
    config = properties(impact(tmp_path, "run.duration=0.03"))["run"]["config_json"]
    stopped = tampered(log, tmp_path / "stopped.rrd", "outcome", lambda t: t.update(status="interrupted"))
    half = tampered(stopped, tmp_path / "half.rrd", "run", lambda t: t.update(config_json=config))
    done = reproduce(half)
    assert done.exact, done.sentence()
    assert done.sentence().endswith("at the same times, as far as the log goes (interrupted)")


def test_what_cannot_be_run_again(log: Path, tmp_path: Path) -> None:
    bare = tampered(log, tmp_path / "bare.rrd", "run", lambda t: t.pop("config_json"))
    with pytest.raises(ScenarioError, match="does not hold the configuration of its run, so it cannot be run again"):
        reproduce(bare)
    odd = tampered(log, tmp_path / "odd.rrd", "run", lambda t: t.update(config_json='{"name": "x"}'))
    with pytest.raises(ScenarioError, match="this version does not understand the configuration in"):
        reproduce(odd)
