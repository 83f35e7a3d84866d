"""Component -> FMU file: sources, binaries and description in a zip that is the same byte for byte every time."""

from __future__ import annotations

import hashlib
import os
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import fmpy

from cosim import Component, ExportError
from cosim.cache import cache_folder
from cosim.kept import digest, fingerprint, kept

from .codegen import equations_source, model_source
from .compile import FLAGS, HERE, PLATFORMS, binary_folder, compile_library
from .describe import build_xml, description_xml
from .layout import Layout

HARNESS = Path(__file__).parent / "harness"
_EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest a zip can hold: no file has another date
_keys: dict[tuple[Any, ...], tuple[str, dict[str, str]]] = {}  # what was generated in this process, per class


def build(
    component: Component, *, fmi: int = 3, platforms: Sequence[str] | None = None, folder: Path | None = None
) -> Path:
    """Return the FMU of *component*'s class and structural values, built unless it was built before.

    *fmi* is 2 or 3, *platforms* are names such as ``x86_64-linux`` (default: this machine), *folder* is where the file
    goes (default: the cache).  The FMU starts with the class's default parameters.  Raises ExportError.
    """
    if fmi not in (2, 3):
        raise ExportError(f"cannot build an FMU of FMI version {fmi!r}; the versions are 2 and 3")
    wanted = tuple(dict.fromkeys(platforms or (HERE,)))
    folders = {p: binary_folder(p, fmi) for p in wanted}
    token, files = _generate(component, fmi)
    identifier = type(component).__name__
    key = hashlib.sha256(repr((token, wanted, FLAGS)).encode()).hexdigest()[:12]
    path = Path(folder or cache_folder()) / f"{identifier}-fmi{fmi}-{key}.fmu"
    if path.exists():
        return path
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".build-") as work:
        sources = Path(work, "sources")
        sources.mkdir()
        contents = {name: text.encode() for name, text in files.items()}
        for name, data in contents.items():
            if name.startswith("sources/"):
                Path(work, name).write_bytes(data)
        for platform in wanted:
            library = Path(work, platform, identifier + PLATFORMS[platform].extension)
            library.parent.mkdir()
            compile_library(sources, library, platform)
            contents[f"binaries/{folders[platform]}/{library.name}"] = library.read_bytes()
        _write_zip(Path(work, "out.fmu"), contents)
        os.replace(Path(work, "out.fmu"), path)  # atomic: who builds the same at the same time gets either file
    return path


def _generate(component: Component, fmi: int) -> tuple[str, dict[str, str]]:
    """Return the token and every text file of the FMU, by its name in the zip."""
    memo = (type(component), tuple(component.structure.items()), fmi)
    if memo not in _keys:
        _keys[memo] = kept("texts", _fingerprint(component, fmi), lambda: _texts(component, fmi))
    return _keys[memo]


def _fingerprint(component: Component, fmi: int) -> str | None:
    """Return a hash of all that the texts of a component's FMU depend on; None where that is not known."""
    known = fingerprint(component)
    about = (known, fmi, digest(Path(__file__).parent), fmpy.__version__)
    return known and hashlib.sha256(repr(about).encode()).hexdigest()


def _texts(component: Component, fmi: int) -> tuple[str, dict[str, str]]:
    layout, identifier = Layout.of(component), type(component).__name__
    headers = Path(fmpy.__file__).parent / "c-code"
    files = {f"sources/{p.name}": p.read_text() for p in sorted(HARNESS.iterdir()) if p.suffix in (".c", ".h")}
    files |= {f"sources/{p.name}": p.read_text() for p in sorted(headers.glob(f"fmi{fmi}*.h"))}
    files["sources/equations.c"] = equations_source(layout)
    if fmi == 3:
        files["sources/buildDescription.xml"] = build_xml(identifier)

    def with_token(token: str) -> dict[str, str]:
        return {
            **files,
            "sources/model.c": model_source(layout, identifier, token, fmi),
            "modelDescription.xml": description_xml(layout, identifier, token, fmi),
        }

    digest = hashlib.sha256(repr(sorted(with_token("").items())).encode()).hexdigest()
    token = f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"
    return token, with_token(token)


def _write_zip(path: Path, contents: dict[str, bytes]) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        for name in sorted(contents):
            info = zipfile.ZipInfo(name, _EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system, info.external_attr = 3, (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(info, contents[name])
