//! The geometry between the control and the link: whatever is homed, switched and moved, the joints
//! move smoothly, and the control sees the same following error as without a geometry.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;
#[expect(dead_code, reason = "a turn here is a turn of the joints")]
#[path = "common/turn.rs"]
mod turning;

use std::f64::consts::TAU;

use feedwright_control::{AxisErrors, ErrorTable, KnownGeometry, TrainedModel};
use feedwright_servo::compensation::{Compensation, MachinePlace};
use feedwright_servo::limits::LinkLimits;
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::servo::{LinkInputs, Servo};
use feedwright_servo::through::{CHANNELS, Carries, PassedThrough, Through};

use common::{LIMITS, SERVO_S, cutting};
use turning::{SETTLE, TURN, command_mm, machine};

/// Highest speed and acceleration of each axis of the command, mm/s and mm/s2.
const SPEED_MM_S: f64 = 200.0;
const ACCELERATION_MM_S2: f64 = 2000.0;
/// Bounds of the slope of the geometric errors below over the travel, and of the change of this
/// slope, 1/mm. Both are somewhat larger than the sums over the errors.
const SLOPE: f64 = 0.008;
const BEND_PER_MM: f64 = 0.004;
/// Rounding error of positions, mm.
const ROUNDING_MM: f64 = 1e-11;

/// Returns a geometry with errors several times as large as the errors of a machine.
fn geometry() -> KnownGeometry<2> {
    let axis = AxisErrors {
        scale: 2e-4,
        pitch_mm: 0.004,
        pitch_rad_per_mm: TAU / 10.0,
        ..AxisErrors::default()
    };
    let other = AxisErrors {
        scale: -1e-4,
        pitch_phase_rad: 2.0,
        ..axis
    };
    let straight = ErrorTable::new([[-100.0, 0.0], [-20.0, 0.01], [30.0, -0.005], [100.0, 0.01]])
        .expect("a table");
    let known = KnownGeometry::new([axis, other], [1e-3, 0.0, 0.0]).with_table(1, 0, straight);
    known.check().expect("it can be compensated");
    known
}

/// Random numbers from a seed.
struct Random(u64);

impl Random {
    fn within(&mut self, least: f64, most: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(0x5851_f42d_4c95_7f2d)
            .wrapping_add(0x1405_7b7e_f767_814f);
        least + (most - least) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn happens(&mut self, part: f64) -> bool {
        self.within(0.0, 1.0) < part
    }
}

/// A command that accelerates and brakes at random, within the limits.
struct Wandering {
    at_mm: [f64; 2],
    speed_mm_s: [f64; 2],
    wanted_mm_s: [f64; 2],
}

impl Wandering {
    fn step(&mut self, random: &mut Random) -> [f64; 2] {
        for i in 0..2 {
            if random.happens(0.01) {
                let most_mm_s = if random.happens(0.3) { 0.0 } else { SPEED_MM_S };
                self.wanted_mm_s[i] = random.within(-most_mm_s, most_mm_s);
            }
            let back_mm_s = if self.at_mm[i].abs() > 80.0 {
                -50.0 * self.at_mm[i].signum()
            } else {
                self.wanted_mm_s[i]
            };
            let most_mm_s = ACCELERATION_MM_S2 * SERVO_S;
            self.speed_mm_s[i] += (back_mm_s - self.speed_mm_s[i]).clamp(-most_mm_s, most_mm_s);
            self.at_mm[i] += SERVO_S * self.speed_mm_s[i];
        }
        self.at_mm
    }
}

fn plain(command_mm: [f64; 2], actual_mm: [f64; 2], powered: bool) -> LinkInputs<2> {
    LinkInputs {
        powered,
        ..cutting(command_mm, actual_mm)
    }
}

/// Converts the feedback of the link to the feedback of the control.
fn back(compensation: &Compensation<2>, feedback_mm: [f64; 2]) -> [f64; 2] {
    let none = PassedThrough {
        drive: [0.0; CHANNELS],
        feedback: [0.0; CHANNELS],
    };
    compensation
        .tool(feedback_mm, none, &Through::NONE.carries)
        .0
}

/// Returns the second difference over the servo period, of each axis, mm/s2.
fn acceleration_mm_s2(three: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| (three[2][i] - 2.0 * three[1][i] + three[0][i]) / (SERVO_S * SERVO_S))
}

