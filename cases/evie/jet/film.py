#!/usr/bin/env python3
"""Loads of the jet's runs beside the laws of jet and film, into film.csv.

    underbody sweep cases/evie/jet && python3 cases/evie/jet/film.py

Needs `underbody` on the PATH and the runs. Lift in mN, up, of the whole body: of the base beside the film's force on it
(`underbody theory jet_film`: viscous part exact on the ellipse, laminar inertia), of the pressure on the opening, and of the
hull. The jet's thrust, density flow^2/area, is in no wall's load; beside it stands what the pump's law says.
"""
import json
import math
import os
import re
import subprocess

here = os.path.dirname(os.path.abspath(__file__))
HALF_AXES = "half_length=67.2mm,half_width=50.3mm"  # of the base of this ellipse
NOZZLE = 2.5e-3                                      # m, radius
FLOW_PER_VOLT, DEAD_BAND, DENSITY = 2.544e-6, 1.54, 998
columns = ["jet_voltage [V]", "jet_flow [mL/s]", "gap [mm]", "base [mN]", "film [mN]", "film_viscous [mN]", "film_inertial [mN]",
           "opening [mN]", "hull [mN]", "thrust [mN]", "thrust_law [mN]", "film_reynolds [1]", "iterations [1]", "settled"]


def ask(*words):
    return json.loads(subprocess.run(["underbody", *words, "--json"], check=True, capture_output=True, text=True).stdout)


def row(folder, gap, voltage):
    flow = FLOW_PER_VOLT * max(0, voltage - DEAD_BAND)
    film = ask("theory", "jet_film", f"{HALF_AXES},nozzle_radius={NOZZLE}m,flow={flow}m^3/s,gap={gap}mm")["values"]
    marker = json.load(open(os.path.join(folder, "case.foam")))
    loads = ask("loads", os.path.join(folder, "case.foam"), "--symmetry", "y", "--zones", "base,hull,nozzle")
    lift = {zone["name"]: 1e3 * zone["force"][2] for zone in loads["zones"]}
    half = 2 if abs(1e3 * loads["lift_force"] - 2 * sum(lift.values())) < 1e-3 * sum(map(abs, lift.values())) else 1
    viscous, force = 1e3 * film["viscous_load"], 1e3 * film["force"]
    thrust = 1e3 * DENSITY * flow**2 / (math.pi * NOZZLE**2)
    # Of the film where half of the plate lies beyond: its inertia over its friction, to be small for the formula.
    reynolds = DENSITY * flow * 1e-3 * gap / (2 * math.pi * 1e-3 * 0.5 * 67.2e-3 * 50.3e-3)
    return [voltage, f"{1e6 * flow:.3f}", gap, *(f"{v:.2f}" for v in (half * lift["base"], force, viscous, force - viscous,
            half * lift["nozzle"], half * lift["hull"], thrust, 0.329 * max(0, voltage - DEAD_BAND)**2)), f"{reynolds:.2f}",
            marker["iterations"], "yes" if marker["settled"] else "no"]


def main():
    runs = os.path.join(here, "runs")
    rows = []
    for name in sorted(os.listdir(runs)):
        found = re.fullmatch(r"evie-h([\d.]+)-p0-u0.02-v([\d.]+)", name)
        if found and os.path.exists(os.path.join(runs, name, "case.foam")):
            rows.append(row(os.path.join(runs, name), float(found[1]), float(found[2])))
    with open(os.path.join(here, "film.csv"), "w") as file:
        file.write("# EVIE's ellipse, flush 5 mm nozzle, 0.02 m/s, draft mesh (film.py)\n" + ", ".join(columns) + "\n")
        for one in sorted(rows, key=lambda r: (r[2], r[0])):
            file.write(", ".join(map(str, one)) + "\n")


main()
