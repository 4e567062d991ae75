"""Inertia matrices against NumPy's eigenvalues, over shapes and types."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import inertias, rotations
from hypothesis import given
from hypothesis import strategies as st

import gyradius


def second_moments_by_numpy(matrices: np.ndarray) -> np.ndarray:
    sigma = 0.5 * np.trace(matrices, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - matrices
    return np.linalg.eigvalsh(sigma)


@given(st.integers(0, 2**32))
def test_realizable_as_eigenvalues_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    good = inertias(rng, 200)
    factors = rng.uniform(0.5, 1.5, size=(200, 1, 3))
    naive = good * factors
    naive = np.triu(naive) + np.triu(naive, 1).transpose(0, 2, 1)
    assert gyradius.is_realizable(good).all()
    least = second_moments_by_numpy(naive)[:, 0]
    size = np.abs(naive).max(axis=(1, 2))
    clear = np.abs(least) > 1e-12 * size
    assert (gyradius.is_realizable(naive) == (least > 0))[clear].all()
    principal = np.linalg.eigvalsh(naive)
    margin = least / np.abs(principal).sum(axis=1)
    assert np.allclose(gyradius.margin(naive), margin, rtol=1e-9, atol=1e-13)
    found = gyradius.report(naive)
    assert (found.is_realizable == gyradius.is_realizable(naive)).all()
    assert all(bool(faults) != good for faults, good in zip(found.faults, found.is_realizable))
    assert np.allclose(np.sort(found.principal_moments), principal, rtol=1e-9, atol=1e-12 * size.max())


@given(st.integers(0, 2**32))
def test_nearest_is_realizable_and_nearer_than_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bad = inertias(rng, 50) * rng.uniform(0.3, 2.0, size=(50, 1, 3))
    bad = np.triu(bad) + np.triu(bad, 1).transpose(0, 2, 1)
    made = gyradius.nearest(bad)
    assert gyradius.is_realizable(made).all()
    distance = np.linalg.norm(made - bad, axis=(1, 2))
    size = np.linalg.norm(bad, axis=(1, 2))
    for method in ("clip-second-moments", "shift-moments"):
        other = gyradius.nearest(bad, method)
        assert gyradius.is_realizable(other).all()
        assert (np.linalg.norm(other - bad, axis=(1, 2)) >= distance - 1e-12 * size).all()
    # No convex mixture with a body is nearer: the condition of a projection on a convex set.
    for one in inertias(rng, 20):
        inner = np.einsum("nij,nij->n", bad - made, one - made)
        assert (inner <= 1e-10 * size * (size + np.linalg.norm(one))).all()
    fine = gyradius.is_realizable(bad)
    assert (made[fine] == bad[fine]).all()


def test_shapes_and_types() -> None:
    rng = np.random.default_rng(1)
    many = inertias(rng, 24).reshape(2, 3, 4, 3, 3)
    assert gyradius.is_realizable(many).shape == (2, 3, 4)
    assert gyradius.margin(many, dtype=np.float32).dtype == np.float32
    assert gyradius.nearest(many).shape == many.shape
    found = gyradius.principal_axes(many)
    assert (found.moments.shape, found.attitude.shape, found.axes.shape) == ((2, 3, 4, 3), (2, 3, 4, 4), many.shape)
    assert isinstance(gyradius.is_realizable(np.eye(3)), bool)
    assert gyradius.is_realizable([[1, 0, 0], [0, 2, 0], [0, 0, 3]])
    assert gyradius.is_realizable(np.empty((0, 3, 3))).shape == (0,)
    assert gyradius.report(np.empty((0, 3, 3))).faults.shape == (0,)
    for dtype in (np.float16, np.float32, np.int64, np.uint8, bool):
        assert gyradius.is_realizable(np.eye(3).astype(dtype))
    for order in "CFA":
        turned = np.array(many[0, 0], order=order)[::-1, :, ::-1]
        assert (gyradius.margin(turned) == gyradius.margin(turned.copy())).all()


@pytest.mark.parametrize("bad", [np.eye(4), np.eye(3)[0], "text", [[object()]], np.eye(3) * 1j, None])
def test_refused(bad: object) -> None:
    for function in (gyradius.is_realizable, gyradius.margin, gyradius.report, gyradius.nearest):
        with pytest.raises(ValueError, match="inertia"):
            function(bad)  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300, 5e-324, -1.0])
def test_odd_numbers_are_answered(value: float) -> None:
    matrix = np.diag([1.0, 1.0, value])
    realizable = gyradius.is_realizable(matrix)
    assert realizable == gyradius.report(matrix).is_realizable
    # 1 + 1 is less than 1e300; a subnormal beside 1 and 1 is a rod.
    assert realizable == (value == 5e-324)
    if not np.isfinite(value):
        assert np.isnan(gyradius.margin(matrix))
        with pytest.raises(ValueError, match="must be finite|finite"):
            gyradius.nearest(matrix)


def test_tolerance() -> None:
    flat = np.diag([1.0, 1.0, 2.000001])
    assert not gyradius.is_realizable(flat)
    assert gyradius.is_realizable(flat, 1e-6)
    skew = np.eye(3)
    skew[0, 1] = 1e-7
    assert not gyradius.is_realizable(skew)
    assert gyradius.is_realizable(skew, tolerance=1e-6)
    for bad in (-1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="tolerance"):
            gyradius.is_realizable(flat, bad)


@given(st.integers(0, 2**32))
def test_principal_axes_put_together_again(seed: int) -> None:
    rng = np.random.default_rng(seed)
    matrices = inertias(rng, 100)
    found = gyradius.principal_axes(matrices)
    again = np.einsum("nij,nj,nkj->nik", found.axes, found.moments, found.axes)
    size = np.abs(matrices).max(axis=(1, 2))[:, None, None]
    assert (np.abs(again - matrices) <= 1e-13 * size + 1e-300).all()
    assert np.allclose(np.linalg.det(found.axes), 1.0)
    first = gyradius.principal_axes(matrices, order="wxyz").attitude
    assert (first[:, [1, 2, 3, 0]] == found.attitude).all()


def test_rotation_keeps_the_margin() -> None:
    rng = np.random.default_rng(2)
    one = inertias(rng, 1)[0]
    turns = rotations(rng, 500)
    turned = turns @ one @ turns.transpose(0, 2, 1)
    assert np.allclose(gyradius.margin(turned), gyradius.margin(one), atol=1e-12)


def test_matrices_in_32_bits() -> None:
    rng = np.random.default_rng(4)
    wide = inertias(rng, 500).astype(np.float32)
    turns = rotations(rng, 500).astype(np.float32)
    turned = turns @ wide @ turns.transpose(0, 2, 1)
    # Not symmetric to the last bit, and plates and rods beyond the boundary by rounding.
    assert (turned != turned.transpose(0, 2, 1)).any()
    assert gyradius.is_realizable(turned).all()
    assert not gyradius.is_realizable(turned.astype(float)).all()
    assert gyradius.is_realizable(gyradius.nearest(turned)).all()
    assert gyradius.principal_axes(turned).moments.shape == (500, 3)
    assert not gyradius.is_realizable(np.diag([1.0, 1.0, 2.001]).astype(np.float32))
    with pytest.raises(ValueError, match="symmetric"):
        gyradius.nearest([[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def test_matrices_of_narrow_numbers_are_symmetric_for_laws_too() -> None:
    # As one body draws them, rounded to 32 bits and turned there.
    law = gyradius.InertiaLaw.about("wishart", np.diag([2.0, 3.0, 4.0]), delta=0.1)
    wide = law.rvs(300, rng=3)
    turns = rotations(np.random.default_rng(4), 300).astype(np.float32)
    narrow = turns @ wide.astype(np.float32) @ np.swapaxes(turns, 1, 2)
    assert (narrow != np.swapaxes(narrow, 1, 2)).any(axis=(1, 2)).sum() > 100
    even = (narrow.astype(float) + np.swapaxes(narrow, 1, 2).astype(float)) / 2
    assert np.isfinite(law.logpdf(narrow)).all()
    assert np.array_equal(law.logpdf(narrow), law.logpdf(even))
    for one, same in zip(narrow[:20], even):
        about = [gyradius.InertiaLaw.about("wishart", matrix, delta=0.1) for matrix in (one, same)]
        assert about[0].form == about[1].form
    assert gyradius.InertiaLaw.fit(narrow).law.form == gyradius.InertiaLaw.fit(even).law.form
    # By more than 32 bits explain, it is no matrix of inertia.
    even[0, 0, 1] += 1e-3
    assert law.logpdf(even[0]) == -np.inf


def test_reports_on_many_are_those_on_each() -> None:
    many = np.random.default_rng(5).normal(size=(2 * 8192 + 3, 3, 3))
    many[::2] = (many[::2] + np.swapaxes(many[::2], 1, 2)) / 2
    whole = gyradius.report(many)
    assert np.array_equal(whole.is_realizable, gyradius.is_realizable(many))
    for place in (0, 8191, 8192, 16384, 16386):
        one = gyradius.report(many[place])
        assert whole.faults[place] == one.faults
        assert np.array_equal(whole.second_moments[place], one.second_moments, equal_nan=True)
    assert gyradius.report(many[:0]).is_realizable.shape == (0,)


def test_masked_entries_are_no_numbers() -> None:
    masked = np.ma.MaskedArray(np.eye(3), mask=np.eye(3, dtype=bool))
    with pytest.raises(ValueError, match="masked"):
        gyradius.margin(masked)
    assert gyradius.is_realizable(np.ma.MaskedArray(np.eye(3)))
    # Wherever they stand.
    for hidden in ([masked, masked], [np.eye(3), (masked,)], [[1.0, 0.0, 0.0], [0.0, np.ma.masked, 0.0], [0.0, 0.0, 1.0]]):
        with pytest.raises(ValueError, match="^inertia: some of its entries are masked"):
            gyradius.is_realizable(hidden)
    # Of whatever array it is, and by its name.
    places = np.ma.MaskedArray([1, 2], mask=[False, True])
    with pytest.raises(ValueError, match="^index: some of its entries are masked"):
        gyradius.key(7, "a", places)
    with pytest.raises(ValueError, match="^samples: some of its entries are masked"):
        gyradius.ScalarLaw("samples", samples=places)
    assert gyradius.key(7, "a", np.ma.MaskedArray([1, 2])) == gyradius.key(7, "a", [1, 2])


@pytest.mark.parametrize(("dtype", "said"), [(np.float64, "1.4e-14"), (np.float32, "7.6e-6"), (np.float16, "0.0625")])
def test_the_tolerance_of_each_type_is_the_one_that_is_said(dtype: type, said: str) -> None:
    page = (Path(__file__).parents[3] / "docs" / "python.md").read_text()
    for text in (str(gyradius.is_realizable.__doc__), page):
        assert f"{said}" in text
    assert float(said) == pytest.approx(64 * np.finfo(dtype).eps, rel=0.02)
    for share in (0.9, 1.1):
        # A second moment of so much of the trace, which is 16, below zero.
        below = share * 64 * float(np.finfo(dtype).eps)
        matrix = np.diag([4.0, 4.0 - 16 * below, 8.0 + 16 * below]).astype(dtype)
        least = float(second_moments_by_numpy(matrix.astype(float))[0])
        assert least == pytest.approx(-16 * below, rel=0.02)
        assert gyradius.is_realizable(matrix) == (share < 1)
        assert gyradius.report(matrix).is_realizable == (share < 1)


@given(st.integers(0, 2**32))
def test_which_way_attitudes_take_components(seed: int) -> None:
    """Principal moments turned by the conjugate give the inertia, and the attitude itself turns them another way."""
    rng = np.random.default_rng(seed)
    made = inertias(rng, 20)
    size = np.abs(made).max(axis=(1, 2), keepdims=True)
    for order in ("xyzw", "wxyz"):
        found = gyradius.principal_axes(made, order=order)
        conjugate = np.where(np.arange(4) == (3 if order == "xyzw" else 0), 1.0, -1.0)
        own = gyradius.MassProperties(np.ones(20), np.zeros((20, 3)), found.moments[:, :, None] * np.eye(3))
        turned = own.rotated(found.attitude * conjugate, order=order).inertia
        assert (np.abs(turned - made) <= 1e-13 * size).all()
        same = gyradius.MassProperties(np.ones(20), np.zeros((20, 3)), made).to_mujoco().body_iquat
        iquat = same if order == "wxyz" else same[:, [1, 2, 3, 0]]
        assert np.allclose(np.abs((iquat * found.attitude * conjugate).sum(axis=1)), 1.0, atol=1e-12)
        # Laws of axes take it as it is.
        roots = np.sqrt(np.maximum(0.5 * found.moments.sum(axis=1, keepdims=True) - found.moments, 0.0))
        for place in range(5):
            axes = gyradius.fixed_attitude(found.attitude[place], order=order)
            drawn = gyradius.InertiaLaw.principal(roots[place].tolist(), axes).rvs(rng=1)
            joint = gyradius.MassPropertiesLaw.joint(1.0, [0.0] * 3, roots=roots[place].tolist(), axes=axes).rvs(rng=1)
            # A root of zero is known to half of the digits.
            for one in (drawn, joint.inertia):
                assert (np.abs(one - made[place]) <= 1e-12 * size[place]).all()


def test_docstrings_say_which_way_attitudes_take_components() -> None:
    for one in (
        gyradius.PrincipalAxes,
        gyradius.principal_axes,
        gyradius.AttitudeLaw,
        gyradius.fixed_attitude,
        gyradius.InertiaLaw.principal,
        gyradius.MassPropertiesLaw.joint,
    ):
        assert "body components to principal components" in " ".join(str(one.__doc__).split()), one


@given(st.integers(0, 2**32), st.sampled_from([0.0, 1e-16, 1e-9, 1e-6, 1e-3, 0.5]))
def test_a_tolerance_means_the_same_to_the_quick_and_the_thorough_way(seed: int, tolerance: float) -> None:
    rng = np.random.default_rng(seed)
    # On both sides of the boundary and of symmetry, by about as much as the tolerance allows.
    some = inertias(rng, 100)
    size = np.abs(some).max(axis=(1, 2), keepdims=True)
    some = some + 2.0 * tolerance * size * rng.normal(size=(100, 3, 3))
    assert (gyradius.is_realizable(some, tolerance) == gyradius.report(some, tolerance).is_realizable).all()
