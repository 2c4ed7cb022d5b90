"""What a .mat or a .npz file holds, read back by SciPy and NumPy."""

import numpy as np
import pytest
from scipy.io import loadmat

from pliant.controllers import LQG, LQR, Feedback
from pliant.controllers.export import arrays_of, export_arrays
from pliant.envs import scenes


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


def test_what_cannot_be_written_is_told(tmp_path) -> None:
    law = Feedback(np.eye(2), ("a", "b"))
    with pytest.raises(ValueError, match=r"must end in \.mat or \.npz"):
        export_arrays(law, tmp_path / "law.txt")
    with pytest.raises(ValueError, match="no linear form"):
        arrays_of(object())