#[test]
fn whatever_is_homed_and_switched_the_joints_go_smoothly_and_the_following_error_is_the_error_of_the_joints()
 {
    let (mut in_force, mut faded) = (0, 0);
    for seed in 0..40 {
        let mut random = Random(seed);
        let mut compensation = Compensation::new(Some(geometry()));
        compensation.runs_at(SERVO_S);
        let mut wandering = Wandering {
            at_mm: [0.0; 2],
            speed_mm_s: [0.0; 2],
            wanted_mm_s: [50.0; 2],
        };
        let mut place = MachinePlace {
            zero_mm: [0.0; 2],
            is_known: false,
            is_wanted: true,
        };
        let (mut commands, mut joints) = (Vec::new(), Vec::new());
        for n in 0..6000 {
            // Homing ends, begins and moves the zero, and the operator switches. Fades in between
            // are interrupted, too.
            place.is_known ^= random.happens(0.002);
            place.is_wanted ^= random.happens(0.001);
            if random.happens(0.001) {
                place.zero_mm = [random.within(-30.0, 30.0), random.within(-30.0, 30.0)];
            }
            let command_mm = wandering.step(&mut random);
            let of = compensation.joints(&plain(command_mm, [0.0; 2], true), &place, &LIMITS);
            assert!(of.command_mm.iter().all(|mm| mm.is_finite()), "{seed} {n}");
            // The drive lags by up to 4 mm.
            let behind_mm = [random.within(-4.0, 4.0), random.within(-4.0, 4.0)];
            let feedback_mm = back(
                &compensation,
                [0, 1].map(|i| of.command_mm[i] - behind_mm[i]),
            );
            for i in 0..2 {
                let seen_mm = command_mm[i] - feedback_mm[i];
                let most_mm = SLOPE * (behind_mm[0].abs() + behind_mm[1].abs()) + ROUNDING_MM;
                assert!(
                    (seen_mm - behind_mm[i]).abs() <= most_mm,
                    "{seed} {n}: {seen_mm} {behind_mm:?}"
                );
            }
            assert!(
                !compensation.compensates() || (place.is_known && place.is_wanted),
                "{seed} {n}"
            );
            in_force += usize::from(compensation.compensates());
            faded +=
                usize::from(!compensation.compensates() && compensation.offset_mm() != [0.0; 2]);
            commands.push(command_mm);
            joints.push(of.command_mm);
        }
        for n in 2..joints.len() {
            let [of_joint, of_command] =
                [&joints, &commands].map(|way| acceleration_mm_s2(&way[n - 2..=n]));
            let bend_mm_s2 = BEND_PER_MM * 2.0 * SPEED_MM_S * SPEED_MM_S;
            let most_mm_s2 =
                LIMITS.correction_mm_s2 + 2.0 * SLOPE * ACCELERATION_MM_S2 + bend_mm_s2 + 2.0;
            for i in 0..2 {
                let more_mm_s2 = of_joint[i] - of_command[i];
                assert!(
                    more_mm_s2.abs() <= most_mm_s2,
                    "{seed} {n}: {more_mm_s2} of {most_mm_s2}"
                );
                let step_mm =
                    joints[n][i] - joints[n - 1][i] - (commands[n][i] - commands[n - 1][i]);
                // A fade of 0.2 mm reaches 10 mm/s.
                assert!(
                    step_mm.abs() <= SERVO_S * (2.0 * SLOPE * SPEED_MM_S + 10.0),
                    "{seed} {n}: {step_mm}"
                );
            }
        }
    }
    assert!(
        in_force > 10_000 && faded > 10_000,
        "there is nothing to see: {in_force} {faded}"
    );
}

#[test]
fn without_power_nothing_fades_and_the_command_at_switching_on_is_where_the_joints_are() {
    for seed in 0..20 {
        let mut random = Random(100 + seed);
        let mut compensation = Compensation::new(Some(geometry()));
        let mut place = MachinePlace {
            zero_mm: [10.0, -20.0],
            is_known: true,
            is_wanted: true,
        };
        let mut actual_mm = [0.0; 2];
        let mut command_mm = [0.0; 2];
        for n in 0..2000 {
            let powered = n / 100 % 2 == 1;
            if !powered {
                // The operator turns the screws by hand.
                actual_mm = actual_mm.map(|mm| mm + random.within(-0.05, 0.05));
                place.is_wanted ^= random.happens(0.05);
                place.is_known ^= random.happens(0.05);
            }
            // LinuxCNC commands the feedback of the previous servo period.
            let of = compensation.joints(&plain(command_mm, actual_mm, powered), &place, &LIMITS);
            if powered {
                let off_mm = [0, 1].map(|i| (of.command_mm[i] - actual_mm[i]).abs());
                assert!(
                    off_mm[0].max(off_mm[1]) <= ROUNDING_MM,
                    "{seed} {n}: {off_mm:?}"
                );
                assert_eq!(
                    compensation.compensates(),
                    place.is_known && place.is_wanted,
                    "{seed} {n}"
                );
            }
            let feedback_mm = back(&compensation, actual_mm);
            command_mm = if powered { command_mm } else { feedback_mm };
        }
    }
}

#[test]
fn without_a_geometry_commands_and_feedback_pass_to_the_bit() {
    let mut random = Random(7);
    let mut compensation = Compensation::<2>::new(None);
    let place = MachinePlace {
        zero_mm: [1.0, 2.0],
        is_known: true,
        is_wanted: true,
    };
    for _ in 0..100 {
        let (a, b) = (random.within(-100.0, 100.0), random.within(-100.0, 100.0));
        let inputs = plain([a, -b], [b, -0.0], true);
        assert_eq!(compensation.joints(&inputs, &place, &LIMITS), inputs);
        assert_eq!(
            back(&compensation, [b, -0.0]).map(f64::to_bits),
            [b, -0.0].map(f64::to_bits)
        );
        assert_eq!(
            (compensation.offset_mm(), compensation.compensates()),
            ([0.0; 2], false)
        );
    }
}

