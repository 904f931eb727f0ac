//! The limit: linear-quadratic-Gaussian control with preview, by everything that can be known of the machine.
//!
//! ```text
//! v = v_r - G (x - x_r)        x by a Kalman filter, G of a linear-quadratic regulator, v_r the exact inverse along the reference ahead
//! ```
//!
//! It knows what the peers know, and the statistics of the noise, the amplitude, the frequency and the wandering of the disturbance,
//! cogging and interpolation error with their phases; the random numbers, and the phase of the disturbance, it does not. It decides in
//! every servo period, within it. Nobody has all this: it says how much of an error nobody can take away.
//!
//! What acts at the motor is the reference speed v of the speed loop: the command is solved for it, with the position that is measured,
//! so that noise goes through the position loop only as far as the filter lets it. v_r carries friction (stepped from where it is
//! estimated to be), cogging, the integral of the speed loop, and what the reference needs, [`AxisInverse::reference_mm_s`]. The regulator
//! is that of the axis without integral and filter; the loads that the filter finds are among its states. Ripple is in the estimate
//! and not in v_r. Where the ball screw gives, it is the table that is held on the reference: the motor's is ahead by the twist, and both masses
//! are states.
//!
//! | File | What |
//! |---|---|
//! | `lqg_preview/riccati.rs` | the gains |
//! | `lqg_preview/linear.rs` | the linear part of an axis and of what acts on it |
//! | `lqg_preview/screw.rs` | where the motor has to be behind a ball screw that gives |
//! | `lqg_preview/approach.rs` | the way back of a tool that is far off, with no more than there is for it |
//! | `lqg_preview/feasible.rs` | whether there is torque for the reference ahead |
//! | `lqg_preview/outliers.rs` | measurements that cannot be true |
//! | `lqg_preview/whiteness.rs` | how much of what is measured the filter believes |
//! | `lqg_preview/estimate.rs` | the filter |
//! | `lqg_preview/validity.rs` | whether the law is that of the axis |
//!
//! Source: Anderson and Moore (1990), Optimal Control: Linear Quadratic Methods, chapters 7 and 8; Tomizuka and Rosenthal (1979),
//! "On the optimal digital state vector feedback controller with integral and preview actions".
//!
//! Departures: the part of the preview is the inverse of the known law, with which a reference is followed at no cost.

mod riccati;
mod linear;
mod screw;
mod approach;
mod feasible;
mod outliers;
mod whiteness;
mod estimate;
mod validity;

use super::feedforward::preview;
use super::{Command, Controller, Measured, Schedule};
use crate::axis::drive::{DriveParameters, DriveReference, DriveState};
use crate::axis::inverse::AxisInverse;
use crate::axis::knowledge::AxisKnowledge;
use crate::axis::mechanics::MechanicsState;
use crate::axis::transmission::TransmissionParameters;
use crate::axis::{AxisState, Parameters};
use crate::vector::{add_scaled, norm, scale, sub};
use crate::window::Window;
use approach::{PricedGains, Room};
use estimate::{AxisModel, Estimate, KEPT_PERIODS, Learnt, NOTHING_SENT, Sent};
use feasible::Feasibility;
use linear::LinearAxis;
use screw::{ScrewTwist, TwistCourse};
use validity::{LawTrial, Validity};

/// Servo periods beyond the command that the inverse looks at.
const DIFFERENCES: f64 = 3.0;

/// An offset that differs by less from what was asked for is that, mm.
const FOLLOWED_MM: f64 = 1e-4;

/// What an offset is held to, whatever is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffsetBounds {
    /// How large it may be, mm.
    pub largest_mm: f64,
    /// How fast it may change, mm/s.
    pub fastest_mm_s: f64,
}

impl OffsetBounds {
    /// To nothing.
    pub const NONE: Self = Self { largest_mm: f64::INFINITY, fastest_mm_s: f64::INFINITY };
}

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Price of the reference speed beside the error of the position, s^2, near the reference.
    pub price_s2: f64,
    /// What the offset is held to.
    pub bounds: OffsetBounds,
    /// Whether law and statistics may be wrong: statistics are learnt, and a wrong law is not followed. Else both are exact.
    pub learns: bool,
}

