#!/usr/bin/env python3
"""make.py [--command-line] [FOLDER]: ten short walks with pictures, made by the programs themselves in a copy of cases/evie: five
with the command line, five in the window. Writes walks.md and its pictures beside this script (or into FOLDER); a test makes them
again and compares. --command-line: those five alone; the window's stay as they are there.

UNDERBODY_PROGRAM, UNDERBODY_STUDIO: the programs (default: build/release/bin).
"""
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PROGRAM = os.environ.get("UNDERBODY_PROGRAM", str(ROOT / "build/release/bin/underbody"))
STUDIO = os.environ.get("UNDERBODY_STUDIO", str(ROOT / "build/release/bin/underbody-studio"))

# Title, what is read in it, commands, picture.
COMMAND_LINE = [
    ("CFD files to a force table", "Every file whose name fits becomes a row; the table is fitted with its error.",
     ["underbody loads 'fields/ellipse-h{gap:mm}-p{pitch:deg}.csv' --symmetry y --out loads.csv",
      "underbody table fit loads.csv --where pitch=0 --axes gap --quantity lift_force --picture lift.png"], "lift.png"),
    ("A table to a controller", "Where the body floats, how firmly, and the same curve for a microcontroller.",
     ["underbody table equilibria loads.csv --where pitch=0 --axes gap --weight 0.3N",
      "underbody export loads.csv --where pitch=0 --axes gap --format c --number float --max-error 0.5% --out lift.h"], None),
    ("A shape", "The body of a few numbers: what it displaces, how it lies over the ground.",
     ["underbody body shapes/ellipse.toml --gap 5mm --section section.png"], "section.png"),
    ("Where it comes back", "The linear motion about each equilibrium, and the map of all starts.",
     ["underbody linear model.toml",
      "underbody region model.toml --axes gap=1mm:100mm,heave_velocity=-0.02:0.02 --grid 60x60 --out region.png"],
     "region.png"),
    ("What the model lacks", "Measured runs name the effect, and the model with it predicts runs that it has not seen.",
     ["underbody discover heave/model.toml --data heave --out found --quiet",
      "underbody predict found/model.toml --data heave --plot prediction.png"], "prediction.png"),
]
# Title, what is seen, the lines of the log (Commands > Copy all), the workspace whose picture it is.
WINDOW = [
    ("Change a shape", "A bump of 2 mm: volume, clearance and added mass follow, now beside before.",
     ["shape ellipse", "pin", "set 'protrusion.height=2 mm'"], "design"),
    ("Choose among cases", "A range drawn along an axis keeps the cases within it.", ["brush gap=2mm:10mm"], "explore"),
    ("Compare two fields", "One camera and one range for both, seen from below.",
     ["select case/ellipse-h5-p0 case/ellipse-h2-p0", "fields camera=bottom"], "compare"),
    ("Move the net weight", "Equilibria of the table, and what a push they survive.", ["table lift net_weight=0.3N"],
     "tables"),
    ("Where starts end", "The map of starts for the numbers of the model as they are now.", ["workspace stability"],
     "stability"),
]
SIZE = ["--width", "1280", "--height", "800"]
MOST_LINES = {"discover": 4, "linear": 23}  # of what is printed; others 20


def run(words, folder):
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}: {done.stderr}")
    return done.stdout


def command_walks(study, out):
    text = ""
    for number, (title, what, commands, picture) in enumerate(COMMAND_LINE, 1):
        text += f"\n### {number}. {title}\n\n{what}\n"
        for command in commands:
            lines = run([PROGRAM, *shlex.split(command)[1:]], study).rstrip("\n").split("\n")
            most = MOST_LINES.get(command.split()[1], 20)
            if len(lines) > most:
                lines[most:] = ["..."]
            text += f"\n```sh\n{command}\n```\n"
            if lines != [""]:
                text += "\n```text\n" + "\n".join(line.rstrip() for line in lines) + "\n```\n"
        if picture:
            shutil.copy(study / picture, out / picture)
            text += f"\n![{title}]({picture})\n"
    return text


def window_walks(study, out):
    run([PROGRAM, "study", "run", ".", "--quiet"], study)
    log = study.parent / "walks.log"
    log.write_text("\n".join(["open evie", *(line for _, _, lines, _ in WINDOW for line in lines)]) + "\n")
    run([STUDIO, "--replay", log.name, "--screenshot", "shots", *SIZE], study.parent)
    text = ""
    for number, (title, what, lines, workspace) in enumerate(WINDOW, 1):
        picture = f"window-{workspace}.png"
        shutil.copy(study.parent / "shots" / f"{workspace}.png", out / picture)
        text += f"\n### {number}. {title}\n\n{what}\n\n```text\n" + "\n".join(lines) + f"\n```\n\n![{title}]({picture})\n"
    return text


def main():
    words = sys.argv[1:]
    window = "--command-line" not in words
    words = [word for word in words if word != "--command-line"]
    out = pathlib.Path(words[0]) if words else HERE
    with tempfile.TemporaryDirectory() as scratch:
        study = pathlib.Path(scratch) / "evie"
        shutil.copytree(ROOT / "cases" / "evie", study, ignore=shutil.ignore_patterns(".underbody"))
        text = ("# Ten walks\n\nMade by `docs/walks/make.py` from the programs, in a copy of the shipped study; a test makes them "
                "again and compares.\n\n## With the command line\n")
        text += command_walks(study, out)
        head = "\n## In the window"
        if not window:
            there = (out / "walks.md").read_text()
            (out / "walks.md").write_text(text + there[there.index(head):])
            return
        text += (head + "\n\n`underbody-studio cases/evie`; the lines are those of its list of commands, each also done "
                 "with the mouse.\n")
        text += window_walks(study, out)
        (out / "walks.md").write_text(text)


if __name__ == "__main__":
    main()
