"""Training: what it writes, going on from a checkpoint, what the lanes charge, and the network as NumPy runs it."""

import dataclasses
import json
import sys

import numpy as np
import pytest

from pliant.controllers import Policy, rl
from pliant.envs import scenes

SCENE = scenes.get("single-link-slew")
SMALL = rl.PPOSettings(num_envs=32, n_steps=16, batch_size=128, n_epochs=2, width=8)
SMALL_SAC = rl.SACSettings(num_envs=8, learning_starts=64, gradient_steps=1, buffer_size=1000, batch_size=32, width=8)
NAMES = {"policy.npz", "policy.json", "curve.json", "checkpoint.npz"}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"algorithm": "dqn"}, "algorithm = 'dqn' must be one of 'apg', 'ppo', 'sac'"),
        ({"seed": -1}, "seed = -1 must be an integer"),
        ({"seconds": 0.0}, "seconds = 0.0 must be > 0"),
        ({"seconds": float("nan")}, "seconds = nan"),
        ({"steps": 0}, "steps = 0 must be an integer"),
        ({"steps": 1, "seconds": 1.0}, "give one of them"),
        ({"num_envs": 0}, "num_envs = 0"),
        ({"threads": 0}, "threads = 0"),
        ({"resume": True}, "needs the folder"),
        ({"settings": SMALL_SAC, "algorithm": "ppo"}, "settings = SACSettings must be PPOSettings"),
    ],
)
def test_bad_input_is_named(changes, words):
    with pytest.raises(ValueError, match=words):
        rl.train(SCENE, **changes)


def test_without_stable_baselines_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr(sys.modules["pliant.controllers.learning.train"], "_installed", lambda: False)
    with pytest.raises(ImportError, match=r"pliant\[rl\]"):
        rl.train(SCENE, "ppo", steps=1)


def test_evaluation_charges_what_the_scene_charges():
    """A policy that always gives the same torque, in the environment and by the adaptive integrator."""
    ny = len(SCENE.observe)
    constant = Policy(
        weights=(np.zeros((1, ny)),),
        biases=(np.array([0.05]),),
        mean=np.zeros(ny),
        std=np.ones(ny),
        scene=SCENE.name,
        reads=SCENE.observe,
        goal=SCENE.goal_values(SCENE.observe),
        inputs=("hub_torque",),
        limits=np.array(SCENE.limits),
        dt=SCENE.dt,
    )
    motion = SCENE.plant.simulate(SCENE.initial[0], constant, SCENE.times, rtol=1e-8, atol=1e-10)
    assert np.allclose(motion.u, 2.0)
    assert rl.evaluate(constant, SCENE) == pytest.approx(SCENE.cost(motion), rel=1e-5)
    wild = dataclasses.replace(constant, biases=(np.array([1.0]),))
    left = rl.evaluate(wild, SCENE)  # turns faster than the scene's bound: the rest of the time is charged
    assert left > SCENE.early_end_rate * SCENE.dt * 10


