"""The span of a record that is analysed, and the public names of the room."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    cut,
    select_output,
)
from ltcgear.runtime.analysis.span import speed_change

from ..outputs import result, times
from ..synthetic import make_dataset

TIME = times()


def test_spans_are_cut_to_the_second_half_or_as_asked():
    dataset = make_dataset()
    assert cut(dataset)["time"].values[0] == pytest.approx(2.0, abs=1e-3)
    part = cut(dataset, 0.5, 1.0)["time"].values
    assert (part[0], part[-1]) == (0.5, 1.0)


def test_statistics_along_the_motion_belong_to_the_span_they_were_taken_over():
    end = float(make_dataset()["time"].values[-1])
    dataset = make_dataset().assign(
        statistics=(("statistic", "output"), np.zeros((5, 1)), {"from_s": 2.0, "to_s": end})
    )
    assert "statistics" in cut(dataset)
    assert "statistics" not in cut(dataset, 2.0, 3.0)
    assert "statistics" not in cut(dataset, 1.0)
    assert "statistics" not in cut(dataset, 3.0)
    for told in ({}, {"from_s": "soon", "to_s": end}, {"from_s": 2.0}):
        dataset["statistics"].attrs = told
        assert "statistics" not in cut(dataset)


@pytest.mark.parametrize(
    ("span", "message"),
    [
        ((-1.0, 2.0), "the record runs from 0 s to 3.9"),
        ((1.0, 9.0), "the record runs from"),
        ((2.0, 1.0), "the first before the second"),
        ((float("nan"), 1.0), "the record runs from"),
        ((1.0, 1.001), r"9 samples, 64 at least are needed; give 0\.007813 s or more"),
    ],
)
def test_spans_outside_the_record_are_refused(span, message):
    with pytest.raises(LtcgearError, match=message):
        cut(make_dataset(), *span)


def test_samples_that_are_no_numbers_are_refused_with_where_they_begin():
    dataset = make_dataset()
    broken = dataset.assign(
        mesh_force=dataset["mesh_force"].where((dataset["time"] < 3.0) | (dataset["mesh"] != "psh.mesh"))
    )
    with pytest.raises(LtcgearError, match=r"mesh_force:psh.mesh: not a number from 3 s on; .* --to 2\.9998"):
        cut(broken)
    assert cut(broken, 1.0, 2.99)["time"].values[-1] == pytest.approx(2.99, abs=1e-3)


def test_a_change_of_speed_is_seen():
    assert speed_change(make_dataset()) == pytest.approx(0.0)
    ramp = result(TIME, speed={"a": 10.0 * TIME, "b": 1.0})
    assert speed_change(ramp) == pytest.approx(0.8 / 0.9, rel=1e-2)
    assert speed_change(result(TIME, mesh_force={"lsp.sun_planet.1": 1.0})) == 0.0


def test_every_public_name_is_there():
    from ltcgear.runtime import analysis

    for name in analysis.__all__:
        assert callable(getattr(analysis, name))
    assert select_output is analysis.select_output
    with pytest.raises(AttributeError, match="nothing"):
        _ = analysis.nothing
