import sys
from pathlib import Path

import pytest

from pliant.envs.scene_files.own_modules import import_file


def test_a_file_is_the_module_of_its_name_and_run_once(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    path = tmp_path / "my_own_crane_file.py"
    path.write_text("runs = []\nruns.append(1)\n")
    try:
        import_file(path)
        import_file(path)
        assert sys.modules["my_own_crane_file"].runs == [1]
    finally:
        sys.modules.pop("my_own_crane_file", None)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("crane.txt", "", "must be a Python file"),
        ("my-crane.py", "", "its name an identifier"),
        ("json.py", "", "must not have the name of another module, 'json'"),
        ("fails_at_once.py", "1 / 0", "fails: ZeroDivisionError"),
    ],
)
def test_what_is_no_module_is_refused(tmp_path, monkeypatch, name, text, words):
    monkeypatch.setattr(sys, "path", list(sys.path))
    (tmp_path / name).write_text(text)
    with pytest.raises(ValueError, match=words):
        import_file(tmp_path / name)
    with pytest.raises(ValueError, match="must be a Python file"):
        import_file(Path(tmp_path / "nowhere.py"))
