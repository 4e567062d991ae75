"""Laws against SciPy, quadrature and their own moments, with negative controls."""

from __future__ import annotations

import pickle
import warnings
from collections.abc import Callable

import numpy as np
import pytest
from conftest import bodies, inertias
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

import gyradius
from gyradius import MassProperties, MassPropertiesLaw, ScalarLaw, normal, uniform

SCALARS: list[tuple[ScalarLaw, object]] = [
    (normal(2.0, 0.3), stats.norm(2.0, 0.3)),
    (uniform(-1.0, 4.0), stats.uniform(-1.0, 5.0)),
    (ScalarLaw("lognormal", mean=3.0, sigma=1.0), stats.lognorm(s=np.sqrt(np.log(1 + 1 / 9)), scale=3 / np.sqrt(1 + 1 / 9))),
    (ScalarLaw("triangular", low=1.0, mode=2.0, high=6.0), stats.triang(0.2, 1.0, 5.0)),
    (ScalarLaw("beta", low=1.0, high=3.0, alpha=2.0, beta=5.0), stats.beta(2, 5, 1.0, 2.0)),
    (ScalarLaw("weibull", low=1.0, scale=2.0, shape=1.5), stats.weibull_min(1.5, 1.0, 2.0)),
]


@pytest.mark.parametrize(("law", "other"), SCALARS)
def test_numbers_have_the_laws_of_scipy(law: ScalarLaw, other: stats.rv_continuous) -> None:
    drawn = law.rvs(20_000, rng=7)
    assert stats.kstest(drawn, other.cdf).pvalue > 1e-4
    # A control: a law that is a little wider is found.
    assert stats.kstest(law.mean + 1.1 * (drawn - law.mean), other.cdf).pvalue < 1e-3
    assert law.mean == pytest.approx(other.mean(), rel=1e-9)
    assert law.std == pytest.approx(other.std(), rel=1e-9)
    x = np.linspace(law.mean - 4 * law.std, law.mean + 4 * law.std, 41)
    assert np.allclose(law.cdf(x), other.cdf(x), atol=1e-9)
    assert np.allclose(law.sf(x), other.sf(x), atol=1e-12, rtol=0)
    # Farther out SciPy's beta law warns.
    least = -9 if law.form["law"] == "beta" else -300
    q = np.concatenate([np.linspace(0, 1, 101), 10.0 ** np.arange(least, 0, 4), 1 - 10.0 ** np.arange(-9, 0)])
    assert np.allclose(law.ppf(q), other.ppf(q), rtol=1e-9, atol=1e-12)
    # Far out, as a share.
    far = other.isf([1e-3, 1e-6, 1e-9])
    assert np.allclose(law.sf(far) / other.sf(far), 1.0, rtol=1e-4)
    assert law.sf(np.inf) == 0.0 and law.sf(-np.inf) == 1.0 and law.cdf(-np.inf) == 0.0
    wrong = np.array([[np.nan, -1e-9], [1 + 1e-9, np.inf]])
    assert np.isnan(law.ppf(wrong)).all() and np.isnan(law.cdf(np.nan)) and np.isnan(law.sf(np.nan))
    assert np.isnan(law.logpdf([np.nan, law.mean])).tolist() == [True, False] and np.isnan(law.logpdf(np.nan))
    assert law.ppf(0.5).shape == () and law.ppf(np.full((2, 0, 3), 0.5)).shape == (2, 0, 3)
    inside = other.pdf(x) > 0
    assert np.allclose(law.logpdf(x)[inside], other.logpdf(x[inside]), atol=1e-8)


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40), st.floats(0.0, 1.0))
def test_steps_are_inverted_as_scipy_does(samples: list[float], p: float) -> None:
    law = ScalarLaw("samples", samples=samples)
    x = np.sort(samples)
    shares = np.append(np.arange(1, len(x) + 1) / len(x), p)
    # The first of the samples whose share reaches that.
    expected = [x[np.argmax(np.arange(1, len(x) + 1) / len(x) >= share)] for share in shares]
    assert law.ppf(shares).tolist() == expected
    assert (law.cdf(law.ppf(shares)) >= shares).all()
    assert np.allclose(law.sf(x), 1 - law.cdf(x), atol=1e-15)
    event = ScalarLaw("bernoulli", probability=p)
    inner = shares[(shares > 0) & (abs(shares - (1 - p)) > 1e-12)]
    assert event.ppf(inner).tolist() == stats.bernoulli(p).ppf(inner).tolist()


