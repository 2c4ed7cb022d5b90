"""The report as one self-contained HTML page: styles, script, pictures and data are in it."""

from __future__ import annotations

from html import escape
from importlib import resources

from . import sections
from .findings import Findings


def build(found: Findings, inlined: dict[str, str]) -> str:
    """The page's text; `inlined` are the pictures as svg."""
    scene = found.scene
    parts = sections.all_of(found, inlined)
    links = "".join(f'<a href="#{_anchor(title)}">{escape(title)}</a>' for title, _ in parts)
    body = "".join(
        f'<section id="{_anchor(title)}"><h2>{escape(title)}</h2>\n{text}</section>\n' for title, text in parts
    )
    head = (
        '<meta charset="utf-8">\n<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(scene.name)} - Pliant</title>\n<style>\n{_asset('page.css')}</style>\n"
    )
    top = f"<h1>{escape(scene.name)}</h1><p>{escape(scene.about)}</p><nav>{links}</nav>"
    end = f"Made by Pliant {escape(found.machine['pliant'])} in {found.seconds:.0f} s."
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n{head}</head>\n<body>\n<header>{top}</header>\n'
        f"<main>\n{body}</main>\n<footer>{end}</footer>\n<script>\n{_asset('page.js')}</script>\n</body>\n</html>\n"
    )


def _asset(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")
