"""Scenario files: what a file says, what variants and overrides change, and the sentence for every mistake."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cosim import ScenarioError
from cosim.scenario import Scenario, ScenarioFile, merge, parse_override

BASE = """
title = "A gain"
claim = "It gains."

[run]
duration = 1.0

[components.a]
type = "Gain"
k = 2.0

[components.b]
type = "Gain"

[connections]
"a.u" = "b.y"
"""
Write = Callable[[str], ScenarioFile]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Return a function that makes a scenario file of a text."""

    def file(text: str) -> ScenarioFile:
        path = tmp_path / "gain.toml"
        path.write_text(text)
        return ScenarioFile(path)

    return file


def test_a_file_is_read_with_its_defaults(write: Write) -> None:
    scenario = write(BASE).load()
    assert (scenario.name, scenario.title, scenario.variant) == ("gain", "A gain", "")
    assert (scenario.run.step, scenario.run.algorithm, scenario.run.order, scenario.run.fmi) == (
        1e-4, "gauss-seidel", (), 3,
    )  # fmt: skip
    assert scenario.components["a"].parameters() == {"k": 2.0}
    assert scenario.connections["a.u"].source == "b.y"
    assert scenario.elements() == []


def test_the_first_variant_is_the_default_and_lies_over_the_base(write: Write) -> None:
    file = write(BASE + "[variants.stiff]\ncomponents.a.k = 9.0\n[variants.soft]\nrun.step = 0.5\n")
    assert list(file.variants) == ["stiff", "soft"]
    assert file.load().components["a"].parameters() == {"k": 9.0}
    soft = file.load("soft")
    assert (soft.variant, soft.run.step, soft.components["a"].parameters()) == ("soft", 0.5, {"k": 2.0})


def test_a_slot_of_another_type_starts_afresh(write: Write) -> None:
    file = write(BASE + '[variants.other]\ncomponents.a = { type = "Spring" }\n[variants.same]\ncomponents.a.d = 1.0\n')
    assert file.load("other").components["a"].parameters() == {}
    assert file.load("same").components["a"].parameters() == {"k": 2.0, "d": 1.0}


def test_merging_leaves_both_tables_as_they_were() -> None:
    base, change = {"a": {"x": 1}}, {"a": {"y": [1]}}
    merged = merge(base, change)
    merged["a"]["y"].append(2)
    assert (base, change) == ({"a": {"x": 1}}, {"a": {"y": [1]}})


@pytest.mark.parametrize(
    ("text", "nested"),
    [
        ("a.k=2e5", {"components": {"a": {"k": 2e5}}}),
        ("a.k = [1.0, 2.0]", {"components": {"a": {"k": [1.0, 2.0]}}}),
        ("components.a.k=true", {"components": {"a": {"k": True}}}),
        ("run.algorithm=jacobi", {"run": {"algorithm": "jacobi"}}),
        ("title=a = b", {"title": "a = b"}),
        ('through."a.u".noise=0', {"through": {"a.u": {"noise": 0}}}),
        ("through.a.u.noise=0", {"through": {"a": {"u": {"noise": 0}}}}),
    ],
)
def test_overrides(text: str, nested: dict[str, Any]) -> None:
    assert parse_override(text, ["a"]) == nested


