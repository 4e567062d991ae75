"""`python -m gyradius` is the program `gyradius`."""

import sys

from gyradius._program import main

sys.exit(main())
