"""A measured ground: a CSV file with the columns ``x`` and ``height`` in metres."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from functools import cached_property
from math import inf, isfinite
from pathlib import Path
from typing import Literal

import numpy as np

from cosim.errors import ScenarioError

from .profile import Piece, Profile, line

COLUMNS = ("x", "height")


@dataclass(frozen=True)
class CsvProfile(Profile):
    """Ground through the points of a CSV file with the columns x and height in m; level before and behind.

    The first line names the columns, ``x,height`` or ``x [m],height [m]`` in any order; further columns are ignored and
    so are lines that start with #.  ``smooth`` joins the points by a quintic spline (level at both ends, continuous to
    the fourth derivative), ``linear`` by straight lines with corners.  The file is read once, when the profile is made.
    """

    path: str
    interpolation: Literal["smooth", "linear"] = "smooth"
    points: tuple[tuple[float, float], ...] = field(init=False, repr=False)  # (x, height) in m

    def __post_init__(self) -> None:
        if self.interpolation not in ("smooth", "linear"):
            raise ScenarioError(
                f"CsvProfile.interpolation cannot be {self.interpolation!r}; it is 'smooth' or 'linear'"
            )
        object.__setattr__(self, "points", read_points(Path(self.path)))

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Level, the points joined, level."""
        x, height = np.array(self.points).T
        before, behind = line(-inf, x[0], x[0], height[0]), line(x[-1], inf, x[-1], height[-1])
        return before, *(self._smooth(x, height) if self.interpolation == "smooth" else _lines(x, height)), behind

    def _smooth(self, x: np.ndarray, height: np.ndarray) -> tuple[Piece, ...]:
        from scipy.interpolate import make_interp_spline

        level = [(1, 0.0), (2, 0.0)]
        spline = make_interp_spline(x, height, k=5, bc_type=(level, level))
        slope, second = spline.derivative(1), spline.derivative(2)

        def jet(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            return spline(x), slope(x), second(x)

        return (Piece(x[0], x[-1], jet, float(np.min(np.diff(x))) / 4),)


def _lines(x: np.ndarray, height: np.ndarray) -> tuple[Piece, ...]:
    slope = np.diff(height) / np.diff(x)
    return tuple(line(x[i], x[i + 1], x[i], height[i], slope[i]) for i in range(slope.size))


def read_points(path: Path) -> tuple[tuple[float, float], ...]:
    """Return the points (x, height) of a CSV file, in m; raises ScenarioError naming file and line."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise ScenarioError(f"cannot read the ground profile {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ScenarioError(f"cannot read the ground profile {path}: it is no text file in UTF-8") from None
    rows = [(number, text) for number, text in enumerate(lines, 1) if text.strip() and not text.startswith("#")]
    if len(rows) < 3:
        raise ScenarioError(f"{path} needs a line of column names and at least two points, but has {len(rows)} lines")
    places = _columns(path, *rows[0])
    points: list[tuple[float, float]] = []
    for number, text in rows[1:]:
        cells = next(csv.reader([text]))
        values = tuple(_number(path, number, cells, place, name) for name, place in zip(COLUMNS, places, strict=True))
        if points and not values[0] > points[-1][0]:
            raise ScenarioError(f"{path}:{number}: x is {values[0]:g} m after {points[-1][0]:g} m, but must ascend")
        points.append((values[0], values[1]))
    return tuple(points)


def _columns(path: Path, number: int, text: str) -> list[int]:
    """Return where x and height stand in the header."""
    found = {}
    for place, cell in enumerate(next(csv.reader([text]))):
        name, _, unit = cell.strip().rstrip("])").replace("(", "[").partition("[")
        name = name.strip()
        if name in COLUMNS:
            if unit.strip() not in ("", "m"):
                raise ScenarioError(f"{path}:{number}: {name} is given in {unit.strip()}, but must be in m")
            found[name] = place
    for name in COLUMNS:
        if name not in found:
            raise ScenarioError(f"{path}:{number}: there is no column {name!r} in {text!r}; name the columns x,height")
    return [found[name] for name in COLUMNS]


def _number(path: Path, number: int, cells: list[str], place: int, name: str) -> float:
    text = cells[place].strip() if place < len(cells) else ""
    try:
        value = float(text)
    except ValueError:
        raise ScenarioError(f"{path}:{number}: {name} must be a number in m, not {text!r}") from None
    if not isfinite(value):
        raise ScenarioError(f"{path}:{number}: {name} must be finite, not {text}")
    return value
