"""The gym: controllers, terms of the plant and agents in Python."""

import doctest
import gc
import hashlib
import importlib.util
import os
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy

import feedwright
from feedwright import Machine, Motion, lab

STAR = Path(os.environ["FEEDWRIGHT_PARTS"]) / "star.ngc"
DOCS = Path(os.environ["FEEDWRIGHT_DOCS"])
SPACE = feedwright.Program(text="G21 G61 F3000\nG1 X10\nG1 Y5 Z5\nG1 X0 Z0\nM2\n")


def load_tests(loader: unittest.TestLoader, tests: unittest.TestSuite, pattern: str | None) -> unittest.TestSuite:
    """The page is a test, too."""
    tests.addTests(doctest.DocFileSuite(str(DOCS / "lab.md"), module_relative=False))
    return tests


class Straight:
    """The programmed path."""

    servo_periods, preview = 10, 0

    def reset(self) -> None:
        pass

    def command(self, window: lab.Window) -> tuple[float, Any]:
        return 1.0, [0.0] * len(window.axes)


class VelocityFeedforward:
    """The controller `feedforward` of the library with its velocity part alone, on axes without delays and integrals."""

    servo_periods = 1

    def prepare(self, axes: Any, servo_s: float) -> None:
        kp, kd, kv, viscous, inertia = (
            numpy.array([axis[name] for axis in axes])
            for name in ("kp_1_s", "kd", "kv_nm_s_per_rad", "viscous_friction_nm_s", "inertia_kg_m2")
        )
        self.speed_1_s, self.last_1, self.gain_1_s = 1 + viscous / kv, kd / servo_s, kp + kd / servo_s
        self.preview = int(numpy.ceil(3 * max(1 / kp + inertia / kv) / servo_s + 3))

    def reset(self) -> None:
        pass

    def command(self, window: lab.Window) -> tuple[float, Any]:
        speed_mm_s = (window.path_mm[2] - window.path_mm[1]) / window.servo_s
        return 1.0, (self.speed_1_s * speed_mm_s + self.last_1 * window.offset_mm) / self.gain_1_s


def example(name: str) -> Any:
    """A program of the examples, as a module."""
    path = Path(__file__).parent.parent / "examples" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Examples(unittest.TestCase):
    def test_the_paper_in_numpy_cuts_as_the_library_does_with_the_same_weights(self) -> None:
        paper = example("lee_cho_jeon_2005")
        names = {"rho": 0.002, "eta": 0.25, "steps": 4, "learning_step": 0.01}
        with tempfile.TemporaryDirectory() as folder:
            model = Path(folder, "tnv40.model.toml")
            line = ("identify", "--machine", "tnv40", "--controller", "two-dimensional", "--out", str(model))
            subprocess.run([sys.executable, "-m", "feedwright", *line], check=True, capture_output=True)
            ours = lab.run(STAR, "tnv40", paper.TwoDimensional(paper.Network.read(model), **names))
        settings = {f"two-dimensional.{name}": value for name, value in names.items()}
        theirs = lab.run(STAR, "tnv40", "two-dimensional", settings=settings)
        self.assertEqual(len(ours.rows["t_s"]), len(theirs.rows["t_s"]))
        self.assertLess(ours.corrected["rms_um"], 0.6 * ours.uncorrected["rms_um"])
        for name in ("cmd_x_mm", "cmd_y_mm", "act_x_mm", "act_y_mm"):
            self.assertLess(abs(ours.rows[name] - theirs.rows[name]).max(), 1e-9, name)