/// Price that serves by an identified model, in squares of the servo period. With 1 there is half as much again left on workshop; as long as the law is
/// not trusted, it is 256 times as high.
pub const IDENTIFIED_PRICE: f64 = 0.01;
/// By a law that may be wrong a screw that gives is regulated in no less than so many radians of its resonance: backlash is not in the law of the
/// regulator. On soft 2 leaves 0.6 of what 0 leaves on star, circle and square, and 0.1 on pocket.
const SCREW_RAD: f64 = 2.0;

impl Settings {
    /// A tenth of the travel of a servo period, squared.
    pub const DEFAULT: Self = Self { price_s2: 1e-8, bounds: OffsetBounds::NONE, learns: false };

    /// For an identified model: a price in squares of a servo period of `servo_s`.
    pub fn identified(price: f64, servo_s: f64, bounds: OffsetBounds) -> Self {
        Self { price_s2: price * servo_s * servo_s, bounds, learns: true }
    }

    /// Near the reference, for an axis with this screw.
    fn lowest_price_s2(&self, screw: &TransmissionParameters) -> f64 {
        if self.learns && screw.resonance_rad_s > 0.0 {
            let slow_s = SCREW_RAD / screw.resonance_rad_s;
            self.price_s2.max(slow_s * slow_s)
        } else {
            self.price_s2
        }
    }
}

/// Linear-quadratic-Gaussian control with preview.
#[derive(Debug, Clone)]
pub struct LqgPreview<const N: usize> {
    axes: [AxisLqg; N],
    /// By how much the tool is to be behind the plan, s.
    lag_s: f64,
    preview: u32,
    /// Where the law may be wrong.
    validity: Option<Validity<N>>,
    feasibility: Feasibility,
    /// The offset that was asked for last, mm.
    asked_mm: [f64; N],
}

impl<const N: usize> LqgPreview<N> {
    /// For a machine of which all this is known.
    pub fn new(known: [AxisKnowledge; N], settings: Settings) -> Self {
        let axes = known.map(|axis| AxisLqg::new(axis, settings));
        let preview_knots = |axis: &AxisLqg| {
            let twist_s = axis.twist.map_or(0.0, |twist| twist.ahead_s());
            preview(axis.inverse.lag_s() + axis.inverse.ahead_s() + twist_s, axis.model.law.periods.servo_s)
        };
        let longest = axes.iter().map(preview_knots).max().unwrap_or(0);
        let lag_s = axes.iter().map(AxisLqg::lag_s).fold(0.0, f64::max);
        Self {
            lag_s,
            preview: longest + DIFFERENCES as u32,
            validity: settings.learns.then(|| Validity::unknown(axes.iter().map(AxisLqg::unforeseen_mm2).sum())),
            feasibility: Feasibility::FOLLOWED,
            asked_mm: [0.0; N],
            axes,
        }
    }

    /// Holds offsets to other bounds from now on.
    pub fn hold_to(&mut self, bounds: OffsetBounds) {
        self.axes.iter_mut().for_each(|axis| axis.bounds = bounds);
    }

    /// Of each axis, near the reference.
    pub fn gains(&self) -> [LqgGains; N] {
        self.axes
            .each_ref()
            .map(|axis| LqgGains { filter: axis.model.gains_as_given(), regulator: axis.regulator.near() })
    }

    /// Takes in what comes to be known of the reference.
    fn look_ahead(&mut self, window: &Window<'_, N>) {
        let servo_s = window.servo_s();
        let end_s = f64::from(self.preview) * servo_s;
        let beyond = self.axes.iter().enumerate().any(|(i, axis)| {
            let at_mm = |before_s: f64| window.at(end_s - before_s).position_mm.get(i).copied().unwrap_or(0.0);
            feasible::is_beyond(&axis.model.law, at_mm)
        });
        self.feasibility.take_in(beyond, end_s + self.lag_s, servo_s);
    }

    /// Speed of the machine on the path, so far behind it, mm/s.
    fn lagging_mm_s(&self, window: &Window<'_, N>) -> [f64; N] {
        let behind_mm = [-self.lag_s, -self.lag_s - window.servo_s()].map(|after_s| window.at(after_s).position_mm);
        scale(1.0 / window.servo_s(), sub(behind_mm[0], behind_mm[1]))
    }
}

