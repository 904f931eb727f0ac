//! Parts shared by the benchmarks and the instruction count: a circle as the path, a lagging tool,
//! and a network.

use feedwright_control::{
    AxisModel, Bounds, ContourError, ContourIdentifier, Controller, Estimator, IDENTIFIED_WEIGHT,
    Inputs, InvertingSettings, Knot, KnotSource, LqgIdentified, LqgSettings, Measured,
    OffsetBounds, Parameters, Periods, Preview, Register, Setpoint, Tick, TwoDimensional, Window,
};

/// The circle of eq. 11 at 50 mm/s.
pub(crate) struct Circle;

impl<const N: usize> KnotSource<N> for Circle {
    fn knot(&mut self, tau_s: f64) -> Knot<N> {
        let (sin, cos) = (5.0 * tau_s).sin_cos();
        let mut knot = Knot {
            feed_mm_s: 50.0,
            ..Knot::REST
        };
        (knot.position_mm[0], knot.position_mm[1]) = (10.0 * (1.0 - cos), 10.0 * sin);
        (knot.tangent[0], knot.tangent[1]) = (sin, cos);
        knot
    }
}

/// Returns weights and inputs of the magnitude that training gives, without symmetry.
pub(crate) fn network<const N: usize>() -> (ContourIdentifier<N>, Inputs<N>) {
    let mut state = 1_u32;
    let mut next = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) - 0.5
    };
    let hidden = std::array::from_fn(|_| std::array::from_fn(|_| std::array::from_fn(|_| next())));
    let output = std::array::from_fn(|_| std::array::from_fn(|_| next()));
    let inputs = std::array::from_fn(|_| std::array::from_fn(|_| 2.0 * next()));
    (ContourIdentifier { hidden, output }, inputs)
}

/// Returns the paper's controller with an untrained network: the work does not depend on the
/// weights.
pub(crate) fn paper<const N: usize>() -> TwoDimensional<N> {
    TwoDimensional::untried(network().0, InvertingSettings::DEFAULT)
}

/// Returns the regulator of axes like the axes of `tnv40`, with fast speed loops, which follow like
/// the tool of a [`Rig`]. Each has noise, a disturbance and, with `gives`, a ball screw with
/// backlash. The regulator decides in every servo period.
pub(crate) fn regulator<const N: usize>(gives: bool) -> LqgIdentified<N> {
    let mut axis = Parameters {
        rad_per_mm: 0.628,
        kp_1_s: 1.0 / LAG_S,
        kd: 0.0,
        kv_nm_s_per_rad: 2.0,
        torque_limit_nm: 30.0,
        inertia_kg_m2: 0.002,
        viscous_friction_nm_s: 0.0,
        coulomb_friction_nm: 0.0,
        coulomb_smoothing_rad_s: 0.05,
        presliding_rad: 1e-4,
        encoder_noise_rad: 1e-4,
        torque_noise_nm: 0.1,
        disturbance_nm: 0.01,
        disturbance_rad_s: 150.0,
        ..Parameters::NOTHING
    };
    if gives {
        (axis.table_share, axis.resonance_rad_s) = (0.4, 600.0);
        (axis.damping_ratio, axis.backlash_rad) = (0.05, 0.002);
    }
    let periods = Periods {
        servo_s: 0.001,
        mechanics_s: 1e-4,
        mechanics_per_servo: 10,
    };
    let bounds = OffsetBounds {
        largest_mm: 0.5,
        fastest_mm_s: 400.0,
        acceleration_mm_s2: 2000.0,
    };
    let settings = LqgSettings::identified(IDENTIFIED_WEIGHT.default, 1e-3, bounds);
    LqgIdentified::new([AxisModel::new(axis, periods); N], settings)
}

/// Behavior of the tool of a [`Rig`]; it lags by 20 ms in either case.
#[derive(Clone, Copy)]
pub(crate) enum Tool {
    /// Stays on the path whatever is commanded, so that an untrained controller can do no harm.
    OnThePath,
    /// Follows the command with a first-order lag.
    Follows,
}

