#!/usr/bin/env python3
"""Re-simulates a trace from the machine file and its cmd columns alone; needs Python 3.11 and nothing else.

    resimulate.py MACHINE.toml TRACE.csv [FINER [SEED [GEOMETRY.toml]]]

Prints the largest difference from the act columns in nm, per axis, with its limit; exit code 1 where it is above. Written
from the laws below, not from the program's source. A key that a machine file leaves out is zero, and the term with it is not there.

Once a servo period Ts, c the command that was sent round(command_delay_s / Ts) servo periods ago, the start before that, and x the
position as it is measured, both in rad of the motor, v = (c - c_prev) / Ts, 0 in the first:

    e = c - x;  w_ref = Kp e + Kd (e - e_prev) / Ts + velocity_feedforward v
    u_ff = acceleration_feedforward J (v - v_prev) / Ts

Both reach the drive drive_delay_s later, and floor(r (m + 1)) mechanics periods beyond that, r a uniform random number of the servo
period, m = jitter_s in mechanics periods; the drive goes by the newest that has come. Once a mechanics period dt, w the motor's speed,
or the difference of its encoder over dt where the drive takes it from there (0 in the first):

    d = (w_ref within the speed limit) - w
    I' = I + Kv d dt / speed_integral_s, unless |Kv d + u_ff + I'| is above the limit and its sign that of d: then I' = I
    y += (1 - exp(-2 pi torque_filter_hz dt)) (clamp(Kv d + u_ff + I', +-limit) - y)
    u = the nearest of 2^bits steps over the range to y, where the drive has bits
    motor torque: u (1 + ripple sin(ripple_per_rev th)) + cogging sin(cogging_per_rev th + cogging_phase_rad)

A rigid axis: J dw/dt = motor torque - L - F(w). With a transmission motor and table are two masses, Jt = share J and Jm = J - Jt, and
the tool is the table (Altintas 2012, section 5; Nordin and Gutman 2002, eq. 4):

    Jm dwm/dt = motor torque - T;  Jt dwt/dt = T - L - F(wt);  k = Jt (2 pi f)^2;  c = 2 zeta Jt 2 pi f
    beyond half the backlash T = k (twist that is left) + c (wm - wt), where it pushes the flanks together; 0 otherwise

    L = D sin(2 pi f t + psi) + torque noise;  psi grows by 2 pi f Ts wander in each servo period, evenly over it

Friction, d the direction of motion, g(w, d) = Fc + Fa d + Fs exp(-(w / stribeck)^2):

    F = B w + tanh(w / ws) g(w, tanh(w / ws)) without presliding; with it (Dahl 1968; Canudas de Wit et al. 1995 without damping of
    the bristles) F = B w + f, a spring S = (Fc + Fs) / presliding that gives way towards g; a step, forces P = all but F:

    a = w + dt / J (P - B w - f);  d = sgn a;  w' = a / (1 + dt^2 S max(0, 1 - f d / g) / J)
    f' = d g + (f - d g) exp(-S |w'| dt / g)

Semi-implicit Euler, every mass's speed and then its angle, t at the start of the step; the axis starts at rest at the
first path point. What an encoder shows of an angle: interpolation error A sin(2 pi x / signal period + interpolation_phase_rad) and white noise added, in whole steps; x is the
motor's, or the table's where the scale is there, measurement_delay_s ago. Where t_s jumps, in a long rest, everything stays but t.

The tool is where the geometry puts it: joint + scale joint + pitch_error sin(2 pi joint / lead), and of squareness x += xy y + xz z,
y += yz z of the joints. Where `corrected` is not `cmd`, the run compensated the geometry of the machine file, or of GEOMETRY.toml, and
the joints start where it brings the tool onto the path. With backlash that its encoders do not see, the geometry of a machine file is not
compensated: only lost motion is, and at the start there is none.

Random numbers: SplitMix64 (Steele, Lea and Flood 2014) with a state of its own for each axis and purpose, its output number n at
moment n; a uniform number is its upper 53 bits, a normal one the sum of the twelve 16-bit parts of the outputs 3n to 3n + 2, less
393,210, divided by 65,536. Correlated noise is an Ornstein-Uhlenbeck process with its exact step.

FINER divides the step of the mechanics, and of nothing else, by this number; the difference is then what the integration
adds to the laws, and its limit another one: see limit_nm.
"""
import csv
import math
import pathlib
import sys
import tomllib

