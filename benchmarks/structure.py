"""Structure of the product in numbers: import chains, circles, sizes of files and functions, names that occur twice.

``python -m benchmarks.structure`` prints them; tests/test_structure.py holds them to their limits. An import inside a
function or under ``TYPE_CHECKING`` counts for circles of rooms, but not for the chain, which is what a start loads.
"""

import ast
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PARTS = ("symbolic", "generated", "runtime")
NAMESPACE = "runtime/namespace"
"""The files of the package itself, tested with the Python interface."""
Functions = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Module:
    """A module: dotted name without ``ltcgear``, its tree, and the modules that it imports when it is loaded."""

    name: str
    path: Path
    tree: ast.Module
    lines: int


@cache
def modules() -> dict[str, Module]:
    """Return all modules of the product by name."""
    found = {}
    for part in PARTS:
        for path in sorted((ROOT / part).rglob("*.py")):
            names = path.relative_to(ROOT).with_suffix("").parts
            name = ".".join(names[:-1] if names[-1] == "__init__" else names)
            text = path.read_text("utf-8")
            found[name] = Module(name, path, ast.parse(text), len(text.splitlines()))
    return found


def imports(module: Module) -> Iterator[str]:
    """Yield the modules that one imports when it is loaded."""
    package = module.name.split(".") if module.path.name == "__init__.py" else module.name.split(".")[:-1]
    for node in module.tree.body:
        if not isinstance(node, ast.ImportFrom):
            continue
        base = package[: len(package) - node.level + 1] if node.level else []
        names = [*base, *(node.module or "").split(".")] if node.module else base
        target = ".".join(names).removeprefix("ltcgear.")
        for alias in node.names:
            inner = f"{target}.{alias.name}"
            if inner in modules() or target in modules():
                yield inner if inner in modules() else target


def circles() -> list[list[str]]:
    """Return modules that import each other in a circle."""
    graph = {name: sorted(set(imports(module)) - {name}) for name, module in modules().items()}
    found, done = [], set[str]()

    def visit(name: str, path: list[str]) -> None:
        if name in path:
            found.append([*path[path.index(name) :], name])
        elif name not in done:
            for other in graph[name]:
                visit(other, [*path, name])
            done.add(name)

    for name in graph:
        visit(name, [])
    return found


def longest_chain() -> list[str]:
    """Return the longest chain of modules of which each imports the next."""

    @cache
    def chain(name: str) -> tuple[str, ...]:
        behind = [chain(other) for other in sorted(set(imports(modules()[name])) - {name})]
        return (name, *max(behind, key=len, default=()))

    return list(max((chain(name) for name in modules()), key=len))


def functions() -> dict[str, int]:
    """Return the lines of every function, its docstring left out."""
    found = {}
    for module in modules().values():
        for node in ast.walk(module.tree):
            if isinstance(node, Functions):
                told = node.body[0]
                words = ast.get_docstring(node) is not None
                own = (told.end_lineno or 0) - told.lineno + 1 if words else 0
                found[f"{module.name}.{node.name}:{node.lineno}"] = (node.end_lineno or 0) - node.lineno + 1 - own
    return found


def twice(names: Counter[str]) -> dict[str, int]:
    """Return what occurs more than once."""
    return {name: count for name, count in sorted(names.items()) if count > 1}


def stems() -> dict[str, int]:
    """Return file stems that occur more than once."""
    return twice(Counter(m.path.stem for m in modules().values() if m.path.name != "__init__.py"))


def classes() -> dict[str, int]:
    """Return public class names that occur more than once."""
    found = (node.name for m in modules().values() for node in m.tree.body if isinstance(node, ast.ClassDef))
    return twice(Counter(name for name in found if not name.startswith("_")))


def room_of(module: Module) -> str:
    """Return a module's folder below the top, two levels at most: ``runtime/model``, ``generated``."""
    return "/".join(module.path.relative_to(ROOT).parts[:-1][:2])


def named() -> dict[str, str]:
    """Return the room of every module by its stem."""
    return {m.path.stem: room_of(m) for m in modules().values() if m.path.name != "__init__.py"}


def test_files() -> list[Path]:
    """Return the test files of the three parts, below ``tests/``."""
    folder = ROOT / "tests"
    return [path.relative_to(folder) for part in PARTS for path in sorted((folder / part).rglob("test_*.py"))]


def unmatched_rooms() -> dict[str, set[str]]:
    """Return rooms without a folder of tests, and folders of tests that are no room."""
    rooms, folders = {room_of(m) for m in modules().values()}, {path.parent.as_posix() for path in test_files()}
    return {"untested": rooms - folders - {*PARTS, NAMESPACE}, "no room": folders - rooms}


def misplaced_tests() -> list[str]:
    """Return test files that have a module's name and stand in another room's folder."""
    rooms, found = named(), [(path, path.parent.as_posix()) for path in test_files()]
    return [str(path) for path, folder in found if rooms.get(path.stem.removeprefix("test_"), folder) != folder]


def print_tests() -> None:
    """Print how many modules of each room have a test file of their name."""
    rooms, files = named(), {path.stem.removeprefix("test_") for path in test_files()}
    every, found = Counter(rooms.values()), Counter(room for stem, room in rooms.items() if stem in files)
    told = ", ".join(f"{room} {found[room]}/{count}" for room, count in sorted(every.items()))
    print(f"modules with a test file of their name {found.total()} of {every.total()}: {told}")


def main() -> None:
    """Print the numbers."""
    sizes = np.array(list(functions().values()))
    lines = defaultdict(int)
    for module in modules().values():
        lines[module.name.split(".")[0]] += module.lines
    testing = sum(len(path.read_text("utf-8").splitlines()) for path in (ROOT / "tests").rglob("*.py"))
    total, chain = sum(lines.values()), longest_chain()
    long_files = {name: m.lines for name, m in modules().items() if m.lines > 400}
    long_functions = {name: size for name, size in functions().items() if size > 60}
    print(f"modules {len(modules())}; longest chain {len(chain)}: {' > '.join(chain)}")
    print(f"circles {circles() or 'none'}")
    entries = sorted(path.name for path in (ROOT / "runtime").iterdir() if path.name != "__pycache__")
    print(f"entries of runtime {len(entries)}: {' '.join(entries)}")
    print(f"stems twice {stems() or 'none'}\npublic classes twice {classes() or 'none'}")
    print(f"functions {len(sizes)}: 90 % at most {np.quantile(sizes, 0.9):.0f} lines, longest {sizes.max()}")
    print(f"longer than 60: {long_functions or 'none'}\nfiles longer than 400: {long_files or 'none'}")
    told = ", ".join(f"{part} {count}" for part, count in lines.items())
    print(f"lines {total} ({told}); tests {testing}, {testing / total:.2f} of it")
    print_tests()


if __name__ == "__main__":
    main()
