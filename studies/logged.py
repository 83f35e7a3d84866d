"""The log of a run: the recorder with scene, blueprint, properties and verdict.  Apart, since Rerun takes a while."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Any

from cosim.instance import Instance
from cosim.record import Record
from logs.blueprint import run_blueprint
from logs.ports import chosen
from logs.recorder import RerunRecorder

from . import inputs
from .assembly import Assembly
from .drawn import drawn, gap_mismatch
from .metrics import as_mapping, markdown, table
from .origin import origin
from .runner import judge, provenance


def log_observer(
    assembly: Assembly,
    path: Path,
    instances: dict[str, Instance],
    record: Record,
    recorder: Callable[..., RerunRecorder] = RerunRecorder,
) -> RerunRecorder:
    """Return the *recorder* that logs a run of *assembly* to *path*, with scene, blueprint, properties and verdict."""
    scenario = assembly.scenario
    config = json.dumps(scenario.model_dump(mode="json"), sort_keys=True)
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%S.%f")[:-3]
    label = f"{scenario.name} {scenario.variant}".strip()

    def closing() -> tuple[dict[str, dict[str, Any]], str]:
        rows = judge(assembly, record)
        report = markdown(scenario, table({scenario.variant or "value": rows})) if rows else ""
        units = {"metric": [m.key for m in rows], "unit": [m.unit for m in rows]}
        return {"metrics": as_mapping(rows), "metric_units": units}, report

    drawings, look = drawn(assembly, instances, record)
    properties: dict[str, dict[str, Any]] = {
        "look": look.table(),
        "run": {
            "scenario": scenario.name, "variant": scenario.variant, "title": scenario.title, "claim": scenario.claim,
            "step_s": scenario.run.step, "duration_s": scenario.run.duration, "algorithm": scenario.run.algorithm,
            "config_json": config, "config_hash": sha256(config.encode()).hexdigest()[:16],
            "command": " ".join(["wmr-cosim", *sys.argv[1:]]), "started_utc": stamp,
        },
        "provenance": {**provenance(instances), "sources": inputs.sources()},
        "files": inputs.files(scenario), **origin(scenario, instances),
    }  # fmt: skip
    return recorder(
        path,
        f"{stamp}-{scenario.name}-{scenario.variant or 'run'}-{properties['run']['config_hash'][:8]}",
        name=label,
        properties=properties,
        blueprint=run_blueprint(chosen(instances, scenario.run.signals), look),
        scene=drawings,
        health=gap_mismatch(instances),
        closing=closing,
        signals=scenario.run.signals,
    )
