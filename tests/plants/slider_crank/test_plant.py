"""The slider-crank against reference deflections, Newton and Euler."""

import dataclasses

import numpy as np
import pytest
from evidence import agrees

from pliant.plants.beams.pinned_rod import AxialModes, rod_shapes
from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.slider_crank.steady_cycles import steady_cycle

PLANT = SliderCrank.textbook()
ROD = PLANT.rod
FIRST = (np.pi / ROD.length) ** 2 * np.sqrt(ROD.EI / ROD.linear_density)
LOCKED = ("crank_angle",)


def changed(**changes):
    return dataclasses.replace(PLANT, **changes)


def outputs(plant, x, u=0.0, w=None):
    return dict(zip((s.name for s in plant.outputs), plant.measure(x, [u], w=w)))


def bent_state(plant, seed, deflection=1e-4):
    rng = np.random.default_rng(seed)
    x = plant.state(rng.uniform(-3, 3), rng.uniform(5, 20))
    n, k = plant.counts
    size = np.concatenate([np.full(n, deflection), np.full(k, 1e-3 * deflection)])
    x[1 : 1 + n + k] = size * rng.normal(size=n + k)
    x[-(n + k) :] = 300 * size * rng.normal(size=n + k)
    return x


@pytest.mark.every(4)
@pytest.mark.parametrize(
    ("changes", "within"),
    [
        ({"modes": 1}, 5e-3),
        ({"modes": 3}, 5e-4),
        ({"modes": 5, "axial_modes": 1}, 1e-4),
        pytest.param({"modes": 9}, 1e-7, marks=pytest.mark.campaign),
        ({"basis": "frame-elements", "modes": 2}, 2e-4),
        pytest.param({"basis": "frame-elements", "modes": 4}, 2e-5, marks=pytest.mark.campaign),
    ],
)
def test_steady_deflection_of_the_middle(reference, changes, within):
    """Of the peak, at the tabulated angles and at the extremes; modes 2, 4, .. do not move the middle."""
    expected = reference("slider_crank")
    cycle = steady_cycle(changed(**changes), points=3601)
    found = 1e6 * cycle["mid_deflection"]
    peak = expected["mid_extremes_um"]["max"]
    for degrees, value in expected["mid_deflection_um"].items():
        assert found[10 * int(degrees)] == pytest.approx(value, abs=within * peak)
    agrees(
        found.max(),
        peak,
        within=within,
        of="SliderCrank",
        what=f"largest bending over a turn, {changes}",
        source="nine modes, with which geometrically exact elements agree (slider_crank.json)",
        kind="finer model",
    )
    assert found.min() == pytest.approx(expected["mid_extremes_um"]["min"], rel=within)
    assert found.argmax() / 10 == pytest.approx(expected["mid_extremes_um"]["at_max"], abs=0.11)
    assert found.argmin() / 10 == pytest.approx(expected["mid_extremes_um"]["at"], abs=0.11)


def test_without_the_axial_force_stiffness_the_deflection_is_one_per_cent_off(reference):
    peak = reference("slider_crank")["mid_extremes_um"]["max"]
    found = 1e6 * steady_cycle(changed(kinematics="linear", modes=5))["mid_deflection"].max()
    assert 0.01 < abs(found / peak - 1) < 0.02


def test_pinned_pinned_frequencies(reference):
    plant = changed(force=0.0, modes=6)
    found = plant.natural_frequencies(plant.state(0.9, 0.0)) / (2 * np.pi)
    agrees(
        found,
        reference("slider_crank")["pinned_pinned_Hz"],
        within=1e-9,
        of="SliderCrank",
        what="pinned-pinned frequencies",
        source="reference numbers (slider_crank.json)",
        kind="independent arithmetic",
    )
    free = dataclasses.replace(plant, crank_speed=None)
    np.testing.assert_allclose(free.natural_frequencies(locked=LOCKED), 2 * np.pi * found, rtol=1e-9)


def test_frame_elements_converge_at_their_orders():
    """Bending as h^4, stretching (with the slider at the end) as h^2."""
    counts = np.array([2, 4, 6])
    axial = AxialModes(1, PLANT.slider_mass / ROD.mass).roots[0] / ROD.length * np.sqrt(ROD.E / ROD.density)
    for exact, order in ((FIRST, -4), (axial, -2)):
        errors = []
        for n in counts:
            plant = changed(force=0.0, basis="frame-elements", modes=int(n))
            found = plant.natural_frequencies()
            errors.append(np.abs(found / exact - 1).min())
        assert np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(order, abs=0.2)


def test_axial_modes_are_orthogonal_with_the_slider():
    ratio = 2.3
    shapes = rod_shapes("pinned-pinned", 0, 4, ratio)
    for G in (shapes.mass + ratio * np.outer(shapes.tip, shapes.tip), shapes.stiffness):
        scale = np.sqrt(np.diag(G))
        np.testing.assert_allclose(G / scale / scale[:, None], np.eye(4), atol=1e-12)


def test_axial_force_changes_the_frequency_as_euler_says():
    """omega^2 = omega1^2 (1 - Q/P), P = pi^2 E I/l^2, in a dead centre; past P the straight rod buckles."""
    P = np.pi**2 * ROD.EI / ROD.length**2
    for share in (-1.0, 0.5, 0.9, 1.2):
        plant = changed(force=share * P)
        found = plant.natural_frequencies(plant.state(0.0, 0.0))[0]
        assert found * abs(found) == pytest.approx(FIRST**2 * (1 - share), rel=1e-9)
    loose = changed(force=0.9 * P, kinematics="linear")
    assert loose.natural_frequencies()[0] == pytest.approx(FIRST, rel=1e-9)


