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

from .cache import cache_folder
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
    event_mode: bool
    memory_functions: bool  # FMI 2.0: it takes the importer's memory functions


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
        can=_capabilities(interface, fmi),
        event_mode=_flag(interface, "hasEventMode"),
        memory_functions=not _flag(interface, "canNotUseMemoryManagementFunctions"),
    )


def _flag(interface: Any, *names: str) -> bool:
    return any(interface.get(name) in ("true", "1") for name in names)


def _capabilities(interface: Any, fmi: int) -> Capabilities:
    """Read from the XML: FMPy 0.3.32 does not know FMI 3.0's name of the directional derivatives."""
    return Capabilities(
        rollback=_flag(interface, "canGetAndSetFMUState", "canGetAndSetFMUstate"),
        serialize=_flag(interface, "canSerializeFMUState", "canSerializeFMUstate"),
        early_return=fmi == 3 and _flag(interface, "mightReturnEarlyFromDoStep"),
        directional_derivatives=_flag(interface, "providesDirectionalDerivatives", "providesDirectionalDerivative"),
        variable_step=_flag(interface, "canHandleVariableCommunicationStepSize"),
    )


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
