//! The free run of an axis: what its law makes of the commands alone, with the drive's known settings and any parameters.
//!
//! It steps the law of [`feedwright_control::axis`] as the plant does, with the delays of the drive and of the measurement in whole
//! mechanics periods, and takes nothing of the recording but the commands and where the axis starts: no measured position comes in, so
//! neither does its noise.

use feedwright_control::{AxisLaw, DriveLaw, DriveReference, DriveState, LoopDelays, MechanicsLaw, MechanicsState};

use super::{AxisParameters, DriveSettings};

/// An axis that runs freely.
pub(super) struct FreeRun {
    law: AxisLaw,
    drive: DriveLaw,
    mechanics: MechanicsLaw,
    /// Delays of the drive and of the measurement, mechanics periods.
    late: [usize; 2],
}

impl FreeRun {
    pub(super) fn new(settings: &DriveSettings, axis: &AxisParameters) -> Self {
        let law = AxisLaw::new(axis.law(settings), settings.periods);
        let LoopDelays { drive_s, measurement_s } = settings.delays;
        Self {
            law,
            drive: DriveLaw::new(&law, settings.drive_of(axis.inertia_kg_m2)),
            mechanics: MechanicsLaw::new(&law, axis.friction(), axis.transmission),
            // A float that is not a number saturates to zero here.
            late: [drive_s, measurement_s].map(|delay_s| (delay_s / settings.periods.mechanics_s).round() as usize),
        }
    }

    /// Positions at the starts of the servo periods of these commands, as they are measured but for all noise, mm; from a place, mm,
    /// and a speed, mm/s.
    pub(super) fn measured_mm(&self, commands_mm: &[f64], start_mm: f64, start_mm_s: f64) -> Vec<f64> {
        let scale = self.law.parameters.rad_per_mm;
        let per_servo = self.law.periods.mechanics_per_servo as usize;
        let [drive_late, measured_late] = self.late;
        let start_rad = start_mm * scale;
        let mut masses = MechanicsState::moving(start_rad, start_mm_s * scale);
        let mut drive = DriveState::AT_REST;
        let mut course_rad = Vec::with_capacity(commands_mm.len() * per_servo);
        let mut sent = Vec::<DriveReference>::with_capacity(commands_mm.len());
        let mut measured_mm = Vec::with_capacity(commands_mm.len());
        for command_mm in commands_mm {
            course_rad.push(masses.motor.angle_rad);
            let measured_rad =
                (course_rad.len() - 1).checked_sub(measured_late).map_or(start_rad, |moment| course_rad[moment]);
            measured_mm.push(measured_rad / scale);
            let command_rad = command_mm * scale;
            sent.push(self.drive.position_loop(&self.law, command_rad, measured_rad, &mut masses.motor, &mut drive));
            for substep in 0..per_servo {
                if substep > 0 {
                    course_rad.push(masses.motor.angle_rad);
                }
                let arrived = (course_rad.len() - 1).checked_sub(drive_late).map(|moment| sent[moment / per_servo]);
                let reference = arrived.unwrap_or_default();
                let torque_nm = self.drive.torque_nm(&self.law, reference, masses.motor.speed_rad_s, &mut drive);
                self.mechanics.advance(&mut masses, torque_nm, 0.0);
            }
        }
        measured_mm
    }
}
