"""FMUs that are not ours: written by hand in C, with what ours do not have (other types, misbehaviour on purpose)."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

import fmpy

HERE = Path(__file__).parent
FMI2, FMI3 = ((HERE / f"foreign_fmi{fmi}.xml").read_text() for fmi in (2, 3))


def foreign(folder: Path, fmi: int, description: str, *, platform: str | None = None) -> Path:
    """Compile ``foreign_fmi*.c`` and pack it with this description; *platform* is where the binary claims to be for."""
    folder.mkdir(parents=True, exist_ok=True)
    library = folder / f"Foreign{fmpy.sharedLibraryExtension}"
    headers = Path(fmpy.__file__).parent / "c-code"
    source = HERE / f"foreign_fmi{fmi}.c"
    if not library.exists():
        subprocess.run(["cc", "-shared", "-fPIC", f"-I{headers}", source, "-o", library], check=True)
    place = platform or (fmpy.platform if fmi == 2 else fmpy.platform_tuple)
    path = folder / "Foreign.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(library, f"binaries/{place}/{library.name}")
    return path
