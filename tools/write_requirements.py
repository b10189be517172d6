"""Write docs/requirements.md from the table of requirements; with --check, exit 1 when the file is stale."""

import sys
from pathlib import Path

from sim.fault_table.requirements import document
from sim.record.whole_file import replace_text

TARGET = Path(__file__).resolve().parent.parent / "docs" / "requirements.md"


def main() -> int:
    if "--check" in sys.argv[1:]:
        stale = not TARGET.is_file() or TARGET.read_text(encoding="utf-8") != document()
        if stale:
            print(f"{TARGET} is stale: run tools/write_requirements.py")
        return int(stale)
    replace_text(TARGET, document())
    return 0


if __name__ == "__main__":
    sys.exit(main())