BUILT_IN = pathlib.Path(__file__).resolve().parents[3] / "sim" / "machines"

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


MASK = 2**64 - 1
GAMMA = 0x9E3779B97F4A7C15
# What a stream of random numbers is for.
ENCODER, MOTOR_ENCODER, TORQUE, WANDER, JITTER = range(5)
# Correlation time of the disturbance's frequency.
WANDER_S = 1.0


def splitmix(seed, n):
    z = (seed + GAMMA * (n + 1)) & MASK
    z = ((z ^ z >> 30) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ z >> 27) * 0x94D049BB133111EB) & MASK
    return z ^ z >> 31


class Stream:
    def __init__(self, seed, axis, purpose):
        self.key = splitmix(seed, 16 * axis + purpose)

    def uniform(self, n):
        return (splitmix(self.key, n) >> 11) / 2**53

    def normal(self, n):
        total = 0
        for output in (splitmix(self.key, 3 * n + k) for k in range(3)):
            total += sum(output >> shift & 0xFFFF for shift in (0, 16, 32, 48))
        return (total - 393210) / 65536


class Correlated:
    def __init__(self, stream, deviation, time_s, dt):
        self.stream = stream
        self.keep = math.exp(-dt / time_s) if time_s > 0 else 0.0
        self.add = deviation * math.sqrt(1 - self.keep**2)
        self.value = deviation * stream.normal(0)

    def next(self, n):
        self.value = self.keep * self.value + self.add * self.stream.normal(n + 1)
        return self.value


class Encoder:
    def __init__(self, axis, stream):
        rad = 1e-3 * 2 * math.pi / axis["lead_mm_per_rev"]
        self.step, self.noise = axis.get("encoder_step_um", 0) * rad, axis.get("encoder_noise_um", 0) * rad
        self.error, self.period = axis.get("interpolation_error_um", 0) * rad, axis.get("signal_period_um", 0) * rad
        self.phase = axis.get("interpolation_phase_rad", 0)
        self.stream = stream

    def read(self, angle, moment):
        shown = angle
        if self.error > 0:
            shown += self.error * math.sin(2 * math.pi / self.period * angle + self.phase)
        if self.noise > 0:
            shown += self.noise * self.stream.normal(moment)
        return stepped(shown, self.step)


class Friction:
    """One mechanics step of a mass with friction: its speed behind it."""

    def __init__(self, axis, dt):
        get = lambda key: axis.get(key, 0)
        rad = 2 * math.pi / axis["lead_mm_per_rev"]
        self.dt = dt
        self.viscous, self.coulomb = axis["viscous_friction_nm_s"], axis["coulomb_friction_nm"]
        self.smoothing, self.asymmetry = axis["coulomb_smoothing_rad_s"], get("coulomb_asymmetry_nm")
        self.more, self.over = get("stribeck_nm"), get("stribeck_mm_s") * rad
        deflection = get("presliding_um") * 1e-3 * rad
        self.spring = (self.coulomb + self.more) / deflection if deflection > 0 else 0.0
        self.f = 0.0

    def level(self, speed, direction):
        more = self.more * math.exp(-min(40.0, (speed / self.over) ** 2)) if self.more > 0 else 0.0
        return self.coulomb + self.asymmetry * direction + more

    def after(self, speed, forces, inertia):
        step = self.dt / inertia
        if self.spring == 0:
            sign = math.tanh(speed / self.smoothing)
            return speed + step * (forces - self.viscous * speed - sign * self.level(speed, sign))
        free = speed + step * (forces - self.viscous * speed - self.f)
        direction = math.copysign(1.0, free)
        # An asymmetry that leaves no friction at all in a direction would be divided by.
        level = max(self.level(speed, direction), 1e-9 * (self.coulomb + self.more))
        speed = free / (1 + step * self.dt * self.spring * max(0.0, 1 - self.f * direction / level))
        gone = math.exp(-min(40.0, self.spring * abs(speed) * self.dt / level))
        self.f = direction * level + (self.f - direction * level) * gone
        return speed


