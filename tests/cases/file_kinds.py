"""Every kind of file that Pliant writes, in versions that are told apart, each by Pliant's own writer.

What the campaigns of kills and of damage are made of. A version is a small number that stands in every part of what is
written; `read` gives the versions found in all parts, through Pliant's reader where it has one.
"""

import functools
import importlib.util
import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np

from pliant.controllers import Policy, rl
from pliant.plants import Trajectory
from pliant.plants.files import sealed_json
from pliant.plants.native import kernel_cache
from pliant.studies.common import atomic_files
from pliant.studies.figures import style
from pliant.studies.papers import registry
from pliant.studies.scoreboard import tables
from pliant.studies.scoreboard.results import Results
from pliant.studies.stability.parameter_map import StabilityMap


@dataclass(frozen=True)
class Kind:
    """One kind. `sealed`: a reader checks it, which raises ValueError for anything but what was written."""

    name: str
    write: Callable[[Path, int], object]  # a version, into a folder
    read: Callable[[Path], set[float]]  # the versions of all parts
    sealed: bool = False
    settles: bool = False  # parts that readers find one by one: a kill between them is mended by the next writer


def motion(version: int, rows: int = 500) -> Trajectory:
    full = np.full((rows, 6), float(version))
    return Trajectory.from_arrays(np.linspace(0, version, rows), full, full[:, :2])


def _motion_read(folder: Path) -> set[float]:
    found = Trajectory.load(folder / "run.npz")
    return set(np.unique(found.x)) | set(np.unique(found.u)) | {found.t[-1]}


def policy(version: int) -> Policy:
    number = float(version)
    return Policy(
        weights=(np.full((8, 3), number), np.full((1, 8), number)),
        biases=(np.full(8, number), np.full(1, number)),
        mean=np.full(3, number),
        std=np.full(3, number),
        scene="any",
        reads=("a", "b", "c"),
        goal=np.full(3, number),
        inputs=("u",),
        limits=np.full(1, number),
        dt=number,
        made={"seed": version},
    )


def _versions(p: Policy) -> set[float]:
    arrays = (*p.weights, *p.biases, p.mean, p.std, p.goal, p.limits, np.array([p.dt, p.made["seed"]]))
    return {float(v) for array in arrays for v in np.unique(array)}


def _policy_read(folder: Path) -> set[float]:
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*belongs to another policy")
        return _versions(Policy.load(folder / "mine"))


def _checkpoint_write(folder: Path, version: int) -> None:
    import torch

    from pliant.controllers.learning import checkpoint

    weights = torch.full((8, 8), float(version))
    model = SimpleNamespace(
        get_parameters=lambda: {"policy": {"w": weights}, "optimizer": {"state": {0: {"step": weights[0]}}}},
        _get_torch_save_params=lambda: ([], []),
        num_timesteps=version,
    )
    moments = SimpleNamespace(mean=np.full(3, version), var=np.full(3, version), count=version)
    words = {"scene": "any", "algorithm": "ppo", "best_cost": version, "spent": version, "curve": []}
    checkpoint.save(folder, model, SimpleNamespace(obs_rms=moments), words, policy(version))


def _checkpoint_read(folder: Path) -> set[float]:
    import torch

    from pliant.controllers.learning import checkpoint

    words, found = checkpoint.read_words(folder), {}
    moments = SimpleNamespace(mean=None, var=None, count=None)
    model = SimpleNamespace(set_parameters=found.update)
    checkpoint.restore(folder, words, model, SimpleNamespace(obs_rms=moments))
    arrays = [found["policy"]["w"], found["optimizer"]["state"][0]["step"], moments.mean, moments.var]
    seen = {float(v) for array in arrays for v in np.unique(torch.as_tensor(array).numpy())}
    return (
        seen
        | {words["stamp"], words["spent"], model.num_timesteps, float(moments.count)}
        | _versions(checkpoint.best_of(folder))
    )


def _curve_write(folder: Path, version: int) -> None:
    points = [{"steps": version, "seconds": 1.0 * version, "cost": 1.0 * version}] * 40
    sealed_json.save(folder / "curve.json", {"format": 2, "spent": version, "curve": points})


def _curve_read(folder: Path) -> set[float]:
    return {float(v) for p in rl.read_curve(folder / "curve.json") for v in (p.steps, p.seconds, p.cost)}


def figure(version: int):
    drawn, (ax,) = style.panels(1, height=0.5, width=1.0)
    ax.plot([0, version], [version, 0])
    return drawn


