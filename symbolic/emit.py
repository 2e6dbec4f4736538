"""Last stages: Equations -> CasADi functions -> C text, manifest and serialised graphs."""

import tempfile
from pathlib import Path

import casadi as ca
from ltcgear.generated.contract import Artifact, Manifest, Signature
from ltcgear.generated.store import digest

from .equations import Equations
from .model import Model
from .pointers import look_once


def functions(equations: Equations) -> dict[str, ca.Function]:
    """Make the functions of the contract, common subexpressions joined, in the contract's order."""
    x, s, p = equations.x, equations.s, equations.p
    rhs = _function("rhs", [x, s, p], [equations.xdot], ["x", "s", "p"], ["xdot"], [True, False, False])
    return {
        "rhs": rhs,
        "jac_rhs": _joined(rhs.jacobian()),
        "outputs": _function("outputs", [x, s, p], [equations.outputs], ["x", "s", "p"], ["y"]),
        "phases": _function("phases", [x, s, p], list(equations.phases), ["x", "s", "p"], ["tau", "tau_rate", "share"]),
        "borders": _function("borders", [x, s, p], [equations.borders], ["x", "s", "p"], ["g"]),
        "energy": _function("energy", [x, s, p], [equations.energy], ["x", "s", "p"], ["balance"]),
        "motion": _function("motion", [x, s, p], _motion(equations), ["x", "s", "p"], ["xdot", "power", "force"]),
    }


def _motion(equations: Equations) -> list[ca.SX]:
    """Return what one stage of an integration needs: xdot, power put in less power lost, mesh forces."""
    _, _, _, given, lost = ca.vertsplit(equations.energy)
    meshes = [i for i, report in enumerate(equations.reports) if report.quantity == "mesh_force"]
    return [equations.xdot, given - lost, ca.vertcat(*(equations.outputs[i] for i in meshes))]


def _function(
    name: str, arguments: list[ca.SX], results: list[ca.SX], names: list[str], out: list[str],
    differentiable: list[bool] | None = None,
) -> ca.Function:  # fmt: skip
    """Make one function with common subexpressions joined."""
    options = {"is_diff_in": differentiable} if differentiable else {}
    return ca.Function(name, arguments, ca.cse([ca.densify(r) for r in results]), names, out, options)


def _joined(function: ca.Function) -> ca.Function:
    """Join the common subexpressions of a function, its sparsity kept."""
    arguments = function.sx_in()
    results = ca.cse(function.call(arguments))
    return ca.Function(function.name(), arguments, results, function.name_in(), function.name_out())


def emit(model: Model, equations: Equations) -> Artifact:
    """Emit C and manifest.

    Parameters
    ----------
    model, equations
        What to emit.

    Returns
    -------
    Artifact
        The same text for the same input, whatever the hash seed.
    """
    made = functions(equations)
    c = c_text(list(made.values()))
    serializer = ca.StringSerializer()
    serializer.pack(list(made.values()))
    graphs = serializer.encode()
    manifest = Manifest(
        digest([c, graphs]), model.reference, equations.states, equations.levels, equations.parameters,
        equations.reports, {name: _signature(function) for name, function in made.items()}, ca.CasadiMeta.version(),
        model.signals, equations.holds, model.clocks,
    )  # fmt: skip
    return Artifact(c, manifest, graphs)


def c_text(made: list[ca.Function]) -> str:
    """Let CasADi write the functions into one C file and return its text."""
    generator = ca.CodeGenerator("model.c", {"verbose": False, "casadi_int": "long long int"})
    for function in made:
        generator.add(function)
    with tempfile.TemporaryDirectory() as folder:
        generator.generate(folder + "/")
        return look_once(Path(folder, "model.c").read_text("utf-8"))


def _signature(function: ca.Function) -> Signature:
    """Describe a function; loads and stores are not counted as operations."""
    shapes_in = [(function.name_in(i), *function.size_in(i)) for i in range(function.n_in())]
    shapes_out = [(function.name_out(i), *function.size_out(i)) for i in range(function.n_out())]
    moves = (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST)
    operations = sum(function.instruction_id(k) not in moves for k in range(function.n_instructions()))
    return Signature(tuple(shapes_in), tuple(shapes_out), function.nnz_out(0), operations)
