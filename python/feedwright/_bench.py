"""Held-out work for a controller: rounds, result files and their page."""

from __future__ import annotations

import hashlib
import inspect
import json
import math
import os
import platform
import secrets
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy

from . import _feedwright
from ._feedwright import Machine, Program, __version__

if TYPE_CHECKING:
    from .lab import Planner

#: The secret of the round that everyone may look at; the package has figures of other controllers for it.
PUBLIC_SECRET = "feedwright public round 1"
KNOWLEDGE = ("exact", "identified", "wrong")
FORMAT = 1


def commitment(secret: str) -> str:
    """What is published before a round: the SHA-256 of its secret, which is published after it.

    >>> commitment("feedwright public round 1")[:16]
    '8c29ce4b67cd415d'
    """
    return hashlib.sha256(secret.encode()).hexdigest()


def new_secret() -> str:
    """A secret for a round, of 256 random bits."""
    return secrets.token_hex(32)


@dataclass(frozen=True)
class Round:
    """Programs and machines that a secret draws; every program is cut on every machine, with a noise of its own."""

    secret: str = PUBLIC_SECRET
    programs: int = 4
    machines: int = 4

    def _seeds(self, what: str) -> Iterator[int]:
        for number in range(2**32):
            drawn = hashlib.sha256(f"{self.secret}/{what}/{number}".encode()).digest()
            yield int.from_bytes(drawn[:8]) >> 1

    def _drawn(self, what: str, draw: Any, count: int) -> list[Any]:
        found = filter(None, map(draw, self._seeds(what)))
        return [next(found) for _ in range(count)]

    def work(self) -> list[tuple[Program, Machine, int]]:
        """All cuts: program, machine, seed of the noise."""
        programs = self._drawn("program", _feedwright.held_out_program, self.programs)
        machines = self._drawn("machine", _feedwright.held_out_machine, self.machines)
        pairs = [(program, machine) for program in programs for machine in machines]
        return [(*pair, seed) for pair, seed in zip(pairs, self._seeds("noise"))]

    def facts(self) -> dict[str, Any]:
        """What a result file says of it."""
        return {
            "commitment": commitment(self.secret),
            "secret": self.secret,
            "programs": self.programs,
            "machines": self.machines,
        }


def _sha256(content: Any) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _name(controller: object, planner: object = None) -> str:
    """What a controller is called; with a planner both, and the planner alone where nothing is corrected."""
    called = controller if isinstance(controller, str) else getattr(controller, "name", type(controller).__name__)
    if planner is None:
        return called
    of_planner = getattr(planner, "__name__", type(planner).__name__)
    return of_planner if called == "uncorrected" else f"{called}, planned by {of_planner}"


def source_sha256(written: object) -> str | None:
    """SHA-256 of the file that a function or the class of an object stands in; none of a controller of the library, and where there is no
    file.
    """
    if isinstance(written, str):
        return None
    try:
        file = inspect.getsourcefile(written if inspect.isroutine(written) else type(written))
        return hashlib.sha256(Path(file or "").read_bytes()).hexdigest()
    except (OSError, TypeError):
        return None


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _row(cut: Any, program: Program, machine: Machine, knowledge: str, seed: int) -> dict[str, Any]:
    was, now = cut.uncorrected, cut.corrected
    names = ("time_s", "rms_um", "max_um")
    return {
        "program": program.name,
        "machine": machine.name,
        "knowledge": knowledge,
        "seed": seed,
        "completed": now["outcome"]["kind"] == "completed",
        "engaged_share": now["engaged_share"],
        **{name: _finite(now[name]) for name in names},
        **{f"uncorrected_{name}": _finite(was[name]) for name in names},
    }


