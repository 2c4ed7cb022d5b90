"""The three reference frames: the same motion in each to rounding, and each frame's own mechanics."""

import dataclasses

import numpy as np
import pytest
import scipy.linalg

from pliant.plants import Payload, SingleLinkArm

ARM = dataclasses.replace(
    SingleLinkArm.textbook(),
    gravity=9.81,
    hub_radius=0.1,
    hub_friction=0.2,
    payload=Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.02, 0.0)),
    modes=3,
)
FRAMES = ("clamped", "pinned", "pinned-pinned")
X0 = np.array([0.3, 0.02, -0.004, 0.001, 0.5, 0.1, 0.05, -0.02])


def variants():
    for kinematics in ("linear", "stiffened"):
        for theory in ("euler-bernoulli", "timoshenko"):
            yield dataclasses.replace(ARM, kinematics=kinematics, theory=theory)


@pytest.mark.every(4)
@pytest.mark.parametrize("arm", list(variants()), ids=lambda a: a.label)
def test_same_motion_in_all_three_frames_to_rounding(arm):
    """A fixed step commutes with a constant linear map, so that only rounding is left."""
    times = np.linspace(0, 0.25, 26)

    def torque(t):
        return [5 * np.sin(6 * t)]

    step = {"method": "rk4", "step": 1e-4}
    known = arm.simulate(X0, torque, times, **step)
    assert np.abs(known["tip_deflection"]).max() > 0.02
    for frame in FRAMES[1:]:
        other, start = arm.in_frame(frame, X0)
        motion = other.simulate(start, torque, times, **step)
        # A step solves with the mass matrix, so that it rounds by its condition number times the unit roundoff, of each
        # signal's own size; over N steps of a motion that does not grow these add up as a random walk, by sqrt(N).
        rounding = np.linalg.cond(other.mass_matrix(start)) * np.sqrt(times[-1] / step["step"]) * np.finfo(float).eps
        assert rounding < 1e-12
        assert (np.abs(motion.y - known.y).max(axis=0) < rounding * np.abs(known.y).max(axis=0)).all()
        again, back = other.in_frame("clamped", motion.x)
        assert again == arm
        assert (np.abs(back - known.x).max(axis=0) < rounding * np.abs(known.x).max(axis=0)).all()
        np.testing.assert_allclose(other.energy(motion.x), arm.energy(known.x), rtol=rounding)
        np.testing.assert_allclose(other.outline(start), arm.outline(X0), atol=1e-14)


def test_matrices_transform_as_eq_1_says():
    """M_j = T^T M_i T and K likewise; T from pinned-pinned to pinned after pinned to clamped is the direct one."""
    maps = {}
    for frame in FRAMES:
        arm, _ = ARM.in_frame(frame, X0)
        T = arm.frame_map("clamped")
        rest = np.zeros(arm.nx)
        np.testing.assert_allclose(arm.mass_matrix(rest), T.T @ ARM.mass_matrix(rest) @ T, atol=1e-13, err_msg=frame)
        np.testing.assert_array_equal(T[:, 0], [1, 0, 0, 0])
        maps[frame] = arm
    chained = maps["pinned"].frame_map("clamped") @ maps["pinned-pinned"].frame_map("pinned")
    np.testing.assert_allclose(chained, maps["pinned-pinned"].frame_map("clamped"), atol=1e-13)
    np.testing.assert_allclose(np.linalg.inv(ARM.frame_map("pinned")), maps["pinned"].frame_map("clamped"), atol=1e-13)


