"""Several runs in one log: each under its own root, differences against a baseline, one scene with all robots.

The viewer shows one recording at a time, so what is to be overlaid has to be one recording::

    /<variant>/plant/...             outputs of up to WIDEST values (the rest and the inputs are in the run's own log)
    /diff/<variant>/plant/...        B - A for each of them, if there are up to ALL_DIFFERENCES variants
    /overlay/<panel>/<variant>       the curves one decides by, in units for reading
    /overlay_diff/<panel>/<variant>  B - A for each of them
    /world/...                       one ground, all robots;  /report  the verdict

A is the baseline, which is the first and has the first colour.  A difference is taken at every time that either run
has, both interpolated linearly there: of runs of different step sizes, or cut at events of their own, no peak is lost.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import rerun as rr
from rerun.chunk import Chunk, RrdReader

from cosim.errors import ScenarioError, nearest

from .blueprint import Camera, comparison_blueprint
from .panels import PANELS
from .parts import Ports, Read, by_parts
from .ports import entity, scalars
from .read import Signal, properties, signals
from .scene import painted
from .style import colour

T = TypeVar("T")
APPLICATION = "wmr_compare"
WIDEST = 4  # values of a port: a scalar, a vector, four wheels; not matrices and stations
ALL_DIFFERENCES = 3  # variants: with more, the file would be large and hardly anybody look


def combine(
    logs: Mapping[str, Path],
    out: Path,
    *,
    title: str = "",
    report: str = "",
    camera: Camera | None = None,
    baseline: str | None = None,
) -> Path:
    """Write the logs of several variants, by name, into one file with differences, a *report* and a blueprint.

    *title* is what the comparison is about, *camera* looks at the scene, if there is one; the differences are to
    *baseline*, or to the first.  Raises ScenarioError for a baseline that is none of them, or if the file cannot be
    written.
    """
    logs = baseline_first(logs, baseline)
    variants = list(logs)
    base = _outputs(logs[variants[0]])
    part = out.with_suffix(f".{secrets.token_hex(4)}.rrd.part")
    recording = rr.RecordingStream(APPLICATION, recording_id=f"{out.stem}-{'-vs-'.join(variants)}")
    try:
        recording.save(str(part), default_blueprint=comparison_blueprint(variants, base, camera))
        rr.set_log_time_enabled(False, recording=recording)
        title = title or out.stem
        recording.send_recording_name(title)
        recording.send_property("compare", rr.AnyValues(variants=variants, title=title, base=variants[0]))
        recording.log("report", rr.TextDocument(report, media_type="text/markdown"), static=True)
        for number, (variant, path) in enumerate(logs.items()):
            found = _outputs(path) if number else base
            recording.send_chunks(_under(path, variant, found, keep_ground=not number))
            recording.send_chunks(_overlaid(variant, number, found, base))
            recording.send_chunks(_painted(path, variant, number))
            recording.send_chunks(_properties(path, variant))
            if number and len(variants) <= ALL_DIFFERENCES:
                recording.send_chunks(_differences(base, found, variant))
            recording.flush()
        recording.disconnect()
        part.replace(out)
    except (OSError, RuntimeError) as error:
        raise ScenarioError(f"cannot write the combined log {out}: {str(error).splitlines()[0]}") from None
    finally:
        part.unlink(missing_ok=True)
    return out


def baseline_first(runs: Mapping[str, T], baseline: str | None) -> dict[str, T]:
    """Return what there is by variant with *baseline* first, the others as they were; raises ScenarioError."""
    if baseline is not None and baseline not in runs:
        raise ScenarioError(f"there is no variant {baseline!r} to be the baseline; {nearest(baseline, runs)}")
    return {name: runs[name] for name in sorted(runs, key=lambda name: name != baseline)}


def _outputs(path: Path) -> dict[str, Signal]:
    return {port: s for port, s in signals(path, "/plant/**").items() if ".in." not in port}


def _narrow(found: Mapping[str, Signal]) -> dict[str, Signal]:
    return {port: s for port, s in found.items() if s.values.shape[1] <= WIDEST}


def _at(variant: str, rest: str) -> str:
    """Return an entity below a variant's root, whatever characters its name has."""
    return f"/{rr.escape_entity_path_part(variant)}{rest}"