@pytest.mark.parametrize("text", ["a.k", "=3", "a..k=3", ".k=3", "a b=3"])
def test_what_is_no_override(text: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        parse_override(text, ["a"])
    assert str(caught.value) == f"cannot read the override {text!r}; write it like wheels.k_w=2e5"


SENSOR = '[through.a.u]\ntype = "Sensor"\nnoise = 0.1\n'


def test_what_stands_in_a_connection_is_named_after_it(write: Write) -> None:
    (element,) = write(BASE + SENSOR).load().elements()
    assert (element.target, element.name, element.where) == ("a.u", "u_to_a", "through.a.u")
    assert (element.slot.type, element.slot.parameters()) == ("Sensor", {"noise": 0.1})


def test_several_have_numbers(write: Write) -> None:
    text = BASE + '[[through."a.u"]]\ntype = "Sensor"\n[[through."a.u"]]\ntype = "Actuator"\nlag = 0.1\n'
    assert [(e.name, e.slot.type, e.where) for e in write(text).load().elements()] == [
        ("u_to_a_1", "Sensor", "through.a.u[1]"), ("u_to_a_2", "Actuator", "through.a.u[2]"),
    ]  # fmt: skip


@pytest.mark.parametrize("port", ['"a.u"', "a.u"])
def test_a_port_means_the_same_with_and_without_quotes(write: Write, port: str) -> None:
    """In the base, in a variant, in an override and among the connections."""
    file = write(BASE + SENSOR + f"[variants.quiet]\nthrough.{port}.noise = 0.0\n")
    assert file.load().elements()[0].slot.parameters() == {"noise": 0.0}
    override = file.overrides([f"through.{port}.seed=5", f"connections.{port}.factor=2.0"])
    scenario = file.load("quiet", [{"connections": {"a.u": {"source": "b.y"}}}, *override])
    assert scenario.elements()[0].slot.parameters() == {"noise": 0.0, "seed": 5}
    assert (scenario.connections["a.u"].source, scenario.connections["a.u"].factor) == ("b.y", 2.0)


def test_a_variant_can_take_an_element_out(write: Write) -> None:
    file = write(BASE + SENSOR + "[variants.with]\n[variants.without]\nthrough.a.u = []\n")
    assert [len(file.load(v).elements()) for v in file.variants] == [1, 0]


def test_a_scenario_says_everything_about_itself_as_json(write: Write) -> None:
    """It is written into the log, and read from there it is the same scenario."""
    scenario = write(BASE + SENSOR).load()
    again = Scenario.model_validate_json(scenario.model_dump_json())
    assert again == scenario
    assert again.elements() == scenario.elements()


MISTAKES = [
    ("duration = 1.0", "durtion = 1.0", "run.durtion is not known here; did you mean 'duration'?"),
    ("duration = 1.0", "step = 1e-3", "run.duration is missing"),
    ("duration = 1.0", "duration = '1'", "run.duration must be a number, not '1'"),
    ("duration = 1.0", "duration = true", "run.duration must be a number, not True"),
    ("duration = 1.0", "duration = -1", "run.duration: input should be greater than 0, got -1"),
    ("duration = 1.0", "duration = 1.0\nalgorithm = 'gauss'",
     "run.algorithm: input should be 'gauss-seidel', 'jacobi' or 'iterated', got 'gauss'"),
    ("duration = 1.0", "duration = 1.0\nfmi = 4", "run.fmi: input should be 2 or 3, got 4"),
    ("duration = 1.0", "duration = 1.0\norder = 'a'",
     'run.order must be a list of components or "computed", not \'a\''),
    ("duration = 1.0", "duration = 1.0\ncontrol = 3", "run.control must be a table, not 3"),
    ("duration = 1.0", "duration = 1.0\ncontrol = { tolrance_rel = 1e-3 }",
     "run.control.tolrance_rel is not known here; did you mean 'tolerance_rel'?"),
    ("duration = 1.0", "duration = 1.0\ncontrol = { max_step = true }",
     "run.control.max_step must be a number, not True"),
    ("duration = 1.0", "duration = 1.0\niterated = { method = 'secant' }",
     "run.iterated.method: input should be 'fixed_point', 'aitken', 'quasi_newton' or 'newton', got 'secant'"),
    ("duration = 1.0", "duration = 1.0\nbonds = [{ effort = 'a.u' }]", "run.bonds[1].flow is missing"),
    ("duration = 1.0", "duration = 1.0\nbonds = [{ efort = 'a.u' }]",
     "run.bonds[1].efort is not known here; did you mean 'effort'?"),
    ("duration = 1.0", "duration = 1.0\nextrapolate = 3",
     "run.extrapolate: input should be less than or equal to 2, got 3"),
    ('title = "A gain"', "", "title is missing"),
    ('title = "A gain"', "title = 3", "title: input should be a valid string, got 3"),
    ('type = "Gain"\nk', "type = 3\nk", "components.a.type: input should be a valid string, got 3"),
    ('type = "Gain"\nk', "every = 0\nk", "components.a.every: input should be greater than or equal to 1, got 0"),
    ('"a.u" = "b.y"', '"a.u" = 3', "connections.a.u must be a table, not 3"),
    ('"a.u" = "b.y"', '"a.u" = { sorce = "b.y" }', "connections.a.u.sorce is not known here; did you mean 'source'?"),
    ('"a.u" = "b.y"', '"a.u" = { factor = 2.0 }', "connections.a.u.source is missing"),
    ('"a.u" = "b.y"', "[through]\n'a.u' = 3", "through.a.u[1] must be a table, not 3"),
    ('"a.u" = "b.y"', "[through]\n'a.u' = [{}, { every = 1.5 }]",
     "through.a.u[2].every: input should be a valid integer, got 1.5"),
]  # fmt: skip


@pytest.mark.parametrize(("right", "wrong", "sentence"), MISTAKES, ids=[m[2][:40] for m in MISTAKES])
def test_mistakes_name_the_file_and_the_key(write: Write, right: str, wrong: str, sentence: str) -> None:
    assert BASE.count(right) == 1
    file = write(BASE.replace(right, wrong))
    with pytest.raises(ScenarioError) as caught:
        file.load()
    assert str(caught.value) == f"{file.path}: {sentence}"


def test_what_is_no_scenario_file(write: Write, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError) as caught:
        ScenarioFile(tmp_path / "other.toml")
    assert str(caught.value) == f"there is no scenario file {tmp_path / 'other.toml'}"
    with pytest.raises(ScenarioError, match=r"gain.toml is not TOML: Invalid value"):
        write("title =")
    with pytest.raises(ScenarioError, match=r"gain.toml: variants must be tables, \[variants.NAME\]"):
        write(BASE + "[variants]\nfirst = 3\n")


def test_a_variant_that_does_not_exist(write: Write) -> None:
    file = write(BASE + "[variants.stiff]\n")
    with pytest.raises(ScenarioError) as caught:
        file.load("stif")
    assert str(caught.value) == f"{file.path} has no variant 'stif'; did you mean 'stiff'?"
