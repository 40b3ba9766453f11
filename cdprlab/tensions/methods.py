"""All methods by name."""

from typing import Any

from ..arrays import Array
from ..errors import InvalidInput, quoted
from . import (
    barycenter,
    closed_form,
    improved_closed_form,
    kernel,
    linear_program,
    pseudo_inverse,
    puncture,
    quadratic_program,
    relaxed,
)
from .method import Method, Solver

METHODS: dict[str, Method] = {
    "linear_program": linear_program.METHOD,
    "quadratic_program": quadratic_program.METHOD,
    "pseudo_inverse": pseudo_inverse.METHOD,
    "closed_form": closed_form.METHOD,
    "improved_closed_form": improved_closed_form.METHOD,
    "kernel": kernel.METHOD,
    "puncture": puncture.METHOD,
    "barycenter": barycenter.METHOD,
    "relaxed": relaxed.METHOD,
}


def tension_methods() -> dict[str, str]:
    """Name → one line about each method.

    >>> list(tension_methods())[0]
    'linear_program'
    """
    return {name: method.summary for name, method in METHODS.items()}


def solver_for(method: str, n: int, tension_min: Array, tension_max: Array, **options: Any) -> Solver:
    """The method built for n rows and these limits, ``(W, w_e) → tensions, reason``: what control loops call.

    Its answers are unchecked; ``checked_distribution`` judges them, one or a whole run at a
    time.
    Raises InvalidInput for an unknown method or option.
    """
    return method_named(method, options).build(n, tension_min, tension_max, **options)


def method_named(name: str, options: dict[str, Any]) -> Method:
    """Raises InvalidInput for an unknown method, or an option that it does not take."""
    if not isinstance(name, str) or name not in METHODS:
        raise InvalidInput(f"unknown tension method {quoted(name)}; there are {', '.join(METHODS)}")
    known = METHODS[name].solve.__kwdefaults__ or {}
    unknown = [option for option in options if option not in known]
    if unknown:
        raise InvalidInput(f"method {quoted(name)} takes no option {quoted(unknown[0])}; "
                           f"it takes {', '.join(known) or 'none'}")
    return METHODS[name]
