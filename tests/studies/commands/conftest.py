"""Whatever a command prints on stdout fits 80 columns: looked at in every run of a command in this room."""

import os

import pytest
from typer.testing import CliRunner


def too_wide(text, width):
    """Lines wider than that, but where there are words, such as paths, that fill half of it: they are never broken."""
    longest = max(map(len, text.replace("─", " ").replace("━", " ").split()), default=0)
    return [] if longest > width / 2 else [line for line in text.splitlines() if len(line) > width]


@pytest.fixture(autouse=True)
def eighty_columns(monkeypatch):
    """The terminal has 80 columns unless a test says otherwise; JSON is for programs and has no lines of words."""
    monkeypatch.setenv("COLUMNS", "80")
    invoke = CliRunner.invoke

    def looked_at(self, app, args=None, **options):
        result = invoke(self, app, args, **options)
        width = int((options.get("env") or {}).get("COLUMNS", os.environ.get("COLUMNS", "80")))
        if "--json" not in (args or ()) and "--show-completion" not in (args or ()):
            assert too_wide(result.stdout, width) == [], args
        return result

    monkeypatch.setattr(CliRunner, "invoke", looked_at)
