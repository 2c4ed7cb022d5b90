"""What a .mat or a .npz file holds, read back by SciPy and NumPy."""

import numpy as np
import pytest
from scipy.io import loadmat

from pliant.controllers import LQG, LQR, MPC, PD, Feedback, Policy
from pliant.controllers.export import arrays_of, export_arrays
from pliant.envs import scenes
from pliant.plants import LinearModel


@pytest.fixture(scope="module")
def scene():
    return scenes.get("single-link-slew")


def test_a_controller_in_both_kinds_of_file(tmp_path, scene) -> None:
    law = LQR.for_scene(scene)
    mat = loadmat(export_arrays(law, tmp_path / "law.mat"))
    npz = np.load(export_arrays(law, tmp_path / "law.npz"))
    assert np.array_equal(mat["K"], law.K) and np.array_equal(npz["K"], law.K)
    assert mat["dt"].item() == law.dt and np.array_equal(npz["D"], law.K)
    assert [str(v.item()) for v in mat["reads"].ravel()] == list(law.reads) == npz["reads"].tolist()
    assert np.array_equal(npz["lowest"], law.limits[0])


def test_an_estimator_and_a_linear_model(tmp_path, scene) -> None:
    law = LQG.for_scene(scene)
    found = arrays_of(law)
    assert np.array_equal(found["filter_L"], law.filter.gains[-1].L) and np.array_equal(found["law_K"], law.law.K)
    model = scene.plant.linearize(*scene.target)
    mat = loadmat(export_arrays(model, tmp_path / "model.mat"))
    assert np.array_equal(mat["A"], model.A) and mat["dt"].item() == 0.0
    assert [str(v.item()) for v in mat["states"].ravel()] == list(model.state_names)


def test_a_policy_acts_from_its_file_alone(tmp_path) -> None:
    """The law of policy.py, written out; no name that MATLAB would not take."""
    law = Policy.for_scene("two-link-reach")
    path = export_arrays(law, tmp_path / "law.mat")
    found = {name: np.squeeze(value) for name, value in loadmat(path).items() if not name.startswith("__")}
    assert not any(name.startswith("_") for name in arrays_of(law))
    y = law.goal + 0.3
    z = np.clip((y - found["goal"] - found["mean"]) / found["std"], -found["clip"], found["clip"])
    for k in (1, 2):
        z = np.tanh(found[f"W{k}"] @ z + found[f"b{k}"])
    wanted = found["limits"] * np.clip(found["W3"] @ z + found["b3"], -1, 1)
    assert law.act(0.0, y) == pytest.approx(wanted, rel=1e-12)


def test_joint_laws_and_predictive_ones(tmp_path, scene) -> None:
    found = np.load(export_arrays(PD.for_scene(scene, shape="zv"), tmp_path / "law.npz"))
    assert found["reference_shaper_amplitudes"].sum() == pytest.approx(1.0) and found["reference_time"] > 0
    law = MPC.for_scene(scene, 5)
    found = np.load(export_arrays(law, tmp_path / "law.npz"))
    x = law.origin[0] + 1e-3
    assert law.act(0.0, x) == pytest.approx(found["u0"][0] + found["G"][0] @ x)  # within the limits


def test_a_file_read_back_is_the_same_model(tmp_path, scene) -> None:
    model = scene.plant.linearize(*scene.target).discretize(scene.dt)
    found = np.load(export_arrays(model, tmp_path / "model.npz"))
    names = {kind: tuple(found[kind].tolist()) for kind in ("states", "inputs", "outputs")}
    back = LinearModel.from_matrices(found["A"], found["B"], found["C"], found["D"], dt=float(found["dt"]), **names)
    assert np.array_equal(back.to_control().A, model.to_control().A) and back.dt == model.dt
    assert back.output_names == model.output_names and np.array_equal(back.D, model.D)


def test_what_cannot_be_written_is_told(tmp_path) -> None:
    law = Feedback(np.eye(2), ("a", "b"))
    with pytest.raises(ValueError, match=r"must end in \.mat or \.npz"):
        export_arrays(law, tmp_path / "law.txt")
    with pytest.raises(ValueError, match="no linear form"):
        arrays_of(object())
