"""The report as one HTML page: a table of contents, sections of text, figures and tables."""

from __future__ import annotations

import html
import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from validation.report.section import Column, Section, Table

_STYLE = """
body { font: 16px/1.55 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem;
       color: #1a1a1a; background: #fff; }
h1, h2 { line-height: 1.2; }
h2 { margin-top: 3rem; border-bottom: 1px solid #ccc; }
nav { background: #f6f6f6; padding: 0.5rem 1rem; }
figure { margin: 1.5rem 0; }
img { max-width: 100%; height: auto; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 0.9rem; max-width: 100%; }
caption { text-align: left; color: #444; padding-bottom: 0.3rem; }
th, td { padding: 0.25rem 0.6rem; text-align: right; border-bottom: 1px solid #ddd;
         vertical-align: bottom; }
td { vertical-align: top; white-space: nowrap; }
th:first-child, td:first-child, .text { text-align: left; white-space: normal; }
th abbr { text-decoration: underline dotted; }
.wide { overflow-x: auto; }
.unit { font-weight: normal; color: #444; }
code { background: #f1f1f1; padding: 0 0.2rem; white-space: nowrap; }
figcaption { color: #444; font-size: 0.9rem; }
summary { cursor: pointer; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.3rem 1rem; }
dt { font-weight: bold; }
dd { margin: 0; }
"""


def page(title: str, lead: str, sections: Sequence[Section]) -> str:
    """The page as HTML, complete but for the pictures."""
    contents = "\n".join(
        f'<li><a href="#{_anchor(section)}">{html.escape(section.title)}</a></li>'
        for section in sections
    )
    body = "\n".join(_section(section) for section in sections)
    name = html.escape(title)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{name}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{name}</h1>\n<p>{_marked(lead)}</p>\n"
        f'<nav aria-label="Contents">\n<ol>\n{contents}\n</ol>\n</nav>\n'
        f"<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def _anchor(section: Section) -> str:
    return re.sub(r"[^a-z]+", "-", section.title.lower()).strip("-")


def _section(section: Section) -> str:
    parts = [f'<h2 id="{_anchor(section)}">{html.escape(section.title)}</h2>']
    parts += [f"<p>{_marked(paragraph)}</p>" for paragraph in section.text]
    if section.terms:
        terms = "\n".join(
            f"<dt>{html.escape(term)}</dt><dd>{_marked(meaning)}</dd>"
            for term, meaning in section.terms.items()
        )
        parts.append(f"<dl>\n{terms}\n</dl>")
    parts += [
        f'<figure><img src="{html.escape(picture.file)}" alt="{html.escape(picture.alt)}">'
        f"<figcaption>{_marked(picture.caption)}</figcaption></figure>"
        for picture in section.pictures
    ]
    parts += [_table(table) for table in section.tables]
    return "\n".join(parts)


def _marked(text: str) -> str:
    """Plain text as HTML, with `names` between backticks as code."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(text))


def _table(table: Table) -> str:
    caption = html.escape(table.caption)
    head = "".join(_head(column) for column in table.columns)
    lines = "\n".join(
        "<tr>" + "".join(_cell(column, row.get(column.key)) for column in table.columns) + "</tr>"
        for row in table.rows
    )
    inner = f"<thead><tr>{head}</tr></thead>\n<tbody>\n{lines}\n</tbody>\n</table>"
    if table.folded:
        return (
            f'<details><summary>{caption}</summary>\n<div class="wide"><table>\n{inner}</div>\n'
            "</details>"
        )
    return f'<div class="wide"><table>\n<caption>{caption}</caption>\n{inner}</div>'


def _head(column: Column) -> str:
    title = html.escape(column.head)
    if column.note:
        title = f'<abbr title="{html.escape(column.note)}">{title}</abbr>'
    if column.unit:
        title += f' <span class="unit">[{html.escape(column.unit)}]</span>'
    return f'<th scope="col"{_class(column)}>{title}</th>'


def _cell(column: Column, value: Any) -> str:
    return f"<td{_class(column)}>{html.escape(column.show(value))}</td>"


def _class(column: Column) -> str:
    return ' class="text"' if column.text else ""
