"""Gains and closed-loop error of a linear-quadratic-Gaussian controller of one axis, from a machine file alone.

    python3 lqg.py MACHINE.toml axis control_weight_s2

prints, as JSON, the stationary gains of the Kalman filter and of the regulator, and the RMS of the position in the closed loop, um, at the
servo periods. Written from the equations; it shares nothing with the program, which iterates the Riccati equation of eight states by
steps: here integral and filter are no states (the machine is to have neither), and the equation is solved by doubling, which squares the
number of steps each time (Chu, Fan, Lin and Wang 2004, "Structure-preserving algorithms for periodic discrete-time algebraic Riccati
equations", Int. J. Control 77).

State: x, w (rad, rad/s of the motor), n (broadband torque), p, q (disturbance and its quadrature), d (random walk), N m.
In a mechanics period dt, under a reference speed v:
    w' = w + dt / J (Kv (v - w) - B w - n - p - d),   x' = x + dt w'
Behind a ball screw that gives, with xt, wt of the table as two states more, k its stiffness and c its damping, it is the table that costs:
    T = k (x - xt) + c (w - wt),   w' = w + dt / Jm (Kv (v - w) - T),   wt' = wt + dt / Jt (T - B wt - n - p - d)
    n' = e^(-dt / tn) n,   (p, q)' = e^(-dt / tm) turned by 2 pi f dt,   d' = d
"""

import json
import math
import pathlib
import sys
import tomllib

MACHINES = pathlib.Path(__file__).parents[3] / "sim" / "machines"
DOUBLINGS = 20
# As the controller documents them.
LONGEST_MEMORY_S = 10.0
DRIFT_SHARE = 0.003


def load(path):
    with open(path, "rb") as file:
        machine = tomllib.load(file)
    if "base" not in machine:
        return machine
    base = load(MACHINES / (machine["base"] + ".toml"))
    for name, axis in machine.get("axis", {}).items():
        base["axis"][name].update(axis)
    base["period"].update(machine.get("period", {}))
    return base


def zeros(rows, columns):
    return [[0.0] * columns for _ in range(rows)]


def eye(size):
    return [[float(i == j) for j in range(size)] for i in range(size)]


def mul(a, b):
    columns = list(zip(*b))
    return [[sum(x * y for x, y in zip(row, column)) for column in columns] for row in a]


def add(a, b, factor=1.0):
    return [[x + factor * y for x, y in zip(p, q)] for p, q in zip(a, b)]


def scale(a, factor):
    return [[factor * x for x in row] for row in a]


def turn(a):
    return [list(column) for column in zip(*a)]


def solve(a, b):
    """a^-1 b by elimination with pivots."""
    size = len(a)
    rows = [list(p) + list(q) for p, q in zip(a, b)]
    for k in range(size):
        pivot = max(range(k, size), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(size):
            if i != k and rows[i][k] != 0.0:
                factor = rows[i][k]
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k])]
    return [row[size:] for row in rows]


def riccati(a, g, h):
    """X = A' X (I + G X)^-1 A + H, by doubling."""
    for _ in range(DOUBLINGS):
        w = add(eye(len(a)), mul(g, h))
        wa, wg = solve(w, a), solve(w, g)
        a, g, h = mul(a, wa), add(g, mul(a, mul(wg, turn(a)))), add(h, mul(turn(a), mul(h, wa)))
        g, h = scale(add(g, turn(g)), 0.5), scale(add(h, turn(h)), 0.5)
    return h


def lyapunov(f, q):
    """Covariance of z' = F z + noise of covariance Q, after 2^DOUBLINGS steps from rest."""
    for _ in range(DOUBLINGS):
        q, f = add(q, mul(f, mul(q, turn(f)))), mul(f, f)
    return q


