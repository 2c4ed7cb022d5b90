"""What is told of lanes: rows under their masks, nothing shared."""

import numpy as np

from pliant.envs.tasks import infos

LANES = np.array([3, 1])
ENDED = infos.Ended(
    LANES,
    np.array([5.0, 6.0]),
    np.array([0.0, 2.0]),
    np.array([False, True]),
    np.ones((2, 2)),
    np.array([[7.0], [8.0]]),
)


def test_rows_stand_where_their_mask_is() -> None:
    found = infos.of_end(5, ENDED)
    assert found["cost"].tolist() == [0, 6, 0, 5, 0] and found["early_end_cost"].tolist() == [0, 2, 0, 0, 0]
    assert found["_cost"].tolist() == found["_diverged"].tolist() == [False, True, False, True, False]
    assert found["diverged"].dtype == bool and found["diverged"].tolist() == [False, True, False, False, False]
    told = infos.of_parameters(5, LANES, ("payload.mass",), ENDED.parameters)
    assert told["parameters"]["payload.mass"].tolist() == [0, 8, 0, 7, 0] and told["_parameters"].sum() == 2


def test_the_end_and_the_new_start_of_one_step() -> None:
    valid = {"validity": np.array([0, 1.5, 2.0, 0, 0]), "_validity": np.array([False, True, True, False, False])}
    found = infos.of_both(5, ENDED, ("payload.mass",), valid, np.zeros((5, 2)))
    assert found["final_obs"].sum(axis=1).tolist() == [0, 2, 0, 2, 0]
    final = found["final_info"]
    assert final["_validity"].tolist() == [False, True, False, False, False]  # of lanes that ended
    assert infos.of_lanes({"final_info": final, "_final_info": found["_final_info"]}, np.array([1, 2])) == [
        {
            "final_info": {
                "cost": 6.0,
                "early_end_cost": 2.0,
                "diverged": True,
                "parameters": {"payload.mass": 8.0},
                "validity": 1.5,
            }
        },
        {},
    ]
    arrays = [
        a for group in (found, final, final["parameters"], valid) for a in group.values() if isinstance(a, np.ndarray)
    ]
    assert not any(np.shares_memory(a, b) for k, a in enumerate(arrays) for b in arrays[:k])
