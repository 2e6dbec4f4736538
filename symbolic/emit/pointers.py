"""Pointer checks of the C text: each argument of a CasADi function is checked once.

CasADi allows null pointers for arguments (zero) and results (not wanted), and checks them at every number read or
written. The hundreds of branches split the text into blocks: without them a right-hand side takes a tenth less time and
a compiler half as long.
"""

import re

BODY = re.compile(r"^static int casadi_f\d+\(.*?^}\n", re.MULTILINE | re.DOTALL)
READ = re.compile(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0")
WRITE = re.compile(r"if \(res\[(\d+)\]!=0\) res\[\1\]\[(\d+)\]")


def look_once(text: str) -> str:
    """Check the pointers of every function at its start.

    Parameters
    ----------
    text
        C as CasADi writes it for functions of scalars.

    Returns
    -------
    str
        The same functions: null arguments are read from zeros, null results are written to a dummy.
    """
    zeros, first = _sizes(READ, text), BODY.search(text)
    if first is None:
        return text
    head = f"static const casadi_real casadi_zeros[{max(zeros.values())}] = {{0}};\n\n" if zeros else ""
    return text[: first.start()] + head + BODY.sub(_function, text[first.start() :])


def _function(match: re.Match[str]) -> str:
    """Rewrite one function."""
    opening, body = match[0].split("\n", 1)
    read, written = _sizes(READ, body), _sizes(WRITE, body)
    lines = [f"  const casadi_real* u{i} = arg[{i}]? arg[{i}] : casadi_zeros;" for i in read]
    for i, size in written.items():
        lines += [f"  casadi_real nowhere{i}[{size}];", f"  casadi_real* y{i} = res[{i}]? res[{i}] : nowhere{i};"]
    return "\n".join([opening, *lines, WRITE.sub(r"y\1[\2]", READ.sub(r"u\1[\2]", body))])


def _sizes(pattern: re.Pattern[str], body: str) -> dict[int, int]:
    """Return pointer -> its required size, in order."""
    sizes: dict[int, int] = {}
    for pointer, number in pattern.findall(body):
        sizes[int(pointer)] = max(sizes.get(int(pointer), 0), int(number) + 1)
    return dict(sorted(sizes.items()))
