#!/usr/bin/python3
"""The commands of LinuxCNC's own planner, servo period by servo period, against those of the feed planner that models it.

    planner.py [--record] [PROGRAM.ngc ...]

Without programs: those of crates/sim/tests/oracle_data/linuxcnc_planner. `--record` writes beside each program what LinuxCNC did: the number of servo
periods and every 20th command, which oracle_linuxcnc_planner tests without LinuxCNC. Build first: cargo build -p feedwright-lab --example linuxcnc_planner.
Columns: servo periods of both, their ratio, the largest distance of commands of the same servo period, and of either path from the other, um. Exit
code 1 where a time is off by 2 %, or a path by 2 um.
"""
import argparse
import fcntl
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import headless

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PROGRAMS = ROOT / "crates" / "sim" / "tests" / "oracle_data" / "linuxcnc_planner"
AXES = "XYZ"
VELOCITY, ACCEL = 200, 2000
# The program may take so long, s.
LIMIT_S = 120
TIME, PATH_UM = 0.02, 2.0
# Of the servo periods one in so many is kept.
KEPT = 20
TRIALS = 3
# Two servo periods of the same place, mm: recordings have six decimals.
STILL_MM = 6e-7


def ini(folder):
    """The least configuration that moves three axes."""
    limits = f"MAX_VELOCITY = {VELOCITY}\nMAX_ACCELERATION = {ACCEL}\nMIN_LIMIT = -1000\nMAX_LIMIT = 1000\n"
    text = f"""[EMC]
VERSION = 1.1
MACHINE = planner
[DISPLAY]
DISPLAY = {pathlib.Path(__file__).resolve()}
CYCLE_TIME = 0.05
MAX_FEED_OVERRIDE = 2.0
PROGRAM_PREFIX = {folder}
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[RS274NGC]
PARAMETER_FILE = planner.var
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 4.0
BASE_PERIOD = 0
SERVO_PERIOD = 1000000
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.1
TOOL_TABLE = planner.tbl
[HAL]
HALFILE = planner.hal
[TRAJ]
COORDINATES = X Y Z
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = 50
MAX_LINEAR_VELOCITY = {VELOCITY}
DEFAULT_LINEAR_ACCELERATION = {ACCEL}
MAX_LINEAR_ACCELERATION = {ACCEL}
[KINS]
KINEMATICS = trivkins coordinates=XYZ
JOINTS = 3
"""
    for i, axis in enumerate(AXES):
        text += f"[AXIS_{axis}]\n{limits}[JOINT_{i}]\nTYPE = LINEAR\n{limits}HOME_SEQUENCE = 0\nFERROR = 10\nMIN_FERROR = 5\n"
    return text


def hal():
    """Commands go straight back as positions, and into a sampler."""
    lines = ["loadrt [KINS]KINEMATICS",
             "loadrt [EMCMOT]EMCMOT base_period_nsec=0 servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS",
             "loadrt sampler depth=20000 cfg=fff", "addf motion-command-handler servo-thread", "addf motion-controller servo-thread",
             "addf sampler.0 servo-thread", "setp sampler.0.enable 0",
             "net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in",
             "net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared",
             "net change iocontrol.0.tool-change => iocontrol.0.tool-changed"]
    lines += [f"net command-{i} joint.{i}.motor-pos-cmd => joint.{i}.motor-pos-fb sampler.0.pin.{i}" for i in range(3)]
    return "\n".join(lines) + "\n"


def real(program):
    """Commands of LinuxCNC from the last before the first motion to the first behind the last."""
    with tempfile.TemporaryDirectory(prefix="feedwright-") as name, open("/tmp/feedwright-linuxcnc.lock", "w") as lock:
        folder = pathlib.Path(name)
        (folder / "home").mkdir()
        for file, text in (("planner.ini", ini(folder)), ("planner.hal", hal()), ("planner.tbl", "T1 P1 D1 Z0\n")):
            (folder / file).write_text(text)
        environment = dict(os.environ, HOME=str(folder / "home"), FEEDWRIGHT_FOLDER=name, FEEDWRIGHT_PROGRAM=str(program.resolve()))
        environment.pop("DISPLAY", None)
        if os.getuid() == 0:
            environment["RTAPI_UID"] = "65534"
            os.chmod(folder, 0o777)
            os.chmod(folder / "home", 0o777)
        fcntl.flock(lock, fcntl.LOCK_EX)
        done = subprocess.run(["linuxcnc", "-r", "planner.ini"], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=LIMIT_S + headless.STARTS_S + headless.ENDS_S, close_fds=True)
        samples = folder / "samples.txt"
        if done.returncode != 0 or not samples.exists():
            raise headless.Failed(f"{program}: LinuxCNC ended with {done.returncode}\n{done.stdout[-2000:]}")
        return moving([tuple(map(float, line.split()[1:4])) for line in samples.read_text().splitlines()])


