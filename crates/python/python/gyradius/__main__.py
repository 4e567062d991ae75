"""`python -m gyradius` is the program `gyradius`."""

import sys

from gyradius._program import main

if __name__ == "__main__":
    sys.exit(main())
