"""What all tests share: a store of their own, so that nothing comes from, or goes to, the user's cache."""

import pytest


@pytest.fixture(autouse=True, scope="session")
def store(tmp_path_factory):
    """Point LTCGEAR_CACHE to a private folder; one for the session, so that each model is compiled once."""
    folder = tmp_path_factory.mktemp("ltcgear-cache")
    folder.chmod(0o700)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LTCGEAR_CACHE", str(folder))
        yield folder
