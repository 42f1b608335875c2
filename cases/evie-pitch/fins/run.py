#!/usr/bin/env python3
"""The runs of forces.csv: one shape at one gap, pitch and mesh, with the moment about its own centre of buoyancy.

    python3 run.py trimmed-fins.toml 5 1 draft [folder for the case]

    python3 run.py --means trimmed-fins.toml 5 1 CASE     a case that has not settled: means over iterations 200 to its end

Needs `underbody` and OpenFOAM 1912. Loads are of the whole body, means of the last 50 iterations; the moment is nose up
positive.
"""
import glob
import json
import math
import os
import subprocess
import sys
import tempfile


def rows(case, name):
    found = {}
    for file in sorted(glob.glob(f"{case}/postProcessing/forces/*/{name}")):
        for line in open(file):
            if not line.startswith("#"):
                numbers = [float(t) for t in line.replace("(", " ").replace(")", " ").split()]
                found[numbers[0]] = numbers
    return [found[t] for t in sorted(found)]


def mean_and_error(values):
    """Mean and its standard error; the correlation of the values is summed until it is lost in its own noise."""
    count, mean = len(values), sum(values) / len(values)
    off = [v - mean for v in values]
    square = sum(v * v for v in off) / count
    length = 1
    for lag in range(1, count // 4):
        correlation = sum(a * b for a, b in zip(off, off[lag:])) / (count - lag) / square
        if correlation < 2 / math.sqrt(count):
            break
        length += 2 * correlation
    return mean, math.sqrt(square * length / count)


def histories(shape, pitch, case):
    """Iterations, and lift, drag and moment about the centre of buoyancy of the whole body at each, N and mN m."""
    stl = os.path.join(tempfile.mkdtemp(), "body.stl")
    x, _, z = json.loads(subprocess.run(["underbody", "body", shape, "--out", stl, "--json"], check=True,
                                        capture_output=True).stdout)["centroid"]
    ahead, above = x * math.cos(pitch) - z * math.sin(pitch), x * math.sin(pitch) + z * math.cos(pitch)
    forces, moments = rows(case, "force.dat"), rows(case, "moment.dat")
    lift, drag = [2 * f[3] for f in forces], [-2 * f[1] for f in forces]
    about = [1e3 * (-2 * m[2] - ahead * up + above * -back) for m, up, back in zip(moments, lift, drag)]
    return [f[0] for f in forces], lift, drag, about


def means(shape, pitch, case):
    iterations, *loads = histories(shape, pitch, case)
    late = [[v for t, v in zip(iterations, load) if t > 200] for load in loads]
    words = ("lift", "N"), ("drag", "N"), ("moment about the centre of buoyancy", "mN m")
    print(f"{case}: iterations 201 to {iterations[-1]:.0f}: " + ", ".join(
        "{} {:.4f} +- {:.4f} {}".format(word, *mean_and_error(load), unit) for load, (word, unit) in zip(late, words)))


def main():
    if sys.argv[1] == "--means":
        return means(sys.argv[2], math.radians(float(sys.argv[4])), sys.argv[5])
    shape, gap, pitch, density = sys.argv[1], float(sys.argv[2]) * 1e-3, math.radians(float(sys.argv[3])), sys.argv[4]
    case = sys.argv[5] if len(sys.argv) > 5 else os.path.join(tempfile.mkdtemp(), "case")
    subprocess.run(["underbody", "body", "domain", shape, "--gap", f"{gap} m", "--pitch", f"{pitch} rad",
                    "--mesh-density", density, "--out", case], check=True)
    subprocess.run(["underbody", "solve", case], check=True)
    iterations, *loads = histories(shape, pitch, case)
    lift, drag, about = (load[-50:] for load in loads)
    mean = lambda values: sum(values) / len(values)
    print(f"{case}: {iterations[-1]:.0f} iterations, lift {mean(lift):.4f} N, drag {mean(drag):.4f} N, moment about the "
          f"centre of buoyancy {mean(about):.2f} mN m, which moves by {max(about) - min(about):.2f} mN m")


main()