class Guests(unittest.TestCase):
    def test_a_controller_of_the_library_that_is_written_in_python_cuts_the_same(self) -> None:
        only = {"feedforward.acceleration_gain": 0, "feedforward.friction_gain": 0}
        for program in (STAR, SPACE):
            theirs = feedwright.run(program, "tnv40", controller="feedforward", settings=only)
            ours = lab.run(program, "tnv40", VelocityFeedforward())
            self.assertEqual(len(ours.rows["t_s"]), len(theirs.rows["t_s"]))
            self.assertGreater(abs(ours.rows["cmd_x_mm"] - ours.rows["path_x_mm"]).max(), 0.5)
            for name in ("cmd_x_mm", "cmd_y_mm", "act_x_mm", "act_y_mm"):
                self.assertLess(abs(ours.rows[name] - theirs.rows[name]).max(), 1e-12, name)

    def test_what_is_raised_ends_the_run_and_is_what_the_caller_gets(self) -> None:
        raised = KeyError("mine")

        def fail(*_: object) -> Any:
            raise raised

        for where in ("prepare", "reset", "command", "observe"):
            controller = Straight()
            setattr(controller, where, fail)
            with self.assertRaises(KeyError) as caught:
                lab.run(STAR, "tnv40", controller)
            self.assertIs(caught.exception, raised, where)
        with self.assertRaises(KeyError) as caught:
            lab.run(STAR, "tnv40", Straight(), plant_term=fail)
        self.assertIs(caught.exception, raised)

    def test_what_is_raised_in_the_middle_ends_the_run_at_once(self) -> None:
        calls: list[float] = []

        class Late(Straight):
            def command(self, window: lab.Window) -> tuple[float, Any]:
                calls.append(window.plan_s)
                if len(calls) == 100:
                    raise RuntimeError("enough")
                return super().command(window)

        with self.assertRaisesRegex(RuntimeError, "enough"):
            lab.run(STAR, "tnv40", Late())
        self.assertEqual(len(calls), 100)

    def test_wrong_answers_are_said(self) -> None:
        for answer in (None, 1.0, (1.0,), (1.0, 2.0), (1.0, [0.0]), (1.0, [0.0] * 3), ("fast", [0.0, 0.0])):
            controller = Straight()
            controller.command = lambda window, answer=answer: answer  # type: ignore[method-assign]
            with self.assertRaises(feedwright.FeedwrightError, msg=repr(answer)):
                lab.run(STAR, "tnv40", controller)
        for torque in (None, (0.0,), (0.0, float("nan"))):
            with self.assertRaises(feedwright.FeedwrightError, msg=repr(torque)):
                lab.run(STAR, "tnv40", Straight(), plant_term=lambda *_, torque=torque: torque)
        for periods, preview in ((0, 0), (10, 26), (1, 257)):
            controller = Straight()
            controller.servo_periods, controller.preview = periods, preview
            with self.assertRaises(feedwright.FeedwrightError):
                lab.run(STAR, "tnv40", controller)
        for wrong in ({"against": "nobody"}, {"knowledge": "rumors"}):
            with self.assertRaises(feedwright.FeedwrightError):
                lab.run(STAR, "tnv40", Straight(), **wrong)

    def test_what_is_no_number_or_beyond_all_bounds_is_held_to_the_bounds(self) -> None:
        bound_mm = feedwright.Machine("tnv40").values["limits"]["max_deviation_mm"]
        nan, inf = float("nan"), float("inf")
        for answer in (
            (nan, [0, 0]),
            (1.0, [nan, nan]),
            (inf, [0, 0]),
            (1.0, [inf, 0]),
            (1.0, [1e9, -1e9]),
            (-5, [0, 0]),
        ):
            controller = Straight()
            controller.preview = 20
            controller.command = lambda window, answer=answer: answer  # type: ignore[method-assign]
            cut = lab.run(STAR, "tnv40", controller)
            self.assertEqual(cut.corrected["outcome"]["kind"], "completed", answer)
            path, command = (
                numpy.column_stack([cut.rows[f"{of}_{axis}_mm"] for axis in "xy"]) for of in ("path", "cmd")
            )
            off_mm = [numpy.hypot(*(path - point).T).min() for point in command[::10]]
            self.assertLessEqual(max(off_mm), bound_mm + 0.01, answer)
            if not all(numpy.isfinite([answer[0], *answer[1]])):
                self.assertEqual(cut.corrected["transitions"][0]["change"], "left", answer)

    def test_a_window_shows_the_path_ahead_and_nobody_changes_it(self) -> None:
        seen: list[Any] = []

        class Looks(Straight):
            preview = 4

            def observe(self, window: lab.Window, measured: lab.Measurement | None) -> None:
                assert measured is not None
                seen.append((window, measured.position_mm, measured.contour_error_mm))

        cut = lab.run(STAR, "tnv40", Looks())
        path = numpy.column_stack([cut.rows["path_x_mm"], cut.rows["path_y_mm"]])
        actual = numpy.column_stack([cut.rows["act_x_mm"], cut.rows["act_y_mm"]])
        for k in (1, 17, 200):
            window, position_mm, error_mm = seen[k]
            numpy.testing.assert_allclose(window.path_mm, path[10 * k : 10 * k + 50 : 10], atol=1e-9)
            numpy.testing.assert_allclose(position_mm, actual[10 * k - 1], atol=1e-12)
            self.assertLess(numpy.hypot(*error_mm), 0.5)
            self.assertEqual((window.path_mm.shape, window.feed_mm_s.shape), ((5, 2), (5,)))
            with self.assertRaises(ValueError):
                window.path_mm[0, 0] = 1.0
            with self.assertRaises(TypeError):
                window.axes[0]["kp_1_s"] = 1.0

    def test_knowledge_is_exact_identified_or_wrong(self) -> None:
        told: dict[str, Any] = {}
        for knowledge in ("exact", "identified", "wrong"):
            controller = Straight()
            controller.prepare = lambda axes, servo_s: told.update({knowledge: axes[0]})  # type: ignore[attr-defined]
            lab.run(STAR, "workshop", controller, knowledge=knowledge, seed=5, rows=False)
        exact, inertia = told["exact"], "inertia_kg_m2"
        self.assertAlmostEqual(told["wrong"][inertia] / exact[inertia], 0.8)
        self.assertAlmostEqual(told["wrong"]["coulomb_friction_nm"] / exact["coulomb_friction_nm"], 1.2)
        self.assertLess(abs(told["identified"][inertia] / exact[inertia] - 1), 0.1)
        self.assertNotEqual(told["identified"][inertia], exact[inertia])
        self.assertEqual({axis["kp_1_s"] for axis in told.values()}, {exact["kp_1_s"]})

    def test_the_same_seed_gives_the_same_bits_and_another_another_noise(self) -> None:
        rms_um = [lab.run(STAR, "workshop", Straight(), seed=seed).corrected["rms_um"] for seed in (7, 7, 8)]
        self.assertEqual(rms_um[0], rms_um[1])
        self.assertNotEqual(rms_um[0], rms_um[2])

    def test_a_term_adds_its_torque_and_no_torque_changes_no_bit(self) -> None:
        machine = feedwright.Machine("tnv40").with_values(
            {f"axis.{axis}.{key}": 0.0 for axis in "xy" for key in ("disturbance_nm", "coulomb_friction_nm")}
        )
        without = lab.run(STAR, machine, Straight())
        nothing = lab.run(STAR, machine, Straight(), plant_term=lambda *_: (0.0, 0.0))
        for name in without.rows:
            numpy.testing.assert_array_equal(nothing.rows[name], without.rows[name], err_msg=name)
        # A constant torque M moves a P position loop over a P speed loop by M / (Kv kp) of a motor angle.
        axis = machine.values["axis"]["x"]
        torque_nm = 0.5
        pushed = lab.run(STAR, machine, Straight(), plant_term=lambda *_: (torque_nm, 0.0))
        rad_per_mm = 2 * numpy.pi / axis["lead_mm_per_rev"]
        expected_mm = torque_nm / (axis["kv_nm_s_per_rad"] * axis["kp_1_s"]) / rad_per_mm
        # It waits at its end for a table that the torque holds off.
        many = len(without.rows["t_s"])
        moved_mm = pushed.rows["act_x_mm"][1000:many] - without.rows["act_x_mm"][1000:]
        numpy.testing.assert_allclose(moved_mm, expected_mm, rtol=1e-6)
        self.assertLess(abs(pushed.rows["act_y_mm"][:many] - without.rows["act_y_mm"]).max(), 1e-12)

    def test_a_term_sees_positions_speeds_and_time(self) -> None:
        seen: list[Any] = []

        def term(position_mm: Any, speed_mm_s: Any, t_s: float) -> Any:
            seen.append((position_mm, speed_mm_s, t_s))
            return numpy.zeros(2)

        cut = lab.run(STAR, "tnv40", Straight(), against="uncorrected", plant_term=term)
        seen = seen[len(seen) // 2 :]
        x_mm = numpy.array([position_mm[0] for position_mm, _, _ in seen])
        numpy.testing.assert_allclose(x_mm[1:], cut.rows["act_x_mm"][: len(x_mm) - 1], atol=1e-12)
        mean_mm_s = numpy.diff(x_mm) / 0.001
        speed_mm_s = numpy.array([speed_mm_s[0] for _, speed_mm_s, _ in seen])
        numpy.testing.assert_allclose((speed_mm_s[1:] + speed_mm_s[:-1]) / 2, mean_mm_s, atol=0.5)
        self.assertAlmostEqual(seen[500][2], 0.5)

    def test_an_interrupt_ends_a_run(self) -> None:
        text = (
            # A shell that starts a job in the background has it ignore Ctrl-C.
            "import signal, sys\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "from feedwright import lab\nclass C:\n servo_periods, preview = 1, 0\n def reset(self): pass\n"
            " def command(self, window):\n  import time; time.sleep(0.01); return 1.0, [0.0, 0.0]\n"
            "print('begun', flush=True)\nlab.run(sys.argv[1], 'tnv40', C())\n"
        )
        job = subprocess.Popen(
            [sys.executable, "-c", text, str(STAR)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        assert job.stdout is not None
        self.assertEqual(job.stdout.readline(), "begun\n")
        time.sleep(0.5)
        job.send_signal(2)
        _, told = job.communicate(timeout=30)
        self.assertIn("KeyboardInterrupt", told)


def half_the_feed(motions: Sequence[Motion], machine: Machine) -> list[float]:
    return [motion.feed_mm_s / 2 for motion in motions]


class Planners(unittest.TestCase):
    def test_a_planner_sets_the_feedrates_of_its_cut_alone(self) -> None:
        as_programmed = lab.run(STAR, "tnv40", "uncorrected")
        half = lab.run(STAR, "tnv40", "uncorrected", planner=half_the_feed)
        self.assertEqual(half.corrected["controller"], "half_the_feed")
        for key in ("time_s", "rms_um", "max_um"):
            self.assertEqual(half.uncorrected[key], as_programmed.uncorrected[key])
        # The arcs of the star are slower than programmed already.
        self.assertGreater(half.corrected["time_s"], 1.1 * half.uncorrected["time_s"])
        self.assertLess(half.corrected["rms_um"], 0.8 * half.uncorrected["rms_um"])

    def test_the_feedrates_of_the_program_change_no_bit(self) -> None:
        for controller in ("uncorrected", "feedforward", Straight()):
            same = lab.run(STAR, "workshop", controller, planner=lambda motions, _: [m.feed_mm_s or 1.0 for m in motions])
            plain = lab.run(STAR, "workshop", controller)
            for key in ("time_s", "rms_um", "max_um", "engaged_share"):
                self.assertEqual(same.corrected[key], plain.corrected[key])

    def test_a_controller_of_the_library_and_a_planner_take_part_together(self) -> None:
        half = {"velocity_gain": 0.5, "acceleration_gain": 0, "friction_gain": 0}
        both = lab.run(STAR, "tnv40", "feedforward", settings=half, planner=half_the_feed)
        self.assertEqual(both.corrected["controller"], "feedforward, planned by half_the_feed")
        alone = lab.run(STAR, "tnv40", "uncorrected", planner=half_the_feed)
        self.assertLess(both.corrected["rms_um"], alone.corrected["rms_um"])

    def test_a_machine_holds_its_limits_whatever_a_planner_says(self) -> None:
        fast = lab.run(STAR, "tnv40", "uncorrected", planner=lambda motions, _: [1e6] * len(motions))
        values = feedwright.Machine("tnv40").values
        most_mm_s = values["limits"]["max_feed_mm_s"]
        self.assertLessEqual(fast.rows["feed_plan_mm_s"].max(), most_mm_s * (1 + 1e-9))

    def test_wrong_plans_are_said(self) -> None:
        def raises(motions: object, machine: object) -> list[float]:
            raise KeyError("in the planner")

        for planner, told in (
            (lambda motions, _: [], "0 feedrates for"),
            (lambda motions, _: [-1.0] * len(motions), "is -1.0 mm/s"),
            (lambda motions, _: [float("nan")] * len(motions), "is nan mm/s"),
            (lambda motions, _: "fast", "could not convert"),
        ):
            with self.assertRaisesRegex(ValueError, told):
                lab.run(STAR, "tnv40", "uncorrected", planner=planner)
        with self.assertRaisesRegex(KeyError, "in the planner"):
            lab.run(STAR, "tnv40", "uncorrected", planner=raises)

    def test_a_planner_is_scored_and_verified(self) -> None:
        round = lab.Round("a planner", programs=1, machines=1)
        found = lab.benchmark("uncorrected", planner=half_the_feed, round=round, knowledge=["exact"])
        self.assertGreater(found.scores["exact"]["time_ratio"], 1.2)
        self.assertEqual(found.results["controller"]["name"], "half_the_feed")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "half.json")
            found.save(path)
            self.assertEqual(lab.verify(path, "uncorrected", half_the_feed), [])
            self.assertIn("the source of the planner is another one", lab.verify(path, "uncorrected"))


def set_feedforward(gain: float) -> lab.Benchmark:
    round = lab.Round("keys", programs=1, machines=1)
    return lab.benchmark(
        "feedforward",
        round=round,
        knowledge=["exact"],
        settings=lambda machine: {"velocity_gain": gain},
        planner=half_the_feed,
    )


class Rounds(unittest.TestCase):
    ROUND = lab.Round("a test", programs=2, machines=2)

    def test_a_secret_draws_work_and_another_secret_other_work(self) -> None:
        work = self.ROUND.work()
        self.assertEqual(len(work), 4)
        told = [(program.name, machine.text, seed) for program, machine, seed in work]
        self.assertEqual(told, [(program.name, machine.text, seed) for program, machine, seed in self.ROUND.work()])
        self.assertEqual(len({seed for _, _, seed in work}), 4)
        other = lab.Round("another test", programs=2, machines=2).work()
        self.assertFalse({machine.name for _, machine, _ in work} & {machine.name for _, machine, _ in other})
        self.assertNotEqual(lab.new_secret(), lab.new_secret())

    def test_a_result_is_verified_bit_by_bit(self) -> None:
        found = lab.benchmark(Straight(), round=self.ROUND, knowledge=["wrong"])
        self.assertEqual(found.scores["wrong"]["error_ratio"], 1.0)
        self.assertEqual(len(found.results["rows"]), 4)
        own = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()
        self.assertEqual(found.results["controller"], {"name": "Straight", "source_sha256": own})
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "straight.json")
            found.save(path)
            self.assertEqual(lab.verify(path, Straight()), [])
            differences = lab.verify(path, VelocityFeedforward())
            self.assertEqual(sum("rms_um is" in difference for difference in differences), 4, differences)
            damaged = path.read_text().replace('"completed": true', '"completed": false', 1)
            path.write_text(damaged)
            with self.assertRaisesRegex(ValueError, "checksum"):
                lab.verify(path, Straight())
            for text in ("", "[]", "{}", '{"sha256": ""}'):
                path.write_text(text)
                with self.assertRaisesRegex(ValueError, "no result file"):
                    lab.leaderboard([path])

    def test_what_a_controller_is_set_to_is_verified_with_it(self) -> None:
        half, other = set_feedforward(0.5), set_feedforward(0.25)
        self.assertEqual(list(half.results["controller"]["settings"].values()), [{"velocity_gain": 0.5}])
        self.assertNotEqual(half.scores, other.scores)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "half.json")
            half.save(path)
            self.assertEqual(lab.verify(path, "feedforward", half_the_feed), [])

    def test_the_manual_has_every_key_of_a_result_file_and_no_other(self) -> None:
        def keys(value: Any, place: str = "") -> set[str]:
            if isinstance(value, list):
                return set().union(*(keys(part, f"{place}[]") for part in value))
            if isinstance(value, dict):
                free = place in ("versions", "scores") or place.startswith("controller.settings")
                return set().union(
                    *(keys(part, f"{place}.{'*' if free else key}".lstrip(".")) for key, part in value.items())
                )
            return {place}

        found = set_feedforward(0.5)
        section = (DOCS / "json.md").read_text(encoding="utf-8").split("## Result files of the gym")[1].split("## ")[0]
        documented = {line.split("`")[1] for line in section.splitlines() if line.startswith("| `")}
        self.assertEqual(documented, keys(found.results))

    def test_a_leaderboard_has_the_files_of_one_round_the_best_first(self) -> None:
        class Drifts(Straight):
            preview = 10
            name = "<b>drifts"

            def command(self, window: lab.Window) -> tuple[float, Any]:
                return 1.0, window.offset_mm + [0.001, 0.0]

        with tempfile.TemporaryDirectory() as folder:
            paths = [Path(folder, f"{k}.json") for k in range(3)]
            lab.benchmark(Drifts(), round=self.ROUND, knowledge=["exact"]).save(paths[0])
            lab.benchmark(Straight(), round=self.ROUND, knowledge=["exact"]).save(paths[1])
            page = lab.leaderboard(paths[:2])
            self.assertLess(page.index("<td>1</td><td>Straight</td>"), page.index("<td>2</td><td>&lt;b&gt;drifts</td>"))
            self.assertIn("Content-Security-Policy", page)
            self.assertIn(lab.commitment("a test"), page)
            self.assertNotIn("http://", page)
            lab.benchmark(Straight(), round=lab.Round("b", 1, 1), knowledge=["exact"]).save(paths[2])
            with self.assertRaisesRegex(ValueError, "different rounds"):
                lab.leaderboard(paths)

    def test_the_package_has_figures_of_others_in_the_public_round(self) -> None:
        found = lab.benchmark("uncorrected", knowledge=["exact"])
        beside = {result["controller"]["name"]: result for result in found.beside()[1:]}
        self.assertGreater(len(beside), 15)
        self.assertEqual(beside["uncorrected"]["scores"]["exact"], found.scores["exact"])
        self.assertLess(beside["feedforward"]["scores"]["exact"]["error_ratio"], 1.0)
        self.assertIn("lqg-identified", repr(found))