@pytest.fixture(scope="module")
def trained(stable_baselines, tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    told = []
    found = rl.train(
        SCENE,
        steps=2048,
        seed=3,
        folder=folder,
        settings=SMALL,
        threads=1,
        command="as asked",
        progress=lambda share, words: told.append((share, words)),
    )
    return folder, found, told


def test_training_writes_what_it_should(trained):
    folder, found, told = trained
    assert {path.name for path in folder.iterdir()} == NAMES
    assert found.steps == 2048 and found.rate > 0 and found.seconds > 0
    assert rl.read_curve(folder / "curve.json") == found.curve
    assert json.loads((folder / "curve.json").read_text())["scene"] == SCENE.name
    assert found.curve[0].steps == 0 and found.curve[-1].steps == 2048
    assert found.cost == min(point.cost for point in found.curve)
    saved = Policy.load(folder / "policy")
    assert saved.made["command"] == "as asked" and saved.made["seed"] == 3
    assert saved.made["settings"]["num_envs"] == 32
    assert rl.evaluate(saved, SCENE) == pytest.approx(found.cost, rel=1e-12)
    shares = [share for share, _ in told]
    assert shares == sorted(shares) and shares[-1] == 1.0 and "torch thread" in told[0][1]


def test_same_seed_same_policy_and_another_seed_another(trained):
    _, found, _ = trained
    again = rl.train(SCENE, steps=2048, seed=3, settings=SMALL, threads=1)
    other = rl.train(SCENE, steps=2048, seed=4, settings=SMALL, threads=1)
    assert [p.cost for p in again.curve] == [p.cost for p in found.curve]
    assert [p.cost for p in other.curve] != [p.cost for p in found.curve]


def test_global_state_is_left_alone(stable_baselines):
    import random

    import torch

    torch.set_num_threads(1)
    random.seed(1)
    np.random.seed(1)  # noqa: NPY002
    torch.manual_seed(1)
    wanted = random.random(), np.random.random(), float(torch.rand(()))  # noqa: NPY002
    random.seed(1)
    np.random.seed(1)  # noqa: NPY002
    torch.manual_seed(1)
    rl.train(SCENE, steps=512, settings=SMALL, threads=2)
    assert (random.random(), np.random.random(), float(torch.rand(()))) == wanted  # noqa: NPY002
    assert torch.get_num_threads() == 1


def test_folder_of_a_run_is_not_overwritten(trained):
    folder, _, _ = trained
    with pytest.raises(ValueError, match="holds a run: go on with resume=True"):
        rl.train(SCENE, steps=2048, folder=folder, settings=SMALL)


def copy(folder, target):
    for path in folder.iterdir():
        (target / path.name).write_bytes(path.read_bytes())
    return target


def test_resumed_run_goes_on(trained, tmp_path):
    folder, before, _ = trained
    goes_on = copy(folder, tmp_path)
    same = rl.train(SCENE, steps=2048, seed=3, folder=goes_on, resume=True, settings=SMALL, threads=1)
    assert same.steps == 2048 and same.curve == before.curve  # nothing left to do
    after = rl.train(SCENE, steps=4096, seed=3, folder=goes_on, resume=True, settings=SMALL, threads=1)
    assert after.steps == 4096
    assert after.curve[: len(before.curve)] == before.curve
    assert after.cost <= before.cost and after.seconds > before.seconds
    first = after.curve[len(before.curve)]
    assert first.steps == 2048 and first.cost == pytest.approx(before.curve[-1].cost, rel=1e-3)


def test_checkpoint_restores_everything(trained, stable_baselines):
    """Weights, both moments of every optimiser's parameter and the observations' statistics, bit for bit."""
    from pliant.controllers.learning import checkpoint, training
    from pliant.controllers.learning.training_callback import Run
    from pliant.controllers.learning.training_env import TrainingLanes, normalised

    folder, _, _ = trained
    env = normalised(TrainingLanes(SCENE, 32, spread=1.5, bounded=False, seed=9, threads=1))
    run = Run(SCENE, env, None, (None, 4096), {}, lambda a, b: None, 0.0)
    model = training._model(SMALL, env, 9, run)
    checkpoint.restore(folder, checkpoint.read_words(folder), model, env)
    assert model.num_timesteps == 2048
    with np.load(folder / "checkpoint.npz") as arrays:
        for name, tensor in model.policy.state_dict().items():
            assert np.array_equal(arrays[f"/model/policy/{name}"], tensor.numpy()), name
        state = model.policy.optimizer.state_dict()["state"]
        assert len(state) == len(list(model.policy.parameters()))
        for key, moments in state.items():
            for name in ("step", "exp_avg", "exp_avg_sq"):
                have = arrays[f"/model/policy.optimizer/state/{key}/{name}"]
                assert np.array_equal(have, np.asarray(moments[name])) and np.any(have)
        assert np.array_equal(arrays["observations.var"], env.obs_rms.var)
    env.close()


def test_policy_and_curve_follow_from_the_checkpoint(trained, tmp_path):
    """As a kill between the files leaves them: the checkpoint is new, the rest of another moment or missing."""
    folder, before, _ = trained
    goes_on = copy(folder, tmp_path)
    other = dataclasses.replace(before.policy, dt=2 * before.policy.dt)
    other.save(goes_on / "policy")
    (goes_on / "curve.json").unlink()
    same = rl.train(SCENE, steps=2048, seed=3, folder=goes_on, resume=True, settings=SMALL, threads=1)
    assert same.policy.dt == Policy.load(goes_on / "policy").dt == before.policy.dt
    assert rl.read_curve(goes_on / "curve.json") == before.curve


def test_checkpoint_of_version_0_1_goes_on(trained, tmp_path):
    """Two files, arrays and words, no checksum; the best policy stands in its own files only."""
    folder = copy(trained[0], tmp_path)
    with np.load(folder / "checkpoint.npz") as found:
        words = json.loads(str(found["about"]))
        arrays = {name: found[name] for name in found.files if name != "about" and not name.startswith("best/")}
    np.savez(folder / "checkpoint.npz", **arrays)
    for name in ("kind", "format", "best"):
        del words[name]
    (folder / "checkpoint.json").write_text(json.dumps(words))
    assert rl.train(SCENE, steps=2048, folder=folder, resume=True, settings=SMALL, threads=1).curve == trained[1].curve
    rl.train(SCENE, steps=2560, folder=folder, resume=True, settings=SMALL, threads=1)
    assert {path.name for path in folder.iterdir()} == NAMES
    (folder / "checkpoint.json").write_text(json.dumps({**words, "stamp": 1}))
    np.savez(folder / "checkpoint.npz", **arrays)
    with pytest.raises(ValueError, match="of different moments"):
        rl.train(SCENE, steps=4096, folder=folder, resume=True, settings=SMALL, threads=1)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda f: (f / "checkpoint.npz").unlink(), "holds no checkpoint"),
        (lambda f: (f / "checkpoint.npz").write_bytes(b"no zip"), r"checkpoint\.npz' cannot be read"),
        (lambda f: (f / "checkpoint.npz").write_bytes((f / "policy.npz").read_bytes()), "is a policy, must be a check"),
    ],
)
def test_damaged_checkpoints_are_refused(trained, tmp_path, damage, words):
    folder = copy(trained[0], tmp_path)
    damage(folder)
    with pytest.raises(ValueError, match=words):
        rl.train(SCENE, steps=4096, folder=folder, resume=True, settings=SMALL)


