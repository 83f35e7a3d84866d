"""FMU file -> unpacked folder and description: of anybody's FMI 2.0 or 3.0 co-simulation FMU."""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import xml.etree.ElementTree as ET
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy
from fmpy.model_description import read_model_description

from cosim import Capabilities, ExportError, Variable
from cosim.cache import cache_folder

from .clocks import Clock, declared_clocks
from .declared import References, declared_variables


@dataclass(frozen=True)
class Archive:
    """An unpacked FMU and what its description says."""

    path: Path  # of the .fmu file
    folder: Path  # where it is unpacked
    fmi: int  # 2 or 3
    model: str
    identifier: str
    token: str
    meaning: str
    tool: str  # that wrote it
    platforms: tuple[str, ...]
    variables: dict[str, Variable]
    references: dict[str, References]
    can: Capabilities
    event_mode: bool  # it has one; where it is used, ``can`` says so, too
    clocks: dict[str, Clock]
    intermediate: tuple[str, ...]  # FMI 3.0: inputs it asks for within a step
    memory_functions: bool  # FMI 2.0: it takes the importer's memory functions
    once_per_process: bool  # it can be in a process only once
    needs_tool: bool  # its tool must be installed, which it starts or calls
    retry: bool = False  # a step that it discards is repeated in shorter ones


def read(path: str | os.PathLike[str]) -> Archive:
    """Unpack an FMU into the cache, keyed by the hash of its bytes, and read its description; raises ExportError."""
    path = Path(path)
    folder = _unpacked(path)
    try:
        root = ET.parse(folder / "modelDescription.xml").getroot()
        version = root.get("fmiVersion", "")
        if version[:2] not in ("2.", "3."):
            raise ExportError(f"{path} is an FMI {version or '?'} FMU; FMI 2.0 and 3.0 can be loaded")
        description = read_model_description(str(folder), validate=False)
    except ExportError:
        raise
    except Exception as error:  # FMPy lets through whatever a malformed description runs into
        raise ExportError(f"{path} is not an FMU that can be read: {error}") from error
    fmi = int(version[0])
    interface = root.find("CoSimulation")
    if interface is None:
        has = [tag for tag in ("ModelExchange", "ScheduledExecution") if root.find(tag) is not None]
        raise ExportError(f"{path} has no co-simulation interface, only {' and '.join(has) or 'nothing'}")
    variables, references = declared_variables(description)
    clocks = declared_clocks(root)
    return Archive(
        path=path,
        folder=folder,
        fmi=fmi,
        model=description.modelName,
        identifier=interface.get("modelIdentifier", ""),
        token=description.guid or "",
        meaning=description.description or "",
        tool=description.generationTool or "",
        platforms=_platforms(folder),
        variables=variables,
        references=references,
        can=_capabilities(interface, fmi, variables),
        event_mode=_flag(interface, "hasEventMode"),
        clocks=clocks,
        intermediate=_intermediate(root) if _flag(interface, "providesIntermediateUpdate") else (),
        memory_functions=not _flag(interface, "canNotUseMemoryManagementFunctions"),
        once_per_process=_flag(interface, "canBeInstantiatedOnlyOncePerProcess"),
        needs_tool=_flag(interface, "needsExecutionTool"),
    )


def _flag(interface: Any, *names: str) -> bool:
    return any(interface.get(name) in ("true", "1") for name in names)


def _capabilities(interface: Any, fmi: int, variables: dict[str, Variable]) -> Capabilities:
    """Read from the XML: FMPy 0.3.32 does not know FMI 3.0's name of the directional derivatives."""
    early = fmi == 3 and _flag(interface, "mightReturnEarlyFromDoStep")
    return Capabilities(
        rollback=_flag(interface, "canGetAndSetFMUState", "canGetAndSetFMUstate"),
        serialize=_flag(interface, "canSerializeFMUState", "canSerializeFMUstate"),
        early_return=early,
        directional_derivatives=_flag(interface, "providesDirectionalDerivatives", "providesDirectionalDerivative"),
        variable_step=_flag(interface, "canHandleVariableCommunicationStepSize"),
        get_after_set=fmi == 3,
        input_derivatives=2 if _flag(interface, "canInterpolateInputs") else 0,
        event_mode=_flag(interface, "hasEventMode") and (not early or any(map(is_discrete, variables.values()))),
    )


def _intermediate(root: Any) -> tuple[str, ...]:
    inputs = root.findall("ModelVariables/Float64[@causality='input'][@intermediateUpdate]")
    return tuple(v.get("name") for v in inputs if _flag(v, "intermediateUpdate"))


def is_discrete(variable: Variable) -> bool:
    """Whether a port changes at events only."""
    return variable.causality in ("input", "output") and variable.variability != "continuous"


def _platforms(folder: Path) -> tuple[str, ...]:
    binaries = folder / "binaries"
    return tuple(sorted(p.name for p in binaries.iterdir() if p.is_dir())) if binaries.is_dir() else ()


def library(archive: Archive) -> Path:
    """Return the shared library for this machine; raises ExportError saying which platforms there are."""
    here = fmpy.platform if archive.fmi == 2 else fmpy.platform_tuple
    path = archive.folder / "binaries" / here / (archive.identifier + fmpy.sharedLibraryExtension)
    if not path.is_file():
        has = ", ".join(archive.platforms)
        raise ExportError(
            f"{archive.path} has no binary for {here}, "
            + (f"only for {has}" if has else "nor for any other platform; compile it from its sources")
        )
    return path


def _unpacked(path: Path) -> Path:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ExportError(f"cannot read the FMU {path}: {error.strerror or error}") from None
    folder = cache_folder() / "unpacked" / hashlib.sha256(data).hexdigest()[:16]
    if folder.is_dir():
        return folder
    folder.parent.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(dir=folder.parent, prefix=".unpack-"))
    try:
        with zipfile.ZipFile(path) as archive:
            if "modelDescription.xml" not in archive.namelist():
                raise ExportError(f"{path} is not an FMU: there is no modelDescription.xml in it")
            archive.extractall(work)
        os.rename(work, folder)  # atomic; who unpacks the same at the same time may have been first
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, NotImplementedError) as error:
        if not folder.is_dir():
            raise ExportError(f"{path} is not an FMU: it cannot be unpacked ({error})") from None
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return folder
