#!/usr/bin/env python3
"""Re-simulates a trace from the machine file and its cmd columns alone; needs Python 3.11 and nothing else.

    resimulate.py MACHINE.toml TRACE.csv [FINER]

Prints the largest difference from the act columns in nm, per axis, with its limit; exit code 1 where it is above. Written
from the laws below, not from the program's source. Once a servo period Ts, x the position as it is measured:

    e = 2 pi (cmd - x) / lead;  w_ref = Kp e + Kd (e - e_prev) / Ts

Once a mechanics period, with the w_ref that left the position loop a delay ago (0 before the first):

    u = clamp(Kv (w_ref - w), +-limit), the nearest of 2^bits steps over the range where the drive has bits

A rigid axis: J dw/dt = u - L(w). With a transmission motor and table are two masses, Jt = share J and Jm = J - Jt, and the
tool is the table (Altintas 2012, section 5; Nordin and Gutman 2002, eq. 4):

    Jm dwm/dt = u - T;  Jt dwt/dt = T - L(wt);  k = Jt (2 pi f)^2;  c = 2 zeta Jt 2 pi f
    beyond half the backlash T = k (twist that is left) + c (wm - wt), where it pushes the flanks together; 0 otherwise

    L(w) = B w + Fc tanh(w / ws) + D sin(2 pi f t)

Semi-implicit Euler, every mass's speed and then its angle, t at the start of the step; the axis starts at rest at the first
cmd. x is that of the motor, or of the table where the scale is there, in whole encoder steps. Where t_s jumps, in a long rest,
everything stays but t.

FINER divides the step of the mechanics, and of nothing else, by this number; the difference is then what the integration
adds to the laws, and its limit another one: see limit_nm.
"""
import csv
import math
import pathlib
import sys
import tomllib

BUILT_IN = pathlib.Path(__file__).resolve().parents[3] / "machines"

# At the same step nothing differs but the last bits of sine, tanh and sums: some 1e-6 nm. It stays so where the
# machine does not amplify them: friction grows with the speed everywhere, so two runs draw near to each other and no choice
# between sticking and sliding hangs on a last bit; an encoder or torque step turns a last bit into something large where
# a value lies within some 1e-12 of the middle between two steps, and the millions of values of a test do not. What would
# amplify them is a limit cycle of flanks that strike each other, with backlash inside a position loop that chatters.
SAME_STEP_NM = 1.0


def upon(base, own):
    """A table, upon that of the same name in the base."""
    merged = dict(base)
    for key, value in own.items():
        is_table = isinstance(value, dict) and isinstance(base.get(key), dict)
        merged[key] = upon(base[key], value) if is_table else value
    return merged


def machine_of(file):
    own = tomllib.loads(file.read_text(encoding="utf-8"))
    if "base" not in own:
        return own
    # A base is a machine of the project by its name, or a file beside this one.
    project = BUILT_IN / (own["base"] + ".toml")
    return upon(machine_of(project if project.exists() else file.parent / own["base"]), own)


def stepped(value, step):
    """The nearest whole number of steps; a tie away from zero."""
    return math.copysign(math.floor(abs(value) / step + 0.5), value) * step if step > 0 else value


def pushed(stiffness, damping, gap, twist, twist_speed):
    """Torque through the screw: flanks touch beyond half the gap, push, and never pull."""
    side = math.copysign(1.0, twist)
    pressed = abs(twist) - gap / 2
    return side * max(0.0, stiffness * pressed + damping * side * twist_speed) if pressed > 0 else 0.0


