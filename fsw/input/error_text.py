"""The text of an error on a terminal."""

LONGEST = 1000


def error_text(error: object) -> str:
    """The text of an error on one readable line: names in it may hold any characters, and any number of them.

    What is not printable is escaped, and what is longer than ``LONGEST`` is cut in its middle.
    """
    text = str(error)
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)
