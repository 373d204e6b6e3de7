"""Picks the build of the extension module for this processor: a wheel holds several."""

import importlib
import os

try:
    from . import _octray as core
except ImportError:
    from ._v2 import _octray as core

    # OCTRAY_LEVEL=v2 or v3 asks for a lower level than the best.
    level = min(core.level(), os.environ.get("OCTRAY_LEVEL", "v4"))
    if level in ("v3", "v4"):
        core = importlib.import_module(f"._{level}._octray", __package__)
