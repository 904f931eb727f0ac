"""The gym: a controller, a term of the plant or an agent in Python takes part in a run.

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

from . import _feedwright
from ._bench import PUBLIC_SECRET, Benchmark, Round, benchmark, commitment, leaderboard, new_secret, verify
from ._env import Env, Observe, Reward
from ._feedwright import Measurement, Window
from ._jobs import Cut, MachineOrPath, ProgramOrPath, _machine, _program, made_of, words_of
from ._progress import Progress, told

__all__ = [
    "Benchmark",
    "Controller",
    "Env",
    "Measurement",
    "Observe",
    "PUBLIC_SECRET",
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


def _name(controller: object) -> str:
    return controller if isinstance(controller, str) else getattr(controller, "name", type(controller).__name__)


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
    `plant_term` adds a torque to the machine in both cuts.

    What the controller or the term raises ends the run and is raised here. The supervisor of the library bounds what the
    controller asks for, and takes it out of the loop where it does harm.
    """
    options = {
        "name": _name(controller),
        "of_library": isinstance(controller, str),
        "settings": words_of(settings),
        "against": against,
        "knowledge": knowledge,
        "seed": seed,
        "feed_mm_s": feed_mm_s,
        "plant_term": plant_term,
        "rows": rows,
    }
    with told(progress) as tell:
        ran = _feedwright.run_with(_program(program), _machine(machine), controller, options, tell)
    return made_of(*ran)