def stepped(value, step):
    """The nearest whole number of steps; a tie away from zero."""
    return math.copysign(math.floor(abs(value) / step + 0.5), value) * step if step > 0 else value


def pushed(stiffness, damping, gap, twist, twist_speed):
    """Torque through the screw: flanks touch beyond half the gap, push, and never pull."""
    side = math.copysign(1.0, twist)
    pressed = abs(twist) - gap / 2
    return side * max(0.0, stiffness * pressed + damping * side * twist_speed) if pressed > 0 else 0.0


class Drive:
    """What leaves the position loop, on its way, and the speed loop."""

    def __init__(self, axis, period, seed):
        get = lambda key: axis.get(key, 0)
        self.servo, self.dt = period["servo_s"], period["mechanics_s"]
        self.substeps = round(self.servo / self.dt)
        self.kp, self.kd, self.kv, self.limit = axis["kp_1_s"], axis["kd"], axis["kv_nm_s_per_rad"], axis["torque_limit_nm"]
        self.fv, self.fa = get("velocity_feedforward"), get("acceleration_feedforward") * axis["inertia_kg_m2"]
        self.fastest = get("speed_limit_mm_s") * 2 * math.pi / axis["lead_mm_per_rev"]
        self.ti, corner = get("speed_integral_s"), get("torque_filter_hz")
        self.filter = 1 - math.exp(-2 * math.pi * corner * self.dt) if corner else 1.0
        self.torque_step = 2 * self.limit / 2 ** axis["torque_bits"] if "torque_bits" in axis else 0
        self.late = round(get("drive_delay_s") / self.dt)
        self.jitter = round(get("jitter_s") / self.dt)
        self.stream = Stream(seed, 0, JITTER)
        self.sent = []
        self.last_error = self.last_speed = self.integral = self.filtered = 0.0
        self.last_command = None

    def send(self, command, measured, n, period):
        error = command - measured
        reference = self.kp * error + self.kd * (error - self.last_error) / self.servo
        speed = 0.0 if self.last_command is None else (command - self.last_command) / self.servo
        torque = self.fa * (speed - self.last_speed) / self.servo
        self.last_error, self.last_command, self.last_speed = error, command, speed
        more = math.floor(self.stream.uniform(period) * (self.jitter + 1)) if self.jitter else 0
        self.sent.append((n * self.substeps + self.late + more, reference + self.fv * speed, torque))

    def torque(self, now, speed):
        reference, forward = next(((r, u) for at, r, u in reversed(self.sent) if at <= now), (0.0, 0.0))
        if self.fastest:
            reference = max(-self.fastest, min(self.fastest, reference))
        error = reference - speed
        integral = self.integral + (self.kv * error * self.dt / self.ti if self.ti else 0.0)
        wanted = self.kv * error + forward
        if abs(wanted + integral) <= self.limit or (wanted + integral) * error <= 0:
            self.integral = integral
        limited = max(-self.limit, min(self.limit, wanted + self.integral))
        self.filtered += self.filter * (limited - self.filtered)
        return stepped(self.filtered, self.torque_step)


