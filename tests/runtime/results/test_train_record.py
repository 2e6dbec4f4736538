"""Trains by their models, by the files of results, and by names alone."""

from dataclasses import replace

import pytest
import xarray as xr
from ltcgear.generated.contract import BACK, Connection, Manifest, RigidBody
from ltcgear.runtime.model.members import Train, train_of, unite_trains
from ltcgear.runtime.results.dataset import make_dataset
from ltcgear.runtime.results.samples import no_rows
from ltcgear.runtime.results.train_record import TRAIN, read_train, write_train

from ..models import case


def body(name, stage, part):
    return RigidBody(name, stage, part, "", ("place x", "place y"), "", f"mass of {name}", "")


def mesh(name, group, *bodies, back=False):
    return Connection(name, group, "mesh", name, bodies, back=back)


BODIES = (body("A", "epi", "sun"), body("B", "epi", "planet"), body("C", "epi", "carrier"), body("D.E", "", "rotor"))
CONNECTIONS = (
    mesh("first", "suns", "A", "B"), mesh("behind", "suns", "A", "B", back=True),
    Connection("P", "pins", "pin", "P", ("C", "B")), Connection("Q", "borne", "bearing", "A", ("A",)),
)  # fmt: skip


@pytest.fixture
def train():
    """A train whose names tell nothing of what they are."""
    manifest = Manifest("", "rest", (), (), (), (), {}, "", bodies=BODIES, connections=CONNECTIONS)
    return train_of(manifest)


def check(train):
    assert [train.stage(name) for name in ("A", "first", "behind", "P", "suns", "D.E", "else")] == [
        "epi", "epi", "epi", "epi", "epi", "D.E", "else",
    ]  # fmt: skip
    named = [train.group(name) for name in ("first", "behind", "P", "A", "B")]
    assert named == ["suns", "behind", "pins", "A", "epi.planet"]
    assert [train.front(name) for name in ("first", "behind", "else")] == ["first", "first", "else"]
    assert [name for name in train.members if train.is_planet(name)] == ["B"]
    assert [name for name in train.members if train.is_geared(name)] == ["A", "B", "C"]
    assert [train.label(name) for name in train.members] == ["A", "epi planets", "C", "D.E"]
    assert (train.part("epi", "carrier"), train.part("epi", "ring")) == ("C", "")
    assert [one.held for one in train.members.values()] == ["borne", "pins", "", ""]
    assert (train.members["A"].mass, train.members["A"].place) == ("mass of A", ("place x", "place y"))


def test_a_model_tells_what_names_do_not(train):
    check(train)


def test_a_result_tells_it_too(train):
    check(read_train(xr.Dataset(attrs={TRAIN: write_train(train)})))


def test_what_a_run_leaves_tells_its_train():
    c = case("lin-parker-3")
    assert read_train(make_dataset(c.library, c.p, no_rows(c.library))) == train_of(c.library.manifest)


def test_older_files_are_read_by_names():
    items = {"mesh": ["s.sun_planet.1", f"s.sun_planet.1{BACK}", "t.mesh"], "member": ["s.planet.2", "s.sun", "motor"]}
    train = read_train(xr.Dataset(coords=items))
    assert [train.stage(name) for name in ("s.sun_planet.1", "s.sun_planet", "s.sun", "motor")] == ["s"] * 3 + ["motor"]
    assert [train.group(name) for name in items["mesh"]] == ["s.sun_planet", f"s.sun_planet.1{BACK}", "t.mesh"]
    assert train.front(f"s.sun_planet.1{BACK}") == "s.sun_planet.1"
    assert [train.is_planet(name) for name in items["member"]] == [True, False, False]
    assert train.members["s.planet.2"] == replace(
        train.members["s.planet.2"], mass="s.planet.mass", held="s.pin", place=("s.planet.2.x_0", "s.planet.2.y_0")
    )
    assert read_train(xr.Dataset()) == Train()


def test_a_sweep_without_its_train_is_read_by_names():
    items = {"mesh": ["lsp.sun_planet.3", "psh.mesh"], "member": ["motor", "lsp.planet.2"], "point": [0, 1]}
    train = read_train(xr.Dataset(coords=items))
    assert [train.group(name) for name in (*items["mesh"], *items["member"])] == [
        "lsp.sun_planet", "psh.mesh", "motor", "lsp.planet",
    ]  # fmt: skip
    assert "0" not in train.members  # points are no members


def test_variants_of_a_train_are_united(train):
    other = Train({"F": train.members["B"]}, {"third": train.joints["first"]})
    united = unite_trains([train, other])
    assert set(united.members) == {*train.members, "F"}
    assert united.group("third") == united.group("first") == "suns"
