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
    def _job(self) -> str: ...

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
    def _job(self) -> tuple[str, str | None]: ...
    def with_values(self, values: Mapping[str, float | int | str | bool]) -> Machine:
        """A machine with other values, by the keys of the file: `{"axis.x.kp_1_s": 80}`."""

class CutOutcome:
    def html(self) -> bytes: ...

class IdentifiedMachine:
    def html(self) -> bytes: ...

class JobList(Sequence[str]):
    def __init__(self, path: str | PathLike[str]) -> None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, number: int) -> str: ...  # type: ignore[override]

_Told = Callable[[str, int, int], Any] | None

def main(arguments: Sequence[str]) -> int: ...
def lists() -> dict[str, list[str]]: ...
def check(program: Program) -> dict[str, Any]: ...
def run(request: str, rows: bool, progress: _Told) -> tuple[dict[str, Any], dict[str, Any] | None, CutOutcome]: ...
def correct(request: str, progress: _Told) -> tuple[dict[str, Any], str | None]: ...
def advise(request: str, progress: _Told) -> dict[str, Any]: ...
def plan(
    program: Program, machine: Machine, control: str | None, progress: _Told
) -> tuple[dict[str, Any], dict[str, Any]]: ...
def identify(
    logs: Sequence[str | PathLike[str]], columns: str | None, name: str, progress: _Told
) -> tuple[dict[str, Any], Machine, IdentifiedMachine]: ...

class Measurement:
    """What is measured at the start of a feed period. Arrays have a number for each axis and are read-only."""

    @property
    def position_mm(self) -> Any:
        """Where the tool is, mm."""
    @property
    def contour_error_mm(self) -> Any:
        """From the tool to the nearest point of the path, mm."""
    @property
    def tangent(self) -> Any:
        """Direction of travel at that point."""
    @property
    def behind(self) -> int:
        """How many servo periods that point is behind the current one."""

class Window:
    """What a controller sees at the start of a feed period.

    The rows of `path_mm`, `tangent`, `feed_mm_s` and `cutting` are the path now and in the next feed periods at the planned
    feed. Arrays are copies, and read-only.
    """

    @property
    def plan_s(self) -> float:
        """Time in the feed plan, s."""
    @property
    def servo_s(self) -> float:
        """Servo period, s."""
    @property
    def feed_period_s(self) -> float:
        """Feed period, s."""
    @property
    def path_mm(self) -> Any:
        """The programmed path, mm; a column for each axis."""
    @property
    def tangent(self) -> Any:
        """Its direction of travel; a column for each axis."""
    @property
    def feed_mm_s(self) -> Any:
        """Its planned feedrate, mm/s."""
    @property
    def cutting(self) -> Any:
        """Whether it cuts."""
    @property
    def offset_mm(self) -> Any:
        """Offset of the command from the path now, mm."""
    @property
    def offset_mm_s(self) -> Any:
        """Speed of that offset, mm/s."""
    @property
    def axes(self) -> tuple[Mapping[str, float], ...]:
        """What is known of each axis: gains, inertia, friction, delays."""
    @property
    def measured(self) -> Measurement | None:
        """What is measured; none where the position was lost."""

class Episode:
    """A run that waits for its actions."""

    def __init__(self, servo_periods: int, preview: int, options: dict[str, Any]) -> None: ...
    @property
    def axes(self) -> int: ...
    def advance(
        self, action: tuple[float, Sequence[float]] | None = None
    ) -> tuple[Window | None, tuple[int, float, float], dict[str, Any] | None]: ...
    def close(self) -> None: ...

def run_with(
    controller: object, options: dict[str, Any], progress: _Told
) -> tuple[dict[str, Any], dict[str, Any] | None, CutOutcome]: ...
def held_out_program(seed: int) -> Program | None: ...
def held_out_machine(seed: int) -> Machine | None: ...
def tables_page(
    title: str, introduction: str, parts: Sequence[tuple[str, str, Sequence[str], Sequence[Sequence[str]]]]
) -> str: ...
def job_address(spec: str, folder: str | PathLike[str]) -> str: ...
def do_job(
    spec: str, folder: str | PathLike[str], out: str | PathLike[str]
) -> tuple[str | None, bool, str | None]: ...
def merge(folders: Sequence[str | PathLike[str]]) -> dict[str, Any]: ...
