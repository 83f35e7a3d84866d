"""Forces to play back: from a file, from the log of an earlier run, or computed off line by the analytical model.

A slot names one of

    file = "forces.csv"             CSV or Parquet with the columns time [s], traction_fl [N], traction_fr [N],
                                    traction_rl [N], traction_rr [N]; interpolation = "linear" or "held"
    log = "run.rrd"                 port = "controller.traction_demand", or "wheels.traction" for what friction let pass
    off_line = { T = 0.1 }          h0, h1, k_w, c_w, mu, z_target, robot: of the impact law and the model it runs on

A file written by ``wmr-cosim inspect --csv`` or ``--parquet`` is read with ``port`` beside it.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from controllers.off_line import AxleModel, PlannedLaw, off_line_forces
from controllers.pd_impact import gains_by_stiffness
from controllers.playback import Playback, force_table
from cosim import units
from cosim.errors import CosimError, DeclarationError, ScenarioError, nearest
from plants.planar import Bicycle, Posture
from plants.wheel_path import rolling_path

from .context import Context

COLUMNS = ("traction_fl", "traction_fr", "traction_rl", "traction_rr")
_SOURCES = ("file", "log", "off_line")
_JUST_BEFORE = 5e-10  # s, half a tick: a recorded row holds from a tick on, whichever way that tick's time is rounded
_WORDS = ("h0", "h1", "k_w", "c_w", "mu", "z_target", "T", "robot", "step")


def playback(parameters: dict[str, Any], context: Context) -> Playback:
    """Return `Playback` with the forces that the slot names; raises ScenarioError for any that cannot be played."""
    given = [name for name in _SOURCES if name in parameters]
    if "forces" in parameters and not given:
        return Playback(**parameters)
    if len(given) != 1:
        raise ScenarioError(f"playback needs one of {', '.join(_SOURCES)}, not {' and '.join(given) or 'none'}")
    source = parameters.pop(given[0])
    found = _off_line(source, context) if given[0] == "off_line" else _recorded(Path(source), given[0], parameters)
    spacing = float(np.median(np.diff(found["forces"][1:, 0])))
    return Playback(**{"period": min(1e-3, round(spacing, 9)), **found, **parameters})


def _recorded(path: Path, kind: str, parameters: dict[str, Any]) -> dict[str, Any]:
    port = parameters.pop("port", "controller.traction_demand" if kind == "log" else None)
    interpolation = parameters.pop("interpolation", "held" if port else "linear")
    largest_step = parameters.pop("largest_step", None)
    try:
        if kind == "log":
            time, forces = read_log(path, port)
        else:
            time, forces = read_file(path, COLUMNS if port is None else tuple(f"{port}[{i}]" for i in range(1, 5)))
        if port is not None:  # a recorded value is that of the step that ended then
            time, forces = time[:-1] - _JUST_BEFORE, forces[1:]
        return force_table(time, forces, interpolation, largest_step)
    except DeclarationError as error:
        raise ScenarioError(f"{path}: {error}") from None


def read_file(path: Path, columns: tuple[str, ...] = COLUMNS) -> tuple[np.ndarray, np.ndarray]:
    """Return times (n,) in s and forces (n, 4) in N of a CSV or Parquet file; an empty cell is not a number.

    Raises ScenarioError naming the file for a column that is missing, without a unit, or in another one.
    """
    import pyarrow as pa  # of all designs only this one needs it
    import pyarrow.csv
    import pyarrow.parquet

    if path.suffix not in (".csv", ".parquet"):
        raise ScenarioError(f"cannot play back {path}: the name must end in .csv or .parquet")
    try:
        read = pyarrow.csv.read_csv if path.suffix == ".csv" else pyarrow.parquet.read_table
        content = read(path)
    except (OSError, pa.ArrowException) as error:
        raise ScenarioError(f"cannot read the forces {path}: {error}") from None
    found = dict(_column(path, header) for header in content.column_names)
    values = []
    for name in ("time", *columns):
        unit = "s" if name == "time" else "N"
        if name not in found:
            raise ScenarioError(f"{path} has no column '{name} [{unit}]'; {nearest(name, found)}")
        header, given = found[name]
        _check_unit(path, header, given, unit)
        try:
            values.append(content[header].cast(pa.float64()).to_numpy())
        except pa.ArrowException as error:
            raise ScenarioError(f"{path}: the column {header!r} does not hold numbers only: {error}") from None
    return values[0], np.column_stack(values[1:])


def _column(path: Path, header: str) -> tuple[str, tuple[str, str | None]]:
    """Return name, and header with unit, of a column called ``name [unit]``."""
    match = re.fullmatch(r"\s*(.*?)\s*\[([^\[\]]*[^\[\]\d][^\[\]]*)\]\s*", header)
    return (match[1], (header, match[2].strip())) if match else (header.strip(), (header, None))


def _check_unit(path: Path, header: str, given: str | None, wanted: str) -> None:
    if given is None:
        raise ScenarioError(f"{path}: the column {header!r} has no unit; call it '{header.strip()} [{wanted}]'")
    try:
        unit, right = units.parse(given), units.parse(wanted)
    except CosimError as error:
        raise ScenarioError(f"{path}: the column {header!r}: {error}") from None
    if not unit.equals(right):
        why = f"is {unit.conversion(right)[0]:g} {wanted}" if unit.same_dimension(right) else "is another quantity"
        raise ScenarioError(f"{path}: the column {header!r} is in {given}, which {why}; playback needs {wanted}")


def read_log(path: Path, port: str) -> tuple[np.ndarray, np.ndarray]:
    """Return times (n,) in s and forces (n, 4) in N that a log recorded; raises ScenarioError naming file and port."""
    from logs.read import signals  # Rerun takes half a second to import

    found = signals(path)
    if port not in found:
        raise ScenarioError(f"the log {path} has no signal {port!r}; {nearest(port, found)}")
    signal = found[port]
    if signal.values.shape[1] != 4:
        raise ScenarioError(f"{port} of the log {path} has {signal.values.shape[1]} values, but there are 4 wheels")
    _check_unit(path, port, signal.unit, "N")
    return signal.ns * 1e-9, signal.values


def _off_line(words: dict[str, Any], context: Context) -> dict[str, Any]:
    """Compute the forces from the front wheels' impact to the end of the run."""
    words = _complete(words, context)
    robot = context.believed(words)
    where, slope = _impact(context)
    wait = (where - context.x - robot.L_f) / context.speed
    time = np.arange(0.0, context.duration - wait + words["step"], words["step"])
    if wait < 0 or len(time) < 2:
        raise ScenarioError(f"the front wheels meet the obstacle at t = {wait:.4g} s, outside the run")
    side, at = Bicycle(robot), Posture(slope)
    model = AxleModel(side.P(at), side.U(at), side.b(at, np.zeros(3)), 2 * words["k_w"], 2 * words["c_w"])
    level = side.contact_forces(Posture(0.0), np.zeros(3), np.zeros(2))
    start = np.append(-level / model.k_w, [0.0, -context.speed * np.sin(slope)])
    axles = off_line_forces(model, _law(words, model), start, time)
    return force_table(time + wait, axles[:, [1, 1, 0, 0]] / 2, "linear")


