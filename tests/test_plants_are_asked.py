"""No module outside a plant's own room asks which plant it has, or guesses from the names of signals what they mean.

What the library needs to know of a plant is a method of it, see plants/dynamics/plant_contract.py.
"""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ("plants", "controllers", "envs", "studies")
ROOMS = {  # a plant, and the room that may know its class
    "SingleLinkArm": "plants/arms",
    "TwoLinkArm": "plants/arms",
    "LargeDeflectionBeam": "plants/large_deflection",
    "SliderCrank": "plants/slider_crank",
    "FlexibleSpacecraft": "plants/spacecraft",
    "FlexibleTree": "plants/multibody",
    "LagrangianPlant": "plants/dynamics",
    "MechanicalPlant": "plants/dynamics",
}
ENDS = {"endswith", "startswith", "removesuffix", "removeprefix"}
TEXTS = {  # what is no name of a signal: {file: the expressions whose beginnings and ends are looked at}
    "plants/stability/assessment.py": {"str(refusal)"},  # the method's own words
    "plants/stability/verdict.py": {"str(refusal)"},
    "plants/stability/open_motion.py": {"str(refusal)"},  # the method's own words
    "plants/files/toml_text.py": {"content.decode()"},  # a file's first character
    "envs/scene_files/plant_scene.py": {"line", "line.removeprefix('[')"},  # of a file
    "envs/scene_files/starts.py": {"line"},  # of a file
    "studies/report/answer.py": {"text"},  # sentences
    "studies/report/control_sections.py": {"c.failure"},
    "plants/tables/plant_tables.py": {"str(refused)"},  # the words of an error
    "envs/scenes/registry.py": {"name"},  # files
    "plants/core/imports.py": {"attribute"},  # of a module
    "plants/native/compiler.py": {"s"},  # lines of /proc/cpuinfo
    "plants/native/slp_codegen.py": {"text"},  # C source
    "plants/toolchain/straight_line.py": {"line"},  # C source
    "controllers/learning/policy_files.py": {"name", "path.name", "path.name.removesuffix('.npz')"},  # arrays and files
    "controllers/learning/policy.py": {"name"},  # files
    "controllers/learning/checkpoint.py": {"name"},  # arrays
    "plants/files/leftovers.py": {"entry.name"},  # files
    "plants/files/sealed_arrays.py": {"archive.comment", "name"},  # files
    "plants/toolchain/shared_library.py": {"content"},  # of a file
    "plants/native/kernel_cache.py": {"p.name"},  # files
    "studies/fidelity/choice.py": {"r.note"},
    "studies/common/machine.py": {"line"},  # of /proc/cpuinfo
    "studies/figures/ladder.py": {"(row.failure or '')"},
    "studies/figures/failure_strip.py": {"reason", "row.reason"},
    "studies/figures/speed_accuracy.py": {"r.reason"},
    "studies/fidelity/speed_accuracy.py": {"text"},  # why there is no result
    "plants/experiments/csv_columns.py": {"rest.rstrip()"},  # heads of a table's columns
    "controllers/export/arrays.py": {"k"},  # names of arrays
    "controllers/export/plant_step.py": {"v"},  # C source
    "studies/charts/gallery.py": {"r.reason"},
    "studies/charts/page.py": {"row.reason"},
    "studies/charts/runner.py": {"text", "twin.failure"},
    "studies/closed_loop/rollout.py": {"failure"},
    "studies/commands/doctor.py": {"name"},  # files
    "studies/commands/scenes.py": {"v"},  # names of scenes
    "studies/commands/console.py": {"category.__module__", "at[0]"},  # of modules
    "studies/report/sections.py": {"text", "name"},  # sentences, parts of the page
    "studies/fidelity/verdict_in_words.py": {"choice.physics"},  # the choice's own words
    "plants/core/errors.py": {"frame.f_globals.get('__name__', '')"},  # modules
    "controllers/analytic_gradients/run_files.py": {"name"},  # arrays
    "envs/gradients/parameter_inputs.py": {"name"},  # attributes
}


