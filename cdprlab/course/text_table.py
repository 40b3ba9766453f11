"""Tables as aligned text: read by eyes, screen readers and headless notebooks alike."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ..run.log import text_table


def fixed(value: float, digits: int) -> str:
    """A number with so many decimals and no minus before zero.

    >>> fixed(-0.001, 2)
    '0.00'
    """
    return f"{round(value, digits) + 0.0:.{digits}f}"


def in_brackets(values: Iterable[float], digits: int) -> str:
    """A point or a vector as text.

    >>> in_brackets([1.0, -0.001], 2)
    '(1.00, 0.00)'
    """
    return f"({', '.join(fixed(value, digits) for value in values)})"


def cable_table(rows: Mapping[str, Sequence[str]], gap: int = 2) -> str:
    """A row a quantity under the cables' numbers.

    rows : quantity with unit → (m,) its cells
    """
    count = len(next(iter(rows.values())))
    return text_table(["cable", *map(str, range(1, count + 1))],
                      [[name, *cells] for name, cells in rows.items()], gap)


def cable_names(which: Iterable[bool]) -> str:
    """Which cables.

    which : (m,) flags

    >>> cable_names([True, False, True]), cable_names([False, True])
    ('cables 1, 3', 'cable 2')
    """
    numbers = [str(i + 1) for i in np.flatnonzero(list(which))]
    return f"cable{'s' if len(numbers) > 1 else ''} {', '.join(numbers)}"
