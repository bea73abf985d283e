"""What sweeps and data sets hold to at scale: shared work, speed-up, killed workers, killed commands, overhead, cost.

Each check says what is wanted and what was measured. Takes about twenty minutes on two idle cores; `--checks` chooses.
"""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[1])  # For the packages beside this folder.

import json as json_text
import os
import random
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Literal

import psutil
from cyclopts import App, Parameter
from typing_extensions import Annotated

from benchmarks.tables import Row, run, show
from evaluation.sweeps.graph import write_scores
from evaluation.sweeps.plan import Sweep, points_of, settings_at
from evaluation.sweeps.run import RECORDINGS, swept
from evaluation.sweeps.subject import subjects_of
from evaluation.sweeps.table import read_results
from evaluation.sweeps.graph import graph_of, trial_of
from recording.cache import Cache
from recording.cluster import Client, cluster
from recording.verify_set import verify_set
from simulator.family import load_family
from simulator.generate import generate
from simulator.order import Order

app = App(help=__doc__)
Check = Literal["shared", "workers", "killed_worker", "killed_sweep", "killed_generate", "overhead", "cost"]
FLOW = {"flow": "dis"}
"""A quick flow: what is measured is not the flow."""
