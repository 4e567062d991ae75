"""The adapters of examples/adapters put into each library what was drawn, as the library itself tells.

What was drawn and what the library holds are compared by means that share no code with the adapters: mass matrices,
spatial inertias and momenta that the library computes, beside the same from the ten numbers.
"""

from __future__ import annotations

import importlib
import itertools
import sys
import types
from pathlib import Path

import gyradius
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "adapters"))

pytestmark = pytest.mark.filterwarnings("ignore")

DRAWS = 5
STATED = {"mass": "10%", "centre": "20mm", "moments": "15%", "axes": "20deg"}


def turned(moments: list[float], seed: int) -> np.ndarray:
    """An inertia with principal axes turned at random."""
    axes = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))[0]
    inertia = axes @ np.diag(moments) @ axes.T
    return (inertia + inertia.T) / 2


ARM = gyradius.MassProperties(2.0, [0.1, -0.2, 0.3], turned([0.02, 0.05, 0.06], 1))
TOOL = gyradius.MassProperties(0.5, [0.0, 0.05, 0.1], turned([0.001, 0.002, 0.0025], 2))
PLATE = gyradius.MassProperties(1.5, [0.2, 0.0, 0.05], turned([0.01, 0.03, 0.04], 3))
ROD = gyradius.MassProperties(0.3, [0.0, 0.0, 0.4], turned([0.0, 0.02, 0.02], 4))
BODIES = {"arm": ARM, "tool": TOOL, "plate": PLATE, "rod": ROD}


def draws(bodies: dict[str, gyradius.MassProperties]) -> dict[str, gyradius.MassProperties]:
    """Draws of each body."""
    return {name: gyradius.law(body, **STATED).rvs(DRAWS, rng=i) for i, (name, body) in enumerate(bodies.items())}


def cross(vector: np.ndarray) -> np.ndarray:
    """The matrix of the cross product by a vector."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def spatial(mass: float, centre: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """The spatial inertia (6, 6) about the origin, linear part first: twice the kinetic energy is (v, ω) · M (v, ω)."""
    c = cross(centre)
    return np.block([[mass * np.eye(3), -mass * c], [mass * c, inertia - mass * c @ c]])


def close(found: np.ndarray, expected: np.ndarray, tolerance: float = 1e-9) -> None:
    """Two arrays are the same to a share of the largest number."""
    assert np.shape(found) == np.shape(expected)
    assert np.abs(np.asarray(found) - expected).max() <= tolerance * np.abs(expected).max()


def urdf_link(name: str, body: gyradius.MassProperties) -> str:
    """A link of a URDF file."""
    i = body.inertia
    named = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), i[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])
    entries = " ".join(f'{key}="{value!r}"' for key, value in ((k, float(v)) for k, v in named))
    at = " ".join(map(repr, body.centre.tolist()))
    return (
        f'<link name="{name}"><inertial><origin xyz="{at}"/><mass value="{float(body.mass)!r}"/>'
        f"<inertia {entries}/></inertial></link>"
    )


URDF = f"""<robot name="robot"><link name="base"/>
{urdf_link("arm", ARM)}{urdf_link("tool", TOOL)}{urdf_link("plate", PLATE)}
<joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
<joint name="weld" type="fixed"><parent link="arm"/><child link="tool"/>
<origin xyz="0.1 0 0.5" rpy="0.3 0.4 0.5"/></joint>
<joint name="wrist" type="revolute"><parent link="tool"/><child link="plate"/><origin xyz="0 0.1 0.2" rpy="0.1 0 0.7"/>
<axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>"""

MJCF = """<mujoco><option gravity="0 0 0"/><worldbody>
<body name="arm" pos="1 2 3"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 2 2.5"/>
  <geom name="same" type="box" size=".1 .2 .3" contype="0" conaffinity="0"/></body>
<body name="plate" pos="4 5 6"><freejoint/><inertial pos="0.3 0.2 0.1" quat="1 2 3 4" mass="1" diaginertia="2 1 2.5"/>
  <geom name="there" type="box" size=".1 .2 .3" pos="0.3 0.2 0.1" quat="1 2 3 4" contype="0" conaffinity="0"/>
  <site name="mark" pos="0.3 0.2 0.1" quat="1 2 3 4"/></body>
<body name="rod" pos="7 8 9"><freejoint/><inertial pos="0 0 0.1" mass="1" diaginertia="1 2 2.5"/></body>
<body name="turning"><joint type="hinge" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="1 2 2.5"/>
  <body name="tool" pos="0 0 1"><joint type="hinge" axis="0 1 0"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 2 2.5"/></body></body>
