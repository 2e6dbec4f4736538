"""Train of a result, from its attribute ``train``."""

import json
from dataclasses import asdict
from functools import lru_cache
from typing import TYPE_CHECKING

from ltcgear.generated.contract import BACK

from ..model.members import PLANET, Joint, Train, TrainMember

if TYPE_CHECKING:
    import xarray as xr

TRAIN = "train"


def write_train(train: Train) -> str:
    """Return a train as the text of the attribute."""
    return json.dumps(asdict(train))


def read_train(dataset: "xr.Dataset") -> Train:
    """Return the train of a result, or of a span of it."""
    if TRAIN in dataset.attrs:
        return _read(dataset.attrs[TRAIN])
    names = (str(name) for index in dataset.indexes.values() if index.dtype.kind in "OU" for name in index)
    return _by_names(tuple(dict.fromkeys(names)))


@lru_cache(maxsize=32)
def _read(text: str) -> Train:
    """Read the attribute."""
    found = json.loads(text)
    members = {name: TrainMember(**(one | {"place": tuple(one["place"])})) for name, one in found["members"].items()}
    return Train(members, {name: Joint(**one) for name, one in found["joints"].items()})


def _group_of(name: str) -> str:
    """Return what equal items share by their names alone: all but the number."""
    head, _, tail = name.rpartition(".")
    return head if tail.isdigit() else name


@lru_cache(maxsize=32)
def _by_names(names: tuple[str, ...]) -> Train:
    """Return the train given by names of items:  ``stage.part``, ``stage.planet.1``, ``stage.kind.1``, ``stage.mesh``.

    For older files, and data that ltcgear did not write, this is all that is known.
    """
    members, joints = {}, {}
    for name in names:
        stage, dot, rest = name.partition(".")
        part = rest.partition(".")[0]
        held = f"{stage}.pin" if part == PLANET else f"{name}.bearing"
        group = _group_of(name)
        members[name] = TrainMember(stage if dot else "", part, f"{group}.mass", (f"{name}.x_0", f"{name}.y_0"), held)
        if dot:
            joints[name] = Joint(stage, group, name.removesuffix(BACK))
    return Train(members, joints)
