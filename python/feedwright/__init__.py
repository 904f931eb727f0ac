"""Predict where a CNC machine tool leaves the programmed path, and correct the program or the live command.

>>> import feedwright
>>> circle = feedwright.Program(text="G17 G21 G90 F3000\\nG2 X0 Y0 I10 J0\\nM2\\n")
>>> cut = feedwright.run(circle, "tnv40", tolerance_um=10)
>>> cut.corrected["rms_um"] < 0.02 * cut.uncorrected["rms_um"] and cut.within_tolerance
True
>>> cut.rows["contour_error_um"].shape == cut.rows["t_s"].shape
True

Lengths are mm, times s, feedrates mm/s, torques N m; contour errors are um. `docs/python.md` of the project has a
tour, `docs/json.md` every key of a result.
"""

from ._feedwright import FeedwrightError, Machine, Motion, Program, __version__
from ._jobs import (
    Advice,
    Check,
    Corrected,
    Cut,
    CycleTime,
    Identified,
    advise,
    check,
    controllers,
    controls,
    correct,
    identify,
    machines,
    motions,
    plan,
    run,
)
from ._sweep import Job, SweepError, Swept, merge, sweep
from ._table import Table

__all__ = [
    "Advice",
    "Check",
    "Corrected",
    "Cut",
    "CycleTime",
    "FeedwrightError",
    "Identified",
    "Job",
    "Machine",
    "Motion",
    "Program",
    "SweepError",
    "Swept",
    "Table",
    "__version__",
    "advise",
    "check",
    "controllers",
    "controls",
    "correct",
    "identify",
    "machines",
    "motions",
    "plan",
    "run",
]
