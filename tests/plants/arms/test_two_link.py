"""The two-link arm against reference states, frequencies and motions."""

import dataclasses

import numpy as np
import pytest
from evidence import agrees

from pliant.plants import TwoLinkArm, step_limit

ARM = TwoLinkArm.textbook()
VARIANTS = {"CS": ARM, "CC": dataclasses.replace(ARM, tip_slope=False)}
LOCKED = ("theta1", "theta2")


def weightless(**changes):
    return dataclasses.replace(ARM, gravity=0.0, **changes)


def state(found):
    return np.concatenate([found["q"], found["qd"]]), np.array(found["tau"])


def test_parameters_and_mode_shapes_are_those_of_the_reference(reference):
    found = reference("two_link")
    given = found["params"]
    assert (ARM.link1.length, ARM.joint_mass, ARM.payload.mass) == (given["L1"], given["mj"], given["mp"])
    assert (ARM.payload.inertia_z, ARM.gravity) == (given["Jp"], given["g"])
    assert ARM.link1.linear_density == pytest.approx(given["rhoA1"], rel=1e-14)
    assert pytest.approx(given["EI2"], rel=1e-14) == ARM.link2.EI
    basis = dataclasses.replace(ARM, modes=(4, 4)).links[0].basis
    for k, row in enumerate(found["modal"]):
        ours = (basis.tip[k], basis.tip_slope[k], basis.moment[k] * 0.864, basis.first[k] * 0.864)
        theirs = [float(row[name]) for name in ("phiE", "dphiE", "nw", "nq")]
        np.testing.assert_allclose(ours, theirs, rtol=1e-12)
        assert basis.stiffness[k, k] * ARM.link1.EI == pytest.approx(float(row["k"]), rel=1e-12)


@pytest.mark.parametrize("case", ["CC_s1", "CC_s3", "CS_s1", "CS_s3"])
def test_accelerations_at_reference_states(reference, case):
    found = reference("two_link")
    variant, point = case.split("_")
    x, tau = state(found["states"][point])
    expected = np.array([float(a) for a in found["accelerations"][case]])
    got = VARIANTS[variant].dynamics(x, tau)[6:]
    agrees(
        got / np.abs(expected).max(),
        expected / np.abs(expected).max(),
        within=1e-8,
        absolute=True,
        of="TwoLinkArm",
        what=f"accelerations, {case}, over the largest",
        source="the paper's equations in 40-digit arithmetic (two_link.json)",
        kind="independent arithmetic",
    )


@pytest.mark.parametrize("variant", ["CC", "CS"])
def test_energies_at_reference_states(reference, variant):
    found = reference("two_link")
    for point in ("s1", "s3"):
        x, _ = state(found["states"][point])
        energy = found["energy"][variant][point]
        got = [VARIANTS[variant].kinetic(x), VARIANTS[variant].potential(x)]
        agrees(
            got,
            [energy["T"], energy["V"]],
            within=1e-12,
            of="TwoLinkArm",
            what=f"energies, {variant} {point}",
            source="reference numbers (two_link.json)",
            kind="independent arithmetic",
        )


def test_frequencies(reference):
    found = reference("two_link")["frequencies_rad_s"]
    straight = dataclasses.replace(VARIANTS["CC"], gravity=0.0)
    agrees(
        straight.natural_frequencies(),
        found["CC_nog_straight_omega"],
        within=1e-8,
        of="TwoLinkArm",
        what="frequencies, straight",
        source="reference numbers (two_link.json)",
        kind="independent arithmetic",
    )
    x0, _ = ARM.equilibrium(theta1=-np.pi / 2, theta2=0.0)
    agrees(
        ARM.natural_frequencies(x0),
        found["CS_hanging_g_omega"],
        within=1e-8,
        of="TwoLinkArm",
        what="frequencies, hanging",
        source="reference numbers (two_link.json)",
        kind="independent arithmetic",
    )
    poles = ARM.linearize(x0).eigenvalues
    np.testing.assert_allclose(np.sort(poles.imag)[6:], found["CS_hanging_g_omega"], rtol=1e-8)
    # With the joints free the slope is only a change of coordinates.
    np.testing.assert_allclose(weightless().natural_frequencies(), straight.natural_frequencies(), rtol=1e-10)