#[test]
fn what_is_not_a_number_moves_nothing() {
    let mut compensation = Compensation::new(Some(geometry()));
    let place = MachinePlace {
        zero_mm: [0.0; 2],
        is_known: true,
        is_wanted: true,
    };
    let good = [30.0, -40.0];
    for _ in 0..1000 {
        compensation.joints(&plain(good, good, true), &place, &LIMITS);
    }
    let offset_mm = compensation.offset_mm();
    assert!(compensation.compensates() && offset_mm != [0.0; 2]);
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        compensation.joints(&plain([bad, 1.0], good, true), &place, &LIMITS);
        assert_eq!(compensation.offset_mm(), offset_mm, "{bad}");
        // An invalid zero counts as unknown: the geometry fades from its present value.
        let lost = MachinePlace {
            zero_mm: [bad, 0.0],
            ..place
        };
        let mut fading = compensation.clone();
        let of = fading.joints(&plain(good, good, true), &lost, &LIMITS);
        let leap_mm = (of.command_mm[0] - good[0] - offset_mm[0]).abs();
        assert!(!fading.compensates() && leap_mm < 1e-3, "{bad}: {leap_mm}");
    }
}

#[test]
fn a_second_motor_gets_the_offset_of_its_axis_and_its_feedback_loses_it() {
    let mut compensation = Compensation::new(Some(geometry()));
    let place = MachinePlace {
        zero_mm: [0.0; 2],
        is_known: true,
        is_wanted: true,
    };
    let mut carries = [Carries::Signal; CHANNELS];
    carries[..3].copy_from_slice(&[Carries::Tandem(1), Carries::Joint, Carries::Tandem(0)]);
    let given = [41.0, 7.0, 30.5, 1.0, 0.0, 0.0];
    let through = Through {
        command: given,
        actual: given,
        carries,
    };
    let inputs = LinkInputs {
        through,
        ..plain([30.0, 40.0], [0.0; 2], true)
    };
    let mut of = inputs;
    for _ in 0..1000 {
        of = compensation.joints(&inputs, &place, &LIMITS);
    }
    let [x_mm, y_mm] = compensation.offset_mm();
    assert!(x_mm != 0.0 && y_mm != 0.0);
    assert_eq!(
        of.through.command,
        [41.0 + y_mm, 7.0, 30.5 + x_mm, 1.0, 0.0, 0.0]
    );
    // The drives are at their commanded positions.
    let passed = PassedThrough {
        drive: of.through.command,
        feedback: of.through.command,
    };
    let (feedback_mm, passed) = compensation.tool(of.command_mm, passed, &carries);
    assert!(
        (feedback_mm[0] - 30.0).abs() < ROUNDING_MM && (feedback_mm[1] - 40.0).abs() < ROUNDING_MM
    );
    for (feedback, given) in passed.feedback.iter().zip(given) {
        assert!((feedback - given).abs() < ROUNDING_MM, "{feedback} {given}");
    }
}

/// Returns the RMS distance of the tool from the commanded circle while it cuts, mm.
fn off_circle_mm(compensates: bool, corrects: bool) -> f64 {
    let mut compensation = Compensation::new(Some(geometry()));
    let (mut plant, mut servo) = (
        SimulatedMachine::new(&machine(), 1).with_geometry(Some(geometry())),
        Servo::new(Ok(TrainedModel::of_axes(machine()))),
    );
    compensation.runs_at(SERVO_S);
    servo.runs_at(SERVO_S);
    let place = MachinePlace {
        zero_mm: [0.0; 2],
        is_known: true,
        is_wanted: compensates,
    };
    let (mut squares, mut count) = (0.0, 0);
    for n in 0..SETTLE + 2 * TURN {
        let inputs = LinkInputs {
            enabled: corrects,
            ..cutting(command_mm(n), plant.measured_mm())
        };
        let of = compensation.joints(&inputs, &place, &LinkLimits::DEFAULT);
        let outputs = servo.step(&of, &LIMITS);
        plant.step(outputs.drive_mm, true, 1.0);
        if (SETTLE + 400..SETTLE + TURN).contains(&n) {
            let [x, y] = plant.tool_mm();
            squares += ((x - 10.0).hypot(y) - 10.0).powi(2);
            count += 1;
        }
    }
    (squares / f64::from(count)).sqrt()
}

#[test]
fn a_circle_is_round_at_the_tool_where_both_are_corrected_and_only_there() {
    let [both, geometry_alone, drives_alone] = [(true, true), (true, false), (false, true)]
        .map(|(compensates, corrects)| off_circle_mm(compensates, corrects));
    println!("{both} {geometry_alone} {drives_alone}");
    assert!(
        both < 0.0002 && geometry_alone > 0.01 && drives_alone > 0.002,
        "{both} {geometry_alone} {drives_alone}"
    );
}
