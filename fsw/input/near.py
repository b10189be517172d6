"""What a user may have meant: the known words nearest to one that is not known."""

from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

LEAST_LIKENESS = 0.65
MOST = 3


def near(word: str, known: Iterable[str]) -> list[str]:
    """The known words similar to ``word``, the most similar first; empty if there is none.

    Case and the choice between ``-`` and ``_`` do not matter. What begins with the word is similar to it.
    """
    plain = {_plain(one): one for one in known}
    found = get_close_matches(_plain(word), plain, MOST, LEAST_LIKENESS)
    begin_alike = [one for one in plain if len(word) > 2 and one.startswith(_plain(word))]
    return [plain[one] for one in dict.fromkeys([*found, *begin_alike])][:MOST]


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """What follows an unknown word: `` (did you mean 'x' or 'y'?)``; empty where nothing is near."""
    words = " or ".join(repr(one) for one in near(word, known))
    return f" (did you mean {words}?)" if words else ""


def toml_files_near(path: Path) -> list[str]:
    """The TOML files beside a file that does not exist, with a similar name; empty if there is none."""
    try:
        beside = {one.stem: str(one) for one in sorted(path.parent.iterdir()) if one.suffix == ".toml"}
    except (OSError, ValueError):  # also of a path that holds a NUL
        return []
    return [beside[stem] for stem in near(path.name.partition(".")[0], beside)]


def _plain(word: str) -> str:
    return word.lower().replace("_", "-")
