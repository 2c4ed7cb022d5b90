"""`pliant doctor` and `pliant cache`."""

import json

import pytest
from typer.testing import CliRunner

from pliant.plants.native import compiler, kernel_loader, kernel_templates
from pliant.studies.commands.cli import app


def test_doctor_says_what_serves():
    done = CliRunner().invoke(app, ["doctor", "--json"])
    found = json.loads(done.stdout)
    assert done.exit_code == 0 and found["processors"] >= 1 and isinstance(found["advice"], list)


def doctor():
    """What it prints."""
    return " ".join(CliRunner().invoke(app, ["doctor"]).stdout.split())


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: no trial kernel")
@pytest.mark.parametrize("fails", ["wrong code", "no code"])
def test_doctor_never_says_that_nothing_is_missing_beside_a_trial_kernel_that_failed(monkeypatch, tmp_path, fails):
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    right, builds = kernel_templates.rk4_source, compiler.build

    def no_code(source, flags=()):
        if "rate" in source:
            raise compiler.CompileError("cc failed: internal compiler error")
        return builds(source, flags)

    if fails == "wrong code":
        monkeypatch.setattr(kernel_templates, "rk4_source", lambda *a: right(*a).replace("h / 6", "h / 6.001"))
    else:
        monkeypatch.setattr(compiler, "build", no_code)
    words = doctor()
    assert "Nothing is missing" not in words and "not used: " in words
    assert "a trial kernel cannot be used, so that others may not be either" in words


@pytest.mark.parametrize(("name", "value"), [("CC", 'gcc "'), ("PLIANT_CFLAGS", "'"), ("PLIANT_NATIVE", "banana")])
def test_doctor_names_nonsense_in_the_environment(monkeypatch, name, value):
    monkeypatch.setenv(name, value)
    words = doctor()
    assert f"{name}=" in words and "Nothing is missing" not in words
    found = json.loads(CliRunner().invoke(app, ["doctor", "--json"]).stdout)
    assert any(f"{name}=" in line for line in found["advice"])


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
