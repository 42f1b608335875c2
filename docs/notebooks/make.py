#!/usr/bin/env python3
"""make.py: the journeys of docs/guide/python.md as scripts (NAME.py, cells marked by # %%) and notebooks (NAME.ipynb).

Each stands alone: it works in a copy of the shipped study and begins with what its journey takes from those before it. The page is
the source: change it, run this, and a test finds them equal. `make.py FOLDER` writes elsewhere.
"""
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parent / "guide" / "python.md"

COPY = '''\
import pathlib, os, shutil, tempfile

places = [pathlib.Path(os.environ.get("UNDERBODY_STUDY", "cases/evie")), pathlib.Path("../../cases/evie"),
          pathlib.Path("/usr/share/underbody/cases/evie")]
study_folder = pathlib.Path(tempfile.mkdtemp()) / "evie"
shutil.copytree(next(place for place in places if (place / "study.toml").exists()), study_folder,
                ignore=shutil.ignore_patterns(".underbody"))
os.chdir(study_folder)
'''
IMPORTS = "import numpy\nimport underbody\n"
LOADS = 'underbody.loads("fields/ellipse-h{gap:mm}-p{pitch:deg}.csv", symmetry="y", out="loads.csv")\n'

# The journey's title on the page: its file, and what it takes from the journeys before it.
JOURNEYS = {
    "CFD files to a force table": ("cfd-to-table", ""),
    "A table to numbers": ("table-to-numbers", LOADS),
    "Shape to stability": ("shape-to-stability", ""),
    "Measurements to the missing effect": ("measurements-to-effect", ""),
    "A study": ("study", ""),
    "When something is wrong": ("errors", ""),
}


def journeys():
    """Name and cells, (kind, text), of each."""
    page = PAGE.read_text()
    for section in re.split(r"^## ", page, flags=re.M)[1:]:
        title, _, body = section.partition("\n")
        if title not in JOURNEYS:
            continue
        name, before = JOURNEYS[title]
        cells = [("markdown", f"# {title}\n\nIn a copy of the shipped study, `cases/evie`."), ("code", COPY),
                 ("code", IMPORTS + before)]
        for i, part in enumerate(re.split(r"^```python\n(.*?)^```$", body, flags=re.M | re.S)):
            if part.strip():
                cells.append(("code" if i % 2 else "markdown", part.strip("\n") + ("\n" if i % 2 else "")))
        yield name, cells


def script(cells):
    text = ""
    for kind, cell in cells:
        if kind == "code":
            text += f"# %%\n{cell}\n"
        else:
            text += "# %% [markdown]\n" + "".join(f"# {line}".rstrip() + "\n" for line in cell.split("\n")) + "\n"
    return text.rstrip("\n") + "\n"


def notebook(cells):
    made = []
    for number, (kind, cell) in enumerate(cells):
        one = {"cell_type": kind, "id": f"cell-{number}", "metadata": {},
               "source": cell.rstrip("\n").splitlines(keepends=True)}
        if kind == "code":
            one.update(execution_count=None, outputs=[])
        made.append(one)
    document = {"cells": made, "nbformat": 4, "nbformat_minor": 5,
                "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
                             "language_info": {"name": "python"}}}
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
    for name, cells in journeys():
        (folder / f"{name}.py").write_text(script(cells))
        (folder / f"{name}.ipynb").write_text(notebook(cells))


if __name__ == "__main__":
    main()
