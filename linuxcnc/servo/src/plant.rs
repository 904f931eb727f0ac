//! A simulated machine: the servo axes of [`feedwright_control::AxisModel`] with the parameters of a
//! model file.
//!
//! Loops, inertia, friction, delays, the drive's feedforward and filter, the disturbance, cogging,
//! broadband torque, and the encoder's noise and step come from the file. The geometry of the file
//! gives the tool position. Two masses and jitter are not in a model file, and not here.
//!
//! ```text
//! load = D sin(W t) + x                  t at the start of a mechanics period; x(c+1) = a x(c) + s sqrt(1 - a^2) n(c), a = exp(-dt / T)
//! y    = q round((angle + s n) / q)      what the encoder shows
//! ```
//!
//! Random numbers n: sums of twelve 16-bit parts of SplitMix64, which are nearly normal. Source:
//! Steele, Lea and Flood (2014), "Fast splittable pseudorandom number generators".

use core::f64::consts::TAU;

use feedwright_control::{
    AxisModel, AxisState, CommandQueue, DriveModel, DriveReference, DriveState, FrictionModel,
    IdentifiedAxes, KnownGeometry, Part, friction_signs, sin,
};

/// References and positions that are kept, servo periods: 20 ms each way at 1 ms, and some.
const KEPT: usize = 128;

/// N axes and their state.
#[derive(Debug, Clone)]
pub struct SimulatedMachine<const N: usize> {
    axes: [SimulatedAxis; N],
    geometry: Option<KnownGeometry<N>>,
    /// Servo periods since the start.
    period: u64,
}

impl<const N: usize> SimulatedMachine<N> {
    /// Starts at rest at zero, with random numbers from `seed`.
    pub fn new(machine: &IdentifiedAxes<N>, seed: u64) -> Self {
        let mut axes = machine.axis_models().map(SimulatedAxis::new);
        for (i, axis) in axes.iter_mut().enumerate() {
            axis.noise.state ^= splitmix(seed.wrapping_add(i as u64));
        }
        Self {
            axes,
            geometry: None,
            period: 0,
        }
    }

    /// The same axes, without noise and disturbance.
    pub fn without_noise(machine: &IdentifiedAxes<N>) -> Self {
        let quiet = |axis_model: AxisModel| {
            SimulatedAxis::new(axis_model.with(|axis| *axis = axis.without(&[Part::Noise])))
        };
        Self {
            axes: machine.axis_models().map(quiet),
            geometry: None,
            period: 0,
        }
    }

    /// Replaces the geometry; `None` removes it.
    #[must_use]
    pub fn with_geometry(self, geometry: Option<KnownGeometry<N>>) -> Self {
        Self { geometry, ..self }
    }

    /// Stands at a place.
    pub fn place(&mut self, position_mm: [f64; N]) {
        self.axes
            .iter_mut()
            .zip(position_mm)
            .for_each(|(axis, mm)| axis.place(mm));
    }

    /// Advances by one servo period under a command, with the inertia of the model times `inertia`.
    /// An axis without power, or with a command that is not finite, stops where it is.
    pub fn step(&mut self, command_mm: [f64; N], powered: bool, inertia: f64) {
        for (axis, command_mm) in self.axes.iter_mut().zip(command_mm) {
            if powered && command_mm.is_finite() {
                axis.turn(command_mm, inertia, self.period);
            } else {
                let position_mm = axis.position_mm();
                axis.place(position_mm);
            }
        }
        self.period += 1;
    }

    /// Returns the joint positions, mm.
    pub fn position_mm(&self) -> [f64; N] {
        self.axes.each_ref().map(SimulatedAxis::position_mm)
    }

    /// Returns the tool position, mm.
    pub fn tool_mm(&self) -> [f64; N] {
        self.geometry
            .as_ref()
            .map_or(self.position_mm(), |geometry| {
                geometry.tool_mm(self.position_mm())
            })
    }

    /// Returns the joint positions that the control has, mm.
    pub fn measured_mm(&self) -> [f64; N] {
        self.axes
            .each_ref()
            .map(|axis| axis.arrived_rad / axis.axis_model.parameters.rad_per_mm)
    }

