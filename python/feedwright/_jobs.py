"""The jobs of the command `feedwright`, as functions and results."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from . import _feedwright
from ._feedwright import Machine, Motion, Program
from ._picture import svg
from ._progress import Progress, told
from ._table import Table

#: A program, or the path of one.
ProgramOrPath = Program | str | os.PathLike[str]
#: A machine, the name of one that is built in, or the path of a machine file.
MachineOrPath = Machine | str | os.PathLike[str]


def _program(program: ProgramOrPath) -> Program:
    return program if isinstance(program, Program) else Program(program)


def _machine(machine: MachineOrPath) -> Machine:
    return machine if isinstance(machine, Machine) else Machine(machine)


def _paths(paths: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]) -> list[str | os.PathLike[str]]:
    return [paths] if isinstance(paths, str | os.PathLike) else list(paths)


def machines() -> list[str]:
    """Names of the machines that are built in.

    >>> "workshop" in machines()
    True
    """
    return _feedwright.lists()["machines"]


def controllers() -> list[str]:
    """Names of the controllers; the command `feedwright controllers NAME` explains one."""
    return _feedwright.lists()["controllers"]


def controls() -> list[str]:
    """Names of the controls that a corrected program can be for.

    >>> controls()[0]
    'generic'
    """
    return _feedwright.lists()["targets"]


@dataclass(frozen=True, repr=False)
class Cut:
    """A program as a machine cuts it, without a correction and with a controller."""

    results: dict[str, Any]
    """All figures, as `feedwright run --json` writes them."""
    rows: Table
    """Servo period by servo period of the corrected cut; no columns where `rows=False` was asked for."""
    _outcome: Any

    def _run_of(self, controller: str) -> dict[str, Any]:
        return next(run for run in self.results["runs"] if run["controller"] == controller)

    @property
    def uncorrected(self) -> dict[str, Any]:
        """Figures of the cut that is compared against."""
        return self._run_of(self.results["settings"]["Compared against"])

    @property
    def corrected(self) -> dict[str, Any]:
        """Figures of the cut with the controller that was asked for."""
        return self._run_of(self.results["assumed"]["controller"])

    @property
    def within_tolerance(self) -> bool:
        """Whether the cut came to its end and held the tolerance, where one was asked for."""
        return self.results["within_tolerance"]

    def report(self) -> bytes:
        """The report, one page of HTML that needs no other file."""
        return bytes(self._outcome.html())

    def save_report(self, path: str | os.PathLike[str]) -> None:
        """Writes the report into a file."""
        Path(path).write_bytes(self.report())

    def __repr__(self) -> str:
        was, now = self.uncorrected, self.corrected
        return (
            f"<feedwright.Cut of {self.results['part']}: RMS {was['rms_um']:.2f} um {was['controller']}, "
            f"{now['rms_um']:.2f} um {now['controller']}>"
        )

    def _repr_html_(self) -> str:
        def row(run: Mapping[str, Any]) -> str:
            figures = (f"{run[key]:.{digits}f}" for key, digits in (("time_s", 3), ("rms_um", 2), ("max_um", 2)))
            return f"<tr><td>{escape(run['controller'])}</td><td>{'</td><td>'.join(figures)}</td></tr>"

        head = "<tr><th></th><th>time s</th><th>RMS um</th><th>max um</th></tr>"
        table = f"<table>{head}{''.join(map(row, self.results['runs']))}</table>"
        return (svg(self.rows) if len(self.rows) else "") + table


def request(program: ProgramOrPath, machine: MachineOrPath, **keys: Any) -> str:
    """A request as JSON: the program, the machine, and the keys that are not None."""
    asked: dict[str, Any] = json.loads(_program(program)._job())
    if isinstance(machine, Machine):
        asked["machine"], asked["machine_text"] = machine._job()
    else:
        asked["machine"] = os.fspath(machine)
    asked.update((key, value) for key, value in keys.items() if value is not None)
    return json.dumps(asked)


def path_or_none(path: str | os.PathLike[str] | None) -> str | None:
    return None if path is None else os.fspath(path)


def words_of(settings: Mapping[str, Any] | None) -> dict[str, str]:
    """Settings with their values as `--set` has them."""
    return {name: f"{value}" for name, value in (settings or {}).items()}


def made_of(results: dict[str, Any], columns: dict[str, Any] | None, outcome: Any) -> Cut:
    """A cut of what the module returns."""
    return Cut(results, Table(columns or {}), outcome)


def run(
    program: ProgramOrPath,
    machine: MachineOrPath = "workshop",
    *,
    controller: str | None = None,
    against: str = "uncorrected",
    tolerance_um: float | None = None,
    feed_mm_s: float | None = None,
    settings: Mapping[str, Any] | None = None,
    model: str | os.PathLike[str] | None = None,
    exact_settings: bool = False,
    log: str | os.PathLike[str] | None = None,
    seed: int = 1,
    rows: bool = True,
    band: int = 0,
    progress: Progress = None,
) -> Cut:
    """Cuts a program without a correction and with a controller, in a simulation: the command `feedwright run`.

    `controller` is by default one that identifies the machine from its log first; `exact_settings` gives it the settings
    of the drives from the machine file instead, and `model` a file that `feedwright identify` wrote. `settings` are those
    of `--set`. `log` is a log of the same cut on a real machine, which is compared. Without `rows` the cut keeps no rows.
    With a `band` of 8, as in the command, eight more machines that fit the same log cut the program too, and
    `results["band"]` has the spread of their errors.

    `progress` is True for a bar of tqdm, or a function that is called with the stage, the steps done and all steps.

    Raises FeedwrightError for a program or a machine file with mistakes; Ctrl-C ends the work.

    >>> cut = run(Program(text="G21 F3000\\nG1 X20\\nG1 Y20\\nM2\\n"), "tnv40", controller="uncorrected")
    >>> cut.corrected["max_um"] > 1.0
    True
    """
    asked = request(
        program,
        _machine(machine),
        controller=controller,
        against=against,
        tolerance_um=tolerance_um,
        feed_mm_s=feed_mm_s,
        seed=seed,
        settings=words_of(settings),
        model=path_or_none(model),
        exact_settings=exact_settings,
        logs=None if log is None else [os.fspath(log)],
        band=band,
    )
    with told(progress) as tell:
        return made_of(*_feedwright.run(asked, rows, tell))


@dataclass(frozen=True, repr=False)
class Corrected:
    """A corrected program for a control without feedback, or why there is none."""

    results: dict[str, Any]
    """All figures, as `feedwright correct --json` writes them."""
    program: str | None
    """The text of the corrected program, where it is better than the original."""

    @property
    def refusal(self) -> str | None:
        """Why there is no corrected program."""
        return self.results["refusal"]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the corrected program into a file."""
        if self.program is None:
            raise ValueError(f"there is no corrected program: {self.refusal}")
        Path(path).write_text(self.program, encoding="utf-8")

    def __repr__(self) -> str:
        was, now = self.results["uncorrected"]["rms_um"], self.results["as_exported"]["rms_um"]
        told = f"RMS {was:.2f} um before, {now:.2f} um now" if self.program else self.refusal
        return f"<feedwright.Corrected for {self.results['control']}: {told}>"


