"""A scenario: what is co-simulated, how, and what differs between its variants, read from a TOML file.

The generic part: components in slots, connections and what stands in them, run settings, variants.  It knows no robot;
an assembly that fills slots and connections by itself (``assembly = "rover"``) is resolved by who runs the scenario,
and its own sections are validated there.  Every mistake is a ScenarioError that names the file and the key.

``through`` puts components with an input ``u`` and an output ``y`` into the connection of a port, one or a list of them
in the order that the signal passes; each is a slot of its own, called ``gap_to_controller``:

    [through.controller.gap]
    type = "Sensor"
    noise = 1e-5
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from types import UnionType
from typing import Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from .errors import ScenarioError, nearest
from .settings import RunSettings


class Slot(BaseModel):
    """What stands in a slot: a component of the catalog by ``type`` or anybody's FMU by ``fmu``, and its parameters."""

    model_config = ConfigDict(extra="allow", frozen=True)

    type: str | None = None
    fmu: str | None = None
    every: int = Field(1, ge=1, strict=True)  # steps at every n-th macro step
    isolated: bool | None = Field(None, strict=True)  # in a process of its own; None: only if the FMU asks for it
    time_limit: float | None = Field(None, gt=0)  # s, for a call into an FMU in a process of its own
    retry: bool = Field(False, strict=True)  # steps that the FMU discards are repeated in shorter ones

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


@dataclass(frozen=True)
class Element:
    """What stands in the connection of the port *target*: the only one (*place* 0), or one of several, from 1."""

    target: str
    slot: Slot
    place: int = 0

    @property
    def name(self) -> str:
        """The name of its slot: ``gap_to_controller`` for ``controller.gap``, with its place if there are several."""
        component, _, port = self.target.partition(".")
        return f"{port}_to_{component}" + (f"_{self.place}" if self.place else "")

    @property
    def where(self) -> str:
        """Its key in the scenario file."""
        return f"through.{self.target}" + (f"[{self.place}]" if self.place else "")


class Scenario(BaseModel):
    """One experiment, with the variants merged in: what `load` returns for a chosen variant."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: str
    title: str
    claim: str
    assembly: str | None = None
    run: RunSettings
    components: dict[str, Slot] = Field(default_factory=dict)
    connections: dict[str, LinkSpec] = Field(default_factory=dict)
    through: dict[str, tuple[Slot, ...]] = Field(default_factory=dict)
    verdict: tuple[str, ...] = ()  # groups of figures beside the usual ones; who judges a run knows them
    view: Literal["impact", "smoothness", "shock", "health"] | None = None  # the question with which a log opens
    variant: str = ""

    @field_validator("connections", mode="before")
    @classmethod
    def _links(cls, value: Any) -> Any:
        if not isinstance(value, Mapping):
            return value
        return {target: {"source": source} if isinstance(source, str) else source for target, source in value.items()}

    @field_validator("through", mode="before")
    @classmethod
    def _chains(cls, value: Any) -> Any:
        if not isinstance(value, Mapping):
            return value
        return {target: chain if isinstance(chain, (list, tuple)) else [chain] for target, chain in value.items()}

    def slot(self, name: str) -> Slot:
        """Return what the scenario says of a slot, also of one in a connection; the default for one that it omits."""
        placed = {element.name: element.slot for element in self.elements()}
        return self.components.get(name) or placed.get(name) or Slot()

    def elements(self) -> list[Element]:
        """Return what stands in connections, in the order of the file, the first that a signal passes first."""
        return [
            Element(target, slot, i if len(chain) > 1 else 0)
            for target, chain in self.through.items()
            for i, slot in enumerate(chain, 1)
        ]

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


def _with_ports(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table whose ports are keys, ``"a.gap"``, also where they were written as a table ``gap`` in a table."""
    found = dict(table)
    for section in ("connections", "through"):
        if not isinstance(found.get(section), Mapping):
            continue
        flat: dict[str, Any] = {}
        for key, value in found[section].items():
            nested = isinstance(value, Mapping) and "." not in key
            flat |= {f"{key}.{port}": inner for port, inner in value.items()} if nested else {key: value}
        found[section] = flat
    return found


