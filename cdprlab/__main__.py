"""``python -m cdprlab``."""

import signal
import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, see `cdprlab.cli.main`; what it takes to load is part of what Ctrl-C stops."""
    try:
        from .cli.main import main as run_command

        return run_command(arguments)
    except KeyboardInterrupt:
        print("cdprlab: stopped", file=sys.stderr)
        return 130


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.exit(main())
