"""The page of published laws and Pliant's own."""

from pliant.studies.two_carts.comparison import OWN, compared, markdown, picture
from pliant.studies.two_carts.published import PUBLISHED


def test_rows_tell_what_is_printed_and_what_is_met():
    rows = compared(OWN[:1])
    by_name = {row.name: row for row in rows}
    assert len(rows) == len(PUBLISHED) + 1
    assert by_name["coefficient diagram 3"].merit.meets
    assert not by_name["coefficient diagram 2"].merit.meets  # unstable at 0.5 and 2 N/m
    lqg = by_name["LQG, price 1"]
    assert lqg.printed_score is None and lqg.score_so is None
    assert 10 < lqg.merit.settling[1] < 15 and not lqg.merit.meets  # as quick as is asked for, without its robustness
    page = markdown(rows, "make it")
    assert "Made by `make it`" in page
    assert page.count("\n| ") == len(rows) + 1
    assert "| coefficient diagram 3 (Manabe and Kim 2021) |" in page
    drawn = picture(rows[-2:], [PUBLISHED[-1].law, OWN[0].law])
    assert [line.get_label() for line in drawn.axes[0].lines][-1] == "LQG, price 1"