FULL = {
    "crank_friction": 0.01,
    "slider_friction": 2.0,
    "dry_friction": 0.5,
    "gravity": 9.81,
}


def turning(a, b):
    """a x b about z."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


@pytest.mark.parametrize("basis", ["pinned-pinned", "frame-elements"])
def test_forces_obey_newtons_laws_on_the_bent_rod(basis):
    """Momentum of rod points taken from the outline, by differences in time, and of the slider; second order in e."""
    plant = changed(**FULL, basis=basis, axial_modes=2 if basis == "pinned-pinned" else 0, crank_speed=None)
    w = np.array([3.0, 2.0])
    for seed in range(3):
        x = bent_state(plant, seed, 1e-5)
        y = outputs(plant, x, 1.3, w)
        assert y["crank_torque"] == pytest.approx(1.3, rel=1e-10)
        h = 1e-6
        path = plant.simulate(x, [1.3], h * np.arange(5), w=w, rtol=1e-12, atol=1e-15)
        points = np.array([plant.outline(s, 241)[1] for s in path.x])
        weights = np.ones(241)
        weights[1:-1:2], weights[2:-1:2] = 4, 2
        dm = ROD.mass * weights / weights.sum()
        acceleration = np.tensordot([-1, 16, -30, 16, -1], points, axes=1) / (12 * h**2)
        y = dict(zip((s.name for s in plant.outputs), plant.measure(path.x[2], [1.3], w=w)))
        q, place = path.x[2], points[2]
        tilt = np.arctan2(-np.sin(q[0]) * PLANT.crank_radius, place[-1, 0] - np.cos(q[0]) * PLANT.crank_radius)
        across = np.array([-np.sin(tilt), np.cos(tilt)])
        weight = np.array([0.0, -9.81])
        pin = np.array([y["crank_pin_x"], y["crank_pin_y"]])
        speed = (points[3, -1, 0] - points[1, -1, 0]) / (2 * h)
        drag = 2.0 * speed + 0.5 * speed / np.hypot(speed, 0.01)
        slider_x = -(0.2 * acceleration[-1, 0] + 20.0 + w[0] + drag)
        slider = np.array([slider_x, y["guide_force"] - 0.2 * 9.81])
        needed = dm @ (acceleration - weight)
        np.testing.assert_allclose(pin + slider + w[1] * across, needed, atol=2e-3 * np.abs(pin).max())
        arm = place - place[0]
        moment = dm @ turning(arm, acceleration - weight)
        middle = turning(arm[120], w[1] * across)
        assert turning(arm[-1], slider) + middle == pytest.approx(moment, abs=2e-3 * abs(slider_x) * 0.05)
        along = slider @ np.array([np.cos(tilt), np.sin(tilt)])
        assert y["axial_force"] == pytest.approx(along, rel=1e-3)
        assert abs(place[-1, 1]) < 1e-15  # the slider stays on its line
        assert y["slider_x"] == pytest.approx(place[-1, 0], abs=1e-12)


@pytest.mark.campaign
def test_accelerations_of_the_middle_are_the_derivatives_of_its_motion():
    """Fourier derivatives around the cycle of the middle's position, taken from the outline."""
    cycle = steady_cycle(PLANT, points=361)
    x = cycle.x[:-1]
    place = np.array([PLANT.outline(s, 3)[1, 1] for s in x])
    order = np.fft.rfftfreq(360, 1 / 360) * PLANT.crank_speed

    def second(values):
        c = np.fft.rfft(values, axis=0) * (-(order**2)).reshape(-1, *[1] * (values.ndim - 1))
        c[60:] = 0
        return np.fft.irfft(c, 360, axis=0)

    absolute, elastic = second(place), second(cycle["mid_deflection"][:-1])
    tilt = PLANT.rigid.motion(x[:, 0], 1.0).rod_angle
    c, s = np.cos(tilt), np.sin(tilt)
    scale = np.abs(absolute).max()
    across, along = c * absolute[:, 1] - s * absolute[:, 0], c * absolute[:, 0] + s * absolute[:, 1]
    np.testing.assert_allclose(cycle["mid_acceleration"][:-1], across, rtol=0, atol=1e-8 * scale)
    np.testing.assert_allclose(cycle["mid_acceleration_along"][:-1], along, rtol=0, atol=1e-8 * scale)
    found = cycle["mid_acceleration_elastic"][:-1]
    np.testing.assert_allclose(found, elastic, rtol=0, atol=1e-5 * np.abs(elastic).max())


def test_mirror_image_moves_as_the_mirror_image():
    x = bent_state(PLANT, 4)
    mirror = np.ones(PLANT.nx)
    mirror[[0, 1, 2, 3, 4, 5]] = -1
    np.testing.assert_allclose(PLANT.dynamics(mirror * x), mirror * PLANT.dynamics(x), rtol=1e-11, atol=1e-9)


def test_energy_of_the_free_mechanism_is_kept():
    plant = changed(crank_speed=None, force=0.0, gravity=9.81, rod=dataclasses.replace(ROD, damping=0.0))
    motion = plant.simulate(bent_state(plant, 1), None, np.linspace(0, 1, 11), rtol=1e-11, atol=1e-14)
    energy = plant.energy(motion.x)
    assert np.ptp(energy) < 1e-9 * energy[0]
