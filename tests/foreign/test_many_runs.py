"""Many runs in one process: reused instances give the same bits, only where reset is sound, and nothing piles up."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from odd import ODDITIES, odd, state_flag
from toys import Mass, Spring

import fmus
import studies
from cosim import GaussSeidel, Record, System, run
from fmus.pool import Loaded, Pool

ROOT = Path(__file__).parents[2]
BENCHMARK = ROOT / "benchmarks" / "many_runs.py"


def oscillator(pool: Pool | None, fmi: int, k: float) -> tuple[bytes, list[Loaded]]:
    make = pool or fmus
    instances = {
        "spring": make.instantiate(Spring(k=k), "spring", fmi=fmi),
        "mass": make.instantiate(Mass(), "mass", fmi=fmi),
    }
    wires = {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"}
    record = Record()
    run(System(instances, wires), GaussSeidel(), step=1e-2, stop=0.2, observers=[record])
    if pool is not None:
        pool.release(instances.values())
    else:
        for instance in instances.values():
            instance.close()
    return b"".join(record[port].tobytes() for port in record.ports()), list(instances.values())


def test_reused_instances_give_the_bits_of_new_ones(fmi: int) -> None:
    """Parameters differ from run to run: what one run set is gone in the next."""
    with Pool(step=1e-2) as pool:
        used = set()
        for k in (4.0, 7.5, 1.0, 4.0):
            bits, instances = oscillator(pool, fmi, k)
            assert bits == oscillator(None, fmi, k)[0]
            used |= {id(i) for i in instances}
        assert len(used) == 2  # the same two all the time


def test_the_default_is_back_after_a_run(fmi: int) -> None:
    with Pool() as pool:
        path = fmus.build(Spring(), fmi=fmi)
        first = pool.load(path, "one")
        first.set("k", 9.0)
        first.enter_initialization()
        first.exit_initialization()
        pool.release([first])
        again = pool.load(path, "two")
        assert again is first
        assert again.name == "two"
        again.enter_initialization()
        assert again.get("k") == Spring().values["k"]


@pytest.mark.parametrize("isolated", [False, True])
def test_a_reset_that_is_not_sound_is_not_used(isolated: bool, fmi: int, tmp_path: Path) -> None:
    """The FMU keeps its state over a reset: every run gets a new instance, and so the right numbers."""
    path = odd(tmp_path, fmi, f'{state_flag(fmi)} needsExecutionTool="{str(isolated).lower()}"')
    ends, used = [], []
    with Pool(step=0.1) as pool:
        for _ in range(3):
            instance = pool.load(path, "odd")
            instance.set("oddity", ODDITIES.index("keep on reset"))
            system = System({"odd": instance}, {})
            record = Record()
            run(system, GaussSeidel(), step=0.1, stop=1.0, observers=[record])
            ends.append(record["odd.y"][-1])
            used.append(instance)
            pool.release([instance])
    assert np.allclose(ends, 1.0)
    assert len(set(map(id, used))) == 3
    assert not any(i.alive for i in used)


def test_scenarios_share_a_pool() -> None:
    """Other parameters and start values in every run, and one run that fails: each is what it is alone."""
    made: list[Loaded] = []

    class Counting(Pool):
        def load(self, *args: Any, **how: Any) -> Loaded:
            made.append(super().load(*args, **how))
            return made[-1]

    changes: list[dict[str, Any]] = [
        {"wheels": {"mu": 0.3}},
        {"wheels": {"k_w": 1e5, "c_w": 100.0}, "start": {"speed": 1.0}},
        {"wheels": {"k_w": 1e200}},
        {},
    ]
    with Counting(step=1e-4) as pool:
        for change in changes:
            shared, alone = (
                studies.run("ramp-impact", "pd", run={"duration": 0.01}, pool=p, **change) for p in (pool, None)
            )
            assert str(shared.error) == str(alone.error)
            assert (shared.error is not None) == (change == {"wheels": {"k_w": 1e200}})
            for port in alone.record.ports():
                assert shared.record[port].tobytes() == alone.record[port].tobytes(), port
    assert len(made) == 4 * 4
    assert len(set(map(id, made))) == 2 * 4  # those of the run that failed are not used again
    assert not any(instance.alive for instance in made)


def test_after_a_failure_all_are_new(fmi: int, odd_fmus: dict[int, Path]) -> None:
    with Pool() as pool:
        first = pool.load(odd_fmus[fmi])
        pool.release([first], failed=True)
        assert not first.alive
        assert pool.load(odd_fmus[fmi]) is not first


def test_a_changed_file_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "changing.fmu"
    with Pool() as pool:
        for component, name in ((Mass(), "pos"), (Spring(), "F")):
            path.write_bytes(fmus.build(component).read_bytes())
            instance = pool.load(path)
            assert name in instance.y_at
            pool.release([instance])


# In a process of its own: thread keys are for all in it.
KEYS = """
import sys
import fmus
how, path, n, pool = sys.argv[1], sys.argv[2], int(sys.argv[3]), fmus.Pool(step=0.1)
for i in range(n):
    instance = pool.load(path, "odd") if how == "pool" else fmus.load(path, "odd")
    instance.set("oddity", 16)
    instance.enter_initialization()
    instance.exit_initialization()
    pool.release([instance])
print("made all")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the number of thread keys is that of Linux")
def test_an_fmu_that_leaks_a_thread_key_each_time_it_is_loaded(odd_fmus: dict[int, Path]) -> None:
    """Such FMUs end after some thousand loads, since a process has 1024 keys; an instance that is reset goes on."""
    assert ODDITIES[16] == "thread key"

    def made(how: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", KEYS, how, str(odd_fmus[2]), "1100"]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)

    alone = made("load")
    assert "there is no key for the data of this thread" in alone.stderr
    assert "made all" in made("pool").stdout


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="needs /proc to see what a process holds")
@pytest.mark.parametrize("way", ["reset", "new"])
def test_nothing_piles_up(way: str) -> None:
    """What the benchmark shows for 10 000 runs, for 300: handles, files and libraries as many as before.

    Memory: no more than a tenth of what the smallest thing that could be left of a run, its 2 x 21 rows of
    8 numbers, would take in Python (300 x 2.7 kB = 0.8 MB); what libc's allocator rounds up is below that.
    """
    command = [sys.executable, str(BENCHMARK), "--runs", "300", "--way", way, "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    before, after = json.loads(done.stdout)["before"], json.loads(done.stdout)["after"]
    for what in ("handles", "temporary files", "cached files", "libraries", "processes"):
        assert after[what] == before[what], what
    assert after["memory_kB"] - before["memory_kB"] < 800
