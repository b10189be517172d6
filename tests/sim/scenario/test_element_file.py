"""Element files are read as people have them, or refused in one sentence that says what is odd and where.

``TORQUER_ELEMENT_FILES=200`` makes the seeded test as long as that.
"""

import codecs
import csv
import io
import json
import os
from math import dist
from random import Random

import pytest
from recorded_samples import TLE
from sgp4 import omm
from sgp4.api import Satrec

from fsw.core.orbit.propagation import sgp4_orbit, state_eci
from fsw.core.orbit.tle import UNIX_EPOCH_JD, read_tle
from fsw.input.schema import TableError
from fsw.table.table import flight_table
from sim.errors import HarnessError
from sim.scenario.element_file import check_one_satellite, nearest_elements, read_element_file

FILES = int(os.environ.get("TORQUER_ELEMENT_FILES", "40"))
LINES = (
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
)
TEXT = "\n".join(LINES) + "\n"
DAY_500 = (
    "1 42680U 16049E   17500.50000000  .00000218  00000-0  80444-4 0  9993",
    "2 42680  98.3668 218.4259 0018140 186.3838 173.7123 14.41455213 48482",
)
OMM = {
    "OBJECT_NAME": "ISS (ZARYA)",
    "OBJECT_ID": "1998-067A",
    "EPOCH": "2025-12-11T13:21:59.411232",
    "MEAN_MOTION": 15.49,
    "ECCENTRICITY": 0.0003,
    "INCLINATION": 51.63,
    "RA_OF_ASC_NODE": 160.1,
    "ARG_OF_PERICENTER": 200.1,
    "MEAN_ANOMALY": 159.9,
    "EPHEMERIS_TYPE": 0,
    "CLASSIFICATION_TYPE": "U",
    "NORAD_CAT_ID": 25544,
    "ELEMENT_SET_NO": 999,
    "REV_AT_EPOCH": 54000,
    "BSTAR": 0.0002,
    "MEAN_MOTION_DOT": 0.0001,
    "MEAN_MOTION_DDOT": 0,
}


def as_csv(fields):
    out = io.StringIO()
    writer = csv.DictWriter(out, fields)
    writer.writeheader()
    writer.writerow(fields)
    return out.getvalue()


def as_xml(fields):
    inside = "".join(f"<{key}>{value}</{key}>" for key, value in fields.items())
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<ndm><omm><body><segment><data><meanElements>'
        f"{inside}</meanElements></data></segment></body></omm></ndm>"
    )


def as_kvn(fields):
    return "CCSDS_OMM_VERS = 2.0\n" + "".join(f"{key} = {value}\n" for key, value in fields.items())


FORMS = {
    "json": lambda fields: json.dumps([fields]),
    "one json": json.dumps,
    "csv": as_csv,
    "xml": as_xml,
    "kvn": as_kvn,
}


@pytest.fixture
def read(tmp_path):
    def read_content(content):
        path = tmp_path / "x.txt"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_element_file(path)

    return read_content


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_an_omm_is_the_orbit_that_sgp4_makes_of_it(read, form):
    (found,) = read(form(OMM))
    assert (found.name, found.satellite) == ("ISS (ZARYA)", "25544")
    expected = Satrec()
    omm.initialize(expected, {key: str(value) for key, value in OMM.items()})
    for hours in (0.0, 10.0):
        unix_s = 86400.0 * (expected.jdsatepoch - UNIX_EPOCH_JD + expected.jdsatepochF) + 3600.0 * hours
        _, r_km, _ = expected.sgp4(UNIX_EPOCH_JD + unix_s // 86400.0, unix_s % 86400.0 / 86400.0)
        r_m, _ = state_eci(sgp4_orbit(*found.lines), unix_s)
        assert dist(r_m, [1e3 * x for x in r_km]) < 5.0


@pytest.mark.parametrize(
    ("number", "in_lines"),
    [(5, "00005"), (100_000, "A0000"), (270_123, "T0123"), (339_999, "Z9999"), (799_500_123, "00000")],
)
def test_catalogue_numbers_beyond_the_fifth_digit(read, number, in_lines):
    (found,) = read(json.dumps(OMM | {"NORAD_CAT_ID": number}))
    assert found.lines[0][2:7] == found.lines[1][2:7] == in_lines


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"EPOCH": "soon"}, "EPOCH is 'soon': a time like"),
        ({"EPOCH": "2090-01-01T00:00:00"}, "EPOCH is in 2090: elements are of 1957 to 2056"),
        ({"MEAN_MOTION": ""}, "MEAN_MOTION is missing"),
        ({"INCLINATION": 198.0}, "INCLINATION is 198: from 0 to 180 is allowed"),
        ({"ECCENTRICITY": "x"}, "ECCENTRICITY is 'x', which is no number"),
        ({"MEAN_ELEMENT_THEORY": "DSST"}, "MEAN_ELEMENT_THEORY is 'DSST': it has to be SGP4"),
        ({"REF_FRAME": "ITRF"}, "REF_FRAME is 'ITRF': it has to be TEME"),
    ],
)
def test_what_is_wrong_in_an_omm_is_named_by_its_keyword(read, changed, said):
    with pytest.raises(HarnessError, match=f"x.txt: OMM, message 1: {said}"):
        read(as_kvn(OMM | changed))


