"""Commands beside others: two at once, one that is watched, and a comparison of which one run fails."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

import numpy as np
import pytest
from commandline import Command, FadingSoon
from toys import Fading

import fmus
from logs.inspect import describe
from logs.read import signals

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
