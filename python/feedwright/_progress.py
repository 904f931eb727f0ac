"""What a job tells of its progress."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

#: Called with the stage, the steps that are done and all steps of the stage, some 25 times a second.
Told = Callable[[str, int, int], Any]
#: A bar of tqdm, a function, or nothing.
Progress = bool | Told | None


class Bar:
    """A bar of tqdm for each stage."""

    def __init__(self) -> None:
        from tqdm.auto import tqdm

        self._tqdm = tqdm
        self._bar: Any = None
        self._stage = ""

    def __call__(self, stage: str, done: int, steps: int) -> None:
        if self._bar is None or stage != self._stage:
            self.close()
            self._stage, self._bar = stage, self._tqdm(total=steps or None, desc=stage, leave=False)
        self._bar.total = steps or None
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        """Removes the bar."""
        if self._bar is not None:
            self._bar.close()


@contextmanager
def told(progress: Progress) -> Iterator[Told | None]:
    """The function that a job calls; a bar is removed at the end."""
    if progress is not True:
        yield progress or None
        return
    bar = Bar()
    try:
        yield bar
    finally:
        bar.close()
