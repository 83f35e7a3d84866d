"""A scenario: what is co-simulated, how, and what differs between its variants, read from a TOML file.

The generic part: components in slots, connections, run settings, variants.  It knows no robot; an assembly that fills
slots and connections by itself (``assembly = "rover"``) is resolved by who runs the scenario, and its own sections are
validated there.  Every mistake is a ScenarioError that names the file and the key.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from .errors import ScenarioError, nearest


class Slot(BaseModel):
    """What stands in a slot: a component of the catalog by ``type`` or anybody's FMU by ``fmu``, and its parameters."""

    model_config = ConfigDict(extra="allow", frozen=True)

    type: str | None = None
    fmu: str | None = None
    every: int = Field(1, ge=1, strict=True)  # steps at every n-th macro step

    def parameters(self) -> dict[str, Any]:
        """Return the values given for the component's own parameters."""
        return dict(self.model_extra or {})


class LinkSpec(BaseModel):
    """A connection with a conversion: ``{source = "a.x", factor = 1e-3}``, or ``convert = true`` by the units."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    source: str
    convert: bool = False
    factor: float | None = None
    offset: float = 0.0


class RunSettings(BaseModel):
    """How the master runs: macro step and duration in s, algorithm, order, which FMI version, what is logged."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    step: float = Field(1e-4, gt=0, strict=False)
    duration: float = Field(..., gt=0)
    algorithm: Literal["gauss-seidel", "jacobi"] = "gauss-seidel"
    order: tuple[str, ...] = ()
    locate_events: bool = True
    tolerance: float = Field(1e-8, gt=0, lt=1e-2)
    fmi: Literal[2, 3] = 3
    signals: tuple[str, ...] = ()  # patterns such as "wheels.*"; none: every port

    @field_validator("step", "duration", "tolerance", mode="before")
    @classmethod
    def _number(cls, value: Any) -> Any:
        if isinstance(value, (bool, str)):
            raise ValueError(f"must be a number, not {value!r}")
        return value


class Scenario(BaseModel):
    """One experiment, with the variants merged in: what `load` returns for a chosen variant."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: str
    title: str
    claim: str
    assembly: str | None = None
    run: RunSettings
    components: dict[str, Slot] = Field(default_factory=dict)
    connections: dict[str, str | LinkSpec] = Field(default_factory=dict)
    variant: str = ""

    def sections(self) -> dict[str, Any]:
        """Return the sections that only the assembly understands."""
        return dict(self.model_extra or {})


def merge(base: Mapping[str, Any], change: Mapping[str, Any]) -> dict[str, Any]:
    """Return *base* with *change* laid over it, table by table; a slot whose ``type`` changes starts afresh."""
    result = dict(base)
    for key, value in change.items():
        old = result.get(key)
        if isinstance(value, Mapping) and isinstance(old, Mapping):
            afresh = any(kind in value and value[kind] != old.get(kind) for kind in ("type", "fmu", "kind", "table"))
            result[key] = dict(value) if afresh else merge(old, value)
        else:
            result[key] = deepcopy(value)
    return result


def parse_override(text: str, slots: Iterable[str]) -> dict[str, Any]:
    """Turn ``wheels.k_w=2e5`` into the nested table it stands for; ``components.`` may be left out before a slot.

    The value is read as TOML (``2e5``, ``[1.0, 2.0]``, ``true``); anything else is a string.
    """
    key, equals, value = text.partition("=")
    path = key.strip().split(".")
    if not equals or not all(path):
        raise ScenarioError(f"cannot read the override {text!r}; write it like wheels.k_w=2e5")
    try:
        read = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        read = value.strip()
    if path[0] in slots:
        path = ["components", *path]
    nested: Any = read
    for part in reversed(path):
        nested = {part: nested}
    return nested


class ScenarioFile:
    """A parsed scenario file: its base table and its variants."""

    def __init__(self, path: Path, *, name: str | None = None) -> None:
        self.path, self.name = path, name or path.stem
        try:
            self.table = tomllib.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise ScenarioError(f"there is no scenario file {path}") from None
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise ScenarioError(f"{path} is not TOML: {error}") from None
        self.variants: dict[str, dict[str, Any]] = self.table.pop("variants", {})
        if not isinstance(self.variants, dict) or not all(isinstance(v, dict) for v in self.variants.values()):
            raise ScenarioError(f"{path}: variants must be tables, [variants.NAME]")

    def load(self, variant: str | None = None, overrides: Iterable[Mapping[str, Any]] = ()) -> Scenario:
        """Return the scenario of one variant (the first, or the base if there are none) with overrides laid over.

        Raises ScenarioError naming file and key for anything missing, misspelt, or of the wrong type.
        """
        if variant is None:
            variant = next(iter(self.variants), "")
        if variant and variant not in self.variants:
            raise ScenarioError(f"{self.path} has no variant {variant!r}; {nearest(variant, self.variants)}")
        table = merge(self.table, self.variants.get(variant, {}))
        for change in overrides:
            table = merge(table, change)
        try:
            return Scenario.model_validate({**table, "name": self.name, "variant": variant})
        except ValidationError as error:
            raise ScenarioError(f"{self.path}: {_first(error, Scenario)}") from None

    def overrides(self, texts: Iterable[str]) -> list[dict[str, Any]]:
        """Read ``--set`` texts for this file."""
        slots = {"controller", "wheels", "body", "chassis", *self.table.get("components", {})}
        return [parse_override(text, slots) for text in texts]


def _first(error: ValidationError, model: type[BaseModel]) -> str:
    """Say the first problem as key and reason, with the nearest key for a misspelt one."""
    problem = error.errors()[0]
    key = ".".join(str(part) for part in problem["loc"] if part != "str")
    if problem["type"] == "extra_forbidden":
        section = model
        for part in problem["loc"][:-1]:
            annotation = section.model_fields[str(part)].annotation if str(part) in section.model_fields else None
            section = annotation if isinstance(annotation, type) and issubclass(annotation, BaseModel) else section
        return f"{key} is not known here; {nearest(str(problem['loc'][-1]), section.model_fields)}"
    if problem["type"] == "missing":
        return f"{key} is missing"
    reason = problem["msg"].removeprefix("Value error, ")
    return f"{key}: {reason[0].lower()}{reason[1:]}, got {problem['input']!r}"


def describe_problem(error: ValidationError, model: type[BaseModel]) -> str:
    """Return one sentence for pydantic's first complaint about *model*."""
    return _first(error, model)
