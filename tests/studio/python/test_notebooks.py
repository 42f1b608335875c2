"""The journeys of the guide as scripts and notebooks: made of the page as it is, and they run.

Their cells are run by Python itself. Where nbclient and ipykernel are installed, Jupyter runs the notebooks as well.
"""
import json
import os
import pathlib
import subprocess
import sys

import pytest

from conftest import SOURCE

FOLDER = SOURCE / "docs" / "notebooks"
NAMES = sorted(path.stem for path in FOLDER.glob("*.ipynb"))


def test_they_are_those_of_the_page(tmp_path):
    subprocess.run([sys.executable, FOLDER / "make.py", tmp_path], check=True)
    made = {path.name: path.read_text() for path in tmp_path.iterdir()}
    there = {path.name: path.read_text() for path in FOLDER.iterdir() if path.suffix in (".py", ".ipynb")}
    del there["make.py"]
    assert made == there, "docs/guide/python.md has changed: run docs/notebooks/make.py"
    assert len(NAMES) >= 6


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Somewhere else, with the shipped study where scripts look for it; they go to a copy of it by themselves."""
    monkeypatch.setenv("UNDERBODY_STUDY", str(SOURCE / "cases" / "evie"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.filterwarnings("ignore::Warning")
def test_the_cells_run(name, here, capsys):
    document = json.loads((FOLDER / f"{name}.ipynb").read_text())
    if any("vtkmodules" in "".join(cell["source"]) for cell in document["cells"]):
        pytest.importorskip("vtkmodules", reason="the Debian package python3-vtk9 is not installed")
    names = {}
    for cell in document["cells"]:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), f"{name}.ipynb, {cell['id']}", "exec"), names)
    assert pathlib.Path.cwd().name == "evie" and pathlib.Path.cwd().is_relative_to(here)
    assert capsys.readouterr().out


def test_a_script_runs_by_itself(here):
    done = subprocess.run([sys.executable, "-W", "ignore", FOLDER / "table-to-numbers.py"], capture_output=True,
                          text=True, env=os.environ)
    assert done.returncode == 0, done.stderr
    assert "(1000000,)" in done.stdout


@pytest.mark.parametrize("name", NAMES)
def test_jupyter_runs_them(name, here):
    nbclient = pytest.importorskip("nbclient", reason="skipped: python3-nbclient is not installed")
    pytest.importorskip("ipykernel", reason="skipped: python3-ipykernel is not installed")
    nbformat = pytest.importorskip("nbformat", reason="skipped: python3-nbformat is not installed")
    document = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    nbformat.validate(document)
    nbclient.NotebookClient(document, timeout=120, resources={"metadata": {"path": str(here)}}).execute()
    assert any(cell.get("outputs") for cell in document.cells)