def _complete(words: dict[str, Any], context: Context) -> dict[str, Any]:
    """Return what the slot says of the off-line model, with the wheels' own values and the usual ones for the rest."""
    if not isinstance(words, dict):
        raise ScenarioError(f"off_line must be a table of {', '.join(_WORDS)}, not {words!r}")
    for name in words:
        if name not in _WORDS:
            raise ScenarioError(f"off_line.{name} is not known; {nearest(name, _WORDS)}")
    wheels = {n: float(np.mean(v)) for n, v in context.wheels().items() if n in ("k_w", "c_w", "mu")}
    found = {"T": 0.1, "step": 1e-4, "c_w": 0.0, "mu": np.inf, **wheels, **words}
    if "k_w" not in found:
        raise ScenarioError(
            "off_line needs k_w, the stiffness of a wheel in N/m, since the wheels of this run have none"
        )
    positive = {"start.speed": context.speed, **{f"off_line.{n}": found[n] for n in ("T", "step", "k_w")}}
    for name, value in positive.items():
        if not value > 0:
            raise ScenarioError(f"{name} is {value:g}, but off-line forces need a positive one")
    return found


def _law(words: dict[str, Any], model: AxleModel) -> PlannedLaw:
    h0 = float(words.get("h0", gains_by_stiffness(model.k_w, float(model.P[1, 1]))[0]))
    if "z_target" in words:
        wheels = np.broadcast_to(np.asarray(words["z_target"], float), 4)
        target = np.array([wheels[2:].mean(), wheels[:2].mean()])
    else:
        target = np.linalg.solve(model.P * model.k_w, model.b)  # static: needs no traction
    h1 = float(words.get("h1", 2 * np.sqrt(h0)))
    return PlannedLaw(h0, h1, target, float(words["T"]), float(words["mu"]))


def _impact(context: Context) -> tuple[float, float]:
    """Return where the front wheel centres meet the obstacle, in m, and its slope there, in rad."""
    paths = [rolling_path(side, context.robot.R) for side in (context.ground.left, context.ground.right)]
    kinks = [path.kinks[0] for path in paths if path.kinks]
    if len(kinks) != 2 or kinks[0] != kinks[1]:
        raise ScenarioError("off-line forces need the same sharp foot under both tracks, such as that of a ramp")
    return kinks[0].x, float(np.arctan(kinks[0].after[0]))
