"""Text files that may be compressed: whole, growing, cut and damaged."""

import gzip
import os

import pytest

from fsw.input.gzip_text import is_compressed, last_member, open_text, stored

LINES = b"".join(b"line %d of the file\n" % number for number in range(20_000))


def members(text, size):
    """The text as members of so many bytes of it each."""
    return b"".join(gzip.compress(text[at : at + size], 1, mtime=0) for at in range(0, len(text), size))


@pytest.mark.parametrize("size", [1, 1000, len(LINES)])
def test_what_is_read_is_the_text_of_all_members(tmp_path, size):
    text = LINES[:5000] if size == 1 else LINES
    path = tmp_path / "a.log.gz"
    path.write_bytes(members(text, size))
    with open_text(path) as file:
        assert file.read() == text
        assert file.read() == b""
    with open_text(path) as file:
        assert b"".join(iter(lambda: file.readline(200), b"")) == text


def test_a_plain_file_is_read_as_it_is(tmp_path):
    path = tmp_path / "a.log"
    path.write_bytes(members(LINES, 1000))
    with open_text(path) as file:
        assert file.read() == path.read_bytes()
    assert not is_compressed(path)


def test_the_gzip_of_a_shell_is_read_too(tmp_path):
    """With name and time in its header, and another level."""
    path = tmp_path / "a.log.gz"
    with gzip.GzipFile(path, "wb", 9, mtime=1_700_000_000) as file:
        file.write(LINES)
    with open_text(path) as file:
        assert file.read() == LINES


def test_a_growing_file_is_read_on(tmp_path):
    path, whole = tmp_path / "a.log.gz", members(LINES, 3000)
    path.write_bytes(b"")
    read = b""
    with path.open("ab") as writer, open_text(path) as reader:
        for at in range(0, len(whole), 777):
            writer.write(whole[at : at + 777])
            writer.flush()
            while piece := reader.read(500):
                read += piece
    assert read == LINES


@pytest.mark.long
def test_a_cut_file_is_read_as_far_as_it_goes(tmp_path):
    path, whole = tmp_path / "a.log.gz", members(LINES[:6000], 2000)
    read = []
    for size in range(len(whole)):
        path.write_bytes(whole[:size])
        with open_text(path) as file:
            read.append(file.read())
    assert all(LINES.startswith(text) for text in read)
    assert read == sorted(read, key=len)
    assert read[-1] == LINES[:6000], "the last byte is of a check"


@pytest.mark.parametrize(
    "content",
    [b"plain text\n", members(LINES, 1000) + b"more", b"\x00" * 50, members(LINES, 99)[:-6] + b"damage"],
)
def test_damage_is_an_error_that_says_so(tmp_path, content):
    path = tmp_path / "a.log.gz"
    path.write_bytes(content)
    with open_text(path) as file, pytest.raises(OSError, match="its compressed text is damaged"):
        file.read()


@pytest.mark.long
def test_of_a_text_that_would_fill_the_memory_only_what_is_asked_for_is_unpacked(tmp_path):
    path = tmp_path / "a.log.gz"
    path.write_bytes(gzip.compress(b"0" * 300_000_000, 9))
    with open_text(path) as file:
        assert file.readline(1000) == b"0" * 1000
        assert os.lseek(file.fileno(), 0, os.SEEK_CUR) < 200_000


def test_a_pipe_is_not_opened(tmp_path):
    os.mkfifo(tmp_path / "a.log.gz")
    with pytest.raises(OSError, match="no regular file"):
        open_text(tmp_path / "a.log.gz")


def test_the_last_member_is_found_in_the_tail(tmp_path):
    whole = members(LINES, 3000)
    last = LINES[len(LINES) // 3000 * 3000 :]
    assert last_member(whole[-4000:]) == last
    assert last.startswith(last_member(whole[-4000:-30]))
    assert (
        last_member(b"")
        == last_member(b"plain text\n")
        == last_member(b"\x1f\x8b\x08" + bytes(5) + b"xx")
        == b""
    )


def test_of_both_forms_the_plain_one_is_taken(tmp_path):
    plain, compressed = tmp_path / "bus.log", tmp_path / "bus.log.gz"
    assert stored(plain) == plain
    compressed.write_bytes(b"")
    assert stored(plain) == compressed
    plain.write_bytes(b"")
    assert stored(plain) == plain