    /// Torque of each motor at the end of the servo period, N m.
    pub fn torque_nm(&self) -> [f64; N] {
        self.axes.each_ref().map(|axis| axis.torque_nm)
    }
}

#[derive(Debug, Clone)]
struct SimulatedAxis {
    axis_model: AxisModel,
    /// Inertia that the file says, kg m2.
    inertia_kg_m2: f64,
    drive: DriveModel,
    friction: Option<FrictionModel>,
    inertia: f64,
    state: AxisState,
    drive_state: DriveState,
    presliding_nm: f64,
    torque_nm: f64,
    broadband_nm: f64,
    /// Share of the broadband torque that is left after a mechanics period.
    kept: f64,
    /// Commands on their way to the position loop, rad.
    commands: CommandQueue,
    /// References on their way to the drive, the newest first.
    sent: [DriveReference; KEPT],
    /// Angles that the encoder has shown, the newest first, each at the moment from which it is
    /// there at the start of a servo period.
    shown_rad: [f64; KEPT],
    arrived_rad: f64,
    noise: NoiseSource,
}

impl SimulatedAxis {
    fn new(axis_model: AxisModel) -> Self {
        let (parameters, periods) = (axis_model.parameters, axis_model.periods);
        let kept = if parameters.torque_noise_s > 0.0 {
            libm::exp(-periods.mechanics_s / parameters.torque_noise_s)
        } else {
            0.0
        };
        Self {
            axis_model,
            inertia_kg_m2: parameters.inertia_kg_m2,
            drive: DriveModel::new(&axis_model),
            friction: FrictionModel::if_present(&axis_model),
            inertia: 1.0,
            state: AxisState::default(),
            drive_state: DriveState::AT_REST,
            presliding_nm: 0.0,
            torque_nm: 0.0,
            broadband_nm: 0.0,
            kept,
            commands: CommandQueue::resting(parameters.command_periods(periods.servo_s), 0.0),
            sent: [DriveReference::default(); KEPT],
            shown_rad: [0.0; KEPT],
            arrived_rad: 0.0,
            noise: NoiseSource { state: 0 },
        }
    }

    fn position_mm(&self) -> f64 {
        self.state.angle_rad / self.axis_model.parameters.rad_per_mm
    }

    fn place(&mut self, position_mm: f64) {
        let angle_rad = position_mm * self.axis_model.parameters.rad_per_mm;
        self.state = AxisState {
            angle_rad,
            ..AxisState::default()
        };
        (self.drive_state, self.presliding_nm, self.torque_nm) = (DriveState::AT_REST, 0.0, 0.0);
        self.commands = CommandQueue::resting(self.commands.periods(), angle_rad);
        self.sent = [DriveReference::default(); KEPT];
        self.shown_rad = [angle_rad; KEPT];
        self.arrived_rad = angle_rad;
    }

    /// The machine is as heavy as this many times what its file says.
    fn load(&mut self, inertia: f64) {
        let possible = inertia > 0.0 && inertia.is_finite();
        if possible && inertia.to_bits() != self.inertia.to_bits() {
            self.inertia = inertia;
            let inertia_kg_m2 = self.inertia_kg_m2 * inertia;
            self.axis_model = self
                .axis_model
                .with(|axis| axis.inertia_kg_m2 = inertia_kg_m2);
            self.friction = FrictionModel::if_present(&self.axis_model);
        }
    }

