"""What is fuzzed: every reader of a file that somebody else may have written, or a disk may have damaged."""

from fuzz.foreign_bags import BAGS
from fuzz.foreign_cameras import CAMERAS
from fuzz.foreign_files import FOREIGN
from fuzz.kept_files import KEPT
from fuzz.own_files import OWN
from fuzz.target import Target

TARGETS: dict[str, Target] = {**OWN, **FOREIGN, **BAGS, **CAMERAS, **KEPT}
"""By what they read."""
