"""Executes the notebooks of docs/notebooks, into build/notebooks with their output: a minute or two.

python tools/run_notebooks.py [NAME...]
"""

import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = ROOT / "docs" / "notebooks"
LONGEST_CELL_S = 600


def read(name: str, **parameters: object) -> NotebookNode:
    """A notebook; parameters replace those of its cell with the tag ``parameters``."""
    notebook: NotebookNode = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
    for cell in notebook.cells:
        if parameters and "parameters" in cell.metadata.get("tags", ()):
            cell.source = "\n".join(f"{key} = {value!r}" for key, value in parameters.items())
    return notebook


def execute(notebook: NotebookNode, folder: Path) -> None:
    """Execute it in a folder; it then has its output."""
    resources = {"metadata": {"path": str(folder)}}
    quiet = ["--log-level=ERROR"]  # its warnings are about TCP on 127.0.0.1
    client = NotebookClient(
        notebook, timeout=LONGEST_CELL_S, kernel_name="python3", extra_arguments=quiet, resources=resources
    )
    client.execute()


def main(names: list[str]) -> None:
    there = sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))
    if unknown := sorted(set(names).difference(there)):
        print(f"run_notebooks: no notebook {unknown[0]}, of {', '.join(there)}", file=sys.stderr)
        sys.exit(2)
    folder = ROOT / "build" / "notebooks"
    folder.mkdir(parents=True, exist_ok=True)
    for name in names or there:
        notebook, began = read(name), time.monotonic()
        try:
            execute(notebook, folder)
        except CellExecutionError as error:
            sys.exit(f"{name}: {error}")
        finally:
            nbformat.write(notebook, folder / f"{name}.ipynb")
        print(f"{name}: {time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main(sys.argv[1:])