@functools.cache
def _png(version: int, draw: Callable[[Path, int], object], name: str) -> bytes:
    """A picture as its writer makes it, to tell its version by."""
    import tempfile

    with tempfile.TemporaryDirectory() as there:
        draw(Path(there), version)
        return (Path(there) / name).read_bytes()


def _picture_version(folder: Path, name: str, draw: Callable[[Path, int], object]) -> int:
    content = (folder / name).read_bytes()
    return next(v for v in (1, 2, 3) if content == _png(v, draw, name))


def _picture_write(folder: Path, version: int) -> None:
    style.save(figure(version), folder / "one.png")


def _chart_write(folder: Path, version: int) -> None:
    values = np.arange(2.0)
    table = np.full((2, 2), float(version))
    verdicts = np.full((2, 2), ("", "stable", "unstable", "marginal")[version])
    found = StabilityMap(("a", "b"), (values, values), verdicts, table, table, verdicts, {}, float(version), "here")
    found.save(folder / "map.json", folder / "map.png")


def _chart_read(folder: Path) -> set[float]:
    told = json.loads((folder / "map.json").read_text())
    return {told["seconds"], told["margins"][1][1], _picture_version(folder, "map.png", _chart_write)}


def _figures_write(folder: Path, version: int) -> None:
    drawn = {name: figure(version) for name in ("first", "second")}
    with patch.dict(registry.DRAWN, {"single-link": lambda: drawn}):
        registry.write("single-link", folder / "figures", lambda *_: None)


def _figures_read(folder: Path) -> set[float]:
    return {_picture_version(folder, f"figures/{name}.png", _figures_write) for name in ("first", "second")}


def _board_write(folder: Path, version: int) -> None:
    tables.write(Results(version, version, (), (), {}, {}), folder / "board", f"board {version}")


def _board_read(folder: Path) -> set[float]:
    told = json.loads((folder / "board" / "scoreboard.json").read_text())
    text = (folder / "board" / "scoreboard.md").read_text()
    return {told["seeds"], told["seed"], int(text.split("board ")[1].split("`")[0])}


def _report_write(folder: Path, version: int) -> None:
    with atomic_files.whole_folder(folder / "report") as made:
        motion(version, 50).save(made / "run.npz")
        for name in ("a.json", "b.json", atomic_files.MARK):
            atomic_files.write_json(made / name, {"version": version})


def _report_read(folder: Path) -> set[float]:
    told = [json.loads(path.read_text())["version"] for path in (folder / "report").glob("*.json")]
    if len(told) < 3:
        raise ValueError("the report, or a part of it, is not there")
    return {*told, *_motion_read(folder / "report")}


def _table_write(folder: Path, version: int) -> None:
    atomic_files.write_json(folder / "table.json", {"rows": [version] * 1000})


def _table_read(folder: Path) -> set[float]:
    return set(json.loads((folder / "table.json").read_text())["rows"])


def _kernel_write(folder: Path, version: int) -> None:
    folder.chmod(0o700)
    with patch.dict("os.environ", {"PLIANT_CACHE": str(folder)}):
        kernel_cache.write("kernel-a.so", b"%d" % version * 5000)


def _kernel_read(folder: Path) -> set[float]:
    with patch.dict("os.environ", {"PLIANT_CACHE": str(folder)}):
        text = kernel_cache.read_text("kernel-a.so")
    if text is None:
        raise ValueError("kernel-a.so is damaged: it is built again")
    assert len(text) == 5000
    return {int(c) for c in text}


KINDS = {
    kind.name: kind
    for kind in (
        Kind("motion", lambda f, v: motion(v).save(f / "run.npz"), _motion_read, sealed=True),
        Kind("policy", lambda f, v: policy(v).save(f / "mine"), _policy_read, sealed=True),
        Kind("curve", _curve_write, _curve_read, sealed=True),
        Kind("kernel", _kernel_write, _kernel_read, sealed=True),
        Kind("table", _table_write, _table_read),
        Kind("picture", _picture_write, lambda f: {_picture_version(f, "one.png", _picture_write)}),
        Kind("table and chart", _chart_write, _chart_read, settles=True),
        Kind("paper's figures", _figures_write, _figures_read),
        Kind("scoreboard", _board_write, _board_read),
        Kind("report", _report_write, _report_read),
    )
}
if importlib.util.find_spec("torch") and importlib.util.find_spec("stable_baselines3"):
    KINDS["checkpoint"] = Kind("checkpoint", _checkpoint_write, _checkpoint_read, sealed=True)
