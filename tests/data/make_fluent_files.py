#!/usr/bin/env python3
"""Writes the small legacy Fluent files in fluent_legacy/: five cells of five kinds, in every coding.

A cube (hexahedron), a pentagonal prism beside it (polyhedron), a wedge on its other side, a pyramid on top of it and a
tetrahedron on the pyramid: volumes 1, 1.25, 0.5, 1/3 and 0.25. Pressure is 1 + 2x + 3y + 4z at the centroid of
each face, so the pressure force on the whole hull is (2, 3, 4) times the volume, exactly.
"""
import gzip
import os
import struct

POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1),
          (2, 0, 0), (2.5, 0.5, 0), (2, 1, 0), (2, 0, 1), (2.5, 0.5, 1), (2, 1, 1),
          (-1, 0.5, 0), (-1, 0.5, 1), (0.5, 0.5, 2), (2, 0.5, 2)]
# Faces of each cell, in any turn; Fluent's element codes.
CELLS = [
    (4, [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]),
    (7, [(1, 8, 9, 10, 2), (5, 11, 12, 13, 6), (1, 8, 11, 5), (8, 9, 12, 11), (9, 10, 13, 12), (10, 2, 6, 13), (1, 2, 6, 5)]),
    (6, [(0, 3, 14), (4, 7, 15), (0, 3, 7, 4), (3, 14, 15, 7), (14, 0, 4, 15)]),
    (5, [(4, 5, 6, 7), (4, 5, 16), (5, 6, 16), (6, 7, 16), (7, 4, 16)]),
    (2, [(5, 6, 16), (5, 6, 17), (6, 16, 17), (16, 5, 17)]),
]


def mean(nodes):
    return [sum(POINTS[n][k] for n in nodes) / len(nodes) for k in range(3)]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def area_vector(nodes):
    total = [0, 0, 0]
    for i in range(1, len(nodes) - 1):
        n = cross(minus(POINTS[nodes[i]], POINTS[nodes[0]]), minus(POINTS[nodes[i + 1]], POINTS[nodes[0]]))
        total = [t + x / 2 for t, x in zip(total, n)]
    return total


def centroid(nodes):
    """Of the area, exact for a plane polygon."""
    whole = area_vector(nodes)
    size = dot(whole, whole) ** 0.5
    total = [0, 0, 0]
    for i in range(1, len(nodes) - 1):
        three = [nodes[0], nodes[i], nodes[i + 1]]
        part = dot(area_vector(three), whole) / size
        total = [t + part * x / size for t, x in zip(total, mean(three))]
    return total


def faces():
    seen = {}
    for cell, (_, polygons) in enumerate(CELLS, 1):
        centre = mean(sorted({n for p in polygons for n in p}))
        for polygon in polygons:
            key = frozenset(polygon)
            if key in seen:
                seen[key][2] = cell
                continue
            inward = dot(area_vector(polygon), minus(centre, mean(polygon))) > 0
            seen[key] = [polygon if inward else tuple(reversed(polygon)), cell, 0]
    return list(seen.values())


def zones():
    inner = [f for f in faces() if f[2] != 0]
    outer = [f for f in faces() if f[2] == 0]
    floor = [f for f in outer if all(POINTS[n][2] == 0 for n in f[0])]
    inlet = [f for f in outer if f not in floor and mean(f[0])[0] < 0]
    body = [f for f in outer if f not in floor and f not in inlet]
    return [(5, 2, "interior", "interior-fluid", inner), (10, 3, "wall", "floor", floor),
            (11, 10, "velocity-inlet", "inlet", inlet), (12, 3, "wall", "body", body)]