class Axis:
    def __init__(self, machine, name):
        axis, period = machine["axis"][name], machine["period"]
        assert not any(axis.get(key) for key in ("speed_integral_s", "torque_filter_hz", "command_delay_s", "drive_delay_s", "measurement_delay_s"))
        self.dt = period["mechanics_s"]
        self.substeps = round(period["servo_s"] / self.dt)
        self.rad = 2.0 * math.pi / axis["lead_mm_per_rev"]
        self.kv, self.inertia = axis["kv_nm_s_per_rad"], axis["inertia_kg_m2"]
        self.viscous, self.coulomb = axis["viscous_friction_nm_s"], axis["coulomb_friction_nm"]
        self.noise_rad = axis.get("encoder_noise_um", 0.0) * 1e-3 * self.rad
        self.torque, self.torque_s = axis.get("torque_noise_nm", 0.0), axis.get("torque_noise_s", 0.0)
        self.swing, self.omega = axis["disturbance_nm"], 2.0 * math.pi * axis["disturbance_hz"]
        wander = axis.get("disturbance_wander", 0.0) * self.omega
        self.screw = axis.get("transmission")
        self.size = 8 if self.screw else 6
        self.table = 6 if self.screw else 0
        self.memory_s = min(1.0 / wander, LONGEST_MEMORY_S) if wander else LONGEST_MEMORY_S

    def substep(self):
        dt, j = self.dt, self.dt / self.inertia
        speed = [0.0, 1.0 - j * (self.kv + self.viscous), -j, -j, 0.0, -j]
        place = [float(i == 0) + dt * s for i, s in enumerate(speed)]
        keep = math.exp(-dt / self.memory_s)
        cos, sin = keep * math.cos(self.omega * dt), keep * math.sin(self.omega * dt)
        forget = math.exp(-dt / self.torque_s) if self.torque_s else 0.0
        a = [
            place,
            speed,
            [0.0, 0.0, forget, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, cos, sin, 0.0],
            [0.0, 0.0, 0.0, -sin, cos, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ]
        b = [[dt * j * self.kv], [j * self.kv], [0.0], [0.0], [0.0], [0.0]]
        return self.two_masses(a) if self.screw else (a, b)

    def two_masses(self, one):
        dt, table = self.dt, self.inertia * self.screw["table_share"]
        omega = 2.0 * math.pi * self.screw["resonance_hz"]
        k, c = table * omega**2, 2.0 * self.screw["damping_ratio"] * table * omega
        jm, jt = dt / (self.inertia - table), dt / table
        # x, w, n, p, q, d, xt, wt
        speed = [-jm * k, 1.0 - jm * (self.kv + c), 0.0, 0.0, 0.0, 0.0, jm * k, jm * c]
        of_table = [jt * k, jt * c, -jt, -jt, 0.0, -jt, -jt * k, 1.0 - jt * (c + self.viscous)]
        place = [float(i == 0) + dt * s for i, s in enumerate(speed)]
        place_of_table = [float(i == 6) + dt * s for i, s in enumerate(of_table)]
        a = [place, speed] + [row + [0.0, 0.0] for row in one[2:]] + [place_of_table, of_table]
        b = [[dt * jm * self.kv], [jm * self.kv]] + [[0.0] for _ in range(6)]
        return a, b

    def noise(self, drift):
        q = zeros(self.size, self.size)
        fresh = 1.0 - math.exp(-2.0 * self.dt / self.torque_s) if self.torque_s else 1.0
        q[2][2] = self.torque**2 * fresh
        q[3][3] = q[4][4] = 0.5 * self.swing**2 * (1.0 - math.exp(-2.0 * self.dt / self.memory_s))
        q[5][5] = (DRIFT_SHARE * (self.coulomb + self.swing)) ** 2 * self.dt if drift else 0.0
        return q

    def sampled(self, drift):
        """Over a servo period: A, b, Q, and the cost's W, n, m without the control weight."""
        a, b = self.substep()
        states, inputs, q = eye(self.size), zeros(self.size, 1), zeros(self.size, self.size)
        w, cross, m = zeros(self.size, self.size), zeros(self.size, 1), 0.0
        for _ in range(self.substeps):
            states, inputs = mul(a, states), add(mul(a, inputs), b)
            q = add(mul(a, mul(q, turn(a))), self.noise(drift))
            place, share = turn([states[self.table]]), 1.0 / self.substeps
            w = add(w, mul(place, turn(place)), share)
            cross = add(cross, place, share * inputs[self.table][0])
            m += share * inputs[self.table][0] ** 2
        return states, inputs, q, w, cross, m


def main(path, name, control_weight_s2):
    axis = Axis(load(path), name)
    a, b, q, w, cross, m = axis.sampled(drift=True)
    m += float(control_weight_s2)
    variance = axis.noise_rad**2
    c = [[float(i == 0)] for i in range(axis.size)]
    # The filter: the same equation of the transposed system.
    p = riccati(turn(a), scale(mul(c, turn(c)), 1.0 / variance), q)
    gain = scale(mul(p, c), 1.0 / (p[0][0] + variance))
    # The regulator, its cross term taken into A and W.
    free = add(a, mul(b, turn(cross)), -1.0 / m)
    s = riccati(free, scale(mul(b, turn(b)), 1.0 / m), add(w, mul(cross, turn(cross)), -1.0 / m))
    asked = add(mul(turn(b), mul(s, a)), turn(cross))
    regulator = scale(asked, 1.0 / (mul(turn(b), mul(s, b))[0][0] + m))
    # The loop: what is true, and the estimate after the measurement. The simulation has no drift.
    seen = mul(gain, mul(turn(c), a))
    acts = scale(mul(b, regulator), -1.0)
    upper = [p + q for p, q in zip(a, acts)]
    lower = [p + q for p, q in zip(seen, add(add(a, acts), seen, -1.0))]
    true_q = axis.sampled(drift=False)[2]
    k = mul(gain, turn(c))
    qk, kqk = mul(true_q, turn(k)), mul(k, mul(true_q, turn(k)))
    kqk = add(kqk, mul(gain, turn(gain)), variance)
    noise = [p + q for p, q in zip(true_q, qk)] + [p + q for p, q in zip(turn(qk), kqk)]
    covariance = lyapunov(upper + lower, noise)
    rms_um = math.sqrt(covariance[axis.table][axis.table]) / axis.rad * 1e3
    print(json.dumps({"filter": [g for [g] in gain], "regulator": regulator[0], "rms_um": rms_um}))


main(*sys.argv[1:])
