#!/usr/bin/env python3
"""The shapes spread-01 to spread-14 of design/plan.csv: over six numbers by Halton's sequence, those with room over the ground."""
import math
def halton(i, b):
    f, r = 1.0, 0.0
    while i:
        f /= b; r += f * (i % b); i //= b
    return r
rows, i = [], 20
while len(rows) < 14:
    i += 1
    u = [halton(i, b) for b in (2, 3, 5, 7, 11, 13)]
    pitch, taper, cut = round(-3 + 6.5*u[0], 2), round(-0.6 + 0.9*u[1], 2), round(0.75 + 0.2*u[2], 3)
    offset, edge, height = round(-20 + 25*u[3], 1), round(5*u[4], 2), round(0.2 + 1.3*u[5], 2)
    half = 101.6*math.sqrt(1 - cut*cut)
    if half*math.tan(math.radians(abs(pitch) + 1)) + 0.7*height > 2.3:   # mm of the 3 mm gap that are taken
        continue
    rows.append((f'spread-{len(rows)+1:02d}', pitch, taper, cut, offset, edge, height))
print('design, body.base_pitch [deg], body.taper [1], body.base_cut [1], body.base_offset [mm], body.edge_radius [mm], protrusion.height [mm], fidelity, why, state')
for r in rows: print(', '.join(map(str, r)) + ', draft, plan, planned')
