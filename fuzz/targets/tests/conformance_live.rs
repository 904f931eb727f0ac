//! Tests that a controller in LinuxCNC's servo thread is the controller of `run`: the same windows
//! and measurements give the same commands, to the bit.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use std::f64::consts::TAU;

use feedwright::{CONTROLLERS, Choices, Setup, offset_bounds};
use feedwright_control::{
    Bounds, Command, ContourIdentifier, Controller, FaultEvidence, IdentifiedAxes, Identifier,
    Knot, KnotSource, Measured, Part, Schedule, Tick, Window,
};
use feedwright_ident::{Model, Origin, Recording, TrainedAxes, TrainedContour};
use feedwright_servo::live_controller::LiveController;
use feedwright_servo::machine::model_of;
use feedwright_sim::{Machine, Plant};

/// Servo periods that are compared: three turns of the circle.
const PERIODS: u32 = 3000;
/// Circle: radius, mm, and time of a turn, s.
const RADIUS_MM: f64 = 5.0;
const TURN_S: f64 = 1.0;

/// A circle at a constant feedrate.
struct Circle;

impl KnotSource<2> for Circle {
    fn knot(&mut self, tau_s: f64) -> Knot<2> {
        let (sin, cos) = (TAU * tau_s / TURN_S).sin_cos();
        Knot {
            position_mm: [RADIUS_MM * (1.0 - cos), RADIUS_MM * sin],
            tangent: [sin, cos],
            feed_mm_s: TAU * RADIUS_MM / TURN_S,
            cutting: true,
        }
    }
}

/// The controller of `run` and the live one, on the same windows.
struct Both {
    run: Box<dyn Controller<2>>,
    live: LiveController<2>,
    /// True if both are reset before each decision. The paper's controllers learn from the feedrate
    /// that was commanded, which is another one where a control plans it.
    forgets: bool,
    /// Decisions that change the plan.
    corrections: u32,
}

impl Controller<2> for Both {
    fn schedule(&self) -> Schedule {
        self.run.schedule()
    }

    fn reset(&mut self) {
        self.run.reset();
        self.live.reset();
    }

    fn observe(&mut self, window: &Window<'_, 2>, measured: Option<&Measured<2>>) {
        self.run.observe(window, measured);
        self.live.observe(window, measured);
    }

    fn prediction_error_mm(&self) -> f64 {
        self.run.prediction_error_mm()
    }

    fn doubt(&self) -> Option<FaultEvidence> {
        self.run.doubt()
    }

    fn moved_mm(&self) -> Option<[f64; 2]> {
        self.run.moved_mm()
    }

    fn acts_at_once(&self) -> bool {
        assert_eq!(self.run.acts_at_once(), self.live.acts_at_once());
        self.run.acts_at_once()
    }

    fn command(&mut self, window: &Window<'_, 2>, measured: &Measured<2>) -> Command<2> {
        if self.forgets {
            self.reset();
        }
        let of_run = self.run.command(window, measured);
        let of_live = self.live.command(window, measured);
        let bits = |rate: f64, command: &Command<2>| {
            let [x, y] = command.offset_mm;
            let [bend_x, bend_y] = command.bend_mm;
            [rate, x, y, bend_x, bend_y].map(f64::to_bits)
        };
        // The live rate is a request to the control.
        assert_eq!(
            bits(of_run.rate, &of_run),
            bits(self.live.rate(), &of_live),
            "at {} s: {of_run:?}, live {} {of_live:?}",
            window.tau_s,
            self.live.rate()
        );
        self.corrections += u32::from(of_run != Command::AS_PLANNED);
        of_run
    }
}

fn origin() -> Origin {
    Origin {
        source: "a test".to_owned(),
        date: "2026-11-29".to_owned(),
    }
}

fn recording(feed_period_s: f64) -> Recording<2> {
    Recording {
        servo_s: 0.001,
        feed_period_s,
        stretches: vec![],
    }
}

/// Exact model of the axes.
fn axes_model(machine: &Machine) -> Model {
    let known = machine.known();
    let axes = IdentifiedAxes {
        periods: known.period.periods(),
        axes: [0, 1].map(|i| {
            let all = machine.axis(i).parameters();
            known.axis(i).nominal.taking(&[Part::Noise], &all)
        }),
    };
    let trained = TrainedAxes {
        axes,
        estimates: vec![],
        fit_um: 1.0,
        samples: 1,
    };
    Model::of_axes(&recording(0.001), &trained, origin())
}

/// Network with weights that are drawn.
fn contour_model() -> Model {
    let (mut net, mut state) = (ContourIdentifier::<2>::NULL, 1_u64);
    net.weights(&mut |_, group| {
        for weight in group {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            *weight = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        }
    });
    let trained = TrainedContour {
        net,
        fit_um: 1.0,
        samples: 1,
    };
    Model::of_contour(&recording(0.01), &trained, origin())
}

/// Compares a controller of the table with the live one, both made with `model`. Returns the number
/// of decisions that change the plan.
fn corrections(name: &str, machine: &Machine, model: &Model) -> u32 {
    let choices = Choices::default();
    let setup = Setup::new(machine, &choices);
    let bounds = Bounds::new(1.0, machine.limits.rapid_mm_s, 400.0);
    let offset = offset_bounds(&setup.known);
    let entry = CONTROLLERS.find(name).unwrap();
    let read = model_of::<2>(&model.block(None)).unwrap();
    let mut live = LiveController::new(&read, machine.period.servo_s, true);
    live.hold_to(&Bounds {
        deviation_mm: offset.largest_mm,
        speed_mm_s: offset.fastest_mm_s,
        ..bounds
    });
    live.change_speed_alone(name == "magnitude-only");
    let mut both = Both {
        run: entry.make_with(setup, model).unwrap(),
        live,
        forgets: name != "lqg-identified",
        corrections: 0,
    };
    let mut tick = Tick::new(machine.period.servo_s, both.schedule(), bounds);
    let mut plant = Plant::<2>::new(machine, [0.0; 2]);
    let mut measured_mm = [0.0; 2];
    for _ in 0..PERIODS {
        let setpoint = tick.step(&mut Circle, &mut both, measured_mm);
        measured_mm = plant.step(setpoint.command_mm).measured_mm;
    }
    both.corrections
}

#[test]
fn a_live_controller_commands_what_the_controller_of_run_commands() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let axes = axes_model(&machine);
    assert!(corrections("lqg-identified", &machine, &axes) > 2900);
    let contour = contour_model();
    assert!(corrections("magnitude-only", &machine, &contour) > 200);
}
