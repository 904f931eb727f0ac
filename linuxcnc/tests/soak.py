#!/usr/bin/python3
"""Random programs, modes, settings and faults in a real LinuxCNC on simulated machines, by a seed: what must hold in every servo period.

    soak.py [MINUTES] [--seed S] [--resume FILE] [--session K] [--keep FOLDER]

A session of LinuxCNC takes half a minute or more: its machine, its model (right, of another machine, damaged or missing) and what is done follow
from the seed and its number. `--resume` keeps what was done in a file and goes on from there; `--session` runs one again, and
`--keep` keeps the recording of each in which something did not hold. Exit code 1 where something did not hold.
"""
import argparse
import collections
import dataclasses
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

import headless
import measure
import paths
import recordings
import through

MACHINES = ("tnv40", "workshop", "stiff")
SESSION_S = 40
# Farthest that a drive's command goes in a servo period, mm: rapids of 200 mm/s along three axes, and as much again for a correction.
MOST_STEP_MM = 0.7
# A limit that is lowered takes effect within this, servo periods.
LOWERED = 210
# A path is looked for among so many of the last commands, as the component keeps, and of the next ones: along it a drive may lead, or stay behind.
LATEST, LATER = 250, 60
# An offset along the path is along its tangent, which leaves the path beside a corner: 4.5 um are the most that was found, mm.
ROUND_MM = 0.01
# Travel of a joint, mm.
TRAVEL_MM = 300.0
DEVIATIONS_MM = (0.0, 10.0)


def models(folder):
    """Block of each machine, its identified model, and a damaged one."""
    run = lambda *words: subprocess.run([headless.FEEDWRIGHT, "--quiet", *map(str, words)], check=True, stdout=subprocess.DEVNULL)
    for machine in MACHINES:
        found = folder / f"{machine}.model.toml"
        run("block", machine, "--axes", 3, "--out", folder / f"{machine}.machine")
        run("identify", "--machine", machine, "--controller", "lqg-identified", "--axes", 3, "--out", found)
        run("block", found, "--machine", machine, "--out", folder / f"{machine}.model")
    block = bytearray((folder / "tnv40.model").read_bytes())
    block[300] ^= 1
    (folder / "damaged.model").write_bytes(block)


def check(periods, with_rotary):
    """What did not hold, in words."""
    wrong, deviation_mm, lowered = [], 0.5, collections.deque(maxlen=LOWERED)
    # Where the joints are asked to be.
    commands = [tuple(map(sum, zip(period.command, period.geometry))) for period in periods]
    for n, period in enumerate(periods):
        told = (*period.drive, *period.feedback, *period.through_drive, *period.through_feedback, *period.numbers)
        if not all(map(math.isfinite, told)):
            wrong.append(f"{n}: not a number: {told}")
            continue
        asked_mm = period.settings[1]
        deviation_mm = asked_mm if DEVIATIONS_MM[0] <= asked_mm <= DEVIATIONS_MM[1] else deviation_mm
        lowered.append(deviation_mm)
        if period.state == 0:
            if all(map(math.isfinite, period.actual)) and period.drive != period.actual:
                wrong.append(f"{n}: without power a drive gets {period.drive}, and is at {period.actual}")
            continue
        allowed_mm = max(lowered) + ROUND_MM
        if math.dist(period.correction, (0, 0, 0)) > allowed_mm and period.state > 1:
            off_mm, _ = paths.to_commands(commands, period.drive, min(n + LATER, len(commands) - 1), LATEST + LATER)
            if off_mm > allowed_mm:
                wrong.append(f"{n}: {off_mm:.4f} mm off the path, {allowed_mm:.4f} are allowed; state {period.state}, settings {period.settings}")
        if max(map(abs, period.drive)) > TRAVEL_MM + allowed_mm:
            wrong.append(f"{n}: beyond the travel: {period.drive}")
        last = periods[n - 1] if n else period
        step_mm = math.dist(period.drive, last.drive)
        if last.state > 0 and step_mm > MOST_STEP_MM:
            wrong.append(f"{n}: the drive's command leapt by {step_mm:.3f} mm, the command by {math.dist(period.command, last.command):.3f}; "
                         f"states {last.state}, {period.state}; settings {period.settings}")
        if with_rotary:
            wrong += out_of_step(periods, n)
    return wrong


def out_of_step(periods, n):
    """Of joints that pass through: the rotary one and the signal to the bit, the second motor with its correction."""
    period = periods[n]
    due = periods[n - period.delay]
    tandem_mm = period.through_drive[0] - due.through[0] - period.correction[1] - due.geometry[1]
    if period.through_drive[1:3] != due.through[1:3] or abs(tandem_mm) > through.ROUNDING_MM:
        return [f"{n}: out of step with a delay of {period.delay}: {period.through_drive}, {due.through}"]
    return []