    fn turn(&mut self, command_mm: f64, inertia: f64, period: u64) {
        self.load(inertia);
        let (parameters, periods) = (self.axis_model.parameters, self.axis_model.periods);
        let command_rad = self
            .commands
            .pass(command_mm * self.axis_model.parameters.rad_per_mm);
        let reference = self.drive.position_loop(
            &self.axis_model,
            command_rad,
            self.arrived_rad,
            &mut self.state,
            &mut self.drive_state,
        );
        self.sent.copy_within(..KEPT - 1, 1);
        self.sent[0] = reference;
        let late = |delay_s: f64| libm::round(delay_s / periods.mechanics_s) as u32;
        let (drive_late, shown_late) = (
            late(parameters.drive_delay_s),
            late(parameters.measurement_delay_s),
        );
        let per_servo = periods.mechanics_per_servo.max(1);
        // An angle is taken where it is a delay before the start of a servo period.
        let takes_at = (per_servo - shown_late % per_servo) % per_servo;
        for substep in 0..per_servo {
            if substep == takes_at && takes_at > 0 {
                self.show();
            }
            // So long before the end of this servo period was sent what acts now.
            let ago = (drive_late + per_servo - 1 - substep) / per_servo;
            let acting = self.sent.get(ago as usize).copied().unwrap_or_default();
            self.mechanics(
                acting,
                (period as f64) * periods.servo_s + f64::from(substep) * periods.mechanics_s,
            );
        }
        if takes_at == 0 {
            self.show();
        }
        let whole = if takes_at == 0 {
            shown_late / per_servo
        } else {
            shown_late.div_ceil(per_servo) - 1
        };
        self.arrived_rad = self
            .shown_rad
            .get(whole as usize)
            .copied()
            .unwrap_or(self.arrived_rad);
    }

    /// The encoder is read.
    fn show(&mut self) {
        let statistics = &self.axis_model.parameters;
        let angle_rad = self.state.angle_rad;
        let interpolation_rad = statistics.interpolation_rad
            * sin(statistics.signal_per_rad * angle_rad + statistics.interpolation_phase_rad);
        let seen_rad =
            angle_rad + interpolation_rad + statistics.encoder_noise_rad * self.noise.normal();
        let step_rad = statistics.encoder_step_rad;
        let shown_rad = if step_rad > 0.0 {
            step_rad * libm::round(seen_rad / step_rad)
        } else {
            seen_rad
        };
        self.shown_rad.copy_within(..KEPT - 1, 1);
        self.shown_rad[0] = shown_rad;
    }

    /// One mechanics period.
    fn mechanics(&mut self, reference: DriveReference, t_s: f64) {
        let axis_model = &self.axis_model;
        let statistics = &axis_model.parameters;
        let turns = statistics.disturbance_rad_s * t_s / TAU;
        let disturbance_nm = statistics.disturbance_nm * sin(TAU * (turns - libm::floor(turns)));
        let step_nm = statistics.torque_noise_nm * libm::sqrt(1.0 - self.kept * self.kept);
        self.broadband_nm = self.kept * self.broadband_nm + step_nm * self.noise.normal();
        let (angle_rad, w) = (self.state.angle_rad, self.state.speed_rad_s);
        let cogging_nm = statistics.cogging_nm
            * sin(statistics.cogging_per_rev * angle_rad + statistics.cogging_phase_rad);
        self.torque_nm = self
            .drive
            .torque_nm(axis_model, reference, w, &mut self.drive_state);
        let forces_nm = self.torque_nm + cogging_nm - disturbance_nm - self.broadband_nm;
        match &self.friction {
            Some(friction) => {
                let inverse_inertia = 1.0 / axis_model.parameters.inertia_kg_m2;
                self.state.speed_rad_s = friction.speed_after_rad_s(
                    forces_nm,
                    inverse_inertia,
                    w,
                    &mut self.presliding_nm,
                );
                self.state.angle_rad += axis_model.periods.mechanics_s * self.state.speed_rad_s;
            }
            None => {
                let [sign] = friction_signs(&[*axis_model], [w]);
                axis_model.accelerate(forces_nm - axis_model.friction_nm(w, sign), &mut self.state);
            }
        }
    }
}

/// Random numbers of an axis.
#[derive(Debug, Clone, Copy)]
struct NoiseSource {
    state: u64,
}

impl NoiseSource {
    /// Returns a random number with mean 0 and standard deviation 1.
    fn normal(&mut self) -> f64 {
        let mut sum = 0_i64;
        for _ in 0..3 {
            self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let bits = splitmix(self.state);
            sum += [0, 16, 32, 48]
                .iter()
                .map(|shift| (bits >> shift & 0xffff) as i64)
                .sum::<i64>();
        }
        // Twelve times the mean of 16 bits.
        (sum - 393_210) as f64 / 65536.0
    }
}

fn splitmix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
