"""Laws in a message: by kind, none cut in the middle, and how many are not named."""

import re

from fsw.core.laws.entry import Aim
from fsw.core.laws.table import LAWS
from fsw.table.sections import FEW, laws_by_aim


def test_a_few_of_each_kind_are_named_in_their_order():
    aims = {f"law_{number}": Aim.RATE for number in range(FEW + 2)} | {"sun": Aim.SUN}
    assert laws_by_aim(aims) == "rate (law_0, law_1, law_2, law_3, law_4 and 2 more), sun (sun)"


def test_all_that_ship_are_counted():
    text = laws_by_aim({name: entry.aim for name, entry in LAWS.items()})
    kinds = re.findall(r"\w+ \(([^)]*)\)", text)
    more = [int(words.split()[-2]) for words in kinds if words.endswith("more")]
    named = sum(len(words.split(" and ")[0].split(",")) for words in kinds)
    assert named + sum(more) == len(LAWS)
    assert len(text) < 700
