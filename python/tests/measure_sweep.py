"""Measures what docs/sweeps.md says of the costs of sweeps. Nothing else should run meanwhile.

    PYTHONPATH=... python python/tests/measure_sweep.py [workers] [scheduler] [costs]

workers: wall time of one worker of Dask against two, with jobs of at least 2 s.
scheduler: tasks that do nothing, by the size of their batches.
costs: what a job costs besides its cut, and what a second of machining costs.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil
from distributed import Client

import feedwright
from feedwright import _sweep

#: Jobs of each measurement with workers.
JOBS = 12
#: Repetitions, of which the median counts.
TIMES = 3
#: Tasks without work of each measurement.
TASKS = 2000
BATCHES = (1, 10, 100, 1000)


def long_program(passes: int) -> str:
    """A square, cut again and again."""
    return "G21 G90 G64 F3000\n" + "G1 X20\nG1 Y20\nG1 X0\nG1 Y0\n" * passes + "M2\n"


def timed(work: object) -> tuple[float, float]:
    """Wall time and processor time of this process, s."""
    wall, cpu = time.monotonic(), time.process_time()
    work()  # type: ignore[operator]
    return time.monotonic() - wall, time.process_time() - cpu


@contextmanager
def cluster(workers: int) -> Iterator[tuple[Client, list[psutil.Process]]]:
    """A scheduler and workers on 127.0.0.1, each a process with one thread."""
    with tempfile.TemporaryDirectory() as place:
        file = os.path.join(place, "scheduler.json")
        options = ["--no-dashboard", "--scheduler-file", file]
        line = [sys.executable, "-m", "dask"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": place}
        scheduler = subprocess.Popen([*line, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-show", *options], **quiet)
        begun = [scheduler]
        begun += [
            subprocess.Popen([*line, "worker", "--nthreads", "1", "--no-nanny", *options], **quiet) for _ in range(workers)
        ]
        try:
            while not (os.path.exists(file) and os.path.getsize(file)):
                time.sleep(0.05)
            with Client(scheduler_file=file) as client:
                client.wait_for_workers(workers)
                yield client, [psutil.Process(process.pid) for process in begun]
        finally:
            for process in begun:
                process.kill()
                process.wait()


def cpu_s(processes: list[psutil.Process]) -> float:
    times = [process.cpu_times() for process in processes]
    return sum(spent.user + spent.system for spent in times)


def measure_workers() -> None:
    passes = 40
    while True:
        program = feedwright.Program(text=long_program(passes), name="long.ngc")
        _, took_s = timed(lambda: feedwright.run(program, "workshop", rows=False))
        if took_s >= 2.0:
            break
        passes = int(passes * 2.2 / took_s) + 1
    print(f"a job: {took_s:.2f} s of processor time")
    walls: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(TIMES):
        for workers in walls:
            with tempfile.TemporaryDirectory() as out, cluster(workers) as (client, processes):
                jobs = [feedwright.Job(program, seed=1, tolerance_um=10.0 + k) for k in range(workers)]
                # Imports, and the first use of the model.
                feedwright.sweep(jobs, out, client=client)
                before = cpu_s(processes[1:])
                jobs = [feedwright.Job(program, seed=1, feed_mm_s=40.0 + 0.1 * k) for k in range(JOBS)]
                wall, _ = timed(lambda: feedwright.sweep(jobs, out, client=client))
                walls[workers].append(wall)
                spent = (cpu_s(processes[1:]) - before) / JOBS
                print(f"{workers} workers: {wall:.2f} s for {JOBS} jobs, {spent:.2f} s of processor time each")
    one, two = (statistics.median(values) for values in walls.values())
    print(f"median: {one:.2f} s and {two:.2f} s, ratio {one / two:.2f}")


def nothing(batch: list[_sweep.Task], out: str) -> list[_sweep.Done]:
    """What a task that has nothing to do answers."""
    return [("0" * 64, True, None)] * len(batch)


def measure_scheduler() -> None:
    job = feedwright.Job("parts/star.ngc", "workshop")
    task = job._task()
    for workers in (1, 2):
        with cluster(workers) as (client, processes):
            client.run_on_scheduler(int)
            for batch in BATCHES:
                tasks = [(task[0].replace('"seed": 1', f'"seed": {k}'), task[1]) for k in range(TASKS // (1 if batch < 100 else 4) * batch)]
                pool = _sweep._Cluster(client)
                pool.work = nothing
                before = cpu_s(processes[:1])
                wall, client_s = timed(lambda: sum(1 for _ in _sweep._each(pool, _sweep._batches(iter(tasks), batch), "out")))
                count = len(tasks) // batch
                spent = (cpu_s(processes[:1]) - before) / count
                print(
                    f"{workers} workers, batches of {batch}: {count / wall:.0f} tasks/s, {len(tasks) / wall:.0f} jobs/s; "
                    f"scheduler {1e3 * spent:.2f} ms, client {1e3 * client_s / count:.2f} ms of processor time a task"
                )


def measure_costs() -> None:
    with tempfile.TemporaryDirectory() as out:
        for part in ("parts/star.ngc", "parts/pocket.ngc"):
            for controller in ("uncorrected", "lqg-identified"):
                job = feedwright.Job(part, "workshop", controller)
                spec, folder = job._task()
                feedwright.run(part, "workshop", controller=controller, rows=False)
                _, computed = timed(lambda: _sweep._do([(spec, folder)], out))
                found, _ = timed(lambda: [_sweep._do([(spec, folder)], out) for _ in range(100)])
                size = (Path(out) / job.address[:2] / f"{job.address}.json").stat().st_size
                machining_s = feedwright.merge(out)["time_s"].max()
                print(
                    f"{part}, {controller}: {computed:.3f} s of processor time, found again in {10 * found:.2f} ms, "
                    f"{size} bytes, {machining_s:.1f} s of machining"
                )
        tiny = feedwright.Program(text="G21 F3000\nG1 X1\nM2\n", name="tiny.ngc")
        jobs = [feedwright.Job(tiny, "tnv40", "uncorrected", seed=seed)._task() for seed in range(1000)]
        wall, spent = timed(lambda: _sweep._do(jobs, out))
        print(f"a job with next to no cut: {wall:.2f} ms, {spent:.2f} ms of processor time")
        wall, _ = timed(lambda: feedwright.merge(out))
        print(f"merge: {wall:.2f} ms a result")
        slower = feedwright.Machine("workshop").with_values({"axis.x.kp_1_s": 40 + time.time() % 1})
        wall, spent = timed(lambda: feedwright.run("parts/circle.ngc", slower, rows=False))
        print(f"the first job on a new machine: {wall:.1f} s, {spent:.1f} s of processor time")


if __name__ == "__main__":
    for name in sys.argv[1:] or ("workers", "scheduler", "costs"):
        print(f"--- {name}: load {os.getloadavg()[0]:.2f} before")
        {"workers": measure_workers, "scheduler": measure_scheduler, "costs": measure_costs}[name]()
