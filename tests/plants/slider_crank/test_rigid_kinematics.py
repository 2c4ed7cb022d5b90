"""The rigid mechanism against the reference file."""

import dataclasses

import numpy as np
import pytest
from evidence import agrees

from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.slider_crank.steady_cycles import steady_cycle

PLANT = SliderCrank.textbook()
ROD = PLANT.rod


def changed(**changes):
    return dataclasses.replace(PLANT, **changes)


def outputs(plant, x, u=0.0, w=None):
    return dict(zip((s.name for s in plant.outputs), plant.measure(x, [u], w=w)))


def test_rigid_limit_is_exact(reference):
    rigid = changed(kinematics="rigid")
    names = {
        "phi2_deg": "rod_angle",
        "omega2": "rod_rate",
        "eps2": "rod_acceleration",
        "x_m": "slider_x",
        "v": "slider_speed",
        "a": "slider_acceleration",
    }
    forces = {"torque_Nm": "crank_torque", "N_B": "axial_force", "guide_By": "guide_force", "x_m": "slider_x"}
    for row in reference("slider_crank")["rigid"]:
        angle = np.radians(row["phi1_deg"])
        motion = rigid.rigid.motion(angle, rigid.crank_speed)._asdict()
        motion["rod_angle"] = np.degrees(motion["rod_angle"])
        for key, name in names.items():
            assert motion[name] == pytest.approx(row[key], rel=1e-9, abs=1e-12), key
        y = outputs(rigid, rigid.state(angle))
        agrees(
            [y[name] for name in forces.values()],
            [row[key] for key in forces],
            within=1e-9,
            absolute=True,
            of="SliderCrank",
            what=f"forces of the rigid mechanism at {row['phi1_deg']} degrees",
            source="reference numbers (slider_crank.json)",
            kind="independent arithmetic",
        )
        for key, name in forces.items():
            assert y[name] == pytest.approx(row[key], rel=1e-9, abs=1e-12), key
    stiff = changed(rod=dataclasses.replace(ROD, E=ROD.E * 1e9, damping=ROD.damping * 1e-4))
    row = reference("slider_crank")["rigid"][1]
    y = outputs(stiff, steady_cycle(stiff, points=361).x[60])
    for key, name in forces.items():
        assert y[name] == pytest.approx(row[key], rel=1e-9), key
