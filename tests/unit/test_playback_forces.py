"""Forces to play back: the table, the files they come from, and the off-line model that computes them."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest

from controllers.off_line import AxleModel, PlannedLaw, off_line_forces
from controllers.playback import Playback, force_table
from controllers.reference import planned
from cosim.errors import DeclarationError, ScenarioError
from plants.planar import Bicycle, Posture
from plants.tables import robot
from studies.designs.playback import read_file

HEADER = "time [s],traction_fl [N],traction_fr [N],traction_rl [N],traction_rr [N]"
TIME = np.array([0.1, 0.2, 0.3, 0.4])
FORCES = np.array([[1.0, 2, 3, 4], [2, 2, 3, 0], [4, 2, 3, 8], [0, 0, 0, 0]])


def played(interpolation: str, period: float = 0.05) -> dict[float, np.ndarray]:
    """Return what is asked after each period, by the time at its start."""
    instance = Playback(period=period, **force_table(TIME, FORCES, interpolation)).instance()
    instance.enter_initialization(0)
    instance.exit_initialization()
    ns, found = round(period * 1e9), {}
    for k in range(10):
        instance.step(k * ns, (k + 1) * ns)
        instance.pull()
        found[round(k * period, 9)] = np.append(instance.get("traction_demand"), instance.get("active"))
    return found


def test_forces_are_joined_by_lines_or_held_and_there_are_none_outside_the_table() -> None:
    linear, held = played("linear"), played("held")
    nothing = np.zeros(5)
    for t in (0.0, 0.05, 0.4, 0.45):
        np.testing.assert_array_equal(linear[t], nothing)
        np.testing.assert_array_equal(held[t], nothing)
    np.testing.assert_allclose(linear[0.1], [1, 2, 3, 4, 1], atol=1e-12)
    np.testing.assert_allclose(linear[0.15], [1.5, 2, 3, 2, 1], atol=1e-12)
    np.testing.assert_allclose(linear[0.35], [2, 1, 1.5, 4, 1], atol=1e-12)
    np.testing.assert_allclose(held[0.15], [1, 2, 3, 4, 1], atol=1e-12)
    np.testing.assert_allclose(held[0.35], [4, 2, 3, 8, 1], atol=1e-12)


@pytest.mark.parametrize(
    ("time", "forces", "sentence"),
    [
        ([0.0], np.ones((1, 4)), "needs at least two rows, but has 1"),
        ([0.0, 0.1, 0.1], np.ones((3, 4)), r"time is 0.1 s after 0.1 s, but must ascend"),
        ([0.0, 0.1, 0.2], [[1] * 4, [1, 2, np.nan, 4], [1] * 4], r"row 2 \(t = 0.1 s\) lacks a number"),
        (
            [0.0, 0.1, 0.2, 0.6, 0.7],
            np.ones((5, 4)),
            r"a gap from t = 0.2 s to 0.6 s, wider than 0.3 s; give the rows in between, or set largest_step = 0.4",
        ),
    ],
)
def test_a_table_that_cannot_be_played_is_refused(time: list[float], forces: np.ndarray, sentence: str) -> None:
    with pytest.raises(DeclarationError, match=sentence):
        force_table(np.array(time), np.array(forces, float))


def test_a_wide_step_may_be_meant() -> None:
    found = force_table(np.array([0.0, 0.1, 0.2, 0.6]), np.ones((4, 4)), largest_step=0.4)
    assert (found["t_start"], found["t_end"]) == (0.0, 0.6)
    with pytest.raises(DeclarationError, match="interpolation cannot be 'cubic'; it is 'linear' or 'held'"):
        force_table(TIME, FORCES, "cubic")


def written(folder: Path, text: str) -> Path:
    """Return the path of a CSV file with the text."""
    path = folder / "forces.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_csv_and_parquet_give_the_same_forces(tmp_path: Path) -> None:
    rows = "\n".join(",".join(repr(float(v)) for v in (t, *f)) for t, f in zip(TIME, FORCES, strict=True))
    table = pa.table({name: column for name, column in zip(HEADER.split(","), (TIME, *FORCES.T), strict=True)})
    pyarrow.parquet.write_table(table, tmp_path / "forces.parquet")
    for path in (written(tmp_path, f"{HEADER}\n{rows}\n"), tmp_path / "forces.parquet"):
        time, forces = read_file(path)
        np.testing.assert_array_equal(time, TIME)
        np.testing.assert_array_equal(forces, FORCES)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (HEADER.replace(",traction_rl [N]", "") + "\n0,1,2,4\n", r"has no column 'traction_rl \[N\]'; did you mean"),
        (HEADER.replace("rl [N]", "rl [kN]") + "\n0,1,2,3,4\n", r"'traction_rl \[kN\]' is in kN, which is 1000 N; pl"),
        (
            HEADER.replace("rl [N]", "rl [N.m]") + "\n0,1,2,3,4\n",
            r"is in N.m, which is another quantity; playback needs",
        ),
        (HEADER.replace("rl [N]", "rl") + "\n0,1,2,3,4\n", r"'traction_rl' has no unit; call it 'traction_rl \[N\]'"),
        (
            HEADER.replace("[s]", "[ms]") + "\n0,1,2,3,4\n",
            r"'time \[ms\]' is in ms, which is 0.001 s; playback needs s",
        ),
        (HEADER.replace("[s]", "[sec]") + "\n0,1,2,3,4\n", r"'time \[sec\]': cannot read unit 'sec'"),
        (HEADER + "\n0,1,2,three,4\n", r"the column 'traction_rl \[N\]' does not hold numbers only"),
        (HEADER + "\n0,1,2\n", r"cannot read the forces .*forces.csv: CSV parse error"),
    ],
)
def test_a_file_that_is_wrong_is_refused_in_one_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        read_file(written(tmp_path, text))


def test_an_empty_cell_is_a_gap(tmp_path: Path) -> None:
    time, forces = read_file(written(tmp_path, f"{HEADER}\n0,1,2,3,4\n0.1,1,2,,4\n0.2,1,2,3,4\n"))
    with pytest.raises(DeclarationError, match=r"row 2 \(t = 0.1 s\) lacks a number"):
        force_table(time, forces)


def test_a_file_that_is_not_there_or_of_another_kind(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"cannot read the forces .*none.csv"):
        read_file(tmp_path / "none.csv")
    with pytest.raises(ScenarioError, match=r"forces.txt: the name must end in .csv or .parquet"):
        read_file(tmp_path / "forces.txt")


def ramp() -> tuple[AxleModel, np.ndarray]:
    """Return the axles at the foot of a 0.3 rad ramp, and their deformations and rates at the impact at 2 m/s."""
    side, at = Bicycle(robot("thesis_6_1")), Posture(0.3)
    model = AxleModel(side.P(at), side.U(at), side.b(at, np.zeros(3)), 5.6e6)
    level = side.contact_forces(Posture(0.0), np.zeros(3), np.zeros(2))
    return model, np.append(-level / model.k_w, [0.0, -2 * np.sin(0.3)])


def test_off_line_forces_are_the_inverse_of_the_plan() -> None:
    """From a matched start and without limits the deformations follow the plan, so U F_a = z_R'' - b + k P z_R."""
    model, start = ramp()
    law = PlannedLaw(1500.0, 70.0, np.array([-0.01, -0.02]), 0.1)
    time = np.linspace(0, 0.12, 601)
    found = off_line_forces(model, law, start, time)
    for i, t in enumerate(time):
        path = planned(min(t, 0.1), 0.1, start[:2], start[2:], law.target)
        acceleration = path.acceleration if t < 0.1 else np.zeros(2)
        expected = np.linalg.solve(model.U, acceleration - model.b + model.k_w * model.P @ path.z)
        # deformations are integrated to 1e-8 of 20 mm, which is 1e-3 N in the springs and |U^-1 P| = 7 times that
        np.testing.assert_allclose(found[i], expected, atol=0.01)


def test_off_line_forces_stay_within_friction() -> None:
    model, start = ramp()
    time = np.linspace(0, 0.05, 501)
    law = PlannedLaw(1500.0, 70.0, np.array([-0.01, -0.02]), 0.1, mu=0.8)
    found = off_line_forces(model, law, start, time)
    unlimited = off_line_forces(model, PlannedLaw(1500.0, 70.0, law.target, 0.1), start, time)
    assert np.max(np.abs(found)) < 0.2 * np.max(np.abs(unlimited))
    F_n = model.normal_force(start[:2], start[2:])
    np.testing.assert_allclose(np.abs(found[0]), np.minimum(np.abs(unlimited[0]), 0.8 * F_n), rtol=1e-12)
    lost = np.all(found == 0, axis=1)  # the law needs both axles, and rests while one is in the air
    assert 0 < np.count_nonzero(lost) < len(time)