def _series(
    ns: np.ndarray, values: np.ndarray, path: str, names: list[str], unit: str, meaning: str, **style: Any
) -> Iterable[Chunk]:
    """Yield the columns of one entity and what does not change about it."""
    yield Chunk.from_columns(path, [rr.TimeColumn("sim_time", duration=ns.astype("timedelta64[ns]"))], scalars(values))
    columns = rr.SeriesLines.columns(names=names, **style)
    yield Chunk.from_columns(path, [], columns.partition([len(names)]))
    yield Chunk.from_columns(path, [], rr.AnyValues.columns(signal_unit=[unit], meaning=[meaning]))


def difference(
    ns: np.ndarray, mine: np.ndarray, other: np.ndarray, theirs: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the times (n,) in ns of A or B at which both runs were on, and B - A there (n, width).

    *mine* are the values of A at the times *ns*, *theirs* those of B at *other*, a row per time.
    """
    both = np.union1d(ns, other)
    both = both[(both >= max(ns[0], other[0])) & (both <= min(ns[-1], other[-1]))]
    return both, _at_times(both, other, theirs) - _at_times(both, ns, mine)


def _at_times(times: np.ndarray, ns: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.column_stack([np.interp(times, ns, column) for column in values.T])


def _differences(base: Mapping[str, Signal], other: Mapping[str, Signal], variant: str) -> Iterable[Chunk]:
    for port, a in _narrow(base).items():
        b = other.get(port)
        if b is None or b.values.shape[1] != a.values.shape[1]:
            continue
        ns, values = difference(a.ns, a.values, b.ns, b.values)
        component, _, name = port.partition(".")
        path = f"/diff{_at(variant, f'/plant/{component}/{name}')}"
        meaning = f"{variant} minus the baseline: {a.meaning}"
        yield from _series(ns, values, path, [f"{label} [{a.unit}]" for label in a.names], a.unit, meaning)


def _overlaid(variant: str, number: int, found: Mapping[str, Signal], base: Mapping[str, Signal]) -> Iterable[Chunk]:
    paint: dict[str, Any] = {"colors": [colour(number)], "widths": [1.5]}
    for panel in PANELS:
        curve = panel.read(_values(found))
        if curve is None:
            continue
        of = found[Ports(found).at(panel.port)]
        about: tuple[list[str], str, str] = ([variant], panel.unit, panel.title)
        yield from _series(of.ns, curve[:, None], f"/overlay/{panel.key}{_at(variant, '')}", *about, **paint)
        first = panel.read(_values(base))
        if number and first is not None:
            ns, values = difference(base[Ports(base).at(panel.port)].ns, first[:, None], of.ns, curve[:, None])
            yield from _series(ns, values, f"/overlay_diff/{panel.key}{_at(variant, '')}", *about, **paint)


def _values(found: Mapping[str, Signal]) -> Read:
    """Return who reads the values of signals, by part."""
    return by_parts(lambda port: found[port].values if port in found else None)


def _painted(path: Path, variant: str, number: int) -> Iterable[Chunk]:
    drawn = {c.entity_path.removeprefix("/world/") for c in RrdReader(str(path)).stream().filter(content="/world/**")}
    for place, columns in painted(colour(number), ghost=number > 0).items():
        if place in drawn:
            yield Chunk.from_columns(f"/world{_at(variant, '/' + place)}", [], columns)


def _properties(path: Path, variant: str) -> Iterable[Chunk]:
    for title, table in properties(path).items():
        known = {k: v for k, v in table.items() if v is not None and ":" not in k}
        if known:
            yield Chunk.from_property(f"{variant} {title}", rr.AnyValues(**known))


def _under(path: Path, variant: str, found: Mapping[str, Signal], *, keep_ground: bool) -> Any:
    """Return a log's chunks below its variant; the scenes are put together below one ``/world``."""
    stream = RrdReader(str(path)).stream().drop(content="/__properties/**").drop(content="/report")
    for component in {port.partition(".")[0] for port in found}:
        stream = stream.drop(content=f"/plant/{component}/in/**")
    for port in found.keys() - _narrow(found).keys():
        stream = stream.drop(content=f"/{entity(port)}")
    if not keep_ground:
        stream = stream.drop(content="/world/ground/**")

    def move(chunk: Any) -> Any:
        place = chunk.entity_path
        if place == "/world" or place.startswith("/world/ground"):
            return chunk
        if place.startswith("/world/"):
            return chunk.with_entity_path(f"/world{_at(variant, place.removeprefix('/world'))}")
        return chunk.with_entity_path(_at(variant, place))

    return stream.map(move)
