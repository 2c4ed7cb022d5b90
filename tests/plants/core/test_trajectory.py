"""Trajectory: columns by name, resampling at its order, round trip through a file, bad input."""

import builtins
import dataclasses
import json

import numpy as np
import pytest

from pliant.plants.core.signals import Signal
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.files import sealed_arrays


def swing(n=21, *, exact=True, **kwargs):
    """x = [sin t, cos t], y = x1^2, u = cos 2t."""
    t = np.linspace(0, 4, n)
    fields = {
        "u": np.cos(2 * t)[:, None], "y": np.sin(t)[:, None] ** 2,
        "states": (Signal("angle", "rad"), Signal("rate", "rad/s")), "inputs": (Signal("torque", "N m"),),
        "outputs": (Signal("tip_x", "m"),), "dx": np.column_stack([np.cos(t), -np.sin(t)]) if exact else None,
        "w": t[:, None], "disturbances": (Signal("wind", "N"),),
        "stats": {"steps": np.int64(7), "method": "rk4"},
    }  # fmt: skip
    return Trajectory(t, np.column_stack([np.sin(t), np.cos(t)]), **{**fields, **kwargs})


def test_columns_by_name():
    motion = swing()
    np.testing.assert_array_equal(motion["angle"], np.sin(motion.t))
    np.testing.assert_array_equal(motion["tip_x"], np.sin(motion.t) ** 2)
    np.testing.assert_array_equal(motion["torque"], np.cos(2 * motion.t))
    np.testing.assert_array_equal(motion["wind"], motion.t)
    with pytest.raises(ValueError, match=r"Trajectory\['tip_y'\] must be one of angle, rate, tip_x, torque, wind"):
        motion["tip_y"]


def test_short_repr_and_length():
    assert repr(swing()) == "Trajectory(21 times, 0 to 4 s, 2 states, 1 inputs, 1 outputs)"
    assert len(swing()) == 21


def test_a_state_goes_before_an_output_of_the_same_name():
    motion = swing(outputs=(Signal("angle", "rad"),))
    np.testing.assert_array_equal(motion["angle"], np.sin(motion.t))


def test_derivative_is_exact_where_known_and_a_spline_else():
    np.testing.assert_array_equal(swing().derivative()[:, 0], np.cos(swing().t))
    errors = [np.abs(swing(n, exact=False).derivative()[:, 0] - np.cos(swing(n).t)).max() for n in (41, 81)]
    assert errors[1] < 1e-4 and 2.7 < np.log2(errors[0] / errors[1]) < 4.5


@pytest.mark.parametrize("exact", [True, False])
def test_resampling_is_of_order_four(exact):
    new = np.linspace(1.0, 3.0, 57)
    errors = [np.abs(swing(n, exact=exact).resample(new)["angle"] - np.sin(new)).max() for n in (41, 81)]
    assert errors[1] < 1e-6 and abs(np.log2(errors[0] / errors[1]) - 4) < 0.5


def test_resampling_keeps_the_nodes_and_says_what_it_knows():
    motion = swing()
    same = motion.resample(motion.t)
    for name in ("x", "u", "y", "dx", "w"):
        np.testing.assert_allclose(getattr(same, name), getattr(motion, name), atol=1e-14)
    assert swing(exact=False).resample([0, 1]).dx is None
    assert same.stats == {}


def test_resampled_rate_is_the_slope_of_the_resampled_path():
    motion = swing(9)
    t = np.array([1.1, 1.1 + 1e-6])
    near = motion.resample(t)
    np.testing.assert_allclose((near.x[1] - near.x[0]) / 1e-6, near.dx[0], atol=1e-5)


def test_held_input_between_times():
    new = [0.0, 0.19, 0.2, 0.3, 4.0]
    held = swing(hold="zero-order").resample(new)
    np.testing.assert_allclose(held["torque"], np.cos([0, 0, 0.4, 0.4, 8.0]), atol=1e-12)
    linear = swing().resample(new)
    assert linear["torque"][3] == pytest.approx((np.cos(0.4) + np.cos(0.8)) / 2)
    assert (held.hold, linear.hold) == ("zero-order", "linear")
    with pytest.raises(ValueError, match=r"resample\.t = 4\.1 must be within \[0, 4\]"):
        swing().resample([0, 4.1])


