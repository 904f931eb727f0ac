//! The controller behind a share that fades in and out, and what it says of itself.
//!
//! A controller that changes the feedrate says so to the control, whose planner goes by it: here time is what the control makes of it, and goes on as it is.

use crate::live_controller::LiveController;
use crate::machine::LinkModel;
use crate::trust::Trust;
use feedwright_control::vector::{norm, scale, sub};
use feedwright_control::{Bounds, OffsetBounds, locate};
use feedwright_control::{Command, Controller, Measured, Schedule, Window};

/// Time in which the correction comes in, and in which it goes, s. A machine that begins to cut where it stands has some 0.1 s until the path bends. With 0.065 s
/// a helix and an eight that begin so are cut within 2.1 and 6 um, with 0.1 s the helix within 3.9, with 0.03 s the eight within 17: it is then ahead of where it
/// is to be. In a straight line both come out nearer than by an S of the same time.
const IN_S: f64 = 0.065;
const FADE_S: f64 = 0.3;
/// Time in which one goes that is worth nothing, s.
const OUT_S: f64 = 0.1;
/// A correction of which a share is asked for.
#[derive(Debug, Clone)]
pub struct Correction<const N: usize> {
    controller: LiveController<N>,
    /// How much of it, 0 to 1, on a line of time.
    share: f64,
    followed: bool,
    /// What was asked for last, mm.
    wanted_mm: [f64; N],
    /// Contour error that there would be without it, by the model, mm.
    without_mm: f64,
    /// Last requested feedrate, as a multiple of the present feedrate.
    rate: f64,
    /// Of axes that are identified.
    trust: Option<Trust<N>>,
}

impl<const N: usize> Correction<N> {
    /// By a model, with a servo period of `servo_s`.
    pub fn new(model: &LinkModel<N>, servo_s: f64) -> Self {
        let controller = LiveController::new(model, servo_s);
        let trust = match (model, &controller) {
            (LinkModel::Axes(identified), LiveController::Regulator(regulator)) => {
                Some(Trust::new(identified, regulator))
            }
            _ => None,
        };
        Self { controller, share: 0.0, followed: true, wanted_mm: [0.0; N], without_mm: 0.0, rate: 1.0, trust }
    }

    /// Holds the offset to these bounds.
    pub fn hold_to(&mut self, bounds: &Bounds) {
        let (largest_mm, fastest_mm_s) = (bounds.deviation_mm, bounds.speed_mm_s);
        self.controller.hold_to(OffsetBounds { largest_mm, fastest_mm_s });
    }

    /// Whether the paper's controllers leave the geometry on the path. Taken over at rest.
    pub fn change_speed_alone(&mut self, speed_alone: bool) {
        self.controller.change_speed_alone(speed_alone);
    }

    /// Returns the last requested feedrate, as a multiple of the present feedrate.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Servo periods that it has to see ahead.
    pub fn looks_ahead(&self) -> u64 {
        self.controller.looks_ahead()
    }

    /// Returns the interval of decisions and the preview, for a path that is known `ahead` servo
    /// periods ahead. The regulator previews all of it; the paper's controllers keep their own
    /// preview.
    pub fn schedule_within(&self, ahead: u32) -> Schedule {
        self.controller.schedule_within(ahead)
    }

    /// Whether it is not tried any more: its model is wrong.
    pub fn is_lost(&self) -> bool {
        self.trust.as_ref().is_some_and(Trust::is_lost)
    }

    /// Whether it is to stay out of the loop for what its model is worth.
    pub fn is_out(&self) -> bool {
        self.is_lost() || !self.is_proven()
    }

    fn is_proven(&self) -> bool {
        self.trust.as_ref().is_none_or(Trust::is_proven)
    }

    /// Whether it waits because the machine does not move as its model says.
    pub fn is_refuted(&self) -> bool {
        self.trust.as_ref().is_some_and(Trust::is_refuted)
    }

    /// Another machine may be there.
    pub fn forgive(&mut self) {
        if let Some(trust) = &mut self.trust {
            trust.forgive();
        }
    }

    /// A servo period on the way in or out.
    ///
    /// `followed` says whether the safety layer has it in the loop: one that was taken out comes back as it came in.
    pub fn fade(&mut self, enabled: bool, followed: bool, servo_s: f64) {
        self.followed = followed;
        if !followed {
            self.share = 0.0;
        }
        let step = match (enabled && self.is_proven(), self.is_lost()) {
            (_, true) => -servo_s / OUT_S,
            (true, _) => servo_s / IN_S,
            (false, _) => -servo_s / FADE_S,
        };
        self.share = (self.share + step).clamp(0.0, 1.0);
        if self.share == 0.0 {
            self.rate = 1.0;
            if let Some(trust) = &mut self.trust {
                trust.wait(servo_s);
            }
        }
    }

    /// Out of the loop at once.
    pub fn restart(&mut self) {
        self.controller.reset();
        if let Some(trust) = &mut self.trust {
            trust.restart();
        }
        (self.share, self.rate, self.wanted_mm, self.without_mm) = (0.0, 1.0, [0.0; N], 0.0);
    }

    /// What was asked for last, mm.
    pub fn wanted_mm(&self) -> [f64; N] {
        self.wanted_mm
    }

    /// Contour error that there would be without it, by the model, mm.
    pub fn without_mm(&self) -> f64 {
        self.without_mm
    }
}

impl<const N: usize> Controller<N> for Correction<N> {
    fn schedule(&self) -> Schedule {
        self.controller.schedule()
    }

    fn acts_at_once(&self) -> bool {
        self.controller.acts_at_once()
    }

    fn reset(&mut self) {
        self.restart();
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        self.controller.observe(window, measured);
    }

    fn prediction_error_mm(&self) -> f64 {
        self.controller.prediction_error_mm()
    }

    fn moved_mm(&self) -> Option<[f64; N]> {
        self.controller.moved_mm()
    }

    fn foreseen_mm2(&self) -> [f64; 2] {
        self.controller.foreseen_mm2()
    }

    fn judged(&mut self, overdone: f64) {
        self.controller.judged(overdone);
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let full = self.controller.command(window, measured);
        let moved_mm = self.controller.moved_mm().unwrap_or([0.0; N]);
        let (index, reach) = (measured.contour.index, measured.contour.index.saturating_neg());
        let without = locate(window, sub(measured.position_mm, moved_mm), index, reach);
        self.without_mm = norm(without.vector_mm);
        let share = self.share;
        if let Some(trust) = &mut self.trust {
            trust.take_in(window, measured, self.followed.then_some(share), self.without_mm);
        }
        self.wanted_mm = scale(share, full.offset_mm);
        let is_asked_for = full.rate.is_finite();
        self.rate = if is_asked_for { 1.0 + share * (full.rate - 1.0) } else { 1.0 };
        // What is not a number is for the safety layer to see.
        Command { rate: if is_asked_for { 1.0 } else { full.rate }, offset_mm: self.wanted_mm, ..full }
    }
}
