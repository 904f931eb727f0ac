"""A run as an environment of Gymnasium."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy

from . import _feedwright
from ._feedwright import Window
from ._jobs import MachineOrPath, ProgramOrPath, _machine, _program, request

try:
    from gymnasium import Env as _Base
    from gymnasium.spaces import Box
except ImportError:  # Without it a space is its bounds.
    _Base = object  # type: ignore[assignment,misc]
    Box = None  # type: ignore[assignment,misc]

#: Makes an observation of a window; the same length each time.
Observe = Callable[[Window], Any]
#: Makes a reward of the window after an action and the mean square of the contour error since, um^2.
Reward = Callable[[Window | None, float], float]

#: Largest speed along the path, as a multiple of the planned one.
FASTEST = 1.2


def observe(window: Window) -> Any:
    """The path ahead and the offset as seen from the tool, mm, the speed of the offset, mm/s, the contour error, mm, and
    the planned feedrate, mm/s."""
    measured = window.measured
    ahead = window.path_mm - measured.position_mm
    parts = (ahead.ravel(), window.offset_mm, window.offset_mm_s, measured.contour_error_mm, window.feed_mm_s[:1])
    return numpy.concatenate(parts)


def reward(window: Window | None, mean_um2: float) -> float:
    """Minus the RMS of the contour error since the last action, um."""
    return -float(numpy.sqrt(mean_um2))


class Env(_Base):  # type: ignore[misc,valid-type]
    """Cuts a program with an agent as its controller.

    An action is a multiple of the planned feedrate and the offset of the command from the path at the end of the feed
    period, mm for each axis. An observation is what `observe` makes of a window, and a reward what `reward` makes of the
    contour error since the action. An episode ends with the program; where the tool does not follow any more, `info` says
    so in `results`. The other arguments are those of `lab.run`.

    `window` is the window of the last observation. The run has a thread of its own, which waits for actions and ends with
    the environment.
    """

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode = None
    window: Window

    def __init__(
        self,
        program: ProgramOrPath,
        machine: MachineOrPath,
        *,
        servo_periods: int = 10,
        preview: int = 5,
        knowledge: str = "exact",
        feed_mm_s: float | None = None,
        plant_term: Callable[[Any, Any, float], Any] | None = None,
        largest_offset_mm: float = 0.5,
        observe: Observe = observe,
        reward: Reward = reward,
    ) -> None:
        program = _program(program)
        self._name = program.name
        self._schedule = (servo_periods, preview)
        self._options = {
            "name": "Env",
            "of_library": None,
            "feeds_mm_s": None,
            "request": request(program, _machine(machine), feed_mm_s=feed_mm_s),
            "against": None,
            "knowledge": knowledge,
            "plant_term": plant_term,
            "rows": False,
        }
        self._observe, self._reward = observe, reward
        self._seeds = numpy.random.default_rng()
        self._episode: Any = None
        episode, window = self._begin(1)
        episode.close()
        low = numpy.array([0.0] + [-largest_offset_mm] * episode.axes)
        high = numpy.array([FASTEST] + [largest_offset_mm] * episode.axes)
        all_seen = numpy.full(self._see(window).shape, numpy.inf)
        self.action_space: Any = self._space(low, high)
        self.observation_space: Any = self._space(-all_seen, all_seen)

    @staticmethod
    def _space(low: Any, high: Any) -> Any:
        return (low, high) if Box is None else Box(low, high, dtype=numpy.float64)

    def _begin(self, seed: int) -> tuple[Any, Window]:
        options = {**self._options, "seed": seed}
        episode = _feedwright.Episode(*self._schedule, options)
        window, _, _ = episode.advance()
        if window is None:
            raise ValueError(f"{self._name} has nothing to decide on")
        return episode, window

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begins anew. `seed` is that of the noise; without one each episode has another noise."""
        if _Base is not object:
            super().reset(seed=seed)
        if seed is not None:
            self._seeds = numpy.random.default_rng(seed)
        self.close()
        self._episode, window = self._begin(int(self._seeds.integers(1, 2**63)))
        return self._see(window), {}

    def _see(self, window: Window) -> Any:
        self.window, self._last = window, numpy.asarray(self._observe(window), dtype=numpy.float64)
        return self._last

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Goes on by a feed period."""
        if self._episode is None:
            raise RuntimeError("reset the environment before its first step")
        feed, *offset = (float(value) for value in numpy.asarray(action).ravel())
        window, (rows, mean_um2, max_um), results = self._episode.advance((feed, offset))
        info = {"rows": rows, "mean_um2": mean_um2, "max_um": max_um}
        if window is not None:
            self._see(window)
        else:
            self._episode, info["results"] = None, results
        return self._last, float(self._reward(window, mean_um2)), window is None, False, info

    def close(self) -> None:
        """Ends the run."""
        if self._episode is not None:
            self._episode.close()
            self._episode = None
