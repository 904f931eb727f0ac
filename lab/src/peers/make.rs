//! How each controller of the laboratory is made from what is known of a machine: one function for
//! each row, or for several that differ in their laps alone.

use feedwright::Setup;
use feedwright_control::{
    ACCELERATION_GAIN, AxisInverse, AxisModel, AxisState, Controller, FRICTION_GAIN, Feedforward,
    Gains, LqgIdentified, LqgSettings, Parameter, Parameters, Part, VELOCITY_GAIN, Values,
};
use feedwright_sim::{Known, KnownAxis, Period};

use super::closed_loop;
use super::constrained_feedrate::{self, ConstrainedFeedrate, LaggingAxis};
use super::contour_compensation::{self, ContourCompensation};
use super::corner_contour::{self, CornerContour};
use super::cross_coupled::{self, CrossCoupled};
use super::cross_coupled_feedrate::{self, CrossCoupledFeedrate};
use super::disturbance_observer;
use super::disturbance_rejection::{DisturbanceRejection, ObservedAxis, ObservedDrive};
use super::fuzzy_feedrate::{self, FuzzyFeedrate};
use super::h_infinity::{self, FuzzyHInfinity};
use super::input_shaping::{self, InputShaping};
use super::iterative_learning::{self, IterativeLearning};
use super::kalman_disturbance::{self, AxisNoise};
use super::model_predictive::horizon::{CorrectionLimits, HorizonSettings};
use super::model_predictive::{self, ModelPredictive};
use super::sum::Sum;
use super::zero_phase::{self, Filter, SampledAxis, ZeroPhase};

pub(super) fn cross_coupled<const N: usize>(
    _: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    Box::new(pid::<N>(values))
}

/// Cross-coupled control of these gains.
fn pid<const N: usize>(values: Values<'_>) -> CrossCoupled<N> {
    CrossCoupled::new(cross_coupled::Settings {
        kp: values(&cross_coupled::KP),
        ki_1_s: values(&cross_coupled::KI),
        kd_s: values(&cross_coupled::KD),
    })
}

pub(super) fn cross_coupled_feedrate<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let settings = cross_coupled_feedrate::Settings {
        allowed_mm: values(&cross_coupled_feedrate::ALLOWED),
        filter_s: values(&cross_coupled_feedrate::FILTER),
        slowest: values(&cross_coupled_feedrate::SLOWEST),
        acceleration_mm_s2: setup.known.limits.tangential_accel_mm_s2,
    };
    Box::new(CrossCoupledFeedrate::new(settings, pid::<N>(values)))
}

pub(super) fn contour_compensation<const N: usize>(
    _: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let settings = contour_compensation::Settings {
        rate_1_s: values(&contour_compensation::RATE),
        filter_s: values(&contour_compensation::FILTER),
    };
    Box::new(ContourCompensation::new(settings))
}

pub(super) fn fuzzy_feedrate<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    Box::new(fuzzy(setup, values))
}

fn fuzzy(setup: &Setup<'_>, values: Values<'_>) -> FuzzyFeedrate {
    FuzzyFeedrate::new(fuzzy_feedrate::Settings {
        servo_periods: setup
            .known
            .period
            .servo_periods(fuzzy_feedrate::FEED_PERIOD_S),
        error_mm: values(&fuzzy_feedrate::ERROR),
        change_mm_s: values(&fuzzy_feedrate::CHANGE),
        slowest: values(&fuzzy_feedrate::SLOWEST),
        acceleration_mm_s2: setup.known.limits.tangential_accel_mm_s2,
    })
}

pub(super) fn fuzzy_h_infinity<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let noise = AxisNoise {
        drift_mm_s: values(&kalman_disturbance::DRIFT),
        ..AxisNoise::DEFAULT
    };
    let gamma_ratio = values(&h_infinity::GAMMA_RATIO);
    let feedforward = feedforward_with::<N>(
        setup,
        Gains {
            friction: 0.0,
            ..Gains::EXACT
        },
    );
    let axes = observed_axes(&setup.known, |axis| {
        h_infinity::gains(axis, &noise, gamma_ratio)
    });
    let rejection = DisturbanceRejection::new(feedforward, axes, setup.known.period.servo_s);
    Box::new(FuzzyHInfinity::new(rejection, fuzzy(setup, values)))
}

