#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference of sphere_press_test.cpp and fat_press_test.cpp by another method: a rigid instrument pressed into a block that is held at its bottom.

Linear elasticity, trilinear hexahedra with averaged dilatation (B-bar), graded away from the instrument; contact without friction,
u_z >= profile(x, y) - depth at the nodes of the top (at rest), as a linear complementarity problem on their condensed compliance.
usage: press_on_block.py CASE CELL_MM CELLS (under the instrument; and beyond in each direction). Needs numpy and scipy. CASE:
  block     sphere of 2.5 mm on the block of tests/sim/scene/support/scenes.h, a quarter of it; 0.25 and 8: two minutes
  fat       the same on fat_press_test.cpp's pad
  hook      the electrode of sim/instruments/instruments.cpp, upright, on the pad: half of it
"""
import sys

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg

MM = 1e-3
BLOCK = {"young": 5000.0, "poisson": 0.45, "half": 30 * MM, "height": 25.5 * MM}
PAD = {"young": 1600.0, "poisson": 0.4, "half": 18 * MM, "height": 12 * MM}
RADIUS = 2.5 * MM
# Axes of the electrode's capsules in y and z over the heel, and their radius.
WIRE, BENDS = 0.6 * MM, np.array([[0.0, 10.0], [0.0, 1.9], [0.381, 0.981], [1.3, 0.6], [4.6, 0.6]]) * MM


def sphere(x, y):
    """Height of the underside over the lowest point, infinite beside it."""
    inside = RADIUS**2 - x**2 - y**2
    return np.where(inside > 1e-9 * RADIUS**2, RADIUS - np.sqrt(np.maximum(inside, 0.0)), np.inf)


def electrode(x, y):
    height = np.full(np.shape(x), np.inf)
    for a, b in zip(BENDS, BENDS[1:]):
        for share in np.linspace(0.0, 1.0, 401):  # spheres along the axis
            cy, cz = a + share * (b - a)
            inside = WIRE**2 - x**2 - (y - cy) ** 2
            height = np.where(inside > 0.0, np.minimum(height, cz - np.sqrt(np.maximum(inside, 0.0))), height)
    return height


CASES = {  # block, underside, what is fine (m): to +x, to -y, to +y; depths
    "block": (BLOCK, sphere, (4 * MM, 0.0, 4 * MM), MM * np.arange(1, 7)),
    "fat": (PAD, sphere, (4 * MM, 0.0, 4 * MM), MM * np.array([0.5, 1, 2, 3])),
    "hook": (PAD, electrode, (1.5 * MM, 1.5 * MM, 6 * MM), MM * np.array([0.5, 1, 2, 3])),
}
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float)


def axis(length, reach, cell, count):
    """Equal cells as far as `reach`, then `count` that grow by a constant ratio."""
    fine = np.arange(round(reach / cell) + 1) * cell
    low, high = 1.0 + 1e-9, 4.0
    for _ in range(200):
        ratio = 0.5 * (low + high)
        low, high = (ratio, high) if cell * (ratio**count - 1) / (ratio - 1) < length - fine[-1] else (low, ratio)
    coarse = np.cumsum(cell * ratio ** np.arange(count))
    return np.concatenate([fine, fine[-1] + coarse * (length - fine[-1]) / coarse[-1]])


def stiffness(size, young, poisson):
    """Of one cell, 24 x 24."""
    lam, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    law = np.diag([2 * mu] * 3 + [mu] * 3)
    law[:3, :3] += lam
    strains = []
    for point in CORNERS / np.sqrt(3):
        f = 1 + CORNERS * point
        gradient = CORNERS * np.stack([f[:, 1] * f[:, 2], f[:, 0] * f[:, 2], f[:, 0] * f[:, 1]], 1) / 4 / size
        strain = np.zeros((6, 24))
        for i, (x, y, z) in enumerate(gradient):
            strain[:, 3 * i:3 * i + 3] = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
        strains.append(strain)
    mean = sum(s[:3].sum(0) for s in strains) / 8
    total = np.zeros((24, 24))
    for strain in strains:
        strain[:3] += (mean - strain[:3].sum(0)) / 3
        total += strain.T @ law @ strain * np.prod(size) / 8
    return total


def complementarity(matrix, free):
    """Forces f >= 0 with gaps matrix f + free >= 0, one of each zero: active sets."""
    active = np.ones(len(free), bool)
    while True:
        force = np.zeros(len(free))
        force[active] = np.linalg.solve(matrix[np.ix_(active, active)], -free[active])
        wanted = np.where(active, force > 0, matrix @ force + free < -1e-12)
        if (wanted == active).all():
            return force
        active = wanted


def main():
    block, underside, (to_x, to_low, to_high), depths = CASES[sys.argv[1]]
    cell, count = MM * float(sys.argv[2]), int(sys.argv[3])
    x, z = axis(block["half"], to_x, cell, count), -axis(block["height"], 4 * MM, cell, count)
    y = axis(block["half"], to_high, cell, count)
    if to_low:
        y = np.concatenate([-axis(block["half"], to_low, cell, count)[:0:-1], y])
    nx, ny, layers = len(x), len(y), len(z)
    node = np.arange(nx * ny * layers).reshape(layers, ny, nx)
    rows, columns, values, known = [], [], [], {}
    for k in range(layers - 1):
        for j in range(ny - 1):
            for i in range(nx - 1):
                size = np.array([x[i + 1] - x[i], y[j + 1] - y[j], z[k] - z[k + 1]])
                key = tuple(np.round(size, 9))
                if key not in known:
                    known[key] = stiffness(size, block["young"], block["poisson"])
                corner = [node[k + 1 - dz, j + dy, i + dx] for dz in (0, 1) for dx, dy in ((0, 0), (1, 0), (1, 1), (0, 1))]
                dofs = (3 * np.array(corner)[:, None] + np.arange(3)).ravel()
                rows.append(np.repeat(dofs, 24))
                columns.append(np.tile(dofs, 24))
                values.append(known[key].ravel())
    matrix = sparse.coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
    held = np.zeros((nx * ny * layers, 3), bool)
    held[node[:, :, 0].ravel(), 0] = held[node[-1].ravel()] = True
    if not to_low:
        held[node[:, 0, :].ravel(), 1] = True
    free = np.flatnonzero(~held.ravel())
    factor = linalg.splu(matrix[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    at_x, at_y = (at.ravel() for at in np.meshgrid(x, y))
    profile = underside(at_x, at_y)
    top = np.flatnonzero(profile < depths[-1])
    profile = profile[top]
    place = np.searchsorted(free, 3 * node[0].ravel()[top] + 2)
    compliance = np.empty((len(top), len(top)))
    for c, at in enumerate(place):
        load = np.zeros(len(free))
        load[at] = 1.0
        compliance[:, c] = factor.solve(load)[place]
    for depth in depths:
        below = profile < depth
        force = (2 if to_low else 4) * complementarity(compliance[np.ix_(below, below)], profile[below] - depth).sum()
        print(f"{depth / MM:g} mm: {force:.5f} N", flush=True)


if __name__ == "__main__":
    main()
