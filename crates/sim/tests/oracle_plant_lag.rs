//! The plant against closed forms of its lag on a straight line: what feedforward, latencies,
//! friction, cogging and noise do to it.
//!
//! At constant speed v, under a torque T that the speed loop has to hold, both in rad of the motor,
//! the axis model gives
//!
//! ```text
//! lag = ((1 - fv) v + T / Kv) / Kp - v d,     (1 - fa) J a / (Kv Kp) more at an acceleration a
//! ```
//!
//! with d the latency of the measurement; the delay of the drive and its filter move nothing that
//! is constant, and with an integral in the speed loop T is nothing.

use feedwright_sim::{Axis, Machine, Plant};

const SPEED_MM_S: f64 = 20.0;

/// tnv40 with nothing but its loops and its inertia, x and y alike, and what `change` adds.
fn machine(change: impl Fn(&mut Axis)) -> Machine {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    let mut axis = machine.axes[0];
    (
        axis.viscous_friction_nm_s,
        axis.coulomb_friction_nm,
        axis.disturbance_nm,
    ) = (0.0, 0.0, 0.0);
    change(&mut axis);
    machine.axes = vec![axis; 2];
    machine
}

/// Returns the lag of the tool behind the command, um, at the start of each servo period of a
/// second, after one second to settle. x moves by `way_mm`, y by its negative.
fn lags_um(machine: &Machine, way_mm: impl Fn(f64) -> f64) -> [Vec<f64>; 2] {
    let mut plant = Plant::<2>::new(machine, [0.0; 2]);
    let (mut at_mm, mut lags_um) = ([0.0; 2], [vec![], vec![]]);
    for n in 0..2000_u32 {
        let way_mm = way_mm(f64::from(n) * machine.period.servo_s);
        if n >= 1000 {
            lags_um[0].push((way_mm - at_mm[0]) * 1e3);
            lags_um[1].push((at_mm[1] + way_mm) * 1e3);
        }
        at_mm = plant.step([way_mm, -way_mm]).position_mm;
    }
    lags_um
}

fn at_speed_um(machine: &Machine) -> [Vec<f64>; 2] {
    lags_um(machine, |t_s| SPEED_MM_S * t_s)
}

/// Deflection of the tool under a constant torque that the speed loop has to hold, um.
fn yields_um(axis: &Axis, torque_nm: f64) -> f64 {
    torque_nm / (axis.kv_nm_s_per_rad * axis.kp_1_s * axis.rad_per_mm()) * 1e3
}

fn near(found: &[f64], wanted: f64, most: f64) {
    for value in found {
        assert!(
            (value - wanted).abs() <= most,
            "{value} um, {wanted} um wanted"
        );
    }
}

