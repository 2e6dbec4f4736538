"""The advice of messages about sweeps: what they say one should write is written, and works."""

import re
import shlex

import pytest
from ltcgear.generated.errors import LtcgearError, SolverError
from ltcgear.runtime import sweep
from ltcgear.runtime.studies.sweep import planning
from ltcgear.runtime.studies.sweep.design import draw_design
from ltcgear.runtime.studies.sweep.sweep_axes import EXAMPLE, read_axes, read_axis
from ltcgear.symbolic import Template

SPEED = "loads.ring.speed=5 rpm:20 rpm"


def refused(*texts, sample="grid", points=None, seed=0):
    """What is said where these are refused."""
    with pytest.raises(LtcgearError) as caught:
        draw_design(read_axes(texts), sample, points, seed)
    return str(caught.value)


def test_the_example_of_axes_is_one():
    assert EXAMPLE in refused("speed")
    [example] = shlex.split(EXAMPLE.split("such as ")[1])
    assert draw_design([read_axis(example)]).size == 11


def test_ranges_without_points_get_them_either_way():
    message = refused(SPEED)
    text, options = re.search(r"write (.*), or draw them with (.*)$", message).groups()
    assert draw_design(read_axes(shlex.split(text))).size == 11
    sample, points = re.fullmatch(r"--sample (\w+) --points (\d+)", options).groups()
    assert draw_design(read_axes([SPEED]), sample, int(points)).size == 100


@pytest.mark.parametrize(
    ("message", "mended", "options"),
    [
        (refused("a=20:5:4"), "a=5:20:4", {}),  # give the lower bound first
        (refused("a=5 rpm:20:4"), "a=5 rpm:20 rpm:4", {}),  # write both in the same
        (refused("a=5:6:1"), "a=5:6:2", {}),  # give 2 points at least
        (refused("a=5:6:1"), "a=5", {}),  # or the value alone
        (refused("a=1,,2"), "a=1,2", {}),
        (refused("a=1,1.0"), "a=1", {}),  # give each value once
        (refused("a=1:2:3", sample="lhs", points=4), "a=1:2:3", {}),  # leave --sample out
        (refused("a=1:2:3", sample="lhs", points=4), "a=1:2", {"sample": "lhs", "points": 4}),  # or write NAME=a:b
        (refused("a=1:2:3", sample="saltelli", points=4), "a=1:2", {"sample": "saltelli", "points": 4}),
        (refused("a=1:2", sample="lhs"), "a=1:2", {"sample": "lhs", "points": 128}),  # such as --points 128
        (refused("a=1:2:3", points=4), "a=1:2:4", {}),  # write NAME=a:b:n
        (refused("a=1:0", sample="normal", points=4), "a=1:0.5", {"sample": "normal", "points": 4}),
    ],
)
def test_what_a_refusal_says_one_should_write_is_taken(message, mended, options):
    assert re.search("[;?] ", message)
    assert draw_design(read_axes([mended]), **options).size


def test_a_key_of_all_points_is_given_by_the_options_named(tmp_path):
    vary, target = ["simulation.t_end=0.01 s:0.02 s:2"], tmp_path / "a.nc"
    with pytest.raises(LtcgearError, match=r"give --t-end, or --set simulation.t_end=\.\.\."):
        sweep(Template("lsp"), vary, target)
    scene = Template("lsp", {"simulation.t_end": "0.02 s"})
    assert sweep(scene, ["loads.ring.speed=5 rpm"], target, workers=1)["failed"] == 0


def test_where_no_end_can_begin_the_reason_is_told_and_a_rate_helps(tmp_path, monkeypatch):
    def failing(*arguments):
        raise SolverError("no equilibrium was found")

    scene = tmp_path / "mine.toml"
    scene.write_text(re.sub(r"(?m)^rate = .*$", "", Template("lsp").text))
    monkeypatch.setattr(planning, "find_rate", failing)
    with pytest.raises(LtcgearError, match=r"can begin \(no equilibrium was found\), so no sampling rate") as caught:
        sweep(Template(scene), [SPEED + ":2"], tmp_path / "a.nc", t_end=0.02, workers=1)
    [given] = shlex.split(re.search(r"--set (.*), or", str(caught.value))[1])
    key, _, value = given.partition("=")
    assert sweep(Template(scene, {key: value}), [SPEED + ":2"], tmp_path / "a.nc", t_end=0.02, workers=1)["failed"] == 0
