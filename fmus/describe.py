"""modelDescription.xml of a component, for FMI 2.0 and 3.0, and the build description of FMI 3.0."""

from __future__ import annotations

import inspect
import xml.etree.ElementTree as ET

import numpy as np

from cosim import Component, Variable, units

from .layout import Layout, scalar_names
from .states import TOOL

SOURCE = "all.c"  # includes all the others: foreign builds compile the first file set only
TOLERANCE, STEP = "1e-08", "0.001"


def description_xml(layout: Layout, identifier: str, token: str, fmi: int) -> str:
    """Return the text of modelDescription.xml."""
    root = ET.Element("fmiModelDescription", fmiVersion="2.0" if fmi == 2 else "3.0", modelName=identifier)
    root.set("guid" if fmi == 2 else "instantiationToken", token)
    root.set("description", first_line(layout.component))
    root.set("generationTool", TOOL)
    root.set("variableNamingConvention", "structured")
    if fmi == 2:
        root.set("numberOfEventIndicators", "0")
    _interface(root, layout, identifier, fmi)
    _units(root, layout)
    categories = ET.SubElement(root, "LogCategories")
    for name in ("logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal"):
        ET.SubElement(categories, "Category", name=name)
    ET.SubElement(root, "DefaultExperiment", startTime="0", stopTime="1", tolerance=TOLERANCE, stepSize=STEP)
    (_scalars if fmi == 2 else _arrays)(root, layout)
    return _text(root)


def build_xml(identifier: str) -> str:
    """Return the text of sources/buildDescription.xml (FMI 3.0)."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    files = ET.SubElement(configuration, "SourceFileSet", language="C11")
    ET.SubElement(files, "SourceFile", name=SOURCE)
    return _text(root)


def first_line(component: Component) -> str:
    """Return the first line of a component's docstring."""
    return (inspect.getdoc(type(component)) or type(component).__name__).splitlines()[0]


def _text(root: ET.Element) -> str:
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _interface(root: ET.Element, layout: Layout, identifier: str, fmi: int) -> None:
    interface = ET.SubElement(root, "CoSimulation", modelIdentifier=identifier)
    follows = "true" if layout.component.equations.follows_inputs else "false"
    announces = "true" if any(layout.component.equations.announced) else "false"
    if fmi == 2:
        flags = {
            "canHandleVariableCommunicationStepSize": "true",
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
            "providesDirectionalDerivative": "true",
            "canInterpolateInputs": follows,
        }
        ET.SubElement(ET.SubElement(interface, "SourceFiles"), "File", name=SOURCE)
    else:
        flags = {
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": "true",
            "providesDirectionalDerivatives": "true",
            "canHandleVariableCommunicationStepSize": "true",
            "providesIntermediateUpdate": follows,
            "mightReturnEarlyFromDoStep": announces,
            "hasEventMode": announces,
        }
    for name, value in flags.items():
        interface.set(name, value)


def _units(root: ET.Element, layout: Layout) -> None:
    definitions = ET.SubElement(root, "UnitDefinitions")
    for name in sorted({v.unit for v in layout.variables if v.unit is not None} | {"s"}):
        unit = units.parse(name)
        base = ET.SubElement(ET.SubElement(definitions, "Unit", name=name), "BaseUnit")
        for symbol, exponent in zip(units.BASE, unit.exponents, strict=True):
            if exponent:
                base.set(symbol, str(exponent))
        if unit.factor != 1.0:
            base.set("factor", repr(unit.factor))
        if unit.offset != 0.0:
            base.set("offset", repr(unit.offset))


def _attributes(layout: Layout, variable: Variable) -> dict[str, str]:
    """Attributes that both versions of the standard have on a variable."""
    found = {"description": variable.meaning, "causality": variable.causality, "variability": variable.variability}
    if variable.causality == "local":
        found["initial"] = "calculated" if variable.name.startswith("der(") else "exact"
    elif variable.causality == "output":
        found["initial"] = "calculated"
    elif variable.causality == "parameter":
        found["initial"] = "exact"
    return found


def _nominal(layout: Layout, variable: Variable) -> str | None:
    declaration = layout.component.declarations.get(variable.name)
    if declaration is None or declaration.role != "state" or declaration.nominal == 1.0:
        return None
    return repr(float(declaration.nominal))


def _start(variable: Variable) -> list[str]:
    return [repr(float(v)) for v in np.ravel(np.broadcast_to(variable.start, variable.shape))]


