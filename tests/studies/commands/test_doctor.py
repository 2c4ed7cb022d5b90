"""`pliant doctor` and `pliant cache`."""

import json

from typer.testing import CliRunner

from pliant.studies.commands.cli import app


def test_doctor_says_what_serves():
    done = CliRunner().invoke(app, ["doctor", "--json"])
    found = json.loads(done.stdout)
    assert done.exit_code == 0 and found["processors"] >= 1 and isinstance(found["advice"], list)


def test_cache_is_shown_emptied_and_checked(tmp_path, monkeypatch):
    """In a folder of its own; a damaged file ends verify with 1."""
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))

    def run(action):
        done = CliRunner().invoke(app, ["cache", action, "--json"])
        return done.exit_code, json.loads(done.stdout)

    code, found = run("info")
    assert code == 0 and found["bytes"] == 0
    assert run("verify") == (0, {"folder": found["folder"], "files": 0, "bad": []})
    assert run("clear") == (0, {"folder": found["folder"], "removed": 0})
