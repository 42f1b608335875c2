#!/usr/bin/env python3
"""Where the pitch moment about the centre of buoyancy comes from, of the shipped fields of the plain ellipse
(../evie/fields): by part of the body, and how moment and slope would change if every pressure stayed what it is and
only its place moved with the base (`base_offset`) or its area changed (`taper`): the first order of what these numbers
of the shape do. The flow answers, too, which only CFD says.

    python3 where_the_moment_comes_from.py            # a table on standard output
"""
import math
import pathlib

FIELDS = pathlib.Path(__file__).resolve().parent.parent / "evie" / "fields"
A, B, C, CUT = 0.1016, 0.076, 0.0725, 0.75            # semi-axes of the ellipsoid in m; depth of the base in semi-heights
DEPTH = CUT * C
CENTRE = 0.0571                                       # m, centre of buoyancy above the base
# Share of `base_offset` by which the centre of buoyancy moves: mean of the squared depth over the volume.
WITH_BASE = CUT * (1 / 3 - CUT**2 / 5) / (CUT * (1 - CUT**2 / 3) + 2 / 3)
BASE = 2 * A * math.sqrt(1 - CUT**2)                  # m, length of the base
# Forward, m for a taper of 1: mean of x^2 and the squared depth over the volume, by the base's length.
WITH_TAPER = A**2 / 4 * CUT * (1 / 3 - 0.4 * CUT**2 + CUT**4 / 7) / (CUT * (1 - CUT**2 / 3) + 2 / 3) / BASE


def faces(path):
    """(centre, force of the whole body) of each face, in body axes from the centre of the base; N, m."""
    gap = float(path.name.split("-h")[1].split("-")[0]) * 1e-3
    pitch = math.radians(float(path.name.split("-p", 1)[1].split("-u")[0].removesuffix(".csv")))
    section, zone, nodes = None, None, []
    for line in path.read_text().splitlines():
        line = line.strip()
        if line.startswith("["):
            section = line
            if section == "[Data]":
                nodes, header = [], True
        elif line and section == "[Name]":
            zone = line
        elif line and section == "[Data]":
            if header:
                header = False
            else:
                nodes.append([float(v) for v in line.split(",")[:7]])
        elif line and section == "[Faces]":
            corners = [nodes[int(i)] for i in line.split(",")]
            points = [(c[0], c[1], c[2] - gap) for c in corners]
            middle = [sum(p[k] for p in points) / len(points) for k in range(3)]
            area = [0.0, 0.0, 0.0]
            for p, q in zip(points, points[1:] + points[:1]):
                a, b = [p[k] - middle[k] for k in range(3)], [q[k] - middle[k] for k in range(3)]
                area[0] += 0.5 * (a[1] * b[2] - a[2] * b[1])
                area[1] += 0.5 * (a[2] * b[0] - a[0] * b[2])
                area[2] += 0.5 * (a[0] * b[1] - a[1] * b[0])
            out = middle[0] * area[0] + middle[1] * area[1] + (middle[2] - CENTRE) * area[2] > 0
            area = [v if out else -v for v in area]
            size = math.sqrt(sum(v * v for v in area))
            pressure = sum(c[3] for c in corners) / len(corners)
            force = [2 * (-pressure * area[k] + sum(c[4 + k] for c in corners) / len(corners) * size) for k in range(3)]
            turn = lambda x, z: (x * math.cos(pitch) + z * math.sin(pitch), z * math.cos(pitch) - x * math.sin(pitch))
            x, z = turn(middle[0], middle[2])
            fx, fz = turn(force[0], force[2])
            yield zone, x, z, fx, fz


def parts(path):
    """{part: moment about the centre of buoyancy}, its changes a metre of base_offset and a unit of taper; nose up
    positive, N m, N."""
    result, by_offset, by_taper = {}, 0.0, 0.0
    for zone, x, z, fx, fz in faces(path):
        where = "nose" if x > 0.02 else "tail" if x < -0.02 else "middle"
        part = f"base, {where}" if zone == "base" else ("hull below" if z < DEPTH else "hull above") + (
            ", nose" if x > 0 else ", tail")
        result[part] = result.get(part, 0.0) + x * fz - (z - CENTRE) * fx
        share = max(0.0, min(1.0, (DEPTH - z) / DEPTH)) ** 2
        by_offset += fz * (share - WITH_BASE)
        by_taper += (x * fz - (z - CENTRE) * fx) * x * share / BASE - WITH_TAPER * fz
    return result, by_offset, by_taper


def main():
    for gap in (3, 5, 10):
        down, up, level = (parts(FIELDS / f"ellipse-h{gap}-p{p}.csv") for p in (-1, 1, 0))
        print(f"\n{gap} mm: part, moment at 0 deg in mN m, slope over +-1 deg in mN m/deg")
        for part in sorted(level[0]):
            print(f"  {part:18s} {1e3 * level[0][part]:8.1f} {500 * (up[0][part] - down[0][part]):8.1f}")
        moment = sum(level[0].values())
        slope = (sum(up[0].values()) - sum(down[0].values())) / 2
        for name, k, unit, size in (("base_offset", 1, "mm", 1e-3), ("taper", 2, "tenth", 0.1)):
            by_moment, by_slope = level[k], (up[k] - down[k]) / 2
            print(f"  {name} a {unit}: moment {1e3 * size * by_moment:+.2f} mN m, slope {1e3 * size * by_slope:+.2f} "
                  f"mN m/deg; no moment at {-moment / by_moment / size:.1f}, no slope at {-slope / by_slope / size:.1f} "
                  f"{unit}{'s' if unit == 'tenth' else ''}")


if __name__ == "__main__":
    main()
