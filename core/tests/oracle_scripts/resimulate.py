#!/usr/bin/env python3
"""Re-simulates a trace from the machine file and its cmd columns alone; needs Python 3.11 and nothing else.

    resimulate.py MACHINE.toml TRACE.csv

Prints the largest difference from the act columns in nm, per axis; exit code 1 where it is above 1 nm. Written from the
servo law, not from the program's source:

    e = 2 pi (cmd - x) / lead;  w_ref = Kp e + Kd (e - e_prev) / Ts, held for one servo period
    u = clamp(Kv (w_ref - w), +-limit);  J dw/dt = u - B w - Fc tanh(w / ws) - D sin(2 pi f t)
    semi-implicit Euler, t at the start of each mechanics period; the axis starts at rest at the first cmd
"""
import csv
import math
import sys
import tomllib

LIMIT_NM = 1.0


def largest_difference_nm(axis, period, rows, name):
    substeps = round(period["servo_s"] / period["mechanics_s"])
    dt = period["servo_s"] / substeps
    per_mm = 2 * math.pi / axis["lead_mm_per_rev"]
    start = float(rows[0][f"cmd_{name}_mm"])
    angle, speed, last_error = start * per_mm, 0.0, 0.0
    largest = 0.0
    for n, row in enumerate(rows):
        error = float(row[f"cmd_{name}_mm"]) * per_mm - angle
        reference = axis["kp_1_s"] * error + axis["kd"] * (error - last_error) / period["servo_s"]
        last_error = error
        for i in range(substeps):
            t = n * period["servo_s"] + i * dt
            limit = axis["torque_limit_nm"]
            torque = max(-limit, min(limit, axis["kv_nm_s_per_rad"] * (reference - speed)))
            load = (
                axis["viscous_friction_nm_s"] * speed
                + axis["coulomb_friction_nm"] * math.tanh(speed / axis["coulomb_smoothing_rad_s"])
                + axis["disturbance_nm"] * math.sin(2 * math.pi * axis["disturbance_hz"] * t)
            )
            speed += dt / axis["inertia_kg_m2"] * (torque - load)
            angle += dt * speed
        largest = max(largest, abs(angle / per_mm - float(row[f"act_{name}_mm"])) * 1e6)
    return largest


def main(machine_file, trace_file):
    with open(machine_file, "rb") as file:
        machine = tomllib.load(file)
    with open(trace_file, newline="") as file:
        rows = list(csv.DictReader(file))
    worst = 0.0
    for name in "xyz":
        if f"cmd_{name}_mm" in rows[0]:
            difference = largest_difference_nm(machine["axis"][name], machine["period"], rows, name)
            print(f"{name}: {difference:.6f} nm over {len(rows)} servo periods")
            worst = max(worst, difference)
    return 0 if worst <= LIMIT_NM else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
