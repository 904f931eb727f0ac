"""Many jobs, on this machine or on a cluster of Dask. A result that is written is not computed again."""

from __future__ import annotations

import hashlib
import json
import os
import queue
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import dataclass, field, fields
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _feedwright
from ._feedwright import Machine, Program
from ._jobs import path_or_none, request
from ._progress import Progress, told
from ._table import Table

if TYPE_CHECKING:
    from distributed import Client

#: Batches under way for each process or thread: one that is worked on, and one that waits.
UNDER_WAY = 2
#: Jobs with mistakes, and jobs without a result, that are named; the results have all.
NAMED = 100
#: Time after which the threads of a cluster are counted again, s.
COUNTED_EACH_S = 2.0

#: A job as JSON, and the folder of its paths.
Task = tuple[str, str]
#: Address, whether the result was there, and the error that it is. No address where there is no result.
Done = tuple[str | None, bool, str | None]


@dataclass(frozen=True)
class Job:
    """A job of a sweep: what `run` is asked for. Keys and defaults are those of JOBS.toml.

    >>> job = Job(Program(text="G1 X1 F600\\nM2\\n", name="line.ngc"), "tnv40", controller="uncorrected")
    >>> len(job.address), job.address == Job(job.program, "tnv40", controller="uncorrected", seed=2).address
    (64, False)
    """

    program: Program | str | os.PathLike[str]
    machine: Machine | str | os.PathLike[str] = "workshop"
    controller: str | None = None
    against: str = "uncorrected"
    tolerance_um: float | None = None
    feed_mm_s: float | None = None
    settings: Mapping[str, Any] | None = None
    model: str | os.PathLike[str] | None = None
    exact_settings: bool = False
    seed: int = 1
    band: int = 0
    fastest: bool = False

    def _task(self) -> Task:
        keys = {field.name: getattr(self, field.name) for field in fields(self)}
        keys["settings"] = dict(self.settings or {})
        keys["model"] = path_or_none(self.model)
        return request(keys.pop("program"), keys.pop("machine"), **keys), os.getcwd()

    @property
    def address(self) -> str:
        """The name of its result: a hash of everything that the result follows from."""
        return _feedwright.job_address(*self._task())


@dataclass
class Swept:
    """What a sweep came to."""

    computed: int = 0
    """Results that were computed."""
    found: int = 0
    """Results that were there."""
    mistaken: int = 0
    """Jobs whose result is an error, such as a program with mistakes."""
    missing: int = 0
    """Jobs without a result."""
    errors: list[str] = field(default_factory=list)
    """The first errors and reasons."""

    def _add(self, done: Done) -> None:
        address, found, error = done
        if address is None:
            self.missing += 1
        elif found:
            self.found += 1
        else:
            self.computed += 1
        if error is not None:
            self.mistaken += address is not None
            self.errors = [*self.errors, error][:NAMED]


class SweepError(RuntimeError):
    """Some jobs have no result. `swept` has what the sweep came to."""

    def __init__(self, swept: Swept) -> None:
        super().__init__(f"{swept.missing} jobs have no result; the first: {swept.errors[0] if swept.errors else ''}")
        self.swept = swept


def sweep(
    jobs: Iterable[Job] | str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    client: Client | None = None,
    workers: int | None = None,
    batch: int = 1,
    progress: Progress = None,
) -> Swept:
    """Does all jobs whose results are not in the folder `out` yet: the command `feedwright sweep`.

    `jobs` are jobs, or the path of a JOBS.toml. They are done by `workers` processes on this machine, as many as it has cores by
    default, or by the threads of the cluster that `client` is connected to. Then `out` is a folder that all its computers share.
    Jobs are taken from `jobs` as they are needed, so that an iterator may have millions. A task has `batch` jobs.

    A process that is killed is replaced, and its jobs are done again. Where a job ends its process each time, or a file cannot be
    read, the others are done, and SweepError tells at the end.
    """
    folder = os.path.abspath(out)
    os.makedirs(folder, exist_ok=True)
    tasks, total = _tasks(jobs)
    swept = Swept()
    pool: _Processes | _Cluster = _Processes(workers) if client is None else _Cluster(client)
    with told(progress) as tell, closing(pool):
        for done in _each(pool, _batches(tasks, batch), folder):
            swept._add(done)
            if tell is not None:
                tell("jobs", swept.computed + swept.found + swept.missing, total)
    if swept.missing:
        raise SweepError(swept)
    return swept


def merge(*folders: str | os.PathLike[str]) -> Table:
    """The results in folders as a table, one row for each job: the command `feedwright merge`.

    Numbers that are missing are NaN; what is missing among texts is None.
    """
    import numpy

    columns = _feedwright.merge(folders)
    return Table({name: numpy.asarray(column, None if hasattr(column, "dtype") else object) for name, column in columns.items()})


def _tasks(jobs: Iterable[Job] | str | os.PathLike[str]) -> tuple[Iterator[Task], int]:
    """The tasks, and how many there are, 0 where that is not known."""
    if isinstance(jobs, (str, os.PathLike)):
        listed = _feedwright.JobList(jobs)
        folder = os.path.dirname(os.path.abspath(jobs))
        return ((listed[number], folder) for number in range(len(listed))), len(listed)
    return (job._task() for job in jobs), len(jobs) if isinstance(jobs, Sequence) else 0