pub(super) fn corner_contour<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let [velocity, acceleration] = [VELOCITY_GAIN, ACCELERATION_GAIN].map(|gain| values(&gain));
    let inverse = feedforward_with::<N>(
        setup,
        Gains {
            velocity,
            acceleration,
            friction: 0.0,
        },
    );
    Box::new(CornerContour::new(
        inverse,
        values(&corner_contour::REACH),
        setup.known.period.servo_s,
    ))
}

pub(super) fn constrained_feedrate<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let settings = constrained_feedrate::Settings {
        servo_periods: setup
            .known
            .period
            .servo_periods(constrained_feedrate::LINE_S),
        allowed_mm: values(&constrained_feedrate::ALLOWED),
        slowest: values(&cross_coupled_feedrate::SLOWEST),
        acceleration_mm_s2: setup.known.limits.tangential_accel_mm_s2,
    };
    let axes = setup.known.axes().map(|KnownAxis { nominal, .. }| {
        let damping_nm_s = nominal.kv_nm_s_per_rad + nominal.viscous_friction_nm_s;
        LaggingAxis {
            kp_1_s: nominal.kp_1_s,
            bandwidth_1_s: damping_nm_s / nominal.inertia_kg_m2,
            reached: nominal.kv_nm_s_per_rad / damping_nm_s,
            fed_forward: nominal.velocity_feedforward,
        }
    });
    Box::new(ConstrainedFeedrate::<N>::new(
        settings,
        axes,
        setup.known.period.servo_s,
    ))
}

/// Feedforward of all three parts, by their gains.
fn full_feedforward<const N: usize>(setup: &Setup<'_>, values: Values<'_>) -> Feedforward<N> {
    let [velocity, acceleration, friction] =
        [VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN].map(|gain| values(&gain));
    feedforward_with(
        setup,
        Gains {
            velocity,
            acceleration,
            friction,
        },
    )
}

/// The part of it that controls have as they are delivered: it is set by the inertia and the gains
/// of the loops, and knows of no delay, integral or filter. A drive that feeds forward by itself
/// was delivered with that, and gets no more: there this is uncorrected.
pub(super) fn feedforward_as_delivered<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let [velocity, acceleration] = [VELOCITY_GAIN, ACCELERATION_GAIN].map(|gain| values(&gain));
    let axes = setup.known.axis_model().map(|axis_model| {
        AxisInverse::new(axis_model.with(|axis| {
            *axis = axis.without(&[Part::Drive, Part::Delays, Part::Friction]);
        }))
    });
    let gains = setup.known.axes::<N>().map(|KnownAxis { nominal, .. }| {
        let feeds_forward =
            nominal.velocity_feedforward > 0.0 || nominal.acceleration_feedforward > 0.0;
        if feeds_forward {
            Gains::NONE
        } else {
            Gains {
                velocity,
                acceleration,
                friction: 0.0,
            }
        }
    });
    Box::new(Feedforward::<N>::new(axes, gains))
}

pub(super) fn feedforward_cross_coupled<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    Box::new(Sum::<_, _, N>::new(
        full_feedforward::<N>(setup, values),
        pid::<N>(values),
    ))
}

/// Feedforward of so much of each part.
fn feedforward_with<const N: usize>(setup: &Setup<'_>, gains: Gains) -> Feedforward<N> {
    Feedforward::new(setup.known.inverse(), [gains; N])
}

pub(super) fn input_shaping<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let settings = input_shaping::Settings {
        frequency_hz: values(&input_shaping::FREQUENCY),
        damping_ratio: values(&input_shaping::DAMPING),
        impulses: values(&input_shaping::IMPULSES) as u32,
    };
    let feedforward = feedforward_with::<N>(setup, Gains::EXACT);
    Box::new(InputShaping::new(
        feedforward,
        &settings,
        setup.known.period.servo_s,
    ))
}

pub(super) fn zero_phase<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    Box::new(inverse::<N>(setup, values))
}

pub(super) fn zero_phase_friction<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let friction = Gains {
        velocity: 0.0,
        acceleration: 0.0,
        friction: values(&FRICTION_GAIN),
    };
    Box::new(Sum::<_, _, N>::new(
        inverse::<N>(setup, values),
        feedforward_with::<N>(setup, friction),
    ))
}