</worldbody></mujoco>"""


def mujoco_model(with_mujoco: types.ModuleType):
    """The model of `MJCF` with every mass centre free to move."""
    mujoco = with_mujoco.mujoco
    if not hasattr(mujoco.MjsBody, "simple"):
        # Without that attribute, MuJoCo 3 takes free bodies with mass centres that are nominally off the origin.
        return mujoco.MjModel.from_xml_string(MJCF.replace('"0 0 0" mass', '"0 0 0.001" mass'))
    return with_mujoco.compile_movable(mujoco.MjSpec.from_string(MJCF))


MECHANISM = """<mujoco><option gravity="0 0 -9.81"/><worldbody>
<camera name="eye" mode="trackcom" pos="1 0 2"/><light name="lamp" mode="trackcom" pos="0 1 3"/>
<body name="target" mocap="true" pos="0 0 2"/>
<body name="arm" pos="0 0 1"><joint name="shoulder" type="ball"/><inertial pos="0 0 0.1" mass="1" diaginertia="1 2 2.5"/>
  <geom type="box" size=".05 .1 .15"/><camera name="held" mode="trackcom" pos="0 0 1"/>
  <light name="torch" mode="targetbodycom" target="plate" pos="0 1 0"/><site name="end" pos=".1 .2 .3"/>
  <body name="tool" pos="0 0 .5"><joint name="elbow" type="hinge" axis="0 1 0" range="-1 1" limited="true"
      frictionloss=".1"/><inertial pos="0 0 0.2" mass="1" diaginertia="1 2 2.5"/>
    <geom type="sphere" size=".1"/><camera name="there" mode="targetbodycom" target="plate"/>
    <site name="tip" pos="0 .1 .2"/></body></body>
<body name="plate" pos="2 0 1"><freejoint/><inertial pos="0.3 0.2 0.1" mass="1" diaginertia="2 1 2.5"/>
  <geom type="box" size=".1 .2 .3"/><camera name="carried" mode="track"/></body>
<body name="rod" pos="-2 0 1"><joint name="slide" type="slide" axis="1 0 0"/><joint type="hinge" axis="0 1 0"/>
  <inertial pos="0 0 0.1" mass="1" diaginertia="1 2 2.5"/><site name="foot" pos="0 0 -.3"/></body>
</worldbody>
<tendon><spatial name="rope" limited="true" range="0 9" stiffness="3"><site site="end"/><site site="tip"/>
  <site site="foot"/></spatial></tendon>
<equality><weld body1="target" body2="arm"/><joint joint1="elbow" joint2="slide"/></equality>
<actuator><motor name="drive" joint="elbow"/><general name="slow" joint="slide" dyntype="filter" dynprm="0.2"/>
  <muscle name="pull" tendon="rope" lengthrange="0.5 5"/></actuator>
<sensor><subtreecom body="arm"/><framepos objtype="camera" objname="held"/></sensor></mujoco>"""
"""A mechanism of every kind of part that MuJoCo derives a constant for."""


def mass_matrix(mujoco, model, data) -> np.ndarray:
    """The mass matrix, by MuJoCo's own multiplication, (nv, nv)."""
    mujoco.mj_forward(model, data)
    matrix = np.empty((model.nv, model.nv))
    for i, unit in enumerate(np.eye(model.nv)):
        mujoco.mj_mulM(model, data, matrix[i], unit)
    return matrix


def test_mujoco_has_the_drawn_bodies():
    pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    import with_mujoco

    mujoco = with_mujoco.mujoco
    model = mujoco_model(with_mujoco)
    data = mujoco.MjData(model)
    drawn = draws(BODIES)
    for index in range(DRAWS):
        with_mujoco.apply(model, data, drawn, index)
        matrix = mass_matrix(mujoco, model, data)
        for name in ("arm", "plate", "rod"):
            first = model.body(name).dofadr[0]
            body = drawn[name][index]
            # Velocities of free joints: of the origin in world axes, and rotation in axes of the body; here the same.
            close(matrix[first : first + 6, first : first + 6], spatial(body.mass, body.centre, body.inertia))
        tool = drawn["tool"][index]
        about_pivot = spatial(tool.mass, tool.centre, tool.inertia)[3:, 3:]
        last = model.body("tool").dofadr[0]
        close(matrix[last, last], about_pivot[1, 1])
        # The hinge of the body below turns what is above too, about the axis 3 of both.
        close(matrix[last - 1, last - 1], 2.5 + about_pivot[2, 2])
        # What is no mass stays where it was.
        close(data.geom("same").xpos, np.array([1.0, 2.0, 3.0]))
        for thing in (data.geom("there"), data.site("mark")):
            close(thing.xpos, np.array([4.3, 5.2, 6.1]))
            quaternion = np.empty(4)
            mujoco.mju_mat2Quat(quaternion, thing.xmat)
            close(quaternion, np.array([1.0, 2.0, 3.0, 4.0]) / np.sqrt(30.0))
        total = sum(float(drawn[name][index].mass) for name in drawn) + 1.0
        close(model.body_subtreemass[0], np.array(total))


def test_mujoco_says_what_it_was_told():
    pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    import with_mujoco

    model = mujoco_model(with_mujoco)
    data = with_mujoco.mujoco.MjData(model)
    drawn = draws(BODIES)
    with_mujoco.apply(model, data, drawn, 2)
    for name, bodies in drawn.items():
        read = with_mujoco.nominal(model, name)
        close(np.append(read.centre, read.mass), np.append(bodies.centre[2], bodies.mass[2]))
        close(read.inertia, bodies.inertia[2])


