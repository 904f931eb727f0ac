//! The controller behind a share that fades in and out, and what it says of itself.

use crate::trust::Trust;
use feedwright_control::contour_error::locate;
use feedwright_control::controller::lqg_preview::{IDENTIFIED_PRICE, LqgPreview, OffsetBounds, Settings};
use feedwright_control::model::IdentifiedAxes;
use feedwright_control::safety::Bounds;
use feedwright_control::vector::{norm, scale, smooth_step, sub};
use feedwright_control::{Command, Controller, Measured, Schedule, Window};

/// Time in which the correction comes in or goes, s.
const FADE_S: f64 = 0.3;
/// Time in which one goes that is worth nothing, s.
const OUT_S: f64 = 0.1;
/// A correction of which a share is asked for.
#[derive(Debug, Clone)]
pub struct Correction<const N: usize> {
    controller: LqgPreview<N>,
    /// How much of it, 0 to 1, on a line of time.
    share: f64,
    followed: bool,
    /// What was asked for last, mm.
    wanted_mm: [f64; N],
    /// Contour error that there would be without it, by the model, mm.
    without_mm: f64,
    trust: Trust<N>,
}

impl<const N: usize> Correction<N> {
    /// By identified axes, with a servo period of `servo_s`.
    pub fn new(identified: &IdentifiedAxes<N>, servo_s: f64) -> Self {
        let settings = Settings::identified(IDENTIFIED_PRICE, servo_s, OffsetBounds::NONE);
        let controller = LqgPreview::new(identified.axes, settings);
        Self {
            controller,
            share: 0.0,
            followed: true,
            wanted_mm: [0.0; N],
            without_mm: 0.0,
            trust: Trust::new(identified),
        }
    }

    /// Holds the offset to these bounds.
    pub fn hold_to(&mut self, bounds: &Bounds) {
        let (largest_mm, fastest_mm_s) = (bounds.deviation_mm, bounds.speed_mm_s);
        self.controller.hold_to(OffsetBounds { largest_mm, fastest_mm_s });
    }

    /// Whether it is not tried any more: its model is wrong.
    pub fn is_lost(&self) -> bool {
        self.trust.is_lost()
    }

    /// Another machine may be there.
    pub fn forgive(&mut self) {
        self.trust.forgive();
    }

    /// A servo period on the way in or out.
    ///
    /// `followed` says whether the safety layer has it in the loop: one that was taken out comes back as it came in.
    pub fn fade(&mut self, enabled: bool, followed: bool, servo_s: f64) {
        self.followed = followed;
        if !followed {
            self.share = 0.0;
        }
        let step = match (enabled, self.is_lost()) {
            (_, true) => -servo_s / OUT_S,
            (true, _) => servo_s / FADE_S,
            (false, _) => -servo_s / FADE_S,
        };
        self.share = (self.share + step).clamp(0.0, 1.0);
        if self.share == 0.0 {
            self.trust.wait(servo_s);
        }
    }

    /// Out of the loop at once.
    pub fn restart(&mut self) {
        self.controller.reset();
        self.trust.restart();
        (self.share, self.wanted_mm, self.without_mm) = (0.0, [0.0; N], 0.0);
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
        let share = self.followed.then_some(smooth_step(self.share));
        self.trust.take_in(window, measured, share, self.without_mm);
        self.wanted_mm = scale(smooth_step(self.share), full.offset_mm);
        Command { offset_mm: self.wanted_mm, ..full }
    }
}
