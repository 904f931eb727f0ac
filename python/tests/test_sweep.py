"""Sweeps as users have them: on processes of this machine, and on a cluster of Dask whose parts are killed."""

import contextlib
import importlib.util
import itertools
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from collections.abc import Callable, Iterator
from pathlib import Path

import feedwright
from feedwright import _sweep

CIRCLE = "G21 G17 G90 G94 G64\nG0 X0 Y0\nG2 X0 Y0 I2 J0 F1200\nM2\n"
WRONG = "G1 X1 F100\nG2 X5 Y0 R1\nM2\n"
LIST = """
programs = ["circle.ngc", "wrong.ngc"]
machines = ["tnv40", "workshop"]
controllers = ["uncorrected", "feedforward"]
"""
#: Jobs of some tenth of a second, so that a sweep can be killed in the middle.
LONG = "G21 G90 G64\nG1 X5 F240\nG1 X0\nM2\n"
LONG_JOBS = 30


class Folder:
    """A folder with a list of jobs."""

    def __init__(self, place: str) -> None:
        self.place = Path(place)
        seeds = ", ".join(map(str, range(1, LONG_JOBS + 1)))
        long = f'programs = ["long.ngc"]\ncontrollers = ["uncorrected"]\nseeds = [{seeds}]\n'
        files = {"circle.ngc": CIRCLE, "wrong.ngc": WRONG, "long.ngc": LONG, "JOBS.toml": LIST, "LONG.toml": long}
        for name, text in files.items():
            (self.place / name).write_text(text)

    def __truediv__(self, name: str) -> Path:
        return self.place / name

    def command(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        line = [sys.executable, "-m", "feedwright", *arguments]
        return subprocess.run(line, cwd=self.place, capture_output=True, text=True, check=False)


def results(folder: Path) -> dict[str, bytes]:
    """The files of a folder of results."""
    return {path.name: path.read_bytes() for path in folder.glob("*/*")}


def written(folder: Path) -> dict[str, tuple[int, int]]:
    """The results of a folder, and what changes where one is written again."""
    about = {path.name: path.stat() for path in folder.glob("*/*.json")}
    return {name: (found.st_ino, found.st_mtime_ns) for name, found in about.items()}


def until(holds: Callable[[], bool], seconds: float = 600.0) -> None:
    """Waits."""
    end = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > end:
            raise TimeoutError
        time.sleep(0.02)


def ends_its_process(batch: list[_sweep.Task], out: str) -> list[_sweep.Done]:
    """Does jobs, and ends with the process at a wrong program."""
    if any("wrong" in task[0] for task in batch):
        os.kill(os.getpid(), signal.SIGKILL)
    return _sweep._do(batch, out)


class OfFolder(unittest.TestCase):
    def setUp(self) -> None:
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = Folder(place.name)
        there = os.getcwd()
        os.chdir(place.name)
        self.addCleanup(os.chdir, there)


class Local(OfFolder):
    def test_the_results_are_those_of_the_command(self) -> None:
        ran = self.folder.command("sweep", "JOBS.toml", "--out", "command")
        self.assertEqual((ran.returncode, ran.stdout), (1, "8 jobs: 8 computed, 0 found, 4 with mistakes\n"), ran.stderr)
        by_command = results(self.folder / "command")
        swept = feedwright.sweep("JOBS.toml", "list", workers=2)
        self.assertEqual((swept.computed, swept.found, swept.mistaken), (8, 0, 4))
        self.assertEqual(results(self.folder / "list"), by_command)
        again = feedwright.sweep(self.folder / "JOBS.toml", "list", workers=1)
        self.assertEqual((again.computed, again.found, again.mistaken, len(again.errors)), (0, 8, 4, 4))
        programs = ["circle.ngc", feedwright.Program("wrong.ngc")]
        every = itertools.product(programs, ["tnv40", feedwright.Machine("workshop")], ["uncorrected", "feedforward"])
        jobs = [feedwright.Job(program, machine, controller) for program, machine, controller in every]
        feedwright.sweep(jobs, "jobs", workers=3, batch=3)
        self.assertEqual(results(self.folder / "jobs"), by_command)
        self.assertEqual({f"{job.address}.json" for job in jobs}, set(by_command))
        table = feedwright.merge("list", "jobs")
        self.assertEqual(self.folder.command("merge", "list", "--out", "table.csv").returncode, 0)
        names = (self.folder / "table.csv").read_text().splitlines()[0].split(",")
        self.assertEqual((list(table), len(table["rms_um"])), (names, 8))
        self.assertEqual(sum(error is not None for error in table["error"]), 4)

    def test_a_table_is_written_as_parquet(self) -> None:
        from pyarrow import parquet

        feedwright.sweep([feedwright.Job("circle.ngc", "tnv40"), feedwright.Job("wrong.ngc", "tnv40")], "out", workers=1)
        table = feedwright.merge("out")
        table.to_parquet("table.parquet")
        read = parquet.read_table("table.parquet")
        self.assertEqual((read.column_names, read.column("within_tolerance").to_pylist()), (list(table), [True, None]))

    def test_jobs_are_taken_as_they_are_needed(self) -> None:
        taken, done = 0, 0

        class Enough(Exception):
            pass

        def jobs() -> Iterator[feedwright.Job]:
            nonlocal taken
            for seed in range(1_000_000):
                taken += 1
                yield feedwright.Job("circle.ngc", "tnv40", controller="uncorrected", seed=seed)

        def told(stage: str, of: int, all: int) -> None:
            nonlocal done
            self.assertLessEqual(taken - of, 2 * _sweep.UNDER_WAY)
            done = of
            if done == 20:
                raise Enough

        with self.assertRaises(Enough):
            feedwright.sweep(jobs(), "out", workers=2, progress=told)
        self.assertGreaterEqual(len(written(self.folder / "out")), 20)

    def test_a_process_that_is_killed_costs_its_job_alone(self) -> None:
        kept: dict[str, tuple[int, int]] = {}

        def told(stage: str, done: int, jobs: int) -> None:
            if done == 8 and not kept:
                kept.update(written(self.folder / "out"))
                os.kill(multiprocessing.active_children()[0].pid or 0, signal.SIGKILL)

        swept = feedwright.sweep("LONG.toml", "out", workers=2, progress=told)
        self.assertGreaterEqual(len(kept), 8)
        self.assertEqual(swept.computed + swept.found, LONG_JOBS)
        self.assertLessEqual(swept.found, 2 * _sweep.UNDER_WAY)
        now = written(self.folder / "out")
        self.assertEqual((len(now), {name: now[name] for name in kept}), (LONG_JOBS, kept))

    def test_a_job_that_ends_its_process_each_time_stops_no_other(self) -> None:
        tasks, _ = _sweep._tasks("JOBS.toml")
        pool = _sweep._Processes(2)
        pool.work = ends_its_process
        done = list(_sweep._each(pool, _sweep._batches(tasks, 1), os.path.abspath("out")))
        pool.close()
        lost = [error for address, _, error in done if address is None]
        self.assertEqual((len(done), len(lost), len(written(self.folder / "out"))), (8, 4, 4), done)
        self.assertTrue(all("wrong.ngc on" in (error or "") for error in lost))

    def test_a_full_disk_ends_the_sweep_and_leaves_nothing_half_written(self) -> None:
        os.mkdir("small")
        sweep = "import feedwright\nif __name__ == '__main__': feedwright.sweep('JOBS.toml', 'small/out', workers=2)\n"
        (self.folder / "sweep.py").write_text(sweep)
        script = "mount -t tmpfs -o size=40k none small || exit 77; $0 sweep.py; cp -r small/out kept; ls -A small/out/*"
        line = ["unshare", "--map-root-user", "--mount", "sh", "-c", script, sys.executable]
        try:
            ran = subprocess.run(line, capture_output=True, text=True, check=False)
        except FileNotFoundError:
            self.skipTest("there is no unshare")
        if ran.returncode == 77 or "unshare failed" in ran.stderr:
            self.skipTest("there are no name spaces")
        self.assertIn("No space left on device", ran.stderr)
        self.assertNotIn(".part", ran.stdout)
        kept = feedwright.merge("kept")
        self.assertTrue(1 <= len(kept["address"]) < 8, ran.stderr)

    def test_what_has_no_result_is_said_at_the_end(self) -> None:
        jobs = [feedwright.Job(name, "tnv40", controller="uncorrected") for name in ("none.ngc", "circle.ngc")]
        with self.assertRaises(feedwright.SweepError) as caught:
            feedwright.sweep(jobs, "out", workers=1)
        self.assertIn("none.ngc: cannot be read", str(caught.exception))
        self.assertEqual((caught.exception.swept.computed, caught.exception.swept.missing), (1, 1))


@unittest.skipUnless(importlib.util.find_spec("distributed"), "there is no distributed")
class Cluster(OfFolder):
    """Scheduler, workers and client are processes, which are killed one after the other."""

    def begin(self, *line: str) -> subprocess.Popen[bytes]:
        environment = {**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "5s"}
        process = subprocess.Popen(
            [sys.executable, *line], env=environment, stdout=subprocess.DEVNULL, stderr=self.log, cwd=self.folder.place
        )
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def scheduler(self) -> subprocess.Popen[bytes]:
        with contextlib.suppress(FileNotFoundError):
            os.remove("scheduler.json")
        line = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show", "--scheduler-file", "scheduler.json")
        scheduler = self.begin("-m", "dask", "scheduler", *line)
        until(lambda: os.path.exists("scheduler.json") and os.path.getsize("scheduler.json") > 0)
        return scheduler

    def worker(self) -> subprocess.Popen[bytes]:
        options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--scheduler-file", "scheduler.json")
        return self.begin("-m", "dask", "worker", *options)

    def client(self, out: str = "out", options: str = "") -> subprocess.Popen[bytes]:
        text = (
            "import feedwright, distributed\n"
            "client = distributed.Client(scheduler_file='scheduler.json')\n"
            f"swept = feedwright.sweep('LONG.toml', '{out}', client=client{options})\n"
            "open('swept.txt', 'w').write(f'{swept.computed} {swept.found}')\n"
        )
        return self.begin("-c", text)

    def setUp(self) -> None:
        super().setUp()
        self.log = open(self.folder / "log.txt", "wb")
        self.addCleanup(self.log.close)

    def test_what_was_written_is_computed_once_whoever_is_killed(self) -> None:
        out = self.folder / "out"
        seen: dict[str, tuple[int, int]] = {}

        def reach(count: int) -> None:
            """Waits for so many results; those that were seen before are still the same files."""
            until(lambda: len(written(out)) >= count)
            now = written(out)
            self.assertEqual({name: now[name] for name in seen}, seen)
            seen.update(now)

        scheduler, workers, client = self.scheduler(), [self.worker(), self.worker()], self.client()
        reach(4)
        workers[0].kill()
        workers.append(self.worker())
        reach(9)
        client.kill()
        client.wait()
        client = self.client()
        reach(15)
        self.assertIsNone(client.poll())
        scheduler.kill()
        client.wait(timeout=600)
        self.assertNotEqual(client.returncode, 0)
        self.log.flush()
        self.assertIn(b"the scheduler of the cluster is gone", (self.folder / "log.txt").read_bytes())
        for worker in workers:
            worker.kill()
            worker.wait()
        reach(15)
        self.assertLess(len(seen), LONG_JOBS)
        self.scheduler()
        workers = [self.worker(), self.worker(), self.worker()]
        self.assertEqual(self.client().wait(timeout=600), 0)
        told = (self.folder / "swept.txt").read_text()
        self.assertEqual(told, f"{LONG_JOBS - len(seen)} {len(seen)}")
        reach(LONG_JOBS)
        self.folder.command("sweep", "LONG.toml", "--out", "command")
        self.assertEqual(results(self.folder / "command"), {name: text for name, text in results(out).items() if name[0] != "."})
        self.assertEqual(self.client("batches", ", batch=4").wait(timeout=600), 0)
        self.assertEqual(results(self.folder / "batches"), results(self.folder / "command"))


if __name__ == "__main__":
    unittest.main()
