"""What must hold of a finished site: links lead somewhere, pictures have words, nothing is loaded from elsewhere."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_LOADED = {"script": "src", "img": "src", "iframe": "src", "source": "src", "video": "src", "object": "data"}
_URL = re.compile(r"""(?:url\(\s*['"]?|@import\s+['"])\s*(?P<to>[^'")\s]+)""")


@dataclass
class _Page(HTMLParser):
    """What one page names, loads and points at."""

    ids: set[str] = field(default_factory=set)
    links: list[str] = field(default_factory=list)
    loads: list[str] = field(default_factory=list)
    mute: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        has = {name: value or "" for name, value in attrs}
        self.ids.update(has[name] for name in ("id", "name") if name in has)
        if tag == "img" and not has.get("alt", "").strip():
            self.mute.append(has.get("src", "?"))
        if tag == "a" and "href" in has:
            self.links.append(has["href"])
        elif tag == "link" and has.get("rel") in ("stylesheet", "icon", "preload"):
            self.loads.append(has["href"])
        elif has.get(_LOADED.get(tag, "")):
            self.loads.append(has[_LOADED[tag]])


def faults(site: Path) -> list[str]:
    """One line a fault of the site: which page, and what is wrong there."""
    pages = {path: _read(path) for path in sorted(site.rglob("*.html"))}
    found = [fault for path, page in pages.items() for fault in _faults_of(site, path, page, pages)]
    return found + [f"{sheet.relative_to(site)} loads {to}" for sheet in sorted(site.rglob("*.css"))
                    for to in _URL.findall(sheet.read_text(encoding="utf-8"))
                    if not to.startswith(("data:", "#")) and _target(site, sheet, to) is None]


def _faults_of(site: Path, path: Path, page: _Page, pages: dict[Path, _Page]) -> Iterator[str]:
    name = path.relative_to(site)
    yield from (f"{name}: picture without alternative text: {picture[:80]}" for picture in page.mute)
    yield from (f"{name} loads {loaded}, which is not part of the site" for loaded in page.loads
                if not loaded.startswith("data:") and _target(site, path, loaded) is None)
    for link in page.links:
        if urlsplit(link).scheme:  # elsewhere, or mail
            continue
        target, fragment = _target(site, path, link), unquote(urlsplit(link).fragment)
        if target is None:
            yield f"{name} points at {link}, which is not there"
        elif fragment and target in pages and fragment not in pages[target].ids:
            yield f"{name} points at {link}, and {target.name} has nothing of that name"


def _target(site: Path, path: Path, link: str) -> Path | None:
    """The file of this site a link leads to; None for a missing one, and for one elsewhere."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return None
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if target.is_dir():
        target /= "index.html"
    return target if target.is_file() and target.is_relative_to(site) else None


def _read(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page