def put_state(mujoco, model, data, rng: np.random.Generator) -> np.ndarray:
    """Put a random state into data, and say what MuJoCo takes for its state."""
    every = mujoco.mjtState.mjSTATE_INTEGRATION
    state = np.empty(mujoco.mj_stateSize(model, every))
    for _ in range(3):
        data.ctrl[:] = rng.uniform(0, 1, model.nu)
        mujoco.mj_step(model, data)
    data.qpos[:] += rng.uniform(-1, 1, model.nq)
    mujoco.mj_normalizeQuat(model, data.qpos)
    data.mocap_quat[:] = np.eye(4)[0]
    for name in ("qvel", "act", "ctrl", "qfrc_applied", "xfrc_applied", "qacc_warmstart", "mocap_pos"):
        values = getattr(data, name)
        values[:] = rng.uniform(0, 1, values.shape)
    data.eq_active[:] = rng.integers(0, 2, model.neq)
    data.time = rng.uniform(1, 9)
    mujoco.mj_getState(model, data, state, every)
    return state


def test_mujoco_keeps_its_state_and_computes_anew_what_follows_from_it():
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    import with_mujoco

    model = mujoco.MjModel.from_xml_string(MECHANISM)
    data = mujoco.MjData(model)
    every = mujoco.mjtState.mjSTATE_INTEGRATION
    drawn = draws(BODIES)
    rng = np.random.default_rng(6)
    for index in range(4 * DRAWS):
        before = put_state(mujoco, model, data, rng)
        with_mujoco.apply(model, data, drawn, index % DRAWS)
        after = np.empty_like(before)
        mujoco.mj_getState(model, data, after, every)
        np.testing.assert_array_equal(after, before)
        # What new data compute of that state in that model.
        other = mujoco.MjData(model)
        mujoco.mj_setState(model, other, before, every)
        mujoco.mj_forward(model, other)
        for name in ("xipos", "subtree_com", "cam_xpos", "light_xpos", "qfrc_bias", "ten_length", "sensordata", "qacc"):
            np.testing.assert_array_equal(getattr(data, name), getattr(other, name), err_msg=name)


def shapes(rng: np.random.Generator) -> str:
    """The geoms of a body, from one to seven, of which some touch nothing."""
    geoms = []
    for _ in range(rng.integers(1, 8)):
        kind = rng.choice(["box", "capsule", "sphere", "ellipsoid"])
        size, place, turn = (" ".join(map(str, numbers)) for numbers in (
            rng.uniform(0.02, 0.3, 3), rng.normal(size=3) * 0.5, rng.normal(size=4)
        ))
        touches = int(rng.uniform() < 0.8)
        geoms.append(
            f'<geom type="{kind}" size="{size}" pos="{place}" quat="{turn}" contype="{touches}" conaffinity="{touches}" '
            f'margin="{rng.uniform(0.0, 0.02)}"/>'
        )
    return "".join(geoms)


@pytest.mark.parametrize("seed", range(30))
def test_mujoco_finds_the_contacts_and_rays_of_drawn_bodies_with_any_geoms(seed: int):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    import with_mujoco

    rng = np.random.default_rng(seed)
    stated = (
        '<inertial pos=".1 -.2 .3" mass="2" fullinertia=".02 .05 .06 .001 -.002 .003"/>',
        '<inertial pos=".1 0 .5" mass="2" quat="1 2 3 4" diaginertia=".02 .05 .06"/>',
        "",
    )
    names = ["one", "two", "three"]
    parts = [(name, rng.choice(stated), shapes(rng)) for name in names]

    def compiled(inertials: list[str]):
        """The model with these inertias."""
        bodies = "".join(
            f'<body name="{name}" pos="{place} 0 0"><joint type="ball"/><joint type="slide"/>{inertial}{geoms}</body>'
            for place, ((name, _, geoms), inertial) in enumerate(zip(parts, inertials))
        )
        return mujoco.MjModel.from_xml_string(
            f'<mujoco><worldbody><geom type="plane" size="9 9 1" pos="0 0 -.8"/>{bodies}</worldbody></mujoco>'
        )

    def seen(model, data) -> tuple:
        """The contacts of a state, and what rays meet."""
        mujoco.mj_forward(model, data)
        contacts = sorted((*contact.geom, contact.dist) for contact in data.contact)
        rays = np.random.default_rng(seed).normal(size=(100, 3))
        met, far = np.empty((100, 1), np.int32), np.empty((100, 1))
        more = [None] if "normal" in mujoco.mj_multiRay.__doc__ else []
        mujoco.mj_multiRay(
            model, data, np.array([[0.0], [2.0], [1.0]]), rays.reshape(-1, 1), None, 1, -1, met, far, *more, 100, 99.0
        )
        return contacts, met, far

    model = compiled([inertial for _, inertial, _ in parts])
    data = mujoco.MjData(model)
    drawn = draws({name: with_mujoco.nominal(model, name) for name in names})
    number = 0
    for index in range(DRAWS):
        with_mujoco.write(model, mujoco.MjData(model), drawn, index)
        fields = zip(*(getattr(model, field)[1:].tolist() for field in ("body_ipos", "body_mass", "body_iquat", "body_inertia")))
        words = 'pos="{}" mass="{}" quat="{}" diaginertia="{}"'
        fresh = compiled([f"<inertial {words}/>".format(*one).translate(str.maketrans("", "", "[],")) for one in fields])
        # The box around all of a body; those in it may be others, for the compiler divides the geoms along its longest side.
        roots = model.body_bvhadr[model.body_bvhnum > 0]
        np.testing.assert_allclose(model.bvh_aabb[roots], fresh.bvh_aabb[roots], rtol=1e-9, atol=1e-9)
        other = mujoco.MjData(fresh)
        for _ in range(8):
            data.qpos[:] = other.qpos[:] = rng.normal(size=model.nq)
            found = seen(model, data)
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MIDPHASE
            everything = seen(model, data)
            model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE)
            for expected in (everything, seen(fresh, other)):
                assert [contact[:2] for contact in found[0]] == [contact[:2] for contact in expected[0]]
                np.testing.assert_allclose(found[0], expected[0], atol=1e-9)
                np.testing.assert_array_equal(found[1], expected[1])
                np.testing.assert_allclose(found[2], expected[2], atol=1e-9)
            number += len(found[0])
    assert number > 40


