"""The house form of a docstring as reStructuredText, for Sphinx.

The form: a line, paragraphs, then lines ``name : shape [unit]``, Returns, Raises, Source, and a doctest. Formulas are
plain text, so that everything which reStructuredText would read as a mark has to be escaped.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

Link = Callable[[str], str | None]
"""A name in backticks → the full name of what it is, None where it is nothing public."""

_NAMES = r"[\w*]+(?:, [\w*]+)*"
_ARGUMENT = re.compile(rf"(?P<names>{_NAMES}) : (?P<text>.*)")
_SEVERAL = re.compile(rf"; (?={_NAMES} : )")
_FIELD = re.compile(r"(?P<name>Returns|Raises|Source:) (?P<text>.*)")
_CLASS = re.compile(r"(?<![`\w.])[A-Z][a-z]\w+(?![`\w])")
_CODE = re.compile(r"(``.+?``|`[^`]+`)")


def as_rst(docstring: str, link: Link = lambda name: None) -> list[str]:
    """The lines of a docstring, to be read by Sphinx.

    >>> as_rst("Force. \\n\\ntau_ : (m,) [N]\\nReturns (n,).")
    ['Force.', '', ':Arguments:', '   **tau\\\\_** : (m,) [N]', '', ':Returns: (n,).', '']
    """
    lines: list[str] = []
    inside = False  # the list of arguments
    for kind, text in _parts(docstring.splitlines()):
        if kind == "argument":
            if not inside:
                lines.append(":Arguments:")
            for one in _SEVERAL.split(text):
                names, meaning = one.split(" : ", 1)
                lines += [f"   **{_escaped(names)}** : {inline(meaning, link)}", ""]
        elif kind in ("Returns", "Raises", "Source"):
            lines += [f":{kind}: {inline(_named(text, link) if kind != 'Source' else text, link)}", ""]
        else:
            lines += [text if kind == "doctest" else inline(text, link), ""]
        inside = kind == "argument"
    return lines


def inline(text: str, link: Link = lambda name: None) -> str:
    """A line of text with code in it.

    >>> inline("K_p * e_, see `Run`", {"Run": "cdprlab.Run"}.get)
    'K_p \\\\* e\\\\_, see :py:obj:`Run <cdprlab.Run>`'
    """
    return "".join(_code(part.strip("`"), link if part[1] != "`" else lambda name: None) if part[:1] == "`"
                   else _escaped(part) for part in _CODE.split(text))


def _named(text: str, link: Link) -> str:
    """Classes are named without backticks in what is returned and raised."""
    return _CLASS.sub(lambda found: f"`{found[0]}`" if link(found[0]) else found[0], text)


def _parts(lines: list[str]) -> Iterator[tuple[str, str]]:
    """(kind, text) of what follows one another: paragraph, argument, Returns, Raises, Source, doctest."""
    kind, held = "", ""
    for line in [*lines, ""]:
        if kind == "doctest" and line.strip():
            held += f"\n{line}"
            continue
        if line.startswith(">>> "):
            begun = ("doctest", line)
        elif found := _FIELD.fullmatch(line):
            begun = (found["name"].rstrip(":"), found["text"])
        elif _ARGUMENT.fullmatch(line):
            begun = ("argument", line)
        elif line.strip() and not (kind == "argument" and line[:1].isupper()) and kind:
            held += f" {line.strip()}"  # goes on
            continue
        else:
            begun = ("paragraph" if line.strip() else "", line.strip())
        if kind:
            yield kind, held
        kind, held = begun


def _code(name: str, link: Link) -> str:
    target = link(name)
    return f":py:obj:`{name} <{target}>`" if target else f"``{name}``"


def _escaped(text: str) -> str:
    return re.sub(r"[\\*|]|_(?!\w)|(?<=\w)_(?=_)", r"\\\g<0>", text)