@pytest.mark.parametrize("n", [1, 2, 4])
def test_frequencies_by_number_of_modes(reference, n):
    found = reference("two_link")["modes_study"][f"slope1_n{n}"]
    arm = weightless(modes=(n, n))
    for held, name in (((), "joints_free"), (LOCKED, "joints_locked")):
        got = arm.natural_frequencies(locked=held)[: len(found[name])]
        agrees(
            got,
            found[name],
            within=5e-10,
            of="TwoLinkArm",
            what=f"frequencies, {n} modes, {name}",
            source="reference numbers (two_link.json)",
            kind="independent arithmetic",
        )


def test_two_polynomials_meet_the_fine_mesh_within_a_hundredth_of_a_per_cent(reference):
    fine = reference("two_link")["fine_finite_elements_straight_no_gravity"]
    two = weightless(basis="polynomial").natural_frequencies(locked=LOCKED)
    expected = reference("two_link")["polynomial_basis_locked_with_slope"]["2"]
    np.testing.assert_allclose(two, expected, rtol=1e-8)
    assert two[0] == pytest.approx(fine["joints_locked_omega"][0], rel=1e-4)
    many = weightless(basis="polynomial", modes=(10, 10))
    agrees(
        many.natural_frequencies(locked=LOCKED)[:6],
        fine["joints_locked_omega"],
        within=1e-6,
        of="TwoLinkArm",
        what="six frequencies, joints locked",
        source="fine finite elements (two_link.json)",
        kind="finer model",
    )
    agrees(
        many.natural_frequencies()[:6],
        fine["joints_free_omega"],
        within=1e-6,
        of="TwoLinkArm",
        what="six frequencies, joints free",
        source="fine finite elements (two_link.json)",
        kind="finer model",
    )


@pytest.mark.every(2)
@pytest.mark.parametrize("basis", ["clamped-free", "payload", "polynomial"])
def test_no_frequency_is_lost_with_many_modes(basis):
    n = 20 if basis == "polynomial" else 40
    arm = weightless(basis=basis, modes=(n, n))
    locked = arm.natural_frequencies(locked=LOCKED)
    assert len(locked) == 2 * n and locked[0] == pytest.approx(6.6256, rel=3e-3)
    assert len(arm.natural_frequencies()) == 2 * n
    assert len(arm.natural_frequencies(rigid=True)) == 2 * n + 2


@pytest.mark.every(2)
@pytest.mark.parametrize("basis", ["clamped-free", "payload"])
def test_frequency_error_falls_as_one_over_the_number_of_modes(basis):
    """Link 1's tip carries a moment, phi'' (1) != 0, which no mode with a free or massive tip has: phi''(1) = 0.

    The missing curvature falls off slowly in the series, and the Rayleigh quotient's error as 1/N.
    """
    exact = weightless(basis="polynomial", modes=(12, 12)).natural_frequencies(locked=LOCKED)[0]
    counts = np.array([10, 14, 20, 28, 40])
    errors = [
        weightless(basis=basis, modes=(n, n)).natural_frequencies(locked=LOCKED)[0] / exact - 1
        for n in map(int, counts)
    ]
    assert min(errors) > 0  # from above
    assert np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(-1, abs=0.05)


@pytest.mark.every(2)
@pytest.mark.parametrize("variant", ["CS_n2", "rigid"])
def test_five_seconds_from_hanging(reference, variant):
    expected = np.array(reference("two_link")["simulation"][variant])
    arm = ARM if variant == "CS_n2" else dataclasses.replace(ARM, reduction="rigid")
    x0 = np.zeros(arm.nx)
    x0[0] = -np.pi / 2
    motion = arm.simulate(
        x0, lambda t: np.array([2.0, 1.0]) * np.sin(2 * np.pi * t), np.arange(6.0), rtol=1e-12, atol=1e-15
    )
    names = ("theta1", "theta2", "tip1_deflection", "tip2_deflection")
    got = np.column_stack([motion[name] for name in names])[1:, : expected.shape[1]]
    # Angles carry ten digits after the point; the deflections agree to 1e-9 of the largest of them.
    np.testing.assert_allclose(got[:, :2], expected[:, :2], rtol=0, atol=5.1e-11)
    np.testing.assert_allclose(got[:, 2:], expected[:, 2:], rtol=0, atol=5e-13)