def correct(
    program: ProgramOrPath,
    machine: MachineOrPath,
    *,
    control: str = "generic",
    logs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    columns: str | None = None,
    file_error: float | None = None,
    progress: Progress = None,
) -> Corrected:
    """Writes a corrected program for a control without feedback: the command `feedwright correct`.

    `logs` are logs of cuts of this part, from which the program is corrected further. `file_error` is the standard
    deviation of the values in the machine file, percent.

    >>> corrected = correct(Program(text="G21 G64 F3000\\nG2 X0 Y0 I10 J0\\nM2\\n"), "tnv40")
    >>> corrected.results["as_exported"]["rms_um"] < 0.1 * corrected.results["uncorrected"]["rms_um"]
    True
    >>> "M2" in corrected.program
    True
    """
    asked = request(
        program,
        _machine(machine),
        target=control,
        logs=[os.fspath(log) for log in _paths(logs)],
        columns=columns,
        file_error=file_error,
    )
    with told(progress) as tell:
        return Corrected(*_feedwright.correct(asked, tell))


@dataclass(frozen=True, repr=False)
class Advice:
    """The feedrates at which a tolerance is held."""

    results: dict[str, Any]
    """All figures, as `feedwright advise --json` writes them."""

    @property
    def holds(self) -> bool:
        """Whether any way of cutting holds the tolerance."""
        return self.results["holds"]

    def __repr__(self) -> str:
        told = "is held" if self.holds else "is not held at any feedrate"
        return f"<feedwright.Advice: {self.results['tolerance_um']} um {told}>"


