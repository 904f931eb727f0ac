//! Motor, screw and table of an axis, and their motion under a voltage.
//!
//! ```text
//! L di/dt      = u - R i - K(theta) w
//! Jm dw/dt     = K(theta) i - Tc sin(nc theta + pc) - r F - Fm(w)
//! d(m(x) v)/dt = F - Ft(v) - W + m'(x) v^2 / 2
//! dtheta/dt    = w,   dx/dt = v
//! K(theta)     = Kt (1 + k sin(nk theta + pk)),   m(x) = m0 (1 + a sin(x / l + p))
//! ```
//!
//! i current, A; u voltage, V; w and theta speed and angle of the motor, rad/s and rad; v and x of
//! the table, m/s and m; F force of the screw (`ball_screw.rs`), N; Fm and Ft friction at motor and
//! table (`lugre.rs`), N m and N; Tc cogging, N m; W load, N, such as the weight of a spindle; m(x)
//! the mass that moves, kg, which depends on the position where a cable chain is laid down or a
//! gantry is turned. The equation of the table is Lagrange's, so that its energy m v^2 / 2 is
//! conserved. Phases of cogging, ripple and mass depend on where the axis was homed, and are known
//! to nobody.
//!
//! Integrated by the implicit trapezoidal rule, y1 = y0 + h / 2 (f(y0) + f(y1)), under a held
//! voltage. It is of second order, A-stable, and leaves the energy of a linear spring alone. Angle,
//! position, current and bristles at the end of a step follow in closed form from the two speeds
//! there; these are found by Newton's method.
//!
//! Source: Altintas (2012), Manufacturing Automation, section 5.3, for motor and drive; Hairer,
//! Norsett and Wanner (1993), Solving Ordinary Differential Equations I, section II.7, for the
//! trapezoidal rule.

use serde::Serialize;

use super::ball_screw::BallScrew;
use super::lugre::LuGre;

/// Most rounds of Newton's method; two or three are usual.
const MOST_ROUNDS: usize = 20;
/// Corrections of the speeds, rad/s and m/s, with which it has come to its end: the next would be
/// their square.
const SMALL: [f64; 2] = [1e-8, 1e-11];

/// A direct-current motor, or a servo motor in the coordinates of its rotor.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct WoundMotor {
    /// Resistance, ohm.
    pub resistance_ohm: f64,
    /// Inductance, H.
    pub inductance_h: f64,
    /// Torque constant, N m/A, and back electromotive force, V s/rad.
    pub torque_nm_a: f64,
    /// Ripple of it, a part; its periods in a turn; its phase, rad.
    pub ripple: [f64; 3],
    /// Cogging torque, N m; its periods in a turn; its phase, rad.
    pub cogging: [f64; 3],
    /// Inertia of rotor, coupling and screw, kg m2.
    pub inertia_kg_m2: f64,
    /// Friction at the motor, N m and rad/s.
    pub friction: LuGre,
}

/// A table on its guideways.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct GuidedTable {
    /// Mass, kg: mean over the travel.
    pub mass_kg: f64,
    /// Part of it that depends on the position; travel for a radian of that, m; its phase, rad.
    pub mass_swing: [f64; 3],
    /// Load that pulls in the negative direction, N.
    pub load_n: f64,
    /// Friction at the guideways, N and m/s.
    pub friction: LuGre,
}

/// Motor, screw and table.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct FeedAxis {
    /// The motor.
    pub motor: WoundMotor,
    /// The screw.
    pub screw: BallScrew,
    /// The table.
    pub table: GuidedTable,
}

/// State of an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FeedState {
    /// Current, A.
    pub current_a: f64,
    /// Speed of the motor, rad/s.
    pub motor_rad_s: f64,
    /// Its angle, rad.
    pub motor_rad: f64,
    /// Speed of the table, m/s.
    pub table_m_s: f64,
    /// Its position, m.
    pub table_m: f64,
    /// Bending of the bristles at the motor, rad, and at the table, m.
    pub bristles: [f64; 2],
}

/// Rates of a state, and the derivatives of the speeds' rates by the speeds. The rest of the state
/// follows by the trapezoidal rule.
struct Rates {
    current_a_s: f64,
    speeds: [f64; 2],
    bristles: [f64; 2],
    slopes: [[f64; 2]; 2],
}

/// A periodic function: amplitude times sine, and its derivative by the argument.
fn wave([amplitude, per_unit, phase_rad]: [f64; 3], at: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(per_unit * at + phase_rad);
    [amplitude * sin, amplitude * per_unit * cos]
}