@pytest.mark.parametrize("epoch", ["2025-345T13:21:59.411232", "2025-12-11T13:21:59.411232Z"])
def test_an_epoch_may_be_written_in_either_form_of_its_standard(read, epoch):
    assert read(json.dumps(OMM | {"EPOCH": epoch})) == read(json.dumps(OMM))


def test_the_last_moment_of_a_year_stays_in_it(read):
    (found,) = read(json.dumps(OMM | {"EPOCH": "2025-12-31T23:59:59.999999"}))
    assert found.lines[0][18:32] == "25365.99999999"


@pytest.mark.parametrize(
    "content",
    [
        codecs.BOM_UTF8 + TEXT.encode(),
        codecs.BOM_UTF16_LE + TEXT.encode("utf-16-le"),
        codecs.BOM_UTF16_BE + TEXT.encode("utf-16-be"),
        f"ITÜPSAT 衛星\n{TEXT}",
        f"GRÖSSE\n{TEXT}".encode("latin-1"),
        TEXT.replace(" ", "\u00a0"),
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("\n", "   \n"),
        TEXT.lower(),
        f"# of a friend\n\n0 ITAMSAT\n\n{TEXT}\n\n",
    ],
)
def test_lines_are_read_as_people_save_them(read, content):
    (found,) = read(content)
    assert found.lines == LINES


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "there is no two-line element set in it, nor an OMM"),
        (LINES[0], "after line 1 its second element line is missing"),
        (LINES[0][:-3] + "\n" + LINES[1], "line 1 is no element line of 69 characters"),
        ("\n".join(DAY_500), "line 1: element line 1 has day 500 of the year, and year 17 has 365"),
        ('{"a": 1}', "OMM, message 1: EPOCH is missing"),
        ("[1]", "JSON, and no OMM"),
        ('[{"EPOCH"', "an OMM in JSON that cannot be read"),
        ("<html><body></body></html>", "XML, and no OMM: there is no segment in it"),
        ("<a", "an OMM in XML that cannot be read"),
        ("[" * 100_000, "an OMM in JSON that cannot be read"),
    ],
)
def test_what_cannot_be_read_is_said(read, content, said):
    with pytest.raises(HarnessError, match=said):
        read(content)


def test_sets_of_several_satellites_are_named(read, tmp_path):
    found = read(json.dumps([OMM, OMM | {"NORAD_CAT_ID": 7, "OBJECT_NAME": "OTHER"}]))
    with pytest.raises(HarnessError, match=r"of 2 satellites \(00007 OTHER, 25544 ISS \(ZARYA\)\): keep one"):
        check_one_satellite(tmp_path / "x", found)


def checksum(line):
    return sum(int(letter) if letter in "0123456789" else letter == "-" for letter in line[:68]) % 10


