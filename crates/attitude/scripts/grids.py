#!/usr/bin/env python3
"""Compares deterministic grids of attitudes: the table of docs/models/attitude.md, "Grid".

Needs numpy and scipy. A minute or two for the default sizes.

    python3 grids.py [n ...]        (default 1000 10000)

Grids, all of n attitudes with equal shares of Haar measure:

super-Fibonacci  the crate's `super_fibonacci` (Alexa 2022, doi:10.1109/CVPR52688.2022.00811).
igloo            layers of theta1, in each of them rings of theta2, in each of them cells of theta3,
                 the hyperspherical angles of Peck (2003), Eq. 24; a cap at every pole.
masonry          the same courses as bricks in a wall: every second ring is shifted by half a cell,
                 every second layer by half a ring.
tori             the other coordinates in which bricks can be laid: tori of constant radius, rows of
                 one angle, bricks of the other, every second row shifted by half a brick.
random           independent uniform draws, the median of several sets.

Igloo and masonry are named after R. Bauer, "Uniform Sampling of SO3", NASA Goddard Flight Mechanics
Symposium 2001, which Peck (2003) cites. That text could not be consulted: what stands here is a
reading of the two names, with Bauer's rule for the sphere S2 ("Distribution of Points on a Sphere
with Application to Star Catalogs", JGCD 23(1), 2000: equal areas, steps along as wide as steps
across) taken one dimension up. His constructions may differ in the number of courses, in the
offsets and in the choice of coordinates.

Measures, as angles of rotation where they are angles:

covering    largest angle from any attitude to the nearest of the grid. Exact: a facet of the convex
            hull of the points and their negatives in R4 is the base of an empty cap.
separation  smallest angle between two of the grid.
moments     worst error of the means of the nine matrix entries and of their squares.
degree <=L  RMS error of the means of all Wigner functions of degree 1 to L, over that of random
            draws (expected value): below one, the grid integrates them better than draws do.
bump s      RMS relative error of the mean of exp(-(1 - cos angle)/s^2), a bump of deviation s about
            an attitude, over random attitudes.
"""

import sys

import numpy as np
from scipy.optimize import brentq
from scipy.spatial import ConvexHull, cKDTree
from scipy.special import ive

PSI = 1.533751168755204288  # the positive root of psi^4 = psi + 4


def super_fibonacci(n):
    s = np.arange(n) + 0.5
    r, complement = np.sqrt(s / n), np.sqrt(1 - s / n)
    a, b = 2 * np.pi * (s / np.sqrt(2) % 1), 2 * np.pi * (s / PSI % 1)
    return np.stack([r * np.sin(a), r * np.cos(a), complement * np.sin(b), complement * np.cos(b)], 1)


def shares(weights, n):
    """Whole numbers of sum n, as near to the weights as rounding of their running sum allows."""
    edges = np.rint(np.cumsum(weights) / np.sum(weights) * n).astype(int)
    counts = np.diff(edges, prepend=0)
    return counts[counts > 0]


def middles(counts):
    """Shares of measure in the middle of runs of so many cells."""
    edges = np.concatenate([[0], np.cumsum(counts)]) / np.sum(counts)
    return 0.5 * (edges[1:] + edges[:-1])


def bands(span, side, capped):
    """Edges of bands about as wide as a side. A capped set begins with half a band."""
    m = max(1, round(span / side))
    return np.linspace(0, span, m + 1) if not capped else span * (np.arange(m + 1) + 0.5) / (m + 0.5)


def sphere(n, side, capped, bricks):
    """n points of S2, equal areas, in rings; the turn by half a cell is what bricks are about."""
    m = max(1, round(np.pi / side))
    if capped:  # a cap of half a ring's height at both poles
        edges = np.concatenate([[0], (np.arange(m) + 0.5), [m]]) * np.pi / m
    else:
        edges = np.linspace(0, np.pi, m + 1)
    counts = shares(np.cos(edges[:-1]) - np.cos(edges[1:]), n)
    z = 1 - 2 * middles(counts)
    points = []
    for ring, (count, height) in enumerate(zip(counts, z)):
        if count == 1 and ring in (0, len(counts) - 1):
            height = 1 if ring == 0 else -1
        offset = 0.5 * (ring % 2) if bricks else 0.0
        longitude = 2 * np.pi * (np.arange(count) + 0.5 + offset) / count
        radius = np.sqrt(max(0, 1 - height * height))
        points.append(np.stack([radius * np.cos(longitude), radius * np.sin(longitude), np.full(count, height)], 1))
    return np.concatenate(points)


def layers(n, bricks):
    """Half of S3, x4 = cos theta1 >= 0, in layers of theta1 that hold whole numbers of cells."""
    side = (np.pi**2 / n) ** (1 / 3)
    volume = lambda t: (2 * t - np.sin(2 * t)) / np.pi  # the share of the half sphere below theta1
    # A cap of half a layer's height about the identity, then whole layers.
    m = round(np.pi / 2 / side - 0.5)
    edges = np.concatenate([[0], np.arange(m + 1) + 0.5]) * (np.pi / 2) / (m + 0.5)
    counts = shares(np.diff(volume(edges)), n)
    points = []
    for layer, (count, share) in enumerate(zip(counts, middles(counts))):
        theta = brentq(lambda t: volume(t) - share, 0, np.pi / 2) if count > 1 or layer else 0.0
        ball = sphere(count, side / max(np.sin(theta), 1e-9), not bricks or layer % 2 == 0, bricks)
        points.append(np.concatenate([np.sin(theta) * ball, np.full((count, 1), np.cos(theta))], 1))
    return np.concatenate(points)


