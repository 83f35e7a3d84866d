"""Several runs in one log: each under its own root, differences against the first, one scene with all robots.

The viewer shows one recording at a time, so what is to be overlaid has to be one recording.
"""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import rerun as rr
import rerun_cli
from rerun.chunk import Chunk, LazyChunkStream, RrdReader

from cosim.errors import ScenarioError

from .blueprint import comparison_blueprint
from .read import signals

APPLICATION = "wmr_compare"
_DIFFER = ("/plant/wheels/**", "/plant/body/**", "/plant/chassis/**")


def combine(logs: Mapping[str, Path], out: Path, *, title: str = "", report: str = "") -> Path:
    """Write the logs of several variants, by name, into one file with differences, a report and a blueprint.

    Differences are taken at the times of the first variant (B - A, with B interpolated there), for every output.
    """
    variants = list(logs)
    base = _outputs(logs[variants[0]])
    extra: list[Any] = []
    for variant in variants[1:]:
        extra += _differences(base, _outputs(logs[variant]), variant)
    extra.append(
        Chunk.from_columns("/report", [], rr.TextDocument.columns(text=[report], media_type=["text/markdown"]))
    )
    streams = [_under(path, variant, keep_ground=variant == variants[0]) for variant, path in logs.items()]
    widths = {entity.removeprefix("/"): values.shape[1] for entity, (_, values) in base.items()}
    with TemporaryDirectory(dir=out.parent) as folder:
        data, blueprint = Path(folder) / "data.rrd", Path(folder) / "view.rbl"
        LazyChunkStream.merge(*streams, LazyChunkStream.from_iter(extra)).write_rrd(
            str(data), application_id=APPLICATION, recording_id=f"{out.stem}-{'-vs-'.join(variants)}"
        )
        comparison_blueprint(variants, widths).save(APPLICATION, str(blueprint))
        merged = Path(folder) / "all.rrd"
        run_cli("rrd", "merge", str(blueprint), str(data), "-o", str(merged))
        merged.replace(out)
    return out


def run_cli(*arguments: str) -> str:
    """Run Rerun's own command line without its analytics; raises ScenarioError with what it said if it fails."""
    binary = Path(rerun_cli.__file__).parent / "rerun"
    done = subprocess.run(
        [str(binary), *arguments], capture_output=True, text=True, env={"RERUN_ANALYTICS": "0", "PATH": ""}
    )
    if done.returncode:
        raise ScenarioError(f"rerun {arguments[0]} {arguments[1]} failed: {done.stderr.strip().splitlines()[-1:]}")
    return done.stdout


def _outputs(path: Path) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    found = {}
    for content in _DIFFER:
        for port, signal in signals(path, content).items():
            if ".in." not in port:
                found[f"/plant/{port.replace('.', '/')}"] = (signal.ns, signal.values)
    return found


def _differences(base: Mapping[str, Any], other: Mapping[str, Any], variant: str) -> list[Any]:
    chunks = []
    for entity, (ns, values) in base.items():
        if entity not in other or other[entity][1].shape[1] != values.shape[1]:
            continue
        theirs_ns, theirs = other[entity]
        inside = (ns >= theirs_ns[0]) & (ns <= theirs_ns[-1])
        there = np.column_stack([np.interp(ns[inside], theirs_ns, column) for column in theirs.T])
        difference = there - values[inside]
        index = [rr.TimeColumn("sim_time", duration=ns[inside].astype("timedelta64[ns]"))]
        columns = rr.Scalars.columns(scalars=difference.ravel()).partition(np.full(len(difference), values.shape[1]))
        chunks.append(Chunk.from_columns(f"/diff/{variant}{entity}", index, columns))
    return chunks


def _under(path: Path, variant: str, *, keep_ground: bool) -> Any:
    """Return a log's chunks below its variant; the scenes are put together below one ``/world``."""
    stream = RrdReader(str(path)).stream().drop(content="/__properties/**")
    if not keep_ground:
        stream = stream.drop(content="/world/ground/**")

    def move(chunk: Any) -> Any:
        entity = chunk.entity_path
        if entity == "/world" or entity.startswith("/world/ground"):
            return chunk
        if entity.startswith("/world/"):
            return chunk.with_entity_path(f"/world/{variant}{entity.removeprefix('/world')}")
        return chunk.with_entity_path(f"/{variant}{entity}")

    return stream.map(move)