@pytest.mark.parametrize("frame", FRAMES[1:])
def test_mass_matrix_from_the_frames_own_shapes(frame):
    """Integrals of (R + x) theta' + phi_f q' and of the hub's and the payload's turning, none of the arm's."""
    flat = dataclasses.replace(ARM, payload=Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.0, 0.0)))
    arm = flat.in_frame(frame, X0)[0]
    R, L, rho = 0.1, arm.link.length, arm.link.linear_density
    S = arm.clamped_map
    x, w = np.polynomial.legendre.leggauss(60)
    x, w = (1 + x) / 2, w / 2
    phi, T = flat.elastic.basis.phi, S[1:, 1:]
    tilt = S[0, 1:]  # the hub's tangent turns by this much from the frame's line

    def shapes(xi):
        return np.column_stack([R + L * xi, phi(xi) @ T + np.outer(R + L * xi, tilt)])

    along = np.append(1.0, phi(1.0, 1) @ T / L + tilt)  # turning of the payload
    load = shapes(np.ones(1))[0] + 0.03 * along
    f = shapes(x)
    M = rho * L * f.T @ (w[:, None] * f) + 0.5 * np.outer(load, load) + 0.002 * np.outer(along, along)
    M += arm.hub_inertia * np.outer(np.append(1.0, tilt), np.append(1.0, tilt))
    np.testing.assert_allclose(arm.mass_matrix(np.zeros(arm.nx)), M, atol=1e-12)
    if frame == "pinned":  # the line goes through the mass centre
        centre = rho * L * w @ f + 0.5 * load
        np.testing.assert_allclose(centre[1:], 0, atol=1e-13)
    else:  # the line goes through the tip
        np.testing.assert_allclose(shapes(np.ones(1))[0, 1:], 0, atol=1e-14)
    np.testing.assert_allclose(w @ f[:, 1:] ** 2, 1, rtol=1e-12)
    assert np.all(tilt > 0)
    own = M[1:, 1:]
    np.testing.assert_allclose(own, np.diag(np.diag(own)), atol=1e-12)  # the frame's own modes


def test_pinned_pinned_modes_are_the_strings_known_ones():
    """Without hub, payload and radius: beta = k pi."""
    unit = dataclasses.replace(
        ARM, payload=Payload(), hub_inertia=0.0, hub_radius=0.0, gravity=0.0, basis="polynomial", modes=12
    )
    arm = unit.in_frame("pinned-pinned", np.zeros(unit.nx))[0]
    link = unit.link
    found = arm.natural_frequencies(locked=("frame_angle",))[:3]
    scale = np.sqrt(link.EI / link.linear_density) / link.length**2
    np.testing.assert_allclose(found, scale * (np.pi * np.arange(1, 4)) ** 2, rtol=1e-8)


def test_pinned_frame_of_a_free_hub_has_no_inertial_coupling():
    """Hub without inertia, on its axis: the mass centre's line and the deflection decouple in translation."""
    unit = dataclasses.replace(
        ARM, payload=Payload(), hub_inertia=0.0, hub_radius=0.0, gravity=0.0, basis="polynomial", modes=12
    )
    arm = unit.in_frame("pinned", np.zeros(unit.nx))[0]
    free = [a.natural_frequencies() for a in (unit, arm)]
    np.testing.assert_allclose(*free, rtol=1e-9)


def test_parameters_vary_in_any_frame():
    """The map holds the nominal's numbers, so that a varied arm is the same arm described in that frame."""
    arm = ARM.in_frame("pinned", X0)[0]
    x = arm.in_frame("pinned", X0)[1]
    heavier = 0.8
    seen = arm.vary("payload.mass").dynamics(x, [1.0], p=[heavier])
    base = ARM.vary("payload.mass")
    S = scipy.linalg.block_diag(arm.clamped_map, arm.clamped_map)
    np.testing.assert_allclose(S @ seen, base.dynamics(S @ x, [1.0], p=[heavier]), rtol=1e-9)


def test_names_and_refusals():
    arm = ARM.in_frame("pinned", X0)[0]
    assert arm.states[0].name == "frame_angle" and arm.outputs == ARM.outputs and "pinned" in arm.label
    with pytest.raises(ValueError, match=r"frame = 'pinned' must be 'clamped' where drive = 'motion'"):
        dataclasses.replace(ARM, frame="pinned", drive="motion")
    with pytest.raises(ValueError, match=r"SingleLinkArm\.frame = 'tangent' must be one of"):
        dataclasses.replace(ARM, frame="tangent")
    with pytest.raises(ValueError, match=r"x has shape \(3,\), must be \(..., 8\)"):
        ARM.in_frame("pinned", np.zeros(3))
    rigid = dataclasses.replace(ARM, kinematics="rigid")
    np.testing.assert_array_equal(rigid.frame_map("pinned"), [[1.0]])
