import random
import subprocess
import sys

import pytest

from pliant.envs import scenes
from pliant.envs.scene_files import save, text
from pliant.plants.files.toml_text import dumps, loads

SHIPPED = {name: text(scenes.get(name)) for name in scenes.SCENES if "spacecraft-s" not in name}


def test_a_scene_is_saved_loaded_and_taken_in_the_place_of_a_name(tmp_path):
    path = tmp_path / "reach.toml"
    save(scenes.get("two-link-reach"), path)
    assert scenes.load(path) == scenes.get("two-link-reach") == scenes.get(str(path))
    assert scenes.get(str(path), duration=5.0).duration == 5.0
    with pytest.raises(FileNotFoundError, match=r"nowhere\.toml"):
        scenes.load(tmp_path / "nowhere.toml")


def leaves(table, path=()):
    """The keys of all values of nested tables, and of tables in lists."""
    for key, value in table.items():
        inner = value if isinstance(value, dict) else {}
        if isinstance(value, list):
            inner = {i: part for i, part in enumerate(value) if isinstance(part, dict)}
        yield from leaves(inner, (*path, key)) if inner else [(*path, key)]


def damaged(name, rng):
    """(bytes of a scene file with one fault, words that the message must have)."""
    tables = loads(SHIPPED[name])
    own = [path for path in leaves(tables) if path[0] not in ("about",) and isinstance(path[-1], str)]
    path = rng.choice(own)
    place = tables
    for key in path[:-1]:
        place = place[key]
    key = path[-1]
    kind = rng.choice(["key", "kind", "range", "number", "missing", "syntax", "cut", "bytes"])
    if kind == "key":
        place[f"{key}_x"] = place.pop(key)
        return dumps(tables).encode(), ["lacks type" if key == "type" else f"{key}_x", "must"]
    if kind == "kind":
        place[key] = {"a": 7}
        return dumps(tables).encode(), [key.split(".")[0], "7", "must"]
    if kind == "range":
        place = rng.choice([(tables, "duration"), (tables["plant"], "gravity"), (tables["limits"], None)])
        key = place[1] or next(iter(tables["limits"]))
        place[0][key] = -3.5 if key != "gravity" else "down"
        return dumps(tables).encode(), [key if place[1] else "limits", "-3.5" if key != "gravity" else "down", "must"]
    if kind == "number":
        place[key] = "@"
        return dumps(tables).replace('"@"', rng.choice(["nan", "inf", "-inf"])).encode(), [
            key,
            "must be a finite number",
        ]
    if kind == "missing":
        key = rng.choice(["name", "plant", "limits"])
        del tables[key]
        return dumps(tables).encode(), [f"lacks {key}", "must"]
    lines = dumps(tables).splitlines()
    k = rng.choice([i for i, line in enumerate(lines) if " = " in line and not line.endswith("[")])
    if kind == "syntax":
        lines[k] = lines[k].replace(" = ", " ")
        return "\n".join(lines).encode(), [f"line {k + 1}: {lines[k][:20]!r}"[:-1], "must be TOML"]
    if kind == "cut":
        return "\n".join([*lines[:k], lines[k].split("=")[0] + "= "]).encode(), [f"line {k + 1}", "must be TOML"]
    content = "\n".join(lines).encode()
    at = content.index(lines[k].encode())
    return content[:at] + bytes([rng.randrange(0x80, 0xC0)]) + content[at:], ["line", "must be UTF-8"]


@pytest.mark.parametrize("first", range(0, 100, 25))
def test_a_damaged_file_is_told_in_one_line_with_key_value_and_range(tmp_path, first):
    """100 seeds, each a fault in one of the shipped scenes' files."""
    path = tmp_path / "damaged.toml"
    for seed in range(first, first + 25):
        rng = random.Random(seed)
        content, words = damaged(rng.choice(list(SHIPPED)), rng)
        path.write_bytes(content)
        with pytest.raises(ValueError) as refused:
            scenes.load(path)
        message = str(refused.value)
        assert len(message.splitlines()) == 1, message
        assert all(word in message for word in [str(path), *words]), (seed, words, message)


HOSTILE = """
import sys
import pliant.envs
from pliant.envs import scenes
from pliant.plants.tables import plant_types
scenes.load("good.toml"), scenes.names(), plant_types.names()  # whatever is imported and listed late is so now
seen = []
def hook(event, arguments):
    told = ("exec", "compile", "import", "os.system", "subprocess.Popen", "os.exec", "socket.connect")
    if event in (*told, "pickle.find_class"):
        seen.append((event, str(arguments)[:80]))
    if event == "open" and not str(arguments[0]).endswith(".toml"):
        seen.append((event, str(arguments)[:80]))
sys.addaudithook(hook)
for k in range(int(sys.argv[1])):
    try:
        scenes.load(f"bad{k}.toml")
    except ValueError:
        pass
    else:
        seen.append(k)
print(seen)
"""
CODE = "__import__('os').system('touch hacked')"
ATTEMPTS = (
    {"name": CODE},
    {"base": CODE},
    {"base": {"name": "spin-up", "speed": CODE}},
    {"motion": {"type": CODE}},
    {"motion": {"type": "samples", "times": CODE, "inputs": CODE}},
    {"plant": {"type": CODE}},
    {"plant": {"type": "os:system", "command": "touch hacked"}},
    {"plant": {"type": "TwoLinkArm", "make": "__init_subclass__"}},
    {"plant": {"type": "FlexibleTree", "make": "from_urdf", "path": "/etc/passwd"}},
    {"plant": {"type": "TwoLinkArm", "make": "textbook", "link1": {"type": "sys"}}},
    {"parameters": {"payload.mass": CODE}},
    {"parameters": {"__class__.__init__": 1}},
    {"goal": {"theta1": CODE}},
)


def test_nothing_in_a_file_is_executed_imported_or_opened(tmp_path):
    """Python's own audit events, while files are read that try."""
    save(scenes.get("two-link-reach"), tmp_path / "good.toml")
    for k, attempt in enumerate(ATTEMPTS):
        (tmp_path / f"bad{k}.toml").write_text(dumps({"name": "a-scene", "base": "two-link-reach"} | attempt))
    told = subprocess.run(
        [sys.executable, "-c", HOSTILE, str(len(ATTEMPTS))], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert told.stdout.strip() == "[]" and not (tmp_path / "hacked").exists()
