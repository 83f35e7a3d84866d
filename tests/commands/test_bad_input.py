"""A mistake ends with exit code 1 and one sentence that says what was asked, why not and what would work."""

from __future__ import annotations

import re
import sys
import zipfile
from pathlib import Path

import pytest
from commandline import Command, FadingSoon, Said

import fmus
from logs.read import properties, signals

MS = 1_000_000

# two components wired by hand: what is between the braces is filled in
FREE = """
title = "t"
claim = "c"

[run]
step = 1e-3
duration = 0.01

[components.controller]
type = "Uncontrolled"

[components.wheels]
type = "WheelDeformation"

[connections]
{}
"""


def complaint(said: Said) -> str:
    """Return the sentence of a command that failed as it should: one line on stderr, nothing else anywhere."""
    assert said.code == 1, said
    assert said.out == ""
    assert "Traceback" not in said.err
    (line,) = said.err.splitlines()
    assert line.startswith("error: ")
    return line.removeprefix("error: ")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ("run ramp-impct", "there is no scenario 'ramp-impct'; did you mean 'ramp-impact'?"),
        ("compare ramp-impct", "there is no scenario 'ramp-impct'; did you mean 'ramp-impact'?"),
        ("run ramp-impact --variant uncontroled", r".*ramp-impact.toml has no variant 'uncontroled'; "
                                                  r"did you mean 'uncontrolled'\?"),
        ("compare ramp-impact --variants pd,uncontroled", r".*ramp-impact.toml has no variant 'uncontroled'; "
                                                          r"did you mean 'uncontrolled'\?"),
        ("run ramp-impact --set wheels.kw=1e5", "components.wheels: WheelDeformation has no parameter 'kw'; "
                                                "did you mean 'k_w'?"),
        ("run ramp-impact --set robot.L_ff=1", "a robot has no 'L_ff'; did you mean 'L_f'?"),
        ("run ramp-impact --set ground.angel=1", "ground.angel is not known for a ramp; did you mean 'angle'?"),
        ("run ramp-impact --set run.setp=1", r".*ramp-impact.toml: run.setp is not known here; did you mean 'step'\?"),
        ("run ramp-impact --set wheels.k_w=stiff", r"components.wheels: WheelDeformation.k_w \[N/m\] must be a number "
                                                   r"or an array of numbers, not 'stiff'"),
        ("run ramp-impact --set wheels.k_w=[1,2,3]", r"components.wheels: WheelDeformation.k_w \[N/m\] has shape "
                                                     r"\[4\], but was given \[3\]"),
        ("run ramp-impact --set run.step=true", r".*ramp-impact.toml: run.step:? must be a number, not True.*"),
        ("run ramp-impact --step 0", r".*ramp-impact.toml: run.step: .*greater than 0.*"),
        ("run ramp-impact --step 1e-4 --duration 1e-5", r"the run from 0 s to 1e-05 s is shorter than its step of "
                                                        r"0.0001 s.*"),
        ("run ramp-impact --set faster", "cannot read the override 'faster'; write it like wheels.k_w=2e5"),
        ("run ramp-impact --set controller.type=Pid", r"components.controller: there is no component 'Pid'; .*"),
        ("run ramp-impact --set controller.period=1.5e-4", "controller has a period of 0.00015 s, which is neither a "
         "multiple nor a whole fraction of its step of 0.0001 s; choose a step that divides the period"),
        ("compare ramp-impact --baseline uncontroled", "there is no variant 'uncontroled' to be the baseline; "
                                                       "did you mean 'uncontrolled'?"),
        ("compare ramp-impact rigid-ramp", "compare runs one scenario, not 2; are these logs? then add --logs"),
        ("compare --logs nowhere.rrd", "compare --logs needs two logs or more; to look at one: wmr-cosim inspect "
                                       "nowhere.rrd"),
        ("compare --logs nowhere.rrd other.rrd", "there is no log nowhere.rrd"),
        ("compare --logs a.rrd b.rrd --step 1e-4", "--logs compares runs as they were: leave out --set, --step, "
                                                   "--duration, --variants, --jobs and --no-log"),
        ("inspect nowhere.rrd", "there is no log nowhere.rrd"),
        ("inspect nowhere.rrd --rerun", "there is no log nowhere.rrd"),
        ("inspect pyproject.toml --diff nowhere.rrd", r"pyproject.toml is not a Rerun log: .*"),
        ("logs nowhere", "there is no folder nowhere of logs; make some with wmr-cosim run or compare"),
        ("inspect pyproject.toml", r"pyproject.toml is not a Rerun log: .*"),
        ("fmu info nowhere.fmu", r"cannot read the FMU nowhere.fmu: No such file or directory"),
        ("fmu info pyproject.toml", r"pyproject.toml is not an FMU: .*"),
        ("fmu build RigidBdy", "there is no component 'RigidBdy'; did you mean 'RigidBody'?"),
        ("fmu build Uncontrolled --platforms z80-cpm", r"cannot build for platform 'z80-cpm'; the platforms are .*"),
    ],
)  # fmt: skip
def test_a_mistake_is_answered_with_a_sentence(
    wmr: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: str, sentence: str
) -> None:
    monkeypatch.chdir(Path(__file__).parents[2])
    words = arguments.split()
    words += ["--out", str(tmp_path)] if words[0] in ("run", "compare") else []
    said = complaint(wmr(*words))
    assert said == sentence or re.fullmatch(sentence, said), said
    assert list(tmp_path.iterdir()) == []  # nothing half done is left