def test_save_and_load(tmp_path):
    motion = swing(hold="zero-order")
    motion.save(tmp_path / "run.npz")
    back = Trajectory.load(tmp_path / "run.npz")
    for name in ("t", "x", "u", "y", "dx", "w"):
        np.testing.assert_array_equal(getattr(back, name), getattr(motion, name))
    for kind in ("states", "inputs", "outputs", "disturbances", "hold"):
        assert getattr(back, kind) == getattr(motion, kind)
    assert back.stats == {"steps": 7, "method": "rk4"}
    swing(dx=None, w=None, disturbances=()).save(tmp_path / "small")
    assert Trajectory.load(tmp_path / "small").dx is None
    np.savez(tmp_path / "other.npz", a=np.zeros(2))
    with pytest.raises(ValueError, match=r"has arrays \['a'\], must have 'about'"):
        Trajectory.load(tmp_path / "other.npz")


def test_a_file_of_version_0_1_is_read(tmp_path):
    """Written as 0.1 did: no checksum, and a format that says no kind."""
    pairs = {"states": [["a", "rad"]], "inputs": [["u", "N m"]], "outputs": [], "disturbances": []}
    about = json.dumps({**pairs, "stats": {"steps": 7}, "hold": "linear", "format": 1})
    t = np.arange(3.0)
    np.savez(tmp_path / "run.npz", about=np.array(about), t=t, x=t[:, None], u=t[:, None], y=np.zeros((3, 0)))
    back = Trajectory.load(tmp_path / "run.npz")
    assert back.states == (Signal("a", "rad"),) and back.stats == {"steps": 7} and back["u"].tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"states": None}, "lacks 'states'"),
        ({"stats": None}, "lacks 'stats'"),
        ({"stats": 3}, "holds no motion"),
        ({"states": [["a"]]}, "must be a name and a unit"),
        ({"states": [["a", 1]]}, "must be a name and a unit"),
        ({"states": 5}, "holds no motion"),
        ({"states": [["a", ""], ["b", ""]]}, r"Trajectory\.x has shape \(3, 1\), must be \(3, 2\)"),
        ({"hold": "spline"}, "Trajectory.hold = 'spline'"),
        ({"t": np.zeros(3)}, "times must be strictly increasing"),
        ({"x": np.full((3, 1), np.nan)}, r"Trajectory\.x\[0, 0\] = nan must be finite"),
        ({"x": np.zeros(3)}, "Trajectory.x has shape"),
        ({"y": None}, "holds no motion"),
        ({"z": np.zeros(3)}, r"has arrays \['z'\], which no motion has"),
    ],
)
def test_a_whole_file_that_holds_no_motion_is_refused_by_name(tmp_path, changes, words):
    t = np.arange(3.0)
    parts = {"t": t, "x": t[:, None], "u": t[:, None], "y": np.zeros((3, 0))}
    about = {"states": [["a", "rad"]], "inputs": [["u", "N m"]], "outputs": [], "disturbances": []}
    about |= {"stats": {}, "hold": "linear"}
    for name, value in changes.items():
        (about if name in about else parts)[name] = value
    about, parts = ({k: v for k, v in given.items() if v is not None} for given in (about, parts))
    sealed_arrays.save(tmp_path / "run.npz", "motion", 2, about, parts)
    with pytest.raises(ValueError, match=r"Trajectory\.load: '.*run\.npz' .*" + words):
        Trajectory.load(tmp_path / "run.npz")


def test_another_kind_a_folder_and_no_path_are_refused(tmp_path):
    sealed_arrays.save(tmp_path / "p.npz", "policy", 2, {}, {})
    for path, words in (
        (tmp_path / "p.npz", "is a policy, must be a motion"),
        (tmp_path, "but a folder"),
        (3, "a path"),
    ):
        with pytest.raises(ValueError, match=words):
            Trajectory.load(path)
    with pytest.raises(FileNotFoundError):
        Trajectory.load(tmp_path / "none.npz")
    with pytest.raises(FileNotFoundError, match="does not exist: not written"):
        swing().save(tmp_path / "none" / "run.npz")