class Measuring:
    """What the control and the drive see of the angles."""

    def __init__(self, axis, period, seed, index, start):
        self.dt = period["mechanics_s"]
        self.encoder = Encoder(axis, Stream(seed, index, ENCODER))
        screw = axis.get("transmission")
        self.on_table = bool(screw) and screw.get("scale_on_table", 0) > 0.5
        self.of_motor = Encoder(axis, Stream(seed, index, MOTOR_ENCODER)) if self.on_table else self.encoder
        self.late = round(axis.get("measurement_delay_s", 0) / self.dt)
        self.by_encoder = axis.get("speed_from_encoder", 0) > 0.5
        self.held = axis.get("speed_held", 0) > 0.5
        self.periods = max(1.0, axis.get("speed_window_s", 0) / self.dt)
        self.substeps = round(period["servo_s"] / self.dt)
        self.start, self.taken, self.shown, self.seen = start, {}, {}, 0.0

    def position(self, n, substeps, motor, table, moment):
        """For the control at the start of the n-th servo period that is simulated."""
        if self.late == 0:
            return self.encoder.read(table if self.on_table else motor, moment)
        return self.taken.get(n * substeps - self.late, self.start)

    def speed(self, now, motor, speed, table, moment):
        """For the drive; and what is to reach the control is taken."""
        if self.late:
            self.taken[now] = self.encoder.read(table if self.on_table else motor, moment)
        if not self.by_encoder and not self.held and self.periods == 1.0:
            return speed
        self.shown[now] = self.of_motor.read(motor, moment) if self.by_encoder else motor
        if not self.held or now % self.substeps == 0:
            # The axis stands before the first; rounding as in the program, since steps of the encoder make much of little.
            at = lambda age: self.shown[max(now - age, 0)]
            whole = int(self.periods)
            part = self.periods - whole
            moved = at(0) - at(whole) + part * (at(whole) - at(whole + 1))
            self.seen = moved / ((whole + part) * self.dt)
        return self.seen


def cut(axis, index, period, seed, times_s, start_mm, commands_mm, finer):
    """Where the joint is at the end of each servo period, mm, and its largest acceleration, mm/s2."""
    servo = period["servo_s"]
    substeps = round(servo / period["mechanics_s"])
    dt = servo / substeps / finer
    per_mm = 2 * math.pi / axis["lead_mm_per_rev"]
    get = lambda key: axis.get(key, 0)
    disturbance, turn = axis["disturbance_nm"], 2 * math.pi * axis["disturbance_hz"]
    screw = axis.get("transmission")
    inertia = axis["inertia_kg_m2"]
    if screw:
        table = screw["table_share"] * inertia
        motor = inertia - table
        natural = 2 * math.pi * screw["resonance_hz"]
        stiffness, damping = table * natural**2, 2 * screw["damping_ratio"] * table * natural
        gap = screw["backlash_um"] * 1e-3 * per_mm

    angle = tool = start_mm * per_mm
    speed = tool_speed = largest = ahead = 0.0
    drive, friction = Drive(axis, period, seed), Friction(axis, dt)
    measuring = Measuring(axis, period, seed, index, angle)
    broadband = Correlated(
        Stream(seed, index, TORQUE), get("torque_noise_nm"), get("torque_noise_s"), period["mechanics_s"]
    )
    wander = Correlated(Stream(seed, index, WANDER), get("disturbance_wander"), WANDER_S, servo)
    bus = round(get("command_delay_s") / servo)
    positions_mm = []
    for n, time_s in enumerate(times_s):
        number = round(time_s / servo)
        start = number * servo
        measured = measuring.position(n, substeps, angle, tool, number * substeps)
        arrived_mm = commands_mm[n - bus] if n >= bus else start_mm
        drive.send(arrived_mm * per_mm, measured, n, number)
        faster = turn * wander.next(number) if get("disturbance_wander") else 0.0
        for i in range(substeps):
            now, moment = n * substeps + i, number * substeps + i
            torque = drive.torque(now, measuring.speed(now, angle, speed, tool, moment))
            noise = broadband.next(moment) if get("torque_noise_nm") else 0.0
            for j in range(finer):
                t = start + (i * finer + j) * dt
                load = disturbance * math.sin(turn * t + ahead + faster * (t - start)) + noise
                driving = torque * (1 + get("ripple") * math.sin(get("ripple_per_rev") * angle))
                driving += get("cogging_nm") * math.sin(get("cogging_per_rev") * angle + get("cogging_phase_rad"))
                before = tool_speed
                if screw:
                    through = pushed(stiffness, damping, gap, angle - tool, speed - tool_speed)
                    speed += dt * (driving - through) / motor
                    tool_speed = friction.after(tool_speed, through - load, table)
                    angle += dt * speed
                    tool += dt * tool_speed
                else:
                    speed = friction.after(speed, driving - load, inertia)
                    angle += dt * speed
                    tool, tool_speed = angle, speed
                largest = max(largest, abs(tool_speed - before) / dt)
        ahead += faster * servo
        positions_mm.append(tool / per_mm)
    return positions_mm, largest / per_mm


