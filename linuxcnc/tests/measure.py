#!/usr/bin/python3
"""RMS and largest contour error in the real LinuxCNC on a simulated machine, without the correction and with it.

    measure.py --machine MACHINE.fwmodel[:MODEL.fwmodel] [--quick] [--only NAME] [--never-worse] [--set PIN=VALUE ...]

Columns: to the programmed path, and to the commands of LinuxCNC; um. Exit code 1 where a target is missed.
"""
import argparse
import math
import pathlib
import struct
import sys

import headless
import paths
import programs

ZERO = (0.0, 0.0, 0.0)
# Of the same run without the correction: RMS and largest, to the commands of LinuxCNC.
SMOOTH, CORNERS = (0.05, 0.1), (0.15, 0.3)
# LinuxCNC blends what its queue holds by then, which differs from run to run, and more so on a machine that is busy: then it cuts again.
SAME_TIME = 0.005
TRIALS = 3
# Never worse, um: RMS and largest.
NO_WORSE_UM = (0.05, 1.0)


def servo_s(block):
    """Servo period of a model, s."""
    return struct.unpack_from("<d", pathlib.Path(block).read_bytes(), 24)[0]


def figures(recording, program, period_s=0.001):
    """RMS and largest error to the programmed path, where that is read, and to the commands, um, and the time of the cut, s."""
    path = paths.pieces(program) if paths.is_read(program) else []
    rows = recording.rows
    commands = [row.command for row in rows]
    moving = [i for i, row in enumerate(rows) if row.motion_type in (2, 3)]
    if not moving:
        raise headless.Failed(f"nothing was cut: {recording.result} {recording.log}")
    begin, end = moving[0], moving[-1]
    # The tool arrives later than the command.
    arrived = min(end + round(0.15 / period_s), len(rows) - 1)
    latest = round(0.1 / period_s)
    programmed, commanded, distance = [], [], paths.Distance(path)
    # Homing takes the place where the axis stands for its home: the motors' zero is not that of the program.
    home = [command - start for command, start in zip(commands[max(begin - 5, 0)], paths.start(path) if path else ZERO)]
    cut = commands[begin:end + 1]
    for i in range(begin, arrived + 1):
        programmed.append(math.nan if not path else 1e3 * distance.of([tool - zero for tool, zero in zip(rows[i].tool, home)]))
        commanded.append(1e3 * paths.to_commands(cut, rows[i].tool, min(i, end) - begin, latest))
    rms = lambda values: math.sqrt(sum(x * x for x in values) / len(values))
    return (rms(programmed), max(programmed)), (rms(commanded), max(commanded)), (end - begin) * period_s


def measure(name, program, machine, params):
    """Both runs of a program."""
    period_s = servo_s(machine[0])
    ini = {"FEEDWRIGHT": {"MACHINE": machine[0], "MODEL": machine[1]}, "EMCMOT": {"SERVO_PERIOD": round(1e9 * period_s)}}
    settings = {"program": program, "params": params}
    for _ in range(TRIALS):
        off = headless.run("cut", {**settings, "enable": False}, ini)
        on = headless.run("cut", {**settings, "enable": True}, ini)
        without, corrected = figures(off, program, period_s), figures(on, program, period_s)
        if is_same_time(without, corrected):
            break
    return without, corrected, on


def is_same_time(off, on):
    return abs(on[2] - off[2]) < SAME_TIME * off[2]


def faults_of(recording):
    """Causes of what took the correction out of the loop."""
    return ",".join(str(cause) for cause in sorted({row.cause for row in recording.rows if row.fault})) or "-"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", required=True, help="MACHINE.fwmodel[:MODEL.fwmodel]")
    parser.add_argument("--only", help="programs whose name begins so")
    parser.add_argument("--quick", action="store_true", help="the first of each kind")
    parser.add_argument("--never-worse", action="store_true", help="the target is to do no harm")
    parser.add_argument("--set", action="append", default=[], metavar="PIN=VALUE", help="any pin, such as feedwright.delay=0.015")
    args = parser.parse_args()
    machine = [str(pathlib.Path(file).resolve()) for file in args.machine.split(":")]
    machine = (machine[0], machine[-1])
    params = dict(pair.split("=") for pair in args.set)
    return 1 if table(machine, params, programs.programs(args.quick), args.only or "", args.never_worse) else 0


def table(machine, params, cut, only="", never_worse=False):
    """Measures programs, and prints a row of each; how many targets were missed."""
    missed = 0
    print(f"{'program':24} {'programmed path: off':>22} {'on':>16} {'commands: off':>18} {'on':>16}  time s  cause of faults  tick p99.9 us")
    for name, program, corners in cut:
        if not name.startswith(only):
            continue
        off, on, recording = measure(name, program, machine, params)
        ticks = sorted(row.tick_ns for row in recording.rows if row.state == 4)
        p999 = ticks[int(0.999 * (len(ticks) - 1))] * 1e-3 if ticks else math.nan
        cells = [f"{rms:8.2f} / {most:7.2f}" for rms, most in (off[0], on[0], off[1], on[1])]
        rms, most = CORNERS if corners else SMOOTH
        # The programmed path is not what is corrected to: LinuxCNC's planner leaves it.
        harmless = not any(on[1][i] > off[1][i] + NO_WORSE_UM[i] for i in range(2))
        ok = harmless if never_worse else on[1][0] <= max(rms * off[1][0], NO_WORSE_UM[0]) and on[1][1] <= max(most * off[1][1], NO_WORSE_UM[1])
        same_time = is_same_time(off, on)
        missed += not (ok and same_time)
        print(f"{name:24} {cells[0]:>22} {cells[1]:>16} {cells[2]:>18} {cells[3]:>16}  {on[2]:6.3f}  {faults_of(recording):>6}"
              f"  {p999:6.1f}  {'' if ok else 'MISSED '}{'' if same_time else f'TIME {off[2]:.3f}'}", flush=True)
    return missed


if __name__ == "__main__":
    sys.exit(main())
