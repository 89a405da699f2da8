"""A run of a fleet, to be killed: folder, manifest."""

import sys
from pathlib import Path

from dashpot.face.batch import run
from dashpot.fleet.engine import local
from dashpot.fleet.manifest import read_manifest

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent))
    run(read_manifest(Path(sys.argv[2])), Path(sys.argv[1]), local("worker", 2))