def tools_mm(machine, joints_mm):
    """Where the tool is, axis by axis, of where the joints are, by a machine file or a geometry file."""
    geometry = machine.get("geometry", {})
    square = {pair: geometry.get(f"squareness_{pair}_urad", 0) * 1e-6 for pair in ("xy", "xz", "yz")}
    tools = {}
    for name, joint_mm in joints_mm.items():
        axis = machine["axis"].get(name, {})
        if any(key == "table" or key.startswith("straightness_") and key[-1] in "xyz" for key in axis):
            sys.exit(f"axis {name}: this script knows no tables")
        scale, pitch = axis.get("scale_um_m", 0) * 1e-6, axis.get("pitch_error_um", 0) * 1e-3
        turn, phase = 2 * math.pi / axis.get("lead_mm_per_rev", 1), math.radians(axis.get("pitch_phase_deg", 0))
        tools[name] = [at + scale * at + pitch * math.sin(turn * at + phase) for at in joint_mm]
        for other in "yz":
            if other in joints_mm and name + other in square:
                tools[name] = [at + square[name + other] * by for at, by in zip(tools[name], joints_mm[other])]
    return tools


def has_hidden_backlash(machine):
    screws = [axis.get("transmission", {}) for axis in machine["axis"].values()]
    return any(screw.get("backlash_um", 0) > 0 and screw.get("scale_on_table", 0) < 0.5 for screw in screws)


def starts_mm(machine, geometry, tool_mm, rows):
    """Where the joints rest at the start: with the tool at the first point of the path, if a geometry is compensated."""
    joints_mm = dict(tool_mm)
    if geometry is None and has_hidden_backlash(machine):
        return joints_mm
    if all(row[f"cmd_{name}_mm"] == row[f"corrected_{name}_mm"] for row in rows for name in tool_mm):
        return joints_mm
    for _ in range(20):
        reached = tools_mm(geometry or machine, {name: [at] for name, at in joints_mm.items()})
        joints_mm = {name: at + tool_mm[name] - reached[name][0] for name, at in joints_mm.items()}
    return joints_mm


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


def main(machine_file, trace_file, finer="1", seed=None, geometry_file=None):
    machine = machine_of(pathlib.Path(machine_file))
    geometry = tomllib.loads(pathlib.Path(geometry_file).read_text(encoding="utf-8")) if geometry_file else None
    with open(trace_file, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    times_s = [float(row["t_s"]) for row in rows]
    period, finer = machine["period"], int(finer)
    seed = machine.get("noise", {}).get("seed", 0) if seed is None else int(seed)
    column = lambda of, name: [float(row[f"{of}_{name}_mm"]) for row in rows]
    names = [name for name in "xyz" if f"cmd_{name}_mm" in rows[0]]
    start_mm = starts_mm(machine, geometry, {name: column("path", name)[0] for name in names}, rows)
    cuts = {
        name: cut(machine["axis"][name], "xyz".index(name), period, seed, times_s, start_mm[name], column("cmd", name), finer)
        for name in names
    }
    tools = tools_mm(machine, {name: joint_mm for name, (joint_mm, _) in cuts.items()})
    holds = True
    for name, tool_mm in tools.items():
        differences_nm = [abs(tool - actual) * 1e6 for tool, actual in zip(tool_mm, column("act", name))]
        limit = limit_nm(machine["axis"][name], period, cuts[name][1], finer)
        print(f"{name}: {max(differences_nm):.6f} nm over {len(rows)} servo periods, limit {limit:.0f} nm")
        # One by one: what is not a number holds no limit.
        holds = holds and all(difference <= limit for difference in differences_nm)
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:6]))