@pytest.mark.campaign
def test_checkpoint_of_something_else_is_refused(trained, tmp_path):
    folder = copy(trained[0], tmp_path)
    with pytest.raises(ValueError, match="scene = 'single-link-slew' must be 'two-link-reach'"):
        rl.train(scenes.get("two-link-reach"), steps=4096, folder=folder, resume=True, settings=SMALL)
    wider = dataclasses.replace(SMALL, width=16)
    with pytest.raises(ValueError, match="does not fit"):
        rl.train(SCENE, steps=4096, folder=folder, resume=True, settings=wider)


def test_seconds_are_kept(stable_baselines):
    found = rl.train(SCENE, seconds=1.0, settings=SMALL, threads=1)
    assert found.seconds > 0.9 and found.steps > 0


def test_time_that_setting_up_takes_leaves_a_policy_all_the_same(stable_baselines):
    found = rl.train(SCENE, seconds=1e-3, settings=SMALL, threads=1)
    assert found.steps > 0 and len(found.curve) > 0 and found.policy.scene == SCENE.name


@pytest.mark.campaign
def test_sac_trains_and_goes_on(stable_baselines, tmp_path):
    found = rl.train(SCENE, "sac", steps=200, folder=tmp_path, settings=SMALL_SAC, threads=1)
    assert found.policy.squash and found.policy.activation == "relu"
    assert {path.name for path in tmp_path.iterdir()} == NAMES
    more = rl.train(SCENE, "sac", steps=400, folder=tmp_path, resume=True, settings=SMALL_SAC, threads=1)
    assert more.steps == 400 and len(more.curve) > len(found.curve)


def test_scenes_that_cannot_be_learned_are_refused():
    from types import SimpleNamespace

    class Blind:
        name, observe, plant = "blind", (), SCENE.plant

    class Inert:
        name, observe, plant = "inert", ("tip_x",), SimpleNamespace(nu=0)

    with pytest.raises(ValueError, match="'blind': observe"):
        rl.train(Blind())
    with pytest.raises(ValueError, match="'inert': its plant has no inputs"):
        rl.train(Inert())
