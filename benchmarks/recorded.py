"""A gallery of recordings that no generator of ours drew: the paper's stand with actuator backlash, and public ones.

    python benchmarks/recorded.py [NAME ...] [-o DIR | -o FILE.json] [--quick] [--compare OLD.json] [--check]

Every entry goes through the commands as a user would type them, each in a process of its own with a limit in time, and
stands on one page beside a linear fit made here with nothing of the product, and beside published figures:
DIR/gallery.html and DIR/gallery.json. The public recordings are not part of the project; they are looked for in
../shared/data or in $DASHPOT_DATA, and left out where they are absent. What is known of each stands in
gallery/catalogue.py.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

# python -P, as the blind proof starts it, does not look beside the script
sys.path.insert(0, str(Path(__file__).resolve().parent))

# for the many small problems of the plain fit, threads of the linear algebra would only stand in their way
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from gallery.run import main

if __name__ == "__main__":
    sys.exit(main())
