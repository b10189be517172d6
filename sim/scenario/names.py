"""Names that become part of a path, and cannot contain another path."""

import re
from typing import Annotated

from pydantic import AfterValidator

ALLOWED = "letters, digits, '.', '_' and '-', at most 100 of them, and neither '.' nor '-' first"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]{0,99}")


def is_name(text: str) -> bool:
    """Whether a text may be part of a path."""
    return _NAME.fullmatch(text) is not None


def _check(text: str) -> str:
    if not is_name(text):
        raise ValueError(f"{text[:100]!r} is not allowed: allowed are {ALLOWED}")
    return text


Name = Annotated[str, AfterValidator(_check)]
"""A text of a scenario that becomes part of a path, or may."""