@pytest.mark.parametrize(
    ("connection", "sentence"),
    [
        (
            '"wheels.traction_demnd" = "controller.traction_demand"',
            "wheels has no input 'traction_demnd'; did you mean 'traction_demand'?",
        ),
        (
            '"wheels.traction_demand" = "controler.traction_demand"',
            "'controler.traction_demand' names no component; did you mean 'controller'?",
        ),
        (
            '"wheels.gap" = "controller.traction_demand"',
            "cannot connect controller.traction_demand [N] to wheels.gap [m]: dimensions differ",
        ),
        (
            '"wheels.traction_demand" = "controller.active"',
            "cannot connect controller.active [1] to wheels.traction_demand [N]: shapes [] and [4] differ; connect "
            "whole ports of the same shape, or single elements such as controller.active to wheels.traction_demand[1]",
        ),
    ],
    ids=["unknown port", "unknown component", "wrong unit", "wrong shape"],
)
def test_what_cannot_be_connected(wmr: Command, tmp_path: Path, connection: str, sentence: str) -> None:
    path = tmp_path / "free.toml"
    path.write_text(FREE.format(connection))
    assert complaint(wmr("run", path, "--no-log")) == sentence


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        ("step = 1e-3", 'step = "fast"', r"{}: run.step:? must be a number, not 'fast'.*"),
        ("step = 1e-3", "step = [1e-3]", r"{}: run.step: .*number.*"),
        ("duration = 0.01", "", r"{}: run.duration is missing"),
        ('type = "WheelDeformation"', 'type = "WheelDeformation"\nevery = 1.5', r"{}: components.wheels.every: .*1.5"),
        ('type = "WheelDeformation"', "type = 5", r"{}: components.wheels.type: .*string.*5"),
        ("[run]", "[run", r"{} is not TOML: .*line 5.*"),
        ('title = "t"', "", r"{}: title is missing"),
    ],
)
def test_wrong_types_in_the_file(wmr: Command, tmp_path: Path, before: str, after: str, sentence: str) -> None:
    path = tmp_path / "typed.toml"
    text = FREE.format("")
    assert before in text
    path.write_text(text.replace(before, after, 1))
    assert re.fullmatch(sentence.format(re.escape(str(path))), complaint(wmr("run", path, "--no-log")))


def test_scenarios_that_are_no_files(wmr: Command, tmp_path: Path) -> None:
    missing = tmp_path / "missing.toml"
    assert complaint(wmr("run", missing)) == f"there is no scenario file {missing}"
    assert str(tmp_path) in complaint(wmr("run", f"{tmp_path}/"))
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    assert complaint(wmr("run", binary)).startswith(f"{binary} is not TOML: ")


# FMUs


def scenario_of(fmu: Path, folder: Path) -> Path:
    path = folder / "foreign.toml"
    path.write_text(
        f'title = "t"\nclaim = "c"\n[run]\nstep = 0.01\nduration = 0.2\n[components.thing]\nfmu = "{fmu}"\n'
    )
    return path