SIMPLE = """<mujoco><worldbody>
<body name="first" pos="0 0 1"><joint axis="0 1 0"/><inertial pos=".1 0 0" mass="1" diaginertia="1 2 2.5"/></body>
<body name="free" pos="3 0 1"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1.2 1.5"/></body>
<body name="ball" pos="6 0 1"><freejoint/><geom size=".1"/></body>
<body name="cart" pos="9 0 1"><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="1" diaginertia="2 1 2.5"/></body>
</worldbody></mujoco>"""


@pytest.mark.parametrize("name", ["free", "ball", "cart"])
@pytest.mark.parametrize("what", [key for count in range(1, 5) for key in itertools.combinations(STATED, count)])
def test_mujoco_refuses_a_body_that_is_compiled_as_simple_only_if_its_frame_is_drawn(name: str, what: tuple[str, ...]):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    import with_mujoco

    model = mujoco.MjModel.from_xml_string(SIMPLE)
    data = mujoco.MjData(model)
    stated = {key: STATED[key] for key in what}
    drawn = {one: gyradius.law(with_mujoco.nominal(model, one), **stated).rvs(DRAWS, rng=1) for one in ("first", name)}
    # A body with three equal moments has no axes that could turn, unless its moments scatter too.
    turns = "axes" in what and (name != "ball" or "moments" in what)
    before = fields(model)
    for index in range(DRAWS):
        if "centre" in what or turns:
            with pytest.raises(ValueError, match=f"body {name}: it is compiled as simple"):
                with_mujoco.apply(model, data, drawn, index)
            assert not changed(before, model)
            continue
        with_mujoco.apply(model, data, drawn, index)
        matrix = mass_matrix(mujoco, model, data)
        dofs = matrix[np.ix_(*2 * [np.arange(model.nv)[model.dof_bodyid == model.body(name).id]])]
        body = drawn[name][index]
        close(dofs, spatial(body.mass, body.centre, body.inertia)[: len(dofs), : len(dofs)])


def fields(model) -> dict[str, np.ndarray]:
    """All numbers of a model, by their names."""
    parts = [("", model), ("stat.", model.stat), ("opt.", model.opt)]
    named = ((first + name, getattr(part, name)) for first, part in parts for name in dir(part) if not name.startswith("_"))
    return {name: np.array(value) for name, value in named if isinstance(value, (np.ndarray, int, float))}


def changed(before: dict[str, np.ndarray], model) -> set[str]:
    """Which numbers of a model are others than before."""
    return {name for name, value in fields(model).items() if not np.array_equal(before[name], value)}


OF_MASSES = {
    *("body_mass", "body_ipos", "body_inertia", "body_iquat", "body_sameframe", "geom_sameframe", "site_sameframe", "bvh_aabb"),
    *("body_subtreemass", "body_invweight0", "dof_invweight0", "dof_M0", "tendon_invweight0", "actuator_acc0", "dof_length"),
    *("flexedge_invweight0", "cam_poscom0", "light_poscom0", "stat.meanmass", "stat.meaninertia"),
    # The bounds of geoms, which MuJoCo 4 computes anew of their sizes.
    *("geom_aabb", "geom_rbound"),
}
"""What a draw may change."""

CLOTH = """<flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" mass="1" dim="2" radius=".01" pos="0 0 5"
  quat="1 2 3 4"><edge equality="true"/></flexcomp>"""


@pytest.mark.parametrize("seed", range(20))
def test_mujoco_changes_what_depends_on_masses_alone(seed: int):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    import with_mujoco

    rng = np.random.default_rng(seed)
    numbers = rng.uniform(0.1, 2.0, 9)
    model = mujoco.MjModel.from_xml_string(
        MECHANISM.replace(
            "<worldbody>", '<statistic extent="{}" meansize="{}" center="{} {} {}"/><worldbody>'.format(*numbers), 1
        )
        .replace("<equality>", '<equality><connect body1="tool" body2="plate" anchor=".1 .2 .3"/><connect site1="tip" site2="foot"/>')
        .replace("</actuator>", '<position joint="elbow" kp="5" dampratio="1"/></actuator>')
        .replace("</worldbody>", f"{CLOTH}</worldbody>")
    )
    drawn = draws({name: with_mujoco.nominal(model, name) for name in BODIES})
    of_mass = {"body_mass", "body_inertia", "body_iquat", "body_ipos"}
    # What a program may have set since the model was compiled.
    for name, value in fields(model).items():
        if value.dtype.kind == "f" and value.ndim > 0 and "." not in name and name not in of_mass and rng.uniform() < 0.7:
            getattr(model, name)[...] = value * rng.uniform(0.9, 1.1, value.shape)
    model.eq_data[:] += rng.uniform(0, 1, model.eq_data.shape)
    model.actuator_biasprm[-1, 1:3] = -model.actuator_gainprm[-1, 0], rng.uniform(-1, 1)
    model.tendon_lengthspring[:] = rng.choice([-1.0, 0.3])
    for index in range(DRAWS):
        before = fields(model)
        with_mujoco.write(model, mujoco.MjData(model), drawn, index)
        assert changed(before, model) <= OF_MASSES
        assert of_mass <= changed(before, model)


