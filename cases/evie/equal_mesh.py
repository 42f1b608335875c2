#!/usr/bin/env python3
"""Cases of forces.csv computed again by `underbody` at the same density of mesh: loads beside loads, into equal_mesh.csv.

    python3 equal_mesh.py --list              what was compared, and what was not
    python3 equal_mesh.py ellipse-h5-p0       computes one (FOLDER of fields/ without .csv) and adds its row
    python3 equal_mesh.py --take CASE NAME    the same from a case that is solved

Needs `underbody` on the PATH and OpenFOAM 1912. A row agrees when lift and drag differ by at most 3 % of the resultant, or by
twice what the case scatters by.
"""
import csv
import glob
import json
import math
import os
import subprocess
import sys
import tempfile

here = os.path.dirname(os.path.abspath(__file__))
table = os.path.join(here, "equal_mesh.csv")
columns = ["case", "mesh", "cells [1]", "cells_there [1]", "iterations [1]", "lift_force [N]", "lift_there [N]", "drag_force [N]",
           "drag_there [N]", "lift_difference [%]", "drag_difference [%]", "allowed [%]", "agrees", "reason"]
flanks = "another body: flanks cut otherwise (ORIGIN.md)"


def read(file):
    with open(file, newline="") as text:
        return list(csv.DictReader(text, skipinitialspace=True))


def name_of(row):
    return os.path.basename(row["file"])[:-4]


def means(case):
    """Lift and drag of the whole body, N, means of the last 50 iterations, and the last iteration."""
    rows = {}
    for file in sorted(glob.glob(f"{case}/postProcessing/forces/*/force.dat"), key=lambda f: int(f.split("/")[-2])):
        for line in open(file):
            if not line.startswith("#"):
                numbers = [float(t) for t in line.replace("(", " ").replace(")", " ").split()]
                rows[numbers[0]] = numbers
    last = [rows[t] for t in sorted(rows)][-50:]
    return 2 * sum(r[3] for r in last) / len(last), -2 * sum(r[1] for r in last) / len(last), int(last[-1][0])


def take(case, row):
    lift, drag, iterations = means(case)
    there = float(row["lift_force [N]"]), float(row["drag_force [N]"])
    resultant = math.hypot(*there)
    allowed = max(3, 200 * max(float(row["lift_force_scatter [N]"]), float(row["drag_force_scatter [N]"])) / resultant)
    differences = [100 * (a - b) / resultant for a, b in zip((lift, drag), there)]
    agrees = max(map(abs, differences)) <= allowed
    cells = json.load(open(f"{case}/constant/mesh.json"))["cells"]
    other = row["variant"] != "ellipse"
    new = [name_of(row), row["mesh"], cells, row["cells [1]"], iterations, f"{lift:.5f}", there[0], f"{drag:.5f}", there[1],
           *(f"{d:.2f}" for d in differences), f"{allowed:.2f}", "yes" if agrees else "no",
           flanks if other else "-" if agrees else "not known"]
    is_new = not os.path.exists(table)
    with open(table, "a", newline="") as file:
        if is_new:
            file.write(", ".join(columns) + "\n")
        file.write(", ".join(map(str, new)) + "\n")
    print(dict(zip(columns, new)))


def solve(row):
    case = os.path.join(tempfile.mkdtemp(), "case")
    subprocess.run(["underbody", "body", "domain", os.path.join(here, "shapes", row["variant"] + ".toml"), "--gap", row["gap [mm]"] + " mm",
                    "--pitch", row["pitch [deg]"] + " deg", "--speed", row["speed [m/s]"] + " m/s", "--mesh-density", row["mesh"],
                    "--out", case], check=True)
    subprocess.run(["underbody", "solve", case], check=True)
    return case


if __name__ == "__main__":
    rows = {name_of(row): row for row in read(os.path.join(here, "forces.csv"))}
    known = {row["case"]: row for row in read(table)} if os.path.exists(table) else {}
    if sys.argv[1:2] == ["--list"]:
        for name in rows:
            print(f"{name}: {'not computed' if name not in known else known[name]['agrees'] + ' ' + known[name]['reason']}")
    elif sys.argv[1:2] == ["--take"]:
        take(sys.argv[2], rows[sys.argv[3]])
    elif len(sys.argv) == 2:
        take(solve(rows[sys.argv[1]]), rows[sys.argv[1]])
    else:
        sys.exit(__doc__)
