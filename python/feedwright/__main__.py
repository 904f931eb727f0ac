"""The command `feedwright`: the same as the one that is built with Rust alone."""

import signal
import sys

from . import _feedwright


def main() -> int:
    """Runs the command of this process and returns its exit code."""
    # As in a command without an interpreter: one that writes files listens by itself, any other ends at once.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _feedwright.main(["feedwright", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
