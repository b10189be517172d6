"""TOML is read within bounds of size, depth and magnitude; what is beyond them is told in a clause."""

import time
import tomllib

import pytest

from fsw.input.toml_text import LEAST, MOST, MOST_BYTES, MOST_LEVELS, BoundsError, load_toml, parse_toml

DEEP = 50_000


def fault(text):
    with pytest.raises(BoundsError) as caught:
        parse_toml(text)
    return str(caught.value)


def test_what_is_within_the_bounds_is_what_python_reads():
    text = 'a.b = 1\n[c]\nd = [1.5, {e = "a.b"}]\n[[f]]\ng = 1979-05-27T07:32:00Z\nh = -0.0\ni = [inf, nan]\n'
    assert repr(parse_toml(text)) == repr(tomllib.loads(text))


def test_what_is_not_toml_is_said_by_python():
    with pytest.raises(tomllib.TOMLDecodeError):
        parse_toml("a = = 1")


@pytest.mark.parametrize("text", ["[" * DEEP, "[" * 400 + "]" * 400, "{a = " * DEEP + "1" + "}" * DEEP])
def test_nesting_has_an_end(text):
    assert fault(f"a = {text}") == f"it is nested deeper than {MOST_LEVELS} levels"


def test_as_deep_as_allowed_and_a_level_more():
    assert parse_toml("a = " + "[" * MOST_LEVELS + "]" * MOST_LEVELS)
    assert "nested deeper" in fault("a = " + "[" * (MOST_LEVELS + 1) + "]" * (MOST_LEVELS + 1))


@pytest.mark.parametrize("part", ["a", '"a.b"', "'a b'", "a-1"])
@pytest.mark.parametrize("line", ["{} = 1", "[{}]", "[[{}]]", "x = {{{} = 1}}"])
def test_so_has_a_key(part, line):
    began = time.process_time()
    assert fault(line.format(" . ".join([part] * DEEP))) == f"a key has more than {MOST_LEVELS} parts"
    assert parse_toml(line.format(".".join([part] * (MOST_LEVELS - 2))))
    assert time.process_time() - began < 2.0


DOTTED = ".".join(["a"] * 40)


@pytest.mark.parametrize(
    "text",
    [
        f"a = 1  # {DOTTED}",
        f'a = "{DOTTED}"',
        f"a = '{DOTTED}'",
        f'a = """\n{DOTTED} = 1\n"""',
        f"a = '''\n{DOTTED} = 1\n'''",
        f'a = "\\"{DOTTED}"',
        f'a = """\\"""{DOTTED}""""\nb = """"c"""""',
        f"a = ''''{DOTTED}'''''",
        f"# an apostrophe's\na = 1 # {DOTTED}",
    ],
)
def test_texts_and_comments_are_no_keys(text):
    assert parse_toml(text) == tomllib.loads(text)


@pytest.mark.parametrize(
    "before",
    [
        'a = """x""""\n',
        "a = '''x'''''\n",
        'a = "#"\n',
        'a = "\\\\"\n',
        "# it's\n",
        'a = """\\""""""\n',
        "a = 'x\\'\n",
        'a = ""\n',
    ],
)
def test_a_long_key_after_a_text_is_found(before):
    assert tomllib.loads(before) is not None
    assert "parts" in fault(f"{before}{DOTTED} = 1")


PIECES = ['\\"', '"""\\', '"', "'''x", "a.", "a .", "\\", '"\\', "'", "a.'"]


@pytest.mark.parametrize("piece", PIECES)
def test_a_text_of_any_kind_is_read_once(piece):
    began = time.process_time()
    with pytest.raises((tomllib.TOMLDecodeError, BoundsError)):
        parse_toml("a = " + piece * (MOST_BYTES // len(piece) // 4))
    assert time.process_time() - began < 3.0


@pytest.mark.parametrize("number", ["9" * 6000, "-" + "9" * 6000])
def test_digits_are_counted(number):
    assert fault(f"a = {number}").startswith(
        "an integer is not allowed: a number is 0, or from 1e-18 to 1e+15"
    )


@pytest.mark.parametrize(
    "number", ["1e16", "-1e16", "1e308", "1e-19", "5e-324", "10000000000000000", "0xfffffffffffffffff"]
)
def test_a_number_beyond_all_quantities_is_named(number):
    assert fault(f"[s]\na = [0.0, {{b = {number}}}]").startswith("s.a.1.b is not allowed: a number is 0, or")


@pytest.mark.parametrize("number", [0, 0.0, LEAST, -LEAST, MOST, -MOST, 1, True, float("inf")])
def test_the_bounds_themselves_are_allowed(number):
    assert parse_toml(f"a = {str(number).lower()}")["a"] == number


def test_a_file(tmp_path):
    (tmp_path / "a.toml").write_text("a = 1\n")
    assert load_toml(tmp_path / "a.toml") == {"a": 1}
    (tmp_path / "a.toml").write_text("#" * (MOST_BYTES + 1))
    with pytest.raises(OSError, match="larger than 1 MB"):
        load_toml(tmp_path / "a.toml")


@pytest.mark.parametrize("codec", ["utf-8-sig", "utf-16"])
def test_a_file_as_editors_save_it(tmp_path, codec):
    (tmp_path / "a.toml").write_bytes('a = "Grüße"\r\n'.encode(codec))
    assert load_toml(tmp_path / "a.toml") == {"a": "Grüße"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = 1\na\u00a0= 1", "at line 2, column 2): U+00A0, no-break space, stands there"),
        ("a = \u22121", "U+2212, minus sign, stands there"),
        ("a = \u201cb\u201d", "U+201C, left double quotation mark, stands there"),
    ],
)
def test_a_character_that_looks_like_another_is_named(text, said):
    with pytest.raises(tomllib.TOMLDecodeError) as caught:
        parse_toml(text)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("[1.0, 2.2e-19, 0.0]", [1.0, 0.0, 0.0]),
        ("[[1.0, 2.2e-19], [-2.2e-19, 1]]", [[1.0, 0.0], [0.0, 1]]),
        ("[1e-3, 1e-18]", [1e-3, 1e-18]),
    ],
)
def test_what_rounding_has_left_of_zero_beside_larger_numbers_is_zero(text, value):
    assert parse_toml(f"a = {text}") == {"a": value}


@pytest.mark.parametrize("text", ["2.2e-19", "[2.2e-19, 1e-6]", "[[1.0], [{b = 2.2e-19}]]", "[1.0, 1e16]"])
def test_a_number_of_its_own_is_no_residue(text):
    assert "is not allowed: a number is 0, or from" in fault(f"a = {text}")