impl WoundMotor {
    /// Torque constant at an angle, N m/A, and its derivative by the angle.
    fn constant(&self, angle_rad: f64) -> [f64; 2] {
        let [ripple, slope] = wave(self.ripple, angle_rad);
        let mean = self.torque_nm_a;
        [mean * ripple + mean, mean * slope]
    }

    /// Torque at a current, N m.
    pub(super) fn torque_nm(&self, state: &FeedState) -> f64 {
        self.constant(state.motor_rad)[0] * state.current_a
    }
}

impl GuidedTable {
    /// Mass at a position, kg, and its first and second derivatives.
    fn mass(&self, at_m: f64) -> [f64; 3] {
        let [part, length_m, phase_rad] = self.mass_swing;
        if part == 0.0 {
            return [self.mass_kg, 0.0, 0.0];
        }
        let per_m = 1.0 / length_m;
        let [swing, slope] = wave([part * self.mass_kg, per_m, phase_rad], at_m);
        [self.mass_kg + swing, slope, -per_m * per_m * swing]
    }
}

impl FeedAxis {
    /// Returns the state at rest with the motor at an angle or, where `is_table` is true, with the
    /// table at a position; the load is carried.
    pub(super) fn at_rest(&self, place_m: f64, is_table: bool) -> FeedState {
        let (motor, screw, table) = (&self.motor, &self.screw, &self.table);
        let lead_m = screw.lead_under(table.load_n);
        let (nut_m, table_m) = match is_table {
            true => (place_m + lead_m, place_m),
            false => (place_m, place_m - lead_m),
        };
        let motor_rad = nut_m / screw.travel_m_rad;
        let held_nm = screw.travel_m_rad * table.load_n + wave(motor.cogging, motor_rad)[0];
        let current_a = held_nm / motor.constant(motor_rad)[0];
        FeedState {
            current_a,
            motor_rad,
            table_m,
            ..FeedState::default()
        }
    }

    /// The state one step later under a held voltage.
    pub fn step(&self, from: &FeedState, volts: f64, step_s: f64) -> FeedState {
        let half_s = 0.5 * step_s;
        let rates = self.rates(from, volts, half_s);
        let start = [from.motor_rad_s, from.table_m_s];
        let mut speeds: [f64; 2] = std::array::from_fn(|i| start[i] + step_s * rates.speeds[i]);
        let mut state = self.following(from, &rates, speeds, volts, half_s);
        for _ in 0..MOST_ROUNDS {
            let end = self.rates(&state, volts, half_s);
            let left =
                [0, 1].map(|i| speeds[i] - start[i] - half_s * (rates.speeds[i] + end.speeds[i]));
            let [[a, b], [c, d]] = end.slopes.map(|row| row.map(|slope| -half_s * slope));
            let (a, d) = (1.0 + a, 1.0 + d);
            let determinant = a * d - b * c;
            let [x, y] = [d * left[0] - b * left[1], a * left[1] - c * left[0]];
            let change = [x / determinant, y / determinant];
            speeds = [speeds[0] - change[0], speeds[1] - change[1]];
            state = self.following(from, &rates, speeds, volts, half_s);
            if change[0].abs() <= SMALL[0] && change[1].abs() <= SMALL[1] {
                break;
            }
        }
        state
    }

    /// The state at the end of a step whose speeds there are these.
    fn following(
        &self,
        from: &FeedState,
        rates: &Rates,
        speeds: [f64; 2],
        volts: f64,
        half_s: f64,
    ) -> FeedState {
        let Self { motor, table, .. } = self;
        let [motor_rad_s, table_m_s] = speeds;
        let motor_rad = from.motor_rad + half_s * (from.motor_rad_s + motor_rad_s);
        let table_m = from.table_m + half_s * (from.table_m_s + table_m_s);
        let drop_v = volts - motor.constant(motor_rad)[0] * motor_rad_s;
        let current_a = (from.current_a
            + half_s * (rates.current_a_s + drop_v / motor.inductance_h))
            / (1.0 + half_s * motor.resistance_ohm / motor.inductance_h);
        let bent = |i: usize, friction: &LuGre| {
            friction.bent(from.bristles[i], rates.bristles[i], speeds[i], half_s)
        };
        let bristles = [bent(0, &motor.friction), bent(1, &table.friction)];
        FeedState {
            current_a,
            motor_rad_s,
            motor_rad,
            table_m_s,
            table_m,
            bristles,
        }
    }

