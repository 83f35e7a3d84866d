"""What is printed: a row is a line, every table also comes as one JSON document, and the files named are there."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commandline import Command, Said

from studies.catalog import COMPONENTS, find_scenario, scenario_files
from studies.metrics import Metric, table
from studies.present import braced
from studies.verdicts import DECISIVE, number, say_table

SHORT = ("--duration", "0.02")


def ran(said: Said) -> str:
    assert (said.code, said.err) == (0, ""), said
    return said.out


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("runs")


@pytest.fixture
def compared(wmr: Command, folder: Path) -> dict:
    """Return the document of a comparison of two variants over 20 ms."""
    saved = folder / "compare.json"
    if not saved.exists():
        said = wmr(
            "compare", "ramp-impact", "--variants", "uncontrolled,pd-friction", *SHORT, "--out", folder, "--json"
        )
        saved.write_text(ran(said))
    return json.loads(saved.read_text())


def test_list_names_everything(wmr: Command) -> None:
    lines = ran(wmr("list")).splitlines()
    named = {line.split()[0] for line in lines if line.strip()}
    assert set(scenario_files()) | set(COMPONENTS) | {"thesis_6_1", "ramp", "flat"} <= named
    document = json.loads(ran(wmr("list", "--json")))
    assert set(document["scenarios"]) == set(scenario_files())
    assert len(lines) < 2 * sum(len(v) for v in document.values())  # a name is a line


def test_run_prints_the_verdict_it_logs(wmr: Command, tmp_path: Path) -> None:
    out = ran(wmr("run", "ramp-impact", *SHORT, "--out", tmp_path))
    document = json.loads(ran(wmr("run", "ramp-impact", *SHORT, "--out", tmp_path, "--json")))
    assert document["scenario"] == "ramp-impact"
    assert document["error"] is None
    known = {k: m for k, m in document["metrics"].items() if m["value"] is not None}
    peak = known["front_normal_peak"]
    assert peak["unit"] == "N"
    (row,) = (line for line in out.splitlines() if line.strip().startswith("peak normal force, front axle"))
    assert row.split()[-2:] == ["N", number(peak["value"])]
    log = tmp_path / "ramp-impact-uncontrolled.rrd"
    assert document["log"] == str(log)
    assert f"log: {log}" in out.splitlines()
    logged = json.loads(ran(wmr("inspect", log, "--json")))
    assert logged["properties"]["metrics"] == {k: m["value"] for k, m in known.items()} | {
        k: None for k in logged["properties"]["metrics"] if k not in known
    }


def test_run_without_a_log_writes_nothing(wmr: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    out = ran(wmr("run", "ramp-impact", *SHORT, "--no-log"))
    assert "log:" not in out
    assert list(tmp_path.iterdir()) == []


def test_compare_writes_all_it_promises(compared: dict, folder: Path) -> None:
    assert [run["variant"] for run in compared["runs"]] == ["uncontrolled", "pd-friction"]
    for path in (compared["combined"], compared["picture"], *(run["log"] for run in compared["runs"])):
        assert Path(path).parent == folder
        assert Path(path).stat().st_size > 10_000
    assert Path(compared["picture"]).read_bytes().startswith(b"\x89PNG")
    assert {p.name for p in folder.iterdir()} == {
        "compare.json", "ramp-impact.png", "ramp-impact-all.rrd", "ramp-impact-uncontrolled.rrd",
        "ramp-impact-pd-friction.rrd",
    }  # fmt: skip


def test_the_table_of_compare_is_that_of_its_document(wmr: Command, compared: dict, tmp_path: Path) -> None:
    arguments = (
        "compare",
        "ramp-impact",
        "--variants",
        "uncontrolled,pd-friction",
        *SHORT,
        "--out",
        tmp_path,
        "--no-log",
        "--full",
    )
    lines = ran(wmr(*arguments)).splitlines()
    shown = [row for row in compared["rows"] if any(v is not None for v in row["values"].values())]
    assert len(shown) > 20
    for row in shown:
        (line,) = (text for text in lines if text.strip().startswith(row["label"] + "  "))
        for variant, value in row["values"].items():
            marked = number(value) + (" *" if variant in row["best"] else "")
            assert f" {marked} " in line, (line, marked)
    (head,) = (text for text in lines if text.split() == ["unit", "uncontrolled", "pd-friction"])
    assert head
    assert [p.name for p in tmp_path.iterdir()] == ["ramp-impact.png"]


NAMES = ["uncontrolled", "pd", "pd-planned", "pole-placement", "pole-placement-observer", "lqr", "playback"]


@pytest.mark.parametrize(("columns", "names"), [(100, NAMES), (100, NAMES[:3]), (140, NAMES), (60, NAMES[:2])])
def test_many_variants_fit_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], columns: int, names: list[str]
) -> None:
    """No line is longer than the terminal, no number or name is cut, and each variant has its column."""
    monkeypatch.setenv("COLUMNS", str(columns))
    label = "RMS normal jerk on the obstacle, inertial, forces changing"
    rows = table({n: [Metric("k", label, "m/s3", "lower", 123456.0 + i)] for i, n in enumerate(names)})
    say_table(rows, names)
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= columns
    assert "…" not in out
    for i in range(len(names)):
        assert f" {123456 + i} " in out
    assert f"{123456} *" in out  # the lowest
    for word in {part for name in names for part in name.split("-")}:
        assert word in out


def test_where_there_is_no_terminal_a_row_is_a_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    label = "payload lift-off margin (specific force / g, below 0 it lifts)"
    say_table(table({n: [Metric("k", label, "1", "", float(i))] for i, n in enumerate(NAMES)}), NAMES)
    head, row = capsys.readouterr().out.splitlines()
    assert head.split() == ["unit", *NAMES]
    assert row.strip().startswith(label)
    assert row.split()[-7:] == [str(i) for i in range(7)]


def test_numbers_at_a_glance() -> None:
    texts = {1234.56: "1235", 774.6: "774.6", 0.0123456: "0.0123", -1.81e-16: "0", 2.5e7: "2.5e+07", None: "-"}
    assert {value: number(value) for value in texts} == texts


def test_inspect_of_a_run(wmr: Command, compared: dict, tmp_path: Path) -> None:
    log = compared["runs"][0]["log"]
    out = ran(wmr("inspect", log))
    lines = out.splitlines()
    assert lines[0] == f"{log}: complete"
    assert any(line.split()[:1] == ["token_body"] for line in lines)
    (row,) = (line for line in lines if line.split()[:1] == ["wheels.normal_force"])
    assert row.split()[1:3] == ["N", "4"]
    assert "body: event at " in out
    verdict = ran(wmr("inspect", log, "--metrics"))
    assert "wheels.normal_force" not in verdict
    assert any(line.split() == ["front_normal_peak", number(_peak(compared)), "N"] for line in verdict.splitlines())
    csv = tmp_path / "x.csv"
    few = ran(wmr("inspect", log, "--signals", "wheels.normal_force,body.pitch", "--csv", csv))
    assert f"wrote {csv}" in few.splitlines()
    assert "wheels.traction" not in few
    assert csv.read_text().splitlines()[0].count(",") == 5


def test_what_decides_is_on_one_screen(wmr: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Nine variants on a terminal of 100 columns: the rows that decide, the words and the files within 50 lines."""
    names = list(find_scenario("ramp-impact-realistic").variants)
    assert len(names) == 9
    monkeypatch.setenv("COLUMNS", "100")
    document = json.loads(ran(wmr("compare", "ramp-impact-realistic", *SHORT, "--out", tmp_path, "--json")))
    arguments = ("compare", "--logs", *(run["log"] for run in document["runs"]), "--out", tmp_path)
    text = ran(wmr(*arguments))
    folded = sum(max(1, -(-len(line) // 100)) for line in text.splitlines())
    assert folded <= 50
    peaks = next(row for row in document["rows"] if row["key"] == "front_normal_peak")["values"]
    for name in names:
        (row,) = (line.split() for line in text.splitlines() if line.split()[:1] == [name] and "the" not in line)
        assert number(peaks[name]) in row
        assert sum(line.startswith(f"{name} ") for line in text.splitlines()) == 1  # its sentence
    heads = " ".join(DECISIVE.values()).replace(",", "").split()
    assert {"peak", "force", "ground", "rebounds"} <= set(heads) & set(text.replace(",", "").split())


def test_paths_as_a_shell_takes_them() -> None:
    runs = [Path(f"/r/ramp-{name}.rrd") for name in ("pd", "pole-placement", "pole")]
    assert braced(runs) == "/r/ramp-{pd,pole-placement,pole}.rrd"
    assert braced(runs[:1]) == "/r/ramp-pd.rrd"
    assert braced(runs[1:]) == "/r/ramp-{pole-placement,pole}.rrd"
    assert braced([Path("a.rrd"), Path("b c.rrd")]) == "a.rrd b c.rrd"
    assert braced([Path("a.rrd"), Path("b.rrd")]) == "{a,b}.rrd"


def _peak(compared: dict) -> float:
    return compared["runs"][0]["metrics"]["front_normal_peak"]["value"]


def test_inspect_of_a_comparison(wmr: Command, compared: dict) -> None:
    out = ran(wmr("inspect", compared["combined"], "--signals", "overlay.*"))
    assert out.splitlines()[0].endswith("ramp-impact-all.rrd: comparison")
    key = "front_normal_peak"
    values = [number(run["metrics"][key]["value"]) for run in compared["runs"]]
    (row,) = (line for line in out.splitlines() if line.split()[:1] == [key])
    assert row.split() == [key, "N", *values]
    assert "overlay.front_normal_force.pd-friction" in out


def test_json_is_one_document_even_if_numbers_are_not_finite(capsys: pytest.CaptureFixture[str]) -> None:
    import numpy as np

    from studies.terminal import print_json

    print_json({"a": float("nan"), "b": [np.float64("inf"), np.int64(3)], "c": np.arange(2), "d": Path("/x")})
    assert json.loads(capsys.readouterr().out) == {"a": None, "b": [None, 3], "c": [0, 1], "d": "/x"}
