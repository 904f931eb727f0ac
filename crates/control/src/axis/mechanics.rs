//! A mechanics period of an axis under given torques: motor, table on a compliant ball screw,
//! friction.
//!
//! Simulation, estimation and the free runs of the identification all step their masses with this
//! code.

use core::array::from_fn;

use super::friction::FrictionModel;
use super::transmission::{TableState, TransmissionModel};
use super::{AxisModel, AxisState, friction_signs};

/// Masses and friction of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MechanicsModel {
    axis_model: AxisModel,
    /// Friction in addition to smoothed Coulomb friction.
    friction: Option<FrictionModel>,
    transmission: Option<TransmissionModel>,
    inverse_inertia: f64,
}

/// State of the moving masses.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MechanicsState {
    /// Motor, with the last error of its position loop.
    pub motor: AxisState,
    /// Table: angle and speed of the motor where the screw is rigid.
    pub table: TableState,
    /// Friction of the presliding spring, N m.
    pub presliding_nm: f64,
}

impl MechanicsState {
    /// Creates a state at rest at an angle, in the middle of the backlash.
    pub fn at_rest(angle_rad: f64) -> Self {
        Self::moving(angle_rad, 0.0)
    }

    /// Creates a state in which motor and table move at one speed.
    pub fn moving(angle_rad: f64, speed_rad_s: f64) -> Self {
        Self {
            motor: AxisState {
                angle_rad,
                speed_rad_s,
                ..AxisState::default()
            },
            table: TableState {
                angle_rad,
                speed_rad_s,
            },
            presliding_nm: 0.0,
        }
    }
}

impl MechanicsModel {
    /// Creates the mechanics of an axis.
    pub fn new(axis_model: &AxisModel) -> Self {
        Self {
            axis_model: *axis_model,
            friction: FrictionModel::if_present(axis_model),
            transmission: TransmissionModel::new(axis_model),
            inverse_inertia: 1.0 / axis_model.parameters.inertia_kg_m2,
        }
    }

    /// Returns the screw, if it is compliant.
    pub fn transmission(&self) -> Option<&TransmissionModel> {
        self.transmission.as_ref()
    }

    /// Integrates one mechanics period under a torque of the motor and a load on the table, N m.
    #[inline]
    pub fn advance(&self, state: &mut MechanicsState, motor_nm: f64, load_nm: f64) {
        match &self.friction {
            Some(friction) => {
                let [forces_nm, inverse, speed_rad_s] = self.push(state, motor_nm, load_nm);
                let after = friction.speed_after_rad_s(
                    forces_nm,
                    inverse,
                    speed_rad_s,
                    &mut state.presliding_nm,
                );
                self.go_on(state, after);
            }
            None => self.advance_smoothly(state, motor_nm, load_nm),
        }
    }

    /// Integrates several axes without a load, in about the time of one: the processor works on the
    /// others while it computes the friction of one.
    #[inline]
    pub fn advance_abreast<const L: usize>(
        axis_models: &[&Self; L],
        mut states: [&mut MechanicsState; L],
        motor_nm: [f64; L],
    ) {
        let all_slide = axis_models
            .iter()
            .all(|axis_model| axis_model.friction.is_some());
        let Some(first) = axis_models
            .first()
            .and_then(|axis_model| axis_model.friction.as_ref())
            .filter(|_| all_slide)
        else {
            (0..L).for_each(|i| axis_models[i].advance(states[i], motor_nm[i], 0.0));
            return;
        };
        let pushed: [[f64; 3]; L] = from_fn(|i| axis_models[i].push(states[i], motor_nm[i], 0.0));
        let mut presliding_nm: [f64; L] = from_fn(|i| states[i].presliding_nm);
        let frictions = axis_models.map(|axis_model| axis_model.friction.as_ref().unwrap_or(first));
        let [forces_nm, inverse, speeds] = from_fn(|k| pushed.map(|pushed| pushed[k]));
        let after = FrictionModel::speeds_after_rad_s(
            &frictions,
            forces_nm,
            inverse,
            speeds,
            &mut presliding_nm,
        );
        for i in 0..L {
            states[i].presliding_nm = presliding_nm[i];
            axis_models[i].go_on(states[i], after[i]);
        }
    }

    /// Returns the torque on the sliding mass, N m, the inverse of its inertia, and its speed. The
    /// sliding mass is the table, and includes the motor where the screw is rigid.
    #[inline]
    fn push(&self, state: &mut MechanicsState, motor_nm: f64, load_nm: f64) -> [f64; 3] {
        let MechanicsState { motor, table, .. } = state;
        let Some(screw) = &self.transmission else {
            return [motor_nm - load_nm, self.inverse_inertia, motor.speed_rad_s];
        };
        let through_nm = screw.torque_nm(
            motor.angle_rad - table.angle_rad,
            motor.speed_rad_s - table.speed_rad_s,
        );
        motor.speed_rad_s += self.axis_model.periods.mechanics_s
            * screw.inverse_motor_inertia
            * (motor_nm - through_nm);
        [
            through_nm - load_nm,
            screw.inverse_table_inertia,
            table.speed_rad_s,
        ]
    }

