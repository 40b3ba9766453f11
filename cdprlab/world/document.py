"""The document of a world file: mappings and lists that remember the comments, lines and style of their text."""

import io
import pickle
import re
from collections.abc import Mapping
from contextlib import suppress
from itertools import chain
from typing import Any

import numpy as np
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.constructor import DuplicateKeyError, RoundTripConstructor
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.representer import RoundTripRepresenter
from ruamel.yaml.resolver import implicit_resolvers
from ruamel.yaml.scalarfloat import ScalarFloat
from ruamel.yaml.scalarint import ScalarInt
from ruamel.yaml.tokens import CommentToken

from ..errors import Location, WorldError, quoted, shortened

LONGEST = 1_000_000
"""Characters of a world file."""
_DEEPEST = 30
_MOST_VALUES = 8_000


def parsed(text: str, path: str) -> Any:
    """The document of a text in YAML; raises WorldError naming ``path`` and line."""
    if len(text) > LONGEST or max(len(text.split()), sum(map(text.count, "[{,:\n"))) > _MOST_VALUES:
        raise WorldError([f"{path}: too long for a world: at most {LONGEST} characters, {_MOST_VALUES} words and "
                          f"{_MOST_VALUES} lines, commas, colons and brackets"])
    try:
        return _yaml().load(text)
    except DuplicateKeyError as error:
        key = str(error.problem).split('"')[1]
        where = place_text((*_cable_at(text, error.problem_mark.index), key))
        problem = f":{error.problem_mark.line + 1}: {shortened(where)}: this key stands here twice; keep one"
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f":{mark.line + 1}" if mark else ""
        problem = f"{line}: not valid YAML: {shortened(error.problem or error.context)}"
    except RecursionError:
        problem = _TOO_DEEP
    except Exception as error:   # of ruamel's own
        problem = f": not valid YAML: {shortened(str(error))}"
    raise WorldError([path + problem])


def check_extent(document: Any, path: str) -> None:
    """Raises WorldError for what is nested too deep or, its aliases written out, has too many values."""
    level, count = [document], 0
    for _ in range(_DEEPEST):
        inside = [node.values() if isinstance(node, Mapping) else node
                  for node in level if isinstance(node, Mapping | list | tuple)]
        count += sum(map(len, inside))
        if count > _MOST_VALUES:
            raise WorldError([f"{path}: too much for a world: more than {_MOST_VALUES} values, aliases written out"])
        level = [*chain.from_iterable(inside)]
    if level:
        raise WorldError([path + _TOO_DEEP])


_TOO_DEEP = f": blocks and lists are nested more than {_DEEPEST} deep, or hold themselves"


def dumped(document: Any) -> str:
    """The text of a document."""
    buffer = io.StringIO()
    _yaml().dump(document, buffer)
    return buffer.getvalue()


def plain(value: Any) -> Any:
    """A document's containers and numbers, or NumPy's, as plain Python."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    for kind in (bool, int, float, str):
        if isinstance(value, kind):
            return kind(value)
    return value


def styled(value: Any) -> Any:
    """Plain data as it reads best in YAML: what fits on a line in braces or brackets, the rest indented; no None."""
    if isinstance(value, dict):
        node: Any = CommentedMap((key, styled(item)) for key, item in value.items()
                                 if item is not None)
    elif isinstance(value, list):
        node = CommentedSeq(styled(item) for item in value)
    else:
        return value
    if len(str(value)) <= 110:
        node.fa.set_flow_style()
    return node


def copied(document: Any) -> Any:
    """A document of its own to be changed, in a fifth of deepcopy's time."""
    return pickle.loads(pickle.dumps(document))


def overlay(node: Any, before: dict[Any, Any], after: dict[Any, Any]) -> None:
    """Write into a block, or a list by its indices, what differs between two descriptions of it.

    None and [] leave a key out; what is built alike keeps its style and comments.
    """
    for key in before | after:
        old: Any = before.get(key)
        value: Any = after.get(key)
        if old == value:
            continue
        _mark_changed(node, key)
        there: Any = node[key] if isinstance(key, int) or key in node else None
        kinds = {type(plain(there)), type(old), type(value)}
        if value in (None, []):
            node.pop(key, None)
        elif kinds == {dict}:
            overlay(own(node, key), old, value)
        elif kinds == {list} and (isinstance(value[0], dict) or len(there) == len(value)):
            entries = own(node, key)
            del entries[len(value):]
            overlay(entries, dict(enumerate(old[:len(value)])), dict(enumerate(value[:len(entries)])))
            entries.extend(map(styled, value[len(entries):]))
        else:
            node[key] = styled(value)


