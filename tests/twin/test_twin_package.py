"""The FMU as a file: valid, the same bytes every time, rebuilt by others from its sources, loaded without a trace."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import zipfile
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu
from specimens import Ball, Mass, Mathematics, Road, Specimen
from test_twin_agreement import agree, prepared

import fmus
from cosim.clock import NS


def test_the_description_is_valid(specimen: Specimen, fmi: int) -> None:
    assert validate_fmu(str(fmus.build(specimen.component, fmi=fmi))) == []


def test_the_behaviour_is_sound(specimen: Specimen, fmi: int) -> None:
    assert fmus.check(fmus.build(specimen.component, fmi=fmi)) == []


def test_variables_come_back_as_declared(specimen: Specimen, fmi: int) -> None:
    """Name, causality, shape, unit, start and meaning survive the way through the XML."""
    fmu = fmus.load(fmus.build(specimen.component, fmi=fmi))
    default = type(specimen.component)(**specimen.component.structure)
    found = {n: v for n, v in fmu.variables.items() if n != "time"}
    assert list(found) == list(default.variables)
    for name, v in default.variables.items():
        read = found[name]
        assert (read.name, read.causality, read.type, read.shape) == (name, v.causality, v.type, v.shape)
        assert (read.unit, read.meaning, read.variability) == (v.unit, v.meaning, v.variability)
        if v.type == "Float64" and v.start is not None:
            assert np.array_equal(read.start, v.start)
        if v.causality == "output":
            assert set(read.depends_on or ()) >= set(v.depends_on or ())
    fmu.close()


def test_two_builds_are_identical(fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from fmus import package

    files = []
    for folder in ("one", "elsewhere/two"):
        monkeypatch.setattr(package, "_keys", {})
        files.append(fmus.build(Ball(), fmi=fmi, folder=tmp_path / folder))
    assert files[0].name == files[1].name
    assert files[0].read_bytes() == files[1].read_bytes()
    assert str(tmp_path).encode() not in b"".join(_contents(files[0]).values())


def _contents(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_the_sources_compile_without_a_warning(fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "cc -Wall -Wextra -Wpedantic -Werror")
    for component in (Ball(), Mathematics(), Road()):
        fmus.build(component, fmi=fmi, folder=tmp_path)


def test_parameter_values_make_no_other_fmu(fmi: int) -> None:
    assert fmus.build(Mass(k=1.0), fmi=fmi) == fmus.build(Mass(k=2.0), fmi=fmi)


def test_builds_at_the_same_time(tmp_path: Path) -> None:
    with ThreadPoolExecutor(4) as pool:
        paths = list(pool.map(lambda _: fmus.build(Ball(), folder=tmp_path), range(4)))
    assert len(set(paths)) == 1
    assert fmus.check(paths[0]) == []
    assert [p.name for p in tmp_path.iterdir()] == [paths[0].name]


def rebuilt(path: Path, folder: Path) -> Path:
    """Do what ``fmpy compile`` does: unpack, build the binary from the sources alone, pack again."""
    fmpy.extract(str(path), unzipdir=str(folder / "unpacked"))
    shutil.rmtree(folder / "unpacked" / "binaries")
    build_platform_binary(folder / "unpacked")
    with zipfile.ZipFile(folder / "rebuilt.fmu", "w") as archive:
        for file in sorted((folder / "unpacked").rglob("*")):
            archive.write(file, file.relative_to(folder / "unpacked"))
    return folder / "rebuilt.fmu"


@pytest.fixture
def cmake(monkeypatch: pytest.MonkeyPatch) -> None:
    """Put the environment's cmake on the path, which FMPy calls by name."""
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=":")
    if shutil.which("cmake") is None:
        pytest.skip("needs cmake: pip install cmake")


@pytest.mark.usefixtures("cmake")
def test_a_rebuilt_fmu_gives_the_same_bits(fmi: int, tmp_path: Path, rng: np.random.Generator) -> None:
    specimen = Specimen(Mathematics())
    path = rebuilt(fmus.build(specimen.component, fmi=fmi), tmp_path)
    assert fmus.check(path) == []
    for _ in range(5):
        values = specimen.values(rng)
        ours, theirs = fmus.instantiate(specimen.component, fmi=fmi), fmus.load(path)
        agree(prepared(theirs, values), prepared(ours, values), tolerance=0.0)
    if sys.platform.startswith("linux"):  # elsewhere libm is part of the C library
        loads_without_libm(next((tmp_path / "unpacked" / "binaries").rglob("*.so")), fmi, tmp_path)


