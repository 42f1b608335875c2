#!/usr/bin/env python3
"""Stability maps of trimmed-fins in heave and pitch, from forces.csv: tables, maps, shares.

    python3 stability.py

Needs `underbody` on the PATH. Writes stability/: draft.csv (the draft mesh at 3, 5 and 10 mm), medium.csv (the same, moved by
what the medium mesh changes at 5 mm, at each pitch), and two maps.

The gap of a run lies under the centre of the base, which is aft of the centre of buoyancy; heave and pitch turn about that one.
So a table's gap is that which a level body of the same height has: at nose-up pitch the base's centre lies lower.
"""
import csv
import json
import math
import os
import subprocess

here = os.path.dirname(os.path.abspath(__file__))
AFT = 17.8  # mm, from the centre of buoyancy to the centre of the base (`underbody body trimmed-fins.toml`)
# Errors of a point. Draft: of the lift half of what draft and coarse differ by at 5 mm and 1 degree, of the moment what they
# do. Medium: the error of its means, which know their correlation; at 3 and 10 mm, where it was not run, half of what it changes
# at 5 mm as well.
DRAFT_ERROR = {"lift": 0.09, "moment": 0.1}
MEDIUM_ERROR = {"lift": 0.01, "moment": 0.3}
MEDIUM = {-1: {"lift": 0.79, "moment": 4.0}, 1: {"lift": 1.06, "moment": 3.3}}  # README.md: means over iterations 200 to 800


def runs(mesh):
    with open(os.path.join(here, "forces.csv"), newline="") as file:
        for row in csv.DictReader(file, skipinitialspace=True):
            if row["design"] == "trimmed-fins" and row["mesh"] == mesh and row["state"] == "solved":
                yield (float(row["gap [mm]"]), float(row["pitch [deg]"]), float(row["lift_force [N]"]),
                       float(row["pitch_moment_at_buoyancy [mN m]"]))


def table(name, rows):
    with open(os.path.join(here, "stability", name), "w") as file:
        file.write("# trimmed-fins about its centre of buoyancy (stability.py, from ../forces.csv)\n"
                   "gap [mm], pitch [deg], lift_force [N], lift_force_sigma [N], pitch_moment [N m], pitch_moment_sigma [N m]\n")
        for gap, pitch, lift, lift_error, moment, moment_error in sorted(rows):
            level = gap + AFT * math.sin(math.radians(pitch))
            file.write(f"{level:.3f}, {pitch:g}, {lift:.4f}, {lift_error:.3g}, {1e-3 * moment:.6f}, {1e-3 * moment_error:.3g}\n")


def tables():
    draft = list(runs("draft"))
    table("draft.csv", [(g, p, l, DRAFT_ERROR["lift"], m, DRAFT_ERROR["moment"]) for g, p, l, m in draft])
    at_5 = {p: (l, m) for g, p, l, m in draft if g == 5}
    rows = []
    for g, p, l, m in draft:
        change = {q: [MEDIUM[s][q] - at_5[s][i] for s in (-1, 1)] for i, q in enumerate(("lift", "moment"))}
        moved = {q: c[0] + 0.5 * (p + 1) * (c[1] - c[0]) for q, c in change.items()}
        error = {q: math.hypot(MEDIUM_ERROR[q], 0 if g == 5 else 0.5 * moved[q]) for q in moved}
        rows.append((g, p, l + moved["lift"], error["lift"], m + moved["moment"], error["moment"]))
    table("medium.csv", rows)


NET_WEIGHT = {"draft": 1.10, "medium": 0.925}  # N: the lift at 5 mm and zero pitch


def region(mesh, below, *more, grid="30x20"):
    """Shares of the starts by where they end, with the centre of gravity `below` mm under the centre of buoyancy."""
    model = os.path.join(here, "stability", f"{mesh}.toml")
    with open(os.path.join(here, "stability", "model.toml")) as file, open(model, "w") as out:
        out.write("# Written by ../stability.py from model.toml.\n" + file.read().replace('"draft.csv"', f'"{mesh}.csv"'))
    command = ["underbody", "region", model, "--set", f"vehicle.buoyancy_height={below} mm",
               "--set", f"vehicle.net_weight={NET_WEIGHT[mesh]} N", "--axes", "gap=3.5mm:9.5mm,pitch=-0.9deg:0.9deg",
               "--grid", grid, "--for", "300 s", "--escape", "12 mm", "--json", *more]
    told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    os.remove(model)
    shares = {}
    for c in told.get("classes", []):  # none of draws
        shares[c["kind"]] = shares.get(c["kind"], 0) + c["fraction"]
    return shares, told


def at_constant_lift(mesh):
    """Slope of the moment over pitch at 5 mm, N m a radian: at a fixed height, and where the lift stays (the body rises as it
    pitches), by differences of the table's means over gap and pitch."""
    draft = {(g, p): (l, m) for g, p, l, m in runs("draft")}
    change = {p: (MEDIUM[p]["lift"] - draft[5, p][0], MEDIUM[p]["moment"] - draft[5, p][1]) if mesh == "medium" else (0, 0)
              for p in (-1, 1)}
    value = {(g, p): [draft[g, p][i] + change[p][i] for i in (0, 1)] for g in (3, 5, 10) for p in (-1, 1)}
    mean = {g: [0.5 * (value[g, -1][i] + value[g, 1][i]) for i in (0, 1)] for g in (3, 5, 10)}
    degree = math.radians(1)
    # Over gaps of unequal steps, at 5 mm: the parabola through three.
    over_gap = [((mean[5][i] - mean[3][i]) / 2 * 5 + (mean[10][i] - mean[5][i]) / 5 * 2) / 7 for i in (0, 1)]
    lift_gap, moment_gap = 1e3 * over_gap[0], over_gap[1]  # N/m, N m/m
    lift_pitch = (value[5, 1][0] - value[5, -1][0]) / (2 * degree) - lift_gap * 1e-3 * AFT
    moment_pitch = 1e-3 * (value[5, 1][1] - value[5, -1][1]) / (2 * degree) - moment_gap * 1e-3 * AFT
    return moment_pitch, moment_pitch - moment_gap * lift_pitch / lift_gap


if __name__ == "__main__":
    os.makedirs(os.path.join(here, "stability"), exist_ok=True)
    tables()
    buoyancy = 22.9  # N
    for mesh in ("draft", "medium"):
        fixed, constant = at_constant_lift(mesh)
        print(f"{mesh}: dM/dpitch at 5 mm {1e3 * fixed * math.pi / 180:.2f} mN m/deg at a fixed height, "
              f"{1e3 * constant * math.pi / 180:.2f} at constant lift; it takes a centre of gravity {1e3 * constant / buoyancy:.1f} "
              "mm below that of buoyancy")
        for below in (0, 4, 8, 12):
            shares, told = region(mesh, below)
            print(f"  {below} mm: " + ", ".join(f"{kind} {100 * share:.0f} %" for kind, share in sorted(shares.items())) +
                  f"; {100 * told['outside_table_path_fraction']:.0f} % leave the table on their way")
    picture = lambda name: os.path.join(here, "stability", name)
    region("draft", 0, "--force", "--out", picture("draft-0mm.png"), grid="60x40")
    region("draft", 8, "--force", "--out", picture("draft-8mm.png"), grid="60x40")
    for mesh in ("draft", "medium"):
        told = region(mesh, 8, "--draws", "20", grid="20x14")[1]
        print(f"{mesh}, 8 mm, 20 draws of the tables' errors, each point by itself: {100 * told['area_mean']:.0f} +- "
              f"{100 * told['area_sigma']:.0f} % of the starts come to rest")