def _scores(rows: Sequence[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """For each kind of knowledge: the geometric mean and the largest of the ratios of RMS errors, the mean of the ratios of
    machining times, and how many cuts did not come to their end."""
    scores = {}
    for knowledge in dict.fromkeys(row["knowledge"] for row in rows):
        mine = [row for row in rows if row["knowledge"] == knowledge]
        ended = [row for row in mine if row["completed"] and row["rms_um"] is not None and row["uncorrected_rms_um"]]
        errors = [row["rms_um"] / row["uncorrected_rms_um"] for row in ended]
        times = [row["time_s"] / row["uncorrected_time_s"] for row in ended]
        scores[knowledge] = {
            "failures": len(mine) - len(ended),
            "error_ratio": math.exp(math.fsum(math.log(max(ratio, 1e-12)) for ratio in errors) / len(errors))
            if errors
            else None,
            "worst_error_ratio": max(errors, default=None),
            "time_ratio": math.fsum(times) / len(times) if times else None,
        }
    return scores


def peers() -> list[dict[str, Any]]:
    """Results of other controllers in the public round, without their rows."""
    return json.loads(Path(__file__).with_name("_peers.json").read_text(encoding="utf-8"))


def _order(result: dict[str, Any], knowledge: str) -> tuple[int, float]:
    score = result["scores"][knowledge]
    ratio = score["error_ratio"]
    return score["failures"], math.inf if ratio is None else ratio


def _cells(result: dict[str, Any], knowledge: str) -> list[str]:
    score = result["scores"][knowledge]
    shown = (
        "-" if score[key] is None else f"{score[key]:.3f}" for key in ("error_ratio", "worst_error_ratio", "time_ratio")
    )
    return [result["controller"]["name"], *shown, str(score["failures"])]


HEADS = ["controller", "error, mean ratio", "error, worst ratio", "time ratio", "failures"]


@dataclass(frozen=True, repr=False)
class Benchmark:
    """What a controller came to in a round."""

    results: dict[str, Any]
    """What the result file has."""

    @property
    def scores(self) -> dict[str, dict[str, Any]]:
        """By kind of knowledge: `error_ratio`, `worst_error_ratio`, `time_ratio`, `failures`."""
        return self.results["scores"]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the result file."""
        Path(path).write_text(json.dumps(self.results, indent=1, allow_nan=False) + "\n", encoding="utf-8")

    def beside(self) -> list[dict[str, Any]]:
        """This result and those of other controllers that the package has of the same round."""
        return [self.results, *(peer for peer in peers() if peer["round"] == self.results["round"])]

    def __repr__(self) -> str:
        lines = []
        for knowledge in self.scores:
            there = [result for result in self.beside() if knowledge in result["scores"]]
            rows = [_cells(result, knowledge) for result in sorted(there, key=lambda result: _order(result, knowledge))]
            widths = [max(map(len, column)) for column in zip(HEADS, *rows)]
            lines += ["", f"knowledge: {knowledge}"]
            lines += [
                "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in [HEADS, *rows]
            ]
        return "\n".join(lines[1:])


def benchmark(
    controller: Any,
    *,
    round: Round | None = None,
    knowledge: Iterable[str] = KNOWLEDGE,
    settings: Callable[[Machine], Mapping[str, Any]] | None = None,
    planner: Planner | None = None,
    name: str | None = None,
) -> Benchmark:
    """Cuts the programs of a round on its machines with a controller, once for each kind of knowledge.

    Without a `round` it is the public one. A controller by its name is one of the library, and `settings` are what its
    parameters are set to on a machine; the result file has them. A planner is scored with "uncorrected" as the controller.
    """
    from .lab import run

    round = round or Round()
    work = round.work()
    set_to = {machine.name: dict(settings(machine)) for _, machine, _ in work[: round.machines]} if settings else {}
    set_there = {"settings": set_to} if settings else {}

    def row(program: Program, machine: Machine, kind: str, seed: int) -> dict[str, Any]:
        options = {"settings": set_to.get(machine.name), "planner": planner, "knowledge": kind, "seed": seed}
        return _row(run(program, machine, controller, rows=False, **options), program, machine, kind, seed)

    rows = [row(program, machine, kind, seed) for kind in knowledge for program, machine, seed in work]
    of_planner = {"planner_source_sha256": source_sha256(planner)} if planner else {}
    content = {
        "format": FORMAT,
        "versions": {"feedwright": __version__, "python": platform.python_version(), "numpy": numpy.__version__},
        "platform": f"{platform.system()} {platform.machine()}",
        "round": round.facts(),
        "controller": {
            "name": name or _name(controller, planner),
            "source_sha256": source_sha256(controller),
            **of_planner,
            **set_there,
        },
        "scores": _scores(rows),
        "rows": rows,
    }
    return Benchmark({**content, "sha256": _sha256(content)})


def _read(path: str | os.PathLike[str]) -> dict[str, Any]:
    """A result file that is what it says."""
    try:
        results = json.loads(Path(path).read_text(encoding="utf-8"))
        claimed = results.pop("sha256")
        valid = results["format"] == FORMAT and claimed == _sha256(results)
        valid = valid and results["scores"] == _scores(results["rows"])
        valid = valid and results["round"]["commitment"] == commitment(results["round"]["secret"])
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path} is no result file of format {FORMAT}: {error!r}") from error
    if not valid:
        raise ValueError(
            f"{path}: the content does not fit its checksum, scores or commitment. Take the file as it was written"
        )
    return {**results, "sha256": claimed}


def verify(path: str | os.PathLike[str], controller: Any, planner: Planner | None = None) -> list[str]:
    """Runs a result file again, and says what differs, bit by bit: an empty list where nothing does."""
    claimed = _read(path)
    facts = claimed["round"]
    round = Round(facts["secret"], facts["programs"], facts["machines"])
    set_to = claimed["controller"].get("settings")
    settings = None if set_to is None else lambda machine: set_to.get(machine.name, {})
    options = {"knowledge": list(claimed["scores"]), "settings": settings, "planner": planner}
    found = benchmark(controller, round=round, **options).results
    differences = [
        f"the source of the {what} is another one"
        for what, key in (("controller", "source_sha256"), ("planner", "planner_source_sha256"))
        if found["controller"].get(key) != claimed["controller"].get(key)
    ]
    for was, now in zip(claimed["rows"], found["rows"]):
        keys = [key for key in {**was, **now} if was.get(key) != now.get(key)]
        place = f"{now['program']} on {now['machine']}, {now['knowledge']}"
        differences += [f"{place}: {key} is {now.get(key)!r}, and the file has {was.get(key)!r}" for key in keys]
    if len(claimed["rows"]) != len(found["rows"]):
        differences.append(f"there are {len(found['rows'])} cuts, and the file has {len(claimed['rows'])}")
    return differences


def leaderboard(paths: Iterable[str | os.PathLike[str]], title: str = "Leaderboard") -> str:
    """A page of result files of one round, best first: HTML that needs no other file."""
    results = [_read(path) for path in paths]
    if not results:
        raise ValueError("a leaderboard needs at least one result file")
    round = results[0]["round"]
    if any(result["round"] != round for result in results):
        raise ValueError("the result files are of different rounds: each round has a leaderboard of its own")
    results += [peer for peer in peers() if peer["round"] == round]
    parts = []
    for knowledge in KNOWLEDGE:
        there = sorted(
            (result for result in results if knowledge in result["scores"]), key=lambda r: _order(r, knowledge)
        )
        rows = [[str(place), *_cells(result, knowledge)] for place, result in enumerate(there, 1)]
        if rows:
            parts.append((knowledge, f"Knowledge: {knowledge}", ["place", *HEADS], rows))
    files = [
        [
            result["controller"]["name"],
            result["controller"]["source_sha256"] or "-",
            result["sha256"],
            result["versions"]["feedwright"],
        ]
        for result in results
    ]
    parts.append(
        ("files", "Result files", ["controller", "SHA-256 of its source", "SHA-256 of the result", "feedwright"], files)
    )
    introduction = (
        f"{round['programs']} programs on {round['machines']} machines with noise. Ratios are to the uncorrected cut; a lower "
        f"one is better. Secret of the round: {round['secret']}. Its SHA-256, published before: {round['commitment']}."
    )
    return _feedwright.tables_page(title, introduction, parts)
