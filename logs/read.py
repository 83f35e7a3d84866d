"""Reading a log back: signals with their units, properties, texts.  Needs no viewer and no server."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from rerun.chunk import RrdReader

from cosim.errors import ScenarioError, nearest
from cosim.quiet import without

from .cut import whole
from .ports import EXACT
from .style import WHEELS

if TYPE_CHECKING:
    import xarray

_SCALARS = "Scalars:scalars"


@dataclass(frozen=True)
class Signal:
    """One logged port: times in ns (n,), values (n, width), and what its values are called."""

    port: str  # "wheels.normal_force"; an input's is "wheels.in.gap", the master's own "master.step_size"
    ns: np.ndarray
    values: np.ndarray
    names: list[str]
    unit: str
    meaning: str
    shape: tuple[int, ...] = ()  # of the port; its values are row-major


def _open(path: Path) -> Any:
    if not path.is_file():
        raise ScenarioError(f"there is no log {path}")
    try:
        with without(Warning, "RRD file has no footer"):  # it is unfinished, which the reader copes with
            reader = RrdReader(str(path))
            try:
                found = reader.recordings()
            except Exception:  # cut in the midst of a message
                reader = RrdReader(str(whole(path)))
                found = reader.recordings()
        if not found:
            raise ScenarioError(f"{path} is not a Rerun log, or it is empty")
        return reader
    except ScenarioError:
        raise
    except Exception as error:
        raise ScenarioError(f"{path} is not a Rerun log: {error}") from None


def properties(path: Path) -> dict[str, dict[str, Any]]:
    """Return the tables of properties of a log, such as ``run``, ``provenance``, ``outcome``, ``metrics``."""
    found: dict[str, dict[str, Any]] = {}
    for entity, values in _statics(path, "/__properties/**").items():
        title = re.sub(r"\\(.)", r"\1", entity.removeprefix("/__properties").strip("/"))
        if title:
            found[title] = values
    return found


def _statics(path: Path, content: str) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for chunk in _open(path).stream().filter(content=content, is_static=True):
        batch = chunk.to_record_batch()
        for field, column in zip(batch.schema, batch.columns, strict=True):
            if b"rerun:component" in (field.metadata or {}):
                value = column.to_pylist()[-1]
                found.setdefault(chunk.entity_path, {})[field.name] = (
                    value[0] if value is not None and len(value) == 1 else value
                )
    return found


def signals(path: Path, content: str = "/**") -> dict[str, Signal]:
    """Return the logged signals by port; *content* is an entity expression such as ``/plant/wheels/**``."""
    parts: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
    for chunk in _open(path).stream().filter(content=content, is_static=False, components=_SCALARS):
        batch = chunk.to_record_batch()
        column = batch.column(_SCALARS)
        values = column.flatten().to_numpy(zero_copy_only=False).reshape(len(column), -1)
        ns = batch.column("sim_time").cast(pa.int64()).to_numpy()
        parts.setdefault(chunk.entity_path, []).append((ns, values))
    described = _statics(path, content)
    found = {}
    for entity, chunks in parts.items():
        ns = np.concatenate([c[0] for c in chunks])
        order = np.argsort(ns, kind="stable")
        values = np.concatenate([c[1] for c in chunks])[order]
        facts = described.get(entity, {})
        names = facts.get("signal_name", facts.get("SeriesLines:names", []))
        names = [names] if isinstance(names, str) else list(names)
        port = _port(entity)
        unit, meaning = str(facts.get("signal_unit", "1")), str(facts.get("meaning", ""))
        found[port] = Signal(port, ns[order], values, names, unit, meaning, _shape(facts.get("signal_shape", 0)))
    return dict(sorted(found.items()))


def _shape(extents: int | list[int]) -> tuple[int, ...]:
    """Return the shape of a port as it is logged: an empty one as 0."""
    found = (extents,) if isinstance(extents, int) else tuple(extents)
    return () if found == (0,) else found


def others(path: Path) -> dict[str, tuple[np.ndarray, list[Any]]]:
    """Return the ports that are not Float64 by name: times in ns, and their values as logged (a list per row)."""
    rows: dict[str, list[tuple[int, Any]]] = {}
    for chunk in _open(path).stream().filter(content="/plant/**", is_static=False):
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if name.startswith(EXACT):
                ns = batch.column("sim_time").cast(pa.int64()).to_pylist()
                rows.setdefault(_port(chunk.entity_path), []).extend(
                    zip(ns, batch.column(name).to_pylist(), strict=True)
                )
    ordered = {port: sorted(found, key=lambda row: row[0]) for port, found in rows.items()}
    return {port: (np.array([t for t, _ in found]), [v for _, v in found]) for port, found in ordered.items()}


def _port(entity: str) -> str:
    """Return the name of an entity with dots between its parts, and without the backslashes of odd characters."""
    return re.sub(r"\\(.)|/", lambda m: m[1] or ".", entity.strip("/").removeprefix("plant/"))


def texts(path: Path, content: str) -> list[tuple[int, str]]:
    """Return text entries as (time in ns, text), in order."""
    found = []
    for chunk in _open(path).stream().filter(content=content, is_static=False):
        batch = chunk.to_record_batch()
        if "TextLog:text" in batch.schema.names and "sim_time" in batch.schema.names:
            ns = batch.column("sim_time").cast(pa.int64()).to_pylist()
            found += [(t, row[0]) for t, row in zip(ns, batch.column("TextLog:text").to_pylist(), strict=True) if row]
    return sorted(found)


def load(path: Path | str, ports: list[str] | None = None) -> xarray.Dataset:
    """Return a log as a dataset over time in s: a variable per port with unit and meaning, properties as attributes.

    An array keeps its shape; its axes are called ``PORT.0``, ``PORT.1``, ... as in a record.  An axis over the wheels
    of a rover has their names, so that ``data["wheels.normal_force"].sel({"wheels.normal_force.0": "fl"})`` is one.
    Where a port was not logged at a time of others it is not a number.  Raises ScenarioError for a file that is no
    log, or a port it does not have.
    """
    import xarray  # brings pandas, and takes a second

    found = signals(Path(path))
    for port in ports or ():
        if port not in found:
            raise ScenarioError(f"the log {path} has no signal {port!r}; {nearest(port, found)}")
    chosen = [found[port] for port in ports or found]
    attributes = {
        f"{title}.{key}": value for title, table in properties(Path(path)).items() for key, value in table.items()
    }
    ns = _together([s.ns for s in chosen])
    time = ("time", ns / 1e9, {"units": "s", "long_name": "simulated time"})
    data = xarray.Dataset({s.port: _array(s, ns) for s in chosen}, {"time": time, "time_ns": ("time", ns)}, attributes)
    if '"assembly": "rover"' not in str(attributes.get("run.config_json")):
        return data
    return data.assign_coords({str(axis): list(WHEELS) for axis in data.dims if _over_wheels(str(axis), data)})


def _over_wheels(axis: str, data: xarray.Dataset) -> bool:
    """Return whether an axis of a rover's log has a place for each wheel: all of four but that of the quaternion."""
    return data.sizes[axis] == len(WHEELS) and not axis.startswith("body.orientation")


def _together(times: list[np.ndarray]) -> np.ndarray:
    """Return all times of several series, in order."""
    if not times or all(np.array_equal(times[0], t) for t in times):
        return times[0] if times else np.empty(0, np.int64)
    return np.unique(np.concatenate(times))


def _array(s: Signal, ns: np.ndarray) -> tuple[tuple[str, ...], np.ndarray, dict[str, str]]:
    """Return axes, values at the times *ns* and attributes of a signal."""
    values = s.values
    if not np.array_equal(s.ns, ns):
        values = np.full((len(ns), s.values.shape[1]), np.nan)
        values[np.searchsorted(ns, s.ns)] = s.values
    width = values.shape[1]
    shape = s.shape if np.prod(s.shape, dtype=int) == width else (() if width == 1 else (width,))
    axes = tuple(f"{s.port}.{axis}" for axis in range(len(shape)))
    return ("time", *axes), values.reshape(len(ns), *shape), {"units": s.unit, "long_name": s.meaning}