def loads_without_libm(library: Path, fmi: int, folder: Path) -> None:
    """Load a library into a C program that uses no mathematics: FMPy's project does not link libm either."""
    (folder / "host.c").write_text(
        "#include <dlfcn.h>\n#include <stdio.h>\n"
        "int main(int n, char **a) { void *l = dlopen(a[n - 1], RTLD_NOW);\n"
        "if (!l) puts(dlerror()); else puts(((const char *(*)(void))dlsym(l, a[1]))()); }\n"
    )
    subprocess.run(["cc", "host.c", "-o", "host", "-ldl"], cwd=folder, check=True)
    needed = subprocess.run(["ldd", folder / "host"], capture_output=True, text=True, check=True).stdout
    assert "libm.so" not in needed
    host = [folder / "host", f"fmi{fmi}GetVersion", library]
    assert subprocess.run(host, capture_output=True, text=True, check=True).stdout.strip() == f"{fmi}.0"


@pytest.mark.parametrize("events", [False, True], ids=["steps", "event-mode"])
def test_another_importer_simulates_it(fmi: int, events: bool) -> None:
    """FMPy's own simulation loop, in FMI 3.0 also with event mode and early return."""
    path = fmus.build(Ball(), fmi=fmi)
    result = fmpy.simulate_fmu(
        str(path), stop_time=1.0, output_interval=0.01, early_return_allowed=events, use_event_mode=events,
        start_values={"e": 0.5}, relative_tolerance=1e-8,
    )  # fmt: skip
    # impacts at t1 = sqrt(2 h/g) = 0.202 s, 2 t1 = 0.404 s, 2.5 t1 = 0.505 s, ...: 0.3 and 0.5 s are between
    middle = result[np.argmin(np.abs(result["time"] - 0.5))]
    assert middle["count"] == 2
    assert result["count"][np.argmin(np.abs(result["time"] - 0.3))] == 1
    fall = np.sqrt(2 * 0.2 / 9.81)
    t = 0.5 - 2 * fall  # since the second impact, with a quarter of the speed
    assert middle["gap"] == pytest.approx(0.25 * 9.81 * fall * t - 9.81 / 2 * t**2, abs=1e-9)


def test_every_function_of_the_standard_is_exported(fmi: int) -> None:
    header = Path(fmpy.__file__).parent / "c-code" / f"fmi{fmi}Functions.h"
    words = header.read_text().replace(";", " ").split()
    wanted = {w for before, w in pairwise(words) if before.endswith("TYPE") and w.startswith(f"fmi{fmi}")}
    assert len(wanted) == {2: 44, 3: 75}[fmi]
    fmu = fmus.load(fmus.build(Mass(), fmi=fmi))
    missing = [name for name in sorted(wanted) if not hasattr(fmu._library._dll, name)]  # type: ignore[union-attr]
    assert missing == []


def test_loading_leaves_nothing_but_the_cache(fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = fmus.build(Mass(), fmi=fmi)
    monkeypatch.setenv("WMR_COSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr("tempfile.tempdir", None)
    fmus.load(path).close()
    before = sorted(tmp_path.rglob("*"))
    for _ in range(20):
        prepared(fmus.load(path), {}).close()
    assert sorted(tmp_path.rglob("*")) == before
    assert not any((tmp_path / "tmp").iterdir())
    assert [p.name for p in (tmp_path / "cache" / "unpacked").iterdir()] == [
        hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    ]


def test_info(fmi: int) -> None:
    found = fmus.info(fmus.build(Mass(), fmi=fmi))
    assert (found["name"], found["fmi"]) == ("Mass", f"{fmi}.0")
    assert found["meaning"] == "Mass on a spring with a damper: m x'' = F - k x - d x'."
    assert found["capabilities"]["rollback"]
    k = next(v for v in found["variables"] if v["name"] == "k")
    assert k == {
        "name": "k", "causality": "parameter", "variability": "fixed", "type": "Float64", "shape": [], "unit": "N/m",
        "start": 50.0, "meaning": "stiffness", "depends_on": None,
    }  # fmt: skip


def test_outputs_follow_inputs_without_a_step(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Mass(), fmi=fmi), {"v": np.array(2.0), "F": np.array(3.0)})
    assert fmu.get("power") == 6.0
    fmu.u[0] = 5.0
    fmu.push()
    fmu.pull()
    assert fmu.y[fmu.y_at["power"]] == 10.0


@pytest.mark.skipif(
    "WMR_COSIM_CROSS" not in os.environ, reason="zig first builds each platform's C library, for minutes"
)
def test_one_fmu_for_several_platforms(tmp_path: Path) -> None:
    pytest.importorskip("ziglang")
    path = fmus.build(
        Mass(), platforms=["x86_64-linux", "aarch64-linux", "x86_64-windows", "aarch64-darwin"], folder=tmp_path
    )
    magic = {
        "x86_64-linux": b"\x7fELF",
        "aarch64-linux": b"\x7fELF",
        "x86_64-windows": b"MZ",
        "aarch64-darwin": b"\xcf\xfa\xed\xfe",
    }
    binaries = {n: d for n, d in _contents(path).items() if n.startswith("binaries/")}
    assert {name.split("/")[1] for name in binaries} == set(magic)
    for name, data in binaries.items():
        assert data.startswith(magic[name.split("/")[1]]), name
    fmu = prepared(fmus.load(path), {})
    assert fmu.step(0, NS).reached == NS
