#!/usr/bin/env python3
"""Runs settled cases of `underbody design run` on until they are twice as long, and says how far their loads move.

    python3 twice_as_long.py design/results.csv OUT.csv design/runs/draft/NAME-h5-p1-u0.5 ...

Each case is copied, run to twice its iterations with its own settings and compared: mean of the last 50 iterations then
and now against the standard deviation that results.csv states (`NAME_sigma`). Needs OpenFOAM 1912.
"""
import csv
import glob
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile


def history(case):
    """[iteration, lift, drag, nose-up moment about the base's centre] of the whole body, from the half's files."""
    def rows(name):
        found = {}
        for file in sorted(glob.glob(case + "/postProcessing/forces/*/" + name)):
            for line in open(file):
                if not line.startswith("#"):
                    numbers = [float(t) for t in line.replace("(", " ").replace(")", " ").split()]
                    found[numbers[0]] = numbers
        return found
    forces, moments = rows("force.dat"), rows("moment.dat")
    return [(t, 2 * f[3], -2 * f[1], -2 * moments[t][2]) for t, f in sorted(forces.items()) if t in moments]


def mean(rows, column, count=50):
    values = [r[column] for r in rows[-count:]]
    return sum(values) / len(values)


def stated(results, case):
    """Sigmas of lift, drag and moment of the run whose folder is `case`."""
    name, gap, pitch = re.match(r"(.+)-h([\d.]+)-p(-?[\d.]+)-", os.path.basename(case)).groups()
    for row in csv.DictReader(open(results), skipinitialspace=True):
        if row["design"] == name and float(row["gap [mm]"]) == float(gap) and float(row["pitch [deg]"]) == float(pitch):
            return [float(row[q]) for q in ("lift_force_sigma [N]", "drag_force_sigma [N]", "pitch_moment_sigma [N m]")]
    sys.exit(f"{results} has no run of {case}")


def longer(case):
    """The histories of a case as it ended, and run on to twice its iterations."""
    before = history(case)
    with tempfile.TemporaryDirectory() as scratch:
        copy = os.path.join(scratch, "case")
        shutil.copytree(case, copy, symlinks=True)
        if os.path.exists(copy + "/settled"):
            os.remove(copy + "/settled")
        control = open(copy + "/system/controlDict").read()
        with open(copy + "/system/controlDict", "w") as file:
            file.write(re.sub(r"\bendTime \d+", f"endTime {int(2 * before[-1][0])}", control))
        subprocess.run(["./Allrun", "solve"], cwd=copy, check=True, stdout=subprocess.DEVNULL)
        return before, history(copy)


def main():
    results, out, cases = sys.argv[1], sys.argv[2], sys.argv[3:]
    fresh = not os.path.exists(out)
    with open(out, "a") as file:
        if fresh:
            file.write("case, iterations [1], longer_iterations [1], lift_force [N], longer_lift_force [N], lift_force_sigma "
                       "[N], drag_force [N], longer_drag_force [N], drag_force_sigma [N], pitch_moment [N m], "
                       "longer_pitch_moment [N m], pitch_moment_sigma [N m], moved_of_resultant [1]\n")
        for case in cases:
            sigmas = stated(results, case)
            before, after = longer(case.rstrip("/"))
            cells = [os.path.basename(case.rstrip("/")), f"{before[-1][0]:.0f}", f"{after[-1][0]:.0f}"]
            for column in (1, 2, 3):
                cells += [f"{mean(before, column):.6g}", f"{mean(after, column):.6g}", f"{sigmas[column - 1]:.3g}"]
            moved = max(abs(mean(after, c) - mean(before, c)) for c in (1, 2))
            cells.append(f"{moved / math.hypot(mean(before, 1), mean(before, 2)):.3g}")
            file.write(", ".join(cells) + "\n")
            file.flush()


main()
