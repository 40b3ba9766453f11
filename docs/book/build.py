"""`make book`: the executed lessons, the pages of docs/ and the public face as a static site, in build/book/.

    python docs/book/build.py [--run all|none|LESSON] [--out FOLDER]

Nothing is fetched, neither while building nor by who reads it. Warnings are errors, and so is a broken link.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

HERE = Path(__file__).resolve().parent
CHECKOUT = HERE.parents[1]
sys.path[:0] = [str(CHECKOUT), str(HERE)]  # the package documented is this checkout's

import lesson_page  # noqa: E402
import site_check  # noqa: E402
import source_tree  # noqa: E402
from sphinx.cmd.build import build_main  # noqa: E402


def build(site: Path, work: Path, run: str = "all") -> int:
    """Make the site, in place of the one before if nothing is wrong with it; returns how many things are.

    site : folder for the pages and nothing else: it can be published as it is
    work : folder for what they are made from, solutions and executed lessons among it
    run : the lessons that are executed: "all", "none", or the name of one
    """
    pages, made = source_tree.assemble(work / "source", work / "executed", run), work / "site"
    shutil.rmtree(made, ignore_errors=True)
    source_tree.math(made)
    failed = build_main(["-b", "html", "-c", str(HERE), "-d", str(work / "doctrees"), "--fail-on-warning",
                         "--keep-going", "--nitpicky", "--quiet", str(pages), str(made)])
    faults = site_check.faults(made)
    for fault in faults:
        print(fault, file=sys.stderr)
    if not failed and not faults:
        shutil.rmtree(site, ignore_errors=True)
        shutil.move(made, site)
    return int(failed != 0) + len(faults)


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--run", default="all", choices=["all", "none", *lesson_page.names()], metavar="LESSON",
                        help="lessons to execute: all (default), none, or one by name")
    parser.add_argument("--out", type=Path, default=CHECKOUT / "build" / "book", help="folder of the site")
    options = parser.parse_args(arguments)
    site = options.out.resolve()
    wrong = build(site, site.with_name(f"{site.name}_work"), options.run)
    if wrong:
        print(f"The book has {wrong} fault{'s' if wrong > 1 else ''}, see above; {site} stays as it was.",
              file=sys.stderr)
        return 1
    print(f"{site}/index.html: open it in a browser, or put the folder on any web server.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
