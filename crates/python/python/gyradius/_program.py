"""The program `gyradius`, as it comes with the package."""

from __future__ import annotations

import sys

from gyradius import _core


def main() -> int:
    """Runs the program with the arguments of the command line, and gives its exit code."""
    if sys.stdout is not None and not sys.stdout.closed:
        sys.stdout.flush()
    return _core.run_program(["gyradius", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