/// Stationary gains of an axis: by state, as in `lqg_preview/linear.rs`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LqgGains {
    /// How much of what is measured beyond the prediction, rad, is added to each state.
    pub filter: [f64; linear::STATES],
    /// By how much the reference speed, rad/s, is less for a unit of each state.
    pub regulator: [f64; linear::STATES],
}

impl<const N: usize> Controller<N> for LqgPreview<N> {
    fn schedule(&self) -> Schedule {
        Schedule { servo_periods: 1, preview: self.preview }
    }

    fn acts_at_once(&self) -> bool {
        true
    }

    fn reset(&mut self) {
        self.axes.iter_mut().for_each(|axis| axis.state = None);
        self.validity.iter_mut().for_each(Validity::forget);
        (self.feasibility, self.asked_mm) = (Feasibility::FOLLOWED, [0.0; N]);
    }

    /// Without a position it begins anew: what the tool does meanwhile nobody knows.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let position_mm = measured.map(|measured| measured.position_mm).filter(|mm| norm(*mm).is_finite());
        let Some(position_mm) = position_mm else {
            self.reset();
            return;
        };
        let begins = self.axes.iter().any(|axis| axis.state.is_none());
        let speed_mm_s = if begins { self.lagging_mm_s(window) } else { [0.0; N] };
        let measured_axes = window.offset_mm.into_iter().zip(position_mm).zip(speed_mm_s);
        for (axis, ((offset_mm, position_mm), speed_mm_s)) in self.axes.iter_mut().zip(measured_axes) {
            axis.observe(offset_mm, position_mm, speed_mm_s);
        }
        let missed_mm = self.axes.each_ref().map(AxisLqg::law_missed_mm);
        let following_mm = sub(add_scaled(window.now().position_mm, 1.0, window.offset_mm), position_mm);
        let followed = norm(sub(window.offset_mm, self.asked_mm)) <= FOLLOWED_MM;
        if let Some(validity) = &mut self.validity {
            validity.take_in(missed_mm, following_mm, position_mm, followed, window.feed_period_s);
        }
    }

    /// Infinite where the law is wrong.
    fn prediction_error_mm(&self) -> f64 {
        if self.validity.as_ref().is_some_and(Validity::is_wrong) {
            return f64::INFINITY;
        }
        norm(self.axes.each_ref().map(|axis| axis.moved_and_missed_mm()[1]))
    }

    fn moved_mm(&self) -> Option<[f64; N]> {
        Some(self.axes.each_ref().map(|axis| axis.moved_and_missed_mm()[0]))
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let here_mm = window.now().position_mm;
        let (mut offset_mm, lag_s) = ([0.0; N], self.lag_s);
        let [taken_up, trusted] = self.validity.as_ref().map_or([1.0; 2], |v| [v.taken_up(), v.trusted()]);
        self.look_ahead(window);
        let open = self.feasibility.open();
        for (i, (axis, offset_mm)) in self.axes.iter_mut().zip(&mut offset_mm).enumerate() {
            // There is an i-th axis; the compiler is not to leave a panic for where there is none.
            let of_axis = |position_mm: [f64; N]| position_mm.get(i).copied().unwrap_or(0.0);
            let at_mm = |after_s: f64| of_axis(window.at(after_s - lag_s).position_mm);
            *offset_mm = axis.offset_mm(of_axis(here_mm), trusted, open, at_mm);
        }
        self.asked_mm = offset_mm;
        Command::straight(1.0, scale(taken_up, offset_mm))
    }
}

/// An axis, its gains, and what it remembers.
#[derive(Debug, Clone)]
struct AxisLqg {
    model: AxisModel,
    inverse: AxisInverse,
    twist: Option<ScrewTwist>,
    regulator: PricedGains,
    bounds: OffsetBounds,
    known: AxisKnowledge,
    state: Option<Running>,
}

/// What an axis remembers while it runs.
#[derive(Debug, Clone, Copy)]
struct Running {
    /// As it is, and as it would be without any offset, under the same load.
    real: Tracked,
    open: Tracked,
    /// Where the path was at the last decision, mm; the command was an offset beside it.
    path_mm: Option<f64>,
    /// What was measured beyond what was expected, rad.
    missed_rad: f64,
    learnt: Learnt,
    trial: LawTrial,
}

