"""Advice works: whoever does what a message of a function in Python says gets what was asked for."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import simulate
from ltcgear.runtime.analysis import (
    cut,
    find_density,
    find_load_share,
    find_orbit,
    find_order_spectrum,
    find_transmission_error,
    select_output,
    shaft_angle,
)

from .models import case


@pytest.fixture(scope="module")
def lsp():
    """Simulate a planetary stage for a moment."""
    one = case("lsp")
    return simulate(one.library, one.model.values(), t_end=0.05, rate=8192.0)


def force_of(result):
    """Return a mesh force over time."""
    return select_output(result.dataset, f"mesh_force:{MESH}")[0]


def with_gap(result):
    """Return a mesh force that breaks down."""
    return force_of(result).where(result.dataset["time"] < 0.03)


def error_of(result, mesh, *definition):
    """Find the transmission error of a mesh."""
    return find_transmission_error(result.dataset, mesh, *definition)


def without_radii(result, definition):
    """Find a transmission error where the result lacks the parameters."""
    return find_transmission_error(result.dataset.drop_attrs(), MESH, definition)


def turned(result, factor):
    """Find orders over a shaft that turns so much faster."""
    return find_order_spectrum(force_of(result), factor * shaft_angle(result.dataset, "lsp.sun"))


MESH = "lsp.sun_planet.1"
ANALYSES = {
    "whole": (lambda r: find_density(r.dataset["mesh_force"]), "choose one item",
              [lambda r: find_density(force_of(r))]),
    "segments": (lambda r: find_density(force_of(r), segment_s=9.0), "give 0.007813 to 0.05017 s",
                 [lambda r: find_density(force_of(r), segment_s=0.007813),
                  lambda r: find_density(force_of(r), segment_s=0.05017)]),
    "short window": (lambda r: find_density(force_of(r)[:9]), "choose a longer window",
                     [lambda r: find_density(force_of(r)[:64])]),
    "gaps": (lambda r: find_density(with_gap(r)), "choose a window that leaves it out",
             [lambda r: find_density(with_gap(r)[:200])]),
    "group": (lambda r: find_load_share(r.dataset, "lsp.sun"), "there are lsp.sun_planet, lsp.ring_planet",
              [lambda r: find_load_share(r.dataset, "lsp.sun_planet"),
               lambda r: find_load_share(r.dataset, "lsp.ring_planet")]),
    "orbit": (lambda r: find_orbit(r.dataset, "sun"), "there are lsp.", [lambda r: find_orbit(r.dataset, "lsp.sun")]),
    "definition": (lambda r: error_of(r, MESH, "sight"), "one of deflection, angles",
                   [lambda r: error_of(r, MESH, "deflection"), lambda r: error_of(r, MESH, "angles")]),
    "mesh": (lambda r: error_of(r, "lsp"), "there are lsp.sun_planet.1,", [lambda r: error_of(r, MESH)]),
    "radii": (lambda r: without_radii(r, "angles"), "simulate again, or take the deflection",
              [lambda r: error_of(r, MESH, "angles"), lambda r: without_radii(r, "deflection")]),
    "standing": (lambda r: turned(r, 0), "a span in which it turns, or another shaft", [lambda r: turned(r, 99)]),
    "span": (lambda r: cut(r.dataset, 0.04, 0.041), "give 0.007813 s", [lambda r: cut(r.dataset, 0.04, 0.047813)]),
    "item": (lambda r: r.mesh["lsp.sunplanet.1"], f"did you mean '{MESH}'?", [lambda r: r.mesh[MESH]]),
    "quantity": (lambda r: r.mesh[MESH].fource, "it has force,", [lambda r: r.mesh[MESH].force]),
    "kind": (lambda r: r.meshes, "it has dataset, summary, parameters, statistics, mesh,", [lambda r: r.mesh]),
}  # fmt: skip


@pytest.mark.parametrize("name", ANALYSES)
def test_the_cure_that_an_analysis_names_works(lsp, name):
    wrong, told, cures = ANALYSES[name]
    with pytest.raises((LtcgearError, KeyError, AttributeError)) as caught:
        wrong(lsp)
    assert told in str(caught.value.args[0])
    for cure in cures:
        assert cure(lsp) is not None


def valued(change=dict, **options):
    """Simulate a stage with other values for a moment."""
    psh = case("psh")
    return simulate(psh.library, change(psh.model.values()), **{"t_end": 0.002, "rate": 8192.0} | options)


def put(name, value):
    """Simulate a stage with another value."""
    return valued(lambda values: values | {name: value})


def stepped(given):
    """Simulate a stage whose torque follows rows of time and value, or tables made from its own."""
    psh = case("psh", "-loads.output.torque", 'loads.output.torque_over_time = [["0 s", "0 N*m"], ["1 s", "-1 N*m"]]')
    tables = given(psh.model.tables) if callable(given) else dict.fromkeys(psh.model.tables, given)
    return simulate(psh.library, psh.model.values(), t_end=0.002, rate=8192.0, tables=tables)


SHARE, ROWS = "psh.mesh.single_share", "must be rows of time [s] and value"
VALUES = {
    "no names": (lambda: valued(list), "take the model's (model.values())", [valued]),
    "missing": (lambda: valued(lambda values: {SHARE: 0.5}), "begin with the model's values (model.values())",
                [lambda: put(SHARE, 0.5)]),
    "misspelt": (lambda: put(SHARE + "s", 0.5), f'did you mean "{SHARE}"?', [lambda: put(SHARE, 0.5)]),
    "stranger": (lambda: put("zzz", 0.5), "leave it out", [valued]),
    "share": (lambda: put(SHARE, 1.0), "must lie between 0 and 1", [lambda: put(SHARE, 0.99)]),
    "massless": (lambda: put("psh.input.inertia", 0.0), "greater than zero", [lambda: put("psh.input.inertia", 1.0)]),
    "negative": (lambda: put("psh.mesh.stiffness_single", -1.0), "must not be negative",
                 [lambda: put("psh.mesh.stiffness_single", 1e9)]),
    "infinite": (lambda: put("loads.output.torque", np.inf), "a finite number",
                 [lambda: put("loads.output.torque", -9.0)]),
    "rtol": (lambda: valued(rtol=1.0), "must lie between 1e-13 and 0.1", [lambda: valued(rtol=0.1)]),
    "rate": (lambda: valued(rate=0.0), "greater than zero", [lambda: valued(rate=1e4)]),
    "samples": (lambda: valued(t_end=9.0, rate=1e12), "lower t_end or rate", [lambda: valued(t_end=0.01, rate=1e5)]),
    "no tables": (lambda: stepped(lambda tables: {}), "begin with the model's (model.tables)", [lambda: stepped(dict)]),
    "list of tables": (lambda: stepped(list), "take the model's (model.tables)", [lambda: stepped(dict)]),
    "other table": (lambda: stepped(lambda tables: tables | {"z": [(0, 0)]}), "leave it out", [lambda: stepped(dict)]),
    "no rows": (lambda: stepped([1, 2]), ROWS, [lambda: stepped([(0, 1), (1, 2)])]),
    "text": (lambda: stepped([("0 s", 1)]), ROWS, [lambda: stepped([(0, 1)])]),
    "not ascending": (lambda: stepped([(0, 1), (0, 1), (-1, 2)]), "sort the rows, keep one of each",
                      [lambda: stepped([(-1, 2), (0, 1)])]),
    "steep": (lambda: stepped([(0, 1e9), (1e-300, 1)]), "move the rows apart", [lambda: stepped([(0, 1e3), (1, 1)])]),
}  # fmt: skip


@pytest.mark.parametrize("name", VALUES)
def test_the_cure_that_values_need_works(name):
    wrong, told, cures = VALUES[name]
    with pytest.raises(LtcgearError) as caught:
        wrong()
    assert told in str(caught.value)
    for cure in cures:
        assert cure().summary["status"] == "done"
