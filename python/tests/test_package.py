"""The package as users have it: `python -m unittest`, with the package on the path."""

import doctest
import importlib
import importlib.util
import json
import os
import pkgutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy

import feedwright

PARTS = Path(os.environ["FEEDWRIGHT_PARTS"])
STAR = PARTS / "star.ngc"
DOCS = Path(os.environ["FEEDWRIGHT_DOCS"])


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    """What the command in the package says."""
    line = [sys.executable, "-m", "feedwright", *map(str, arguments)]
    return subprocess.run(line, capture_output=True, text=True, check=False)


def without_times(value: object) -> object:
    """Results without what the clock says of the ticks."""
    if isinstance(value, dict):
        return {key: without_times(part) for key, part in value.items() if not key.startswith("tick")}
    return [without_times(part) for part in value] if isinstance(value, list) else value


def load_tests(loader: unittest.TestLoader, tests: unittest.TestSuite, pattern: str | None) -> unittest.TestSuite:
    """The examples in the documentation are tests, too."""
    for module in pkgutil.iter_modules(feedwright.__path__, "feedwright."):
        if module.name not in ("feedwright.__main__", "feedwright._feedwright"):
            tests.addTests(doctest.DocTestSuite(importlib.import_module(module.name)))
    tests.addTests(doctest.DocTestSuite(feedwright))
    for page in ("python.md", "sweeps.md"):
        tests.addTests(doctest.DocFileSuite(str(DOCS / page), module_relative=False))
    return tests


class Results(unittest.TestCase):
    def test_a_cut_has_the_figures_and_rows_of_the_command(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            files = {name: Path(folder, name) for name in ("star.json", "star.csv", "star.html")}
            options = ("--json", files["star.json"], "--trace", files["star.csv"], "--report", files["star.html"])
            ran = command("run", STAR, *options)
            self.assertEqual(ran.returncode, 0, ran.stderr)
            told = json.loads(files["star.json"].read_text())
            with open(files["star.csv"]) as trace:
                names = next(line for line in trace if not line.startswith("#")).strip().split(",")
            trace = numpy.genfromtxt(files["star.csv"], delimiter=",", names=True, comments="#")
        cut = feedwright.run(STAR, band=8)
        self.assertEqual(without_times(cut.results), without_times(told))
        self.assertEqual(len(cut.rows["t_s"]), len(trace))
        shared = [name for name in names if name in cut.rows]
        self.assertGreater(len(shared), 8, names)
        for name in shared:
            numpy.testing.assert_allclose(cut.rows[name], trace[name], rtol=1e-5, atol=1e-6, err_msg=name)
        cutting = cut.rows["contour_error_um"][cut.rows["cutting"]]
        self.assertAlmostEqual(abs(cutting).max(), cut.corrected["max_um"], places=6)
        self.assertIn(b"<!doctype html>", cut.report()[:100])
        self.assertIn("<svg", cut._repr_html_())

    def test_a_corrected_program_is_that_of_the_command(self) -> None:
        part = PARTS / "circle.ngc"
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder, "out.ngc")
            ran = command("correct", part, "--machine", "tnv40", "--out", out)
            self.assertEqual(ran.returncode, 0, ran.stderr)
            told = out.read_text()
        self.assertEqual(feedwright.correct(part, "tnv40").program, told)

    def test_machines_have_the_keys_of_their_files(self) -> None:
        machine = feedwright.Machine("workshop")
        other = machine.with_values({"axis.x.kp_1_s": 40, "name": "mine"})
        self.assertEqual(other.values["axis"]["x"]["kp_1_s"], 40.0)
        self.assertEqual((other.name, machine.name), ("mine", "workshop"))
        again = feedwright.Machine(text=other.text)
        self.assertEqual(again.values, other.values)

    def test_rows_are_taken_over_without_a_copy(self) -> None:
        try:
            import pyarrow
        except ImportError:
            self.skipTest("pyarrow is not installed")
        rows = feedwright.run(STAR, "tnv40", controller="uncorrected").rows
        table = pyarrow.table(rows)
        self.assertEqual(table.column_names, list(rows))
        for name in ("t_s", "line", "act_x_mm"):
            address = table.column(name).chunk(0).buffers()[1].address
            self.assertEqual(address, rows[name].ctypes.data, name)


