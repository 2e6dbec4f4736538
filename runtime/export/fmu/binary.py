"""Binary of an FMU: its C compiled for Linux machines of this kind."""

import platform
from collections.abc import Mapping

from ltcgear.generated import store
from ltcgear.generated.compiler import run_compiler, seconds_for
from ltcgear.generated.drafts import draft, tell_fault
from ltcgear.generated.errors import CompileError, LtcgearError
from ltcgear.generated.writing import told

FLAGS = (
    "-std=c11", "-O3", "-fPIC", "-shared", "-fvisibility=hidden", "-fno-math-errno", "-fno-ident", "-Wall",
    "-Werror", "-s", "-Wl,--build-id=none",
)  # fmt: skip
"""For any processor of the kind; nothing of the place where it is built goes into the file."""
NEEDED = "an FMU needs a C compiler, and none was found; install gcc or clang, or name one with CC"
EXPORTS = "exports.map"


def platform_of(exchange: bool) -> str:
    """Return how FMI calls this machine.

    Raises
    ------
    LtcgearError
        If FMI has no name for it.
    """
    system, machine = platform.system(), platform.machine()
    if system != "Linux" or (not exchange and machine != "x86_64"):
        raise LtcgearError(f"FMUs are compiled on Linux only (co-simulation: on x86_64), not on {system} {machine}")
    return f"{machine}-linux" if exchange else "linux64"


def compile_fmu(sources: Mapping[str, str], exchange: bool) -> bytes:
    """Compile the C of an FMU; only functions of the standard can be seen from outside.

    Raises
    ------
    CompileError
        If the compiler refuses it or does not end, or there is none.
    MachineError
        If the store, in which it is made, cannot be written.
    """
    compiler = require_compiler()
    parent = store.root()
    with told(parent, tell=tell_fault), draft(parent) as folder:
        for name, text in sources.items():
            (folder / name).write_text(text, encoding="utf-8")
        prefix = "fmi3" if exchange else "fmi2"
        (folder / EXPORTS).write_text(f"{{ global: {prefix}*; local: *; }};\n", encoding="ascii")
        files, made = [name for name in sources if name.endswith(".c")], folder / "model.so"
        script = f"-Wl,--version-script={EXPORTS}"
        command = [*compiler.command, *FLAGS, script, *files, "-o", made.name, *store.LIBRARIES]
        ended = run_compiler(command, seconds_for(sum(map(len, sources.values()))), folder)
        if ended.code != 0:
            raise CompileError(f"{compiler.name} refused the C of the FMU ({ended.how})")
        store.check_library(made, compiler)
        return made.read_bytes()


def require_compiler() -> store.Compiler:
    """Return the C compiler.

    Raises
    ------
    CompileError
        If there is none.
    """
    compiler = store.compiler()
    if compiler is None:
        raise CompileError(NEEDED)
    return compiler
