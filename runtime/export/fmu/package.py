"""FMU file: description, C and binary put together."""

import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.store import digest
from ltcgear.generated.writing import check_output, written_whole

from ...model.library import Library
from ...model.load_tables import Pairs
from ...simulation.method_limits import MOST_STEPS, REACH
from ..plain_c.data import PlainRun
from .binary import compile_fmu, platform_of, require_compiler
from .description import Head, describe, describe_build
from .names import identify
from .sources import write_sources, write_variables
from .variables import OUTPUTS, Interface

CO_SIMULATION, MODEL_EXCHANGE = "co-simulation", "model-exchange"
VERSIONS = {CO_SIMULATION: "2.0", MODEL_EXCHANGE: "3.0"}
"""Kind of FMU -> version of FMI."""
RTOL = 1e-6
OLDEST = (1980, 1, 1, 0, 0, 0)
"""Modification time of all files of the archive, so that the same scene gives the same bytes."""


def write_fmu(
    library: Library,
    values: Mapping[str, float],
    path: str | Path,
    *,
    kind: str = CO_SIMULATION,
    name: str = "model",
    title: str = "",
    tables: Mapping[str, Pairs] | None = None,
    inputs: Sequence[str] = (),
    t_end: float = 0.5,
    rate: float = 8192.0,
) -> dict[str, Any]:
    """Write a model as an FMU; the file appears whole or not at all.

    Parameters
    ----------
    library, values
        Model and its parameters by name.
    path
        The file, ``.fmu``.
    kind
        ``co-simulation`` (FMI 2.0, with the integrator inside) or ``model-exchange`` (FMI 3.0, for the importer's).
    name, title
        What it is called.
    tables
        The model's tables over time, by name.
    inputs
        Names of tables that become inputs; their first values are the start values.
    t_end, rate
        Time to simulate [s] and communication points a second [Hz] that the description proposes.

    Returns
    -------
    dict
        Path, kind, version of FMI, token, and how many variables of each kind there are.

    Raises
    ------
    LtcgearError
        If the file cannot be written, the kind is not known, a table is missing, or there is no C compiler.
    CompileError
        If the compiler refuses the C.
    SolverError
        If the model has no equilibrium.
    """
    path, exchange = Path(path), check_kind(kind)
    check_fmu(path)
    system = platform_of(exchange)
    require_compiler()
    known = dict(tables or {})
    _check_tables(library, known, inputs)
    run = PlainRun(values, known, t_end, rate)
    interface = Interface(library, run, inputs, exchange)
    if not exchange:
        _check_effort(library, interface, t_end)
    head = Head(name, title, identify(name), "", f"ltcgear {version('ltcgear')}", t_end, RTOL, 1 / rate, ())
    token, files = _write_files(library, run, interface, head, system)
    _pack(path, files)
    kinds = {kind: (kind,) for kind in ("parameter", "input", "output", "state", "indicator")} | {"output": OUTPUTS}
    counts = {kind: len(interface.of(*members)) for kind, members in kinds.items()}
    return {
        "file": str(path), "kind": kind, "fmi": VERSIONS[kind], "token": token, "variables": counts,
        "inputs": [variable.name for variable in interface.of("input")],
    }  # fmt: skip


def _write_files(
    library: Library, run: PlainRun, interface: Interface, head: Head, system: str
) -> tuple[str, dict[str, bytes]]:
    """Return the token, which follows from all texts, and path -> content of what is in the archive."""
    sources = write_sources(library, head.name, run, interface)
    head = replace(head, sources=(*(file for file in sources if file.endswith(".c")), "variables.c"))
    token = digest([*sources, *sources.values(), describe(head, interface), write_variables(interface, "")])[:32]
    head, sources["variables.c"] = replace(head, token=token), write_variables(interface, token)
    files = {
        "modelDescription.xml": describe(head, interface).encode(),
        f"binaries/{system}/{head.identifier}.so": compile_fmu(sources, interface.exchange),
        **{f"sources/{file}": text.encode() for file, text in sources.items()},
    }
    if interface.exchange:
        files["sources/buildDescription.xml"] = describe_build(head).encode()
    return token, files


def _check_tables(library: Library, tables: Mapping[str, Pairs], inputs: Sequence[str]) -> None:
    """Refuse a table that is missing, and an input that is no table of the model's."""
    used = {signal.table for signal in library.manifest.signals}
    if missing := sorted(used - set(tables)):
        raise LtcgearError(f"tables: {', '.join(missing)} missing; give the model's tables (model.tables)")
    if unknown := sorted(set(inputs) - used):
        raise LtcgearError(f"inputs: the model has no table {', '.join(unknown)}; it has {', '.join(used) or 'none'}")


def _check_effort(library: Library, interface: Interface, t_end: float) -> None:
    """Refuse a model whose fastest motion takes too many steps from the explicit method inside."""
    speed, body = interface.point.fastest, interface.point.fastest_body
    steps = t_end * speed / REACH
    if steps > MOST_STEPS:
        raise LtcgearError(
            f"co-simulation integrates by an explicit method, which needs about {steps:.0e} steps for {t_end:g} s: "
            f"{body} swings at {speed:.1e} rad/s; write --kind model-exchange, give {body.split()[0]} more inertia or "
            "softer springs, or lower simulation.t_end"
        )


def check_kind(kind: str) -> bool:
    """Return whether a kind is model exchange; LtcgearError if there is no such kind."""
    if kind not in VERSIONS:
        raise LtcgearError(f"--kind {kind}: must be one of {', '.join(VERSIONS)}")
    return kind == MODEL_EXCHANGE


def check_fmu(path: Path, *sources: str) -> None:
    """Refuse a file that cannot be written, of another suffix, or that is the source itself."""
    check_output(path, *sources)
    if path.suffix != ".fmu":
        raise LtcgearError(f"{path}: FMUs have their own suffix; name it {path.with_suffix('.fmu')}")


def _pack(path: Path, files: Mapping[str, bytes]) -> None:
    """Write an archive whose bytes depend on the files only."""
    with written_whole(path) as draft, zipfile.ZipFile(draft, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            info = zipfile.ZipInfo(name, OLDEST)
            info.compress_type, info.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(info, files[name])