impl Running {
    /// Where nothing is known yet but an angle and a speed.
    fn at(angle_rad: f64, speed_rad_s: f64) -> Self {
        let moving = Tracked::moving(angle_rad, speed_rad_s);
        Self {
            real: moving,
            open: moving,
            path_mm: None,
            missed_rad: 0.0,
            learnt: Learnt::NOTHING,
            trial: LawTrial::from(&moving.estimate),
        }
    }
}

/// An axis behind its position loop.
#[derive(Debug, Clone, Copy)]
struct Tracked {
    estimate: Estimate,
    sent: Sent,
    /// The position loop as it is in the control.
    position_loop: (AxisState, DriveState),
    /// What is measured now, rad.
    measured_rad: f64,
}

impl Tracked {
    fn moving(measured_rad: f64, speed_rad_s: f64) -> Self {
        Self {
            estimate: AxisModel::moving(measured_rad, speed_rad_s),
            sent: NOTHING_SENT,
            position_loop: (AxisState::default(), DriveState::AT_REST),
            measured_rad,
        }
    }

    /// The reference speed that the position loop makes of a command; torque beside it counts as that.
    fn asked_rad_s(&self, model: &AxisModel, command_rad: f64) -> f64 {
        let (mut axis, mut drive) = self.position_loop;
        let DriveReference { speed_rad_s, torque_nm } =
            model.drive.position_loop(&model.law, command_rad, self.measured_rad, &mut axis, &mut drive);
        speed_rad_s + torque_nm / model.law.parameters.kv_nm_s_per_rad
    }

    /// What the position loop makes of a command goes to the drive.
    fn send(&mut self, model: &AxisModel, command_rad: f64) {
        let (axis, drive) = &mut self.position_loop;
        axis.angle_rad = self.measured_rad;
        let reference = model.drive.position_loop(&model.law, command_rad, self.measured_rad, axis, drive);
        self.sent.copy_within(..KEPT_PERIODS - 1, 1);
        self.sent[0] = reference;
    }
}

impl AxisLqg {
    fn new(known: AxisKnowledge, settings: Settings) -> Self {
        let AxisKnowledge { drive, friction, transmission, delays, statistics, .. } = known;
        let law = known.law();
        let model = AxisModel::new(&known, settings.learns);
        let screw = model.mechanics.transmission();
        let regulated = LinearAxis::new(&law, &DriveParameters::default(), screw, &statistics);
        let lowest_s2 = settings.lowest_price_s2(&transmission);
        let (states, input, _) = regulated.sampled();
        Self {
            inverse: AxisInverse::new(law, drive, friction, delays),
            twist: screw.map(|screw| ScrewTwist::new(&law, screw)),
            regulator: PricedGains::new(lowest_s2, |price_s2| {
                riccati::regulator(&states, &input, &regulated.cost(price_s2))
            }),
            bounds: settings.bounds,
            known,
            state: None,
            model,
        }
    }

    /// How far the axis is behind the command at constant speed where nothing is added to it, s.
    fn lag_s(&self) -> f64 {
        let (parameters, AxisKnowledge { drive, delays, .. }) = (self.model.law.parameters, self.known);
        let friction = if drive.speed_integral_s > 0.0 {
            0.0
        } else {
            parameters.viscous_friction_nm_s / parameters.kv_nm_s_per_rad
        };
        (1.0 + friction - drive.velocity_feedforward) / parameters.kp_1_s - delays.measurement_s
    }

    /// What was commanded in the last servo period, as an offset from the path, has led to this position. Where it begins it has about this speed.
    fn observe(&mut self, offset_mm: f64, position_mm: f64, speed_mm_s: f64) {
        let rad_per_mm = self.model.law.parameters.rad_per_mm;
        let measured_rad = position_mm * rad_per_mm;
        let running = self.state.get_or_insert_with(|| Running::at(measured_rad, speed_mm_s * rad_per_mm));
        let Running { real, open, path_mm, missed_rad, learnt, trial, .. } = running;
        let Some(path_mm) = *path_mm else {
            real.measured_rad = measured_rad;
            return;
        };
        real.send(&self.model, (path_mm + offset_mm) * rad_per_mm);
        let told = self.model.correct(&mut real.estimate, &real.sent, measured_rad, learnt);
        real.measured_rad = told.measured_rad;
        trial.go_on(&self.model, &real.sent, measured_rad, &real.estimate);
        let possible = self.model.is_possible(&real.estimate);
        *missed_rad = if possible { told.missed_rad } else { f64::INFINITY };
        open.send(&self.model, path_mm * rad_per_mm);
        open.estimate.acting_nm = real.estimate.acting_nm;
        self.model.predict(&mut open.estimate, &open.sent);
        open.measured_rad = open.estimate.masses.motor.angle_rad;
    }

