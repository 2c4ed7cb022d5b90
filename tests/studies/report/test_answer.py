"""The table that a report begins with: what is known is in it, what is lost is told below it."""

import re
from types import SimpleNamespace as Names

from pliant.studies.closed_loop.comparison import Contest
from pliant.studies.report import answer
from pliant.studies.report.findings import Findings


def rows(text):
    cells = re.findall(r"<t[dh](?: [^>]*)?>(.*?)</t[dh]>", text)
    return dict(zip(cells[::2], cells[1::2]))


def findings(**lost):
    found = Findings.__new__(Findings)
    rung = Names(variant="stiffened 2+2", states=12, chosen=True, error=5.95e-4)
    fast = Names(setting="dop853, rtol 1e-03", seconds=2.91e-4)
    choice = Names(
        rungs=[rung],
        unit="m",
        met=True,
        convergence=4e-5,
        tolerance=1e-3,
        integrator=fast,
        motions=1,
        compare=("tip_x",),
    )
    choice.largest_step, choice.physics = Names(setting="rk8, 20 ms"), "strain"
    own = Contest("LQR", "arm", 12, cost=2.482), Contest("MPC", "arm", 12, cost=2.459, failure="tip out of bounds")
    scene = Names(plant=Names(label="arm"), cost=lambda motion: 3.5361, unit="m", tolerance=1e-3)
    gains = {"tip_y": Names(upper=0.6821)}
    horizon = Names(furthest=Names(name="tip_y", unit="m"), peak=gains, bounded={"tip_y": Names(upper=1.371)})
    horizon.limits_said, horizon.trusted = "at most 1 N of each", "linear" not in lost
    told = Names(verdict="bounded", method="floquet", horizon=horizon, sentence="It is bounded.")
    fields = {
        "scene": scene,
        "choice": choice,
        "judgement": Names(found=told, over_ranges="", reason=""),
        "contests": (*own, Contest("LQR", "finer", 16, cost=2.5)),
        "open_loop": None,
        "law": object(),
        "loops": (Names(stable=True, cost=2.482), Names(stable=False, name="a finer arm", verdict="it rings")),
        "scene_error": 5.95e-4,
        "lost": lost,
    }
    for name, value in fields.items():
        if name not in lost:
            setattr(found, name, value)
    return found


def test_the_answer_is_a_table_and_three_sentences():
    text = answer.answer(findings())
    assert rows(text) == {
        "what": "answer",
        "model": "stiffened 2+2, 12 states",
        "its error": "0.595 mm from physics, known to 40 µm; asked 1 mm",
        "method and step": "dop853, rtol 1e-03; fixed at most rk8, 20 ms",
        "its speed": "0.291 ms a simulated second",
        "stability along the motion": "bounded, by Floquet multipliers",
        "tip_y is pushed by": "at most 0.682 m of unit energy, 1.37 m by at most 1 N of each",
        "costs": "LQR 2.482, MPC 2.459 (ended early); open loop 3.536",
    }
    assert [p[:18] for p in re.findall(r"<p>(.*?)</p>", text)] == [
        "It is bounded.",
        "stiffened 2+2 (12 ",
        "The LQR designed o",
    ]
    assert re.findall(r'<p class="warning">(.*?)</p>', text) == ["On a finer arm: it rings."]


def test_numbers_beyond_the_linear_model_are_called_so():
    assert rows(answer.answer(findings(linear="no")))["tip_y is pushed by"].endswith(
        "1.37 m by at most 1 N of each; beyond where the linear model can be trusted"
    )


def test_what_is_lost_is_told_and_not_surmised():
    text = answer.answer(findings(choice="CHOICE", judgement="JUDGEMENT"))
    assert list(rows(text)) == ["what", "costs"]
    assert "The smallest model in words: nothing to tell. CHOICE." in text and "JUDGEMENT." in text
    unmet = findings()
    unmet.choice.met, unmet.choice.integrator = False, None
    told = rows(answer.answer(unmet))
    assert told["model"].endswith("not shown to keep the tolerance") and "its speed" not in told
    assert told["method and step"] == "none measured is within the tolerance"
    unmet.choice.rungs[0].chosen = False
    assert answer._model(unmet) == [("model", "none is chosen")]
