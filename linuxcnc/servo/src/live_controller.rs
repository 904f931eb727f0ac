//! The controllers that can stand in the link, by the kind of the model: the regulator of
//! identified axes, or the paper's two.

use feedwright_control::{
    Bounds, Command, Controller, FaultEvidence, IDENTIFIED_WEIGHT, InvertingSettings, LqgPreview,
    LqgSettings, MagnitudeOnly, Measured, OffsetBounds, Schedule, TwoDimensional, Window,
};

use crate::machine::{LinkModel, TrainedContour};

/// A controller in the link, and the feedrate that it asks the control for.
///
/// A controller that changes the feedrate says so to the control, whose planner goes by it. Here
/// time is what the control makes of it, and goes on as it is.
#[derive(Debug, Clone)]
pub struct LiveController<const N: usize> {
    kind: Kind<N>,
    /// Last requested feedrate, as a multiple of the present feedrate.
    rate: f64,
}

/// One of them.
#[derive(Debug, Clone)]
enum Kind<const N: usize> {
    /// `lqg-identified`.
    Regulator(LqgPreview<N>),
    /// `two-dimensional` or `magnitude-only`.
    Inversion(Inversion<N>),
}

/// The paper's controllers, with one identifier.
#[derive(Debug, Clone)]
struct Inversion<const N: usize> {
    both: TwoDimensional<N>,
    magnitude: MagnitudeOnly<N>,
    speed_alone: bool,
}

impl<const N: usize> Inversion<N> {
    fn new(contour: &TrainedContour<N>) -> Self {
        let settings = InvertingSettings {
            // A float that is not a number, or below zero, saturates to 0.
            servo_periods: (libm::round(contour.feed_period_s / contour.servo_s) as u32)
                .clamp(1, MOST_PERIODS),
            is_planned_elsewhere: true,
            ..InvertingSettings::DEFAULT
        };
        Self {
            both: TwoDimensional::on_trial(contour.identifier.clone(), settings, RESPONSE_S),
            magnitude: MagnitudeOnly::exact(contour.identifier.clone(), settings),
            speed_alone: false,
        }
    }

    fn chosen(&self) -> &dyn Controller<N> {
        if self.speed_alone {
            &self.magnitude
        } else {
            &self.both
        }
    }

    fn chosen_mut(&mut self) -> &mut dyn Controller<N> {
        if self.speed_alone {
            &mut self.magnitude
        } else {
            &mut self.both
        }
    }
}

/// Response time of the speed loops, s, for the trial of `two-dimensional`: its model does not
/// state the axes. The speed loops of the machine files of this repository respond within 2 to 12
/// ms, `tnv40` within 6.
const RESPONSE_S: f64 = 0.006;
/// Servo periods between decisions that a link keeps commands for.
const MOST_PERIODS: u32 = 100;

impl<const N: usize> LiveController<N> {
    /// Creates the controller for a model, with a servo period of `servo_s`. Unless `is_known`, the
    /// regulator corrects nothing before motion has shown that the model is of this machine.
    pub fn new(model: &LinkModel<N>, servo_s: f64, is_known: bool) -> Self {
        let kind = match model {
            LinkModel::Axes(identified) => {
                let settings =
                    LqgSettings::identified(IDENTIFIED_WEIGHT, servo_s, OffsetBounds::NONE);
                let settings = LqgSettings {
                    is_known,
                    ..settings
                };
                Kind::Regulator(LqgPreview::new(identified.axis_models(), settings))
            }
            LinkModel::Contour(contour) => Kind::Inversion(Inversion::new(contour)),
        };
        Self { kind, rate: 1.0 }
    }

    /// Holds the offset to these bounds, where the supervisor alone does not.
    pub fn hold_to(&mut self, bounds: &Bounds) {
        if let Kind::Regulator(regulator) = &mut self.kind {
            regulator.hold_to(OffsetBounds {
                largest_mm: bounds.deviation_mm,
                fastest_mm_s: bounds.speed_mm_s,
            });
        }
    }

    /// Another machine may be there.
    pub fn forget_machine(&mut self) {
        match &mut self.kind {
            Kind::Regulator(regulator) => regulator.forget_machine(),
            Kind::Inversion(_) => self.reset(),
        }
    }

    /// Sets whether the paper's controllers leave the geometry on the path. Takes effect at rest.
    pub fn change_speed_alone(&mut self, speed_alone: bool) {
        if let Kind::Inversion(inversion) = &mut self.kind {
            inversion.speed_alone = speed_alone;
        }
    }

    /// Returns the last requested feedrate, as a multiple of the present feedrate.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Servo periods of path that the controller needs ahead. The regulator needs one, and uses
    /// more if they are known.
    pub fn looks_ahead(&self) -> u64 {
        match &self.kind {
            Kind::Regulator(_) => 1,
            Kind::Inversion(inversion) => {
                let Schedule {
                    servo_periods,
                    preview,
                } = inversion.chosen().schedule();
                u64::from(servo_periods) * u64::from(preview)
            }
        }
    }

    /// Returns the interval of decisions and the preview, for a path that is known `ahead` servo
    /// periods ahead. The regulator previews all of it; the paper's controllers keep their own
    /// preview.
    pub fn schedule_within(&self, ahead: u32) -> Schedule {
        match &self.kind {
            Kind::Regulator(_) => Schedule {
                servo_periods: 1,
                preview: ahead,
            },
            Kind::Inversion(inversion) => inversion.chosen().schedule(),
        }
    }

    fn as_controller(&self) -> &dyn Controller<N> {
        match &self.kind {
            Kind::Regulator(regulator) => regulator,
            Kind::Inversion(inversion) => inversion.chosen(),
        }
    }

    fn as_controller_mut(&mut self) -> &mut dyn Controller<N> {
        match &mut self.kind {
            Kind::Regulator(regulator) => regulator,
            Kind::Inversion(inversion) => inversion.chosen_mut(),
        }
    }
}

impl<const N: usize> Controller<N> for LiveController<N> {
    fn schedule(&self) -> Schedule {
        self.as_controller().schedule()
    }

    fn reset(&mut self) {
        self.as_controller_mut().reset();
        self.rate = 1.0;
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        self.as_controller_mut().observe(window, measured);
    }

    fn prediction_error_mm(&self) -> f64 {
        self.as_controller().prediction_error_mm()
    }

    fn doubt(&self) -> Option<FaultEvidence> {
        self.as_controller().doubt()
    }

    fn learned(&self) -> [bool; N] {
        self.as_controller().learned()
    }

    fn moved_mm(&self) -> Option<[f64; N]> {
        self.as_controller().moved_mm()
    }

    fn acts_at_once(&self) -> bool {
        self.as_controller().acts_at_once()
    }

    fn corrects(&self) -> bool {
        self.as_controller().corrects()
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let asked = self.as_controller_mut().command(window, measured);
        let is_asked_for = asked.rate.is_finite();
        self.rate = if is_asked_for { asked.rate } else { 1.0 };
        // What is not a number is for the supervisor to see.
        Command {
            rate: if is_asked_for { 1.0 } else { asked.rate },
            ..asked
        }
    }
}
