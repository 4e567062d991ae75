"""The program `gyradius`, as it comes with the package."""

from __future__ import annotations

import signal
import sys
import threading

from gyradius import _core


def main() -> int:
    """Runs the program with the arguments of the command line, and gives its exit code."""
    if sys.stdout is not None and not sys.stdout.closed:
        sys.stdout.flush()
    # The program ends in good order by itself when it is interrupted: Python would end it with a traceback of its own.
    if (
        threading.current_thread() is threading.main_thread()
        and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    ):
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    # Without a path of its own, as where it is embedded, Python is called by its name.
    called = [sys.executable or "python3", "-m", "gyradius"]
    return _core.run_program(called, ["gyradius", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
