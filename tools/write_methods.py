"""Write docs/methods.md from methods and docs/validation.json; with --check, exit 1 when it is stale."""

import sys
from pathlib import Path

from sim.methods import page, read_methods
from sim.record.whole_file import replace_text
from sim.validate.outcomes import as_figures, read_record

DOCS = Path(__file__).resolve().parent.parent / "docs"
TARGET = DOCS / "methods.md"


def main() -> int:
    text = page(read_methods(), as_figures(read_record(DOCS / "validation.json")))
    if "--check" in sys.argv[1:]:
        stale = not TARGET.is_file() or TARGET.read_text(encoding="utf-8") != text
        if stale:
            print(f"{TARGET} is stale: run tools/write_methods.py")
        return int(stale)
    replace_text(TARGET, text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
