"""What the tests of the Python module share: the program to compare with, and a copy of the shipped study."""
import json
import os
import pathlib
import shutil
import subprocess

import pytest

SOURCE = pathlib.Path(os.environ.get("UNDERBODY_SOURCE", pathlib.Path(__file__).parents[3]))
PROGRAM = os.environ.get("UNDERBODY_PROGRAM", str(SOURCE / "build" / "release" / "bin" / "underbody"))


class Program:
    """The command line."""

    def __init__(self, folder):
        self.folder = folder

    def run(self, *words):
        return subprocess.run([PROGRAM, *map(str, words)], cwd=self.folder, capture_output=True, text=True)

    def json(self, *words):
        done = self.run(*words, "--json")
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    def sentence(self, *words):
        """What an error says, without the program's name and the word before it."""
        done = self.run(*words)
        assert done.returncode in (2, 3), done.stdout
        lines = [line for line in done.stderr.splitlines() if not line.startswith("underbody: warning: ")]
        return "\n".join(lines).split(": ", 2)[2].rstrip("\n")


@pytest.fixture(scope="session")
def evie(tmp_path_factory):
    """A copy of the shipped study; tests of this run share it and do not change what it ships."""
    folder = tmp_path_factory.mktemp("evie") / "evie"
    shutil.copytree(SOURCE / "cases" / "evie", folder, ignore=shutil.ignore_patterns(".underbody"))
    return folder


@pytest.fixture
def program(evie, monkeypatch):
    monkeypatch.chdir(evie)
    return Program(evie)


@pytest.fixture(scope="session")
def data():
    return SOURCE / "tests" / "data"
