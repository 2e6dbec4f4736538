"""A store of each test's own, the compiler that is there, and the flags that users have."""

import pytest
from ltcgear.generated import store


@pytest.fixture(autouse=True)
def flags_of_users(shipped_flags):
    """Compile as users do."""


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A store of the test's own."""
    monkeypatch.setenv("LTCGEAR_CACHE", str(tmp_path / "store"))
    return tmp_path / "store"


@pytest.fixture
def compiler():
    found = store.compiler()
    assert found is not None
    return found
