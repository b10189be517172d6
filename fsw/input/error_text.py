"""How an error is told on a terminal."""

LONGEST = 1000


def error_text(error: object) -> str:
    """What an error says, on one line that can be read: names in it may hold any character, and any number.

    What is not printable is escaped, and what is longer than ``LONGEST`` is cut in its middle.
    """
    text = str(error)
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)
