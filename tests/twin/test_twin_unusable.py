"""FMUs that cannot be loaded or built are named, with the file, the platforms or the compiler, in one sentence."""

from __future__ import annotations

import zipfile
from pathlib import Path

import fmpy
import pytest
from foreign import FMI3, foreign
from specimens import Ball, Mass

import fmus
from cosim import ExportError

# files


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match=r"cannot read the FMU .*nothing\.fmu: No such file or directory"):
        fmus.load(tmp_path / "nothing.fmu")


def test_no_zip(tmp_path: Path) -> None:
    (tmp_path / "text.fmu").write_text("no zip")
    with pytest.raises(ExportError, match=r"text\.fmu is not an FMU: it cannot be unpacked \(File is not a zip file\)"):
        fmus.load(tmp_path / "text.fmu")


def test_a_cut_file(tmp_path: Path) -> None:
    data = fmus.build(Mass()).read_bytes()
    (tmp_path / "cut.fmu").write_bytes(data[: len(data) // 2])
    with pytest.raises(ExportError, match=r"cut\.fmu is not an FMU: it cannot be unpacked"):
        fmus.load(tmp_path / "cut.fmu")


def test_a_damaged_file(tmp_path: Path) -> None:
    data = bytearray(fmus.build(Mass()).read_bytes())
    data[2000:2100] = bytes(100)
    (tmp_path / "damaged.fmu").write_bytes(data)
    with pytest.raises(ExportError, match=r"damaged\.fmu is not an FMU: it cannot be unpacked"):
        fmus.load(tmp_path / "damaged.fmu")


def test_a_zip_that_is_no_fmu(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "other.fmu", "w") as archive:
        archive.writestr("readme.txt", "hello")
    with pytest.raises(ExportError, match=r"other\.fmu is not an FMU: there is no modelDescription\.xml in it"):
        fmus.load(tmp_path / "other.fmu")


def test_nothing_is_left_of_a_file_that_is_no_fmu(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WMR_COSIM_CACHE", str(tmp_path / "cache"))
    (tmp_path / "text.fmu").write_text("no zip")
    with pytest.raises(ExportError):
        fmus.load(tmp_path / "text.fmu")
    assert list((tmp_path / "cache" / "unpacked").iterdir()) == []


def test_another_platform(tmp_path: Path) -> None:
    path = foreign(tmp_path, 3, FMI3, platform="riscv64-plan9")
    with pytest.raises(ExportError) as found:
        fmus.load(path)
    assert str(found.value) == f"{path} has no binary for {fmpy.platform_tuple}, only for riscv64-plan9"


def test_no_co_simulation(tmp_path: Path) -> None:
    path = foreign(tmp_path, 3, FMI3.replace("CoSimulation", "ModelExchange").replace("canHandleVariable", "needsX"))
    with pytest.raises(ExportError, match=r"has no co-simulation interface, only ModelExchange"):
        fmus.load(path)


def test_fmi_1(tmp_path: Path) -> None:
    path = foreign(
        tmp_path, 3, '<fmiModelDescription fmiVersion="1.0" modelIdentifier="x"><ModelVariables/></fmiModelDescription>'
    )
    with pytest.raises(ExportError, match=r"is an FMI 1\.0 FMU; FMI 2\.0 and 3\.0 can be loaded"):
        fmus.load(path)


def test_a_wrong_token(tmp_path: Path) -> None:
    path = foreign(tmp_path, 3, FMI3.replace("{42}", "{43}"))
    with pytest.raises(ExportError, match=r"cannot be instantiated: the token is not \{42\}"):
        fmus.load(path)
    assert any("the token is not {42}" in problem for problem in fmus.check(path))


def test_a_token_of_other_sources(fmi: int, tmp_path: Path) -> None:
    source, path = fmus.build(Mass(), fmi=fmi), tmp_path / "changed.fmu"
    token = fmus.info(source)["token"]
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, data.replace(token.encode(), b"{other}") if name.endswith("Description.xml") else data)
    with pytest.raises(ExportError) as found:
        fmus.load(path)
    what = {2: "GUID", 3: "instantiation token"}[fmi]
    assert str(found.value) == (
        f"{path} cannot be instantiated: the {what} is {{other}}, but this binary was built for {token}"
    )


# building


def test_no_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(ExportError) as found:
        fmus.build(Ball(), folder=tmp_path)
    assert str(found.value) == ("no C compiler was found: install a C compiler or pip install 'wmr-cosim[portable]'")
    assert list(tmp_path.iterdir()) == []


def test_no_cross_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(
        ExportError, match=r"building for x86_64-windows on .* needs zig: pip install 'wmr-cosim\[portable\]'"
    ):
        fmus.build(Ball(), platforms=["x86_64-windows"], folder=tmp_path)


def test_a_compiler_that_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "cc -DHARNESS_H")  # the harness' own header is skipped: nothing is declared
    with pytest.raises(ExportError, match=r"the C compiler cc failed for .*Ball.*\n(.*\n)*.*error"):
        fmus.build(Ball(), folder=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_platforms_that_cannot_be(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match=r"cannot build for platform 'z80-cpm'; the platforms are x86_64-linux, "):
        fmus.build(Ball(), platforms=["z80-cpm"], folder=tmp_path)
    with pytest.raises(
        ExportError, match=r"cannot build an FMI 2\.0 FMU for aarch64-darwin: the standard has no folder"
    ):
        fmus.build(Ball(), fmi=2, platforms=["aarch64-darwin"], folder=tmp_path)
    with pytest.raises(ExportError, match="the versions are 2 and 3"):
        fmus.build(Ball(), fmi=1, folder=tmp_path)
