//! The independent plant against closed forms: energy, the order of its integration, following
//! error, friction at break-away, backlash.

use std::f64::consts::TAU;

use feedwright_lab::independent_plant::IndependentPlant;
use feedwright_lab::independent_plant::ball_screw::BallScrew;
use feedwright_lab::independent_plant::linearization::LinearPart;
use feedwright_lab::independent_plant::lugre::LuGre;
use feedwright_lab::independent_plant::machines::{INDEPENDENT_MACHINES, IndependentMachine};
use feedwright_lab::independent_plant::mechanics::{FeedAxis, FeedState, GuidedTable, WoundMotor};
use feedwright_sim::Mechanism;

const STEP_S: f64 = 31.25e-6;

/// The x axis of a machine.
fn axis(name: &str) -> FeedAxis {
    IndependentMachine::named(name).unwrap().axes[0].feed
}

/// A bent screw, a running motor and a current, so that everything stores energy and takes some.
fn disturbed(axis: &FeedAxis) -> FeedState {
    let travel = axis.screw.travel_m_rad;
    FeedState {
        current_a: 2.0,
        motor_rad_s: 0.05 / travel,
        motor_rad: 1e-4 / travel,
        table_m_s: -0.02,
        table_m: 0.0,
        bristles: [0.0; 2],
    }
}

/// Returns the error in the energy balance of a free run under zero voltage after a tenth of a
/// second, as a part of the energy at its beginning.
fn imbalance(axis: &FeedAxis, step_s: f64) -> f64 {
    let mut state = disturbed(axis);
    let rest = FeedState {
        motor_rad: state.motor_rad,
        table_m: state.table_m,
        ..FeedState::default()
    };
    let before_j = axis.energy_j(&state);
    let scale_j = before_j - axis.energy_j(&rest);
    let mut lost_j = 0.0;
    for _ in 0..(0.1 / step_s).round() as usize {
        let loss_w = axis.loss_w(&state);
        state = axis.step(&state, 0.0, step_s);
        assert!(
            axis.loss_w(&state) > -1e-9,
            "friction gives energy: {state:?}"
        );
        lost_j += 0.5 * step_s * (loss_w + axis.loss_w(&state));
    }
    (axis.energy_j(&state) + lost_j - before_j).abs() / scale_j
}

#[test]
fn what_an_unforced_axis_loses_is_what_friction_damping_and_winding_take() {
    // The integration is of second order: the error at 31 us falls to a quarter with half of the
    // step, except for the corner of LuGre friction at rest.
    for name in INDEPENDENT_MACHINES {
        let (coarse, fine) = (
            imbalance(&axis(name), STEP_S),
            imbalance(&axis(name), 0.25 * STEP_S),
        );
        assert!(
            coarse < 2e-3 && fine < 0.2 * coarse,
            "{name}: {coarse:e} {fine:e}"
        );
    }
}

#[test]
fn an_axis_without_losses_keeps_its_energy() {
    for name in INDEPENDENT_MACHINES {
        let mut lossless = axis(name);
        (lossless.motor.resistance_ohm, lossless.screw.damping_n_s_m) = (0.0, 0.0);
        (lossless.motor.friction, lossless.table.friction) = (LuGre::default(), LuGre::default());
        let mut state = disturbed(&lossless);
        let before_j = lossless.energy_j(&state);
        let mut most_j = 0.0_f64;
        for _ in 0..32_000 {
            state = lossless.step(&state, 0.0, STEP_S);
            most_j = most_j.max((lossless.energy_j(&state) - before_j).abs());
        }
        // A second is some hundred periods of the screw: a method of first order would have lost or
        // doubled it all.
        assert!(
            most_j < 0.02 * before_j.abs(),
            "{name}: {most_j:e} J of {before_j:e} J"
        );
    }
}

#[test]
fn half_the_step_leaves_a_quarter_of_the_error() {
    let mut smooth = axis("machining-center");
    let viscous = |viscous: f64| LuGre {
        viscous,
        ..LuGre::default()
    };
    (smooth.motor.friction, smooth.table.friction) = (viscous(4e-3), viscous(600.0));
    let end = |steps: u32| {
        let mut state = disturbed(&smooth);
        (0..steps).for_each(|_| state = smooth.step(&state, 5.0, 0.02 / f64::from(steps)));
        state
    };
    let [coarse, middle, fine] = [640, 1280, 2560].map(end);
    for of in [
        |s: &FeedState| s.table_m,
        |s: &FeedState| s.motor_rad_s,
        |s: &FeedState| s.current_a,
    ] {
        let ratio = (of(&coarse) - of(&middle)) / (of(&middle) - of(&fine));
        assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
    }
}

