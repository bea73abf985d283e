"""What the machine has, for whoever sets Unocclude up."""

import os
import platform
from importlib.metadata import version

from recording.version import VERSION
from simulator.backend import find_backend

_PACKAGES = ("mitsuba", "drjit", "numpy", "scipy", "opencv-contrib-python-headless", "OpenEXR", "trimesh", "pyarrow")


def diagnosis() -> str:
    """Versions, rendering backend and why, cores; and what is missing with how to get it. One line each."""
    backend = find_backend("auto")
    lines = [
        f"unocclude {VERSION}, Python {platform.python_version()}, {platform.platform()}",
        ", ".join(f"{name} {version(name)}" for name in _PACKAGES),
        f"rendering backend: {backend.name} ({backend.reason})",
        f"cores: {os.cpu_count()}",
    ]
    if backend.name != "llvm":
        lines.append("missing: LLVM 19, for fast rendering; on Debian: apt-get install libllvm19")
    return "\n".join(lines)
