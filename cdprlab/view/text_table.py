"""Tables as aligned text: read by eyes, screen readers and headless notebooks alike."""

from __future__ import annotations

from collections.abc import Sequence


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]], gap: int = 2) -> str:
    """Columns aligned, ``gap`` spaces apart: the first to the left, all others to the right.

    >>> print(text_table(["cable", "1", "2"], [["length [m]", "4.36", "12.10"]]))
    cable          1      2
    length [m]  4.36  12.10
    """
    lines = [list(header), *map(list, rows)]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join((gap * " ").join(cell.ljust(width) if k == 0 else cell.rjust(width)
                                     for k, (cell, width) in enumerate(zip(line, widths))).rstrip() for line in lines)


def fixed(value: float, digits: int) -> str:
    """A number with so many decimals and no minus before zero.

    >>> fixed(-0.001, 2)
    '0.00'
    """
    return f"{round(value, digits) + 0.0:.{digits}f}"
