"""The text that a terminal is given: names and values in it may come from anyone's files."""

LONGEST = 1000


def error_text(error: object) -> str:
    """The text of an error on one readable line: names in it may hold any characters, and any number of them.

    What is not printable is escaped, and what is longer than ``LONGEST`` is cut in its middle.
    """
    text = str(error)
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"
    return line_text(text)


def line_text(text: str) -> str:
    """A text on one line, in which what is not printable is escaped.

    That is any control character, of both sets, any mark that changes the direction of writing, and what is
    no character. None of them can move the cursor, colour or rewrite what stands on a terminal.
    """
    if text.isprintable():
        return text
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)


def lines_text(text: str) -> str:
    """The same of a text of several lines, which stay lines."""
    return "\n".join(map(line_text, text.split("\n")))
