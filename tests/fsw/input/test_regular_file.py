"""Only regular files are read, and no more of them than they are allowed to hold."""

import os
from pathlib import Path

import pytest

from fsw.input.regular_file import read_regular


def fault(path, most_bytes=10):
    try:
        read_regular(path, most_bytes)
    except OSError as error:
        return error.strerror
    return pytest.fail("it was read")


def test_the_content(tmp_path):
    (tmp_path / "a").write_bytes(b"0123456789")
    assert read_regular(tmp_path / "a", 10) == b"0123456789"


def test_a_byte_too_many(tmp_path):
    (tmp_path / "a").write_bytes(b"0123456789a")
    assert fault(tmp_path / "a") == "it is larger than 1e-05 MB"


def test_what_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "zero").symlink_to("/dev/zero")
    assert fault(tmp_path / "pipe") == fault(tmp_path / "zero") == "it is no regular file"
    assert fault(tmp_path) == "Is a directory"
    assert fault(tmp_path / "none") == "No such file or directory"
    assert fault(tmp_path / ("x" * 300)) == "File name too long"
    assert fault(Path("a\0b")) == "there is a NUL in its name"
