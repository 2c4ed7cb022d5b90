"""What a verdict accounts for and writes."""

import json

from pliant.plants.stability import METHODS, assess


def test_every_verdict_accounts_for_every_method_and_writes_itself(random_path, pulsating):
    for model in (pulsating(), pulsating(-0.1), pulsating(0.0), random_path()[1], random_path(shift=4.0)[1]):
        found = assess(model)
        assert {name for name, _, text in found.rows() if text} == set(METHODS)
        assert [role for _, role, _ in found.rows()].count("decides") == (1 if found.method else 0)
        assert found.method != "frozen_time"
        again = json.loads(json.dumps(found.to_json(), allow_nan=False))
        assert again["verdict"] == found.verdict and found.verdict in str(found)
        quick = assess(model, thorough=False)
        assert (quick.verdict, quick.method) == (found.verdict, found.method)
