"""FMUs with event mode, written by hand in C: they refuse every call that the standard forbids."""

from __future__ import annotations

import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy

from cosim import Instance

Make = Callable[..., Instance]  # the fixture ``make``
HERE = Path(__file__).parent
FLAGS = (
    'canGetAndSetFMUState="true" canSerializeFMUState="true" canHandleVariableCommunicationStepSize="true" '
    'hasEventMode="true"'
)
EARLY = 'mightReturnEarlyFromDoStep="true"'


def _float(name: str, reference: int, causality: str, variability: str = "continuous", more: str = "") -> str:
    unit = ' unit="1"'
    return (
        f'<Float64 name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="{variability}"{unit} {more}/>'
    )


def _int(name: str, reference: int, more: str = "") -> str:
    return f'<Int32 name="{name}" valueReference="{reference}" causality="output" variability="discrete" {more}/>'


def _clock(name: str, k: int, causality: str, kind: str, more: str = "") -> str:
    return (
        f'<Clock name="{name}" valueReference="{100 + k}" causality="{causality}" variability="discrete" '
        f'intervalVariability="{kind}" {more}/>'
    )


def _parameter(name: str, reference: int, start: float) -> str:
    return _float(name, reference, "parameter", "fixed", f'start="{start}"')


MODELS: dict[str, tuple[str, list[str]]] = {
    "BALL": (EARLY, [
        _float("push", 1, "input", more='start="0"'),
        _float("kick", 2, "input", "discrete", 'start="0"'),
        _float("h", 3, "output"),
        _float("v", 4, "output"),
        _int("bounces", 5),
        _parameter("g", 6, 9.81), _parameter("e", 7, 0.8), _parameter("h0", 8, 1), _parameter("rest", 9, 0),
        _parameter("longest", 38, 0),
        _clock("bounce", 0, "output", "triggered"),
    ]),
    "CONTROLLER": ("", [
        _float("seen", 1, "input", "discrete", 'start="0" clocks="100"'),
        _float("command", 2, "output", "discrete", 'clocks="100"'),
        _float("saw", 3, "output", "discrete", 'clocks="100"'),
        _int("count", 4), _float("last", 5, "output", "discrete"), _int("ticks", 7),
        _parameter("strength", 6, 4),
        _clock("sample", 0, "input", "constant", 'intervalDecimal="0.1"'),
        _clock("bounced", 1, "input", "triggered"),
    ]),
    "CLOCKS": ("", [
        *(_int(name, k + 1) for k, name in enumerate(
            ["n_constant", "n_asked", "n_given", "n_tunable", "n_changing", "n_countdown", "n_triggered"])),
        _clock("constant", 0, "input", "constant",
               'supportsFraction="true" resolution="3" intervalCounter="1" intervalDecimal="0.333333"'),
        _clock("asked", 1, "input", "fixed"),
        _clock("given", 2, "input", "fixed", 'intervalDecimal="0.25"'),
        _clock("tunable", 3, "input", "tunable"),
        _clock("changing", 4, "input", "changing"),
        _clock("countdown", 5, "input", "countdown"),
        _clock("triggered", 6, "input", "triggered"),
    ]),
    "STAIR": ("", [_int("count", 1), _parameter("width", 2, 0.1), _int("updates", 3), _parameter("last", 5, 0),
                   _clock("stepped", 0, "output", "triggered")]),
    "RELAY": ("", [_float("u", 1, "input", "discrete", 'start="0"'), _float("y", 2, "output", "discrete")]),
    "SUMMING": ("", [
        _float("u", 1, "input", "discrete", 'start="0"'), _float("y", 2, "output", "discrete"),
        _parameter("step", 3, 1),
    ]),
}  # fmt: skip


def hybrid(folder: Path, model: str, *, can: str = FLAGS, period: float = 0.1) -> Path:
    """Compile one model of ``hybrid_fmi3.c`` and pack it; *can* are the capabilities it declares besides its own."""
    folder.mkdir(parents=True, exist_ok=True)
    library = folder / f"{model}{fmpy.sharedLibraryExtension}"
    flags, variables = MODELS[model]
    subprocess.run(
        ["gcc", "-shared", "-fPIC", "-O1", "-ffp-contract=off", "-w", f"-DMODEL={model}", f"-DPERIOD={period!r}",
         f"-I{Path(fmpy.__file__).parent / 'c-code'}", f"-I{HERE}", str(HERE / "hybrid_fmi3.c"), "-o", str(library),
         "-lm"], check=True,
    )  # fmt: skip
    structure = ""
    for tag in ("Output", "InitialUnknown"):
        for v in variables:
            if 'causality="output"' in v and not (tag == "InitialUnknown" and "clocks=" in v):
                reference = v.split('valueReference="')[1].split('"')[0]
                structure += f'<{tag} valueReference="{reference}" dependencies=""/>'
    text = (
        f'<fmiModelDescription fmiVersion="3.0" modelName="{model}" instantiationToken="x">'
        f'<CoSimulation modelIdentifier="{model}" {can} {flags}/>'
        f'<UnitDefinitions><Unit name="1"><BaseUnit/></Unit></UnitDefinitions>'
        f'<ModelVariables><Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>'
        f"{''.join(variables)}</ModelVariables><ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )
    path = folder / f"{model}.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text.replace('intervalDecimal="0.1"', f'intervalDecimal="{period!r}"'))
        archive.write(library, f"binaries/{fmpy.platform_tuple}/{model}{fmpy.sharedLibraryExtension}")
    return path