def advise(
    program: ProgramOrPath,
    machine: MachineOrPath,
    tolerance_um: float,
    *,
    control: str = "generic",
    controller: str | None = None,
    file_error: float | None = None,
    progress: Progress = None,
) -> Advice:
    """Finds the feedrates at which a tolerance is held: the command `feedwright advise`."""
    asked = request(
        program,
        _machine(machine),
        tolerance_um=tolerance_um,
        target=control,
        controller=controller,
        file_error=file_error,
        seed=0,
    )
    with told(progress) as tell:
        return Advice(_feedwright.advise(asked, tell))


@dataclass(frozen=True, repr=False)
class CycleTime:
    """What a program takes."""

    results: dict[str, Any]
    """All figures, as `feedwright plan --json` writes them."""
    lines: Table
    """`line`, `time_s` and `waiting_s` of every line that takes time."""

    @property
    def time_s(self) -> float:
        """The cycle time, s."""
        return self.results["time_s"]

    def __repr__(self) -> str:
        return f"<feedwright.CycleTime {self.time_s:.3f} s, planned by {self.results['planner']}>"


def plan(
    program: ProgramOrPath,
    machine: MachineOrPath = "workshop",
    *,
    control: str | None = None,
    progress: Progress = None,
) -> CycleTime:
    """Plans a program and tells what it takes: the command `feedwright plan`.

    `control` plans as that control does; without, the planner suits the machine.

    >>> found = plan(Program(text="G21 F600\\nG1 X10\\nG4 P0.5\\nM2\\n"), "tnv40")
    >>> found.time_s > 1.5 and abs(float(found.lines["time_s"].sum()) - found.time_s) < 1e-9
    True
    """
    with told(progress) as tell:
        results, lines = _feedwright.plan(_program(program), _machine(machine), control, tell)
    return CycleTime(results, Table(lines))


@dataclass(frozen=True)
class Check:
    """The mistakes and warnings of a program, and what it amounts to."""

    findings: list[dict[str, Any]]
    """Each with severity, code, line, column, length, message and hint."""
    amounts_to: dict[str, Any]
    """Lines, motions, `feed_mm`, `rapid_mm`, `box_mm` and dialect; empty where the program has mistakes."""

    @property
    def ok(self) -> bool:
        """Whether there are at most warnings."""
        return all(finding["severity"] != "error" for finding in self.findings)


def check(program: ProgramOrPath) -> Check:
    """Finds every mistake of a program: the command `feedwright check`.

    >>> found = check(Program(text="G1 X1 F100\\nG2 X5 Y0 R1\\nM2\\n"))
    >>> found.ok, found.findings[0]["line"], found.findings[0]["code"]
    (False, 2, 'gcode::arc_radius')
    """
    answer = _feedwright.check(_program(program))
    return Check(answer.pop("findings"), answer)


def motions(program: ProgramOrPath) -> Iterator[Motion]:
    """The motions of a program in its order, with modes, units, offsets and expressions resolved.

    >>> [(m.line, m.shape, m.end_mm) for m in motions(Program(text="G20 G1 X1 F10\\nG91 Y1\\nM2\\n"))]
    [(1, 'line', (25.4, 0.0, 0.0)), (2, 'line', (25.4, 25.4, 0.0))]
    """
    return iter(_feedwright.Motions(_program(program)))


@dataclass(frozen=True, repr=False)
class Identified:
    """A machine by its log."""

    machine: Machine
    """The machine; `machine.text` is its file."""
    results: dict[str, Any]
    """All figures, as `feedwright identify --json` writes them."""
    _identified: Any

    def report(self) -> bytes:
        """The page of the identification, which needs no other file."""
        return bytes(self._identified.html())

    def __repr__(self) -> str:
        return f"<feedwright.Identified {self.machine.name}>"


def identify(
    logs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    columns: str | None = None,
    name: str = "identified",
    progress: Progress = None,
) -> Identified:
    """Identifies a machine from logs of its motion: the command `feedwright identify`."""
    with told(progress) as tell:
        results, machine, identified = _feedwright.identify(_paths(logs), columns, name, tell)
    return Identified(machine, results, identified)