def episodes() -> int:
    """Threads of this process that a run waits in."""
    names = Path("/proc/self/task").glob("*/comm")
    return sum(name.read_text().startswith("feedwright epi") for name in names)


class Environments(unittest.TestCase):
    def test_gymnasium_finds_nothing_wrong(self) -> None:
        try:
            from gymnasium.utils.env_checker import check_env
        except ImportError:
            self.skipTest("gymnasium is not installed")
        with warnings.catch_warnings():
            # Its advice on the bounds of spaces: lengths have none.
            warnings.simplefilter("ignore")
            check_env(lab.Env(STAR, "workshop"))

    def test_without_gymnasium_spaces_are_bounds(self) -> None:
        text = (
            "import sys\nsys.modules['gymnasium'] = None\nfrom feedwright import lab\n"
            "env = lab.Env(sys.argv[1], 'tnv40', preview=3, largest_offset_mm=0.25)\n"
            "seen, info = env.reset(seed=1)\n"
            "print([bound.tolist() for bound in env.action_space], env.observation_space[0].shape, seen.shape, info)\n"
        )
        ran = subprocess.run([sys.executable, "-c", text, str(STAR)], capture_output=True, text=True, timeout=30)
        self.assertEqual(ran.stdout, "[[0.0, -0.25, -0.25], [1.2, 0.25, 0.25]] (15,) (15,) {}\n", ran.stderr)

    def test_an_episode_is_the_run_of_a_controller_that_does_the_same(self) -> None:
        actions = [numpy.array([1.0 - 0.001 * (k % 7), 0.001 * (k % 5), -0.002 * (k % 3)]) for k in range(2000)]

        class Replays(Straight):
            preview = 5

            def reset(self) -> None:
                self.left = iter(actions)

            def command(self, window: lab.Window) -> tuple[float, Any]:
                feed, *offset = next(self.left)
                return feed, offset

        env = lab.Env(STAR, "tnv40")
        env.reset(seed=3)
        squares, rows, rewards = 0.0, 0, 0.0
        for action in actions:
            _, reward, over, _, info = env.step(action)
            squares, rows, rewards = squares + info["mean_um2"] * info["rows"], rows + info["rows"], rewards + reward
            if over:
                break
        self.assertTrue(over)
        figures = info["results"]["runs"][0]
        self.assertAlmostEqual(numpy.sqrt(squares / rows), figures["rms_um"], places=9)
        self.assertLess(rewards, 0.0)
        # The noise of tnv40 is none, so that the seed does not matter.
        cut = lab.run(STAR, "tnv40", Replays())
        self.assertEqual(cut.corrected["rms_um"], figures["rms_um"])
        with self.assertRaises(RuntimeError):
            env.step(actions[0])

    def test_early_ends_leave_no_thread_behind(self) -> None:
        env = lab.Env(STAR, "tnv40")
        for _ in range(5):
            env.reset(seed=1)
            env.step([1.0, 0.0, 0.0])
        self.assertEqual(episodes(), 1)
        env.close()
        env.close()
        self.assertEqual(episodes(), 0)
        env.reset()
        del env
        gc.collect()
        ends_s = time.monotonic() + 5
        while episodes() and time.monotonic() < ends_s:
            time.sleep(0.01)
        self.assertEqual(episodes(), 0)

    def test_what_is_raised_in_an_episode_is_raised_by_its_step(self) -> None:
        class Late(Exception):
            pass

        def term(position_mm: Any, speed_mm_s: Any, t_s: float) -> Any:
            if t_s > 0.1:
                raise Late
            return 0.0, 0.0

        env = lab.Env(STAR, "tnv40", plant_term=term)
        env.reset(seed=1)
        with self.assertRaises(Late):
            for _ in range(100):
                env.step([1.0, 0.0, 0.0])
        env.reset(seed=1)
        with self.assertRaises(feedwright.FeedwrightError):
            env.step([1.0, 0.0])
        env.step([1.0, 0.0, 0.0])
        env.close()
        with self.assertRaises(feedwright.FeedwrightError):
            lab.Env("nowhere.ngc", "tnv40")

    def test_environments_in_threads_do_not_wait_for_each_other(self) -> None:
        figures: dict[int, float] = {}

        def play(k: int) -> None:
            env = lab.Env(STAR, "workshop", plant_term=lambda *_: (0.01, 0.0))
            env.reset(seed=11)
            over = False
            while not over:
                _, _, over, _, info = env.step([1.0, 0.0, 0.0])
            figures[k] = info["results"]["runs"][0]["rms_um"]

        threads = [threading.Thread(target=play, args=(k,)) for k in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(120)
        self.assertEqual(len(figures), 3)
        self.assertEqual(len(set(figures.values())), 1)

    def test_the_interpreter_ends_in_the_middle_of_an_episode(self) -> None:
        text = (
            "import sys\nfrom feedwright import lab\n"
            "env = lab.Env(sys.argv[1], 'tnv40', plant_term=lambda *_: (0.0, 0.0))\n"
            "env.reset(seed=1)\nenv.step([1.0, 0.0, 0.0])\nprint('over')\n"
        )
        ran = subprocess.run([sys.executable, "-c", text, str(STAR)], capture_output=True, text=True, timeout=30)
        self.assertEqual((ran.returncode, ran.stdout, ran.stderr), (0, "over\n", ""))


if __name__ == "__main__":
    unittest.main()
