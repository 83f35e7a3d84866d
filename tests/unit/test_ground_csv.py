"""A ground measured elsewhere: a CSV file of x and height."""

from pathlib import Path

import numpy as np
import pytest

from cosim.errors import ScenarioError
from plants.ground import CsvProfile, Hump
from plants.wheel_path import rolling_path


def written(folder: Path, text: str) -> str:
    """Return the path of a file with the text."""
    path = folder / "ground.csv"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_sampled_hump_comes_back(tmp_path: Path) -> None:
    """A quintic spline through samples d apart misses the hump by O(d^6): seen by halving d."""
    hump = Hump(1.0, 1.0, 0.05, shape="sin4")
    missed = []
    for count in (31, 61):
        x = np.linspace(0.8, 2.2, count)
        rows = "\n".join(f"{a!r},{float(h)!r}" for a, h in zip(x.tolist(), hump.elevation(x), strict=True))
        csv = CsvProfile(written(tmp_path, f"x,height\n{rows}\n"))
        np.testing.assert_allclose(csv.elevation(x), hump.elevation(x), rtol=0, atol=1e-15)
        dense = np.linspace(0.9, 2.1, 2001)
        missed.append(np.max(np.abs(csv.elevation(dense) - hump.elevation(dense))))
        path, exact = rolling_path(csv, 0.1), rolling_path(hump, 0.1)
        # the envelope of a ground that is nowhere further off is nowhere further off, but for the patches' own errors
        assert np.max(np.abs(path.height(dense) - exact.height(dense))) < missed[-1] + 2e-9
    # order 5 rather than 6 at the feet, where the hump's fourth derivative jumps: at least 2^4 for half the spacing
    assert missed[1] < missed[0] / 2**4


def test_straight_lines_keep_their_corners(tmp_path: Path) -> None:
    csv = CsvProfile(written(tmp_path, "x,height\n1,0\n2,0.1\n3,0.1\n4,0\n"), interpolation="linear")
    assert csv.corners == (1, 2, 3, 4)
    np.testing.assert_allclose(csv.elevation([0, 1.5, 2.5, 3.5, 9]), [0, 0.05, 0.1, 0.05, 0], atol=1e-15)
    path = rolling_path(csv, 0.1)
    shift = 0.1 * np.tan(np.arctan(0.1) / 2)
    assert [k.x for k in path.kinks] == pytest.approx([1 - shift, 4 + shift], abs=1e-12)


def test_columns_are_found_by_name_with_or_without_their_unit(tmp_path: Path) -> None:
    plain = CsvProfile(written(tmp_path, "x,height\n0,0.5\n1,0.25\n"))
    for text in (
        "# measured on site\nheight [m], quality, x (m)\n\n0.5, good, 0\n# again\n0.25, poor, 1\n",
        "\ufeffx,height\r\n0,0.5\r\n1,0.25\r\n",
    ):
        assert CsvProfile(written(tmp_path, text)).points == plain.points == ((0.0, 0.5), (1.0, 0.25))


def test_the_ground_is_level_outside_the_points(tmp_path: Path) -> None:
    csv = CsvProfile(written(tmp_path, "x,height\n0,0.5\n1,0.25\n3,0.3\n"))
    np.testing.assert_allclose(csv.elevation([-5, 0, 3, 9]), [0.5, 0.5, 0.3, 0.3], rtol=1e-14)
    np.testing.assert_allclose(csv.slope([0, 3]), 0, atol=1e-14)
    assert csv.corners == csv.knots == ()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x,height\n0,0\n", "{} needs a line of column names and at least two points, but has 2 lines"),
        ("x,z\n0,0\n1,0\n", "{}:1: there is no column 'height' in 'x,z'; name the columns x,height"),
        ("x [mm],height\n0,0\n1,0\n", "{}:1: x is given in mm, but must be in m"),
        ("x,height\n0,0\n1,high\n", "{}:3: height must be a number in m, not 'high'"),
        ("x,height\n0,0\n1\n", "{}:3: height must be a number in m, not ''"),
        ("x,height\n0,0\n1,nan\n", "{}:3: height must be finite, not nan"),
        ("x,height\n\n0,0\n1,0\n1,0.2\n", "{}:5: x is 1 m after 1 m, but must ascend"),
    ],
)
def test_a_wrong_file_is_refused_with_its_line(tmp_path: Path, text: str, sentence: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ScenarioError) as error:
        CsvProfile(path)
    assert str(error.value) == sentence.format(path)


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError) as error:
        CsvProfile(str(tmp_path / "none.csv"))
    assert str(error.value) == f"cannot read the ground profile {tmp_path / 'none.csv'}: No such file or directory"
    (tmp_path / "binary.csv").write_bytes(b"x,height\n\xff\xfe")
    with pytest.raises(ScenarioError) as error:
        CsvProfile(str(tmp_path / "binary.csv"))
    assert str(error.value) == f"cannot read the ground profile {tmp_path / 'binary.csv'}: it is no text file in UTF-8"


def test_an_unknown_interpolation_is_refused() -> None:
    with pytest.raises(ScenarioError) as error:
        CsvProfile("any.csv", interpolation="cubic")  # type: ignore[arg-type]
    assert str(error.value) == "CsvProfile.interpolation cannot be 'cubic'; it is 'smooth' or 'linear'"