    /// Rates of a state.
    fn rates(&self, state: &FeedState, volts: f64, half_s: f64) -> Rates {
        let (motor, screw, table) = (&self.motor, &self.screw, &self.table);
        let (current_a, w, v) = (state.current_a, state.motor_rad_s, state.table_m_s);
        let (motor_rad, table_m, bristles) = (state.motor_rad, state.table_m, state.bristles);
        let travel = screw.travel_m_rad;
        let [constant, constant_slope] = motor.constant(motor_rad);
        let [cogging, cogging_slope] = wave(motor.cogging, motor_rad);
        let force = screw.force(travel * motor_rad - table_m, travel * w - v);
        let by_nut = half_s * force.slopes[0] + force.slopes[1];
        let at_motor = motor.friction.at(w, bristles[0]);
        let at_table = table.friction.at(v, bristles[1]);
        let [mass, mass_slope, mass_bend] = table.mass(table_m);

        let electrical = 1.0 + half_s * motor.resistance_ohm / motor.inductance_h;
        let current_slope =
            -half_s * (constant + constant_slope * half_s * w) / (motor.inductance_h * electrical);
        let torque_nm = constant * current_a - cogging - travel * force.force_n - at_motor.force;
        let torque_slope = half_s * (constant_slope * current_a - cogging_slope)
            + constant * current_slope
            - travel * travel * by_nut
            - at_motor.slope(half_s);
        let pull_n = force.force_n - at_table.force - table.load_n - 0.5 * mass_slope * v * v;
        let table_m_s2 = pull_n / mass;
        let pull_slope =
            -by_nut - at_table.slope(half_s) - mass_slope * v - 0.5 * half_s * mass_bend * v * v;
        let inertia = motor.inertia_kg_m2;
        let pull_slope = pull_slope - half_s * mass_slope * table_m_s2;
        let left_v = volts - motor.resistance_ohm * current_a - constant * w;
        Rates {
            current_a_s: left_v / motor.inductance_h,
            speeds: [torque_nm / inertia, table_m_s2],
            bristles: [at_motor.rate, at_table.rate],
            slopes: [
                [torque_slope / inertia, travel * by_nut / inertia],
                [travel * by_nut / mass, pull_slope / mass],
            ],
        }
    }

    /// Energy that is stored in motion, springs, bristles, winding, cogging and height, J.
    pub fn energy_j(&self, state: &FeedState) -> f64 {
        let (motor, screw, table) = (&self.motor, &self.screw, &self.table);
        let [amplitude_nm, per_rad, phase_rad] = motor.cogging;
        let cogging_j = match amplitude_nm == 0.0 {
            true => 0.0,
            false => -amplitude_nm / per_rad * libm::cos(per_rad * state.motor_rad + phase_rad),
        };
        0.5 * motor.inductance_h * state.current_a.powi(2)
            + 0.5 * motor.inertia_kg_m2 * state.motor_rad_s.powi(2)
            + 0.5 * table.mass(state.table_m)[0] * state.table_m_s.powi(2)
            + screw.energy_j(self.nut_lead_m(state))
            + motor.friction.energy_j(state.bristles[0])
            + table.friction.energy_j(state.bristles[1])
            + table.load_n * state.table_m
            + cogging_j
    }

    /// Returns the power that friction, damping and the winding dissipate, W.
    pub fn loss_w(&self, state: &FeedState) -> f64 {
        let (motor, screw, table) = (&self.motor, &self.screw, &self.table);
        motor.resistance_ohm * state.current_a.powi(2)
            + motor.friction.loss_w(state.motor_rad_s, state.bristles[0])
            + table.friction.loss_w(state.table_m_s, state.bristles[1])
            + screw.loss_w(self.nut_lead_m(state), self.nut_rate_m_s(state))
    }

    /// Force of the screw on the table, N.
    pub fn screw_force_n(&self, state: &FeedState) -> f64 {
        let (lead_m, rate_m_s) = (self.nut_lead_m(state), self.nut_rate_m_s(state));
        self.screw.force(lead_m, rate_m_s).force_n
    }

    /// Returns the rate of that lead, m/s.
    fn nut_rate_m_s(&self, state: &FeedState) -> f64 {
        self.screw.travel_m_rad * state.motor_rad_s - state.table_m_s
    }

    /// Returns the lead of the nut over the table, m.
    fn nut_lead_m(&self, state: &FeedState) -> f64 {
        self.screw.travel_m_rad * state.motor_rad - state.table_m
    }

    /// Inertia at the motor shaft, kg m2: mean over the travel.
    pub fn inertia_kg_m2(&self) -> f64 {
        self.motor.inertia_kg_m2 + self.table.mass_kg * self.screw.travel_m_rad.powi(2)
    }
}
