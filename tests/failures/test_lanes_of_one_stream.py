"""One stream of random numbers for all lanes: what a lane plays then depends on when the others end.

Training is repeated, or debugged lane by lane, by seed. Lanes that draw their episodes from one stream in the order in
which they end give lane 0 another second episode as soon as another lane plays otherwise. Seeded, each of Pliant's
lanes has a stream of its own and plays what PlantEnv of that seed plays; and where a lane cannot be told apart from the
others (a method of the whole batch), it is refused in words.
"""

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv

SCENE = scenes.get("two-link-reach", duration=0.2, bounds=(("theta2_rate", 0.3),))
CALM, WILD = np.zeros(2), np.ones(2)


def masses(vector: PlantVectorEnv, others: np.ndarray, count: int = 4) -> list[float]:
    """The first payloads [kg] that lane 0 plays, without torque, while the others are driven, which ends theirs."""
    found: list[float] = []
    while len(found) < count:
        told = vector.step(np.stack([CALM, others, others]))[4]
        if "final_info" in told and told["_final_info"][0]:
            found.append(float(told["final_info"]["parameters"]["payload.mass"][0]))
    return found


def made(seed: int | None) -> PlantVectorEnv:
    vector = PlantVectorEnv(SCENE, 3, randomise=True, autoreset_mode="SameStep")
    vector.np_random = np.random.default_rng(5)
    vector.reset(seed=seed)
    return vector


def test_one_stream_hands_its_episodes_to_whoever_ends_first() -> None:
    calm, wild = masses(made(None), CALM), masses(made(None), WILD)
    assert len(calm) == len(wild) == 4 and calm[0] == wild[0] and calm[1:] != wild[1:]


def test_seeded_lanes_play_what_single_environments_of_their_seeds_do() -> None:
    single, wanted = PlantEnv(SCENE, randomise=True), []
    for k in range(4):
        wanted.append(single.reset(seed=7 if k == 0 else None)[1]["parameters"]["payload.mass"])
    assert masses(made(7), CALM) == masses(made(7), WILD) == wanted


def test_a_lane_that_cannot_be_addressed_alone_is_refused() -> None:
    with pytest.raises(ValueError, match="acts on all lanes at once"):
        made(7).call_lanes("step", [0], CALM)