def cut(axis, period, times_s, commands_mm, finer):
    """Where the tool is at the end of each servo period, mm, and its largest acceleration, mm/s2."""
    servo = period["servo_s"]
    substeps = round(servo / period["mechanics_s"])
    dt = servo / substeps / finer
    per_mm = 2 * math.pi / axis["lead_mm_per_rev"]
    kp, kd, kv, limit = axis["kp_1_s"], axis["kd"], axis["kv_nm_s_per_rad"], axis["torque_limit_nm"]
    viscous, coulomb, smoothing = (
        axis["viscous_friction_nm_s"], axis["coulomb_friction_nm"], axis["coulomb_smoothing_rad_s"]
    )
    disturbance, turn = axis["disturbance_nm"], 2 * math.pi * axis["disturbance_hz"]
    encoder_step = axis.get("encoder_step_um", 0) * 1e-3 * per_mm
    torque_step = 2 * limit / 2 ** axis["torque_bits"] if "torque_bits" in axis else 0
    late = round(axis.get("drive_delay_s", 0) / period["mechanics_s"])
    screw = axis.get("transmission")
    inertia = axis["inertia_kg_m2"]
    if screw:
        table = screw["table_share"] * inertia
        motor = inertia - table
        natural = 2 * math.pi * screw["resonance_hz"]
        stiffness, damping = table * natural**2, 2 * screw["damping_ratio"] * table * natural
        gap = screw["backlash_um"] * 1e-3 * per_mm
        scale_on_table = screw.get("scale_on_table", 0) > 0.5

    angle = tool = commands_mm[0] * per_mm
    speed = tool_speed = last_error = largest = 0.0
    references, positions_mm = [], []
    for n, (time_s, command_mm) in enumerate(zip(times_s, commands_mm)):
        start = round(time_s / servo) * servo
        measured = stepped(tool if screw and scale_on_table else angle, encoder_step)
        error = command_mm * per_mm - measured
        references.append(kp * error + kd * (error - last_error) / servo)
        last_error = error
        for i in range(substeps):
            sent = (n * substeps + i - late) // substeps
            reference = references[sent] if sent >= 0 else 0.0
            torque = stepped(max(-limit, min(limit, kv * (reference - speed))), torque_step)
            for j in range(finer):
                t = start + (i * finer + j) * dt
                load = (
                    viscous * tool_speed
                    + coulomb * math.tanh(tool_speed / smoothing)
                    + disturbance * math.sin(turn * t)
                )
                if screw:
                    through = pushed(stiffness, damping, gap, angle - tool, speed - tool_speed)
                    acceleration = (through - load) / table
                    speed += dt * (torque - through) / motor
                    tool_speed += dt * acceleration
                    angle += dt * speed
                    tool += dt * tool_speed
                else:
                    acceleration = (torque - load) / inertia
                    speed += dt * acceleration
                    angle += dt * speed
                    tool, tool_speed = angle, speed
                largest = max(largest, abs(acceleration))
        positions_mm.append(tool / per_mm)
    return positions_mm, largest / per_mm


def limit_nm(axis, period, largest_mm_s2, finer):
    """What the tool may be off.

    A step of semi-implicit Euler goes a dt^2 / 2 too far at acceleration a, as if there were a speed of a dt / 2 more; the
    position loop holds against a speed v by v / Kp. With the step divided by FINER, the rest of it is left:

        a dt / (2 Kp) (1 - 1 / FINER)

    for a loop that does not overshoot (its speed bandwidth Kv / J is four times Kp) and whose torque is not at its limit. Where the runs differ at all, a line of the
    encoder is crossed in another servo period and a step of torque made in another mechanics period: a measurement off by
    an encoder step moves the tool by no more, a torque off by a step q by no more than q / (Kv Kp).
    """
    if finer == 1:
        return SAME_STEP_NM
    kp, kv = axis["kp_1_s"], axis["kv_nm_s_per_rad"]
    torque_step = 2 * axis["torque_limit_nm"] / 2 ** axis["torque_bits"] if "torque_bits" in axis else 0
    integration_mm = largest_mm_s2 * period["mechanics_s"] / (2 * kp) * (1 - 1 / finer)
    steps_mm = axis.get("encoder_step_um", 0) * 1e-3 + torque_step / (kv * kp) * axis["lead_mm_per_rev"] / (2 * math.pi)
    return (integration_mm + steps_mm) * 1e6


def main(machine_file, trace_file, finer="1"):
    machine = machine_of(pathlib.Path(machine_file))
    with open(trace_file, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    times_s = [float(row["t_s"]) for row in rows]
    period, finer = machine["period"], int(finer)
    holds = True
    for name in "xyz":
        if f"cmd_{name}_mm" in rows[0]:
            axis = machine["axis"][name]
            commands_mm, actual_mm = ([float(row[f"{of}_{name}_mm"]) for row in rows] for of in ("cmd", "act"))
            tool_mm, largest_mm_s2 = cut(axis, period, times_s, commands_mm, finer)
            differences_nm = [abs(tool - actual) * 1e6 for tool, actual in zip(tool_mm, actual_mm)]
            limit = limit_nm(axis, period, largest_mm_s2, finer)
            print(f"{name}: {max(differences_nm):.6f} nm over {len(rows)} servo periods, limit {limit:.0f} nm")
            # One by one: what is not a number holds no limit.
            holds = holds and all(difference <= limit for difference in differences_nm)
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:4]))
