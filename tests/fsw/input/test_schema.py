"""Values from TOML: laid over each other, checked, and every fault told in one sentence."""

from typing import Annotated, Literal

import pytest
from pydantic import Field, Strict

from fsw.input.schema import (
    NotNegative,
    Positive,
    Section,
    Square,
    TableError,
    Triple,
    merge,
    read_toml,
    validated,
)


class Deep(Section):
    share: float = Field(default=0.5, ge=0.0, le=1.0)
    rows: Square = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Inner(Section):
    count: int = Field(ge=1, le=9)
    length_m: Positive
    angle_deg: float = Field(default=0.0, ge=-180.0, lt=180.0)
    on: bool = False
    name: str = "x"
    axes: Triple = (1.0, 0.0, 0.0)
    kind: Literal["round", "square"] = "round"
    deep: Deep = Deep()
    pair: Annotated[tuple[str, str] | None, Strict(False)] = None
    spare: Deep | None = None
    ratio: Annotated[float, Field(gt=0.0)] | None = None
    code: Annotated[str, Field(pattern="^[a-f]{2}$")] = "aa"
    places: Annotated[tuple[float, ...], Strict(False), Field(min_length=1, max_length=2)] = (0.0,)


class Outer(Section):
    inner: Inner
    weight: NotNegative = 0.0


GOOD = {"inner": {"count": 3, "length_m": 2.5, "axes": [1, 2.5, -3]}}


def fault(**inner):
    with pytest.raises(TableError) as caught:
        validated(Outer, merge(GOOD, {"inner": inner}), "file.toml")
    return str(caught.value)


class TestMerge:
    def test_lays_values_over_section_by_section(self):
        base = {"a": 1, "s": {"x": 1, "y": 2, "t": {"u": 1}}}
        assert merge(base, {"s": {"y": 3, "t": {"v": 2}}, "b": 4}) == {
            "a": 1,
            "b": 4,
            "s": {"x": 1, "y": 3, "t": {"u": 1, "v": 2}},
        }

    def test_lists_are_values_and_replaced_whole(self):
        assert merge({"a": [1, 2, 3]}, {"a": [4]}) == {"a": [4]}

    def test_a_value_replaces_a_section_and_a_section_a_value(self):
        assert merge({"a": {"b": 1}}, {"a": 2}) == {"a": 2}
        assert merge({"a": 2}, {"a": {"b": 1}}) == {"a": {"b": 1}}

    def test_leaves_both_as_they_were(self):
        base, over = {"s": {"x": 1}}, {"s": {"y": 2}}
        merge(base, over)
        assert (base, over) == ({"s": {"x": 1}}, {"s": {"y": 2}})


