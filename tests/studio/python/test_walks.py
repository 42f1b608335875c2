"""The walks of docs/walks, made again by the programs: the same words, the same numbers, the same pictures but for a little."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

import numpy
import pytest

from conftest import PROGRAM, SOURCE

FOLDER = SOURCE / "docs" / "walks"
STUDIO = pathlib.Path(PROGRAM).parent / "underbody-studio"
NUMBER = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")


def pixels(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader
    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[:, :, :3].astype(float)


def difference(a, b):
    """Share of the blocks of 16 x 16 pixels whose mean colour differs by more than a tenth of the scale."""
    a, b = (one[:one.shape[0] // 16 * 16, :one.shape[1] // 16 * 16] for one in (a, b))
    blocks = [one.reshape(one.shape[0] // 16, 16, one.shape[1] // 16, 16, 3).mean(axis=(1, 3)) for one in (a, b)]
    return numpy.mean(numpy.abs(blocks[0] - blocks[1]).max(axis=2) > 25.5)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    if not STUDIO.exists():
        pytest.skip("skipped: underbody-studio is not built")
    if shutil.which("Xvfb") is None:
        pytest.skip("skipped: Xvfb is not installed")
    folder = tmp_path_factory.mktemp("walks")
    # The window looks for a display by itself: the one that ctest names for other tests draws no fields.
    own = {name: value for name, value in os.environ.items() if name != "QT_QPA_PLATFORM"}
    done = subprocess.run([sys.executable, FOLDER / "make.py", folder], capture_output=True, text=True,
                          env={**own, "UNDERBODY_PROGRAM": PROGRAM, "UNDERBODY_STUDIO": str(STUDIO)})
    assert done.returncode == 0, done.stderr
    return folder


def test_words_and_numbers(made):
    there, again = ((folder / "walks.md").read_text() for folder in (FOLDER, made))
    hint = "run docs/walks/make.py and look at what changed"
    assert NUMBER.sub("#", there) == NUMBER.sub("#", again), hint
    old, new = (numpy.array([float(word) for word in NUMBER.findall(text)]) for text in (there, again))
    assert numpy.allclose(old, new, rtol=0.05, atol=1e-6), hint
    assert there.count("\n### ") == 10


def test_pictures(made):
    pytest.importorskip("vtkmodules", reason="skipped: the Debian package python3-vtk9 is not installed")
    names = sorted(path.name for path in FOLDER.glob("*.png"))
    assert names == sorted(path.name for path in made.glob("*.png")) and len(names) >= 9
    for name in names:
        there, again = pixels(FOLDER / name), pixels(made / name)
        assert there.shape == again.shape, name
        assert difference(there, again) < (0.1 if name.startswith("window") else 0.03), \
            f"{name}: run docs/walks/make.py and look at what changed"
    # The measure tells pictures apart.
    windows = [pixels(FOLDER / name) for name in names if name.startswith("window")]
    assert difference(windows[0], windows[1]) > 0.15