/// Lag of the tool, s, and part of the distance to the command that it then covers in a servo
/// period.
const LAG_S: f64 = 0.02;
const FOLLOWED: f64 = 0.001 / LAG_S;

/// A whole run, stepped by hand: reference, contour error, controller under the supervisor, and a
/// tool.
pub(crate) struct Rig<const N: usize, C> {
    tick: Tick<N>,
    controller: C,
    tool: Tool,
    tool_mm: [f64; N],
}

impl<const N: usize, C: Controller<N>> Rig<N, C> {
    /// Creates a rig, warmed up by nearly a lap.
    pub(crate) fn new(controller: C, tool: Tool) -> Self {
        let tick = Tick::new(0.001, controller.schedule(), Bounds::new(0.5, 400.0, 400.0));
        let mut rig = Self {
            tick,
            controller,
            tool,
            tool_mm: [0.0; N],
        };
        for _ in 0..1000 {
            rig.servo_period();
        }
        rig
    }

    /// Runs one servo period.
    pub(crate) fn servo_period(&mut self) -> Setpoint<N> {
        let setpoint = self
            .tick
            .step(&mut Circle, &mut self.controller, self.tool_mm);
        match self.tool {
            Tool::OnThePath => {
                self.tool_mm = Circle.knot(setpoint.tau_s + 0.001 - LAG_S).position_mm;
            }
            Tool::Follows => {
                for axis in 0..N {
                    self.tool_mm[axis] +=
                        FOLLOWED * (setpoint.command_mm[axis] - self.tool_mm[axis]);
                }
            }
        }
        setpoint
    }

    /// Stops the measurement if the supervisor has taken the controller out of the loop: its work
    /// would be missing.
    pub(crate) fn expect_in_the_loop(&self) {
        assert!(
            self.tick.fade().is_none(),
            "the supervisor took the controller out: {:?}",
            self.tick.fade()
        );
    }
}

/// A register filled by the circle, its preview, and a tool that lags by 20 ms and is 20 um inside.
pub(crate) struct Surroundings<const N: usize> {
    register: Register<N>,
    preview: Preview<N>,
    /// Position of the tool, mm.
    pub(crate) tool_mm: [f64; N],
}

impl<const N: usize> Surroundings<N> {
    /// Creates the state after 0.3 s.
    pub(crate) fn new() -> Self {
        let mut register = Register::default();
        for i in 0..300 {
            register.push(Circle.knot(f64::from(i) * 0.001));
        }
        let mut preview = Preview::new(0.001);
        preview.fill(&mut Circle, 0.299, 0.15);
        let mut tool: Knot<N> = Circle.knot(0.279);
        tool.position_mm[0] += 0.02 * tool.tangent[1];
        Self {
            register,
            preview,
            tool_mm: tool.position_mm,
        }
    }

    /// Returns the window that the controller sees.
    pub(crate) fn window(&self) -> Window<'_, N> {
        Window {
            register: &self.register,
            preview: &self.preview,
            tau_s: 0.299,
            feed_period_s: 0.01,
            offset_mm: [0.0; N],
            offset_mm_s: [0.0; N],
        }
    }

    /// Returns the measured position and contour error.
    pub(crate) fn measured(&self) -> Measured<N> {
        let contour: ContourError<N> = Estimator::default().estimate(&self.window(), self.tool_mm);
        Measured {
            position_mm: self.tool_mm,
            contour,
        }
    }
}

/// Runs one decision: observe, command.
pub(crate) fn decide<const N: usize>(
    controller: &mut impl Controller<N>,
    window: &Window<'_, N>,
    measured: &Measured<N>,
) -> [f64; N] {
    controller.observe(window, Some(measured));
    controller.command(window, measured).offset_mm
}
