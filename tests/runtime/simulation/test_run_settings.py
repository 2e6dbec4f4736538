"""Settings of a run: as keyword arguments and as one value, they are the same."""

from dataclasses import MISSING, fields

import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import record, simulate, simulate_many
from ltcgear.runtime.simulation.run_settings import RunOptions, RunSettings

from ..models import case


def test_keyword_arguments_are_the_fields_of_the_settings():
    needed = {field.name for field in fields(RunSettings) if field.default is MISSING}
    assert RunOptions.__annotations__.keys() == {field.name for field in fields(RunSettings)}
    assert set(RunOptions.__required_keys__) == needed == {"t_end"}


def test_a_keyword_that_is_none_is_refused(tmp_path):
    c = case("psh")
    calls = (
        lambda **options: simulate(c.library, c.model.values(), **options),
        lambda **options: record(c.library, c.model.values(), tmp_path / "a.nc", **options),
        lambda **options: simulate_many(c.library, [c.model.values()], **options),
    )
    for call in calls:
        with pytest.raises(TypeError, match="tend"):
            call(t_end=0.1, tend=0.1)
        with pytest.raises(TypeError, match="t_end"):
            call()
    assert list(tmp_path.iterdir()) == []


def test_many_runs_are_not_verified_one_by_one():
    c = case("psh")
    with pytest.raises(LtcgearError, match="verify: is for one run"):
        simulate_many(c.library, [c.model.values()], t_end=0.1, verify=True)