@pytest.mark.parametrize("law", [normal(2.0, 0.0), uniform(2.0, 2.0), ScalarLaw("weibull", low=2.0, scale=0.0, shape=2.0)])
def test_what_is_known_has_itself_as_every_quantile(law: ScalarLaw) -> None:
    assert law.ppf([0.0, 0.3, 1.0]).tolist() == [2.0] * 3
    assert law.sf([1.0, 2.0, 3.0]).tolist() == [1.0, 0.0, 0.0]


def test_table_of_samples() -> None:
    law = ScalarLaw("samples", samples=np.array([1.0, 2.0, 4.0]))
    assert set(law.rvs(200, rng=1)) == {1.0, 2.0, 4.0}
    assert law.mean == pytest.approx(7 / 3)
    with pytest.raises(ValueError, match="not known"):
        law.logpdf(1.0)


@pytest.mark.parametrize(
    ("name", "keys", "word"),
    [
        ("normal", {"mean": 1.0}, "sigma"),
        ("normal", {"mean": 1.0, "sigma": -1.0}, "sigma"),
        ("normal", {"mean": float("nan"), "sigma": 1.0}, "NaN|number"),
        ("normal", {"mean": 1.0, "sigma": 1.0, "colour": 3}, "colour"),
        ("uniform", {"low": 2.0, "high": 1.0}, "high|low|bounds"),
        ("gaussian", {"mean": 1.0, "sigma": 1.0}, "gaussian"),
        ("samples", {"samples": []}, "samples"),
    ],
)
def test_laws_of_numbers_that_are_refused(name: str, keys: dict[str, object], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        ScalarLaw(name, **keys)


def test_uniform_attitudes_are_uniform() -> None:
    law = gyradius.uniform_attitude()
    q = law.rvs(50_000, rng=3)
    assert np.allclose(np.linalg.norm(q, axis=1), 1.0, atol=1e-15)
    # The coordinates of uniform points on S³ squared, each Beta(1/2, 3/2); the pole of the rotation likewise.
    for k in range(4):
        assert stats.kstest(q[:, k] ** 2, stats.beta(0.5, 1.5).cdf).pvalue > 1e-4
    assert stats.kstest((1.02 * q[:, 0]) ** 2, stats.beta(0.5, 1.5).cdf).pvalue < 1e-4
    assert np.allclose(law.logpdf(q), 0.0)


@pytest.mark.filterwarnings("ignore:cov. rotations of")
def test_densities_of_attitudes_integrate_to_one() -> None:
    uniform_q = gyradius.uniform_attitude().rvs(200_000, rng=1)
    mean = np.array([0.1, 0.2, -0.3, 0.9])
    for law in (
        gyradius.small_rotations(mean, np.diag([0.3, 0.2, 0.4])),
        gyradius.radially_constrained_gaussian(mean / np.linalg.norm(mean), np.diag([0.2, 0.3, 0.1, 0.2])),
        gyradius.bingham(np.diag([5.0, 3.0, 4.0, 0.0])),
        gyradius.fisher_bingham(np.diag([2.0, 1.0, 2.0, 0.0]), [0.0, 1.0, 0.0, 2.0]),
    ):
        weight = np.exp(law.logpdf(uniform_q))
        error = weight.std() / np.sqrt(weight.size)
        assert abs(weight.mean() - 1.0) < 5 * error < 0.1
        # Draws against the density: the mean of any function, here q qᵀ, by weights.
        drawn = law.rvs(100_000, rng=2)
        by_weight = np.einsum("n,ni,nj->ij", weight, uniform_q, uniform_q) / weight.sum()
        assert np.allclose(np.einsum("ni,nj->ij", drawn, drawn) / len(drawn), by_weight, atol=0.02)


def test_attitudes_in_either_order() -> None:
    mean, cov = np.array([0.1, -0.2, 0.3, 0.9]), np.diag([1e-3, 2e-3, 3e-3, 4e-3])
    first = np.array([3, 0, 1, 2])
    one = gyradius.radially_constrained_gaussian(mean, cov)
    two = gyradius.radially_constrained_gaussian(mean[first], cov[np.ix_(first, first)], order="wxyz")
    assert (one.rvs(10, rng=1)[:, first] == two.rvs(10, rng=1, order="wxyz")).all()
    q = one.rvs(10, rng=1)
    assert np.allclose(one.logpdf(q), two.logpdf(-3.0 * q[:, first], order="wxyz"), atol=1e-12)
    three = gyradius.fisher_bingham(np.diag([1.0, 2.0, 3.0, 4.0]), [1.0, 2.0, 3.0, 4.0])
    four = gyradius.fisher_bingham(np.diag([4.0, 1.0, 2.0, 3.0]), [4.0, 1.0, 2.0, 3.0], order="wxyz")
    assert np.allclose(three.logpdf(q), four.logpdf(q), atol=1e-12)
    with pytest.raises(ValueError, match="order"):
        one.rvs(1, order="zyxw")


def test_turns_about_an_axis() -> None:
    drawn = gyradius.about_axis([0, 0, 0, 1], [0, 0, 2]).rvs(20_000, rng=1)
    assert np.allclose(drawn[:, :2], 0.0)
    angle = np.mod(2 * np.arctan2(drawn[:, 2], drawn[:, 3]), 2 * np.pi)
    assert stats.kstest(angle, stats.uniform(0, 2 * np.pi).cdf).pvalue > 1e-4
    with pytest.raises(ValueError, match="axis"):
        gyradius.about_axis([0, 0, 0, 1], [0, 0, 0])


def test_fits_of_attitudes_find_the_law() -> None:
    truth = gyradius.small_rotations([0.3, 0.1, -0.2, 0.8], np.diag([1e-3, 2e-3, 4e-3]))
    fit = gyradius.AttitudeLaw.fit(truth.rvs(4000, rng=5))
    assert abs(fit.law.mean @ truth.mean) > np.cos(0.005)
    assert np.allclose(np.diag(fit.law.cov), np.diag(truth.cov), rtol=0.1)


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [
        ("wishart", {"delta": 0.1}),
        ("entrywise", {"deviation_kg_m2": np.full((3, 3), 0.05)}),
        ("basilisk", {"diagonal_deviation_kg_m2": 0.1, "angle_deviation_rad": 0.02}),
    ],
)
def test_models_of_inertia_have_their_moments(kind: str, parameters: dict[str, object]) -> None:
    nominal = np.array([[5.0, 0.1, -0.2], [0.1, 4.0, 0.3], [-0.2, 0.3, 3.0]])
    law = gyradius.InertiaLaw.about(kind, nominal, **parameters)
    drawn = law.rvs(40_000, rng=7)
    entries = drawn[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    error = law.std / np.sqrt(len(drawn))
    assert (np.abs(entries.mean(axis=0) - law.mean[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]) < 5 * error + 1e-12).all()
    assert np.allclose(entries.std(axis=0), law.std, rtol=0.03)
    assert law.name == kind


@pytest.mark.parametrize(("share", "exists"), [(0.1, True), (1.0, True), (2.0, True), (3.0, True), (4.0, False), (6.0, False)])
def test_moments_with_which_no_log_cholesky_law_is_found_are_told(share: float, exists: bool) -> None:
    mean, deviations = np.array([5, 4, 3, 0, 0, 0.0]), share * np.array([0.35, 0.35, 0.35, 0.2, 0.2, 0.2])
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        law = gyradius.InertiaLaw.matched("log-cholesky", mean, np.diag(deviations**2))
    gap = np.abs(np.diag(law.mean) - mean[:3]) / deviations[:3]
    assert bool(gap.max() < 1e-6) == exists
    assert [("no log-cholesky law" in str(one.message)) for one in told] == ([] if exists else [True])


def test_every_model_can_be_matched() -> None:
    base = gyradius.InertiaLaw.about("wishart", np.diag([5.0, 4.0, 3.0]), delta=0.05)
    mean = base.mean[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    for kind, what in gyradius.InertiaLaw.kinds().items():
        law = gyradius.InertiaLaw.matched(kind, mean, base.cov)
        drawn = law.rvs(2000, rng=1)
        assert drawn.shape == (2000, 3, 3)
        if what["realizable"]:
            assert gyradius.is_realizable(drawn).all() and law.is_realizable
        assert gyradius.InertiaLaw.of(law.form) == law or np.array_equal(
            gyradius.InertiaLaw.of(law.form).rvs(5, rng=1), law.rvs(5, rng=1)
        )


def test_principal_laws_and_their_density() -> None:
    roots = [normal(31.6, 0.35), uniform(44.0, 45.0), 54.8]
    law = gyradius.InertiaLaw.principal(roots, gyradius.fixed_attitude([0, 0, 0, 1]))
    drawn = law.rvs(20_000, rng=2)
    k = 0.5 * np.trace(drawn, axis1=1, axis2=2)[:, None] - np.diagonal(drawn, axis1=1, axis2=2)
    assert stats.kstest(np.sqrt(k[:, 0]), stats.norm(31.6, 0.35).cdf).pvalue > 1e-4
    assert stats.kstest(np.sqrt(k[:, 1]), stats.uniform(44, 1).cdf).pvalue > 1e-4
    assert np.allclose(np.sqrt(k[:, 2]), 54.8)
    one = gyradius.InertiaLaw.about("wishart", np.diag([5.0, 4.0, 3.0]), delta=0.2)
    two = gyradius.InertiaLaw.about("wishart", np.diag([5.2, 4.1, 2.9]), delta=0.25)
    some = two.rvs(100_000, rng=4)
    ratio = np.exp(one.logpdf(some) - two.logpdf(some))
    assert abs(ratio.mean() - 1.0) < 5 * ratio.std() / np.sqrt(ratio.size) < 0.1
    assert one.logpdf(np.diag([9.0, 1.0, 1.0])) == -np.inf and np.isnan(one.logpdf(np.full((3, 3), np.nan)))
    for bad in ("wishart", "tensor"):
        with pytest.raises(ValueError, match="delta|tensor"):
            gyradius.InertiaLaw.about(bad, np.diag([5.0, 4.0, 3.0]))
    with pytest.raises(ValueError, match="colour"):
        gyradius.InertiaLaw.about("wishart", np.eye(3), delta=0.1, colour=1)
    with pytest.raises(ValueError, match="delta"):
        gyradius.InertiaLaw.about("entrywise", np.eye(3), deviation_kg_m2=np.full((3, 3), 0.05), delta=0.1)


STATED = [
    {"mass": "5%"},
    {"centre": "1cm"},
    {"centre": "1cm, 5mm, 0.002m"},
    {"moments": "10%"},
    {"axes": "2deg"},
    {"products": "0.0002kgm2"},
    {"mass": "0.1kg", "moments": ("5%", "6%", "7%")},
    {"mass": "5%", "centre": "1cm", "moments": "10%", "axes": "2deg"},
    {"mass": {"percent": 15, "sigmas": 3}, "axes": {"deg": 6, "sigmas": 3}},
]


@pytest.mark.parametrize("said", STATED)
def test_statements_come_true(said: dict[str, object], link: MassProperties) -> None:
    law = gyradius.law(link, **said)
    drawn = law.rvs(40_000, rng=7)
    assert drawn.is_realizable.all() and law.acceptance == 1.0
    std = drawn.array.std(axis=0)
    assert np.allclose(std, law.std, rtol=0.03, atol=1e-9)
    assert np.allclose(drawn.array.mean(axis=0), law.mean.array, atol=5 * (law.std.max() + 1e-12) / 200)
    if "mass" in said:
        expected = 0.1 if said["mass"] == "0.1kg" else 0.05 * 2.4
        assert std[0] == pytest.approx(expected, rel=0.03)
    else:
        assert np.ptp(drawn.mass) == 0.0
    if said.get("centre") == "1cm":
        assert np.allclose(std[1:4], 0.01, rtol=0.03)
    if said.get("moments") == "10%":
        assert np.allclose(std[4:7], 0.1 * np.diag(link.inertia), rtol=0.1)
    if said == {"mass": "5%"}:
        ratio = drawn.inertia / link.inertia
        assert np.allclose(ratio, (drawn.mass / 2.4)[:, None, None], rtol=1e-9)


@pytest.mark.parametrize(
    ("said", "word"),
    [
        ({"mass": "5"}, "mass"),
        ({"mass": 0.05}, "mass"),
        ({"mass": "-5%"}, "mass"),
        ({"centre": "5%"}, "centre"),
        ({"moments": "5%,6%"}, "moments"),
        ({"axes": "nan deg"}, "axes"),
        ({"mass": {"percent": 5, "sigmas": 0}}, "sigmas"),
        ({"mass": {"percent": 5, "sigmas": 1, "colour": 2}}, "colour"),
        ({"mass": "5%", "sigmas": 0.0}, "sigmas"),
        ({}, "nothing is stated"),
        ({"mass": None, "sigmas": 3.0}, "nothing is stated"),
    ],
)
def test_statements_that_are_refused(said: dict[str, object], word: str, link: MassProperties) -> None:
    with pytest.raises(ValueError, match=word):
        gyradius.law(link, **said)


def test_statements_inside_a_region(link: MassProperties) -> None:
    region = gyradius.ellipsoid(link.centre, semi_axes=[0.2, 0.075, 0.075])
    law = gyradius.law(link, centre="2cm", moments="10%", inside=region)
    assert 0.0 < law.acceptance < 1.0
    drawn = law.rvs(500, rng=1)
    assert (region.holds(drawn) == 1.0).all()
    free = gyradius.law(link, centre="2cm", moments="10%").rvs(500, rng=1)
    assert (region.holds(free) == 0.0).any()
    with pytest.raises(ValueError, match="not known"):
        _ = law.cov


def laws_of_bodies() -> dict[str, MassPropertiesLaw]:
    body = bodies(np.random.default_rng(11), 1)[0]
    spread = np.diag(np.full(10, 0.02))
    lengths = [normal(0.12, 0.006), normal(0.03, 0.0015), normal(0.02, 0.001)]
    axes = gyradius.small_rotations([0, 0, 0, 1], np.eye(3) * 3e-3)
    centre = [normal(0.15, 0.003), uniform(-0.01, 0.01), 0.02]
    return {
        "lengths": MassPropertiesLaw.joint(normal(2.4, 0.1), centre, gyration_lengths=lengths, axes=axes),
        "roots": MassPropertiesLaw.joint(
            ScalarLaw("lognormal", mean=2.4, sigma=0.3),
            centre,
            roots=lengths,
            axes=axes,
            follows=0.5,
            nominal_mass=2.4,
            correlations=[("mass", "shape1", 0.6)],
        ),
        "model": MassPropertiesLaw.joint(
            normal(2.4, 0.1), centre, inertia=gyradius.InertiaLaw.about("wishart", np.diag([5.0, 4.0, 3.0]), delta=0.1)
        ),
        "log-cholesky": MassPropertiesLaw.log_cholesky(body, spread @ spread),
        "maximum-entropy": MassPropertiesLaw.maximum_entropy(body, mass_delta=0.1, centre_std=0.01, delta=0.1),
        "wishart": MassPropertiesLaw.pseudo_inertia_wishart(body, 200.0),
    }


def test_a_nominal_mass_goes_with_what_follows_it() -> None:
    def joint(**given: float) -> MassPropertiesLaw:
        lengths = [normal(0.12, 0.006), normal(0.03, 0.0015), normal(0.02, 0.001)]
        return MassPropertiesLaw.joint(
            normal(2.4, 0.1), [0.0, 0.0, 0.0], roots=lengths, axes=gyradius.uniform_attitude(), **given
        )

    joint(follows=0.5, nominal_mass=2.4)
    for given in ({"nominal_mass": 2.4}, {"nominal_mass": -7.0}, {"follows": 0.5}):
        with pytest.raises(ValueError, match="nominal_mass"):
            joint(**given)


@pytest.mark.parametrize("name", list(laws_of_bodies()))
def test_laws_of_bodies_have_their_moments(name: str) -> None:
    law = laws_of_bodies()[name]
    drawn = law.rvs(40_000, rng=3)
    assert law.is_realizable and drawn.is_realizable.all()
    try:
        mean, cov = law.mean.array, law.cov
        found = drawn.array
    except ValueError:
        mean, cov = law.linear_moments
        found = drawn.linear
    std = np.sqrt(np.diag(cov))
    assert (np.abs(found.mean(axis=0) - mean) < 5 * std / 200 + 1e-9).all()
    scale = np.where(std > 1e-12, std, 1.0)
    assert np.allclose(np.cov((found / scale).T), cov / np.outer(scale, scale), atol=0.05)
    # A control: the mass counted twice is found.
    twice = drawn.with_mass(2.0 * drawn.mass).array
    if found is drawn.array:
        assert not np.allclose(twice.mean(axis=0), mean, rtol=0.05)


def test_naive_rules_draw_what_no_body_has(link: MassProperties) -> None:
    naive = MassPropertiesLaw.naive(link, "diagonal-factors", uniform(0.5, 1.5), mass=uniform(0.9, 1.1))
    drawn = naive.rvs(4000, rng=1)
    assert 0.3 < (~drawn.is_realizable).mean() < 0.9 and not naive.is_realizable
    assert MassPropertiesLaw.naive(link, "scale-all", uniform(0.5, 1.5)).rvs(4000, rng=1).is_realizable.all()
    with pytest.raises(ValueError, match="rule"):
        MassPropertiesLaw.naive(link, "guess", uniform(0.5, 1.5))


def test_there_and_back(link: MassProperties) -> None:
    law = gyradius.law(link, mass="5%", centre="1cm", moments="5%", axes="2deg")
    fit = MassPropertiesLaw.fit(law.rvs(2000, rng=9))
    assert np.allclose(fit.law.std, law.std, rtol=0.1, atol=1e-6)
    assert fit.found["mass"] is not None and "fits=" in repr(fit)
    inertia_fit = gyradius.InertiaLaw.fit(gyradius.InertiaLaw.about("wishart", link.inertia, delta=0.05).rvs(500, rng=1))
    assert np.allclose(inertia_fit.law.mean, link.inertia, rtol=0.05, atol=1e-4)
    with pytest.raises(ValueError, match="row 2 of 20"):
        bad = np.tile(np.eye(3), (20, 1, 1))
        bad[2] = np.diag([1.0, 1.0, 3.0])
        gyradius.InertiaLaw.fit(bad)
    with pytest.raises(ValueError, match="13"):
        gyradius.InertiaLaw.fit(np.tile(np.eye(3), (5, 1, 1)))


def test_estimates(link: MassProperties) -> None:
    truth = gyradius.law(link, mass="3%", centre="2mm", moments="4%", axes="1deg")
    mean, cov = truth.linear_moments
    found = gyradius.from_estimate(mean, cov)
    assert found.moved == pytest.approx(0.0, abs=1e-6)
    assert found.law.rvs(2000, rng=1).is_realizable.all()
    made, spread = found.law.linear_moments
    std = np.sqrt(np.diag(cov))
    assert (np.abs(made - mean) < 0.05 * std).all()
    assert np.allclose(np.sqrt(np.diag(spread)), std, rtol=0.05)
    # The law is the nearer one; deviations are told in percent.
    for deviations in (1.0, 30.0):
        near = gyradius.from_estimate(mean, deviations**2 * cov)
        both = ((near.joint, near.joint_distance), (near.log_cholesky, near.log_cholesky_distance))
        known = [(law, how) for law, how in both if law is not None and how is not None]
        best = min(known, key=lambda one: (not one[1]["is_exact"], one[1]["total"]))
        assert near.law is best[0]
        for law, how in known:
            ratio = np.sqrt(np.diag(law.linear_moments[1])) / (deviations * std)
            assert np.allclose(100.0 * (ratio - 1.0), how["deviations"], atol=0.5 * deviations)
    # One that no body has is moved.
    mean = mean.copy()
    mean[6] += 0.009
    far = gyradius.from_estimate(mean, cov)
    assert far.moved > 3.0 and far.nearest.is_realizable
    for bad, word in (({"form": "polar"}, "form"), ({"cov": -cov}, "covariance|cov")):
        with pytest.raises(ValueError, match=word):
            gyradius.from_estimate(**{"phi": mean, "cov": cov, **bad})  # type: ignore[arg-type]


@given(st.integers(0, 2**32))
def test_any_body_can_be_randomized(seed: int) -> None:
    rng = np.random.default_rng(seed)
    # Rods, plates and solids of any size, turned anyhow.
    body = MassProperties(10.0 ** rng.uniform(-3, 3), rng.normal(size=3), inertias(rng, 1)[0])
    law = gyradius.law(body, mass="10%", centre="5mm", moments="15%", axes="5deg")
    drawn = law.rvs(200, rng=seed)
    assert drawn.is_realizable.all()
    assert np.isfinite(drawn.array).all()


def test_any_law_of_attitudes_is_a_law_of_axes() -> None:
    roots, draws = [1.0, normal(2.0, 0.1), 3.0], 4000
    for axes in [
        gyradius.about_axis([0.1, -0.2, 0.3, 0.9], [0.0, 1.0, 1.0]),
        gyradius.fisher_bingham(np.diag([3.0, 1.0, 0.0, 7.0]), [0.3, -1.0, 2.0, 0.5]),
    ]:
        law = gyradius.InertiaLaw.principal(roots, axes)
        again = gyradius.InertiaLaw.of(law.form)
        drawn = law.rvs(draws, rng=3)
        assert np.array_equal(again.rvs(draws, rng=3), drawn)
        gap = np.abs(drawn.mean(axis=0) - law.mean) / np.maximum(drawn.std(axis=0), 1e-12)
        assert (gap < 5 / np.sqrt(draws)).all()
        joint = MassPropertiesLaw.joint(normal(10.0, 0.1), [0, 0, 0], roots=roots, axes=axes)
        assert np.isfinite(joint.rvs(10, rng=1).array).all()


LAWS: list[Callable[[], object]] = [
    lambda: gyradius.law(MassProperties.of(np.zeros((2, 10))), mass="5%"),
    lambda: MassPropertiesLaw.joint(1.0, [0, 0, 0]),
    lambda: MassPropertiesLaw.joint(1.0, [0, 0], roots=[1, 1, 1], axes=gyradius.uniform_attitude()),
    lambda: MassPropertiesLaw.joint(1.0, [0, 0, 0], roots=[1, 1], axes=gyradius.uniform_attitude()),
    lambda: MassPropertiesLaw.joint(-1.0, [0, 0, 0], roots=[1, 1, 1], axes=gyradius.uniform_attitude()),
    lambda: MassPropertiesLaw.joint("x", [0, 0, 0], roots=[1, 1, 1], axes=gyradius.uniform_attitude()),
    lambda: gyradius.InertiaLaw.principal([1, 2, 3], "uniform"),  # type: ignore[arg-type]
    lambda: gyradius.small_rotations([0, 0, 0, 0], np.eye(3)),
    lambda: gyradius.small_rotations([0, 0, 0, 1], -np.eye(3)),
    lambda: gyradius.radially_constrained_gaussian([0, 0, 0, 1], np.eye(3)),
]


@pytest.mark.parametrize("make", LAWS)
def test_laws_that_are_refused(make: Callable[[], object]) -> None:
    with pytest.raises(ValueError):
        make()


def test_sigmas_of_dicts_and_texts_are_one(link: MassProperties) -> None:
    said = [
        gyradius.law(link, mass="9%", sigmas=3.0),
        gyradius.law(link, mass={"percent": 9}, sigmas=3.0),
        gyradius.law(link, mass={"percent": 9, "sigmas": 3.0}, sigmas=1.0),
    ]
    assert said[0] == said[1] == said[2]
    for kind in (gyradius.AttitudeLaw, gyradius.InertiaLaw, MassPropertiesLaw, gyradius.StatedLaw):
        with pytest.raises(TypeError, match="made by"):
            kind()
    for bad in ({"axes": [0, 0, 0, 1]}, {"inertia": np.eye(3)}, {"inside": "box"}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            MassPropertiesLaw.joint(1.0, [0, 0, 0], **bad)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="inside"):
        gyradius.law(link, inside="box")  # type: ignore[arg-type]


def test_a_plate_that_is_written_with_six_digits_is_drawn() -> None:
    for moments, taken in ([1.0, 1.0, 2.000001], True), ([1.0, 1.0, 2.0001], False):
        plate = MassProperties(1.0, [0.0, 0.0, 0.1], np.diag(moments))
        if not taken:
            with pytest.raises(ValueError, match="no body has this inertia"):
                gyradius.law(plate, mass="5%")
            continue
        law = gyradius.law(plate, mass="5%", axes="2deg")
        draws = law.rvs(100, rng=1, inset=True)
        assert draws.is_realizable.all()
        assert np.allclose(draws.inertia.mean(axis=0), plate.inertia, atol=0.02)
        again = pickle.loads(pickle.dumps(law))
        assert np.array_equal(again.rvs(100, rng=1, inset=True).inertia, draws.inertia)


def test_scalar_laws_are_equal_if_they_say_the_same() -> None:
    one = gyradius.ScalarLaw("normal", mean=0, sigma=1)
    for other in (
        gyradius.ScalarLaw("normal", sigma=1.0, mean=0.0),
        gyradius.ScalarLaw(**one.form),
        pickle.loads(pickle.dumps(one)),
    ):
        assert one == other and hash(one) == hash(other)
    assert one != gyradius.ScalarLaw("normal", mean=0, sigma=2)


def test_an_arm_is_refused_beside_a_drawn_centre() -> None:
    body = gyradius.MassProperties(10.0, [0, 0, 0], np.diag([5.0, 4, 3]))
    with pytest.raises(ValueError, match="arm_m"):
        gyradius.law(body, centre={"mm": 10, "sigmas": 1, "arm_m": [0, 0, 1.5]})


def test_axes_limit_the_turns_beside_products() -> None:
    """Products of 0.1 would take turns of several degrees: the axes allow 0.1."""
    body = gyradius.MassProperties(10.0, [0, 0, 0], np.diag([5.0, 4, 3]))
    law = gyradius.law(body, axes="0.1deg", products="0.1kgm2")
    most = np.deg2rad(0.1) * np.array([1.0, 2.0, 1.0])
    assert (law.std[7:] <= 1.01 * most).all()


@pytest.mark.parametrize("degrees", [1, 5, 10, 14, 20, 30, 60])
def test_rotations_that_are_not_small_are_warned_of(degrees: float) -> None:
    asked = np.eye(3) * np.radians(degrees) ** 2
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        law = gyradius.small_rotations([0.1, 0.2, 0.3, 0.9], asked)
    had = np.sqrt(np.diag(law.cov) / np.diag(asked))
    assert bool(told) == (had.min() < 0.95)
    assert (degrees <= 14) != bool(told)
    for warning in told:
        assert f"rotations of {degrees}° are not small" in str(warning.message)
        assert warning.filename == __file__


def test_slips_of_the_unit_are_refused() -> None:
    body = gyradius.MassProperties(10.0, [0, 0, 0], np.diag([0.1, 0.15, 0.2]))
    bodies = gyradius.law(body, mass="4%", moments="6%", axes="1deg").rvs(60, rng=3)
    ten = np.column_stack([bodies.mass, bodies.centre, bodies.inertia[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]])
    ten[7, 0] *= 1000.0
    ten[7, 4:] *= 1000.0
    inertia = np.zeros((60, 3, 3))
    for column, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]):
        inertia[:, i, j] = inertia[:, j, i] = ten[:, 4 + column]
    slip = gyradius.MassProperties(ten[:, 0], ten[:, 1:4], inertia)
    with pytest.raises(ValueError, match="body 8: its mass is"):
        gyradius.MassPropertiesLaw.fit(slip)