def _arrays(root: ET.Element, layout: Layout) -> None:
    """FMI 3.0: one element per variable, arrays with dimensions."""
    parent = ET.SubElement(root, "ModelVariables")
    time = {"name": "time", "valueReference": "0", "causality": "independent", "variability": "continuous"}
    ET.SubElement(parent, "Float64", time, unit="s", description="simulation time")
    for v in layout.variables:
        element = ET.SubElement(parent, v.type, name=v.name, valueReference=str(layout.reference[v.name]))
        element.attrib |= _attributes(layout, v)
        if v.causality == "input" and layout.component.equations.follows_inputs:
            element.set("intermediateUpdate", "true")
        if v.type == "String":
            ET.SubElement(element, "Start", value=str(v.start))
            continue
        if v.unit is not None:
            element.set("unit", v.unit)
        if (nominal := _nominal(layout, v)) is not None:
            element.set("nominal", nominal)
        if v.start is not None:
            element.set("start", " ".join(_start(v)))
        if v.name.startswith("der("):
            element.set("derivative", str(layout.reference[v.name[4:-1]]))
        for extent in v.shape:
            ET.SubElement(element, "Dimension", start=str(extent))
    structure = ET.SubElement(root, "ModelStructure")
    unknowns = [(v, at, at + v.size) for v, at in _unknowns(layout)]
    names = [("Output", "output"), ("ContinuousStateDerivative", "local"), ("InitialUnknown", None)]
    depends = layout.dependencies()
    for tag, causality in names:
        for v, at, end in unknowns:
            if causality is not None and v.causality != causality:
                continue
            element = ET.SubElement(structure, tag, valueReference=str(at))
            if causality is not None:
                rows = depends[at - layout.first["y"] : end - layout.first["y"]].max(axis=0)
                element.set("dependencies", " ".join(map(str, _whole_variables(layout, rows))))


def _unknowns(layout: Layout) -> list[tuple[Variable, int]]:
    """Outputs and derivatives, with their first slot, in the order of slots."""
    found = [(v, layout.reference[v.name]) for v in layout.variables if v.type != "String"]
    return sorted(((v, at) for v, at in found if at >= layout.first["y"]), key=lambda pair: pair[1])


def _whole_variables(layout: Layout, depends: np.ndarray) -> list[int]:
    """Value references of the variables that have at least one scalar among those depended on."""
    return [
        at
        for v, at in [(None, 0), *((v, layout.reference[v.name]) for v in layout.variables if v.type != "String")]
        if at < len(depends) and depends[at : at + (v.size if v else 1)].any() and _is_known(layout, at)
    ]


def _is_known(layout: Layout, slot: int) -> bool:
    """Inputs, time, and the states if their derivatives are exposed."""
    first = layout.first
    return slot == 0 or first["u"] <= slot < (first["y"] if first["dx"] < first["end"] else first["x"])


def _scalars(root: ET.Element, layout: Layout) -> None:
    """FMI 2.0: one element per scalar, referred to by its index."""
    parent = ET.SubElement(root, "ModelVariables")
    index: dict[int, int] = {}

    def add(slot: int, tag: str, attributes: dict[str, str]) -> ET.Element:
        index[slot] = len(index) + 1
        return ET.SubElement(ET.SubElement(parent, "ScalarVariable", attributes), tag)

    time = {"name": "time", "valueReference": "0", "causality": "independent", "variability": "continuous"}
    add(0, "Real", {**time, "description": "simulation time"}).set("unit", "s")
    for v in layout.variables:
        if v.type == "String":
            attributes = {"name": v.name, "valueReference": str(layout.reference[v.name]), **_attributes(layout, v)}
            add(layout.reference[v.name], "String", attributes).set("start", str(v.start))
            continue
        starts = _start(v) if v.start is not None else None
        for i, name in enumerate(scalar_names(v)):
            slot = layout.reference[v.name] + i
            real = add(slot, "Real", {"name": name, "valueReference": str(slot), **_attributes(layout, v)})
            if v.unit is not None:
                real.set("unit", v.unit)
            if (nominal := _nominal(layout, v)) is not None:
                real.set("nominal", nominal)
            if starts is not None:
                real.set("start", starts[i])
            if v.name.startswith("der("):
                real.set("derivative", str(index[slot - layout.first["dx"] + layout.first["x"]]))
    structure = ET.SubElement(root, "ModelStructure")
    first, depends = layout.first, layout.dependencies()
    groups = {"Outputs": range(first["y"], first["dx"]), "Derivatives": range(first["dx"], first["end"])}
    for tag, slots in groups.items():
        group = ET.SubElement(structure, tag) if slots else structure
        for slot in slots:
            known = sorted(
                index[s] for s in np.flatnonzero(depends[slot - first["y"]]).tolist() if _is_known(layout, s)
            )
            ET.SubElement(group, "Unknown", index=str(index[slot]), dependencies=" ".join(map(str, known)))
    unknowns = sorted(index[slot] for slot in range(first["y"], first["end"]))
    group = ET.SubElement(structure, "InitialUnknowns") if unknowns else structure
    for i in unknowns:
        ET.SubElement(group, "Unknown", index=str(i))
