"""How far numbers in a text are from where they were at the start: told beside or below each of them."""

import html
import re

NUMBER = re.compile(r"(?<![\w.])[-−+]?\d+(?:\.\d+)?(?:e[-+]\d+)?(?![\w])")


def with_changes(text: str, start: str) -> str:
    """The text as HTML, with the change since the start beside the only number of a line, below those of a table.

    Lines that say something else than at the start, and sentences, stay as they are.

    >>> with_changes("load [N]  12.5", "load [N]  10.0")
    'load [N]  12.5<i>  (+2.5)</i>'
    >>> print(with_changes("a  1.0  2.0", "a  1.0  4.0"))
    a  1.0  2.0
    <i>       -2.0</i>
    """
    before: dict[str, list[str]] = {}
    for line in start.splitlines():
        before.setdefault(_words(line), []).append(line)
    told = []
    for line in text.splitlines():
        told.append(html.escape(line))
        alike = before.get(_words(line))
        old, numbers = alike.pop(0) if alike else line, list(NUMBER.finditer(line))
        if line == old or line.endswith("."):
            continue
        changes = [_change(number.group(), was) for number, was in zip(numbers, NUMBER.findall(old))]
        if len(numbers) == 1:
            told[-1] += f"<i>  ({changes[0]})</i>"
            continue
        below = ""
        for number, change in zip(numbers, changes):
            below = below.ljust(number.end() - len(change))
            below += f"{' ' * (below[-1:] not in ('', ' ') and change != '')}{change}"
        told.append(f"<i>{below}</i>")
    return "\n".join(told)


def _words(line: str) -> str:
    """All of a line but its numbers."""
    return " ".join(NUMBER.sub("#", line).split())


def _change(now: str, was: str) -> str:
    """As many decimals as shown; nothing where nothing changed."""
    if now == was:
        return ""
    digits = len(now.partition(".")[2]) if "e" not in now else 0
    change = float(now.replace("−", "-")) - float(was.replace("−", "-"))
    return f"{change:+.1e}" if "e" in now else f"{change:+.{digits}f}"
