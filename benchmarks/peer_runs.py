"""Run three FMUs (FMI 2.0, input u, output y) in a ring with another tool; executed in the tool's own environment.

    python peer_runs.py NAME '{"files": [...], "step": 0.001, "steps": 1000, "folder": "..."}'

Prints one JSON document: the processor time of the steps, the outputs in the end, the tool's version.  Logging is off,
or as little as the tool can.  Names and calls are those of the tools' own documentation.
"""

import json
import sys
import time
from importlib.metadata import version
from pathlib import Path

NAMES = ("a", "b", "c")
BEFORE = {"a": "c", "b": "a", "c": "b"}  # whose output each reads


def timed(steps):
    """Return the processor seconds of a call; of all threads, since some tools step in their own."""
    began = time.process_time()
    steps()
    return time.process_time() - began


def fmpy(files, step, steps, folder):
    """A loop over FMPy's methods, as its documentation shows for two FMUs."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    slaves = []
    for name, file in zip(NAMES, files, strict=True):
        description = read_model_description(file)
        vr = {v.name: v.valueReference for v in description.modelVariables}
        slave = FMU2Slave(guid=description.guid, unzipDirectory=extract(file),
                          modelIdentifier=description.coSimulation.modelIdentifier, instanceName=name)  # fmt: skip
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        slaves.append(slave)
    y = [slave.getReal([vr["y"]])[0] for slave in slaves]

    def go():
        for k in range(steps):
            for i, slave in enumerate(slaves):
                slave.setReal([vr["u"]], [y[i - 1]])
            for slave in slaves:
                slave.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
            y[:] = [slave.getReal([vr["y"]])[0] for slave in slaves]

    return timed(go), y, "fmpy"


def libcosim(files, step, steps, folder):
    """All steps in one call of libcosim."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(step_size=round(step * 1e9))
    at = [
        execution.add_local_slave(CosimLocalSlave(fmu_path=f, instance_name=n))
        for n, f in zip(NAMES, files, strict=True)
    ]
    vr = {v.name.decode(): v.reference for v in execution.slave_variables(at[0])}
    for i in range(3):
        execution.connect_real_variables(at[i - 1], vr["y"], at[i], vr["u"])
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    taken = timed(lambda: execution.step(steps))
    return taken, [observer.last_real_values(slave_index=i, variable_references=[vr["y"]])[0] for i in at], "libcosimpy"


def ecos(files, step, steps, folder):
    """All steps in one call of Ecos."""
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    for name, file in zip(NAMES, files, strict=True):
        structure.add_model(name, file)
    for target, source in BEFORE.items():
        structure.make_real_connection(f"{source}::y", f"{target}::u")
    with EcosSimulation(structure=structure, step_size=step) as simulation:
        simulation.init()
        taken = timed(lambda: simulation.step(steps))
        return taken, [simulation.get_real(f"{name}::y") for name in NAMES], "ecospy"


def cofmupy(files, step, steps, folder):
    """CoFMUPy's coordinator, its loop solved by Jacobi without iterations."""
    from cofmupy.coordinator import Coordinator

    config = Path(folder, "cofmupy.json")
    fmus = [{"id": n, "path": f, "initialization": {}} for n, f in zip(NAMES, files, strict=True)]
    ends = [({"id": s, "variable": "y", "unit": ""}, {"id": t, "variable": "u", "unit": ""}) for t, s in BEFORE.items()]
    wires = [{"source": source, "target": target} for source, target in ends]
    method = {"cosim_method": "jacobi", "iterative": False, "edge_sep": " -> ", "root": str(folder)}
    config.write_text(json.dumps({"fmus": fmus, "connections": wires, **method}))
    coordinator = Coordinator()
    coordinator.start(str(config))

    def go():
        for _ in range(steps):
            coordinator.do_step(step)

    taken = timed(go)
    return taken, [float(coordinator.get_variable((n, "y"))[0]) for n in NAMES], "cofmupy"


def pathsim(files, step, steps, folder):
    """PathSim's simulation with one co-simulation block for each FMU."""
    from pathsim import Connection, Simulation
    from pathsim_fmi import CoSimulationFMU

    blocks = [CoSimulationFMU(fmu_path=f, instance_name=n, dt=step) for n, f in zip(NAMES, files, strict=True)]
    wires = [Connection(blocks[i - 1], blocks[i]) for i in range(3)]
    simulation = Simulation(blocks, wires, dt=step, log=False)
    taken = timed(lambda: simulation.run(duration=step * steps))
    return taken, [float(block.outputs[0]) for block in blocks], "pathsim-fmi"


def fmucontainer(files, step, steps, folder):
    """The container of the three, an FMU of its own, driven by FMPy's methods in steps of a hundred of its own."""
    import shutil
    import subprocess

    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    work = Path(folder, "container")
    work.mkdir(exist_ok=True)
    for name, file in zip(NAMES, files, strict=True):
        shutil.copy(file, work / f"{name}.fmu")
    rows = ["rule;from_fmu;from_port;to_fmu;to_port", *(f"FMU;{n}.fmu;;;" for n in NAMES),
            *(f"LINK;{s}.fmu;y;{t}.fmu;u" for t, s in BEFORE.items()),
            *(f"OUTPUT;{n}.fmu;y;;y_{n}" for n in NAMES)]  # fmt: skip
    (work / "ring.csv").write_text("\n".join(rows) + "\n")
    command = [str(Path(sys.executable).parent / "fmucontainer"), "-fmu-directory", str(work), "-container"]
    subprocess.run([*command, f"ring.csv:{step}"], check=True, capture_output=True)
    description = read_model_description(str(work / "ring.fmu"))
    vr = {v.name: v.valueReference for v in description.modelVariables}
    slave = FMU2Slave(guid=description.guid, unzipDirectory=extract(str(work / "ring.fmu")),
                      modelIdentifier=description.coSimulation.modelIdentifier, instanceName="ring")  # fmt: skip
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()

    def go():
        for k in range(steps // 100):
            slave.doStep(currentCommunicationPoint=100 * k * step, communicationStepSize=100 * step)

    taken = timed(go)
    return taken, slave.getReal([vr[f"y_{n}"] for n in NAMES]), "fmu-manipulation-toolbox"


RUNS = {"FMPy": fmpy, "libcosim": libcosim, "Ecos": ecos, "CoFMUPy": cofmupy, "PathSim": pathsim,
        "fmucontainer": fmucontainer}  # fmt: skip


def main():
    """Run and print."""
    name, asked = sys.argv[1], json.loads(sys.argv[2])
    if name not in RUNS:
        sys.exit(f"Error: {name} installs, but this benchmark does not know how to call it")
    seconds, y, package = RUNS[name](asked["files"], asked["step"], asked["steps"], asked["folder"])
    print(json.dumps({"seconds": seconds, "y": list(y), "version": version(package)}))


if __name__ == "__main__":
    main()
