#!/usr/bin/env python3
"""Programs of `feedwright correct --log` in a real LinuxCNC, without any live correction, from a machine file with wrong values.

    learned.py [PART ...]

The original is cut and logged, corrected by the wrong file, corrected by that file and the log, and corrected by it and the logs of both. Errors
are to the original path. Exit code 1 where a part keeps more than a tenth of its RMS and 0.3 um after one log, or gets worse.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import corrected
import headless
import measure
import programs

# What is wrong in the machine file; the machine that is simulated is tnv40.
WRONG = corrected.MACHINE.replace("[axis.x]", "[axis.x]\nkp_1_s = 45\ninertia_kg_m2 = 0.0124").replace(
    "[axis.y]", "[axis.y]\nkv_nm_s_per_rad = 1.65\nkp_1_s = 57")
# Of the original's RMS, and um beside.
MOST, MOST_UM = 0.1, 0.3


def write_log(recording, path):
    """The recording as a log: commands of LinuxCNC and positions of the tool, which are those of the encoders on tnv40, from 0.3 s before the first cut to 0.3 s behind the last."""
    rows = recording.rows
    cuts = [row.motion_type in (2, 3) for row in rows]
    begin, end = cuts.index(True), len(cuts) - cuts[::-1].index(True)
    with open(path, "w", encoding="utf-8") as log:
        log.write("t_s," + ",".join(f"{axis}.cmd,{axis}.act" for axis in "xy") + "\n")
        for k in range(max(begin - 300, 0), min(end + 300, len(rows))):
            cells = (f"{position:.6f}" for i in range(2) for position in (rows[k].command[i], rows[k].tool[i]))
            log.write(f"{1e-3 * k:.3f},{','.join(cells)}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", default=["circle", "star", "square"])
    args = parser.parse_args()
    missed = 0
    with tempfile.TemporaryDirectory(prefix="feedwright-learned-") as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        machine, block = folder / "wrong.toml", folder / "machine.fwmodel"
        machine.write_text(WRONG)
        subprocess.run([headless.FEEDWRIGHT, "--quiet", "block", "tnv40", "--axes", "3", "--out", block], check=True, stdout=subprocess.DEVNULL)
        print(f"{'program':8} {'original, um':>16} {'no log':>16} {'one log':>16} {'two logs':>16}")
        for part in args.parts:
            source = programs.PARTS / f"{part}.ngc"
            original = programs.with_rests(source.read_text())

            def cut(text, log=None):
                recording = headless.run("cut", {"program": text, "enable": False}, {"FEEDWRIGHT": {"MACHINE": block, "MODEL": block}})
                if log:
                    write_log(recording, log)
                return measure.figures(recording, original).programmed

            def correct(out, *logs):
                words = ["correct", source, "--machine", machine, "--for", "linuxcnc", "--file-error", "0", "--out", out, *(word for log in logs for word in ("--log", log))]
                done = subprocess.run([headless.FEEDWRIGHT, "--quiet", *map(str, words)], check=False, capture_output=True, text=True)
                print(done.stdout if logs else "", done.stderr, sep="", file=sys.stderr)
                return programs.with_rests(out.read_text()) if out.exists() else None

            figures = [cut(original, folder / "cut0.csv")]
            best = original
            for number, logs in enumerate(([], [folder / "cut0.csv"], [folder / "cut0.csv", folder / "cut1.csv"])):
                text = correct(folder / f"{part}{number}.ngc", *logs)
                best = text or best
                figures.append(cut(best, folder / "cut1.csv" if number == 1 else None))
                best = original if number == 0 else best
            was, _, one, two = figures
            ok = one[0] <= MOST * was[0] + MOST_UM and two[0] <= one[0] + measure.NO_WORSE_UM[0]
            missed += not ok
            print(f"{part:8}", *(f"{rms:>8.2f} / {most:<5.2f}" for rms, most in figures), "" if ok else "MISSED", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
