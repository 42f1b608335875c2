#!/usr/bin/env python3
"""Writes the small EnSight Gold cases in ensight/: the cells of make_fluent_files.py in each coding and byte order."""
import os
import struct

from make_fluent_files import POINTS, zones, centroid

HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "ensight")
# In EnSight's order; the pentagonal prism as nfaced.
ELEMENTS = [("hexa8", [(0, 1, 2, 3, 4, 5, 6, 7)]), ("penta6", [(0, 3, 14, 4, 7, 15)]), ("pyramid5", [(4, 5, 6, 7, 16)]),
            ("tetra4", [(5, 6, 16, 17)])]
PRISM = [(2, 10, 9, 8, 1), (5, 11, 12, 13, 6), (1, 8, 11, 5), (8, 9, 12, 11), (9, 10, 13, 12), (10, 2, 6, 13), (2, 1, 5, 6)]


class Writer:
    def __init__(self, coding):
        self.coding = coding
        self.out = bytearray()

    def record(self, raw):
        if self.coding == "fortran":
            raw = struct.pack("<i", len(raw)) + raw + struct.pack("<i", len(raw))
        self.out += raw

    def line(self, text):
        self.record(text.encode() + b"\n" if self.coding == "ascii" else text.encode().ljust(80, b" " if self.coding == "fortran" else b"\0"))

    def ints(self, values, per_line=1):
        if self.coding == "ascii":
            for i in range(0, len(values), per_line):
                self.out += ("".join("%10d" % v for v in values[i:i + per_line]) + "\n").encode()
        else:
            self.record(struct.pack((">" if self.coding == "big" else "<") + f"{len(values)}i", *values))

    def reals(self, values):
        if self.coding == "ascii":
            self.out += "".join("%12.5e\n" % v for v in values).encode()
        else:
            self.record(struct.pack((">" if self.coding == "big" else "<") + f"{len(values)}f", *values))


def coordinates(out, nodes):
    out.line("coordinates")
    out.ints([len(nodes)])
    for k in range(3):
        out.reals([POINTS[n][k] for n in nodes])


def surface():
    """The body's faces with nodes of their own, as nsided."""
    polygons = [f[0] for f in zones()[3][4]]
    nodes = sorted({n for p in polygons for n in p})
    return nodes, polygons


def write(coding):
    geo = Writer(coding)
    if coding != "ascii":
        geo.line("Fortran Binary" if coding == "fortran" else "C Binary")
    for text in ("underbody test", "five cells", "node id assign", "element id assign", "part"):
        geo.line(text)
    geo.ints([4])
    geo.line("water")
    coordinates(geo, range(len(POINTS)))
    for name, cells in ELEMENTS:
        geo.line(name)
        geo.ints([len(cells)])
        geo.ints([n + 1 for c in cells for n in c], len(cells[0]))
    geo.line("nfaced")
    geo.ints([1])
    geo.ints([len(PRISM)])
    geo.ints([len(f) for f in PRISM])
    geo.ints([n + 1 for f in PRISM for n in f], 100)
    geo.line("part")
    geo.ints([6])
    geo.line("body")
    nodes, polygons = surface()
    coordinates(geo, nodes)
    geo.line("nsided")
    geo.ints([len(polygons)])
    geo.ints([len(p) for p in polygons])
    geo.ints([nodes.index(n) + 1 for p in polygons for n in p], 100)

    nodal = Writer(coding)
    nodal.line("Static Pressure")
    for number, part in ((4, range(len(POINTS))), (6, nodes)):
        nodal.line("part")
        nodal.ints([number])
        nodal.line("coordinates")
        nodal.reals([1 + 2 * POINTS[n][0] + 3 * POINTS[n][1] + 4 * POINTS[n][2] for n in part])
    shear = Writer(coding)
    shear.line("Wall Shear")
    shear.line("part")
    shear.ints([6])
    shear.line("nsided")
    for value in (0.5, -0.25, 0.125):
        shear.reals([value] * len(polygons))

    def name(ending):
        return os.path.join(HERE, f"{coding}.{ending}")
    for ending, writer in (("geo", geo), ("scl1", nodal), ("vel", shear)):
        with open(name(ending), "wb") as file:
            file.write(writer.out)
    quote = '"' if coding == "big" else ""
    with open(name("encas"), "w") as file:
        file.write(f"# underbody test\nFORMAT\ntype:  ensight gold\n\nGEOMETRY\nmodel:  {quote}{coding}.geo{quote}\n\nVARIABLE\n"
                   f"scalar per node:  pressure  {quote}{coding}.scl1{quote}\nvector per element:  wall-shear  {coding}.vel\n"
                   f"constant per case: gamma 1.4\nSCRIPTS\nmetadata: {quote}x.xml{quote}\n")


if __name__ == "__main__":
    os.makedirs(HERE, exist_ok=True)
    for each in ("little", "big", "fortran", "ascii"):
        write(each)
