#!/usr/bin/env python3
"""Measures this crate's benches and what else there is for the same work, in one run.

    python3 peers.py [--quick] [--core N]

Prints one Markdown table: speeds on one thread, the best of several repeats, and remarks on what was
seen. Needs cargo, numpy and scipy, and uses pyrecest where it is installed. Exit code 2 where cargo,
numpy or scipy is missing or the benches fail.

Ours are criterion's samples, the shortest of each id, for whatever the groups uniform, rcg and normaliser
hold; each group is run before and after the others of its work, so that all see the same machine. The
others are called for many attitudes at once, as is usual in Python; the generator is numpy's PCG64.
"Of ours" is a speed divided by that of the fastest of ours for the same work.
"""

import argparse
import json
import math
import os
import platform
import shutil
import subprocess
import sys
import time
import warnings
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is loaded

try:
    import numpy as np
    import scipy
    from scipy import integrate, optimize, stats
    from scipy.spatial.transform import Rotation
except ImportError as error:
    print(f"peers.py needs numpy and scipy: {error}", file=sys.stderr)
    sys.exit(2)

CRATE = Path(__file__).resolve().parents[1]
# Benches of laws that no other program is measured on.
OTHER_LAWS = ("isotropic", "four-scales")


class Law:
    """exp(-(x - m)' S^-1 (x - m) / 2) on the unit sphere of R4, S diagonal, scalar last."""

    def __init__(self, mean, variances, ln_c):
        self.mean = np.array(mean) / np.linalg.norm(mean)
        self.variances = np.array(variances)
        self.ln_c = ln_c  # from 200-bit arithmetic

    def ln_weight(self, x):
        return -0.5 * ((x - self.mean) ** 2 / self.variances).sum(-1)


# The example of Peck (2003), Eq. 27 and 30, and a mild law.
PAPER = Law((0.0249, 0.0005, -0.0100, 0.9996), (2e-5, 6e-4, 6e-4, 0.6), -10.035477697452611)
MILD = Law((1, 2, 3, 4), (0.1, 0.2, 0.3, 0.4), 0.3458571649223226)


def best(work, repeats):
    """The shortest of several times, after one call that is not counted, and the last result."""
    result, shortest = work(), math.inf
    for _ in range(repeats):
        start = time.perf_counter()
        result = work()
        shortest = min(shortest, time.perf_counter() - start)
    return shortest, result


def rate(seconds):
    return f"{1e-6 / seconds:.3g} M/s" if seconds < 1e-5 else f"{1 / seconds:,.0f} /s"