#[test]
fn a_linear_axis_swings_at_the_frequency_of_two_masses_on_a_spring() {
    let (inertia, mass, travel, stiffness) = (1e-3, 200.0, 2e-3, 5e7);
    let free = FeedAxis {
        motor: WoundMotor {
            resistance_ohm: 1.0,
            inductance_h: 1e-3,
            inertia_kg_m2: inertia,
            ..WoundMotor::default()
        },
        screw: BallScrew {
            travel_m_rad: travel,
            stiffness_n_m: stiffness,
            ..BallScrew::default()
        },
        table: GuidedTable {
            mass_kg: mass,
            ..GuidedTable::default()
        },
    };
    let angular = (stiffness * (1.0 / mass + travel * travel / inertia)).sqrt();
    // The trapezoidal rule turns by 2 atan(w h / 2) in place of w h.
    let turned = 2.0 * libm::atan(0.5 * angular * STEP_S);
    let mut state = FeedState {
        motor_rad: 1e-5 / travel,
        ..FeedState::default()
    };
    for step in 1..=2000 {
        state = free.step(&state, 0.0, STEP_S);
        let lead_m = travel * state.motor_rad - state.table_m;
        let wanted_m = 1e-5 * libm::cos(turned * f64::from(step));
        assert!(
            (lead_m - wanted_m).abs() < 1e-12,
            "{step}: {lead_m:e} {wanted_m:e}"
        );
    }
}

/// The mass of the paper on LuGre's friction (its section IV.B): 1 kg that a spring of 2 N/m pulls
/// at 0.1 m/s. The largest force of the spring, and the smallest after it.
fn stick_slip(friction: LuGre, direction: f64) -> [f64; 2] {
    let pulled = FeedAxis {
        motor: WoundMotor {
            resistance_ohm: 1.0,
            inductance_h: 1e-3,
            inertia_kg_m2: 1e9,
            ..WoundMotor::default()
        },
        screw: BallScrew {
            travel_m_rad: 1.0,
            stiffness_n_m: 2.0,
            ..BallScrew::default()
        },
        table: GuidedTable {
            mass_kg: 1.0,
            friction,
            ..GuidedTable::default()
        },
    };
    let mut state = FeedState {
        motor_rad_s: 0.1 * direction,
        ..FeedState::default()
    };
    let (mut most_n, mut least_n) = (0.0_f64, f64::INFINITY);
    for step in 0..100_000 {
        state = pulled.step(&state, 0.0, 1e-4);
        let force_n = direction * pulled.screw_force_n(&state);
        most_n = most_n.max(force_n);
        // 0.2 N/s come to the Coulomb level in five seconds or so.
        if step > 50_000 {
            least_n = least_n.min(force_n);
        }
    }
    [most_n, least_n]
}

/// Friction of the paper's Table I, higher in the positive direction by a tenth.
const OF_PAPER: LuGre = LuGre {
    stiffness: 1e5,
    damping: 316.227_766,
    viscous: 0.4,
    coulomb: 1.0,
    break_away: 1.5,
    stribeck: 1e-3,
    asymmetry: 0.1,
};

#[test]
fn a_mass_sticks_up_to_the_break_away_force_of_its_direction_and_then_slips() {
    for direction in [1.0, -1.0] {
        let [most_n, least_n] = stick_slip(OF_PAPER, direction);
        let (level_n, coulomb_n) = (OF_PAPER.breaks_away_at(direction), 1.0 + 0.1 * direction);
        // The spring goes on until the mass is as fast as its end: for v m / (Fs - Fc), by half of
        // k v on the mean.
        let more_n = 0.5 * 2.0 * 0.1 * 0.1 / (level_n - coulomb_n);
        assert!(
            most_n > 0.99 * level_n && most_n < level_n + more_n,
            "{direction}: {most_n} of {level_n} N"
        );
        // Without losses the spring would run as far below the Coulomb level as it was above.
        assert!(
            least_n < coulomb_n && least_n > 2.0 * coulomb_n - level_n,
            "{direction}: {least_n} N"
        );
    }
}