@pytest.mark.parametrize("seed", range(20))
def test_mujoco_computes_and_wakes_drawn_bodies_that_sleep(seed: int):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    import with_mujoco

    if not with_mujoco.SLEEP:
        pytest.skip("in this MuJoCo no body sleeps")
    rng = np.random.default_rng(seed)
    piles = [[f"box{place}{level}" for level in range(rng.integers(1, 4))] for place in range(4)]
    names = [name for pile in piles for name in pile]

    def pile(place: int, number: int) -> str:
        """Boxes on each other, which fall asleep together, or are asleep from the beginning."""
        sleep = rng.choice(["auto", "init"])
        return "".join(
            f'<body name="box{place}{level}" pos="{2 * place} 0 {0.199 * level + 0.099}" sleep="{sleep}"><freejoint/>'
            f'<inertial pos="0 .01 -.02" mass="{number - level}" diaginertia=".01 .012 .015"/>'
            '<geom type="box" size=".1 .1 .1"/><geom type="box" size=".01 .01 .05"/></body>'
            for level in range(number)
        )

    bodies = "".join(pile(place, len(names)) for place, names in enumerate(piles))
    text = f"""<mujoco><option><flag sleep="enable"/></option><worldbody><geom type="plane" size="99 9 .1"/>{bodies}
<body name="still" pos="0 5 0"><inertial pos="0 0 .02" mass="1" diaginertia=".01 .01 .01"/></body>
<body name="arm" pos="0 9 2"><joint axis="0 1 0"/><inertial pos="0.1 0 0" mass="1" diaginertia=".01 .02 .025"/></body>
</worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    # The same model in which nothing sleeps.
    restless = mujoco.MjModel.from_xml_string(text.replace('"enable"', '"disable"'))
    data = mujoco.MjData(model)
    for _ in range(rng.choice([0, 2000])):
        mujoco.mj_step(model, data)
    slept = data.tree_asleep >= 0
    chosen = [name for name in [*names, "arm", "still"] if rng.uniform() < 0.3]
    drawn = draws({name: with_mujoco.nominal(model, name) for name in chosen})
    flags = model.opt.enableflags
    before = fields(model)
    with_mujoco.apply(model, data, drawn, 1)
    assert model.opt.enableflags == flags
    with_mujoco.write(restless, mujoco.MjData(restless), drawn, 1)
    of_masses = OF_MASSES & set(before)
    assert not changed({**before, **{name: fields(restless)[name] for name in of_masses}}, model)
    for name in chosen:
        at = data.body(name)
        close(at.xipos, at.xpos + at.xmat.reshape(3, 3) @ drawn[name].centre[1])
    # What wakes up is what was drawn, and what lies below and above it.
    woken = {model.body_treeid[model.body(name).id] for pile in piles if {*pile} & {*chosen} for name in pile}
    expected = np.array([one and tree not in woken for tree, one in enumerate(slept)])
    np.testing.assert_array_equal(data.tree_asleep >= 0, expected)
    # What a model computes in which nothing sleeps, of what moves.
    every = mujoco.mjtState.mjSTATE_INTEGRATION
    state = np.empty(mujoco.mj_stateSize(model, every))
    mujoco.mj_getState(model, data, state, every)
    other = mujoco.MjData(restless)
    mujoco.mj_setState(restless, other, state, every)
    mujoco.mj_forward(restless, other)
    moves = ~expected[model.body_treeid] | (model.body_treeid < 0)
    for name in ("xipos", "ximat", "cinert", "crb"):
        np.testing.assert_array_equal(getattr(data, name)[1:][moves[1:]], getattr(other, name)[1:][moves[1:]], err_msg=name)
    awake = ~expected[model.dof_treeid]
    for name in ("qfrc_bias", "qacc_smooth"):
        np.testing.assert_array_equal(getattr(data, name)[awake], getattr(other, name)[awake], err_msg=name)


def test_mjx_has_the_drawn_bodies_in_each_environment():
    pytest.importorskip("mujoco.mjx", reason="MJX is not installed", exc_type=ImportError)
    import jax
    import with_mjx
    import with_mujoco
    from mujoco import mjx

    host = mujoco_model(with_mujoco)
    nominal = host.body_mass.copy()
    drawn = draws(BODIES)
    function = with_mjx.for_playground(host, drawn)
    model, axes = function(mjx.put_model(host), jax.random.split(jax.random.key(0), DRAWS))
    data = mjx.make_data(host)
    full = jax.jit(
        jax.vmap(lambda m: mjx.full_m(m, mjx.crb(m, mjx.com_pos(m, mjx.kinematics(m, data)))), in_axes=(axes,))
    )(model)
    for index in range(DRAWS):
        for name in ("arm", "plate", "rod"):
            first = host.body(name).dofadr[0]
            body = drawn[name][index]
            found = np.asarray(full[index, first : first + 6, first : first + 6])
            close(found, spatial(body.mass, body.centre, body.inertia), 1e-5)
        scratch = mujoco_model(with_mujoco)
        with_mujoco.apply(scratch, with_mujoco.mujoco.MjData(scratch), drawn, index)
        close(np.asarray(model.dof_invweight0[index]), scratch.dof_invweight0, 1e-5)
        close(np.asarray(model.body_subtreemass[index]), scratch.body_subtreemass, 1e-5)
    close(host.body_mass, nominal, 0.0)


def test_mjx_has_in_each_environment_what_it_makes_of_a_model_with_the_draw():
    pytest.importorskip("mujoco.mjx", reason="MJX is not installed", exc_type=ImportError)
    import jax
    import with_mjx
    import with_mujoco
    from mujoco import mjx

    mujoco = with_mujoco.mujoco
    host = mujoco.MjModel.from_xml_string(MECHANISM)
    drawn = draws(BODIES)
    batch, axes = with_mjx.randomize(host, mjx.put_model(host), drawn, DRAWS)
    for index in range(DRAWS):
        scratch = mujoco.MjModel.from_xml_string(MECHANISM)
        with_mujoco.write(scratch, mujoco.MjData(scratch), drawn, index)
        found = jax.tree.map(
            lambda axis, leaf: leaf if axis is None else leaf[index], axes, batch, is_leaf=lambda axis: axis is None
        )
        expected = jax.tree_util.tree_leaves_with_path(mjx.put_model(scratch))
        for (path, there), (_, leaf) in zip(expected, jax.tree_util.tree_leaves_with_path(found), strict=True):
            np.testing.assert_array_equal(leaf, there, err_msg=jax.tree_util.keystr(path))


def test_robosuite_has_the_drawn_bodies():
    suite = pytest.importorskip("robosuite", reason="robosuite is not installed")
    import with_robosuite

    options = {"has_renderer": False, "has_offscreen_renderer": False, "use_camera_obs": False}
    try:
        env = suite.make("Lift", robots="Panda", **options)
    except AssertionError as error:
        pytest.skip(f"this robosuite does not work with the MuJoCo that is installed: {error!r}")
    env.reset()
    names = [f"robot0_link{i}" for i in range(1, 8)]
    bodies = {name: with_robosuite.nominal(env, name) for name in names}
    drawn = draws(bodies)
    import mujoco

    model, data = env.sim.model._model, env.sim.data._data
    every = mujoco.mjtState.mjSTATE_INTEGRATION
    before = np.empty(mujoco.mj_stateSize(model, every))
    after = np.empty_like(before)
    mujoco.mj_getState(model, data, before, every)
    with_robosuite.apply(env, drawn, 3)
    mujoco.mj_getState(model, data, after, every)
    np.testing.assert_array_equal(after, before)
    matrix = mass_matrix(mujoco, model, data)
    hinges = [model.body(name).dofadr[0] for name in names]
    # The mass matrix of the arm as the sum over bodies of Jᵀ M J, in axes of the world.
    expected = np.zeros((7, 7))
    for i in range(1, model.nbody):
        name = model.body(i).name
        body = drawn[name][3] if name in drawn else with_robosuite.nominal(env, name)
        axes = data.xmat[i].reshape(3, 3)
        move, turn = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, move, turn, data.xpos[i] + axes @ body.centre, i)
        move, turn = move[:, hinges], turn[:, hinges]
        expected += body.mass * move.T @ move + turn.T @ axes @ body.inertia @ axes.T @ turn
    expected += np.diag(model.dof_armature[hinges])
    close(matrix[np.ix_(hinges, hinges)], expected)
    env.close()


class Tensor(np.ndarray):
    """As much of a tensor of PyTorch as the adapter for Isaac Lab uses."""

    def new_tensor(self, value) -> Tensor:
        """A tensor of the same type."""
        return np.asarray(value, dtype=self.dtype).view(Tensor)

    def cpu(self) -> Tensor:
        """The same on the CPU, where all others are."""
        return self


class Elsewhere:
    """Indices on a GPU, by which no tensor on the CPU can be indexed."""

    def __init__(self, indices: np.ndarray):
        self.indices = indices

    def cpu(self) -> Tensor:
        """The same on the CPU."""
        return self.indices.view(Tensor)


@pytest.fixture
def with_isaac_lab(monkeypatch: pytest.MonkeyPatch) -> types.ModuleType:
    """The adapter, with as much of PyTorch as it uses."""
    torch = types.SimpleNamespace(arange=lambda count, device: np.arange(count).view(Tensor), Tensor=Tensor)
    monkeypatch.setitem(sys.modules, "torch", torch)
    monkeypatch.delitem(sys.modules, "with_isaac_lab", raising=False)
    return importlib.import_module("with_isaac_lab")


class View:
    """As much of PhysX's view of articulations as the adapter uses: getters give copies, setters take the rows of
    some environments."""

    def __init__(self, environments: int, bodies: int, drops=lambda held: None):
        shapes = {
            "masses": (environments, bodies),
            "coms": (environments, bodies, 7),
            "inertias": (environments, bodies, 9),
        }
        self.held = {name: np.full(shape, 0.125, np.float32).view(Tensor) for name, shape in shapes.items()}
        self.drops = drops
        for name in shapes:
            setattr(self, f"get_{name}", lambda name=name: self.held[name].copy())
            setattr(self, f"set_{name}", lambda values, ids, name=name: self.put(name, values, ids))

    def put(self, name: str, values: Tensor, env_ids: Tensor) -> None:
        """Take the rows of some environments."""
        self.held[name][env_ids] = values[env_ids]
        self.drops(self.held)


def asset(view: View) -> types.SimpleNamespace:
    """An articulation of Isaac Lab."""
    return types.SimpleNamespace(root_physx_view=view, body_names=["base", "arm", "other", "plate"])


@pytest.mark.parametrize("given", [lambda indices: indices.view(Tensor), Elsewhere, lambda indices: None])
@pytest.mark.parametrize("environments", [[6, 1, 3], [0], [4, 3, 2, 1, 0], [0, 1, 2, 3, 4]])
def test_isaac_lab_is_given_the_drawn_bodies_in_its_tensors(with_isaac_lab, given, environments: list[int]):
    # No simulator is here: a small stand-in has the shapes, types and frames that its documentation states.
    env_ids = given(np.array(environments))
    environments = [0, 1, 2, 3, 4] if env_ids is None else environments
    view = View(5 if env_ids is None else 8, 4)
    drawn = draws({"plate": PLATE, "arm": ARM})
    with_isaac_lab.apply(asset(view), env_ids, drawn)
    for row, env in enumerate(environments):
        for body, name in ((1, "arm"), (3, "plate")):
            close(view.held["masses"][env, body], drawn[name].mass[row], 1e-6)
            close(view.held["coms"][env, body], np.append(drawn[name].centre[row], [0, 0, 0, 1]), 1e-6)
            close(view.held["inertias"][env, body].reshape(3, 3), drawn[name].inertia[row], 1e-6)
    untouched = np.ones(view.held["masses"].shape, bool)
    untouched[np.ix_(environments, [1, 3])] = False
    for values in view.held.values():
        assert np.all(values[untouched] == 0.125)


@pytest.mark.parametrize("body", [1, 3])
@pytest.mark.parametrize(
    "name, entries, what",
    [("masses", (), "masses"), ("coms", ([0, 1, 2],), "mass centres"), ("inertias", ([1, 2, 3, 5, 6, 7],), "inertias")],
)
def test_isaac_lab_that_drops_anything_of_a_body_of_any_size_is_found_out(
    with_isaac_lab, body: int, name: str, entries: tuple, what: str
):
    for size in 10.0 ** np.arange(-4, 4):
        # The same bodies in another length and another mass, beside one that stays as it is.
        small = ["arm", "plate"][[1, 3].index(body)]
        drawn = draws({"arm": ARM, "plate": PLATE})
        one = drawn[small]
        drawn[small] = gyradius.MassProperties(one.mass * size**3, one.centre * size, one.inertia * size**5)

        def drops(held: dict[str, Tensor]) -> None:
            """Drop entries of one body in one environment."""
            held[name][(2, body, *entries)] = 0.0

        env_ids = np.arange(3).view(Tensor)
        with_isaac_lab.apply(asset(View(8, 4)), env_ids, drawn)
        with pytest.raises(RuntimeError, match=f"does not hold the {what}"):
            with_isaac_lab.apply(asset(View(8, 4, drops)), env_ids, drawn)


def test_genesis_is_given_the_drawn_links_in_the_axes_of_their_inertia():
    # Genesis needs PyTorch and forty packages: a small stand-in has its three setters, as its reference has them.
    import with_genesis

    quaternion = np.array([0.5, 0.1, -0.7, 0.5]) / np.linalg.norm([0.5, 0.1, -0.7, 0.5])
    written = {}
    link = types.SimpleNamespace(
        desc=types.SimpleNamespace(inertial_quat=quaternion),
        set_mass=lambda value: written.update(mass=value),
        set_COM=lambda value: written.update(centre=value),
        set_inertia=lambda value: written.update(inertia=value),
    )
    drawn = draws({"arm": ARM})
    with_genesis.apply(types.SimpleNamespace(get_link=lambda name: link), drawn, 3)
    close(written["mass"], drawn["arm"].mass[:3])
    close(written["centre"], drawn["arm"].centre[:3])

    def turn(vector: np.ndarray) -> np.ndarray:
        """A vector turned by the quaternion, by v + 2 u × (u × v + w v)."""
        w, u = quaternion[0], quaternion[1:]
        return vector + 2 * np.cross(u, np.cross(u, vector) + w * vector)

    # Twice the energy of a rotation about any axis is the same in both frames.
    for axis in np.random.default_rng(5).standard_normal((10, 3)):
        found = np.einsum("i,nij,j->n", axis, written["inertia"], axis)
        close(found, np.einsum("i,nij,j->n", turn(axis), drawn["arm"].inertia[:3], turn(axis)))


def test_pinocchio_has_the_drawn_links():
    pin = pytest.importorskip("pinocchio", reason="Pinocchio is not installed")
    import with_pinocchio

    model = pin.buildModelFromXML(URDF)
    nominal = {name: BODIES[name] for name in ("arm", "tool", "plate")}
    drawn = draws(nominal)
    before = [inertia.copy() for inertia in model.inertias]
    for index in range(DRAWS):
        changed = with_pinocchio.apply(model, nominal, drawn, index)
        # Beside it, a model that Pinocchio itself makes of a file with the drawn numbers.
        text = URDF
        for name, body in nominal.items():
            text = text.replace(urdf_link(name, body), urdf_link(name, drawn[name][index]))
        expected = pin.buildModelFromXML(text)
        for q in np.random.default_rng(index).uniform(-3, 3, (3, model.nq)):
            data, other = changed.createData(), expected.createData()
            close(pin.crba(changed, data, q), pin.crba(expected, other, q))
            v = np.ones(model.nv)
            close(pin.rnea(changed, data, q, v, v), pin.rnea(expected, other, q, v, v))
    assert all(a.isApprox(b, 0.0) for a, b in zip(before, model.inertias))


def test_drake_has_the_drawn_bodies():
    pytest.importorskip("pydrake", reason="Drake is not installed")
    import with_drake
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(URDF, "urdf")
    plant.Finalize()
    context, other = plant.CreateDefaultContext(), plant.CreateDefaultContext()
    drawn = draws({name: BODIES[name] for name in ("arm", "tool", "plate")})
    for index in range(DRAWS):
        with_drake.apply(plant, context, drawn, index)
        for name, bodies in drawn.items():
            body = bodies[index]
            found = plant.GetBodyByName(name).CalcSpatialInertiaInBodyFrame(context).CopyToFullMatrix6()
            expected = spatial(body.mass, body.centre, body.inertia)
            # Drake has the rotation first.
            close(found, np.block([[expected[3:, 3:], expected[3:, :3]], [expected[:3, 3:], expected[:3, :3]]]))
        plate = drawn["plate"][index]
        about_pivot = spatial(plate.mass, plate.centre, plate.inertia)[3:, 3:]
        close(plant.CalcMassMatrix(context)[-1, -1], about_pivot[0, 0])
    found = plant.GetBodyByName("arm").CalcSpatialInertiaInBodyFrame(other).get_mass()
    close(found, ARM.mass)


def test_basilisk_has_the_drawn_hub():
    pytest.importorskip("Basilisk", reason="Basilisk is not installed")
    import with_basilisk
    from Basilisk.simulation import spacecraft
    from Basilisk.utilities import SimulationBaseClass, macros

    drawn = draws({"hub": ARM})["hub"]
    spin = np.array([0.3, -0.2, 0.5])
    speed = np.array([0.1, 0.2, -0.3])
    for index in range(DRAWS):
        simulation = SimulationBaseClass.SimBaseClass()
        simulation.CreateNewProcess("process").addTask(simulation.CreateNewTask("task", macros.sec2nano(0.1)))
        satellite = spacecraft.Spacecraft()
        with_basilisk.apply(satellite, drawn, index)
        satellite.hub.omega_BN_BInit = spin.reshape(3, 1).tolist()
        satellite.hub.v_CN_NInit = speed.reshape(3, 1).tolist()
        simulation.AddModelToTask("task", satellite)
        simulation.InitializeSimulation()
        simulation.ConfigureStopTime(macros.sec2nano(0.1))
        simulation.ExecuteSimulation()
        body = drawn[index]
        # The sums that Basilisk keeps of momentum and energy, and its mass properties about the origin of the hub.
        about = np.array(satellite.totRotAngMomPntC_N).ravel()
        close(np.linalg.norm(about), np.linalg.norm(body.inertia @ spin), 1e-6)
        close(np.array(satellite.totRotEnergy), 0.5 * spin @ body.inertia @ spin, 1e-6)
        whole = satellite.scMassOutMsg.read()
        close(whole.massSC, body.mass)
        close(np.array(whole.c_B).ravel(), body.centre)
        close(np.array(whole.ISC_PntB_B), spatial(body.mass, body.centre, body.inertia)[3:, 3:])


def test_mujoco_refuses_an_impossible_inertia_in_a_file_alone():
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    body = '<mujoco><worldbody><body><freejoint/><inertial pos="0 0 1" mass="1" diaginertia="{}"/></body></worldbody></mujoco>'
    with pytest.raises(ValueError, match="inertia must satisfy"):
        mujoco.MjModel.from_xml_string(body.format("1 1 3"))
    model = mujoco.MjModel.from_xml_string(body.format("1 1 1.5"))
    data = mujoco.MjData(model)
    model.body_inertia[1] = [1.0, 1.0, 3.0]
    mujoco.mj_setConst(model, data)
    mujoco.mj_step(model, data)
    assert np.isfinite(data.qacc).all()


def test_drake_refuses_an_impossible_inertia():
    pytest.importorskip("pydrake", reason="Drake is not installed")
    import with_drake

    with pytest.raises(RuntimeError, match="IsPhysicallyValid"):
        with_drake.spatial_inertia(gyradius.MassProperties(1.0, [0.0, 0.0, 1.0], np.diag([1.0, 1.0, 3.0])))
