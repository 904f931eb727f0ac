//! How each controller of the table is made from what is known of a machine, and from a model: one
//! function for each row.

use feedwright_control::{
    Controller, Feedforward, Gains, InvertingSettings, LqgPreview, LqgSettings, MagnitudeOnly,
    OffsetBounds, TwoDimensional, Uncorrected,
};
use feedwright_sim::{Known, KnownAxis};

use super::Setup;
use super::parameters::Values;

pub(super) fn feedforward<const N: usize>(
    setup: &mut Setup<'_>,
    values: &Values,
) -> Box<dyn Controller<N>> {
    let [velocity, acceleration, friction] =
        ["velocity_gain", "acceleration_gain", "friction_gain"].map(|name| values.number(name));
    Box::new(Feedforward::<N>::new(
        setup.known.inverse(),
        [Gains {
            velocity,
            acceleration,
            friction,
        }; N],
    ))
}

pub(super) fn lqg_identified<const N: usize>(
    setup: &mut Setup<'_>,
    values: &Values,
) -> Box<dyn Controller<N>> {
    let bounds = offset_bounds(&setup.known);
    let settings = LqgSettings::identified(
        values.number("control_weight"),
        setup.known.period.servo_s,
        bounds,
    );
    match setup.axes::<N>() {
        Some(identified) => Box::new(LqgPreview::new(identified.axis_models(), settings)),
        None => Box::new(Uncorrected),
    }
}

pub(super) fn magnitude_only<const N: usize>(
    setup: &mut Setup<'_>,
    values: &Values,
) -> Box<dyn Controller<N>> {
    let settings = inverting(setup, values);
    Box::new(MagnitudeOnly::exact(
        setup.contour(values.number("feed_period_s")),
        settings,
    ))
}

pub(super) fn two_dimensional<const N: usize>(
    setup: &mut Setup<'_>,
    values: &Values,
) -> Box<dyn Controller<N>> {
    let response_s = setup
        .known
        .axes::<N>()
        .map(|axis| response_s(&axis))
        .into_iter()
        .fold(0.0, f64::max);
    let settings = inverting(setup, values);
    let identifier = setup.contour(values.number("feed_period_s"));
    Box::new(if setup.choices.tries {
        TwoDimensional::on_trial(identifier, settings, response_s)
    } else {
        TwoDimensional::untried(identifier, settings)
    })
}

/// Returns the bounds that the supervisor applies to an offset.
pub fn offset_bounds(known: &Known) -> OffsetBounds {
    let limits = known.limits;
    OffsetBounds {
        largest_mm: limits.max_deviation_mm,
        fastest_mm_s: limits.rapid_mm_s,
    }
}

/// Time in which the speed loop of an axis responds: its time constant, and the delays of bus and
/// encoder.
fn response_s(KnownAxis { nominal, .. }: &KnownAxis) -> f64 {
    let damping_nm_s = nominal.kv_nm_s_per_rad + nominal.viscous_friction_nm_s;
    nominal.inertia_kg_m2 / damping_nm_s + nominal.drive_delay_s + nominal.measurement_delay_s
}

/// Settings of the controllers that invert the paper's identifier.
fn inverting(setup: &Setup<'_>, values: &Values) -> InvertingSettings {
    let mut settings = InvertingSettings::DEFAULT;
    settings.servo_periods = setup
        .known
        .period
        .servo_periods(values.number("feed_period_s"));
    (settings.knots, settings.learning_step) =
        (values.whole("knots"), values.number("learning_step"));
    (settings.inversion.rho, settings.inversion.eta) = (values.number("rho"), values.number("eta"));
    settings.inversion.steps = values.whole("steps");
    settings
}
