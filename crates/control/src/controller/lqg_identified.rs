//! The controller `lqg-identified`: a Kalman filter and a linear-quadratic regulator with preview,
//! with an identified model of each axis.
//!
//! ```text
//! v = v_r - G (x - x_r)        x by a Kalman filter, G of a linear-quadratic regulator, v_r the inverse along the reference ahead
//! ```
//!
//! It decides in every servo period, within it. It learns the errors of its model in motion, and
//! judges whether the model fits the machine. The laboratory makes its limit, `lqg-preview`,
//! from the same controller with exact knowledge that no real controller has: the statistics of the
//! noise, the amplitude, frequency and wander of the disturbance, and cogging and interpolation
//! error with their phases. The limit does not know the random numbers and the phase of the
//! disturbance. Its result shows the part of an error that no controller can remove.
//!
//! The reference speed v of the speed loop acts at the motor: the command is solved for it with the
//! measured position, so that noise passes the position loop only as far as the filter permits. v_r
//! carries friction (stepped from its estimated state), cogging, the integral of the speed loop,
//! and the need of the reference,
//! [`reference_mm_s`](crate::axis::inverse::AxisInverse::reference_mm_s). The regulator is designed
//! for the axis without integral and filter; the loads that the filter finds are among its states.
//! Ripple is in the estimate and not in v_r. With a compliant ball screw, the table is held on the
//! reference: the motor leads its reference by the twist, and both masses are states.
//!
//! A position loop in the drive has a command n servo periods late. The axis then first predicts
//! these n periods, by the model and the commands on their way, and decides for the time at which
//! the position loop has the command. The tool lags by n more servo periods, as it does without any
//! correction.
//!
//! | File | Content |
//! |---|---|
//! | `lqg_identified/control_weight.rs` | control weight and bounds of the offset |
//! | `lqg_identified/riccati.rs` | the gains |
//! | `lqg_identified/linear.rs` | the linear part of an axis and of its loads |
//! | `lqg_identified/command_noise.rs` | noise of the command |
//! | `lqg_identified/command_weight.rs` | a regulator whose command is quiet |
//! | `lqg_identified/shaped.rs` | the reference, smoothed where its ideal command needs too much acceleration |
//! | `lqg_identified/screw.rs` | position of the motor on a compliant ball screw |
//! | `lqg_identified/approach.rs` | the way back of a tool that is far off, within the available control authority |
//! | `lqg_identified/feasible.rs` | check of the torque for the reference ahead |
//! | `lqg_identified/gain_table.rs` | gains of the filter by the noise of the measurement |
//! | `lqg_identified/estimate.rs` | the filter |
//! | `lqg_identified/loop_margins.rs` | margins of the loop |
//! | `lqg_identified/learning.rs` | model errors, learned while the axis moves |
//! | `lqg_identified/regulated_axis.rs` | an axis: filter, regulator and inverse |
//!
//! Source: Anderson and Moore (1990), Optimal Control: Linear Quadratic Methods, chapters 7 and 8;
//! Tomizuka and Rosenthal (1979), "On the optimal digital state vector feedback controller with
//! integral and preview actions".
//!
//! Departures: the preview part is the inverse of the known model, which follows a reference at no
//! cost.

mod control_weight;
mod riccati;
mod linear;
mod command_noise;
mod command_weight;
mod screw;
mod approach;
mod feasible;
mod gain_table;
mod estimate;
mod loop_margins;
mod learning;
mod regulated_axis;
mod shaped;

use super::feedforward::preview;
use super::row::{ControllerData, ControllerRow, Knows, Member, Values};
use super::{Controller, OffsetBounds, Schedule};
use crate::axis::AxisModel;
use crate::command::{Command, Measured, SelfReport, Verdict};
use crate::identifier::IdentifierKind;
use crate::model::Trained;
use crate::supervisor::first_use::FirstUse;
use crate::supervisor::one_step::{OneStep, RUN_S};
use crate::supervisor::validity::{ModelWeights, Shown, Validity};
use crate::vector::{add_scaled, norm, scale, sub};
use crate::window::{PREVIEW_KNOTS, Window};
use feasible::Feasibility;
use regulated_axis::AxisLqg;
use shaped::Shaped;

pub use control_weight::{IDENTIFIED_WEIGHT, LqgSettings};
pub use regulated_axis::LqgGains;

/// Servo periods beyond the command that the inverse evaluates.
const DIFFERENCES: f64 = 3.0;

/// Difference from the requested offset up to which an offset counts as followed, mm.
const FOLLOWED_MM: f64 = 1e-4;

