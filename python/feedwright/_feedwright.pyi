"""The library, in Rust."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any

__version__: str

class FeedwrightError(ValueError):
    """What keeps feedwright from doing what is asked for.

    `findings` has every mistake as a dict; the other attributes are those of the first.
    """

    file: str | None
    line: int | None
    column: int | None
    code: str | None
    hint: str | None
    findings: list[dict[str, Any]]

class Program:
    """A G-code program in a file or a text, and how it is read."""

    def __init__(
        self,
        path: str | PathLike[str] | None = None,
        *,
        text: str | None = None,
        name: str | None = None,
        dialect: str = "auto",
        tool_table: str | PathLike[str] | None = None,
        inch_tools: bool = False,
        subroutines: Sequence[str | PathLike[str]] = (),
    ) -> None: ...
    @property
    def name(self) -> str:
        """What messages call it."""

class Motion:
    """A motion of a program."""

    line: int
    rapid: bool
    shape: str
    """`line`, `arc` or `spline`."""
    start_mm: tuple[float, float, float]
    end_mm: tuple[float, float, float]
    center_mm: tuple[float, float, float] | None
    """Of an arc."""
    turns: int
    """Of an arc: positive is counter-clockwise, and each unit beyond 1 adds a full turn."""
    feed_mm_s: float
    """Programmed; not used by a rapid."""

class Motions(Iterator[Motion]):
    """The motions of a program in its order, read as they are asked for."""

    def __init__(self, program: Program) -> None: ...
    def __next__(self) -> Motion: ...

class Machine:
    """A machine: one that is built in, or one of a machine file."""

    def __init__(
        self, name_or_path: str | PathLike[str] | None = None, *, text: str | None = None, name: str = "machine.toml"
    ) -> None: ...
    @property
    def name(self) -> str:
        """Its name."""
    @property
    def text(self) -> str:
        """The machine file that reads as this machine."""
    @property
    def values(self) -> dict[str, Any]:
        """The keys and values of its file, as nested dicts."""
    def with_values(self, values: Mapping[str, float | int | str | bool]) -> Machine:
        """A machine with other values, by the keys of the file: `{"axis.x.kp_1_s": 80}`."""

class CutOutcome:
    def html(self) -> bytes: ...

class IdentifiedMachine:
    def html(self) -> bytes: ...

_Told = Callable[[str, int, int], Any] | None

def main(arguments: Sequence[str]) -> int: ...
def lists() -> dict[str, list[str]]: ...
def check(program: Program) -> dict[str, Any]: ...
def run(
    program: Program, machine: Machine, options: dict[str, Any], progress: _Told
) -> tuple[dict[str, Any], dict[str, Any] | None, CutOutcome]: ...
def correct(
    program: Program, machine: Machine, options: dict[str, Any], progress: _Told
) -> tuple[dict[str, Any], str | None]: ...
def advise(program: Program, machine: Machine, options: dict[str, Any], progress: _Told) -> dict[str, Any]: ...
def plan(
    program: Program, machine: Machine, control: str | None, progress: _Told
) -> tuple[dict[str, Any], dict[str, Any]]: ...
def identify(
    logs: Sequence[str | PathLike[str]], columns: str | None, name: str, progress: _Told
) -> tuple[dict[str, Any], Machine, IdentifiedMachine]: ...
