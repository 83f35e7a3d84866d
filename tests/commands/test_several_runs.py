"""Commands beside others: two at once, one that is watched, and a comparison of which one run fails."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
from pathlib import Path
from time import monotonic, sleep
from typing import Any
from urllib.error import URLError
from urllib.request import urlopen

import numpy as np
import pytest
from commandline import Command, FadingSoon
from toys import Fading

import fmus
from cosim.scenario import Scenario
from logs.inspect import describe
from logs.read import signals
from studies.catalog import find_scenario
from studies.parallel import together
from studies.terminal import SILENT, Bar

ROOT = Path(__file__).parents[2]


def test_two_commands_into_one_folder_at_once(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "studies.cli", "compare", "ramp-impact", "--variants", "uncontrolled,pd-friction",
               "--duration", "0.02", "--out", str(tmp_path), "--json"]  # fmt: skip
    started = [
        subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in "ab"
    ]
    answers = [process.communicate(timeout=120) for process in started]
    assert [process.returncode for process in started] == [0, 0], answers
    documents = [json.loads(out) for out, _ in answers]
    assert documents[0]["rows"] == documents[1]["rows"]
    names = ("ramp-impact.png", "ramp-impact-all.rrd", "ramp-impact-pd-friction.rrd", "ramp-impact-uncontrolled.rrd")
    assert {p.name for p in tmp_path.iterdir()} == set(names)
    for run in documents[0]["runs"]:
        facts = describe(Path(run["log"]), ["body.pitch"])
        assert facts["status"] == "complete"
        assert facts["signals"]["body.pitch"]["rows"] == facts["properties"]["outcome"]["steps"] + 1


def test_a_served_run_is_watched_until_ctrl_c(tmp_path: Path) -> None:
    """The page is there while the run goes and after it; Ctrl-C ends it, and the command did what it was asked."""
    command = [sys.executable, "-m", "studies.cli", "run", "ramp-impact", "--duration", "0.02", "--out", str(tmp_path),
               "--serve", "--json"]  # fmt: skip
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    page = process.stderr.readline().strip().removeprefix("note: look at it at ")
    assert page.startswith("http://127.0.0.1:")
    assert process.stderr.readline() == "note: the page is served until Ctrl-C\n"
    assert urlopen(page.partition("?")[0], timeout=10).status == 200
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (0, "")
    assert describe(Path(json.loads(out)["log"]), ["body.pitch"])["status"] == "complete"
    with pytest.raises(URLError):
        urlopen(page, timeout=5)


def test_a_comparison_of_which_one_run_fails(wmr: Command, tmp_path: Path) -> None:
    """The others are compared all the same, over the time that both were on; the exit code tells."""
    scenario = tmp_path / "fading.toml"
    paths = [fmus.build(c(), folder=tmp_path) for c in (Fading, FadingSoon)]
    scenario.write_text(
        'title = "t"\nclaim = "c"\n[run]\nstep = 0.01\nduration = 0.2\n'
        f'[variants.long]\ncomponents.thing.fmu = "{paths[0]}"\n[variants.short]\ncomponents.thing.fmu = "{paths[1]}"\n'
    )
    out = tmp_path / "out"
    said = wmr("compare", scenario, "--out", out, "--json")
    assert said.code == 1
    (line,) = said.err.splitlines()
    assert line.startswith("error: fading short: thing failed at t = 0.1 s: ")
    assert line.endswith(f"; the log up to there is {out / 'fading-short.rrd'}")
    document = json.loads(said.out)
    assert [run["error"] is None for run in document["runs"]] == [True, False]
    assert document["picture"] is None  # none of the signals that the picture shows
    found = signals(Path(document["combined"]))
    assert len(found["long.plant.thing.y"].ns) == 21
    difference = found["diff.short.plant.thing.y"]
    assert difference.ns.tolist() == [k * 10_000_000 for k in range(11)]
    own = [signals(out / f"fading-{name}.rrd")["thing.y"].values[:11] for name in ("long", "short")]
    np.testing.assert_array_equal(difference.values, own[1] - own[0])


# several variants at once


def compared(wmr: Command, out: Path, jobs: int) -> tuple[dict[str, Any], dict[str, bytes]]:
    """Return the answer of a comparison, without times and places, and every value of its combined log."""
    said = wmr("compare", "ramp-impact", "--variants", "uncontrolled,pd-friction,lqr", "--duration", "0.05",
               "--out", out, "--jobs", jobs, "--json")  # fmt: skip
    assert said.code == 0, said.err
    document = json.loads(said.out)
    values = {
        port: held.ns.tobytes() + held.values.tobytes()
        for port, held in signals(Path(document["combined"])).items()
        if not port.endswith("master.wall")
    }
    runs = [{key: run[key] for key in ("variant", "error", "metrics")} for run in document["runs"]]
    return {"rows": document["rows"], "words": document["in_words"], "runs": runs}, values


def test_at_once_or_in_turn_is_the_same(wmr: Command, tmp_path: Path) -> None:
    """To the bit, in the order of the file."""
    answer, values = compared(wmr, tmp_path / "turn", 1)
    assert [run["variant"] for run in answer["runs"]] == ["uncontrolled", "pd-friction", "lqr"]
    assert len(values) > 100
    again, others = compared(wmr, tmp_path / "once", 3)
    assert again == answer
    assert {port for port in values.keys() | others.keys() if values.get(port) != others.get(port)} == set()


@pytest.mark.parametrize("jobs", [1, 3])
def test_a_variant_that_cannot_begin_does_not_lose_the_others(jobs: int, wmr: Command, tmp_path: Path) -> None:
    scenario = tmp_path / "absent.toml"
    path = fmus.build(Fading(end=9.0), folder=tmp_path)
    variants = {"absent": tmp_path / "nothing.fmu", "first": path, "second": path}
    scenario.write_text(
        'title = "t"\nclaim = "c"\n[run]\nstep = 0.01\nduration = 0.2\n'
        + "".join(f'[variants.{name}]\ncomponents.thing.fmu = "{fmu}"\n' for name, fmu in variants.items())
    )
    said = wmr("compare", scenario, "--out", tmp_path / "out", "--jobs", jobs, "--json")
    document = json.loads(said.out)
    assert said.code == 1
    assert said.err.startswith(f"error: absent: cannot read the FMU {tmp_path / 'nothing.fmu'}: No such file")
    assert list(document["failed"]) == ["absent"]
    assert [run["variant"] for run in document["runs"]] == ["first", "second"]
    assert Path(document["combined"]).exists()
    said = wmr("compare", scenario, "--variants", "absent", "--jobs", jobs)
    assert (said.code, said.out) == (1, "")


def test_what_breaks_one_run_off_breaks_all_off() -> None:
    """The others end at the next point of theirs at which they say how far they are."""
    running, ended = threading.Barrier(2), []
    scenarios = [find_scenario("ramp-impact").load(variant) for variant in ("uncontrolled", "pd", "lqr")]

    def run(scenario: Scenario, bar: Bar) -> None:
        running.wait(10)
        if scenario.variant == "pd":
            raise OSError("disk full")
        try:
            while True:
                bar(scenario.variant, 0.5)
        except OSError:
            ended.append(scenario.variant)
            raise

    with pytest.raises(OSError, match="disk full"):
        together(scenarios, run, SILENT, 2)
    assert ended == ["uncontrolled"]  # and the third has not begun


def test_ctrl_c_ends_all_runs_and_their_logs_say_so(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "studies.cli", "compare", "ramp-impact", "--variants", "uncontrolled,pd-friction",
               "--duration", "500", "--out", str(tmp_path), "--jobs", "2"]  # fmt: skip
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    until = monotonic() + 100
    # what does not change takes 1.4 MB of a log, and one without a step would be taken away again
    while len(begun := list(tmp_path.glob("*.part"))) < 2 or min(p.stat().st_size for p in begun) < 4 << 20:
        assert process.poll() is None, process.communicate()
        assert monotonic() < until
        sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 128 + signal.SIGINT
    assert err.endswith("a log that was begun holds what was computed up to here, and says so\n")
    logs = sorted(tmp_path.iterdir())
    assert [log.name for log in logs] == ["ramp-impact-pd-friction.rrd", "ramp-impact-uncontrolled.rrd"]
    assert [describe(log, ["body.pitch"])["status"] for log in logs] == ["interrupted"] * 2
