//! Tests that a controller in LinuxCNC's servo thread is the controller of `run`: the same windows
//! and measurements give the same commands, to the bit.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use std::f64::consts::TAU;

use feedwright::{CONTROLLERS, Choices, Setup, TWO_DIMENSIONAL};
use feedwright_control::{
    AnyController, Bounds, Command, Controller, ControllerRow, IdentifiedAxes, IdentifierKind,
    Knot, KnotSource, Knows, Measured, MemberName, OffsetBounds, Part, Schedule, SelfReport, Tick,
    Window,
};
use feedwright_ident::{Model, Origin, Recording, TrainedAxes};
use feedwright_servo::machine::{live_controller, model_of};
use feedwright_sim::{BoxedController, Machine, Plant};

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
    live: AnyController<2>,
    /// Decisions that change the plan.
    corrections: u32,
}

impl Both {
    /// Returns what both controllers report, which must be the same.
    fn same<T: PartialEq + std::fmt::Debug>(&self, report: impl Fn(&dyn Controller<2>) -> T) -> T {
        let of_run = report(&*self.run);
        assert_eq!(of_run, report(&*self.live), "{}", self.live.name());
        of_run
    }
}

impl Controller<2> for Both {
    fn schedule(&self) -> Schedule {
        self.same(|controller| controller.schedule())
    }

    fn reset(&mut self) {
        self.run.reset();
        self.live.reset();
    }

    fn observe(&mut self, window: &Window<'_, 2>, measured: Option<&Measured<2>>) {
        self.run.observe(window, measured);
        self.live.observe(window, measured);
    }

    fn report(&self) -> SelfReport<2> {
        self.same(|controller| controller.report())
    }

    fn command(&mut self, window: &Window<'_, 2>, measured: &Measured<2>) -> Command<2> {
        let of_run = self.run.command(window, measured);
        let of_live = self.live.command(window, measured);
        let bits = |command: &Command<2>| {
            let [x, y] = command.offset_mm;
            let [bend_x, bend_y] = command.bend_mm;
            [command.rate, x, y, bend_x, bend_y].map(f64::to_bits)
        };
        assert_eq!(
            bits(&of_run),
            bits(&of_live),
            "{} at {} s: {of_run:?}, live {of_live:?}",
            self.live.name(),
            window.tau_s
        );
        self.corrections += u32::from(of_run != Command::AS_PLANNED);
        of_run
    }
}

/// Exact model of the axes.
fn axes_model(machine: &Machine) -> Model {
    let known = machine.known();
    let axes = IdentifiedAxes::<2> {
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
    let recording = Recording {
        servo_s: axes.periods.servo_s,
        feed_period_s: axes.periods.servo_s,
        stretches: vec![],
    };
    let origin = Origin {
        source: "a test".to_owned(),
        date: "2026-11-29".to_owned(),
    };
    Model::of_axes(&recording, &trained, origin)
}

/// Compares a controller of the table with the live one, both made with `model`. Returns the number
/// of decisions that change the plan.
fn corrections(
    (member, row): (MemberName, &ControllerRow),
    machine: &Machine,
    model: &Model,
    is_planned_elsewhere: bool,
) -> u32 {
    let choices = Choices {
        tries: true,
        ..Choices::default()
    };
    let mut setup = Setup::new(machine, &choices);
    let bounds = Bounds::new(1.0, machine.limits.rapid_mm_s, 400.0);
    let block = model_of::<2>(&model.block(None)).unwrap();
    let mut live = live_controller(member, &block.model, true, setup.offset_bounds());
    assert_eq!(live.name(), row.name);
    live.hold_to(setup.offset_bounds());
    let entry = CONTROLLERS.find(row.name).unwrap();
    let run = match row.identifier {
        Some(_) => match entry.make_with(setup, 2, model).unwrap() {
            BoxedController::Plane(controller) => controller,
            BoxedController::Space(_) => unreachable!("two axes"),
        },
        None => entry.in_plane(&mut setup),
    };
    let corrections = 0;
    let mut both = Both {
        run,
        live,
        corrections,
    };
    let mut tick = Tick::new(machine.period.servo_s, both.schedule(), bounds);
    if is_planned_elsewhere {
        tick = tick.planned_elsewhere();
    }
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
    // The training of the paper's network takes most of the time.
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let choices = Choices::default();
    let axes = axes_model(&machine);
    let (entry, date) = (&TWO_DIMENSIONAL, "2026-11-29".to_owned());
    let contour = Setup::new(&machine, &choices)
        .train(entry, 2, date)
        .unwrap();
    for (member, row) in AnyController::<2>::ROWS {
        let model = match row.identifier {
            Some(IdentifierKind::Contour) => &contour,
            _ => &axes,
        };
        if row.knows == Knows::ExactModel {
            // A model file is not exact.
            let block = model_of::<2>(&model.block(None)).unwrap();
            let live = live_controller(*member, &block.model, true, OffsetBounds::NONE);
            assert_eq!(live.name(), "uncorrected");
            continue;
        }
        for is_planned_elsewhere in [false, true] {
            let corrections = corrections((*member, row), &machine, model, is_planned_elsewhere);
            assert_eq!(
                corrections > 200,
                row.knows != Knows::Nothing,
                "{}",
                row.name
            );
        }
    }
}