@pytest.mark.campaign
@pytest.mark.parametrize("slope", [False, pytest.param(True, marks=pytest.mark.campaign)])
def test_error_against_the_rigid_arm_falls_with_stiffness(slope, reference):
    def angles(arm):
        x0 = np.zeros(arm.nx)
        x0[0] = -np.pi / 2
        motion = arm.simulate(
            x0, lambda t: np.array([2.0, 1.0]) * np.sin(2 * np.pi * t), [0.0, 5.0], rtol=1e-9, atol=1e-11
        )
        return motion.x[-1, :2]

    rigid = angles(dataclasses.replace(ARM, reduction="rigid"))
    errors = []
    for factor, (expected, _) in reference("two_link")["rigid_limit_values"].items():
        stiff = dataclasses.replace(ARM.link1, E=ARM.link1.E * float(factor))
        arm = dataclasses.replace(ARM, link1=stiff, link2=stiff, modes=(1, 1), tip_slope=slope)
        errors.append(np.abs(angles(arm) - rigid).max())
        assert slope or errors[-1] == pytest.approx(expected, rel=1e-5)  # the reference has no tip slope
    assert np.polyfit([0, 1, 2], np.log10(errors), 1)[0] == pytest.approx(-1, abs=0.02)


def test_locked_torque_at_joint_2_reacts_on_the_slope_of_link_1():
    """With the slope a torque at joint 2 bends link 1: the generalised force is tau2 - in theta2 only."""
    B = ARM.mass_matrix(np.zeros(12)) @ ARM.jacobians(np.zeros(12))[1][6:]
    np.testing.assert_allclose(B, np.eye(6)[:, :2], atol=1e-9)
    x0, u0 = ARM.equilibrium(theta1=0.0, theta2=0.0)
    assert u0[0] == pytest.approx((0.864 / 2 + 0.864 + 1.0 + 0.5) * 9.81 + (0.864 / 2 + 0.5) * 9.81, rel=1e-2)
    assert x0[2] < 0 and x0[4] < 0  # both links sag


def test_stiffened_arm_hangs_taut_and_linear_one_does_not():
    """Gravity along a hanging link stiffens it; the linear kinematics does not know."""
    taut = dataclasses.replace(ARM, kinematics="stiffened")
    x0 = np.zeros(12)
    x0[0] = -np.pi / 2
    loose = ARM.natural_frequencies(x0, locked=LOCKED)[0]
    assert taut.natural_frequencies(x0, locked=LOCKED)[0] > 1.02 * loose


@pytest.mark.campaign
def test_ladder_starts_rigid_and_every_step_has_its_own_label():
    ladder = ARM.ladder()
    labels = [step.label for step in ladder]
    assert labels[0] == "rigid" and len(set(labels)) == len(labels)
    assert all(step.outputs == ARM.outputs and step.inputs == ARM.inputs for step in ladder)
    sizes = [step.nx for step in ladder]
    assert sizes[0] == min(sizes) == 4
    assert all(0 < step_limit(step, np.zeros(step.nx)) < np.inf for step in ladder[1:])


def test_numbers_of_modes_may_differ_and_signals_have_units():
    arm = dataclasses.replace(ARM, modes=(1, 3))
    assert [s.name for s in arm.states[:6]] == ["theta1", "theta2", "q11", "q21", "q22", "q23"]
    assert [s.unit for s in arm.states] == ["rad"] * 2 + ["m"] * 4 + ["rad/s"] * 2 + ["m/s"] * 4
    assert arm.label == "linear, clamped-free 1+3"
