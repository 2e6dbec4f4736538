"""FMUs give back all memory, and touch none that is not theirs."""

import gc
from pathlib import Path

import fmpy
import pytest
from ltcgear.generated import store

from ..plain import SANITIZERS, UNUSED, call, can_sanitize, execute

HERE = Path(__file__).parent
HEADERS = Path(fmpy.__file__).parent / "c-code"


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_sanitizers_find_nothing(kind, unzipped, folder, request):
    if not can_sanitize(folder):
        pytest.skip("no sanitizers here")
    sources = unzipped[request.getfixturevalue(kind)] / "sources"
    driver = HERE / {"cs": "fmu2_drive.c", "me": "fmu3_drive.c"}[kind]
    objects = [sanitized(source, sources, folder) for source in (*sources.glob("*.c"), driver)]
    call(store.compiler().path, *SANITIZERS, *objects, "-o", folder / driver.stem, "-lm")
    assert execute(folder / driver.stem) == ("", "")


def sanitized(source, headers, folder):
    """Compile a file with sanitizers, once for both kinds where it is the same."""
    made = folder / f"{store.digest([source.name, source.read_text()])[:16]}.o"
    level = ("-O1", "-fno-inline") if source.name == "ltcgear.c" else ("-O0", *UNUSED)
    if not made.exists():
        places = ("-I", headers, "-I", HEADERS)
        call(store.compiler().path, "-std=c11", *level, *SANITIZERS, *places, "-c", source, "-o", made)
    return made


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_memory_stays_flat(kind, make, request):
    instance = make(request.getfixturevalue(kind))
    free = instance.fmu.fmi2FreeInstance if instance.two else instance.fmu.fmi3FreeInstance

    def use():
        free(instance.fmu.component)
        instance.instantiate()
        instance.initialise(**{"pair.output.inertia": 0.05})
        if instance.two:
            instance.step(0, 3)
        instance.state("free", instance.state("get"))

    for _ in range(50):
        use()
    gc.collect()
    before = resident()
    for _ in range(100):
        use()
    gc.collect()
    assert resident() - before < 100 * 2048  # an instance has more than 20 kB


def resident():
    """Return the memory of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096
