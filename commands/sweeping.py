"""Trying out many settings: sweep, tune."""

import json
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from commands.common import CACHING, COMMON, SCALING, WRITING, Caching, Common, Output, Scaling, Writing
from evaluation.sweeps.plan import load_sweep
from evaluation.sweeps.plots import draw_curves, draw_pairs, has_pairs
from evaluation.sweeps.run import swept
from evaluation.sweeps.summary import summary_document, summary_of, summary_text, write_summary
from evaluation.sweeps.table import RESULTS
from evaluation.sweeps.tune import tuned
from evaluation.sweeps.tune_report import tuning_document, tuning_text, write_tuning


def sweep_command(
    sweep: Path,
    *,
    output: Output,
    json_: Annotated[bool, Parameter(name="--json")] = False,
    scaling: Scaling = SCALING,
    caching: Caching = CACHING,
    common: Writing = WRITING,
) -> None:
    """Score many settings on many recordings: a table, the best setting, how much each parameter matters, plots.

    Example: `unocclude sweep sweeps/epsilon.toml -o epsilon`

    The same call again goes on where it ended, and makes what is missing after changes to the sweep's file. What points
    have in common is made once. docs/sweeps.md says what stands in the file.

    Args:
        sweep: TOML file.
        output: Folder for `results.parquet`, `summary.md`, `summary.json`, the plots, and what is simulated. With
            `--overwrite` every point is scored again, from the cache where that holds.
        json_: The summary as one JSON object in place of text.
    """
    plan = load_sweep(sweep)
    with common.progress(), scaling.team(common) as client:
        rows = swept(plan, output, client, cache=caching.chosen(), overwrite=common.overwrite)
    summary = summary_of(plan, rows)
    write_summary(summary, output)
    for ending in ("png", "svg"):
        draw_curves(plan, rows, output / f"curves.{ending}")
        if has_pairs(plan):
            draw_pairs(plan, rows, output / f"pairs.{ending}")
    print(json.dumps(summary_document(summary), allow_nan=False) if json_ else summary_text(summary))
    common.say(f"swept {output / RESULTS}: {len(rows)} rows, {len(summary.failures)} failed")


def tune_command(
    sweep: Path,
    *,
    output: Output,
    trials: Annotated[int, Parameter(validator=Number(gte=1))] = 64,
    at_once: Annotated[int, Parameter(validator=Number(gte=1))] = 2,
    json_: Annotated[bool, Parameter(name="--json")] = False,
    scaling: Scaling = SCALING,
    caching: Caching = CACHING,
    common: Common = COMMON,
) -> None:
    """Search the best settings on development seeds: error against time, and which settings none is better than.

    Example: `unocclude tune sweeps/default.toml -o tuning --trials 100`

    The file is that of a sweep; its axes are searched between their ends. The same call again goes on until there are
    so many trials.

    Args:
        sweep: TOML file.
        output: Folder for the study (`study.log`, an Optuna journal), `trials.json`, `best.toml`, the plot of error
            against time, and what is simulated.
        trials: How many settings the study is to have tried, those of earlier calls among them.
        at_once: Trials that are drawn before the first of them is known; with more workers than recordings, more.
        json_: One JSON object in place of a table.
    """
    plan = load_sweep(sweep)
    with common.progress(), scaling.team(common) as client:
        attempts = tuned(plan, output, client, trials=trials, at_once=at_once, cache=caching.chosen())
    write_tuning(plan, attempts, output)
    print(json.dumps(tuning_document(plan, attempts), allow_nan=False) if json_ else tuning_text(plan, attempts))
