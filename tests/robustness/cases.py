"""All wrong inputs of the table, by what is read."""

from case import Case
from command_cases import COMMANDS
from import_cases import IMPORTS
from motions_cases import CORRECTIONS, MOTION, SETTINGS
from recording_cases import DESCRIPTION, FRAMES, LEFT, TRUTHS
from scene_cases import FILES, SCENES, SETS

GROUPS: dict[str, tuple[Case, ...]] = {
    "`recording.json`": DESCRIPTION,
    "Frames": FRAMES,
    "Truth": TRUTHS,
    "Motions": MOTION,
    "Settings": SETTINGS,
    "Corrections": CORRECTIONS,
    "Scenes": SCENES,
    "Files that scenes name": FILES,
    "Families, data sets, sweeps": SETS,
    "Imports": IMPORTS,
    "Arguments": COMMANDS,
    "What was left": LEFT,
}
