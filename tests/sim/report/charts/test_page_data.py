"""What the script of the report is given."""


def test_the_data_are_those_of_the_flight(page):
    data = page.data
    assert data["time"]["end_s"] == 7000.0
    assert data["time"]["eclipses"] == [[1000.0, 3000.0]]
    lanes = data["charts"]["modes"]["panels"][0]["lanes"]
    assert {lane["label"]: lane["spans_s"] for lane in lanes} == {
        "SAFE": [], "DETUMBLE": [], "ACQUIRE": [[0.0, 3500.0]], "POINT": [[3500.0, 7000.0]],
    }  # fmt: skip
    assert {"zoom", "gaps_and_levels", "track"}.isdisjoint(data["charts"])


def test_pulses_are_shown_by_levels_and_their_dipoles(page):
    motion = page.data["motion"]
    assert motion["levels_am2"] == sorted(motion["levels_am2"])
    assert len(motion["levels_am2"]) == 3
    assert motion["m_am2"] == "", "a continuous driver alone is shown by its histories"
