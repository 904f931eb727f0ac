"""The gym: a controller, a planner, a term of the plant or an agent in Python takes part in a run.

>>> from feedwright import lab, Program
>>> class Straight:
...     servo_periods, preview = 10, 0
...     def reset(self): pass
...     def command(self, window): return 1.0, [0.0, 0.0]
>>> square = Program(text="G21 F3000\\nG1 X10\\nG1 Y10\\nM2\\n")
>>> cut = lab.run(square, "tnv40", Straight())
>>> cut.corrected["controller"], cut.corrected["rms_um"] == cut.uncorrected["rms_um"]
('Straight', True)

`docs/lab.md` of the project has a tour.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy

from . import _feedwright
from ._bench import PUBLIC_SECRET, Benchmark, Round, _name, benchmark, commitment, leaderboard, new_secret, verify
from ._env import Env, Observe, Reward
from ._feedwright import Machine, Measurement, Motion, Program, Window
from ._jobs import Cut, MachineOrPath, ProgramOrPath, _machine, _program, made_of, request, words_of
from ._progress import Progress, told

__all__ = [
    "Benchmark",
    "Controller",
    "Env",
    "Measurement",
    "Observe",
    "PUBLIC_SECRET",
    "Planner",
    "PlantTerm",
    "Reward",
    "Round",
    "Window",
    "benchmark",
    "commitment",
    "leaderboard",
    "new_secret",
    "run",
    "verify",
]

#: Called with the positions, mm, and speeds, mm/s, of the joints and the time, s: an added torque for each axis, N m.
PlantTerm = Callable[[Any, Any, float], Sequence[float]]

#: Called with the motions of the program and the machine: a feedrate for each motion, mm/s. Those of rapids are not used.
Planner = Callable[[Sequence[Motion], Machine], Sequence[float]]


class Controller(Protocol):
    """What a controller has. It may also have `prepare(axes, servo_s)`, which is called once before anything of it is read,
    and `observe(window, measured)`, which is called before each `command` and also where the position was lost.
    """

    servo_periods: int
    """Servo periods in a feed period, at least 1."""
    preview: int
    """Feed periods of preview; together at most 256 servo periods."""

    def reset(self) -> None:
        """Back to the state after construction. Called before each run."""

    def command(self, window: Window) -> tuple[float, Sequence[float]]:
        """What to do in the next feed period: a multiple of the planned feedrate, and the offset of the command from the
        path at its end, mm for each axis."""


def _feeds(planner: Planner | None, program: Program, machine: Machine) -> list[float] | None:
    """What a planner says to a program on a machine."""
    if planner is None:
        return None
    motions = list(_feedwright.Motions(program))
    feeds = numpy.asarray(planner(motions, machine), dtype=float)
    if feeds.shape != (len(motions),):
        raise ValueError(f"the planner returned {feeds.size} feedrates for {len(motions)} motions: one for each, mm/s")
    for motion, feed in zip(motions, feeds):
        if not (motion.rapid or 0 < feed < numpy.inf):
            raise ValueError(f"line {motion.line}: the planner's feedrate is {feed} mm/s; it must be above 0")
    return feeds.tolist()


def run(
    program: ProgramOrPath,
    machine: MachineOrPath,
    controller: Controller | str,
    *,
    against: str = "uncorrected",
    settings: Mapping[str, Any] | None = None,
    knowledge: str = "exact",
    seed: int | None = None,
    feed_mm_s: float | None = None,
    planner: Planner | None = None,
    plant_term: PlantTerm | None = None,
    rows: bool = True,
    progress: Progress = None,
) -> Cut:
    """Cuts a program with a controller of the library and with one in Python, in a simulation.

    A controller by its name is one of the library, as it was published: it corrects from the first servo period on.
    `settings` are those of `feedwright.run`.

    `knowledge` says what the controller is given of the axes: `exact` values; what is `identified` from a recording, that
    is inertia and friction; or `wrong` ones, with inertia 20 % too low and friction 20 % too high. What drives are set to is
    always right. `seed` is that of the noise; without one it is that of the machine file, as it is in the recording.
    `planner` sets the feedrate of each motion in the cut of the controller; the planner of the library holds the limits of the
    machine in any case. `plant_term` adds a torque to the machine in both cuts.

    What the controller, the planner or the term raises ends the run and is raised here. The supervisor of the library bounds what the
    controller asks for, and takes it out of the loop where it does harm.
    """
    program, machine = _program(program), _machine(machine)
    options = {
        "name": _name(controller, planner),
        "of_library": controller if isinstance(controller, str) else None,
        "feeds_mm_s": _feeds(planner, program, machine),
        "request": request(program, machine, settings=words_of(settings), feed_mm_s=feed_mm_s),
        "against": against,
        "knowledge": knowledge,
        "seed": seed,
        "plant_term": plant_term,
        "rows": rows,
    }
    with told(progress) as tell:
        ran = _feedwright.run_with(controller, options, tell)
    return made_of(*ran)