    /// By how much the offset has moved it, and what was measured beyond what was expected, mm.
    fn moved_and_missed_mm(&self) -> [f64; 2] {
        let mm = 1.0 / self.model.law.parameters.rad_per_mm;
        self.state.as_ref().map_or([0.0; 2], |Running { real, open, missed_rad, .. }| {
            let [with_rad, without_rad] = [real, open].map(|tracked| tracked.estimate.masses.table.angle_rad);
            [with_rad - without_rad, *missed_rad].map(|rad| rad * mm)
        })
    }

    /// By how much the law has missed what was measured, mm.
    fn law_missed_mm(&self) -> f64 {
        self.state.as_ref().map_or(0.0, |running| running.trial.missed_rad() / self.model.law.parameters.rad_per_mm)
    }

    /// What noise and loads that nobody foresees make it miss, mm^2.
    fn unforeseen_mm2(&self) -> f64 {
        let Parameters { rad_per_mm, .. } = self.model.law.parameters;
        self.model.unforeseen_rad2(validity::run_periods(self.model.law.periods.servo_s)) / (rad_per_mm * rad_per_mm)
    }

    /// The offset of the command in this servo period, by a law that is `trusted` so far; `at_mm` is the reference so many seconds from its start, in whose
    /// place the `open` loop is followed in part.
    fn offset_mm(&mut self, here_mm: f64, trusted: f64, open: f64, at_mm: impl Fn(f64) -> f64) -> f64 {
        let Some(running) = &mut self.state else { return 0.0 };
        running.path_mm = Some(here_mm);
        let ahead = self.model.ahead(&running.real.estimate, &running.real.sent);
        let rad_per_mm = self.model.law.parameters.rad_per_mm;
        let inner = [ahead.drive.integral_nm(), ahead.masses.presliding_nm];
        let acts_s = self.known.delays.drive_s;
        let twist = self.twist.map_or(TwistCourse::NONE, |twist| twist.course(&at_mm, acts_s));
        let load_mm_s = self.cogging_mm_s(&at_mm) - twist.spared_mm_s();
        let motor_mm = |after_s: f64| at_mm(after_s) + twist.mm(after_s);
        let reference_mm_s = self.inverse.reference_mm_s(motor_mm, inner, load_mm_s);
        let mut reference_rad_s = reference_mm_s * rad_per_mm;
        let mut off = self.off(&ahead, &at_mm, &motor_mm);
        if open > 0.0 {
            let (open_rad_s, open_off) = self.beside_open(here_mm, &ahead);
            reference_rad_s += open * (open_rad_s - reference_rad_s);
            off.iter_mut().zip(open_off).for_each(|(off, of_open)| *off += open * (of_open - *off));
        }
        let Parameters { kv_nm_s_per_rad, .. } = self.model.law.parameters;
        let [_, off_rad_s, ..] = off;
        let reference_nm = kv_nm_s_per_rad * (reference_rad_s - (ahead.masses.motor.speed_rad_s - off_rad_s));
        let asked_rad_s = self.asked_rad_s(reference_nm, &off, trusted);
        self.solved_mm(here_mm, reference_rad_s - asked_rad_s)
    }

    /// The reference speed of the axis by itself, without any offset, and by how much the axis is off it.
    fn beside_open(&self, here_mm: f64, ahead: &Estimate) -> (f64, [f64; linear::STATES]) {
        let Some(Running { open, .. }) = &self.state else { return (0.0, [0.0; linear::STATES]) };
        let beside = self.model.ahead(&open.estimate, &open.sent);
        let Parameters { kv_nm_s_per_rad, rad_per_mm, .. } = self.model.law.parameters;
        let integral_rad_s = (beside.drive.integral_nm() - ahead.drive.integral_nm()) / kv_nm_s_per_rad;
        let reference_rad_s = open.asked_rad_s(&self.model, here_mm * rad_per_mm) + integral_rad_s;
        let [real, open] = [ahead, &beside].map(|estimate| estimate.masses);
        let x = real.motor.angle_rad - open.motor.angle_rad;
        let w = real.motor.speed_rad_s - open.motor.speed_rad_s;
        let xt = real.table.angle_rad - open.table.angle_rad;
        let wt = real.table.speed_rad_s - open.table.speed_rad_s;
        (reference_rad_s, [x, w, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, xt, wt])
    }