/// Distance from the prediction, mm, beyond which everything begins anew when a lost position
/// returns. A free run of the model predicts it for [`RUN_S`].
const FORESEEN_MM: f64 = 0.05;

/// Linear-quadratic-Gaussian control with preview, by a model of each axis.
#[derive(Debug, Clone)]
pub struct LqgIdentified<const N: usize> {
    axes: [AxisLqg; N],
    /// Lag of the tool behind the plan, s.
    lag_s: f64,
    preview: u32,
    /// Validity of the model; `None` if the model is exact.
    validity: Option<Validity<N>>,
    /// Test of the models before their first use on this machine.
    first_use: Option<FirstUse>,
    feasibility: Feasibility,
    /// The last requested offset, mm.
    asked_mm: [f64; N],
    /// Time since the position was lost, s.
    lost_s: f64,
    /// The smoothed reference, the acceleration that its ideal command may take, mm/s2, and the time
    /// from now up to which it is needed, s.
    shaped: Shaped<N>,
    limit_mm_s2: f64,
    needed_s: f64,
}

impl<const N: usize> LqgIdentified<N> {
    /// Creates the controller of a machine with these models of its axes.
    pub fn new(known: [AxisModel; N], settings: LqgSettings) -> Self {
        let axes = known.map(|axis| AxisLqg::new(axis, settings));
        let servo_s = known.first().map_or(1.0, |axis| axis.periods.servo_s);
        let preview_knots =
            |axis: &AxisLqg| preview(axis.ahead_s(), axis.axis_model().periods.servo_s);
        let longest = axes.iter().map(preview_knots).max().unwrap_or(0);
        let unforeseen_mm2 = axes.iter().map(AxisLqg::unforeseen_mm2).sum();
        let lag_s = axes.iter().map(AxisLqg::lag_s).fold(0.0, f64::max);
        let needed_s = axes
            .iter()
            .map(|axis| axis.looks_ahead_s() - lag_s)
            .fold(0.0, f64::max);
        // The cast saturates where the float is too large or NaN.
        let shaped = libm::ceil(needed_s / servo_s) as u32 + shaped::BEHIND as u32;
        Self {
            lag_s,
            preview: (longest + DIFFERENCES as u32)
                .max(shaped)
                .min(PREVIEW_KNOTS as u32),
            validity: settings.learns.then(|| Validity::unknown(unforeseen_mm2)),
            first_use: (!settings.is_known).then(|| FirstUse::new(unforeseen_mm2)),
            feasibility: Feasibility::FOLLOWED,
            asked_mm: [0.0; N],
            lost_s: 0.0,
            shaped: Shaped::new(known),
            limit_mm_s2: settings.bounds.acceleration_mm_s2,
            needed_s,
            axes,
        }
    }

    /// Returns the squared error of the models alone and the squared error to correct, mm^2; `None`
    /// at rest.
    fn seen_alone_mm2(&self, window: &Window<'_, N>, position_mm: [f64; N]) -> Option<[f64; 2]> {
        let mut seen_mm2 = [0.0; 2];
        for (i, (axis, position_mm)) in self.axes.iter().zip(position_mm).enumerate() {
            let there_mm = window
                .at(-self.lag_s - axis.axis_model().parameters.measurement_delay_s)
                .position_mm;
            let off_mm = [
                position_mm - axis.alone_mm(),
                position_mm - there_mm.get(i).copied().unwrap_or(0.0),
            ];
            seen_mm2 = add_scaled(seen_mm2, 1.0, off_mm.map(|mm| mm * mm));
        }
        (window.now().feed_mm_s > 0.0).then_some(seen_mm2)
    }

    /// Returns the gains of each axis near the reference.
    pub fn gains(&self) -> [LqgGains; N] {
        self.axes.each_ref().map(AxisLqg::gains)
    }

    /// Predicts a servo period without a position.
    fn foresee(&mut self, window: &Window<'_, N>) {
        self.lost_s += window.feed_period_s;
        if self.lost_s > RUN_S {
            self.begin_anew();
            return;
        }
        let here_mm = window.now().position_mm;
        for (axis, (offset_mm, here_mm)) in self
            .axes
            .iter_mut()
            .zip(window.offset_mm.into_iter().zip(here_mm))
        {
            axis.foresee(offset_mm, here_mm);
        }
        self.asked_mm = [0.0; N];
    }

    /// Begins anew after the position was lost.
    fn begin_anew(&mut self) {
        self.axes.iter_mut().for_each(AxisLqg::begin_anew);
        self.know_nothing();
    }

