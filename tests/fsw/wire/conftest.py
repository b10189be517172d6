from pathlib import Path

import cantools
import pytest

import fsw.wire


@pytest.fixture(scope="session")
def dbc():
    """The DBC as cantools, the second implementation, reads it."""
    return cantools.database.load_file(Path(fsw.wire.__file__).with_name("torquer.dbc"))
