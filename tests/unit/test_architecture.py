"""Who may import whom, and that what is imported is this checkout."""

import ast
import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("cosim", "plants", "controllers", "fmus", "logs", "studies")
ALLOWED = {
    "cosim": {"cosim"},
    "plants": {"plants", "cosim"},
    "controllers": {"controllers", "cosim"},
    "fmus": {"fmus", "cosim"},
    "logs": {"logs", "cosim"},
    "studies": set(PACKAGES),
}


def imported(file: Path) -> set[str]:
    """Return the first names of all absolute imports of a file, those inside functions included."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.split(".")[0])
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_imports_follow_the_arrows(package: str) -> None:
    files = sorted((ROOT / package).rglob("*.py"))
    assert files
    crossed = {
        f"{file.relative_to(ROOT)} imports {name}"
        for file in files
        for name in imported(file) & (set(PACKAGES) | {"tests", "benchmarks"}) - ALLOWED[package]
    }
    assert not crossed


def test_relative_imports_stay_inside_their_package() -> None:
    """A package is flat or one level deep: ``from ..sibling import x`` would slip through the arrows."""
    for package in PACKAGES:
        for file in (ROOT / package).rglob("*.py"):
            depth = len(file.relative_to(ROOT).parts) - 1
            for node in ast.walk(ast.parse(file.read_text())):
                if isinstance(node, ast.ImportFrom):
                    assert node.level <= depth, f"{file.relative_to(ROOT)}:{node.lineno} leaves its package"


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_comes_from_this_checkout(package: str) -> None:
    """The names are generic: a distribution of the same name elsewhere on the path must not shadow ours."""
    module = importlib.import_module(package)
    assert module.__file__ is not None
    assert Path(module.__file__).parent == ROOT / package


def test_only_the_fmu_package_uses_fmpy() -> None:
    users = {
        file.relative_to(ROOT).parts[0]
        for package in PACKAGES
        for file in (ROOT / package).rglob("*.py")
        if "fmpy" in imported(file)
    }
    assert users <= {"fmus"}


def test_only_the_log_package_uses_rerun() -> None:
    users = {
        file.relative_to(ROOT).parts[0]
        for package in PACKAGES
        for file in (ROOT / package).rglob("*.py")
        if "rerun" in imported(file)
    }
    assert users <= {"logs"}


def test_what_the_master_exports_exists_and_is_documented() -> None:
    import cosim

    for name in cosim.__all__:
        thing = getattr(cosim, name)
        assert (thing.__doc__ or "").strip(), f"cosim.{name} has no docstring"
