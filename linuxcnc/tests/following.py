#!/usr/bin/python3
"""What drives and LinuxCNC have to allow where the component stands between them: following errors, speeds and accelerations of each joint.

    following.py --machine MACHINE.fwmodel[:MODEL.fwmodel] [--only NAME]

Columns: MIN_FERROR that the program needs with FERROR as in the configuration, FERROR that it needs with the MIN_FERROR of the configuration, the
largest distance of a drive's position from its command, mm, the highest speed of a drive's command, mm/s, and the largest change of that speed, mm/s2.
Exit code 1 where the configuration allows less than a program needs.
"""
import argparse
import pathlib
import sys

import headless
import measure
import programs

# As in the configuration: mm, and mm/s for FERROR.
FERROR_MM, MIN_FERROR_MM, MAX_MM_S = 10.0, 3.0, 200.0
RAPIDS = "G21 G17 G90 G94 MODE\nG0 X-2\nG4 P0.3\n" + "G0 X60 Y30 Z-20\nG4 P0.3\nG0 X0 Y0 Z0\nG4 P0.3\nG0 X60\nG0 Y60\nG0 X0\nG0 Y0\nG4 P0.3\n" + "M2\n"
WAYS = {"direct": {"feedwright.direct": 1}, "delayed": {"feedwright.enable": 0},
        "delayed by 15 ms": {"feedwright.enable": 0, "feedwright.delay": 0.015}, "corrected": {}}


def needs(rows, period_s):
    """The columns, over all joints."""
    least = ferror = window = speed = change = 0.0
    for before, last, row in zip(rows, rows[1:], rows[2:]):
        for i in range(3):
            mm_s = abs(row.command[i] - last.command[i]) / period_s
            off = abs(row.command[i] - row.feedback[i])
            if off > FERROR_MM * mm_s / MAX_MM_S:
                least = max(least, off)
            if off > MIN_FERROR_MM:
                ferror = max(ferror, off * MAX_MM_S / max(mm_s, 1e-9))
            # The drive's own: its position is the feedback, less what the delay makes of it.
            window = max(window, abs(row.correction[i] + row.command[i] - row.feedback[i]))
            steps = [(b.drive[i] - a.drive[i]) / period_s for a, b in ((before, last), (last, row))]
            speed, change = max(speed, abs(steps[1])), max(change, abs(steps[1] - steps[0]) / period_s)
    return least, ferror, window, speed, change


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", required=True, help="MACHINE.fwmodel[:MODEL.fwmodel]")
    parser.add_argument("--only", default="", help="programs whose name begins so")
    args = parser.parse_args()
    files = [str(pathlib.Path(file).resolve()) for file in args.machine.split(":")]
    ini = {"FEEDWRIGHT": {"MACHINE": files[0], "MODEL": files[-1]}}
    period_s, missed = measure.servo_s(files[0]), 0
    print("| program | command | MIN_FERROR mm | FERROR mm | drive's window mm | speed mm/s | acceleration mm/s2 |\n|---|---|--:|--:|--:|--:|--:|")
    for name, program in [*((f"rapids {mode}", RAPIDS.replace("MODE", mode)) for mode in ("G61", "G64")), *((name, text) for name, text, _ in programs.programs(True))]:
        for way, params in WAYS.items():
            if not name.startswith(args.only):
                continue
            enable = params.get("feedwright.enable", 1)
            recording = headless.run("cut", {"program": program, "params": params, "enable": enable}, ini)
            least, ferror, window, speed, change = needs(recording.rows, period_s)
            missed += least > MIN_FERROR_MM or ferror > FERROR_MM or bool(recording.result["messages"])
            print(f"| {name} | {way} | {least:.2f} | {ferror:.2f} | {window:.2f} | {speed:.0f} | {change:.0f} |", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
