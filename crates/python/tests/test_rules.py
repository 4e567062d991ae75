"""The rules of examples/domain_randomization do what their descriptions say, and the table counts what it says.

Each rule is held to a closed form or an invariant, not to another run of itself.
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

import gyradius
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "domain_randomization"))

import harvest
import plates
import rules
import table

N = 40_000
PAGE = Path(__file__).parents[3] / "docs" / "domain-randomization.md"


def rng(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


def bodies(n: int, generator: np.random.Generator) -> np.ndarray:
    """Inertias of bodies, (n, 3, 3), among them plates, rods and near ones, in axes turned at random."""
    second = generator.uniform(0.0, 1.0, (n, 3)) ** generator.integers(1, 12, (n, 3))
    second[: n // 4, 0] = 0.0
    second[: n // 8, 1] = 0.0
    axes = np.linalg.qr(generator.standard_normal((n, 3, 3)))[0]
    turned = np.einsum("nij,nj,nkj->nik", axes, second, axes)
    return np.trace(turned, axis1=1, axis2=2)[:, None, None] * np.eye(3) - (turned + turned.transpose(0, 2, 1)) / 2


def share(rule: rules.Draw, inertia: np.ndarray, n: int = N) -> float:
    return table.impossible(rule(inertia, rng(), n))


def near(found: float, expected: float) -> bool:
    """Whether a share of N draws is an expected one, to five standard errors."""
    return abs(found - expected) <= 5 * np.sqrt(expected * (1 - expected) / N) + 1e-12


def test_a_factor_for_each_diagonal_entry():
    inertia = np.array([[2.0, 0.3, -0.2], [0.3, 2.5, 0.1], [-0.2, 0.1, 3.0]])
    drawn = rules.entrywise_diagonal(0.5, 1.5)(inertia, rng(), N)
    off = ~np.eye(3, dtype=bool)
    assert np.all(drawn[:, off] == inertia[off])
    factors = np.diagonal(drawn, axis1=1, axis2=2) / np.diag(inertia)
    assert factors.min() >= 0.5 and factors.max() <= 1.5
    assert np.allclose(np.cov(factors.T), np.eye(3) / 12, atol=0.003)
    # Of a ball: that one of three uniform numbers exceeds the sum of the others, 3 (1/2)³ / 6.
    assert near(share(rules.entrywise_diagonal(0.5, 1.5), np.eye(3)), 1 / 16)
    assert share(rules.entrywise_diagonal(0.8, 1.2), np.eye(3)) == 0.0
    # Of a plate: by chance I₃₃ becomes the larger, half of the time however small the range is.
    assert near(share(rules.entrywise_diagonal(0.999, 1.001), np.diag([1.0, 1.0, 2.0])), 0.5)
    assert share(rules.entrywise_diagonal(0.9, 1.1), np.diag([0.0, 1.0, 1.0])) == 1.0


def test_a_factor_for_the_first_entry():
    plate = np.diag([1.0, 1.0, 2.0])
    drawn = rules.first_entry(0.5, 1.5)(plate, rng(), N)
    drawn[:, 0, 0] = 1.0
    assert np.all(drawn == plate)
    assert near(share(rules.first_entry(0.5, 1.5), plate), 0.5)
    assert share(rules.first_entry(0.5, 1.5), np.eye(3)) == 0.0


def test_a_factor_for_each_of_nine_entries():
    inertia = bodies(1, rng(3))[0]
    factors = (rules.entrywise_all(0.9, 1.2)(inertia, rng(), N) / inertia).reshape(N, 9)
    assert np.allclose(np.cov(factors.T), np.eye(9) * 0.3**2 / 12, atol=3e-4)
    assert np.allclose(factors.mean(axis=0), 1.05, atol=0.003)


def test_one_factor_for_the_diagonal():
    # Above 1 it adds the inertia of a body, diag(I), and below 1 it takes one away.
    for inertia in bodies(200, rng(4)):
        assert share(rules.common_diagonal(1.0, 3.0), inertia, 50) == 0.0
    rod = (np.eye(3) * 3 - np.ones((3, 3))) / 3
    assert share(rules.common_diagonal(0.5, 1.0), rod) == 1.0
    drawn = rules.common_diagonal(0.5, 1.5)(rod, rng(), 10)
    assert np.allclose(drawn[:, 0, 0], drawn[:, 2, 2]) and np.all(drawn[:, 0, 1] == rod[0, 1])


def test_one_number_for_all_nine_entries():
    # It takes 3/2 of the number from the second moment along (1, 1, 1), which is 1/2 for a ball.
    assert near(share(rules.added_all(0.5), np.eye(3)), 1 / 3)
    assert share(rules.added_all(0.33), np.eye(3)) == 0.0
    drawn = rules.added_all(0.5)(np.eye(3), rng(), N) - np.eye(3)
    assert np.all(drawn == drawn[:, :1, :1]) or np.allclose(drawn, drawn[:, :1, :1], rtol=0, atol=1e-15)
    assert share(rules.replaced_all(0.01, 0.1), np.eye(3)) == 1.0


def test_a_factor_for_each_principal_moment():
    for inertia in bodies(20, rng(5)):
        drawn = rules.principal_moments(0.3)(inertia, rng(), 50)
        size = np.trace(inertia) ** 2
        assert np.abs(drawn @ inertia - inertia @ drawn).max() < 1e-12 * size, "the principal axes are kept"
    assert share(rules.principal_moments(0.3), np.eye(3)) == 0.0
    assert near(share(rules.principal_moments(0.5), np.eye(3)), 1 / 16)


def test_nine_normal_numbers():
    drawn = rules.gaussian_all(2.0)(np.eye(3), rng(), N).reshape(N, 9)
    assert np.allclose(np.cov(drawn.T), 4 * np.eye(9), atol=0.12)
    assert np.abs(drawn.mean(axis=0) - np.eye(3).ravel()).max() < 0.05


@pytest.mark.parametrize("rule", [rules.common_all(0.5, 1.5), rules.added_diagonal(0.5), rules.unchanged])
def test_rules_that_never_make_an_impossible_body(rule: rules.Draw):
    for inertia in bodies(200, rng(6)):
        assert share(rule, inertia, 50) == 0.0
    assert np.std(rule(np.eye(3), rng(), 1000)[:, 0, 0]) > 0.1 or rule is rules.unchanged


def test_the_table_has_a_row_of_each_rule():
    text = table.rules_table([gyradius.MassProperties(1.0, [0.0, 0.0, 0.0], np.diag([1.0, 1.1, 1.9]))])
    rows = text.splitlines()[2:]
    assert [line.split(" | ")[0] for line in rows] == [
        *(f"| {rule.what}" for rule in rules.RULES),
        *(f"| **{words}**" for words in table.STATED),
    ]
    assert all(line.split(" | ")[2] == "0 %" for line in rows[-2:])
    assert len({rule.what for rule in rules.RULES}) == len(rules.RULES), "what a rule does is also its stream"


def test_the_page_has_a_row_of_each_rule():
    page = PAGE.read_text(encoding="utf-8")
    inside = page.split("<!-- rules -->\n")[1].split("\n<!-- end of rules -->")[0].splitlines()[2:]
    names = [line.split(" | ")[0] for line in inside]
    assert names == [*(f"| {rule.what}" for rule in rules.RULES), *(f"| **{words}**" for words in table.STATED)]
    assert all(line.split(" | ")[2] == "0 %" for line in inside[-2:])


def test_shares_read_as_what_they_are():
    assert [table.percent(share) for share in (0.0, 0.0004, 0.0005, 0.5, 1.0)] == [
        "0 %",
        "< 0.1 %",
        "0.1 %",
        "50.0 %",
        "100.0 %",
    ]


def test_a_page_keeps_what_is_outside_of_the_markers():
    page = "a\n<!-- x -->\nold\n<!-- end of x -->\nb <!-- y --> c"
    assert table.written(page, "x", "new\nlines") == "a\n<!-- x -->\nnew\nlines\n<!-- end of x -->\nb <!-- y --> c"


def link(name: str, mass: float, moments: list[float], product: float = 0.0) -> str:
    a, b, c = moments
    return (
        f'<link name="{name}"><inertial><mass value="{mass}"/><inertia ixx="{a}" iyy="{b}" izz="{c}" ixy="{product}" '
        f'ixz="0" iyz="0"/></inertial></link>'
    )


def test_bodies_are_counted_once_and_for_what_they_are(tmp_path: Path):
    links = [
        link("first", 1.0, [1.0, 1.5, 2.0]),
        link("mirrored", 1.0, [1.5, 1.0, 2.0]),
        link("other mass", 2.0, [1.0, 1.5, 2.0]),
        link("plate", 1.0, [1.0, 1.5, 2.5]),
        link("ball", 1.0, [0.1, 0.1, 0.1]),
        link("impossible", 1.0, [1.0, 1.5, 2.6]),
        link("without mass", 0.0, [1.0, 1.5, 2.0]),
        link("without inertia", 1.0, [0.0, 0.0, 0.0]),
    ]
    wheel = tmp_path / "robots-1.0-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("robots/a.urdf", f'<robot name="r">{"".join(links[:4])}</robot>')
        archive.writestr("robots/b.urdf", f'<robot name="r">{"".join(links[3:])}</robot>')
        archive.writestr("robots/c.xml", "<nothing/>")
        archive.writestr("robots/d.py", "<robot/>")
    found = harvest.harvest([wheel], tmp_path / "robots")
    assert [body.name for body in found.bodies] == ["first", "other mass", "plate"]
    assert {body.wheel for body in found.bodies} == {"robots"}
    assert (found.files, found.stated, found.balls, found.impossible, found.massless) == (2, 9, 1, 1, 2)


def test_the_factor_of_a_pseudo_inertia_is_that_of_numpy():
    mass, centre, moments, axes = plates.plates(rng(7), 200)
    whole = plates.pseudo_inertia(mass, centre, moments + 1e-3, axes)
    assert np.allclose(plates.factor(whole), np.linalg.cholesky(whole), atol=1e-12)
    own = gyradius.MassProperties(mass, centre, np.einsum("nij,nj,nkj->nik", axes, moments + 1e-3, axes))
    assert np.allclose(gyradius.pseudo_inertia(own), whole, atol=1e-12)
    assert 0.2 < plates.not_finite(rng(8), 1000) < 0.8


def test_the_python_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    blocks = [block.split("```")[0] for block in PAGE.read_text(encoding="utf-8").split("```python\n")[1:]]
    assert len(blocks) == 2
    monkeypatch.chdir(tmp_path)
    links = link("base", 0.0, [0.0] * 3) + link("arm", 1.0, [1.0, 1.5, 2.0], 0.1) + link("plate", 1.0, [1.0, 1.5, 2.5])
    Path("robot.urdf").write_text(f'<robot name="r">{links}</robot>', encoding="utf-8")
    found: dict = {"numpy": np}
    with pytest.warns(RuntimeWarning, match='left out: "base"'):
        exec(blocks[0], found)  # noqa: S102
    assert list(found["draws"]) == ["arm", "plate"]
    for draws in found["draws"].values():
        assert (draws.mass.shape, draws.centre.shape, draws.inertia.shape) == ((4096,), (4096, 3), (4096, 3, 3))
        assert draws.is_realizable.all()
    found["body"] = gyradius.load("robot.urdf")["plate"]
    found["inertias"] = np.repeat(found["body"].inertia.reshape(1, 9), 4096, axis=0)
    before, after = blocks[1].strip().splitlines()
    exec(before, found)  # noqa: S102
    assert not gyradius.is_realizable(found["inertias"].reshape(-1, 3, 3)).all()
    exec(after, found)  # noqa: S102
    assert gyradius.is_realizable(found["inertias"].reshape(-1, 3, 3)).all()


@pytest.mark.parametrize("moments", [[1.0, 1.5, 2.5], [1.0, 1.0, 2.0], [0.0, 1.0, 1.0]])
def test_plates_and_rods_stay_bodies_in_single_precision_with_a_millionth_more(moments: list[float]):
    axes = np.linalg.qr(rng(9).standard_normal((3, 3)))[0]
    body = gyradius.MassProperties(1.0, [0.1, 0.2, 0.3], axes @ np.diag(moments) @ axes.T)
    for stated in [*table.STATED.values(), {"mass": "10%"}, {"axes": "20deg"}]:
        drawn = gyradius.law(body, **stated).rvs(N, rng=1).inertia
        single = drawn.astype(np.float32).astype(float)
        assert gyradius.is_realizable(single, tolerance=1e-7).all()
        traces = np.trace(single, axis1=1, axis2=2)[:, None, None]
        thicker = (single + 1e-6 * traces * np.eye(3)).astype(np.float32).astype(float)
        assert gyradius.is_realizable(thicker, tolerance=0.0).all()


@pytest.mark.parametrize("moments", [[0.1, 0.2, 0.3], [1.0, 1.4, 2.4], [0.0, 1.0, 1.0]])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_millionth_is_enough_for_principal_moments_in_single_precision_and_an_inset_is_not(moments: list[float], scale: float):
    axes = np.linalg.qr(rng(11).standard_normal((3, 3)))[0]
    body = gyradius.MassProperties(1.0, [0.1, 0.2, 0.3], scale * axes @ np.diag(moments) @ axes.T)
    drawn = gyradius.law(body, mass="10%", axes="5deg").rvs(5000, rng=1, inset=True)
    traces = np.trace(drawn.inertia, axis1=1, axis2=2)[:, None, None]
    thicker = gyradius.MassProperties(drawn.mass, drawn.centre, drawn.inertia + 1e-6 * traces * np.eye(3))

    def beyond(bodies: gyradius.MassProperties) -> int:
        """How many have a moment larger than the sum of the others, exactly or in the arithmetic of 32 bits."""
        small, middle, large = np.sort(bodies.to_mujoco(np.float32).body_inertia, axis=1).T
        exact = large.astype(float) > small.astype(float) + middle.astype(float)
        return int(np.count_nonzero(exact | (large > small + middle)))

    assert beyond(thicker) == 0
    assert moments[0] == 0.0 or beyond(drawn) > 0


def test_a_mass_alone_or_a_mass_centre_alone_is_never_impossible():
    generator = rng(10)
    inertias = bodies(500, generator)
    masses, centres = generator.uniform(0.01, 100.0, 500), generator.normal(0.0, 10.0, (500, 3))
    whole = gyradius.pseudo_inertia(gyradius.MassProperties(masses, centres, inertias))
    # The pseudo-inertia about the origin of the link, which all bodies have positive semidefinite.
    assert np.linalg.eigvalsh(whole).min() > -1e-12 * np.abs(whole).max()
    # Of a ball of 1 kg whose inertia about the origin is kept while its mass centre moves by 1 m.
    about_origin = np.eye(3)
    moved = gyradius.MassProperties.about_point(1.0, [1.0, 0.0, 0.0], about_origin)
    assert not moved.is_realizable
