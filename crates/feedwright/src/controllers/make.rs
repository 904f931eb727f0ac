//! How each controller of the table is made from what is known of a machine, and from a model: one function for each row.

use feedwright_control::{
    Controller, CorrectionLimits, Feedforward, Gains, Gradient, HorizonSettings, InvertingSettings, LqgPreview,
    LqgSettings, MagnitudeOnly, OffsetBounds, RecedingHorizon, RecedingHorizonSettings, TwoDimensional, Uncorrected,
};
use feedwright_sim::Known;

use super::Setup;
use super::parameters::Values;

pub(super) fn feedforward<const N: usize>(setup: &mut Setup<'_>, values: &Values) -> Box<dyn Controller<N>> {
    let [velocity, acceleration, friction] =
        ["velocity_gain", "acceleration_gain", "friction_gain"].map(|name| values.number(name));
    Box::new(Feedforward::<N>::new(setup.known.inverse(), [Gains { velocity, acceleration, friction }; N]))
}

pub(super) fn lqg_identified<const N: usize>(setup: &mut Setup<'_>, values: &Values) -> Box<dyn Controller<N>> {
    let bounds = offset_bounds(&setup.known);
    let settings = LqgSettings::identified(values.number("control_weight"), setup.known.period.servo_s, bounds);
    match setup.axes::<N>() {
        Some(identified) => Box::new(LqgPreview::new(identified.axes, settings)),
        None => Box::new(Uncorrected),
    }
}

pub(super) fn magnitude_only<const N: usize>(setup: &mut Setup<'_>, values: &Values) -> Box<dyn Controller<N>> {
    let mut settings = inverting(setup, values);
    settings.inversion.gradient = Gradient::Exact;
    Box::new(MagnitudeOnly::new(setup.contour(values.number("feed_period_s")), settings))
}

pub(super) fn two_dimensional<const N: usize>(setup: &mut Setup<'_>, values: &Values) -> Box<dyn Controller<N>> {
    let settings = inverting(setup, values);
    Box::new(TwoDimensional::new(setup.contour(values.number("feed_period_s")), settings))
}

pub(super) fn receding_horizon<const N: usize>(setup: &mut Setup<'_>, values: &Values) -> Box<dyn Controller<N>> {
    let (net, spread) = setup.servo(values.number("feed_period_s"));
    let mut settings = RecedingHorizonSettings::<N>::DEFAULT;
    settings.servo_periods = setup.known.period.servo_periods(values.number("feed_period_s"));
    (settings.steps, settings.innovation_scale_mm, settings.foreseen_mm) =
        (values.whole("steps"), values.number("innovation_scale_mm"), values.number("foreseen_mm"));
    settings.horizon = HorizonSettings {
        knots: values.whole("knots"),
        rate_weight: values.number("rate_weight_s2"),
        change_weight: values.number("change_weight_s2"),
        tangential_weight: values.number("tangential_weight"),
        last_weight: values.number("last_weight"),
        on_rapids: values.is_on("on_rapids"),
        limits: correction_limits(&setup.known),
        ..settings.horizon
    };
    let controller: RecedingHorizon<N> = RecedingHorizon::new(net, &spread, settings);
    Box::new(controller)
}

/// Part of the largest deviation that a plan uses: the rest is for what it misses, before the supervisor acts.
const PLANNED_DEVIATION: f64 = 0.9;

/// What a machine allows a correction.
pub fn correction_limits<const N: usize>(known: &Known) -> CorrectionLimits<N> {
    CorrectionLimits {
        acceleration_mm_s2: std::array::from_fn(|i| known.axis(i).correction_accel_mm_s2),
        speed_mm_s: known.limits.rapid_mm_s,
        deviation_mm: PLANNED_DEVIATION * known.limits.max_deviation_mm,
        drive_mm_s2: std::array::from_fn(|i| known.axis(i).drive_mm_s2()),
    }
}

/// What the supervisor holds an offset to.
pub fn offset_bounds(known: &Known) -> OffsetBounds {
    let limits = known.limits;
    OffsetBounds { largest_mm: limits.max_deviation_mm, fastest_mm_s: limits.rapid_mm_s }
}

/// Settings of the controllers that invert the paper's identifier.
fn inverting(setup: &Setup<'_>, values: &Values) -> InvertingSettings {
    let mut settings = InvertingSettings::DEFAULT;
    settings.servo_periods = setup.known.period.servo_periods(values.number("feed_period_s"));
    (settings.knots, settings.learning_step) = (values.whole("knots"), values.number("learning_step"));
    (settings.inversion.rho, settings.inversion.eta) = (values.number("rho"), values.number("eta"));
    settings.inversion.steps = values.whole("steps");
    settings
}