/// The inverse of the closed loop, with scales on its lag and its inertia.
fn inverse<const N: usize>(setup: &Setup<'_>, values: Values<'_>) -> ZeroPhase<N> {
    let (known, servo_s) = (&setup.known, setup.known.period.servo_s);
    let [lag_scale, inertia_scale] =
        [zero_phase::LAG_SCALE, zero_phase::INERTIA_SCALE].map(|scale| values(&scale));
    let plain: [SampledAxis; N] = sampled_axes(known, [lag_scale, inertia_scale]);
    let filters = std::array::from_fn(|i| {
        let axis = known.axis(i);
        let filter = if !axis.nominal.has(Part::Drive) && !axis.nominal.has(Part::Delays) {
            None
        } else {
            closed_loop::inverting(
                axis,
                &scaled(&axis.nominal, [lag_scale, inertia_scale]),
                &known.period,
            )
        };
        filter.unwrap_or_else(|| Filter::new(&plain[i], servo_s))
    });
    ZeroPhase::new(
        filters,
        plain.iter().map(SampledAxis::lag_s).fold(0.0, f64::max),
        servo_s,
    )
}

/// Returns the parameters with a scaled lag and a scaled inertia.
fn scaled(nominal: &Parameters, [lag_scale, inertia_scale]: [f64; 2]) -> Parameters {
    let inertia_kg_m2 = inertia_scale * nominal.inertia_kg_m2;
    Parameters {
        kp_1_s: nominal.kp_1_s / lag_scale,
        inertia_kg_m2,
        ..*nominal
    }
}

/// The linear part of every axis, with scales on its lag and its inertia.
fn sampled_axes<const N: usize>(known: &Known, scales: [f64; 2]) -> [SampledAxis; N] {
    known
        .axes()
        .map(|KnownAxis { nominal, .. }| sampled(&scaled(&nominal, scales), &known.period))
}

pub(super) fn disturbance_observer<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let (bandwidth_hz, servo_s) = (
        values(&disturbance_observer::BANDWIDTH),
        setup.known.period.servo_s,
    );
    let feedforward = feedforward_with::<N>(
        setup,
        Gains {
            friction: 0.0,
            ..Gains::EXACT
        },
    );
    let gains = |axis: &SampledAxis| disturbance_observer::gains(axis, bandwidth_hz, servo_s);
    Box::new(DisturbanceRejection::new(
        feedforward,
        observed_axes(&setup.known, gains),
        servo_s,
    ))
}

pub(super) fn kalman_disturbance<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let noise = AxisNoise {
        drift_mm_s: values(&kalman_disturbance::DRIFT),
        torque_mm_s: values(&kalman_disturbance::TORQUE_NOISE),
        ..AxisNoise::DEFAULT
    };
    let feedforward = feedforward_with::<N>(
        setup,
        Gains {
            friction: values(&FRICTION_GAIN),
            ..Gains::EXACT
        },
    );
    let axes = observed_axes(&setup.known, |axis| kalman_disturbance::gains(axis, &noise));
    Box::new(DisturbanceRejection::new(
        feedforward,
        axes,
        setup.known.period.servo_s,
    ))
}

/// Returns observers of every axis with these gains. The disturbance estimate is limited to the
/// reference speed that demands the torque limit of the drive.
fn observed_axes<const N: usize>(
    known: &Known,
    gains: impl Fn(&SampledAxis) -> [f64; 3],
) -> [ObservedAxis; N] {
    let axes: [SampledAxis; N] = sampled_axes(known, [1.0; 2]);
    std::array::from_fn(|i| {
        let nominal = known.axis(i).nominal;
        let limit_mm_s = nominal.torque_limit_nm / (nominal.kv_nm_s_per_rad * nominal.rad_per_mm);
        let fed_nm_s2 = nominal.acceleration_feedforward * nominal.inertia_kg_m2;
        let drive = ObservedDrive {
            velocity_feedforward: nominal.velocity_feedforward,
            torque_1_s: fed_nm_s2
                / (nominal.kv_nm_s_per_rad * known.period.servo_s * known.period.servo_s),
            speed_integral_s: nominal.speed_integral_s,
            delay_s: nominal.drive_delay_s + nominal.measurement_delay_s,
            command_periods: nominal.command_periods(known.period.servo_s),
        };
        ObservedAxis {
            axis: axes[i],
            drive,
            limit_mm_s,
            gains: gains(&axes[i]),
        }
    })
}

