"""One page, with all that it needs in it."""

import re

from pliant.studies.common.html_page import document, section


def test_a_page_holds_its_styles_and_scripts_and_escapes_its_title():
    text = document("a < b", "<h1>A</h1>", section("Two words", "<p>x</p>"), "end", ("let a = 1;\n", "let b = 2;\n"))
    assert "<title>a &lt; b - Pliant</title>" in text and '<section id="two-words"><h2>Two words</h2>' in text
    assert text.count("<script>") == 2 and "font: 16px/1.5" in text
    assert not re.search(r'(src|href)="?https?:', text)