def moving(points):
    steps = [i for i in range(1, len(points)) if math.dist(points[i], points[i - 1]) > STILL_MM]
    if not steps:
        raise headless.Failed("nothing moved")
    return points[steps[0] - 1:steps[-1] + 1]


def model(program):
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    found = [target / profile / "examples" / "linuxcnc_planner" for profile in ("release", "debug")]
    tool = next((file for file in found if file.exists()), None)
    if tool is None:
        raise headless.Failed("cargo build -p feedwright-lab --example linuxcnc_planner comes first")
    done = subprocess.run([tool, program], capture_output=True, text=True, check=True)
    return moving([tuple(map(float, line.split(","))) for line in done.stdout.splitlines()])


def away(points, path):
    """Largest distance of points from a path that goes the same way at about the same time, um."""
    largest = 0.0
    for at, point in enumerate(points):
        nearest, span = math.inf, 50 + int(TIME * at)
        for begin, end in zip(path[max(at - span, 0):at + span], path[max(at - span, 0) + 1:at + span + 1]):
            way = [b - a for a, b in zip(begin, end)]
            square = sum(w * w for w in way)
            part = sum((p - a) * w for p, a, w in zip(point, begin, way)) / square if square > 0 else 0.0
            nearest = min(nearest, math.dist(point, [a + min(max(part, 0), 1) * w for a, w in zip(begin, way)]))
        largest = max(largest, nearest)
    return 1e3 * largest


def agreed(program):
    """What two runs agree on: a busy machine is late with a block now and then."""
    runs = []
    while len(runs) <= TRIALS:
        runs.append(real(program))
        if runs[-1] in runs[:-1]:
            return runs[-1]
    raise headless.Failed(f"{program}: no two of {len(runs)} runs are the same")


def record(program, points):
    """The number of servo periods, and every 20th command."""
    lines = [f"{len(points) - 1}"] + [",".join(f"{x:.6f}" for x in point) for point in points[::KEPT]]
    program.with_suffix(".csv").write_text("\n".join(lines) + "\n")


def screen():
    """In place of a screen."""
    import linuxcnc
    machine = headless.Machine(linuxcnc, pathlib.Path(os.environ["FEEDWRIGHT_FOLDER"]))
    deadline = time.monotonic() + headless.STARTS_S
    while True:
        try:
            machine.poll()
            break
        except linuxcnc.error:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.05)
    machine.on()
    machine.home()
    machine.open(pathlib.Path(os.environ["FEEDWRIGHT_PROGRAM"]).read_text())
    machine.record()
    machine.begin()
    machine.finish(LIMIT_S)
    machine.end_record()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--record", action="store_true")
    parser.add_argument("programs", nargs="*", type=pathlib.Path)
    args = parser.parse_args()
    missed = False
    print(f"| {'program':<24} | LinuxCNC | model | ratio | same period um | path um |\n|---|--:|--:|--:|--:|--:|", flush=True)
    for program in args.programs or sorted(PROGRAMS.glob("*.ngc")):
        ours = model(program)
        for trial in range(TRIALS):
            try:
                theirs = agreed(program) if args.record else real(program)
                break
            except (headless.Failed, subprocess.TimeoutExpired) as failed:
                print(f"again: {failed}", file=sys.stderr)
                if trial + 1 == TRIALS:
                    raise
        if args.record:
            record(program, theirs)
        periods = [len(theirs) - 1, len(ours) - 1]
        same_um = 1e3 * max(math.dist(a, b) for a, b in zip(theirs, ours))
        path_um = max(away(theirs, ours), away(ours, theirs))
        ratio = periods[1] / periods[0]
        missed |= abs(ratio - 1) > TIME or path_um > PATH_UM
        print(f"| {program.stem:<24} | {periods[0]} | {periods[1]} | {ratio:.4f} | {same_um:.4f} | {path_um:.4f} |", flush=True)
    sys.exit(missed)


if __name__ == "__main__":
    if "FEEDWRIGHT_PROGRAM" in os.environ:
        screen()
    else:
        main()
