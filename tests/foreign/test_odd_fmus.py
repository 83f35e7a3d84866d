"""How a run ends with an FMU that fails, hangs, crashes, discards, ...: as specified, with what was computed kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from odd import ODDITIES, odd
from toys import Mass

import fmus
from cosim import (
    Algorithm,
    CosimError,
    ExportError,
    GaussSeidel,
    Jacobi,
    Link,
    Observer,
    Record,
    StepError,
    Summary,
    System,
    run,
)
from logs.read import properties, signals
from logs.recorder import RerunRecorder

STEP, STOP = 0.1, 1.0
PROCESS = dict(isolated=True, time_limit=1.0)
NO_HARM = "only its own process is gone: look at the inputs it was given last, or ask who made odd"

# oddity: how it is loaded, the time of the last point, what is said (None: the run is complete)
ENDS = [
    ("none", {}, 1.0, None),
    ("none", PROCESS, 1.0, None),
    ("fail", {}, 0.5, "odd failed at t = 0.5 s: the valve is stuck (fmi{fmi}DoStep returned error, step 6)"),
    ("fail", PROCESS, 0.5, "odd failed at t = 0.5 s: the valve is stuck (fmi{fmi}DoStep returned error, step 6)"),
    ("fatal", {}, 0.5, "odd failed at t = 0.5 s: the heap is broken"),
    ("fatal", PROCESS, 0.5, "odd failed at t = 0.5 s: the heap is broken"),
    (
        "hang", PROCESS, 0.5,
        "odd failed at t = 0.5 s: fmi{fmi}DoStep did not return within the time limit of 1 s and was ended; if it only "
        "needs longer, raise time_limit, else look at the inputs it was given last",
    ),
    (
        "talk", dict(isolated=True, time_limit=0.3), 0.5,
        "odd failed at t = 0.5 s: fmi{fmi}DoStep did not return within the time limit of 0.3 s and was ended; before, "
        "it said: one moment, please; if it only needs longer",
    ),
    (
        "crash", PROCESS, 0.5,
        "odd failed at t = 0.5 s: it crashed in fmi{fmi}DoStep: SIGSEGV (segmentation fault); before, it said: about "
        f"to write where nothing is; {NO_HARM}",
    ),
    (
        "abort", PROCESS, 0.5,
        "odd failed at t = 0.5 s: it crashed in fmi{fmi}DoStep: SIGABRT (aborted); before, it said: odd.c: assertion "
        f"x > 0 failed; {NO_HARM}",
    ),
    (
        "exit", PROCESS, 0.5,
        f"odd failed at t = 0.5 s: it ended its own process in fmi{{fmi}}DoStep with exit code 3; {NO_HARM}",
    ),
    ("crash in get", PROCESS, 0.5, "odd failed at t = 0.5 s: it crashed in fmi{fmi}Get{real}: SIGSEGV"),
    ("end", {}, 0.5, None),
    ("end", PROCESS, 0.5, None),
    (
        "discard all", {}, 0.5,
        "odd failed at t = 0.5 s: it said nothing; with retry such steps are repeated in shorter ones, as it can be "
        "taken back; else use a shorter macro step (fmi{fmi}DoStep returned discard, step 6)",
    ),
    (
        "discard all", dict(retry=True), 0.5,
        "odd failed at t = 0.5 s: it said nothing; it does so however short the step is (fmi{fmi}DoStep returned "
        "discard, step 6)",
    ),
    ("nan", {}, 0.5, "mass failed at t = 0.5 s: input F is nan at t = 0.5 s"),
    ("nan", PROCESS, 0.5, "mass failed at t = 0.5 s: input F is nan at t = 0.5 s"),
    ("chatty", {}, 1.0, None),
    ("chatty", PROCESS, 1.0, None),
]  # fmt: skip


def coupled(path: Path, oddity: str, how: dict[str, object]) -> System:
    """Return a mass that an odd FMU pushes: x' = 1, m v' = x."""
    odd = fmus.load(path, "odd", **how)
    odd.set("oddity", ODDITIES.index(oddity))
    return System({"odd": odd, "mass": fmus.instantiate(Mass(), "mass")}, {"mass.F": Link("odd.y", factor=1.0)})


def ending(system: System, *observers: Observer) -> tuple[Summary | None, str]:
    """Run to the end, or to what breaks it off, and say which; close the system."""
    try:
        return run(system, GaussSeidel(), step=STEP, stop=STOP, observers=observers), ""
    except CosimError as error:
        return None, str(error)
    finally:
        system.close()


@pytest.mark.parametrize(
    ("oddity", "how", "last", "said"), ENDS, ids=[f"{o}{''.join(f'-{k}' for k in h)}" for o, h, _, _ in ENDS]
)
def test_a_run_ends_as_specified(
    oddity: str, how: dict[str, object], last: float, said: str | None,
    fmi: int, odd_fmus: dict[int, Path], tmp_path: Path,
) -> None:  # fmt: skip
    """Nothing is lost, neither in the record nor in the log, which says how the run ended."""
    record, log = Record(), tmp_path / "odd.rrd"
    summary, error = ending(coupled(odd_fmus[fmi], oddity, how), record, RerunRecorder(log, "odd"))
    assert record.time[-1] == pytest.approx(last, abs=1e-12)
    # whatever happened then: y = t, in tenths that the FMU adds up itself
    before = record.time <= 0.5 + 1e-12
    assert np.allclose(record["odd.y"][before], record.time[before], atol=1e-15)
    outcome = properties(log)["outcome"]
    if said is None:
        assert summary is not None, error
        assert summary.terminated_by == ("odd" if oddity == "end" else "")
        assert outcome["status"] == "complete"
    else:
        assert said.format(fmi=fmi, real={2: "Real", 3: "Float64"}[fmi]) in error
        assert (outcome["status"], outcome["error"]) == ("failed", error)
    logged = signals(log)
    for port in record.ports():
        name = port if port in logged else port.replace(".", ".in.")
        np.testing.assert_array_equal(logged[name].ns, record.time_ns)
        assert logged[name].values.tobytes() == record[port].tobytes(), port


@pytest.mark.parametrize("how", [{}, PROCESS], ids=["here", "isolated"])
def test_a_stiff_one_whose_solver_blows_up(how: dict[str, object], fmi: int, odd_fmus: dict[int, Path]) -> None:
    """Explicit Euler at 1e79 times its limit: x = 1 - (-1e79)^n passes the largest double, 1.8e308, in step 4."""
    record = Record()
    summary, error = ending(coupled(odd_fmus[fmi], "stiff", how), record)
    assert summary is None
    assert error.startswith("mass failed at t = 0.3 s: input F is -inf")
    np.testing.assert_allclose(record["odd.y"], [0, 1e79, -1e158, 1e237], rtol=1e-15)


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("algorithm", [Jacobi(), GaussSeidel()])
def test_what_is_no_number_does_not_travel(
    algorithm: Algorithm, compiled: bool, fmi: int, odd_fmus: dict[int, Path]
) -> None:
    """Between two FMUs that do not look at what they are given; the time is that of the first bad point."""
    first, second = (fmus.load(odd_fmus[fmi], name) for name in ("first", "second"))
    first.set("oddity", ODDITIES.index("nan"))
    record = Record()
    with (
        System({"first": first, "second": second}, {"second.u": "first.y"}) as system,
        pytest.raises(StepError, match=r"^first failed at t = 0.6 s: its output y is nan, which second.u is to take"),
    ):
        run(system, algorithm, step=STEP, stop=STOP, observers=[record], compiled=compiled)
    np.testing.assert_allclose(record.time, np.arange(6) / 10, atol=1e-15)
    assert np.isfinite(record["second.u"]).all()


def test_what_nobody_takes_may_be_no_number(fmi: int, odd_fmus: dict[int, Path]) -> None:
    odd, record = fmus.load(odd_fmus[fmi], "odd"), Record()
    odd.set("oddity", ODDITIES.index("nan"))
    assert ending(System({"odd": odd}, {}), record)[1] == ""
    assert np.isnan(record["odd.y"]).tolist() == [False] * 6 + [True] * 5


def test_a_discarded_step_is_repeated_in_shorter_ones(fmi: int, odd_fmus: dict[int, Path]) -> None:
    """The FMU makes at most 0.04 s: it says so by discarding steps, whose states it leaves broken."""
    record = Record()
    system = coupled(odd_fmus[fmi], "discard", dict(retry=True))
    system.instances["odd"].set("longest", 0.04)
    summary, error = ending(system, record)
    assert summary is not None, error
    assert summary.rejected == 2 * round(STOP / STEP)
    assert summary.events == 0  # nothing has happened where the step was cut
    assert record.events == []
    assert np.diff(record.time).max() <= 0.04 + 1e-9
    # every macro step of 0.1 s is made in 0.04 + 0.04 + 0.02 s, and all points of the grid are there
    assert len(record.time) == 1 + 3 * round(STOP / STEP)
    assert np.allclose(record["odd.y"], record.time, atol=1e-14)
    # m v' = y, y held over each step at its end: v = sum of h t
    assert record["mass.vel"][-1] == pytest.approx(np.sum(np.diff(record.time) * record.time[1:]), abs=1e-14)


def test_steps_that_are_discarded_again_and_again(fmi: int, odd_fmus: dict[int, Path]) -> None:
    """Of a macro step of 0.1 s, steps of 50 us would make 2000: that is no way to run."""
    system = coupled(odd_fmus[fmi], "discard", dict(retry=True))
    system.instances["odd"].set("longest", 5e-5)
    summary, error = ending(system, record := Record())
    assert summary is None
    assert error.startswith(
        "odd discarded 1001 steps in one macro step, the last from 0.050000000 s to 0.100000000 s; choose a macro step "
        "that it takes"
    )
    assert record.time[-1] == 0.05


def test_without_going_back_nothing_is_repeated(fmi: int, odd_fmus: dict[int, Path]) -> None:
    system = coupled(odd_fmus[fmi], "discard all", dict(retry=True))
    with system, pytest.raises(StepError, match=r"to repeat it in shorter ones takes a run that locates events: loc"):
        run(system, GaussSeidel(), step=STEP, stop=STOP, locate_events=False)


def test_a_discarded_step_in_its_own_process(fmi: int, odd_fmus: dict[int, Path]) -> None:
    points = []
    for how in (dict(retry=True), dict(retry=True, isolated=True)):
        record = Record()
        system = coupled(odd_fmus[fmi], "discard", how)
        system.instances["odd"].set("longest", 0.04)
        ending(system, record)
        points.append((record.time, record["odd.y"], record["mass.vel"]))
    assert all(np.array_equal(a, b) for a, b in zip(*points, strict=True))


def test_what_cannot_be_taken_back_is_not_repeated(fmi: int, tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="cannot be taken back, so steps that it discards cannot be repeated"):
        fmus.load(odd(tmp_path, fmi), retry=True)


def test_messages_are_kept_but_not_all(fmi: int, odd_fmus: dict[int, Path]) -> None:
    """The FMU sends 10 000 warnings in a run: the last hundred stay, in this process or another."""
    for how in ({}, PROCESS):
        system = coupled(odd_fmus[fmi], "chatty", how)
        summary, _ = ending(system, Record())
        assert summary is not None
        assert system.instances["odd"].warnings == ["here I am"] * 100


def test_a_crash_at_the_start_leaves_the_others_alone(fmi: int, odd_fmus: dict[int, Path]) -> None:
    record = Record()
    summary, error = ending(coupled(odd_fmus[fmi], "crash at the start", PROCESS), record)
    assert summary is None
    assert error.startswith(
        f"odd failed at t = 0 s: it crashed in fmi{fmi}EnterInitializationMode: SIGABRT (aborted); "
    )
    assert len(record) == 0


def test_a_hang_at_the_end_does_not_lose_the_run(fmi: int, odd_fmus: dict[int, Path]) -> None:
    """The run is complete when the FMU hangs in its farewell: that is a warning."""
    record = Record()
    with pytest.warns(RuntimeWarning, match=f"while it was closed, odd failed at t = 1 s: fmi{fmi}Terminate did not"):
        summary, error = ending(coupled(odd_fmus[fmi], "hang at the end", dict(time_limit=0.3)), record)
    assert summary is not None, error
    assert record.time[-1] == STOP