def write_case(path, coding):
    """coding: '' ASCII, '2' single precision, '3' double precision."""
    out = bytearray()

    def text(line):
        out.extend(line.encode())

    def end(index):
        text("\n))\n" if not coding else f")\nEnd of Binary Section   {coding}0{index})\n")

    def begin(index, header):
        text(f"({coding + '0' if coding else ''}{index} ({header})\n(")
        if not coding:
            text("\n")

    text('(0 "underbody test file (a bracket that does not match")\n(2 3)\n')
    text('(0 "Machine Config:")\n(4 (60 0 0 1 2 4 4 4 8 8 8 4))\n')
    text('(37 (\n(rp-3d? #t)\n(operating-pressure 101325.)\n(case-file-units "si")\n'
         '(materials ((water fluid (density (constant . 998.2) (ideal-gas . #f)))))\n))\n')
    total = sum(len(z[4]) for z in zones())
    text(f"(12 (0 1 {len(CELLS):x} 0))\n(13 (0 1 {total:x} 0))\n(10 (0 1 {len(POINTS):x} 0 3))\n")
    begin(12, f"2 1 {len(CELLS):x} 1 0")
    codes = [c for c, _ in CELLS]
    out.extend(struct.pack(f"<{len(codes)}i", *codes) if coding else " ".join(f"{c:x}" for c in codes).encode())
    end(12)
    first = 1
    for zone, kind, _, _, part in zones():
        begin(13, f"{zone:x} {first:x} {first + len(part) - 1:x} {kind:x} 0")
        lines = []
        for nodes, c0, c1 in part:
            numbers = [len(nodes)] + [n + 1 for n in nodes] + [c0, c1]
            if coding:
                out.extend(struct.pack(f"<{len(numbers)}i", *numbers))
            else:
                lines.append(" ".join(f"{n:x}" for n in numbers))
        text("\n".join(lines))
        end(13)
        first += len(part)
    begin(10, f"1 1 {len(POINTS):x} 1 3")
    flat = [x for p in POINTS for x in p]
    if coding:
        out.extend(struct.pack(f"<{len(flat)}{'d' if coding == '3' else 'f'}", *flat))
    else:
        text("\n".join("%.17g %.17g %.17g" % p for p in POINTS))
    end(10)
    text(f"({coding + '0' if coding else ''}41 (1 {len(POINTS):x})\n(")
    out.extend(b"\x00)\x01(" * 4 if coding else b" 1 2 3 4")
    end(41)
    text("(39 (2 fluid water 1)(\n(material . water)\n(name \"a ( in a text\")\n))\n")
    for zone, _, kind, name, _ in zones():
        text(f"(39 ({zone} {kind} {name} 1)(\n))\n")
    with open(path, "wb") as file:
        file.write(gzip.compress(bytes(out), mtime=0) if path.endswith(".gz") else bytes(out))


def write_data(path, coding):
    out = bytearray()

    def text(line):
        out.extend(line.encode())

    def field(number, name, zone, kind, first, rows):
        width = len(rows[0])
        text(f'(0 "{name}, domain 1, {kind} zone {zone}, {len(rows)} {"cells" if kind == "cell" else "faces"}:")\n')
        text(f"({ {'': 300, '2': 2300, '3': 3300}[coding] } ({number} {zone} {width} 0 1 {first} {first + len(rows) - 1})\n(")
        flat = [x for row in rows for x in row]
        if coding:
            out.extend(struct.pack(f"<{len(flat)}{'d' if coding == '3' else 'f'}", *flat))
            text(f"\nEnd of Binary Section   {coding}300))\n\n")
        else:
            text("\n" + "\n".join(" ".join("%.17g" % x for x in row) for row in rows) + "))\n\n")

    def pressure(c):
        return 1 + 2 * c[0] + 3 * c[1] + 4 * c[2]

    text('(0 "underbody test data")\n(4 (60 0 0 1 2 4 4 4 8 8 8 4))\n')
    total = sum(len(z[4]) for z in zones())
    text(f"(33 ({len(CELLS)} {total} {len(POINTS)}))\n")
    text("(37 (\n(flow-time 1.5)\n))\n")
    centres = [mean(sorted({n for p in polygons for n in p})) for _, polygons in CELLS]
    field(1, "SV_P", 2, "cell", 1, [[pressure(c)] for c in centres])
    for k, letter in enumerate("UVW"):
        field(111 + k, "SV_" + letter, 2, "cell", 1, [[c[k]] for c in centres])
    first = 1
    for zone, _, kind, _, part in zones():
        if kind != "interior":
            field(1, "SV_P", zone, kind, first, [[pressure(centroid(f[0]))] for f in part])
        if kind == "wall":
            # Traction (0.5, -0.25, 0.125) Pa on the body; the file holds the wall's force on the fluid.
            rows = []
            for nodes, _, _ in part:
                size = dot(area_vector(nodes), area_vector(nodes)) ** 0.5
                rows.append([-0.5 * size, 0.25 * size, -0.125 * size])
            field(19, "SV_WALL_SHEAR", zone, kind, first, rows)
            field(35, "SV_WALL_YPLUS", zone, kind, first, [[float(i + 1)] for i in range(len(part))])
            field(99999, "SV_NEW_THING", zone, kind, first, [[7.0] for _ in part])
        first += len(part)
    text("(302 (1 1 1)(\n(1 0.5)\n))\n")
    with open(path, "wb") as file:
        file.write(gzip.compress(bytes(out), mtime=0) if path.endswith(".gz") else bytes(out))


if __name__ == "__main__":
    here = os.path.join(os.path.dirname(os.path.abspath(__file__)), "fluent_legacy")
    for stem, code in (("ascii", ""), ("single", "2"), ("double", "3")):
        write_case(os.path.join(here, f"{stem}.cas"), code)
        write_data(os.path.join(here, f"{stem}.dat"), code)
    write_case(os.path.join(here, "packed.cas.gz"), "3")
    write_data(os.path.join(here, "packed.dat.gz"), "")
