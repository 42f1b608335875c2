#!/usr/bin/env python3
"""The runs of forces.csv: one shape at one gap, pitch and mesh, with the moment about its own centre of buoyancy.

    python3 run.py trimmed-fins.toml 5 1 draft [folder for the case]

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


def main():
    shape, gap, pitch, density = sys.argv[1], float(sys.argv[2]) * 1e-3, math.radians(float(sys.argv[3])), sys.argv[4]
    case = sys.argv[5] if len(sys.argv) > 5 else os.path.join(tempfile.mkdtemp(), "case")
    stl = os.path.join(tempfile.mkdtemp(), "body.stl")
    x, _, z = json.loads(subprocess.run(["underbody", "body", shape, "--out", stl, "--json"], check=True,
                                        capture_output=True).stdout)["centroid"]
    subprocess.run(["underbody", "body", "domain", shape, "--gap", f"{gap} m", "--pitch", f"{pitch} rad",
                    "--mesh-density", density, "--out", case], check=True)
    subprocess.run(["underbody", "solve", case], check=True)
    ahead, above = x * math.cos(pitch) - z * math.sin(pitch), x * math.sin(pitch) + z * math.cos(pitch)
    forces, moments = rows(case, "force.dat")[-50:], rows(case, "moment.dat")[-50:]
    lift, drag = [2 * f[3] for f in forces], [-2 * f[1] for f in forces]
    about = [-2 * m[2] - ahead * up + above * -back for m, up, back in zip(moments, lift, drag)]
    mean = lambda values: sum(values) / len(values)
    print(f"{case}: {forces[-1][0]:.0f} iterations, lift {mean(lift):.4f} N, drag {mean(drag):.4f} N, moment about the "
          f"centre of buoyancy {1e3 * mean(about):.2f} mN m, which moves by {1e3 * (max(about) - min(about)):.2f} mN m")


main()
