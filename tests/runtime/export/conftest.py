"""What the tests of FMUs share: a pair that rattles as an FMU of both kinds, written once for all of them."""

from pathlib import Path

import fmpy
import pytest

from ..instances import Instance
from ..rattling import SCENE, steer


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Make a folder for all of it."""
    return tmp_path_factory.mktemp("fmu")


@pytest.fixture(scope="session")
def pair(folder):
    """Load the pair that rattles."""
    (folder / "rattle.toml").write_text(SCENE)
    return steer(folder / "rattle.toml")


@pytest.fixture(scope="session")
def cs(folder, pair):
    """Write it for co-simulation."""
    pair.write(folder / "cs.fmu")
    return folder / "cs.fmu"


@pytest.fixture(scope="session")
def me(folder, pair):
    """Write it for model exchange."""
    pair.write(folder / "me.fmu", kind="model-exchange")
    return folder / "me.fmu"


@pytest.fixture(scope="session")
def unzipped(cs, me, folder):
    """Unpack both."""
    return {path: Path(fmpy.extract(str(path), str(folder / path.stem))) for path in (cs, me)}


@pytest.fixture
def make(unzipped):
    """Make instances, and free them in the end."""
    made = []

    def maker(path):
        made.append(Instance(path, unzipped[path]))
        return made[-1]

    yield maker
    for instance in made:
        instance.close()