def parse_override(text: str, slots: Iterable[str]) -> dict[str, Any]:
    """Turn ``wheels.k_w=2e5`` into the nested table it stands for; ``components.`` may be left out before a slot.

    Key and value are read as TOML (``2e5``, ``[1.0, 2.0]``, ``true``); a value that is none is a string.
    """
    key, equals, value = text.partition("=")
    path = _path(key) if equals else []
    if not path:
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


def _path(key: str) -> list[str]:
    """Return the parts of a dotted TOML key, quotes removed; none if it is not one."""
    try:
        table = tomllib.loads(f"{key} = 0")
    except tomllib.TOMLDecodeError:
        return []
    path = []
    while isinstance(table, dict) and table:
        part, table = next(iter(table.items()))
        path.append(part)
    return path


class ScenarioFile:
    """A parsed scenario file: its base table and its variants."""

    def __init__(self, path: Path, *, name: str | None = None) -> None:
        self.path, self.name = path, name or path.stem
        try:
            self.table = tomllib.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise ScenarioError(f"there is no scenario file {path}") from None
        except OSError as error:
            raise ScenarioError(f"cannot read the scenario file {path}: {error.strerror}") from None
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
        table: dict[str, Any] = {}
        for change in (self.table, self.variants.get(variant, {}), *overrides):
            table = merge(table, _with_ports(change))
        try:
            return Scenario.model_validate({**table, "name": self.name, "variant": variant})
        except ValidationError as error:
            raise ScenarioError(f"{self.path}: {_first(error, Scenario)}") from None

    def overrides(self, changes: Iterable[str | Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Read ``--set`` texts, or tables, for this file; ``components`` may be left out before a slot."""
        slots = {"controller", "wheels", "body", "chassis", *self.table.get("components", {})}
        return [parse_override(c, slots) if isinstance(c, str) else _below_components(c, slots) for c in changes]


def _below_components(change: Mapping[str, Any], slots: Iterable[str]) -> dict[str, Any]:
    """Return a table of changes with the slots where they belong."""
    found = {name: value for name, value in change.items() if name not in slots}
    return merge(found, {"components": {name: value for name, value in change.items() if name in slots}})


def _first(error: ValidationError, model: type[BaseModel]) -> str:
    """Say the first problem as key and reason, with the nearest key for a misspelt one."""
    problem = min(error.errors(), key=lambda p: p["type"] != "extra_forbidden")  # a misspelt key before a missing one
    key = _spelt(problem["loc"])
    if problem["type"] == "extra_forbidden":
        return f"{key} is not known here; {nearest(str(problem['loc'][-1]), _known(model, problem['loc'][:-1]))}"
    if problem["type"] == "missing":
        return f"{key} is missing"
    if problem["type"] in ("model_type", "dict_type"):
        return f"{key} must be a table, not {problem['input']!r}"
    if problem["type"] == "value_error":
        return f"{key} {problem['msg'].removeprefix('Value error, ')}"
    reason = problem["msg"].replace("valid tuple", "list")
    return f"{key}: {reason[0].lower()}{reason[1:]}, got {problem['input']!r}"


def _spelt(loc: tuple[int | str, ...]) -> str:
    """Return a key as a TOML file spells it, places in a list in brackets, from 1."""
    return "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in loc).removeprefix(".")


def _known(model: type[BaseModel], loc: tuple[int | str, ...]) -> list[str]:
    """Return the keys of the section of *model* that *loc* leads to."""
    at: Any = model
    for part in loc:
        if isinstance(at, type) and issubclass(at, BaseModel):
            at = at.model_fields[str(part)].annotation
            at = get_args(at)[0] if isinstance(at, UnionType) else at  # a table that may be left out
        else:  # a table or a list: of which the last type argument says what is in it
            at = next(a for a in reversed(get_args(at)) if a is not Ellipsis)
    return list(at.model_fields)


def describe_problem(error: ValidationError, model: type[BaseModel]) -> str:
    """Return one sentence for pydantic's first complaint about *model*."""
    return _first(error, model)