    /// Forgets the results on the models and on the reference.
    fn know_nothing(&mut self) {
        self.validity.iter_mut().for_each(Validity::forget);
        self.shaped.forget();
        (self.feasibility, self.asked_mm, self.lost_s) = (Feasibility::FOLLOWED, [0.0; N], 0.0);
    }

    /// Returns the distance between the last position and its prediction, mm.
    fn missed_mm(&self) -> f64 {
        norm(
            self.axes
                .each_ref()
                .map(|axis| axis.moved_and_missed_mm()[1]),
        )
    }

    /// Returns true if a position that comes back after it was lost is not where the models expect
    /// it.
    fn is_elsewhere(&self) -> bool {
        !self.axes.iter().all(AxisLqg::is_possible) || self.missed_mm() > FORESEEN_MM
    }

    /// Returns the verdict on the models. They are also wrong if no command can follow a drive, or
    /// if a load cannot be real.
    fn model(&self) -> Verdict {
        let of_runs = self
            .validity
            .as_ref()
            .map_or(Verdict::Sound, Validity::verdict);
        let is_exact = self.validity.is_none();
        let holds = |axis: &AxisLqg| {
            axis.is_possible() && (is_exact || axis.axis_model().parameters.is_followed())
        };
        if matches!(of_runs, Verdict::Sound) && !self.axes.iter().all(holds) {
            Verdict::Wrong { evidence: None }
        } else {
            of_runs
        }
    }

    /// Takes in the next part of the reference.
    fn look_ahead(&mut self, window: &Window<'_, N>) {
        let servo_s = window.servo_s();
        let end_s = f64::from(self.preview) * servo_s;
        let knots_mm =
            feasible::BEFORE_END_S.map(|before_s| window.at(end_s - before_s).position_mm);
        let beyond = self.axes.iter().enumerate().any(|(i, axis)| {
            let of_axis = |position_mm: [f64; N]| position_mm.get(i).copied().unwrap_or(0.0);
            feasible::is_beyond(axis.axis_model(), knots_mm.map(of_axis))
        });
        self.feasibility
            .take_in(beyond, end_s + self.lag_s, servo_s);
    }

    /// Returns the speed of the path at the lag of the machine, mm/s.
    fn lagging_mm_s(&self, window: &Window<'_, N>) -> [f64; N] {
        let behind_mm = [-self.lag_s, -self.lag_s - window.servo_s()]
            .map(|after_s| window.at(after_s).position_mm);
        scale(1.0 / window.servo_s(), sub(behind_mm[0], behind_mm[1]))
    }
}

impl<const N: usize> Member<N> for LqgIdentified<N> {
    const ROW: ControllerRow = ControllerRow {
        name: "lqg-identified",
        knows: Knows::Identified,
        identifier: Some(IdentifierKind::Axes),
        parameters: &[IDENTIFIED_WEIGHT],
    };

    fn make(data: &ControllerData<'_, N>, values: Values<'_>) -> Option<Self> {
        let model = data.model?;
        let Trained::Axes(identified) = &model.trained else {
            return None;
        };
        let weight = values(&IDENTIFIED_WEIGHT);
        let settings = LqgSettings {
            is_known: data.is_known,
            ..LqgSettings::identified(weight, model.servo_s, data.bounds)
        };
        Some(Self::new(identified.axis_models(), settings))
    }
}

impl<const N: usize> Controller<N> for LqgIdentified<N> {
    fn schedule(&self) -> Schedule {
        Schedule {
            servo_periods: 1,
            preview: self.preview,
        }
    }

    fn reset(&mut self) {
        self.axes.iter_mut().for_each(AxisLqg::forget);
        self.know_nothing();
    }

    fn forget_machine(&mut self) {
        self.reset();
        self.first_use.iter_mut().for_each(FirstUse::forget);
    }

    fn hold_to(&mut self, bounds: OffsetBounds) {
        self.limit_mm_s2 = bounds.acceleration_mm_s2;
        self.axes.iter_mut().for_each(|axis| axis.hold_to(bounds));
    }

