"""FMUs give back all memory, and touch none that is not theirs."""

import gc
from pathlib import Path

import pytest


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
