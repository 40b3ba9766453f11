"""Checks of exercises: the author's sentence first, numbers below, the traceback folded away."""

import contextlib
import copy
import sys
import traceback
from collections.abc import Callable
from typing import Any

import numpy as np


def check(holds: Any, sentence: str, **numbers: Any) -> None:
    """Fail with the author's sentence unless ``holds``.

    holds : True or False, or an array of them, of which all must be True
    sentence : what a student reads first: what is expected, and where to look
    numbers : printed below it by name, for instance yours=…, right=…
    Raises AssertionError. In a notebook only its display differs: no traceback of lines that a student did not write.

    >>> check(2 + 2 == 4, "Two and two make four.")
    """
    if np.all(holds):
        return
    told = (f"  {name.replace('_', ' ')}: {_printed(value)}" for name, value in numbers.items())
    text = "\n".join([sentence, *told])
    error = AssertionError(text)
    stack = traceback.extract_stack()[:-1]
    # Of helpers that the check's cell defines, the line that calls them.
    line = next(frame.lineno for frame in stack if frame.filename == stack[-1].filename)
    folded = [f"AssertionError: {text}", f"(line {line} of the check)"]
    # IPython shows what an exception says of itself by this name, where there is one.
    error._render_traceback_ = lambda: folded  # type: ignore[attr-defined]
    raise error


def answer(function: Callable[..., Any], *arguments: Any, may_be_none: bool = False, **named: Any) -> Any:
    """What a student's function returns: numbers as float arrays, however they were written.

    function : the student's
    arguments, named : handed to it as copies, which it must leave as they are
    may_be_none : whether None is an answer; else it is a forgotten `return`
    Lists and float32 become float64 arrays, also inside a tuple; what is no number stays as it is.
    Warnings are printed and cost nothing: nbgrader takes the points of a check that writes to stderr.
    Raises AssertionError where nothing is returned, or an argument was changed.

    >>> answer(lambda x: [2 * x, 1], 3.0)
    array([6., 1.])
    """
    given = copy.deepcopy(arguments)
    with contextlib.redirect_stderr(sys.stdout):
        returned = function(*given, **named)
    check(returned is not None or may_be_none,
          f"Your function {function.__name__} returned nothing: is there a `return`?")
    for position, (before, after) in enumerate(zip(arguments, given), start=1):
        if isinstance(before, np.ndarray):
            check(np.array_equal(before, after, equal_nan=True),
                  f"{function.__name__} changes what it was given (argument {position}): work on a copy.",
                  given=before, afterwards=after)
    return numbers_of(returned)


def numbers_of(returned: Any) -> Any:
    """Lists and arrays of numbers as float64 arrays (of truths as bool); a tuple of several things stays one."""
    if isinstance(returned, tuple):
        return tuple(numbers_of(part) for part in returned)
    if not isinstance(returned, list | np.ndarray | np.generic):
        return returned
    try:
        array = np.asarray(returned)
    except ValueError:  # of several lengths
        return returned
    if array.dtype.kind in "iuf":
        array = array.astype(float)
    return array if array.dtype.kind in "fb" else returned


def refuses(error: type[Exception], function: Callable[..., Any], *arguments: Any) -> bool:
    """Whether a student's function raises this error for these arguments.

    >>> refuses(ZeroDivisionError, lambda x: 1 / x, 0)
    True
    """
    try:
        with contextlib.redirect_stderr(sys.stdout):
            function(*copy.deepcopy(arguments))
    except error:
        return True
    return False


def _printed(value: Any) -> str:
    if isinstance(value, np.ndarray | list | tuple):
        if not all(isinstance(part, int | float | np.number) for part in np.asarray(value, object).flat):
            return str(value)
        return np.array2string(np.asarray(value, float), precision=5, suppress_small=True, separator=", ",
                               prefix=" " * 9, threshold=60)
    return f"{value:.6g}" if isinstance(value, float | np.floating) else str(value)
