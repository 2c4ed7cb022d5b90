"""The report as one self-contained HTML page: styles, script, pictures and data are in it."""

from __future__ import annotations

from html import escape

from pliant.studies.charts import page as chart_page
from pliant.studies.common.html_page import anchor, asset, document, section

from . import sections
from .findings import Findings


def build(found: Findings, inlined: dict[str, str]) -> str:
    """The page's text; `inlined` are the pictures as svg."""
    scene = found.scene
    parts = sections.all_of(found, inlined)
    links = "".join(f'<a href="#{anchor(title)}">{escape(title)}</a>' for title, _ in parts)
    top = f"<h1>{escape(scene.name)}</h1><p>{escape(scene.about)}</p><nav>{links}</nav>"
    end = f"Made by Pliant {escape(found.machine['pliant'])} in {found.seconds:.0f} s."
    body = "".join(section(title, text) for title, text in parts)
    return document(scene.name, top, body, end, (asset(__package__ or "", "page.js"), chart_page.script()))