def test_from_arrays_of_another_program():
    t = np.linspace(0, 1, 5)
    motion = Trajectory.from_arrays(t, np.zeros((5, 2)), states=["a", "b"])
    assert motion.u.shape == (5, 0) and motion.y.shape == (5, 0) and motion["b"].shape == (5,)

    class Doubler:
        states, inputs = (Signal("a", ""), Signal("b", "")), (Signal("u", ""),)
        outputs, disturbances = (Signal("sum", ""),), ()

        def measure(self, x, u, *, w, t):
            return (x.sum(axis=1) + u[:, 0] + t)[:, None]

    motion = Trajectory.from_arrays(t, np.ones((5, 2)), plant=Doubler())
    np.testing.assert_array_equal(motion["sum"], 2 + t)
    with pytest.raises(ValueError, match=r"Trajectory\.x has shape \(5, 3\), must be \(5, 2\)"):
        Trajectory.from_arrays(t, np.ones((5, 3)), plant=Doubler())


def test_to_pandas_says_what_is_missing(monkeypatch):
    real = builtins.__import__

    def no_pandas(name, *args, **kwargs):
        if name == "pandas":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", no_pandas)
    with pytest.raises(ImportError, match="pip install pandas"):
        swing().to_pandas()


def test_to_pandas():
    pytest.importorskip("pandas")
    frame = swing().to_pandas()
    assert list(frame.columns) == ["angle", "rate", "tip_x", "torque", "wind"] and frame.index.name == "t"


def test_arrays_are_own_and_write_protected():
    x = np.zeros((21, 2))
    motion = Trajectory.from_arrays(np.arange(21.0), x)
    x[:] = 1.0
    assert motion.x.max() == 0
    with pytest.raises(ValueError, match="read-only"):
        motion.x[0, 0] = 1.0


@pytest.mark.parametrize(
    ("t", "x", "message"),
    [
        ([0, 1, 1], np.zeros((3, 1)), r"Trajectory\.t\[2\] = 1 must be greater than Trajectory\.t\[1\] = 1"),
        ([0, np.nan, 1], np.zeros((3, 1)), r"Trajectory\.t\[1\] = nan must be finite"),
        ([0], np.zeros((1, 1)), r"Trajectory\.t has 1 times, must have at least 2"),
        ([0, 1], [[0.0], [np.inf]], r"Trajectory\.x\[1, 0\] = inf must be finite"),
        ([0, 1], np.zeros((3, 1)), r"Trajectory\.x has shape \(3, 1\)"),
    ],
)
def test_bad_input(t, x, message):
    with pytest.raises(ValueError, match=message):
        Trajectory.from_arrays(t, x)


def test_bad_names():
    with pytest.raises(ValueError, match=r"hold = 'cubic' must be one of 'zero-order', 'linear'"):
        swing(hold="cubic")
    with pytest.raises(ValueError, match="must be 1 names"):
        Trajectory.from_arrays([0, 1], np.zeros((2, 1)), states=["a", "b"])
    with pytest.raises(ValueError, match="must be distinct names"):
        Trajectory.from_arrays([0, 1], np.zeros((2, 2)), states=["a", "a"])


@pytest.mark.parametrize("given", [{"outputs": 3}, {"disturbances": object()}, {"plant": 3}, {"states": np.array("a")}])
def test_what_has_no_length_and_what_is_no_plant_is_refused_by_name(given):
    with pytest.raises(ValueError, match=rf"Trajectory.*{next(iter(given))} = "):
        Trajectory.from_arrays([0.0, 1.0], np.zeros((2, 1)), **given)


def test_stats_that_cannot_be_saved_are_refused_when_made():
    motion = Trajectory.from_arrays([0.0, 1.0], np.zeros((2, 1)))
    for stats in ([["a", 1]], None, 3):
        with pytest.raises(ValueError, match=r"Trajectory\.stats = "):
            dataclasses.replace(motion, stats=stats)
