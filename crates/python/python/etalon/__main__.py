"""The command line: ``python -m etalon render scenes/cornell.json``."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import sysconfig

from . import _etalon


def main() -> int:
    """Runs the command line with the arguments of this process and gives the exit status."""
    # The program listens to signals itself. Python's own handler would raise KeyboardInterrupt after it.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # What jobs for farms call: the command that was installed with this package.
    program = shutil.which("etalon", path=sysconfig.get_path("scripts"))
    return _etalon.main(["etalon", *sys.argv[1:]], os.path.abspath(program) if program else None)


if __name__ == "__main__":
    sys.exit(main())