def own(node: Any, key: str | int) -> Any:
    """The block at ``key``, to be changed: a copy if others refer to it (YAML anchors)."""
    if node[key].yaml_anchor() is not None:
        node[key] = copied(node[key])
        node[key].yaml_set_anchor(None)
    return node[key]


def _mark_changed(node: Any, key: str | int) -> None:
    """The comment beside a value, which tells where that came from, says that it is another one now."""
    after = node.ca.items.get(key, ())[0 if isinstance(key, int) else 2:][:1] if hasattr(node, "ca") else ()
    for token in after:
        if isinstance(token, CommentToken) and not token.value.startswith("# changed"):
            token.value = "# changed; before:" + token.value.removeprefix("#")


# --- places -------------------------------------------------------------------------------------------
def place_text(location: Location) -> str:
    """A place in words: cables are counted from 1.

    >>> place_text(("cables", 2, "tension"))
    'cable 3: tension'
    """
    text = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}"
                   for part in location)
    return re.sub(r"^cables\[(\d+)\]\.?", r"cable \1: ", text.lstrip(".")).removesuffix(": ")


def line_number(document: Any, location: Location) -> int | None:
    """Line (from 1) of the deepest part of ``location`` the document has; None where it has no lines."""
    node = document
    line = None
    with suppress(AttributeError, KeyError, TypeError):
        line = node.lc.line + 1
        for part in location:
            line = node.lc.data[part][0] + 1
            node = node[part]
    return line


def _cable_at(text: str, index: int) -> Location:
    """("cables", i) of the cable in whose block a character stands; () outside of them."""
    for key, value in _yaml().compose(text).value:
        if key.value == "cables" and isinstance(value.value, list):
            for i, block in enumerate(value.value):
                if block.start_mark.index <= index < block.end_mark.index:
                    return ("cables", i)
    return ()


class _Constructor(RoundTripConstructor):
    """Names the line of what Python cannot make of a date, a number or a tag."""

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        kind = node.tag.rpartition(":")[2]
        try:
            if kind in ("int", "float") and node.value.endswith("_"):   # 1_ is no 1
                raise ValueError
            return super().construct_object(node, deep)
        except (YAMLError, RecursionError):
            raise
        except Exception:
            raise MarkedYAMLError(problem=f"{quoted(node.value)} is no {kind}", problem_mark=node.start_mark) from None


class _Representer(RoundTripRepresenter):
    """Writes numbers and texts so that readers of YAML 1.1 (PyYAML) take them for what they are, too."""

    def number(self, value: Any) -> Any:
        node = RoundTripRepresenter.yaml_representers[type(value)](self, value)
        as_read = _with_point_and_sign(node.value)
        if isinstance(value, int):
            node.value = str(int(value))   # in 1.1 010 is eight
        elif re.fullmatch(r"[-+]?\d+\.\d*(e[-+]\d+)?", as_read) and float(as_read) == value:
            node.value = as_read
        else:
            node.value = _with_point_and_sign(repr(float(value)))
        return node

    def text(self, value: str) -> Any:
        means_more = any(rule.match(value) for versions, _, rule, _ in implicit_resolvers if (1, 1) in versions)
        return self.represent_scalar("tag:yaml.org,2002:str", value, style="'" if means_more else None)


_Representer.add_representer(str, _Representer.text)
for kind in (float, ScalarFloat, ScalarInt, *ScalarInt.__subclasses__()):
    _Representer.add_representer(kind, _Representer.number)


def _with_point_and_sign(number: str) -> str:
    """In 1.1 only 5.0e+4 is a number, neither 5e+4 nor 5.0e4."""
    mantissa, e, exponent = number.lower().partition("e")
    point = ".0" if e and "." not in mantissa else ""
    sign = "+" if exponent[:1].isdigit() else ""
    return mantissa + point + e + sign + exponent


def _yaml() -> YAML:
    yaml = YAML()
    yaml.Constructor = _Constructor
    yaml.Representer = _Representer
    yaml.composer.warn_double_anchors = False
    yaml.width = 120
    yaml.indent(mapping=2, sequence=4, offset=2)
    return yaml