def named(node):
    """Whether an expression is the name or unit of something."""
    return (isinstance(node, ast.Attribute) and node.attr in ("name", "unit")) or (
        isinstance(node, ast.Name) and node.id in ("name", "word", "unit")
    )


def text(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def classes(node):
    """Names of the classes of the second argument of isinstance, of a tuple each."""
    parts = node.elts if isinstance(node, ast.Tuple) else [node]
    return {p.attr if isinstance(p, ast.Attribute) else getattr(p, "id", "") for p in parts}


def guesses(source, file):
    """(line, what is wrong) of a module."""
    for node in ast.walk(ast.parse(source)):
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in ("isinstance", "issubclass")
        ):
            for name in classes(node.args[1]) & set(ROOMS):
                if not file.startswith(ROOMS[name] + "/"):
                    yield node.lineno, f"asks whether a plant is a {name}"
        elif isinstance(node, ast.MatchClass) and classes(node.cls) & set(ROOMS):
            yield node.cls.lineno, "matches the class of a plant"
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in ENDS:
            said = ast.unparse(node.func.value)
            if said not in {ast.unparse(ast.parse(t)) for t in TEXTS.get(file, ())}:
                yield node.lineno, f"looks at the ends of {said}"
        elif isinstance(node, ast.Compare) and len(node.ops) == 1:
            left, right = node.left, node.comparators[0]
            if isinstance(node.ops[0], (ast.In, ast.NotIn)) and text(left) and named(right):
                yield node.lineno, f"looks for {left.value!r} in {ast.unparse(right)}"
            if isinstance(node.ops[0], (ast.Is, ast.IsNot, ast.Eq, ast.NotEq)):
                if (
                    isinstance(left, ast.Call)
                    and getattr(left.func, "id", "") == "type"
                    and classes(right) & set(ROOMS)
                ):
                    yield node.lineno, "compares the class of a plant"
                if (
                    isinstance(left, ast.Attribute)
                    and left.attr == "name"
                    and "states" in ast.unparse(left)
                    and text(right)
                ):
                    yield node.lineno, f"compares {ast.unparse(left)} with {right.value!r}"


def test_no_module_asks_for_a_shipped_plant_or_guesses_from_names():
    found = []
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*.py")):
            file = path.relative_to(ROOT).as_posix()
            found += [f"{file}:{line}: {wrong}" for line, wrong in guesses(path.read_text("utf-8"), file)]
    assert found == []


@pytest.mark.parametrize(
    ("source", "says"),
    [
        ("isinstance(plant, TwoLinkArm)", "asks whether a plant is a TwoLinkArm"),
        ("isinstance(plant, (Other, plants.SliderCrank))", "asks whether a plant is a SliderCrank"),
        ("type(plant) is FlexibleSpacecraft", "compares the class of a plant"),
        ("match plant:\n    case SingleLinkArm():\n        pass", "matches the class of a plant"),
        ("[s for s in plant.outputs if s.name.endswith('deflection')]", "looks at the ends of s.name"),
        ("name.removesuffix('_rate')", "looks at the ends of name"),
        ("s.unit.startswith('m')", "looks at the ends of s.unit"),
        ("'deflection' in s.name", "looks for 'deflection' in s.name"),
        ("plant.states[0].name == 'hub_angle'", "compares plant.states[0].name with 'hub_angle'"),
    ],
)
def test_the_check_sees(source, says):
    assert [wrong for _, wrong in guesses(source, "envs/scenes/scene.py")] == [says]


def test_a_plants_own_room_knows_it():
    assert list(guesses("isinstance(other, TwoLinkArm)", "plants/arms/two_link.py")) == []
    assert list(guesses("isinstance(plant, Plant)", "studies/report/report.py")) == []