def test_an_fmu_that_is_not_there_or_none(wmr: Command, tmp_path: Path) -> None:
    nowhere, text, cut = (tmp_path / f"{name}.fmu" for name in ("nowhere", "text", "cut"))
    text.write_text("not an archive")
    whole = fmus.build(FadingSoon(), folder=tmp_path).read_bytes()
    cut.write_bytes(whole[: len(whole) // 2])
    assert complaint(wmr("run", scenario_of(nowhere, tmp_path))) == (
        f"cannot read the FMU {nowhere}: No such file or directory"
    )
    for path in (text, cut):
        assert complaint(wmr("run", scenario_of(path, tmp_path))).startswith(f"{path} is not an FMU: ")
        said = wmr("fmu", "check", path)
        assert (said.code, said.err) == (1, "")
        assert f"{path} is not an FMU: " in said.out


def test_an_fmu_for_another_platform(wmr: Command, tmp_path: Path) -> None:
    mine, other = fmus.build(FadingSoon(), folder=tmp_path), tmp_path / "other.fmu"
    with zipfile.ZipFile(mine) as source, zipfile.ZipFile(other, "w") as target:
        for name in source.namelist():
            moved = re.sub(r"^binaries/[^/]+/", "binaries/sparc-solaris/", name)
            target.writestr(moved, source.read(name))
    assert re.fullmatch(
        rf"{re.escape(str(other))} has no binary for [\w-]+, only for sparc-solaris",
        complaint(wmr("run", scenario_of(other, tmp_path))),
    )


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_that_fails_on_its_way(wmr: Command, tmp_path: Path, fmi: int) -> None:
    """Everything up to t = 0.1 s is in the log, which says that the run failed and why."""
    scenario = scenario_of(fmus.build(FadingSoon(), fmi=fmi, folder=tmp_path), tmp_path)
    folder = tmp_path / "out"
    said = wmr("run", scenario, "--out", folder)
    log = folder / "foreign.rrd"
    assert said.code == 1
    assert "Traceback" not in said.err
    (line,) = said.err.splitlines()
    assert line.startswith(
        "error: foreign: thing failed at t = 0.1 s: the integrator cannot go on at t = 0.105 s with x = "
    )
    assert line.endswith(f"; the log up to there is {log}")
    assert signals(log)["thing.y"].ns.tolist() == [k * 10 * MS for k in range(11)]
    outcome = properties(log)["outcome"]
    assert outcome["status"] == "failed"
    assert outcome["error"].startswith("thing failed at t = 0.1 s")
    shown = wmr("inspect", log)
    assert shown.code == 0
    assert shown.out.splitlines()[0] == f"{log}: failed"
    assert "thing failed at t = 0.1 s" in shown.out


def test_no_compiler(wmr: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("WMR_COSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setitem(sys.modules, "ziglang", None)  # as if it were not installed
    said = "no C compiler was found: install a C compiler or pip install 'wmr-cosim[portable]'"
    assert complaint(wmr("run", "ramp-impact", "--no-log")) == said
    assert complaint(wmr("fmu", "build", "Uncontrolled")) == said


# folders


def test_folders_that_cannot_be_written(wmr: Command, tmp_path: Path) -> None:
    """Below a file there is no folder, for root neither."""
    file = tmp_path / "file"
    file.touch()
    folder = file / "below"
    for command in ("run", "compare"):
        assert complaint(wmr(command, "ramp-impact", "--out", folder)) == (
            f"cannot write to the folder {folder}: Not a directory; choose another with --out"
        )
    assert complaint(wmr("fmu", "build", "Uncontrolled", "--out", folder)).startswith(
        f"cannot write to the folder {folder}"
    )


def test_exports_that_cannot_be_written(wmr: Command, tmp_path: Path) -> None:
    assert wmr("run", "ramp-impact", "--duration", "2e-4", "--out", tmp_path).code == 0
    log = tmp_path / "ramp-impact-uncontrolled.rrd"
    assert complaint(wmr("inspect", log, "--csv", tmp_path / "none" / "x.csv")).startswith("cannot write ")
    assert complaint(wmr("inspect", log, "--csv", tmp_path / "x.txt")).endswith(
        "the name must end in .csv, .parquet or .mcap"
    )
    assert re.fullmatch(
        rf"the log {log} has no signal like 'body.pich'; did you mean 'body.pitch'\?",
        complaint(wmr("inspect", log, "--signals", "body.pich")),
    )


@pytest.mark.parametrize(
    "arguments",
    [
        "run",
        "run ramp-impact --step fast",
        "run ramp-impact --pace 0",
        "compare ramp-impact --view --no-log",
        "compare ramp-impact --serve --no-log",
        "nonsense",
    ],
)
def test_usage_errors_show_how_it_is_called(wmr: Command, arguments: str) -> None:
    said = wmr(*arguments.split())
    assert said.code == 2
    assert "Traceback" not in said.err
    assert "Usage: wmr-cosim" in said.err