def blind():
    """What would not be found, in words: each way of being wrong is tried on a made-up recording."""
    rest = (0.0,) * recordings.CHANNELS
    at = lambda n: (0.05 * n, 0.0, 0.0)
    through_at = lambda n: (0.0, 0.1 * n, *rest[2:])
    good = [recordings.Period(at(n), at(n), (0.01, 0.5, 400.0, 400.0, 0.0, 1.0), at(n - 10), at(n), (0.0,) * 3, (0.0,) * 3, through_at(n), rest, through_at(n - 10), rest,
                              4, 0, 10, (0.0,)) for n in range(300)]
    good = [dataclasses.replace(period, delay=0, drive=at(n), through_drive=through_at(n)) if n < 10 else period for n, period in enumerate(good)]
    wrong = {"not a number": {"feedback": (math.nan, 0.0, 0.0)}, "off the path": {"drive": (9.5, 0.6, 0.0), "correction": (0.0, 0.6, 0.0)},
             "beyond": {"drive": (350.0, 0.0, 0.0)}, "leapt": {"drive": (10.5, 0.0, 0.0)}, "without power": {"state": 0},
             "out of step": {"through_drive": through_at(191)}}
    # The delay is taken up with a leap, which is not looked for here.
    found = check(good[10:], False)
    for name, changes in wrong.items():
        periods = [dataclasses.replace(period, **changes) if n == 200 else period for n, period in enumerate(good)]
        found += [] if any(name in what for what in check(periods, True)) else [f"not found: {name}"]
    return found


def session(folder, seed, number, keep=None):
    """Runs a session. Returns what it was, what it did, and what did not hold."""
    pick = random.Random(f"{seed}/{number}")
    machine, kind = pick.choice(MACHINES), pick.choice(("right", "right", "right", "wrong", "damaged", "missing"))
    other = pick.choice([name for name in MACHINES if name != machine])
    model = folder / {"right": f"{machine}.model", "wrong": f"{other}.model", "damaged": "damaged.model", "missing": "none.model"}[kind]
    periods_s = [measure.servo_s(folder / f"{of}.machine") for of in (machine, other)]
    # A model for another servo period is refused.
    corrects = {"right": [4], "wrong": [2, 3, 4] if periods_s[0] == periods_s[1] else [1]}
    expects = corrects.get(kind, [1])
    with_rotary = pick.random() < 0.5
    ini = {"FEEDWRIGHT": {"MACHINE": folder / f"{machine}.machine", "MODEL": model, "RECORD": 400, "RECORDING": "recording.fwreplay"},
           "EMCMOT": {"SERVO_PERIOD": round(1e9 * periods_s[0])}}
    settings = {"seed": f"{seed}/{number}/actions", "seconds": SESSION_S, "expects": expects, "with_rotary": with_rotary}
    name = f"{machine}, {kind} model{', gantry with a rotary axis' if with_rotary else ''}"
    # One component has all the switches.
    hal = through.HAL.replace("names=", "names=probed,") + headless.PROBE.split("\n", 1)[1] if with_rotary else headless.PROBE
    with tempfile.TemporaryDirectory(prefix="feedwright-soak-") as kept:
        try:
            run = headless.run("soak", settings, ini, hal, keep=kept, change=through.gantry if with_rotary else None)
        except headless.Failed as failed:
            return name, {}, 0, [str(failed)[-3000:]]
        recording = pathlib.Path(kept) / "recording.fwreplay"
        periods = recordings.read(recording)
        wrong = run.result["wrong"] + check(periods, with_rotary)
        if wrong and keep:
            shutil.copy(recording, keep / f"session-{number}.fwreplay")
    return name, run.result["counts"], len(periods), wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("minutes", nargs="?", type=float, default=5.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--resume", type=pathlib.Path, help="file of what was done")
    parser.add_argument("--session", type=int, help="this one alone")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for recordings in which something did not hold")
    args = parser.parse_args()
    done = {"seed": args.seed, "sessions": 0, "periods": 0, "wrong": []}
    if args.resume and args.resume.exists():
        done = json.loads(args.resume.read_text())
    if found := blind():
        print(f"the test is blind: {found}", file=sys.stderr)
        return 1
    totals, end = {}, time.monotonic() + 60 * args.minutes
    with tempfile.TemporaryDirectory(prefix="feedwright-soak-models-") as folder:
        folder = pathlib.Path(folder)
        folder.chmod(0o755)
        models(folder)
        for number in [args.session] if args.session is not None else iter(lambda: done["sessions"], None):
            if time.monotonic() >= end:
                break
            name, counts, periods, wrong = session(folder, done["seed"], number, args.keep)
            totals = {what: totals.get(what, 0) + counts.get(what, 0) for what in {*totals, *counts}}
            done["sessions"], done["periods"] = number + 1, done["periods"] + periods
            done["wrong"] += [f"session {number}, {name}: {what}" for what in wrong[:5]]
            print(f"session {number}: {name}: {periods} servo periods, {sum(counts.values())} actions{'' if not wrong else f', {len(wrong)} WRONG'}", flush=True)
            for what in wrong[:5]:
                print(f"    {what}", flush=True)
            if args.resume:
                args.resume.write_text(json.dumps(done, indent=1) + "\n")
    print(f"seed {done['seed']}, {done['sessions']} sessions, {done['periods']} servo periods: {', '.join(f'{what} {totals[what]}' for what in sorted(totals))}")
    print("everything held" if not done["wrong"] else f"{len(done['wrong'])} did not hold")
    return 1 if done["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
