"""What a notebook shows of a result: what ``print`` does."""

from html import escape


class PrintedResult:
    """A result that a notebook shows as text."""

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"
