"""Structure of the product: no circles, short chains of imports, no name twice, nothing too long, tests by room."""

import numpy as np
from benchmarks.structure import (
    ROOT,
    circles,
    classes,
    functions,
    longest_chain,
    misplaced_tests,
    modules,
    stems,
    unmatched_rooms,
)  # fmt: skip

ROOMS = {"analysis", "api", "cli", "export", "linear", "model", "results", "simulation", "studies", "view"}


def test_no_module_imports_itself_in_a_circle():
    assert circles() == []


def test_runtime_has_its_rooms_and_the_door():
    found = {path.name for path in (ROOT / "runtime").iterdir()} - {"__pycache__"}
    assert found == {*ROOMS, "namespace", "__init__.py", "__init__.pyi"}


def test_no_name_occurs_twice():
    assert (stems(), classes()) == ({}, {})


def test_files_and_functions_are_short():
    sizes = functions()
    assert np.quantile(list(sizes.values()), 0.9) <= 22
    assert {name: size for name, size in sizes.items() if size > 60} == {}
    assert {name: module.lines for name, module in modules().items() if module.lines > 400} == {}


def test_chains_of_imports_stay_short():
    assert len(longest_chain()) <= 14


def test_every_room_has_a_folder_of_tests_and_every_folder_is_a_room():
    assert unmatched_rooms() == {"untested": set(), "no room": set()}


def test_a_test_file_with_the_name_of_a_module_stands_in_its_room():
    assert misplaced_tests() == []