    /// By how much the regulator asks for less speed than the reference has, which takes this torque.
    fn asked_rad_s(&self, reference_nm: f64, off: &[f64; linear::STATES], trusted: f64) -> f64 {
        let Parameters { torque_limit_nm, kp_1_s, kv_nm_s_per_rad, rad_per_mm, .. } = self.model.law.parameters;
        let by_torque_rad_s = approach::left_nm(torque_limit_nm, reference_nm) / kv_nm_s_per_rad;
        let of_offset = kp_1_s * rad_per_mm;
        let room = Room {
            most_rad_s: by_torque_rad_s.min(of_offset * self.bounds.largest_mm),
            change_rad_s2: of_offset * self.bounds.fastest_mm_s,
        };
        self.regulator.asked_rad_s(off, room, trusted)
    }

    /// By how much the axis is off the reference when what is sent now begins to act, and what acts on it.
    fn off(
        &self,
        ahead: &Estimate,
        table_mm: &impl Fn(f64) -> f64,
        motor_mm: &impl Fn(f64) -> f64,
    ) -> [f64; linear::STATES] {
        let MechanicsState { motor, table, .. } = ahead.masses;
        let [x, w] = self.off_reference([motor.angle_rad, motor.speed_rad_s], motor_mm);
        let [xt, wt] = self.off_reference([table.angle_rad, table.speed_rad_s], table_mm);
        let [broadband, disturbance, quadrature, drift] = ahead.acting_nm;
        [x, w, 0.0, 0.0, broadband, disturbance, quadrature, drift, xt, wt]
    }

    /// By how much an angle, rad, and its speed, rad/s, are off theirs.
    fn off_reference(&self, [angle_rad, speed_rad_s]: [f64; 2], at_mm: &impl Fn(f64) -> f64) -> [f64; 2] {
        let (rad_per_mm, periods) = (self.model.law.parameters.rad_per_mm, self.model.law.periods);
        let servo_s = periods.servo_s;
        let [before_mm, there_mm, after_mm] =
            [-1.0, 0.0, 1.0].map(|n: f64| at_mm(self.known.delays.drive_s + n * servo_s));
        // The speed of the law is that of the mechanics period that has ended: half of one ago.
        let change_mm = (after_mm - there_mm) - (there_mm - before_mm);
        let late_mm_s = 0.5 * periods.mechanics_s * change_mm / (servo_s * servo_s);
        let there_mm_s = (after_mm - before_mm) / (2.0 * servo_s) - late_mm_s;
        [angle_rad - there_mm * rad_per_mm, speed_rad_s - there_mm_s * rad_per_mm]
    }

    /// What cogging takes along the reference in the period in which what is sent now acts, mm/s of reference speed; by Simpson's rule.
    fn cogging_mm_s(&self, at_mm: &impl Fn(f64) -> f64) -> f64 {
        let (parameters, servo_s) = (self.model.law.parameters, self.model.law.periods.servo_s);
        let cogging_nm =
            |n: f64| self.model.cogging_nm(at_mm(self.known.delays.drive_s + n * servo_s) * parameters.rad_per_mm);
        let mean_nm = (cogging_nm(0.0) + 4.0 * cogging_nm(0.5) + cogging_nm(1.0)) / 6.0;
        -mean_nm / (parameters.kv_nm_s_per_rad * parameters.rad_per_mm)
    }

    /// The offset with which the position loop asks for a reference speed.
    fn solved_mm(&self, here_mm: f64, wanted_rad_s: f64) -> f64 {
        let Some(running) = &self.state else { return 0.0 };
        let rad_per_mm = self.model.law.parameters.rad_per_mm;
        let asked = |command_mm: f64| running.real.asked_rad_s(&self.model, command_mm * rad_per_mm);
        // It is linear.
        let (here, beyond) = (asked(here_mm), asked(here_mm + 1.0));
        (wanted_rad_s - here) / (beyond - here)
    }
}