def duration(seconds):
    for unit, size in (("s", 1), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            break
    return f"{seconds / size:.3g} {unit}"


class Table:
    def __init__(self):
        self.rows = []

    def add(self, work, who, seconds, remark="", ours=False, same=True):
        """Seconds for one attitude or one constant; None where there is none to time."""
        self.rows.append((work, who, seconds, remark, ours, same))

    def print(self):
        print("| work | who | speed | of ours | remark |\n|---|---|---|---|---|")
        for work, who, seconds, remark, ours, same in self.rows:
            fastest = min((r[2] for r in self.rows if r[0] == work and r[4] and r[5]), default=None)
            speed = "–"
            if seconds is not None:
                speed = duration(seconds) if work.startswith("normaliser") else rate(seconds)
            ratio = f"{fastest / seconds:.2g}" if seconds and fastest and same else "–"
            print(f"| {work} | {who} | {speed} | {ratio} | {remark} |")


class Benches:
    """Our benches, by cargo. What criterion wrote before this run is not looked at."""

    def __init__(self, arguments):
        self.seconds, self.span, self.began = {}, [], time.time()
        if arguments.quick:
            self.span = ["--warm-up-time", "0.5", "--measurement-time", "1"]
        metadata = self.cargo("metadata", "--no-deps", "--format-version", "1")
        self.results = Path(json.loads(metadata)["target_directory"]) / "criterion"
        self.bench("--no-run")

    @staticmethod
    def cargo(*command):
        done = subprocess.run(["cargo", *command], cwd=CRATE, capture_output=True, text=True)
        if done.returncode != 0:
            print(f"peers.py: cargo {command[0]} failed:\n{done.stderr[-2000:]}", file=sys.stderr)
            sys.exit(2)
        return done.stdout

    def bench(self, *extra):
        self.cargo("bench", "-p", "gyradius-attitude", "--bench", "attitude", *extra)

    def run(self, group):
        """Runs a group; of every id the shortest sample since the start counts."""
        self.bench("--", f"^{group}/", *self.span)
        for path in sorted(self.results.glob("**/new/sample.json")):
            about = json.loads((path.parent / "benchmark.json").read_text())
            if about["group_id"] != group or path.stat().st_mtime < self.began - 1:
                continue
            units = about.get("throughput") or {}
            number = units.get("Elements") or units.get("ElementsAndBytes", {}).get("elements", 1)
            sample, name = json.loads(path.read_text()), about["full_id"]
            least = min(t / i for t, i in zip(sample["times"], sample["iters"])) * 1e-9 / number
            self.seconds[name] = min(least, self.seconds.get(name, math.inf))

    def report(self, table, group):
        for name, seconds in self.seconds.items():
            if name.split("/")[0] != group:
                continue
            other = any(law in name for law in OTHER_LAWS)
            law = "other laws" if other else "mild law" if "mild" in name else "paper"
            work = group if group == "uniform" else f"{group}, {law}"
            ready = "with moments" + (" and the sampler's set-up" if "sampler" in name else "")
            remark = ready if group == "normaliser" else ""
            table.add(work, f"`{name}`", seconds, remark, True, not other)


def uniform(table, arguments, pyrecest):
    rng = np.random.default_rng(1)

    def normals(n):
        x = rng.standard_normal((n, 4))
        x /= np.sqrt(np.einsum("ij,ij->i", x, x))[:, None]
        return x

    def angles(n):
        square, a, b = rng.random((3, n))
        a *= 2 * np.pi
        b *= 2 * np.pi
        r, s = np.sqrt(1 - square), np.sqrt(square)
        return np.stack([r * np.sin(a), r * np.cos(a), s * np.sin(b), s * np.cos(b)], 1)

    def rotations(n):
        try:
            return Rotation.random(n, rng=rng)
        except TypeError:  # before scipy 1.15
            return Rotation.random(n, random_state=rng)

    ways = [
        ("scipy `Rotation.random`", rotations),
        ("numpy, four normals over their norm", normals),
        ("numpy, two angles (Shoemake)", angles),
        ("scipy `uniform_direction(4)`", lambda n: stats.uniform_direction(4, seed=rng).rvs(n)),
        ("scipy `special_ortho_group(3)`", lambda n: stats.special_ortho_group(3, seed=rng).rvs(n)),
    ]
    if pyrecest:
        law = pyrecest.HypersphericalUniformDistribution(3)
        ways.append(("pyrecest `HypersphericalUniformDistribution`", law.sample))
    for who, draw in ways:
        # Within the caches and beyond them.
        times = {n: best(lambda: draw(n), arguments.best)[0] / n for n in (10_000, 100_000)}
        n = min(times, key=times.get)
        table.add("uniform", who, times[n], f"{n:,} at once")
    if not pyrecest:
        table.add("uniform", "pyrecest", None, "not installed")


def from_uniform(law, rng, n):
    """Uniform proposals; exact, as the weight is one at the mean and less elsewhere."""
    x = rng.standard_normal((n, 4))
    x /= np.linalg.norm(x, axis=1)[:, None]
    return x[rng.random(n) < np.exp(law.ln_weight(x))]


class AngularCentralGaussian:
    """The envelope of Kent, Ganeiber & Mardia (2018), doi:10.1080/10618600.2017.1390468.

    For density exp(g'x - x'Ax), with k = |g| and u = x'g/k: k u <= k (u^2/t + t)/2, with equality at
    u = t, leaves a Bingham law, and exp(-v) <= exp(-(4 - b)/2) (4/b)^2 (1 + 2v/b)^-2 an angular central
    Gaussian one. Our reading of the paper has t = 1: the bound touches where x lies along g.
    """

    def __init__(self, law, t):
        self.g, self.a = law.mean / law.variances, 0.5 / law.variances
        k = np.linalg.norm(self.g)
        eigen, self.axes = np.linalg.eigh(np.diag(self.a) - np.outer(self.g, self.g) / (2 * t * k))
        excess = eigen - eigen[0]
        b = optimize.brentq(lambda b: np.sum(1 / (b + 2 * excess)) - 1, 1e-9, 4.0 + 1e-9)
        self.omega = 1 + 2 * excess / b
        self.ln_bound = 0.5 * k * t - eigen[0] - 0.5 * (4 - b) + 2 * math.log(4 / b)
        ln_mass = self.ln_bound - 0.5 * np.sum(np.log(self.omega)) + math.log(2 * math.pi**2)
        self.ln_acceptance = law.ln_c + 0.5 * np.sum(law.mean**2 / law.variances) - ln_mass

    def draw(self, rng, n):
        y = rng.standard_normal((n, 4)) / np.sqrt(self.omega)
        y /= np.linalg.norm(y, axis=1)[:, None]
        x = y @ self.axes.T
        ln_ratio = x @ self.g - (x * x) @ self.a - self.ln_bound + 2 * np.log((y * y) @ self.omega)
        return x[np.log(rng.random(n)) < ln_ratio]

    @staticmethod
    def best_of(law):
        cost = lambda s: -AngularCentralGaussian(law, math.exp(s)).ln_acceptance
        starts = np.linspace(-7, 0, 200)
        s = starts[np.argmin([cost(s) for s in starts])]
        return math.exp(optimize.minimize_scalar(cost, bracket=(s - 0.05, s, s + 0.05)).x)


def rcg(table, arguments, pyrecest):
    n = 100_000 if arguments.quick else 1_000_000
    rng, work = np.random.default_rng(1), "rcg, paper"
    seconds, _ = best(lambda: from_uniform(PAPER, rng, n), arguments.best // 2 + 1)
    acceptance = math.exp(PAPER.ln_c) / (2 * math.pi**2)
    table.add(work, "numpy, rejection from the uniform law", seconds / n / acceptance, f"accepts {acceptance:.1e}")
    published, t = AngularCentralGaussian(PAPER, 1.0), AngularCentralGaussian.best_of(PAPER)
    table.add(
        work,
        "numpy, ACG envelope (Kent et al.), t = 1",
        None,
        f"accepts {math.exp(published.ln_acceptance):.0e}: none to be had",
    )
    envelope = AngularCentralGaussian(PAPER, t)
    seconds, draws = best(lambda: envelope.draw(rng, n), arguments.best // 2 + 1)
    expected = n * math.exp(envelope.ln_acceptance)
    assert abs(len(draws) - expected) < 6 * math.sqrt(expected), (len(draws), expected)
    table.add(
        work,
        f"numpy, the same, t = {t:.4f} by search",
        seconds / expected,
        f"accepts {math.exp(envelope.ln_acceptance):.2%}; {(draws[:, 3] < 0).mean():.2%} in the far half",
    )

    def normalised():
        x = PAPER.mean + np.sqrt(PAPER.variances) * rng.standard_normal((n, 4))
        return x / np.linalg.norm(x, axis=1)[:, None]

    seconds, draws = best(normalised, arguments.best // 2 + 1)
    far = (draws[:, 3] < 0).mean()
    table.add(
        work, "numpy, Gaussian over its norm", seconds / n, f"another law: {far:.2%} in the far half", same=False
    )
    if not pyrecest:
        table.add(work, "pyrecest", None, "not installed")
        return
    from pyrecest import backend

    rows = 500 if arguments.quick else 2000
    backend.random.seed(1)
    law = pyrecest.CustomHypersphericalDistribution(lambda x: np.exp(PAPER.ln_weight(np.atleast_2d(x))), 3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        start = time.perf_counter()
        chain = law.sample_metropolis_hastings(rows)
        seconds = time.perf_counter() - start
    distinct = len(np.unique(chain, axis=0))
    table.add(
        work,
        "pyrecest, Metropolis-Hastings with its defaults",
        seconds / rows,
        f"a chain: {distinct} distinct rows of {rows:,}",
        same=False,
    )


class TooLong(Exception):
    pass


def quadrature(law, limit):
    """ln C by scipy's adaptive rule in the hyperspherical angles, with its default tolerances."""
    (m1, m2, m3, m4), (h1, h2, h3, h4) = law.mean.tolist(), (-0.5 / law.variances).tolist()
    start, calls, sin, cos, exp = time.perf_counter(), 0, math.sin, math.cos, math.exp

    def weight(c, b, a):
        nonlocal calls
        calls += 1
        if calls % 10_000 == 0 and time.perf_counter() - start > limit:
            raise TooLong
        sa, sb = sin(a), sin(b)
        d1, d2, d3, d4 = sa * sb * cos(c) - m1, sa * sb * sin(c) - m2, sa * cos(b) - m3, cos(a) - m4
        return exp(h1 * d1 * d1 + h2 * d2 * d2 + h3 * d3 * d3 + h4 * d4 * d4) * sa * sa * sb

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            value = integrate.tplquad(weight, 0, math.pi, 0, math.pi, 0, 2 * math.pi)[0]
            remark = f"ln C off by {abs(math.log(value) - law.ln_c):.0e}"
        except TooLong:
            remark = f"stopped after {limit} s"
    if any(issubclass(w.category, integrate.IntegrationWarning) for w in caught):
        remark += ", warns"
    return time.perf_counter() - start, f"{remark}; {calls:,} evaluations"


class Saddlepoint:
    """Kume & Wood (2005), doi:10.1093/biomet/92.2.465, of first order and with their correction exp(T)."""

    def __init__(self, law):
        a, g = 0.5 / law.variances, law.mean / law.variances
        order = np.argsort(a)
        a, g = a[order], g[order]
        k = lambda j, t: np.sum(
            0.5 * math.factorial(j - 1) / (a - t) ** j + 0.25 * math.factorial(j) * g**2 / (a - t) ** (j + 1)
        )
        # The root has a0 - t between 1/2 and 2 + |g|: one term reaches one, four terms stay below.
        t = optimize.brentq(lambda t: k(1, t) - 1, a[0] - 2 - np.linalg.norm(g), a[0] - 0.5, xtol=1e-14)
        self.first = (
            0.5 * math.log(2)
            + 1.5 * math.log(math.pi)
            - 0.5 * math.log(k(2, t))
            - 0.5 * np.sum(np.log(a - t))
            - t
            + 0.25 * np.sum(g**2 / (a - t))
            - 0.5 * np.sum(law.mean**2 / law.variances)
        )
        self.corrected = self.first + k(4, t) / k(2, t) ** 2 / 8 - 5 / 24 * k(3, t) ** 2 / k(2, t) ** 3
        # Where `fb.saddle` of the R package Directional looks for the root.
        low = a[0] - 1 - 0.5 * math.sqrt(4 + 4 * g.max() ** 2)
        high = a[0] - 0.25 - 0.5 * math.sqrt(0.25 + g.min() ** 2)
        self.bracketed = k(1, low) < 1 < k(1, high)


def normaliser(table, arguments, _):
    limit = 10 if arguments.quick else 120
    for name, law in (("paper", PAPER), ("mild law", MILD)):
        work = f"normaliser, {name}"
        seconds, approximation = best(lambda: Saddlepoint(law), 200)
        off = [abs(x - law.ln_c) for x in (approximation.first, approximation.corrected)]
        remark = f"ln C off by {off[0]:.1e}, with exp(T) by {off[1]:.1e}"
        if not approximation.bracketed:
            remark += "; `Directional`'s bracket misses the root"
        table.add(work, "numpy, saddlepoint (Kume & Wood)", seconds, remark)
        seconds, remark = quadrature(law, limit)
        table.add(work, "scipy `tplquad`", None if "stopped" in remark else seconds, remark)


def machine():
    model = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{model}, {os.cpu_count()} CPUs, {platform.system()} {platform.machine()}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="short times and few draws: does it run at all?")
    parser.add_argument("--core", type=int, help="keep to this CPU (Linux)")
    arguments = parser.parse_args()
    arguments.best = 3 if arguments.quick else 15
    if arguments.core is not None:
        allowed = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set()
        if arguments.core not in allowed:
            parser.error(f"--core {arguments.core}: can be one of {sorted(allowed) or 'none on this system'}")
    if not shutil.which("cargo"):
        print("peers.py needs cargo, to run the benches of gyradius-attitude", file=sys.stderr)
        sys.exit(2)
    try:
        import pyrecest.distributions as pyrecest
        from importlib.metadata import version

        extra = f", pyrecest {version('pyrecest')}"
    except ImportError:
        pyrecest, extra = None, ""
    table, benches = Table(), Benches(arguments)
    if arguments.core is not None:  # after the build, which may use every core
        os.sched_setaffinity(0, {arguments.core})
    for peers in (uniform, rcg, normaliser):
        benches.run(peers.__name__)
        theirs = Table()
        peers(theirs, arguments, pyrecest)
        if not arguments.quick:
            benches.run(peers.__name__)
        benches.report(table, peers.__name__)
        table.rows += theirs.rows
    rustc = subprocess.run(["rustc", "--version"], capture_output=True, text=True).stdout.split()
    # By work, in the order in which works first appear.
    works = list(dict.fromkeys(row[0] for row in table.rows))
    table.rows.sort(key=lambda row: works.index(row[0]))
    table.print()
    print(
        f"\n{machine()}; one thread{', quick' if arguments.quick else ''}. rustc {' '.join(rustc[1:2])}, "
        f"Python {platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}{extra}."
    )


if __name__ == "__main__":
    main()
