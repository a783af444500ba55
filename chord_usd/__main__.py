"""python -m chord_usd is chord-usd."""

import sys

from chord_usd.cli import main

if __name__ == "__main__":
    sys.exit(main())