#[test]
fn on_a_long_straight_the_following_error_comes_from_the_loops_and_delays() {
    for name in INDEPENDENT_MACHINES {
        let mut machine = IndependentMachine::named(name).unwrap();
        for axis in &mut machine.axes {
            // The closed form has no ripple and no errors of the encoders.
            (
                axis.feed.motor.ripple[0],
                axis.feed.motor.cogging[0],
                axis.feed.table.mass_swing[0],
            ) = (0.0, 0.0, 0.0);
            (axis.encoder.error_mm, axis.encoder.step_mm) = (0.0, 0.0);
            axis.scale
                .iter_mut()
                .for_each(|scale| (scale.error_mm, scale.step_mm) = (0.0, 0.0));
        }
        let mut plant = IndependentPlant::new(&machine.axes, [0.0; 3]);
        let (servo_s, speed_mm_s) = (machine.axes[0].cascade.servo_s(), 20.0);
        let (mut command_mm, mut seen_mm) = (0.0, [0.0; 3]);
        let mut speed = 0.0_f64;
        for _ in 0..1500 {
            speed = (speed + 0.1).min(speed_mm_s);
            command_mm += speed * servo_s;
            seen_mm = plant.step([command_mm, -command_mm, 0.0]).measured_mm;
        }
        // What is measured at the end of a servo period stands beside the command of the next.
        for (axis, seen_mm) in [(0, seen_mm[0]), (1, -seen_mm[1])] {
            let found_s = (command_mm + speed_mm_s * servo_s - seen_mm) / speed_mm_s;
            let wanted_s = LinearPart::of(&machine.axes[axis]).lag_s;
            assert!(
                (found_s - wanted_s).abs() < 2e-6,
                "{name}, axis {axis}: {found_s} {wanted_s} s"
            );
        }
    }
}

#[test]
fn between_the_flanks_of_a_screw_the_table_stays_where_it_is() {
    let machine = IndependentMachine::named("bench-router").unwrap();
    let mut plant = IndependentPlant::new(&machine.axes, [0.0; 3]);
    let places = |plant: &mut IndependentPlant, to_mm: f64| {
        let from_mm = plant.state(0).motor_rad * machine.axes[0].feed.screw.travel_m_rad * 1e3;
        for n in 1..=600 {
            plant.step([
                from_mm + (to_mm - from_mm) * f64::from(n.min(400)) / 400.0,
                0.0,
                0.0,
            ]);
        }
        let state = plant.state(0);
        (
            1e3 * state.motor_rad * machine.axes[0].feed.screw.travel_m_rad,
            1e3 * state.table_m,
        )
    };
    // On the way back the table is behind by the backlash and by what the friction of both ways
    // bends the screw.
    let (there, back) = (places(&mut plant, 1.0), places(&mut plant, 0.5));
    let lost_um = 1e3 * ((back.1 - there.1) - (back.0 - there.0));
    assert!((30.0..90.0).contains(&lost_um), "{lost_um}");
    // Some of that on the way there again: the nut moves, the table does not.
    let still = places(&mut plant, 0.53);
    assert!(
        (still.1 - back.1).abs() < 3e-3 && still.0 - back.0 > 10e-3,
        "{back:?} {still:?}"
    );
}

#[test]
fn the_tool_has_the_lead_error_that_no_encoder_has_and_a_scale_sees_the_table() {
    let machine = IndependentMachine::named("machining-center").unwrap();
    let mut plant = IndependentPlant::new(&machine.axes, [0.0; 3]);
    let mut at = plant.step([0.0; 3]);
    for n in 0..1000 {
        at = plant.step([5.0 * f64::from(n.min(500)) / 500.0, 0.0, 0.0]);
    }
    let axis = &machine.axes[0];
    let table_mm = 1e3 * plant.state(0).table_m;
    let [error_mm, phase_rad] = axis.lead_error;
    let wanted_mm =
        table_mm + error_mm * (libm::sin(TAU * table_mm / 16.0 + phase_rad) - libm::sin(phase_rad));
    assert!((at.position_mm[0] - wanted_mm).abs() < 1e-12 && error_mm == 1.5e-3);
    assert_eq!(at.joint_mm[0], table_mm);
    // Half a step and the error within a period.
    assert!(
        (at.measured_mm[0] - table_mm).abs() < 0.01e-3 + 0.081e-3,
        "{at:?} {table_mm}"
    );
    assert!(at.measured_mm[0] != at.joint_mm[0]);
}

#[test]
fn at_rest_every_axis_stays_where_it_was_and_a_rest_that_is_skipped_is_one_that_is_stepped_through()
{
    for name in INDEPENDENT_MACHINES {
        let machine = IndependentMachine::named(name).unwrap();
        let start_mm = [1.0, -2.0, 3.0];
        let mut plants = [0, 1].map(|_| IndependentPlant::new(&machine.axes, start_mm));
        let tables_mm =
            |plant: &IndependentPlant| [0, 1, 2].map(|axis| 1e3 * plant.state(axis).table_m);
        let before_mm = tables_mm(&plants[0]);
        plants[0].skip(300);
        for _ in 0..300 {
            plants[1].step(start_mm);
        }
        let [rested, stepped] = plants.each_mut().map(|plant| plant.step([1.01, -2.0, 3.0]));
        assert_eq!(rested, stepped);
        // Friction takes over some of what the motor carries: within a step of the encoder or the
        // bending of the bristles.
        for (before_mm, after_mm) in before_mm.into_iter().zip(tables_mm(&plants[0])) {
            assert!(
                (after_mm - before_mm).abs() < 1e-3,
                "{name}: {before_mm} {after_mm}"
            );
        }
    }
}
