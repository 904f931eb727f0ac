//! The free run of an axis: the response of its model to the commands alone, with the drive's known
//! settings and any parameters.
//!
//! It steps the model of [`feedwright_control::axis`] as the plant does, with the delays of the
//! drive and of the measurement in whole mechanics periods. From the recording it takes only the
//! commands that the position loop had and the start of the axis. No measured position enters, so
//! no measurement noise does either.

use feedwright_control::{
    AxisModel, DriveModel, DriveReference, DriveState, MechanicsModel, MechanicsState, Parameters,
};

use super::with_identified;

/// An axis that runs freely.
pub(super) struct FreeRun {
    axis_model: AxisModel,
    drive: DriveModel,
    mechanics: MechanicsModel,
    /// Delays of the drive and of the measurement, mechanics periods.
    late: [usize; 2],
}

impl FreeRun {
    pub(super) fn new(known: &AxisModel, found: &Parameters) -> Self {
        let axis_model = known.with(|axis| *axis = with_identified(axis, found));
        let Parameters {
            drive_delay_s,
            measurement_delay_s,
            ..
        } = axis_model.parameters;
        Self {
            drive: DriveModel::new(&axis_model),
            mechanics: MechanicsModel::new(&axis_model),
            // A float that is not a number saturates to zero here.
            late: [drive_delay_s, measurement_delay_s]
                .map(|delay_s| (delay_s / axis_model.periods.mechanics_s).round() as usize),
            axis_model,
        }
    }

    /// Positions at the starts of the servo periods of these commands, as they are measured but for
    /// all noise, mm, of several axes with the same settings; from a place, mm, and a speed, mm/s.
    ///
    /// They run side by side: each step of one waits for its step before, and the processor works
    /// on the others meanwhile.
    pub(super) fn measured_mm<const M: usize>(
        axes: &[Self; M],
        commands_mm: &[f64],
        start_mm: f64,
        start_mm_s: f64,
    ) -> [Vec<f64>; M] {
        let mut running = axes
            .each_ref()
            .map(|axis| FreeAxis::new(axis, commands_mm.len(), start_mm, start_mm_s));
        for command_mm in commands_mm {
            running
                .iter_mut()
                .for_each(|axis| axis.command(*command_mm));
            for _ in 0..axes[0].axis_model.periods.mechanics_per_servo {
                FreeAxis::step(&mut running);
            }
        }
        running.map(|axis| axis.measured_mm)
    }
}

/// An axis on its way.
struct FreeAxis<'a> {
    axis: &'a FreeRun,
    start_rad: f64,
    masses: MechanicsState,
    drive: DriveState,
    /// Angle at the start of each mechanics period up to the next one, rad.
    course_rad: Vec<f64>,
    sent: Vec<DriveReference>,
    measured_mm: Vec<f64>,
}

impl<'a> FreeAxis<'a> {
    fn new(axis: &'a FreeRun, commands: usize, start_mm: f64, start_mm_s: f64) -> Self {
        let scale = axis.axis_model.parameters.rad_per_mm;
        let start_rad = start_mm * scale;
        let mut course_rad =
            Vec::with_capacity(commands * axis.axis_model.periods.mechanics_per_servo as usize + 1);
        course_rad.push(start_rad);
        Self {
            axis,
            start_rad,
            masses: MechanicsState::moving(start_rad, start_mm_s * scale),
            drive: DriveState::AT_REST,
            course_rad,
            sent: Vec::with_capacity(commands),
            measured_mm: Vec::with_capacity(commands),
        }
    }

    /// Returns the mechanics period `late` periods before the next, if the run had begun then.
    fn moment(&self, late: usize) -> Option<usize> {
        (self.course_rad.len() - 1).checked_sub(late)
    }

    /// A servo period begins.
    fn command(&mut self, command_mm: f64) {
        let FreeRun {
            axis_model,
            drive,
            late: [_, measured_late],
            ..
        } = self.axis;
        let scale = axis_model.parameters.rad_per_mm;
        let measured_rad = self
            .moment(*measured_late)
            .map_or(self.start_rad, |then| self.course_rad[then]);
        self.measured_mm.push(measured_rad / scale);
        let motor = &mut self.masses.motor;
        self.sent.push(drive.position_loop(
            axis_model,
            command_mm * scale,
            measured_rad,
            motor,
            &mut self.drive,
        ));
    }

    /// A mechanics period of several.
    #[inline]
    fn step<const M: usize>(running: &mut [Self; M]) {
        let axis_models = running.each_ref().map(|running| &running.axis.mechanics);
        let torques_nm = running.each_mut().map(Self::torque_nm);
        MechanicsModel::advance_abreast(
            &axis_models,
            running.each_mut().map(|running| &mut running.masses),
            torques_nm,
        );
        running
            .iter_mut()
            .for_each(|running| running.course_rad.push(running.masses.motor.angle_rad));
    }

    /// Torque of the motor, N m.
    #[inline]
    fn torque_nm(&mut self) -> f64 {
        let FreeRun {
            axis_model,
            drive,
            late: [drive_late, _],
            ..
        } = self.axis;
        let per_servo = axis_model.periods.mechanics_per_servo as usize;
        let arrived = self
            .moment(*drive_late)
            .map(|then| self.sent[then / per_servo]);
        let speed_rad_s = self.masses.motor.speed_rad_s;
        drive.torque_nm(
            axis_model,
            arrived.unwrap_or_default(),
            speed_rad_s,
            &mut self.drive,
        )
    }
}
