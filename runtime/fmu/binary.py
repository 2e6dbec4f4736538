"""Binary: the C of an FMU compiled for whatever Linux machine of this kind."""

import platform
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

from ltcgear.generated import store
from ltcgear.generated.errors import CompileError, LtcgearError

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
        If the compiler refuses it.
    LtcgearError
        If there is none.
    """
    compiler = require_compiler()
    with tempfile.TemporaryDirectory(prefix="ltcgear-") as folder:
        for name, text in sources.items():
            Path(folder, name).write_text(text, encoding="utf-8")
        prefix = "fmi3" if exchange else "fmi2"
        Path(folder, EXPORTS).write_text(f"{{ global: {prefix}*; local: *; }};\n", encoding="ascii")
        files = [name for name in sources if name.endswith(".c")]
        command = [compiler.path, *FLAGS, f"-Wl,--version-script={EXPORTS}", *files, "-o", "model.so", *store.LIBRARIES]
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise CompileError(f"{compiler.path} refused the C of the FMU: {run.stderr.strip()[:2000]}")
        return Path(folder, "model.so").read_bytes()


def require_compiler() -> store.Compiler:
    """Return the C compiler.

    Raises
    ------
    LtcgearError
        If there is none.
    """
    compiler = store.compiler()
    if compiler is None:
        raise LtcgearError(NEEDED)
    return compiler
