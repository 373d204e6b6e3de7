"""Picks the builds of module and program for this processor: a wheel holds several."""

import importlib
import os
import sys
from pathlib import Path

from . import _octray as core

# The best level of the processor; OCTRAY_LEVEL=v2 or v3 asks for less.
level = min(core.level(), os.environ.get("OCTRAY_LEVEL", "v4"))
try:
    core = importlib.import_module(f"._{level}._octray", __package__)
except ModuleNotFoundError:
    # For the lowest level, or built for this machine alone.
    pass


def program() -> None:
    """Run the program octray, with the arguments of this process."""
    folder = Path(__file__).parent
    for name in (f"_{level}", "_v2"):
        path = folder / name / "octray"
        if path.exists():
            # Installers that do not keep permissions take the right to execute.
            if not os.access(path, os.X_OK):
                path.chmod(0o755)
            os.execv(path, ["octray", *sys.argv[1:]])
    sys.exit("octray: this package has only the Python module; a wheel has the program too")
