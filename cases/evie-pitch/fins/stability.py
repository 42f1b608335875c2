#!/usr/bin/env python3
"""Stability maps of level-fins in heave and pitch, from means.csv: tables, maps, shares.

    python3 stability.py

Needs `underbody` on the PATH. Writes stability/: medium.csv and fine.csv (each mesh at 3, 5 and 10 mm) and three maps.

The gap of a run lies under the centre of the base, which is aft of the centre of buoyancy; heave and pitch turn about that one.
So a table's gap is that which a level body of the same height has: at nose-up pitch the base's centre lies lower.
"""
import csv
import json
import math
import os
import subprocess

here = os.path.dirname(os.path.abspath(__file__))
AFT = 14.25  # mm, from the centre of buoyancy to the centre of the base (`underbody body level-fins.toml`)
BUOYANCY = 22.9  # N


def runs(mesh):
    """(gap, pitch): lift, its error, moment, its error; mm, degrees, N, mN m."""
    with open(os.path.join(here, "means.csv"), newline="") as file:
        return {(float(row["gap [mm]"]), float(row["pitch [deg]"])): [float(row[key]) for key in (
                    "lift_force [N]", "lift_error [N]", "pitch_moment_at_buoyancy [mN m]", "pitch_moment_error [mN m]")]
                for row in csv.DictReader(file, skipinitialspace=True)
                if row["design"] == "level-fins" and row["mesh"] == mesh}


def table(mesh):
    with open(os.path.join(here, "stability", f"{mesh}.csv"), "w") as file:
        file.write("# level-fins about its centre of buoyancy (stability.py, from ../means.csv)\n"
                   "gap [mm], pitch [deg], lift_force [N], lift_force_sigma [N], pitch_moment [N m], pitch_moment_sigma [N m]\n")
        for (gap, pitch), (lift, lift_error, moment, moment_error) in sorted(runs(mesh).items()):
            if abs(pitch) == 1:
                level = gap + AFT * math.sin(math.radians(pitch))
                file.write(f"{level:.3f}, {pitch:g}, {lift:.4f}, {lift_error:.3g}, {1e-3 * moment:.6f}, {1e-3 * moment_error:.3g}\n")


def net_weight(mesh):
    """N: the lift at 5 mm and zero pitch."""
    at = runs(mesh)
    return 0.5 * (at[5, -1][0] + at[5, 1][0])


def region(mesh, below, *more, grid="30x20"):
    """Shares of the starts by where they end, with the centre of gravity `below` mm under the centre of buoyancy."""
    model = os.path.join(here, "stability", f"{mesh}.toml")
    with open(os.path.join(here, "stability", "model.toml")) as file, open(model, "w") as out:
        out.write("# Written by ../stability.py from model.toml.\n" + file.read().replace('"fine.csv"', f'"{mesh}.csv"'))
    command = ["underbody", "region", model, "--set", f"vehicle.buoyancy_height={below} mm",
               "--set", f"vehicle.net_weight={net_weight(mesh):.4f} N", "--axes", "gap=3.5mm:9.5mm,pitch=-0.9deg:0.9deg",
               "--grid", grid, "--for", "300 s", "--escape", "12 mm", "--json", *more]
    told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    os.remove(model)
    shares = {}
    for c in told.get("classes", []):  # none of draws
        shares[c["kind"]] = shares.get(c["kind"], 0) + c["fraction"]
    return shares, told


def at_constant_lift(mesh):
    """Slope of the moment over pitch at 5 mm, N m a radian: at a fixed height, and where the lift stays (the body rises as it
    pitches), by differences of the table over gap and pitch."""
    value = {key: (of[0], of[2]) for key, of in runs(mesh).items()}
    mean = {g: [0.5 * (value[g, -1][i] + value[g, 1][i]) for i in (0, 1)] for g in (3, 5, 10)}
    degree = math.radians(1)
    # Over gaps of unequal steps, at 5 mm: the parabola through three.
    over_gap = [((mean[5][i] - mean[3][i]) / 2 * 5 + (mean[10][i] - mean[5][i]) / 5 * 2) / 7 for i in (0, 1)]
    lift_gap, moment_gap = 1e3 * over_gap[0], over_gap[1]  # N/m, N m/m
    lift_pitch = (value[5, 1][0] - value[5, -1][0]) / (2 * degree) - lift_gap * 1e-3 * AFT
    moment_pitch = 1e-3 * (value[5, 1][1] - value[5, -1][1]) / (2 * degree) - moment_gap * 1e-3 * AFT
    print(f"{mesh}, 5 mm: lift {lift_gap:.0f} N/m over the gap and {lift_pitch:.1f} N/rad over pitch, moment "
          f"{moment_gap:.2f} mN m per mm over the gap")
    return moment_pitch, moment_pitch - moment_gap * lift_pitch / lift_gap


if __name__ == "__main__":
    os.makedirs(os.path.join(here, "stability"), exist_ok=True)
    for mesh in ("medium", "fine"):
        table(mesh)
        fixed, constant = at_constant_lift(mesh)
        print(f"{mesh}: dM/dpitch at 5 mm {1e3 * fixed * math.pi / 180:.2f} mN m/deg at a fixed height, "
              f"{1e3 * constant * math.pi / 180:.2f} at constant lift; it takes a centre of gravity {1e3 * constant / BUOYANCY:.1f} "
              "mm below that of buoyancy")
        for below in (0, 4, 8, 12):
            shares, told = region(mesh, below)
            print(f"  {below} mm: " + ", ".join(f"{kind} {100 * share:.0f} %" for kind, share in sorted(shares.items())) +
                  f"; {100 * told['outside_table_path_fraction']:.0f} % leave the table on their way")
    picture = lambda name: os.path.join(here, "stability", name)
    for below in (0, 8):
        region("fine", below, "--force", "--out", picture(f"fine-{below}mm.png"), grid="60x40")
        told = region("fine", below, "--draws", "20", grid="20x14")[1]
        print(f"fine, {below} mm, 20 draws of the tables' errors, each point by itself: {100 * told['area_mean']:.0f} +- "
              f"{100 * told['area_sigma']:.0f} % of the starts come to rest")
