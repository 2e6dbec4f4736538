"""Model description of an FMU: modelDescription.xml and buildDescription.xml."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass

from .fmi_units import exponents
from .variables import OUTPUTS, Interface, Variable

CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
LOGGED = {"logStatusError": "what was refused, and why", "logStatusDiscard": "why a step could not be finished"}


@dataclass(frozen=True)
class Head:
    """What the description says besides its variables: names, and the experiment that the scene is made for.

    Attributes
    ----------
    name, title
        The scene's.
    identifier
        How the binary is called.
    token
        By which importer and binary know each other, ``""`` while it is not known.
    tool
        Name and version of what has written it.
    t_end, rtol, step
        Time to simulate [s], relative tolerance, communication step [s].
    sources
        C files to compile.
    """

    name: str
    title: str
    identifier: str
    token: str
    tool: str
    t_end: float
    rtol: float
    step: float
    sources: tuple[str, ...]


def describe(head: Head, interface: Interface) -> str:
    """Return modelDescription.xml: FMI 3.0 for model exchange, FMI 2.0 for co-simulation."""
    return _exchange(head, interface) if interface.exchange else _simulation(head, interface)


def describe_build(head: Head) -> str:
    """Return buildDescription.xml of FMI 3.0, which describes how to compile the sources."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    build = ET.SubElement(root, "BuildConfiguration", modelIdentifier=head.identifier)
    files = ET.SubElement(build, "SourceFileSet", language="C11")
    for name in head.sources:
        ET.SubElement(files, "SourceFile", name=name)
    ET.SubElement(build, "Library", name="m", external="true")
    return _text(root)


def _simulation(head: Head, interface: Interface) -> str:
    """Return the description of FMI 2.0."""
    root = ET.Element("fmiModelDescription", {"fmiVersion": "2.0"} | _about(head) | {"guid": head.token})
    kind = ET.SubElement(
        root, "CoSimulation", modelIdentifier=head.identifier, canHandleVariableCommunicationStepSize="true",
        canNotUseMemoryManagementFunctions="true", canGetAndSetFMUstate="true", canSerializeFMUstate="true",
    )  # fmt: skip
    files = ET.SubElement(kind, "SourceFiles")
    for name in head.sources:
        ET.SubElement(files, "File", name=name)
    _add_common(root, head, interface)
    listed = ET.SubElement(root, "ModelVariables")
    index = {variable.reference: str(i) for i, variable in enumerate(interface.variables, start=1)}
    for variable in interface.variables:
        place = {"name": variable.name, "valueReference": str(variable.reference)}
        item = ET.SubElement(listed, "ScalarVariable", place | _roles(variable))
        ET.SubElement(item, "Real", _numbers(variable))
    structure = ET.SubElement(root, "ModelStructure")
    for section in ("Outputs", "InitialUnknowns"):  # states of a co-simulation are nobody else's, and no unknowns
        inside = ET.SubElement(structure, section)
        for variable in interface.of(*OUTPUTS):
            ET.SubElement(inside, "Unknown", index=index[variable.reference])
    return _text(root)


def _exchange(head: Head, interface: Interface) -> str:
    """Return the description of FMI 3.0."""
    root = ET.Element("fmiModelDescription", {"fmiVersion": "3.0"} | _about(head) | {"instantiationToken": head.token})
    ET.SubElement(
        root, "ModelExchange", modelIdentifier=head.identifier, canGetAndSetFMUState="true",
        canSerializeFMUState="true", needsCompletedIntegratorStep="false",
    )  # fmt: skip
    _add_common(root, head, interface)
    listed = ET.SubElement(root, "ModelVariables")
    for variable in interface.variables:
        place = {"name": variable.name, "valueReference": str(variable.reference)}
        ET.SubElement(listed, "Float64", place | _roles(variable) | _numbers(variable))
    structure = ET.SubElement(root, "ModelStructure")
    sections = {
        "Output": interface.of(*OUTPUTS),
        "ContinuousStateDerivative": interface.of("rate"),
        "InitialUnknown": interface.of("state", "rate", *OUTPUTS),
        "EventIndicator": interface.of("indicator"),
    }
    for section, variables in sections.items():
        for variable in variables:
            ET.SubElement(structure, section, valueReference=str(variable.reference))
    return _text(root)


def _about(head: Head) -> dict[str, str]:
    """Return what both versions say of the model."""
    return {
        "modelName": head.name, "description": head.title, "generationTool": head.tool,
        "variableNamingConvention": "structured",
    }  # fmt: skip


def _add_common(root: ET.Element, head: Head, interface: Interface) -> None:
    """Add units, categories of messages and the experiment."""
    units = ET.SubElement(root, "UnitDefinitions")
    for name in sorted({variable.unit for variable in interface.variables if variable.unit}):
        unit = ET.SubElement(units, "Unit", name=name)
        ET.SubElement(unit, "BaseUnit", {base: str(power) for base, power in exponents(name).items()})
    categories = ET.SubElement(root, "LogCategories")
    for category, text in LOGGED.items():
        ET.SubElement(categories, "Category", name=category, description=text)
    ET.SubElement(
        root, "DefaultExperiment", startTime="0.0", stopTime=repr(head.t_end), tolerance=repr(head.rtol),
        stepSize=repr(head.step),
    )  # fmt: skip


def _roles(variable: Variable) -> dict[str, str]:
    """Return a variable's roles, as both versions name them."""
    said = {
        "description": variable.description, "causality": variable.causality, "variability": variable.variability,
        "initial": "" if variable.causality == "input" else variable.initial,
    }  # fmt: skip
    return {key: value for key, value in said.items() if value}


def _numbers(variable: Variable) -> dict[str, str]:
    """Return a variable's unit and numbers, as both versions name them."""
    numbers: Sequence[tuple[str, float | None]] = (
        ("start", variable.start), ("min", variable.lowest), ("max", variable.highest),
        ("nominal", variable.nominal),
    )  # fmt: skip
    said = {"unit": variable.unit} if variable.unit else {}
    said |= {key: repr(value) for key, value in numbers if value is not None}
    return said | ({} if variable.derivative is None else {"derivative": str(variable.derivative)})


def _text(root: ET.Element) -> str:
    """Return a document as text; XML has no control characters, not even written out."""
    ET.indent(root)
    text = CONTROL.sub("_", ET.tostring(root, encoding="unicode"))
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'
