"""Text as people save it is read; what is odd in it is said with its line."""

import codecs

import pytest

from fsw.input.text_file import read_text, text_of

TEXT = 'name = "Grüße 衛星"\r\nsecond = 2\n'


@pytest.mark.parametrize(
    ("mark", "codec"),
    [
        (b"", "utf-8"),
        (codecs.BOM_UTF8, "utf-8"),
        (codecs.BOM_UTF16_LE, "utf-16-le"),
        (codecs.BOM_UTF16_BE, "utf-16-be"),
        (codecs.BOM_UTF32_LE, "utf-32-le"),
        (codecs.BOM_UTF32_BE, "utf-32-be"),
    ],
)
def test_every_way_to_save_it_is_read(tmp_path, mark, codec):
    path = tmp_path / "x.toml"
    path.write_bytes(mark + TEXT.encode(codec))
    assert read_text(path, 1000) == TEXT


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (TEXT.replace("衛星", "").encode("latin-1"), "line 1 is not UTF-8 text: byte 0xFC, which is 'ü' in"),
        (b"a\nb\nc\x8d", "line 3 is not UTF-8 text: byte 0x8D; save the file as UTF-8"),
        (TEXT.encode("utf-16-le"), "it is no text: there are NULs in it"),
        ("a\nb = 1".encode("utf-16-le"), "line 1 holds a NUL: it is no text, or UTF-16 without its mark"),
        (codecs.BOM_UTF16_LE + b"abc", "it begins with the mark of UTF-16-LE, and is cut or damaged"),
        (b"\x7fELF\x02\xff\0", "it is no text"),
    ],
)
def test_what_is_odd_is_said_in_words(content, said):
    with pytest.raises(OSError, match=said) as caught:
        text_of(content)
    assert "codec" not in caught.value.strerror


def test_letters_that_do_not_matter_are_passed_over():
    assert text_of("Größe\n1 2".encode("latin-1"), odd_letters=True).endswith("\n1 2")


def test_its_size_has_a_bound(tmp_path):
    path = tmp_path / "x"
    path.write_text("abcd")
    with pytest.raises(OSError, match="larger than"):
        read_text(path, 3)