    /// Begins anew where the position is lost for longer than it can be predicted: the motion of
    /// the tool is then unknown.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let position_mm = measured
            .map(|measured| measured.position_mm)
            .filter(|mm| norm(*mm).is_finite());
        let Some(position_mm) = position_mm else {
            self.foresee(window);
            return;
        };
        let begins = self.axes.iter().any(AxisLqg::begins);
        let speed_mm_s = if begins {
            self.lagging_mm_s(window)
        } else {
            [0.0; N]
        };
        let measured_axes = window
            .offset_mm
            .into_iter()
            .zip(position_mm)
            .zip(speed_mm_s);
        let mut turned = false;
        let is_alone = self
            .first_use
            .as_ref()
            .is_some_and(|first_use| !first_use.is_shown());
        let is_likely = self.axes.iter().any(AxisLqg::is_learned);
        for (axis, ((offset_mm, position_mm), speed_mm_s)) in
            self.axes.iter_mut().zip(measured_axes)
        {
            turned |= axis.observe(offset_mm, position_mm, speed_mm_s, [is_alone, is_likely]);
        }
        if core::mem::replace(&mut self.lost_s, 0.0) > 0.0 && self.is_elsewhere() {
            self.begin_anew();
            return;
        }
        let seen_mm2 = if is_alone {
            self.seen_alone_mm2(window, position_mm)
        } else {
            None
        };
        if let Some(first_use) = &mut self.first_use {
            first_use.take_in(seen_mm2, window.feed_period_s);
            if turned {
                first_use.begin_model();
            }
        }
        if let Some(validity) = &mut self.validity {
            if turned {
                validity.begin_model();
            }
            let missed_mm = self.axes.each_ref().map(AxisLqg::model_missed_mm);
            let path_mm = window.now().position_mm;
            let mut open_mm = [0.0; N];
            for (i, (axis, open_mm)) in self.axes.iter().zip(&mut open_mm).enumerate() {
                let at_mm = |late_s: f64| {
                    window
                        .at(-self.lag_s - late_s)
                        .position_mm
                        .get(i)
                        .copied()
                        .unwrap_or(0.0)
                };
                *open_mm = axis.open_off_mm(at_mm);
            }
            let by_noise_mm2 = self.axes.iter().map(AxisLqg::by_noise_mm2).sum();
            let moves = window.now().feed_mm_s > 0.0;
            let shown = Shown {
                missed_mm,
                open_mm,
                by_noise_mm2,
                path_mm,
                moves,
            };
            let followed = norm(sub(window.offset_mm, self.asked_mm)) <= FOLLOWED_MM;
            validity.take_in_step(
                OneStep::sum(self.axes.iter().map(AxisLqg::step)),
                window.feed_period_s,
            );
            validity.take_in(&shown, followed, window.feed_period_s);
            if validity.has_machine_changed() {
                self.axes.iter_mut().for_each(AxisLqg::restore_uncertainty);
            }
        }
    }

    fn report(&self) -> SelfReport<N> {
        SelfReport {
            missed_mm: self.missed_mm(),
            model: self.model(),
            moved_mm: Some(
                self.axes
                    .each_ref()
                    .map(|axis| axis.moved_and_missed_mm()[0]),
            ),
            learned: self.axes.each_ref().map(AxisLqg::is_learned),
            acts_at_once: true,
            ..SelfReport::CORRECTS
        }
    }

    fn known(&self) -> Option<[AxisModel; N]> {
        Some(self.axes.each_ref().map(|axis| *axis.axis_model()))
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let here_mm = window.now().position_mm;
        let (mut offset_mm, lag_s) = ([0.0; N], self.lag_s);
        let model_weights = self
            .validity
            .as_ref()
            .map_or(ModelWeights::FULLY, Validity::model_weights);
        self.look_ahead(window);
        self.shaped.take_in(window, self.limit_mm_s2, self.needed_s);
        let open = self.feasibility.open();
        for (i, (axis, offset_mm)) in self.axes.iter_mut().zip(&mut offset_mm).enumerate() {
            // The i-th element exists. `get` avoids a panic that the compiler would leave in.
            let of_axis = |position_mm: [f64; N]| position_mm.get(i).copied().unwrap_or(0.0);
            let late_s = axis.command_delay_s();
            let shaped = &self.shaped;
            let at_mm = |after_s: f64| of_axis(shaped.at_mm(window, after_s + late_s - lag_s));
            *offset_mm = axis.offset_mm(of_axis(here_mm), model_weights, open, at_mm);
        }
        self.asked_mm = offset_mm;
        let share = self.first_use.as_ref().map_or(1.0, FirstUse::share);
        let offset_mm = if share < 1.0 {
            // The regulator must not make up for the part that is left out.
            self.axes.iter_mut().for_each(AxisLqg::forget_decision);
            scale(share, offset_mm)
        } else {
            offset_mm
        };
        Command::straight(1.0, offset_mm)
    }
}
