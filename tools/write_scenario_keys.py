"""Write docs/scenario-keys.md and docs/scenario.schema.json from the schema of scenarios.

With --check, exit 1 when one is stale.
"""

import sys
from pathlib import Path

from sim.record.whole_file import replace_text
from sim.scenario.keys.editor_schema import as_text
from sim.scenario.keys.page import page

DOCS = Path(__file__).resolve().parent.parent / "docs"


def documents() -> dict[Path, str]:
    return {
        DOCS / "scenario-keys.md": page(),
        DOCS / "scenario.schema.json": as_text(),
    }


def main() -> int:
    stale = 0
    for path, text in documents().items():
        if "--check" not in sys.argv[1:]:
            replace_text(path, text)
        elif not path.is_file() or path.read_text(encoding="utf-8") != text:
            print(f"{path} is stale: run tools/write_scenario_keys.py")
            stale = 1
    return stale


if __name__ == "__main__":
    sys.exit(main())
