"""Document → the words of a `World`; every mistake is named by file, line, key and cable."""

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from ..errors import Location, WorldError, quoted, shortened
from ..robot import MOTION_PATTERNS
from .blocks import WorldFile, keys_at
from .document import check_extent, line_number, place_text, plain, styled


def read(document: Any, path: str) -> dict[str, Any]:
    """The arguments of the `World` a document describes.

    document : its mapping; kept for saving if it comes from a file, for its comments, else
        copied
    path : what messages call it; '' where its lines have moved: they name neither file nor line
    Raises WorldError.
    """
    if not isinstance(document, Mapping):
        kind = "a list" if isinstance(document, list | tuple) else quoted(document)
        raise WorldError([f"{path}: a world is a mapping of keys (name, platform, cables, …), "
                          f"got {'an empty file' if document is None else kind}"])
    check_extent(document, path)
    content = plain(document)
    pattern = MOTION_PATTERNS.get(str(content.get("motion_pattern")))
    d = pattern.dimension if pattern else 0   # without a pattern there is a mistake anyway
    try:
        words = WorldFile.model_validate(content, context=d).part(d)
    except ValidationError as refused:
        found = [_Mistake(document, error) for error in refused.errors()[:100]]
        raise WorldError([mistake.line(path) for mistake in _distinct(found)]) from None
    return words | {"document": document if hasattr(document, "lc") else styled(content)}


class _Mistake:
    """What pydantic says of a document, and where: in parts that the document has, and a missing last key.

    Pydantic puts the name of a union's member into the path; the document has no such key.
    """

    def __init__(self, document: Any, error: Any) -> None:
        self.document, self.error, self.kind = document, error, error["type"]
        self.context = error.get("ctx", {})
        self.refused = self.context.get("error")
        location = (*error["loc"], *getattr(self.refused, "location", ()))
        self.place: Location = tuple(_existing(document, location))

    def guesses(self) -> list[str]:
        """The allowed key that looks most like an unknown one, if any does."""
        if self.kind != "extra_forbidden":
            return []
        from difflib import get_close_matches

        return get_close_matches(str(self.place[-1]), keys_at(self.place[:-1]), n=1)

    def line(self, path: str) -> str:
        number = line_number(self.document, self.place) if path else None
        return ": ".join(filter(None, (f"{path}:{number}" if number else path,
                                       shortened(place_text(self.place)), self.words())))

    def words(self) -> str:
        if self.refused is not None:
            return str(self.refused)
        if self.kind == "extra_forbidden":
            hint = "".join(f"did you mean {guess!r}? " for guess in self.guesses())
            return f"unknown key; {hint}allowed here: {', '.join(sorted(keys_at(self.place[:-1])))}"
        words = _WANTED.get(self.kind, "").format(**self.context) or self.error["msg"]
        for pydantics, ours in _WORDS.items():
            words = words.replace(pydantics, ours)
        given = self.error["input"]
        is_told = ", got " in words or self.kind == "missing"
        return words if is_told else f"{words}, got {'nothing' if given is None else quoted(given)}"


_WORDS = {"Input should": "must", "List should": "must", "a valid ": "a ", "a string": "text",
          " after validation, not ": ", got ", "greater than or equal to": "at least",
          "Field required": "missing; a world needs it"}
_WANTED = {"dict_type": "must be a block of keys", "model_type": "must be a block of keys",
           "model_attributes_type": "must be a block of keys",
           "string_pattern_mismatch": "must be one word of letters, digits, _ and -",
           "union_tag_invalid": "kind must be {expected_tags}, got {tag}",
           "union_tag_not_found": "must name its kind"}


def _existing(document: Any, location: Location) -> Iterator[str | int]:
    node = document
    for place, part in enumerate(location, 1):
        try:
            node = node[part]
        except (KeyError, TypeError):
            if place < len(location) or not isinstance(node, Mapping):
                continue
        yield part


def _distinct(found: list[_Mistake]) -> list[_Mistake]:
    """Unknown keys first, each mistake once."""
    found.sort(key=lambda mistake: mistake.kind != "extra_forbidden")
    misspelt = {(*mistake.place[:-1], guess) for mistake in found
                for guess in mistake.guesses()}
    kept: dict[Location, _Mistake] = {}
    for mistake in found:
        place = mistake.place
        # A value that fits no member of a union is told at its deepest place only.
        deeper = any(other.place[:len(place)] == place != other.place for other in found)
        if not deeper and not (mistake.kind == "missing" and place in misspelt):
            kept.setdefault(place, mistake)
    return list(kept.values())