class Mistakes(unittest.TestCase):
    def test_a_mistake_has_its_line_and_column(self) -> None:
        with self.assertRaises(feedwright.FeedwrightError) as caught:
            feedwright.run(feedwright.Program(text="G1 X1 F100\nG2 X5 Y0 R1\nG1 Q\nM2\n"))
        error = caught.exception
        self.assertEqual((error.line, error.column, error.code), (2, 10, "gcode::arc_radius"))
        self.assertEqual([finding["line"] for finding in error.findings], [2, 3])

    def test_a_machine_file_is_told_of_by_line_and_column(self) -> None:
        with self.assertRaises(feedwright.FeedwrightError) as caught:
            feedwright.Machine(text='base = "tnv40"\n[limits]\nmax_feed_mm_s = -3\n', name="mine.toml")
        error = caught.exception
        self.assertEqual((error.file, error.line, error.column), ("mine.toml", 3, 17))
        self.assertIn("sign", error.hint)
        with self.assertRaises(feedwright.FeedwrightError):
            feedwright.Machine("tnv40").with_values({"limits.max_feed_mm_s.deep": 1})
        with self.assertRaises(feedwright.FeedwrightError):
            feedwright.Machine("tnv40").with_values({"": 1})

    def test_what_is_not_there_is_said(self) -> None:
        for wrong in (
            lambda: feedwright.run("nowhere.ngc"),
            lambda: feedwright.run(STAR, "nobody"),
            lambda: feedwright.run(STAR, controller="nobody"),
            lambda: feedwright.run(STAR, tolerance_um=-1),
            lambda: feedwright.run(STAR, settings={"nothing": 1}),
            lambda: feedwright.correct(STAR, "tnv40", control="nobody"),
            lambda: feedwright.advise(STAR, "tnv40", float("nan")),
            lambda: feedwright.identify(STAR),
            lambda: feedwright.identify([]),
            lambda: feedwright.Program(),
            lambda: feedwright.Program("a", text="b"),
            lambda: feedwright.Program("a", dialect="nobody's"),
        ):
            with self.assertRaises(feedwright.FeedwrightError) as caught:
                wrong()
            self.assertTrue(str(caught.exception))


class Threads(unittest.TestCase):
    def test_a_job_tells_of_its_progress_and_ends_where_that_raises(self) -> None:
        stages: list[str] = []

        class Enough(Exception):
            pass

        def told(stage: str, done: int, steps: int) -> None:
            self.assertLessEqual(done, steps)
            stages.append(stage)
            if "cutting" in stage:
                raise Enough

        with self.assertRaises(Enough):
            feedwright.run(STAR, band=32, progress=told)
        self.assertTrue(stages)

    def test_other_threads_of_python_go_on(self) -> None:
        counted = [0]
        done = threading.Event()

        def count() -> None:
            while not done.wait(0.001):
                counted[0] += 1

        thread = threading.Thread(target=count)
        thread.start()
        begun = time.monotonic()
        feedwright.run(STAR, "tnv40", controller="uncorrected")
        feedwright.correct(PARTS / "circle.ngc", "tnv40")
        took_s = time.monotonic() - begun
        done.set()
        thread.join()
        self.assertGreater(counted[0], 50 * took_s)

    def test_an_interrupt_is_raised_within_a_tenth_of_a_second(self) -> None:
        text = (
            "import signal, sys, time, feedwright\n"
            # A shell that starts a job in the background has it ignore Ctrl-C.
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "for _ in range(5):\n"
            " try:\n"
            "  print('begun', flush=True)\n"
            "  feedwright.run(sys.argv[1], band=32)\n"
            "  print('ended', flush=True)\n"
            " except KeyboardInterrupt:\n"
            "  print(time.monotonic(), flush=True)\n"
        )
        job = subprocess.Popen([sys.executable, "-c", text, str(PARTS / "pocket.ngc")], stdout=subprocess.PIPE, text=True)
        assert job.stdout is not None
        took_s = []
        for wait_s in (0.05, 0.2, 0.4, 0.6, 0.8):
            self.assertEqual(job.stdout.readline(), "begun\n")
            time.sleep(wait_s)
            sent_s = time.monotonic()
            job.send_signal(signal.SIGINT)
            took_s.append(float(job.stdout.readline()) - sent_s)
        job.communicate(timeout=30)
        self.assertEqual(job.returncode, 0)
        self.assertLess(statistics.median(took_s), 0.1, took_s)


#: Runs the cells of a notebook as they stand.
RUN = """import json, sys
cells = json.load(open(sys.argv[1], encoding="utf-8"))["cells"]
names = {"__name__": "__main__"}
for number, cell in enumerate(cells):
    if cell["cell_type"] == "code":
        exec(compile("".join(cell["source"]), f"{sys.argv[1]}, cell {number}", "exec"), names)
"""


@unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
class Notebooks(unittest.TestCase):
    def test_every_notebook_runs_from_top_to_bottom(self) -> None:
        folder = DOCS.parent / "python" / "notebooks"
        notebooks = sorted(folder.glob("*.ipynb"))
        self.assertGreaterEqual(len(notebooks), 4)
        with tempfile.TemporaryDirectory() as results:
            environment = dict(os.environ, MPLBACKEND="Agg", FLEET="3x3", FLEET_RESULTS=results)
            for notebook in notebooks:
                line = [sys.executable, "-c", RUN, notebook.name]
                ran = subprocess.run(line, cwd=folder, env=environment, capture_output=True, text=True, check=False)
                self.assertEqual(ran.returncode, 0, f"{notebook.name}: {ran.stderr[-2000:]}")


if __name__ == "__main__":
    unittest.main()
