"""Signals as an MCAP file, which Foxglove opens: a topic for every port, messages in JSON, log times in ns."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from heapq import merge
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import ScenarioError

from .read import Signal


def write(chosen: Sequence[Signal], out: Path) -> None:
    """Write signals to *out* in the order of time; what is not finite becomes null: JSON has no word for it.

    Raises ScenarioError if the package mcap is missing, OSError if the file cannot be written.
    """
    try:
        from mcap.writer import Writer
    except ImportError:
        raise ScenarioError(
            f"cannot write {out} without the package mcap; install it with: pip install 'wmr-cosim[mcap]'"
        ) from None
    with out.open("wb") as stream:
        writer = Writer(stream)
        writer.start(library="wmr-cosim")
        channels: dict[int, Signal] = {}
        for signal in chosen:
            schema = writer.register_schema(signal.port, "jsonschema", json.dumps(_schema(signal)).encode())
            channels[writer.register_channel(signal.port, "json", schema, {"unit": signal.unit})] = signal
        for t, channel, k in merge(*(_times(channel, signal) for channel, signal in channels.items())):
            data = _message(channels[channel], k)
            writer.add_message(channel, log_time=t, publish_time=t, sequence=k, data=data)
        writer.finish()


def _times(channel: int, signal: Signal) -> Iterator[tuple[int, int, int]]:
    return ((int(t), channel, k) for k, t in enumerate(signal.ns))


def _schema(signal: Signal) -> dict[str, Any]:
    about = {"type": ["number", "null"], "description": f"[{signal.unit}]"}
    fields = {name: about for name in signal.names}
    return {"title": signal.port, "description": signal.meaning, "type": "object", "properties": fields}


def _message(signal: Signal, k: int) -> bytes:
    values = [float(v) if np.isfinite(v) else None for v in signal.values[k]]
    return json.dumps(dict(zip(signal.names, values, strict=True))).encode()
