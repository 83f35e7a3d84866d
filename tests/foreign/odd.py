"""Odd FMUs, compiled from ``odd.c``: they fail, hang, crash, discard, ... at a time that a parameter says."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

import fmpy

HERE = Path(__file__).parent
ODDITIES = (
    "none", "fail", "fatal", "hang", "crash", "abort", "exit", "discard", "end", "nan", "chatty", "hang at the end",
    "crash at the start", "crash in get", "discard all", "keep on reset", "thread key", "refuse inputs",
    "refuse outputs", "end nowhere", "end before", "return nowhere", "creep", "fail to save", "fail to restore",
    "talk", "start a tool", "write a lot", "stiff",
)  # fmt: skip
FMI2 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Odd" guid="{{odd}}">
  <CoSimulation modelIdentifier="Odd" canHandleVariableCommunicationStepSize="true" {flags}/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="oddity" valueReference="2" causality="parameter" variability="fixed">
      <Integer start="0"/></ScalarVariable>
    <ScalarVariable name="at" valueReference="3" causality="parameter" variability="fixed">
      <Real start="0.5"/></ScalarVariable>
    <ScalarVariable name="longest" valueReference="4" causality="parameter" variability="fixed">
      <Real start="1e9"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2" dependencies=""/></Outputs></ModelStructure>
</fmiModelDescription>
"""
FMI3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Odd" instantiationToken="{{odd}}">
  <CoSimulation modelIdentifier="Odd" canHandleVariableCommunicationStepSize="true" {flags}/>
  <ModelVariables>
    <Float64 name="u" valueReference="0" causality="input" start="1"/>
    <Float64 name="y" valueReference="1" causality="output"/>
    <Int32 name="oddity" valueReference="2" causality="parameter" variability="fixed" start="0"/>
    <Float64 name="at" valueReference="3" causality="parameter" variability="fixed" start="0.5"/>
    <Float64 name="longest" valueReference="4" causality="parameter" variability="fixed" start="1e9"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="1" dependencies=""/></ModelStructure>
</fmiModelDescription>
"""


def odd(folder: Path, fmi: int, flags: str = "", oddity: str = "none") -> Path:
    """Build the odd FMU with these *flags* of its co-simulation interface; *oddity* is what it is by default."""
    folder.mkdir(parents=True, exist_ok=True)
    library = folder / f"Odd{fmpy.sharedLibraryExtension}"
    headers = Path(fmpy.__file__).parent / "c-code"
    command = [
        "cc",
        "-shared",
        "-fPIC",
        "-O1",
        f"-DFMI_VERSION={fmi}",
        f"-DODDITY={ODDITIES.index(oddity)}",
        f"-I{headers}",
        HERE / "odd.c",
        "-o",
        library,
    ]
    subprocess.run(command, check=True)
    place = fmpy.platform if fmi == 2 else fmpy.platform_tuple
    path = folder / f"odd{fmi}.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", (FMI2 if fmi == 2 else FMI3).format(flags=flags))
        archive.write(library, f"binaries/{place}/{library.name}")
    return path


def state_flag(fmi: int) -> str:
    """Return the flag that says that the FMU can be taken back."""
    return f'canGetAndSetFMU{"state" if fmi == 2 else "State"}="true"'
