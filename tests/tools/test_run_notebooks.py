"""The notebooks: stored without output, and the shortest of them runs."""

import nbformat
import pytest
import run_notebooks

NAMES = sorted(path.stem for path in run_notebooks.NOTEBOOKS.glob("*.ipynb"))


def code_of(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


@pytest.mark.parametrize("name", NAMES)
def test_it_is_valid_and_has_no_output(name):
    notebook = run_notebooks.read(name)
    nbformat.validate(notebook)
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code_of(notebook))
    assert sum("parameters" in cell.metadata.get("tags", ()) for cell in notebook.cells) == 1


@pytest.mark.long
@pytest.mark.slow
def test_the_first_flight_runs(tmp_path):
    notebook = run_notebooks.read("first_flight", ORBITS=0.1)
    run_notebooks.execute(notebook, tmp_path)
    outputs = [output for cell in code_of(notebook) for output in cell.outputs]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 3
    text = "".join(output.text for output in outputs if output.output_type == "stream")
    assert "microsat, seed 2: 604 s flown" in text
    assert "bit-exact: 604 ticks" in text
    assert not any(output.get("name") == "stderr" for output in outputs)


def test_a_notebook_that_is_not_there_is_one_sentence(capsys):
    with pytest.raises(SystemExit) as ended:
        run_notebooks.main(["first_fligth"])
    assert ended.value.code == 2
    assert "no notebook first_fligth, of " in capsys.readouterr().err