def tori(n):
    """Tori of radius sin psi: rows of the first angle in [0, pi), bricks of the second in [0, 2 pi)."""
    side = (np.pi**2 / n) ** (1 / 3)
    m = round(np.pi / 2 / side)
    edges = np.linspace(0, np.pi / 2, m + 1)
    counts = shares(np.diff(np.sin(edges) ** 2), n)
    points = []
    for layer, (count, square) in enumerate(zip(counts, middles(counts))):
        r, complement = np.sqrt(square), np.sqrt(1 - square)
        rows = min(count, max(1, round(np.pi * r / side)))
        sizes = shares(np.ones(rows), count)
        for row, (size, share) in enumerate(zip(sizes, middles(sizes))):
            a = np.pi * share + (layer % 2) * 0.5 * np.pi / rows
            b = 2 * np.pi * (np.arange(size) + 0.5 * (row % 2) + 0.25 * (layer % 2)) / size
            ones = np.ones(size)
            points.append(
                np.stack([r * np.sin(a) * ones, r * np.cos(a) * ones, complement * np.sin(b), complement * np.cos(b)], 1)
            )
    return np.concatenate(points)


def random(n, rng):
    q = rng.standard_normal((n, 4))
    return q / np.linalg.norm(q, axis=1)[:, None]


def covering(q):
    hull = ConvexHull(np.concatenate([q, -q]), qhull_options="Qt")
    facet = np.argmax(hull.equations[:, -1])
    return 2 * np.arccos(-hull.equations[facet, -1]), hull.equations[facet, :-1]


def separation(q):
    chord = cKDTree(np.concatenate([q, -q])).query(q, k=2)[0][:, 1].min()
    return 4 * np.arcsin(chord / 2)


def moments(q):
    x, y, z, w = q.T
    entries = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return max(np.abs(entries.mean(-1)).max(), np.abs((entries**2).mean(-1) - 1 / 3).max())


def harmonics(q, degrees):
    """By the addition theorem: sums over pairs of the characters of SO(3)."""
    n, degree = len(q), max(degrees)
    total = np.zeros(degree + 1)
    for rows in np.array_split(q, max(1, n // 500)):
        t = rows @ q.T
        before, now = np.ones_like(t), 2 * t  # Chebyshev U0, U1
        for k in range(2, 2 * degree + 1):
            before, now = now, 2 * t * now - before
            if k % 2 == 0:
                total[k // 2] += now.sum() * (k + 1)
    error = np.cumsum(total[1:]) / n**2  # sums of squares over an orthonormal basis
    expected = np.cumsum((2 * np.arange(1, degree + 1) + 1) ** 2) / n
    return [np.sqrt(max(error[d - 1], 0) / expected[d - 1]) for d in degrees]


def bump(q, deviation, centres):
    k = deviation**-2
    exact = ive(0, k) - ive(1, k)
    errors = [np.exp(2 * k * ((part @ q.T) ** 2 - 1)).mean(1) / exact - 1 for part in np.array_split(centres, 20)]
    return np.sqrt(np.mean(np.concatenate(errors) ** 2))


def measures(q, centres):
    degrees = np.degrees
    return [
        degrees(covering(q)[0]),
        degrees(separation(q)),
        moments(q),
        *harmonics(q, (4, 8)),
        bump(q, np.radians(30), centres),
        bump(q, np.radians(15), centres),
    ]


def main():
    if any(a in ("-h", "--help") for a in sys.argv[1:]):
        print(__doc__)
        return
    rng = np.random.default_rng(2003)
    for n in [int(a) for a in sys.argv[1:]] or [1000, 10000]:
        centres = random(2000, rng)
        # What balls allow: the densest lattice packing, 0.7405, and the thinnest lattice covering, 1.4635.
        ideal = [np.degrees(2 * (d * np.pi * 0.75 / n) ** (1 / 3)) * f for d, f in ((1.4635, 1), (0.7405, 2))]
        print(f"\nn = {n}; lattices of balls would have covering {ideal[0]:.1f}, separation {ideal[1]:.1f}\n")
        print("| grid | covering, deg | separation, deg | moments | degree <=4 | degree <=8 | bump 30 deg | bump 15 deg |")
        print("|---|---|---|---|---|---|---|---|")
        sets = [
            ("super-Fibonacci", super_fibonacci(n)),
            ("igloo", layers(n, bricks=False)),
            ("masonry", layers(n, bricks=True)),
            ("tori", tori(n)),
        ]
        rows = {name: measures(q, centres) for name, q in sets}
        for name, q in sets:
            assert q.shape == (n, 4) and np.abs((q**2).sum(1) - 1).max() < 1e-14, name
            # Holes that random attitudes find may not be wider than the hull's.
            probes = random(20000, rng)
            chord = cKDTree(np.concatenate([q, -q])).query(probes)[0].max()
            assert np.degrees(4 * np.arcsin(chord / 2)) <= rows[name][0] + 1e-6, name
        rows["random"] = np.median([measures(random(n, rng), centres) for _ in range(5)], axis=0)
        for name, (cover, apart, moment, four, eight, wide, narrow) in rows.items():
            print(
                f"| {name} | {cover:.1f} | {apart:.2f} | {moment:.1e} | {four:.4f} | {eight:.4f} | {wide:.1e} | {narrow:.1e} |"
            )
        angle, hole = covering(sets[0][1])
        print(f"\nsuper-Fibonacci's deepest hole: {float(angle)!r} rad, at {hole.tolist()}")


if __name__ == "__main__":
    main()
