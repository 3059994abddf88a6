"""`hausbench track`, see track.py."""

import sys

from bench.tracking.track import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