/// The linear part of an axis over one servo period, as the plant integrates it.
pub(super) fn sampled(axis: &Parameters, period: &Period) -> SampledAxis {
    let linear = Parameters {
        torque_limit_nm: f64::INFINITY,
        coulomb_friction_nm: 0.0,
        ..*axis
    };
    let axis_model = AxisModel::new(linear, period.periods());
    let over = |speed_rad_s: f64, reference_rad_s: f64| {
        let mut state = AxisState {
            speed_rad_s,
            ..AxisState::default()
        };
        for _ in 0..period.mechanics_per_servo {
            let w = state.speed_rad_s;
            axis_model.accelerate(
                axis_model.torque_nm(reference_rad_s, w) - axis_model.friction_nm(w, 0.0),
                &mut state,
            );
        }
        (state.speed_rad_s, state.angle_rad)
    };
    let ((alpha, gamma_s), (beta, delta_s)) = (over(1.0, 0.0), over(0.0, 1.0));
    SampledAxis {
        alpha,
        beta,
        gamma_s,
        delta_s,
        kp_1_s: axis.kp_1_s,
        kd: axis.kd,
    }
}

pub(super) fn model_predictive<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let mut horizon = HorizonSettings::<N>::DEFAULT;
    (horizon.knots, horizon.rate_weight) = (
        values(&model_predictive::KNOTS) as usize,
        values(&model_predictive::RATE_WEIGHT),
    );
    horizon.limits = CorrectionLimits::of(&setup.known);
    let servo_periods = setup
        .known
        .period
        .servo_periods(values(&model_predictive::PLAN_PERIOD_S));
    Box::new(ModelPredictive::new(
        &setup.known,
        model_predictive::Settings {
            servo_periods,
            horizon,
        },
    ))
}

pub(super) const CONTROL_WEIGHT: Parameter = Parameter::number(
    "control_weight_s2",
    LqgSettings::DEFAULT.control_weight_s2,
    [1e-12, 1e-2],
    Some([1e-11, 1e-3]),
    "weight of the reference speed against the error, s^2: a low one rings between servo periods, a high one leaves the error",
);

pub(super) fn lqg_preview<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let settings = LqgSettings {
        control_weight_s2: values(&CONTROL_WEIGHT),
        bounds: feedwright_control::OffsetBounds {
            acceleration_mm_s2: f64::INFINITY,
            ..setup.offset_bounds()
        },
        ..LqgSettings::DEFAULT
    };
    Box::new(LqgIdentified::new(setup.truth::<N>(), settings))
}

pub(super) fn iterative_learning<const N: usize>(
    setup: &mut Setup<'_>,
    values: Values<'_>,
) -> Box<dyn Controller<N>> {
    let settings = iterative_learning::Settings {
        gain: values(&iterative_learning::GAIN),
        lead_s: values(&iterative_learning::LEAD_S),
        cut_off_hz: values(&iterative_learning::CUT_OFF_HZ),
        ..iterative_learning::Settings::DEFAULT
    };
    Box::new(IterativeLearning::new(settings, setup.known.period.servo_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_sim::Machine;

    /// Rounding of a few hundred products of positions of about 1 rad.
    const TOLERANCE: f64 = 1e-9;

    #[test]
    fn a_p_speed_loop_inverted_as_any_other_has_the_filter_in_closed_form() {
        let mut machine = Machine::load("tnv40".as_ref()).unwrap();
        machine.axes[0].kd = 0.02;
        let known = machine.known();
        let axis = known.axis(0);
        let filter = closed_loop::inverting(axis, &axis.nominal, &known.period).unwrap();
        let plain = Filter::new(&sampled(&axis.nominal, &known.period), known.period.servo_s);
        for (weight, wanted) in filter.weights().iter().zip(plain.weights()) {
            assert!((weight - wanted).abs() < TOLERANCE, "{filter:?} {plain:?}");
        }
    }
}
