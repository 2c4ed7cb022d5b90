"""A self-contained HTML page in the house style: its styles and scripts are in it, and it opens without a network."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from importlib import resources


def document(title: str, header: str, main: str, footer: str, scripts: Sequence[str] = ()) -> str:
    """The page's text. `header`, `main`, `footer`: HTML; scripts: JavaScript, run at the end."""
    style = asset(__package__ or "", "page.css")
    head = (
        '<meta charset="utf-8">\n<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)} - Pliant</title>\n<style>\n{style}</style>\n"
    )
    played = "".join(f"<script>\n{script}</script>\n" for script in scripts)
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n{head}</head>\n<body>\n<header>{header}</header>\n'
        f"<main>\n{main}</main>\n<footer>{footer}</footer>\n{played}</body>\n</html>\n"
    )


def section(title: str, body: str) -> str:
    """A part with its heading, which links can name."""
    return f'<section id="{anchor(title)}"><h2>{escape(title)}</h2>\n{body}</section>\n'


def anchor(title: str) -> str:
    """What a link to a section names."""
    return title.lower().replace(" ", "-")


def asset(package: str, name: str) -> str:
    """A file that is shipped with a package, as text."""
    return resources.files(package).joinpath(name).read_text(encoding="utf-8")