def with_oddity(random):
    """The bytes of an element file with one thing odd in it."""
    fields = OMM | {"NORAD_CAT_ID": random.randrange(1, 10**9)}
    key = random.choice([*OMM, "REF_FRAME"])
    odd_value = random.choice(["", "nan", "1e400", "-1", "ä", None, "9" * 5000, [1], {}, "\0", "2025-02-30"])
    row, place = random.randrange(2), random.randrange(69)
    lines = list(LINES)
    letter = random.choice(["\u00a0", "x", "-", " ", ".", "9", "\u200b", "\t", "²", "\x1b", "\u2028", "−"])
    lines[row] = lines[row][:place] + letter + lines[row][place + 1 :]
    if random.random() < 0.5:
        lines = [line[:68] + str(checksum(line)) for line in lines]
    text = random.choice(["\n", "\r\n", "\r", "\n\n", "\u2028"]).join(lines)
    form = random.choice(list(FORMS.values()))
    kinds = {
        "a letter": text,
        "a name": f"{''.join(chr(random.randrange(32, 0x2FFF)) for _ in range(20))}\n{TEXT}",
        "cut": TEXT[: random.randrange(len(TEXT))],
        "swapped": "\n".join(LINES[::-1]),
        "twice": TEXT * random.randrange(2, 5),
        "a value": form({**fields, key: odd_value}),
        "no key": form({name: value for name, value in fields.items() if name != key}),
        "cut omm": form(fields)[: random.randrange(1, 300)],
    }
    content = kinds[random.choice(list(kinds))].encode(errors="replace")
    codec = random.choice(["", "", "utf-8-sig", "utf-16", "utf-32", "utf-16-le", "latin-1"])
    return content.decode().encode(codec, errors="replace") if codec else content


def read_or_refused(read, content):
    try:
        return read(content), ""
    except HarnessError as error:
        return [], str(error)


def judged(one):
    """Why such elements are not flown, in one sentence; empty if they are."""
    try:
        flight_table({"orbit": {"tle": one.lines}}, "x")
    except TableError as error:
        return str(error)
    return ""


def test_a_file_with_one_oddity_is_read_or_refused_in_one_sentence(read):
    """What is read are lines that hold by themselves."""
    random, sets, refused = Random(56), 0, 0
    for _ in range(FILES):
        content = with_oddity(random)
        found, said = read_or_refused(read, content)
        refused += not found
        sets += len(found)
        assert "codec" not in said, content
        assert "\n" not in said, content
        for one in found:
            assert read_tle(*one.lines).error == 0
            assert "\n" not in judged(one)
    assert sets > 0
    assert refused > 0


# --- Of many element sets the nearest is taken, whatever stands between them

TWO_LINES = TLE.read_text().splitlines()
OTHER = (
    "1 25544U 98067A   20062.59097222  .00016717  00000-0  10270-3 0  9003",
    "2 25544  51.6442 147.1064 0004607  95.6506 329.8285 15.49249062  2422",
)


@pytest.mark.parametrize(
    ("unix_s", "epoch"), [(1702e6, 1702321485), (1711e6, 1710438527), (1800e6, 1713270618)]
)
def test_the_nearest_is_taken(unix_s, epoch):
    found = nearest_elements(TLE, unix_s)
    assert found.epoch_unix_s == pytest.approx(epoch, abs=90000)
    assert found.age_days(found.epoch_unix_s + 86400.0 * 1.5) == 1.5
    distances = [
        abs(nearest_elements(TLE, other).epoch_unix_s - unix_s) for other in (1702e6, 1711e6, 1800e6)
    ]
    assert abs(found.epoch_unix_s - unix_s) == min(distances)


def test_names_comments_and_blank_lines_do_not_matter(tmp_path):
    path = tmp_path / "tle.txt"
    path.write_text(
        "# sets\n\nSAT A\n" + "\n".join(TWO_LINES[1:3]) + "\n\n0 SAT A\n" + "\n".join(TWO_LINES[4:6])
    )
    assert nearest_elements(path, 1711e6).epoch_unix_s == nearest_elements(TLE, 1711e6).epoch_unix_s


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "there is no two-line element set in it"),
        (TWO_LINES[1:2], "after line 1 its second element line is missing"),
        ([TWO_LINES[1][:-1] + "0", TWO_LINES[2]], "line 1: element line 1 has checksum 0 but adds up to 7"),
        ([*TWO_LINES[1:3], *OTHER], "it holds sets of 2 satellites (25544, 52191): keep one"),
        ([TWO_LINES[1][:-3], TWO_LINES[2]], "line 1 is no element line of 69 characters"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path, lines, said):
    path = tmp_path / "tle.txt"
    path.write_text("\n".join(lines))
    with pytest.raises(HarnessError) as error:
        nearest_elements(path, 1712e6)
    assert said in str(error.value)


def test_a_missing_file_is_said_to_be_so(tmp_path):
    with pytest.raises(HarnessError, match="cannot be read"):
        nearest_elements(tmp_path / "none.txt", 0.0)