class TestValidated:
    def test_good_values(self):
        outer = validated(Outer, GOOD, "file.toml")
        assert (outer.inner.count, outer.inner.length_m, outer.weight) == (3, 2.5, 0.0)
        assert outer.inner.axes == (1.0, 2.5, -3.0)

    def test_whole_numbers_serve_as_numbers(self):
        outer = validated(Outer, merge(GOOD, {"inner": {"length_m": 2}}), "file.toml")
        assert outer.inner.length_m == 2.0

    COUNT = "a whole number at least 1 and at most 9"

    @pytest.mark.parametrize(
        ("key", "value", "allowed"),
        [
            ("count", 10, COUNT),
            ("count", "3", COUNT),
            ("count", 3.0, COUNT),
            ("count", True, COUNT),
            ("length_m", 0.0, "a number above 0"),
            ("length_m", "2", "a number above 0"),
            ("length_m", True, "a number above 0"),
            ("length_m", float("nan"), "a number above 0"),
            ("length_m", float("inf"), "a number above 0"),
            ("angle_deg", 180, "a number at least -180 and below 180"),
            ("on", 1, "true or false"),
            ("on", "true", "true or false"),
            ("name", 5, "a text"),
            ("axes", 5, "a list"),
        ],
    )
    def test_one_sentence_names_file_key_value_and_what_is_allowed(self, key, value, allowed):
        assert (
            fault(**{key: value})
            == f"file.toml: inner.{key} = {value!r} is not allowed: allowed is {allowed}"
        )

    @pytest.mark.parametrize(
        ("inner", "sentence"),
        [
            ({"axes": [1, 2]}, "inner.axes.2 is missing"),
            ({"axes": [1, "2", 3]}, "inner.axes.1 = '2' is not allowed: allowed is a number"),
            ({"pair": ["a", 2]}, "inner.pair.1 = 2 is not allowed: allowed is a text"),
        ],
    )
    def test_the_place_in_a_list_is_named_too(self, inner, sentence):
        assert fault(**inner) == f"file.toml: {sentence}"

    def test_an_unknown_key(self):
        assert fault(size=3) == "file.toml: inner.size is not a known key"

    def test_a_choice(self):
        assert (
            fault(kind="oval")
            == "file.toml: inner.kind = 'oval' is not allowed: allowed is 'round' or 'square'"
        )

    @pytest.mark.parametrize(
        ("inner", "key", "value", "allowed"),
        [
            ({"spare": {"share": 1.5}}, "spare.share", "1.5", "a number at most 1"),
            ({"spare": {"share": -1}}, "spare.share", "-1", "a number at least 0"),
            ({"ratio": 0.0}, "ratio", "0.0", "a number above 0"),
            ({"ratio": float("nan")}, "ratio", "nan", "a finite number"),
            ({"code": "xx"}, "code", "'xx'", "a text that matches ^[a-f]{2}$"),
            ({"places": []}, "places", "[]", "a list of at least 1"),
            ({"places": [1, 2, 3]}, "places", "[1, 2, 3]", "a list of at most 2"),
        ],
    )
    def test_what_may_be_left_out_and_what_has_a_length_is_told_in_the_same_words(
        self, inner, key, value, allowed
    ):
        assert fault(**inner) == f"file.toml: inner.{key} = {value} is not allowed: allowed is {allowed}"

    def test_a_section_within_a_section(self):
        assert fault(deep={"share": 1.5}) == (
            "file.toml: inner.deep.share = 1.5 is not allowed: allowed is a number at least 0 and at most 1"
        )

    def test_rows_of_numbers(self):
        rows = [[1, 2, 3], [4, 5, 6], [7, 8, 9.5]]
        outer = validated(Outer, merge(GOOD, {"inner": {"deep": {"rows": rows}}}), "file.toml")
        assert outer.inner.deep.rows == ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (7.0, 8.0, 9.5))

    @pytest.mark.parametrize("weight", [-0.5, float("nan"), float("inf"), "0"])
    def test_a_quantity_that_cannot_be_negative(self, weight):
        with pytest.raises(TableError, match=r"weight = .* is not allowed: allowed is a number at least 0"):
            validated(Outer, merge(GOOD, {"weight": weight}), "file.toml")
        assert validated(Outer, merge(GOOD, {"weight": 0.5}), "file.toml").weight == 0.5

    def test_a_missing_key(self):
        with pytest.raises(TableError) as caught:
            validated(Outer, {"inner": {"count": 3}}, "file.toml")
        assert str(caught.value) == "file.toml: inner.length_m is missing"

    def test_a_value_where_a_section_should_be(self):
        with pytest.raises(TableError) as caught:
            validated(Outer, {"inner": 5}, "file.toml")
        assert str(caught.value) == "file.toml: inner = 5 is not allowed: allowed is a section of keys"

    def test_all_faults_are_told_at_once(self):
        sentence = fault(count=0, length_m=-1.0, extra=1)
        assert sentence.startswith("file.toml: ")
        assert sentence.count(";") == 2
        for key in ("inner.count", "inner.length_m", "inner.extra"):
            assert key in sentence

    def test_a_checked_value_cannot_be_changed(self):
        outer = validated(Outer, GOOD, "file.toml")
        with pytest.raises(ValueError, match="frozen"):
            outer.weight = 1.0


class TestReadToml:
    def test_reads(self, tmp_path):
        file = tmp_path / "a.toml"
        file.write_text("[s]\nx = 1 # one\n", encoding="utf-8")
        assert read_toml(file) == {"s": {"x": 1}}

    @pytest.mark.parametrize("content", [b"x = = 1\n", b"x = 1\nx = 2\n", b"[s\n", "a\u00a0= 1".encode()])
    def test_what_is_not_toml_is_told_with_its_name(self, tmp_path, content):
        file = tmp_path / "a.toml"
        file.write_bytes(content)
        with pytest.raises(TableError, match="not TOML") as caught:
            read_toml(file)
        assert str(file) in str(caught.value)

    def test_missing(self, tmp_path):
        with pytest.raises(TableError, match=r"a\.toml: cannot be read \(No such file or directory\)"):
            read_toml(tmp_path / "a.toml")

    def test_of_a_missing_file_a_similar_one_beside_it_is_named(self, tmp_path):
        (tmp_path / "my3u.toml").touch()
        with pytest.raises(TableError) as caught:
            read_toml(tmp_path / "my3.toml")
        assert str(caught.value) == (
            f"{tmp_path}/my3.toml: cannot be read (No such file or directory); "
            f"did you mean {tmp_path}/my3u.toml?"
        )

    def test_a_folder(self, tmp_path):
        with pytest.raises(TableError, match="cannot be read"):
            read_toml(tmp_path)


@pytest.mark.parametrize(
    ("values", "asked"),
    [
        ({"range_km": 550_000.0}, "; is it in km?"),
        ({"range_km": 1e9}, ""),
        ({"range_km": 40_001.0}, ""),
        ({"other": 550_000.0}, ""),
    ],
)
def test_a_number_that_may_be_in_a_smaller_unit_is_asked_for_it(values, asked):
    class Orbit(Section):
        range_km: float = Field(default=1.0, le=40_000.0)
        other: float = Field(default=1.0, le=40_000.0)

    with pytest.raises(TableError) as caught:
        validated(Orbit, values, "x")
    assert str(caught.value).endswith(f"allowed is a number at most 40000{asked}")