    /// Moves the masses through a mechanics period at whose end the sliding mass has a speed.
    #[inline]
    fn go_on(&self, state: &mut MechanicsState, after_rad_s: f64) {
        let dt_s = self.axis_model.periods.mechanics_s;
        let MechanicsState { motor, table, .. } = state;
        if self.transmission.is_none() {
            motor.speed_rad_s = after_rad_s;
            motor.angle_rad += dt_s * after_rad_s;
            *table = TableState {
                angle_rad: motor.angle_rad,
                speed_rad_s: motor.speed_rad_s,
            };
        } else {
            table.speed_rad_s = after_rad_s;
            motor.angle_rad += dt_s * motor.speed_rad_s;
            table.angle_rad += dt_s * table.speed_rad_s;
        }
    }

    /// Integrates a mechanics period with smoothed Coulomb friction only.
    #[inline]
    fn advance_smoothly(&self, state: &mut MechanicsState, motor_nm: f64, load_nm: f64) {
        if self.transmission.is_none() {
            let motor = &mut state.motor;
            self.axis_model.accelerate(
                motor_nm - (self.friction_nm(motor.speed_rad_s) + load_nm),
                motor,
            );
            state.table = TableState {
                angle_rad: motor.angle_rad,
                speed_rad_s: motor.speed_rad_s,
            };
            return;
        }
        let [pushed_nm, inverse, speed_rad_s] = self.push(state, motor_nm, 0.0);
        let load_nm = self.friction_nm(speed_rad_s) + load_nm;
        self.go_on(
            state,
            speed_rad_s + self.axis_model.periods.mechanics_s * inverse * (pushed_nm - load_nm),
        );
    }

    /// Returns the viscous and Coulomb friction, N m.
    #[inline]
    fn friction_nm(&self, speed_rad_s: f64) -> f64 {
        let [sign] = friction_signs(&[self.axis_model], [speed_rad_s]);
        self.axis_model.friction_nm(speed_rad_s, sign)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Parameters, Periods};
    use super::*;

    fn axis_model(coulomb_friction_nm: f64) -> AxisModel {
        let parameters = Parameters {
            rad_per_mm: 0.6,
            kp_1_s: 50.0,
            kd: 0.0,
            kv_nm_s_per_rad: 2.0,
            torque_limit_nm: 30.0,
            inertia_kg_m2: 0.01,
            viscous_friction_nm_s: 0.0,
            coulomb_friction_nm,
            coulomb_smoothing_rad_s: 0.5,
            ..Parameters::NOTHING
        };
        AxisModel::new(
            parameters,
            Periods {
                servo_s: 0.001,
                mechanics_s: 1e-5,
                mechanics_per_servo: 100,
            },
        )
    }

    fn with_screw(axis_model: &AxisModel, resonance_rad_s: f64) -> AxisModel {
        axis_model.with(|axis| {
            (axis.table_share, axis.damping_ratio) = (0.4, 0.05);
            axis.resonance_rad_s = resonance_rad_s;
        })
    }

    /// Returns the state after a tenth of a second under 1 N m at the motor and 0.3 N m against the
    /// table.
    fn driven(mechanics: &MechanicsModel) -> MechanicsState {
        let mut state = MechanicsState::at_rest(0.0);
        (0..10_000).for_each(|_| mechanics.advance(&mut state, 1.0, 0.3));
        state
    }

    #[test]
    fn several_axes_at_once_are_each_as_it_is_alone() {
        let none = axis_model(0.2);
        let dahl = none.with(|axis| axis.presliding_rad = 0.001);
        for axis_models in [
            [with_screw(&dahl, 300.0), dahl],
            [with_screw(&dahl, 300.0), with_screw(&none, 200.0)],
        ] {
            let axis_models = axis_models.map(|axis_model| MechanicsModel::new(&axis_model));
            let mut alone = [MechanicsState::at_rest(0.0); 2];
            let mut abreast = alone;
            for step in 0..5000_u32 {
                let torques_nm = [0.5, 0.9].map(|nm| nm * libm::sin(0.003 * f64::from(step)));
                (0..2).for_each(|i| axis_models[i].advance(&mut alone[i], torques_nm[i], 0.0));
                MechanicsModel::advance_abreast(
                    &axis_models.each_ref(),
                    abreast.each_mut(),
                    torques_nm,
                );
                assert_eq!(abreast, alone, "{step}");
            }
        }
    }

    #[test]
    fn a_stiff_screw_is_as_a_rigid_one() {
        for coulomb_nm in [0.0, 0.2] {
            let axis_model = axis_model(coulomb_nm);
            let rigid = driven(&MechanicsModel::new(&axis_model));
            let stiff = driven(&MechanicsModel::new(&with_screw(&axis_model, 5e3)));
            let (a, b) = (rigid.motor.speed_rad_s, stiff.motor.speed_rad_s);
            assert!((a - b).abs() < 2e-3 * a, "{a} {b}");
            assert_eq!(
                [rigid.table.angle_rad, rigid.table.speed_rad_s],
                [rigid.motor.angle_rad, a]
            );
        }
    }

    #[test]
    fn both_masses_together_have_the_momentum_that_the_torques_gave() {
        let state = driven(&MechanicsModel::new(&with_screw(&axis_model(0.0), 300.0)));
        let momentum = 0.006 * state.motor.speed_rad_s + 0.004 * state.table.speed_rad_s;
        assert!((momentum - 0.7 * 0.1).abs() < 1e-9, "{momentum}");
    }
}
