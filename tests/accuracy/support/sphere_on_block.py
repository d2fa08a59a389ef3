#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference of sphere_press_test.cpp: a rigid sphere on the block of tests/sim/scene/support/scenes.h, by another method.

Linear elasticity, a quarter of the block, trilinear hexahedra with averaged dilatation (B-bar), graded away from the sphere; contact without
friction, u_z >= profile(r) - depth at the nodes of the top (r at rest), as a linear complementarity problem on their condensed compliance.
usage: sphere_on_block.py CELL_MM CELLS (under the sphere; and beyond 4 mm in each direction). Needs numpy and scipy. 0.25 and 8: two minutes.
"""
import sys

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg

YOUNG, POISSON, RADIUS = 5000.0, 0.45, 0.0025
HALF, HEIGHT, FINE = 0.03, 0.0255, 0.004
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float)


def axis(length, cell, count):
    """Equal cells as far as FINE, then `count` that grow by a constant ratio."""
    fine = np.arange(round(FINE / cell) + 1) * cell
    low, high = 1.0 + 1e-9, 4.0
    for _ in range(200):
        ratio = 0.5 * (low + high)
        low, high = (ratio, high) if cell * (ratio**count - 1) / (ratio - 1) < length - fine[-1] else (low, ratio)
    coarse = np.cumsum(cell * ratio ** np.arange(count))
    return np.concatenate([fine, fine[-1] + coarse * (length - fine[-1]) / coarse[-1]])


def stiffness(size):
    """Of one cell, 24 x 24."""
    lam, mu = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
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
    cell, count = 1e-3 * float(sys.argv[1]), int(sys.argv[2])
    x, z = axis(HALF, cell, count), -axis(HEIGHT, cell, count)
    n, layers = len(x), len(z)
    node = np.arange(n * n * layers).reshape(layers, n, n)
    rows, columns, values, known = [], [], [], {}
    for k in range(layers - 1):
        for j in range(n - 1):
            for i in range(n - 1):
                size = np.array([x[i + 1] - x[i], x[j + 1] - x[j], z[k] - z[k + 1]])
                key = tuple(np.round(size, 9))
                if key not in known:
                    known[key] = stiffness(size)
                corner = [node[k + 1 - dz, j + dy, i + dx] for dz in (0, 1) for dx, dy in ((0, 0), (1, 0), (1, 1), (0, 1))]
                dofs = (3 * np.array(corner)[:, None] + np.arange(3)).ravel()
                rows.append(np.repeat(dofs, 24))
                columns.append(np.tile(dofs, 24))
                values.append(known[key].ravel())
    matrix = sparse.coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
    held = np.zeros((n * n * layers, 3), bool)
    held[node[:, :, 0].ravel(), 0] = held[node[:, 0, :].ravel(), 1] = held[node[-1].ravel()] = True
    free = np.flatnonzero(~held.ravel())
    factor = linalg.splu(matrix[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    radius = np.hypot(*np.meshgrid(x, x)).ravel()
    top = np.flatnonzero(radius < RADIUS * (1 - 1e-9))
    place = np.searchsorted(free, 3 * node[0].ravel()[top] + 2)
    compliance = np.empty((len(top), len(top)))
    for c, at in enumerate(place):
        load = np.zeros(len(free))
        load[at] = 1.0
        compliance[:, c] = factor.solve(load)[place]
    profile = RADIUS - np.sqrt(RADIUS**2 - radius[top] ** 2)
    for depth in 1e-3 * np.arange(1, 7):
        below = profile < depth
        force = 4 * complementarity(compliance[np.ix_(below, below)], profile[below] - depth).sum()
        print(f"{1e3 * depth:.0f} mm: {force:.5f} N")


if __name__ == "__main__":
    main()