def _batches(tasks: Iterator[Task], size: int) -> Iterator[list[Task]]:
    batch: list[Task] = []
    for task in tasks:
        batch.append(task)
        if len(batch) == size:
            yield batch
            batch = []
    if batch:
        yield batch


def _each(pool: _Processes | _Cluster, batches: Iterator[list[Task]], out: str) -> Iterator[Done]:
    """What comes of each task. No more batches are taken than the pool has places for."""
    more = True
    while True:
        while more and pool.places() > 0:
            batch = next(batches, None)
            if batch is None:
                more = False
            else:
                pool.submit(batch, out)
        if not more and pool.is_idle():
            return
        yield from pool.next(out)


def _do(batch: list[Task], out: str) -> list[Done]:
    """Does the jobs of a batch, in a process or on a worker."""
    return [_feedwright.do_job(spec, folder, out) for spec, folder in batch]


def _lost(batch: list[Task]) -> list[Done]:
    """What comes of jobs that ended their process."""

    def name(task: Task) -> str:
        keys = json.loads(task[0])
        return f"{keys['program']} on {keys['machine']}: the process that did this job ended"

    return [(None, False, name(task)) for task in batch]


class _Processes:
    """Processes on this machine."""

    def __init__(self, workers: int | None) -> None:
        of_machine = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
        self._workers = workers or of_machine or 1
        #: What is done with a batch.
        self.work = _do
        self._pool = self._begun()
        self._running: dict[Future[list[Done]], list[Task]] = {}
        #: Batches that were under way when a process ended: each is tried again alone, to see which ends its process.
        self._suspects: deque[list[Task]] = deque()

    def _begun(self) -> ProcessPoolExecutor:
        # Threads of this process, such as those of Arrow, do not survive a fork.
        return ProcessPoolExecutor(self._workers, mp_context=get_context("spawn"))

    def places(self) -> int:
        return 0 if self._suspects else UNDER_WAY * self._workers - len(self._running)

    def is_idle(self) -> bool:
        return not self._running and not self._suspects

    def submit(self, batch: list[Task], out: str) -> None:
        try:
            self._running[self._pool.submit(self.work, batch, out)] = batch
        except BrokenProcessPool:
            self._suspects.append(batch)

    def next(self, out: str) -> list[Done]:
        alone = not self._running
        if alone:
            self._pool = self._pool if self._is_whole() else self._begun()
            self.submit(self._suspects.popleft(), out)
        finished, _ = wait(self._running, return_when=FIRST_COMPLETED)
        done: list[Done] = []
        for future in finished:
            batch = self._running.pop(future)
            try:
                done += future.result()
            except BrokenProcessPool:
                if alone:
                    done += _lost(batch)
                else:
                    self._suspects.append(batch)
        return done

    def _is_whole(self) -> bool:
        try:
            self._pool.submit(int).result()
        except BrokenProcessPool:
            return False
        return True

    def close(self) -> None:
        self._pool.shutdown(wait=True, cancel_futures=True)


class _Cluster:
    """The workers of a cluster of Dask."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._running: dict[str, tuple[Any, list[Task]]] = {}
        self._done: queue.Queue[Any] = queue.Queue()
        self._threads, self._counted_s = 0, 0.0
        #: What is done with a batch.
        self.work = _do

    def places(self) -> int:
        if time.monotonic() - self._counted_s > COUNTED_EACH_S:
            self._threads = sum(self._asked(self._client.nthreads).values())
            self._counted_s = time.monotonic()
        return UNDER_WAY * max(1, self._threads) - len(self._running)

    def is_idle(self) -> bool:
        return not self._running

    def submit(self, batch: list[Task], out: str) -> None:
        text = json.dumps([batch, out])
        digits = hashlib.blake2s(text.encode()).hexdigest()
        part = Path(json.loads(batch[0][0])["program"]).stem
        keys = (f"cut-{part}-{digits[:length]}" for length in (8, len(digits)))
        key = next((key for key in keys if key not in self._running), None)
        if key is None:
            # The same batch is under way: what is listed twice is done once.
            return
        future = self._client.submit(self.work, batch, out, key=key)
        self._running[key] = future, batch
        future.add_done_callback(self._done.put)

    def next(self, out: str) -> list[Done]:
        while True:
            try:
                future = self._done.get(timeout=1.0)
                break
            except queue.Empty:
                if self._client.status != "running":
                    raise self._gone() from None
        _, batch = self._running.pop(future.key)
        if future.status == "finished":
            return self._asked(future.result)
        if future.status != "error":
            raise self._gone()
        from distributed import KilledWorker

        error = future.exception()
        if isinstance(error, KilledWorker):
            return _lost(batch)
        raise error

    def _asked(self, ask: Callable[[], Any]) -> Any:
        """What the scheduler answers."""
        from distributed.comm import CommClosedError

        try:
            return ask()
        except CommClosedError:
            raise self._gone() from None

    def _gone(self) -> ConnectionError:
        return ConnectionError("the scheduler of the cluster is gone; what is written stays, and another sweep goes on from it")

    def close(self) -> None:
        if self._running and self._client.status == "running":
            self._client.cancel([future for future, _ in self._running.values()])
