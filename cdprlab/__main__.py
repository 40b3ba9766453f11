"""``python -m cdprlab``."""

import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, see `cdprlab.cli.main`; what it takes to load is part of what Ctrl-C stops."""
    try:
        from .cli.main import main as run_command

        return run_command(arguments)
    except KeyboardInterrupt:
        # Python forgets that Ctrl-C came while a library was executing text, or would end by it and not by 130.
        exec("")
        print("cdprlab: stopped", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
