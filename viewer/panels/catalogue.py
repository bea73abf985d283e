"""The panels in their order; another one is a file and a line here."""

from collections.abc import Mapping

from viewer.panels.corrections import corrections_panel
from viewer.panels.desk import Panel
from viewer.panels.layers import layers_panel
from viewer.panels.motion import motion_panel
from viewer.panels.solving import solving_panel
from viewer.panels.time import time_panel

first_panel: Panel = time_panel
"""Always in sight, above the others."""
PANELS: Mapping[str, Panel] = {
    "Layers": layers_panel,
    "Motion": motion_panel,
    "Settings": solving_panel,
    "Corrections": corrections_panel,
}
"""By the name of their tab."""
