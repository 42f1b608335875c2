"""The guide's page runs: its blocks one after the other, in a copy of the shipped study."""
import re
import shutil

import pytest

from conftest import SOURCE


@pytest.mark.filterwarnings("ignore::Warning")
def test_the_guide_runs(tmp_path, monkeypatch, capsys):
    pytest.importorskip("vtkmodules", reason="the Debian package python3-vtk9 is not installed")
    folder = tmp_path / "evie"
    shutil.copytree(SOURCE / "cases" / "evie", folder, ignore=shutil.ignore_patterns(".underbody"))
    monkeypatch.chdir(folder)
    page = (SOURCE / "docs" / "guide" / "python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.S | re.M)
    assert len(blocks) >= 7
    names = {}
    for block in blocks:
        line = page[:page.index(block)].count("\n")
        exec(compile("\n" * line + block, "docs/guide/python.md", "exec"), names)
    assert (folder / "out" / "index.html").exists() and (folder / "lift.h").exists()
    assert names["after"].channels.gap.rmse < names["before"].channels.gap.rmse