#[test]
fn feedforward_takes_its_part_of_the_lag_and_latency_gives_some_back() {
    for (part, measured_late_s, drive_late_s) in [
        (0.0, 0.0, 0.0),
        (0.5, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        (0.0, 0.0013, 0.0),
        (0.9, 0.003, 0.0),
        (0.3, 0.001, 0.0017),
    ] {
        for corner_hz in [0.0, 300.0] {
            let machine = machine(|axis| {
                axis.velocity_feedforward = part;
                axis.torque_filter_hz = corner_hz;
                (axis.measurement_delay_s, axis.drive_delay_s) = (measured_late_s, drive_late_s);
            });
            let wanted =
                SPEED_MM_S * 1e3 * ((1.0 - part) / machine.axes[0].kp_1_s - measured_late_s);
            at_speed_um(&machine)
                .iter()
                .for_each(|lags| near(lags, wanted, 1e-3));
        }
    }
}

#[test]
fn acceleration_feedforward_takes_its_part_of_what_the_inertia_costs() {
    // c = a t^2 / 2: the lag grows with the speed, and what two machines differ by is constant.
    let acceleration_mm_s2 = 30.0;
    let lags = |part: f64| {
        lags_um(
            &machine(|axis| axis.acceleration_feedforward = part),
            |t_s| 0.5 * acceleration_mm_s2 * t_s * t_s,
        )
    };
    let (without, axis) = (lags(0.0), machine(|_| {}).axes[0]);
    let torque_nm = axis.inertia_kg_m2 * acceleration_mm_s2 * axis.rad_per_mm();
    for part in [0.4, 1.0] {
        for (lags, without) in lags(part).iter().zip(&without) {
            let less: Vec<f64> = without
                .iter()
                .zip(lags)
                .map(|(without, with)| without - with)
                .collect();
            near(&less, yields_um(&axis, part * torque_nm), 1e-3);
        }
    }
}

#[test]
fn a_window_of_the_speed_takes_what_the_speed_is_seen_late_by_from_the_lag() {
    // The loop sees w - L a: lag = (v + (J / Kv - L) a) / Kp, with L half of what the window is
    // longer than a mechanics period.
    let acceleration_mm_s2 = 30.0;
    let lags = |window_s: f64, is_held: bool| {
        let machine = machine(|axis| (axis.speed_window_s, axis.speed_held) = (window_s, is_held));
        lags_um(&machine, |t_s| 0.5 * acceleration_mm_s2 * t_s * t_s)
    };
    let (kp_1_s, without) = (machine(|_| ()).axes[0].kp_1_s, lags(0.0, false));
    for (window_s, is_held, late_s) in [
        (0.00305, false, 0.001_475),
        (0.002, true, 0.0014),
        (0.0, true, 0.000_45),
    ] {
        let wanted_um = 1e3 * acceleration_mm_s2 * late_s / kp_1_s;
        for (with, without) in lags(window_s, is_held).iter().zip(&without) {
            let taken: Vec<f64> = without
                .iter()
                .zip(with)
                .map(|(without, with)| without - with)
                .collect();
            near(&taken, wanted_um, 0.01 * wanted_um);
        }
    }
}

#[test]
fn the_speed_limit_is_the_speed_and_the_lag_grows() {
    let limited = machine(|axis| axis.speed_limit_mm_s = 15.0);
    for lags in at_speed_um(&limited) {
        let grows = (lags[999] - lags[0]) / 0.999;
        assert!((grows - 5000.0).abs() < 1.0, "{grows} um/s");
    }
}

#[test]
fn friction_costs_its_level_each_way_and_an_integral_takes_it() {
    // Behind the presliding, and at ten times the Stribeck speed, the level is Fc + Fa d.
    for presliding_um in [0.0, 10.0] {
        let with_friction = |integral_s: f64| {
            machine(|axis| {
                (axis.coulomb_friction_nm, axis.coulomb_asymmetry_nm) = (0.3, 0.05);
                (axis.stribeck_nm, axis.stribeck_mm_s) = (0.1, 2.0);
                (axis.presliding_um, axis.speed_integral_s) = (presliding_um, integral_s);
            })
        };
        let machine = with_friction(0.0);
        let axis = &machine.axes[0];
        let free_um = SPEED_MM_S * 1e3 / axis.kp_1_s;
        let [x, y] = at_speed_um(&machine);
        near(&x, free_um + yields_um(axis, 0.35), 1e-3);
        near(&y, free_um + yields_um(axis, 0.25), 1e-3);
        at_speed_um(&with_friction(0.02))
            .iter()
            .for_each(|lags| near(lags, free_um, 1e-3));
        // At the Stribeck speed it is Fs / e more.
        let slow = lags_um(&machine, |t_s| 2.0 * t_s);
        near(
            &slow[0],
            2e3 / axis.kp_1_s + yields_um(axis, 0.35 + 0.1 * (-1.0_f64).exp()),
            2e-3,
        );
    }
}

/// Checks at so low a speed that the loop yields as to a constant torque: at a tenth of a turn per
/// second and 5 waves per turn, the phase goes from pi to 2 pi for x and from -pi to -2 pi for y:
/// the sine has its least for x and its most for y. A first-order lag at Kp takes 0.2 % of it.
#[test]
fn cogging_and_ripple_are_waves_over_the_turn() {
    let largest = |lags: &[f64]| lags.iter().copied().fold(f64::MIN, f64::max);
    let least = |lags: &[f64]| lags.iter().copied().fold(f64::MAX, f64::min);
    let cogging = machine(|axis| (axis.cogging_nm, axis.cogging_per_rev) = (0.04, 5.0));
    let axis = cogging.axes[0];
    let (free_um, yields) = (1e3 / axis.kp_1_s, yields_um(&axis, 0.04));
    for lags in lags_um(&cogging, |t_s| t_s) {
        assert!(
            (largest(&lags) - (free_um + yields)).abs() < 0.005 * yields,
            "{} {free_um} {yields}",
            largest(&lags)
        );
    }
    // Ripple is in proportion to the torque: what is to be T is T / (1 + r sin) at the drive.
    let ripple = machine(|axis| {
        (axis.ripple, axis.ripple_per_rev, axis.viscous_friction_nm_s) = (0.1, 5.0, 0.5);
    });
    let yields = yields_um(&axis, 0.5 * axis.rad_per_mm());
    let [x, y] = lags_um(&ripple, |t_s| t_s);
    let [most, wanted] = [largest(&x), free_um + yields / 0.9];
    assert!((most - wanted).abs() < 0.005 * yields, "{most} {wanted}");
    let [fewest, wanted] = [least(&y), free_um + yields / 1.1];
    assert!(
        (fewest - wanted).abs() < 0.005 * yields,
        "{fewest} {wanted}"
    );
}

#[test]
fn slow_torque_noise_moves_the_tool_by_what_the_loop_yields() {
    // A correlation time of 1 s is fifty times the time constant of the loop. Over 400 seeds the
    // standard error of the deviation is 3.5 %; the tolerance is four standard errors.
    let noisy = machine(|axis| (axis.torque_noise_nm, axis.torque_noise_s) = (0.1, 1.0));
    let mut square = 0.0;
    for seed in 0..400 {
        let mut plant = Plant::<2>::with_seed(&noisy, [0.0; 2], seed);
        let last = (0..300)
            .map(|_| plant.step([0.0; 2]).position_mm)
            .last()
            .unwrap();
        square += (last[0] * 1e3).powi(2) / 400.0;
    }
    let wanted = yields_um(&noisy.axes[0], 0.1);
    assert!(
        (square.sqrt() - wanted).abs() < 0.14 * wanted,
        "{} {wanted}",
        square.sqrt()
    );
}

/// A command that is late moves everything behind it by whole servo periods: the machine does to
/// the bit what one without the delay does with a plan that is so much later. Disturbance, noise
/// and encoder stay in their own time.
#[test]
fn a_late_command_is_a_plan_that_is_later_by_whole_servo_periods() {
    let course_mm = |n: u32| {
        let t_s = f64::from(n) * 0.001;
        [40.0 * (3.0 * t_s).sin(), 25.0 * t_s * t_s]
    };
    for name in ["tnv40", "soft", "coarse", "workshop"] {
        let prompt = Machine::load(name.as_ref()).unwrap();
        for late in [1, 2, 3, 8] {
            let mut machine = prompt.clone();
            let delay_s = f64::from(late) * machine.period.servo_s;
            machine
                .axes
                .iter_mut()
                .for_each(|axis| axis.command_delay_s = delay_s);
            let [mut delayed, mut plain] =
                [&machine, &prompt].map(|machine| Plant::<2>::new(machine, [0.0; 2]));
            for n in 0_u32..600 {
                let later_mm = n.checked_sub(late).map_or([0.0; 2], course_mm);
                let (found, wanted) = (delayed.step(course_mm(n)), plain.step(later_mm));
                assert_eq!(
                    found, wanted,
                    "{name}, {late} servo periods late, servo period {n}"
                );
            }
        }
    }
}
