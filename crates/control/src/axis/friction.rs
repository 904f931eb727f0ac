//! Friction of real machines: a level that depends on the direction and increases at low speed, and
//! presliding.
//!
//! ```text
//! g(w, d) = Fc + Fa d + Fs exp(-(w / ws)^2)             level, N m, of a motion in the direction d = -1, 1
//! F = B w + tanh(w / w_s) g                             without presliding; Fa d is Fa tanh there
//! F = B w + f,  df/dt = S (w - |w| f / g),  S = (Fc + Fs) / z         with it
//! ```
//!
//! The second is the LuGre model without the damping of its bristles, which is Dahl's model without
//! a Stribeck part: a spring S that yields as it approaches the level, over the deflection z.
//!
//! Over a mechanics period dt of constant w, f has a closed form, which is integrated. The speed
//! enters it implicitly, linearized about w = 0, so that a spring too stiff for dt is stable:
//!
//! ```text
//! a  = w + dt / J (forces - B w - f),   d = sgn a
//! w' = a / (1 + dt^2 S max(0, 1 - f d / g) / J)
//! f' = d g + (f - d g) exp(-S |w'| dt / g)
//! ```
//!
//! Symbols: Fc Coulomb friction; Fa its asymmetry; Fs excess of the breakaway torque over Fc; ws
//! Stribeck speed, rad/s; z presliding deflection, rad at the motor shaft; B viscous friction; w_s
//! speed over which friction changes sign.
//!
//! Source: Dahl (1968), A solid friction model; Canudas de Wit, Olsson, Åström and Lischinsky
//! (1995), A new model for control of systems with friction, eqs 1 to 4; Armstrong-Hélouvry, Dupont
//! and Canudas de Wit (1994), a survey, for asymmetry and the Stribeck curve; the linearly implicit
//! step is Rosenbrock's, Hairer and Wanner (1996), section IV.7.

use core::array::from_fn;

use super::numbers::Part;
use super::{AxisModel, Parameters};
use crate::activation::{exp, tanh};

/// Smallest level as a part of Fc + Fs: an asymmetry as large as the Coulomb friction makes the
/// level 0, and the level is a divisor.
const LEAST_LEVEL: f64 = 1e-9;
/// Exponent x beyond which e^-x is negligible beside 1, and its value there.
const FORGOTTEN: f64 = 40.0;
const LEAST_DECAY: f64 = 4.248_354_255_291_589e-18;
/// Argument beyond which tanh is 1 to the last bit.
const SATURATED: f64 = 20.0;

/// Friction of an axis, ready to be integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionModel {
    coulomb_asymmetry_nm: f64,
    stribeck_nm: f64,
    dt_s: f64,
    viscous_nm_s: f64,
    coulomb_nm: f64,
    inverse_smoothing_s: f64,
    inverse_stribeck_s: f64,
    stiffness_nm_rad: f64,
    least_nm: f64,
}

impl FrictionModel {
    /// Creates the friction of an axis; `None` where it is Coulomb and viscous friction alone.
    pub fn if_present(axis_model: &AxisModel) -> Option<Self> {
        let is_present = axis_model.parameters.has(Part::Friction);
        is_present.then(|| Self::new(axis_model))
    }

    /// Creates the friction of an axis.
    pub fn new(axis_model: &AxisModel) -> Self {
        let Parameters {
            viscous_friction_nm_s,
            coulomb_friction_nm,
            coulomb_asymmetry_nm,
            stribeck_nm,
            stribeck_rad_s,
            presliding_rad,
            ..
        } = axis_model.parameters;
        let breakaway_nm = coulomb_friction_nm + stribeck_nm;
        Self {
            coulomb_asymmetry_nm,
            stribeck_nm,
            dt_s: axis_model.periods.mechanics_s,
            viscous_nm_s: viscous_friction_nm_s,
            coulomb_nm: coulomb_friction_nm,
            inverse_smoothing_s: axis_model.inverse_smoothing_s,
            inverse_stribeck_s: if stribeck_rad_s > 0.0 {
                1.0 / stribeck_rad_s
            } else {
                0.0
            },
            stiffness_nm_rad: if presliding_rad > 0.0 {
                (breakaway_nm / presliding_rad).min(f64::MAX)
            } else {
                0.0
            },
            least_nm: LEAST_LEVEL * breakaway_nm,
        }
    }

    /// Returns the speed after a mechanics period under forces without friction, N m at the shaft.
    /// `presliding_nm` is f.
    #[inline]
    pub fn speed_after_rad_s(
        &self,
        forces_nm: f64,
        inverse_inertia: f64,
        speed_rad_s: f64,
        presliding_nm: &mut f64,
    ) -> f64 {
        let presliding_nm = core::array::from_mut(presliding_nm);
        let [after] = Self::speeds_after_rad_s(
            &[self],
            [forces_nm],
            [inverse_inertia],
            [speed_rad_s],
            presliding_nm,
        );
        after
    }

    /// Computes [`Self::speed_after_rad_s`] for several masses at once: a processor computes two or
    /// four exponentials in the time of one.
    #[inline]
    pub fn speeds_after_rad_s<const L: usize>(
        axis_models: &[&Self; L],
        forces_nm: [f64; L],
        inverse_inertia: [f64; L],
        speeds: [f64; L],
        presliding_nm: &mut [f64; L],
    ) -> [f64; L] {
        let steps: [f64; L] = from_fn(|i| axis_models[i].dt_s * inverse_inertia[i]);
        let left_nm: [f64; L] = from_fn(|i| forces_nm[i] - axis_models[i].viscous_nm_s * speeds[i]);
        let slides_at_once = axis_models.map(|axis_model| axis_model.stiffness_nm_rad == 0.0);
        if slides_at_once.iter().all(|at_once| *at_once) {
            let signs = signs(from_fn(|i| speeds[i] * axis_models[i].inverse_smoothing_s));
            let levels_nm = Self::levels_nm(axis_models, &speeds, &signs);
            return from_fn(|i| speeds[i] + steps[i] * (left_nm[i] - signs[i] * levels_nm[i]));
        }
        if slides_at_once.iter().any(|at_once| *at_once) {
            return from_fn(|i| {
                axis_models[i].speed_after_rad_s(
                    forces_nm[i],
                    inverse_inertia[i],
                    speeds[i],
                    &mut presliding_nm[i],
                )
            });
        }
        let free: [f64; L] = from_fn(|i| speeds[i] + steps[i] * (left_nm[i] - presliding_nm[i]));
        let directions = free.map(|rad_s| f64::copysign(1.0, rad_s));
        let levels_nm = Self::levels_nm(axis_models, &speeds, &directions);
        let levels_nm: [f64; L] = from_fn(|i| levels_nm[i].max(axis_models[i].least_nm));
        let after: [f64; L] = from_fn(|i| {
            let to_go = (1.0 - presliding_nm[i] * directions[i] / levels_nm[i]).max(0.0);
            free[i]
                / (1.0 + steps[i] * axis_models[i].dt_s * axis_models[i].stiffness_nm_rad * to_go)
        });
        let sliding_nm: [f64; L] = from_fn(|i| directions[i] * levels_nm[i]);
        if *presliding_nm != sliding_nm {
            let left: [f64; L] = decays(from_fn(|i| {
                axis_models[i].stiffness_nm_rad * after[i].abs() * axis_models[i].dt_s
                    / levels_nm[i]
            }));
            *presliding_nm =
                from_fn(|i| sliding_nm[i] + (presliding_nm[i] - sliding_nm[i]) * left[i]);
        }
        after
    }

    /// Returns the mean of the friction without its viscous part, N m, over a time at a constant
    /// speed that is imposed on the axis.
    #[inline]
    pub fn along_nm(&self, speed_rad_s: f64, time_s: f64, presliding_nm: &mut f64) -> f64 {
        if self.stiffness_nm_rad == 0.0 {
            let [sign] = signs([speed_rad_s * self.inverse_smoothing_s]);
            return sign * self.level_nm(speed_rad_s, sign);
        }
        let direction = f64::copysign(1.0, speed_rad_s);
        let level_nm = self.level_nm(speed_rad_s, direction).max(self.least_nm);
        let slid = self.stiffness_nm_rad * speed_rad_s.abs() * time_s / level_nm;
        let (sliding_nm, left) = (direction * level_nm, decay(slid));
        let beyond_nm = *presliding_nm - sliding_nm;
        *presliding_nm = sliding_nm + beyond_nm * left;
        // The mean of e^-x from 0 to `slid`; for a short travel its series, which does not cancel.
        let mean = if slid < 1e-4 {
            1.0 - 0.5 * slid
        } else {
            (1.0 - left) / slid
        };
        if slid == 0.0 {
            *presliding_nm
        } else {
            sliding_nm + beyond_nm * mean
        }
    }

    /// Returns the level at a speed, in a direction from -1 to 1, N m.
    #[inline]
    fn level_nm(&self, speed_rad_s: f64, direction: f64) -> f64 {
        let [level_nm] = Self::levels_nm(&[self], &[speed_rad_s], &[direction]);
        level_nm
    }

    #[inline]
    fn levels_nm<const L: usize>(
        axis_models: &[&Self; L],
        speeds_rad_s: &[f64; L],
        directions: &[f64; L],
    ) -> [f64; L] {
        let stribeck_nm = axis_models.map(|axis_model| axis_model.stribeck_nm);
        let mut low_nm = [0.0; L];
        if stribeck_nm.iter().any(|nm| *nm > 0.0) {
            let ratios: [f64; L] = from_fn(|i| speeds_rad_s[i] * axis_models[i].inverse_stribeck_s);
            let left = decays(ratios.map(|ratio| ratio * ratio));
            low_nm = from_fn(|i| {
                if stribeck_nm[i] > 0.0 {
                    stribeck_nm[i] * left[i]
                } else {
                    0.0
                }
            });
        }
        from_fn(|i| {
            axis_models[i].coulomb_nm
                + axis_models[i].coulomb_asymmetry_nm * directions[i]
                + low_nm[i]
        })
    }
}

/// Returns tanh(x), which is 1 or -1 to the last bit most of the time.
#[inline]
fn signs<const L: usize>(x: [f64; L]) -> [f64; L] {
    if x.iter().all(|x| x.abs() >= SATURATED) {
        x.map(|x| f64::copysign(1.0, x))
    } else {
        tanh(x)
    }
}

/// Returns e^-x of non-negative numbers.
#[inline]
fn decays<const L: usize>(x: [f64; L]) -> [f64; L] {
    if x.iter().all(|x| *x >= FORGOTTEN) {
        [LEAST_DECAY; L]
    } else {
        x.map(|x| exp(-x.min(FORGOTTEN)))
    }
}

#[inline]
fn decay(x: f64) -> f64 {
    let [left] = decays([x]);
    left
}

#[cfg(test)]
mod tests {
    use super::super::Periods;
    use super::*;

    #[test]
    fn several_masses_at_once_are_each_as_it_is_alone() {
        let stribeck = Parameters {
            stribeck_nm: 0.1,
            stribeck_rad_s: 1.0,
            ..DAHL
        };
        let sliding = Parameters {
            presliding_rad: 0.0,
            ..stribeck
        };
        for parameters in [
            [DAHL, stribeck],
            [sliding, Parameters::NOTHING],
            [stribeck, sliding],
        ] {
            let axis_models = parameters.map(|parameters| friction(0.2, 1e-4, parameters));
            let (mut speeds, mut presliding) = ([0.0, 3.0], [0.0, 0.1]);
            for step in 0..5000_u32 {
                let forces = [0.5, 0.3].map(|nm| nm * libm::sin(0.003 * f64::from(step)));
                let mut alone = presliding;
                let each: [f64; 2] = from_fn(|i| {
                    axis_models[i].speed_after_rad_s(forces[i], 1.0 / J, speeds[i], &mut alone[i])
                });
                let axis_models = axis_models.each_ref();
                speeds = FrictionModel::speeds_after_rad_s(
                    &axis_models,
                    forces,
                    [1.0 / J; 2],
                    speeds,
                    &mut presliding,
                );
                assert_eq!((speeds, presliding), (each, alone), "{step}");
            }
        }
    }

    #[test]
    fn what_is_not_computed_is_what_would_be_computed() {
        assert_eq!(LEAST_DECAY.to_bits(), exp(-FORGOTTEN).to_bits());
        for x in [SATURATED, 21.7, 1e3, f64::INFINITY] {
            assert_eq!(signs([x, -x]), tanh([x, -x]));
        }
    }

    const J: f64 = 0.01;

    fn friction(coulomb_nm: f64, mechanics_s: f64, parameters: Parameters) -> FrictionModel {
        let axis_model = Parameters {
            rad_per_mm: 0.6,
            kp_1_s: 50.0,
            kd: 0.0,
            kv_nm_s_per_rad: 2.0,
            torque_limit_nm: 30.0,
            inertia_kg_m2: J,
            viscous_friction_nm_s: 0.0,
            coulomb_friction_nm: coulomb_nm,
            coulomb_smoothing_rad_s: 1e-4,
            ..parameters
        };
        let periods = Periods {
            servo_s: 0.001,
            mechanics_s,
            mechanics_per_servo: 10,
        };
        FrictionModel::new(&AxisModel::new(axis_model, periods))
    }

    const DAHL: Parameters = Parameters {
        presliding_rad: 0.01,
        ..Parameters::NOTHING
    };

    /// Friction, N m, of a motion that a speed of `rad_s` is forced upon for a time; by what it
    /// takes to keep the speed.
    fn friction_at(
        axis_model: &FrictionModel,
        rad_s: f64,
        steps: u32,
        mut presliding_nm: f64,
    ) -> f64 {
        let mut found_nm = 0.0;
        for _ in 0..steps {
            let before_nm = presliding_nm;
            let after = axis_model.speed_after_rad_s(before_nm, 1.0 / J, rad_s, &mut presliding_nm);
            found_nm = if axis_model.stiffness_nm_rad > 0.0 {
                presliding_nm
            } else {
                (rad_s - after) * J / axis_model.dt_s + before_nm
            };
        }
        found_nm
    }

    #[test]
    fn dahls_friction_comes_to_its_level_over_the_presliding_deflection() {
        let axis_model = friction(0.2, 1e-6, DAHL);
        // f = Fc (1 - exp(-x / z)) from rest; turned round at +Fc: f = -Fc + 2 Fc exp(-x / z).
        for way_rad in [0.001, 0.005, 0.02_f64] {
            let steps = libm::round(way_rad / (0.5 * 1e-6)) as u32;
            let decayed = libm::exp(-way_rad / 0.01);
            let rising = friction_at(&axis_model, 0.5, steps, 0.0);
            assert!(
                (rising - 0.2 * (1.0 - decayed)).abs() < 1e-6,
                "{way_rad}: {rising}"
            );
            let turned = friction_at(&axis_model, -0.5, steps, 0.2);
            assert!(
                (turned - (-0.2 + 0.4 * decayed)).abs() < 1e-6,
                "{way_rad}: {turned}"
            );
        }
    }

    #[test]
    fn the_level_is_stribecks_curve_and_another_one_each_way() {
        let parameters = Parameters {
            coulomb_asymmetry_nm: 0.03,
            stribeck_nm: 0.1,
            stribeck_rad_s: 2.0,
            ..Parameters::NOTHING
        };
        for presliding_rad in [0.0, 0.001] {
            let axis_model = friction(
                0.2,
                1e-4,
                Parameters {
                    presliding_rad,
                    ..parameters
                },
            );
            for speed in [0.5, -0.5, 2.0, -2.0, 20.0, -20.0_f64] {
                let ratio = speed / 2.0;
                let wanted = f64::copysign(0.2 + 0.1 * libm::exp(-ratio * ratio), speed) + 0.03;
                let found = friction_at(&axis_model, speed, 2000, 0.0);
                assert!((found - wanted).abs() < 1e-6, "{speed}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn within_the_presliding_it_is_a_spring() {
        // f = S x for small x: J x'' = -S x swings at sqrt(S / J) from a push of 1e-4 rad/s, which
        // deflects by z / 4000.
        let axis_model = friction(0.2, 1e-6, DAHL);
        let (mut speed, mut presliding, mut crossings) = (1e-4, 0.0, 0);
        let mut first_s = 0.0;
        let mut last_s = 0.0;
        for step in 0..1_000_000_u32 {
            let after = axis_model.speed_after_rad_s(0.0, 1.0 / J, speed, &mut presliding);
            if speed > 0.0 && after <= 0.0 {
                last_s = f64::from(step) * 1e-6;
                crossings += 1;
                if crossings == 1 {
                    first_s = last_s;
                }
            }
            speed = after;
        }
        let found_rad_s = core::f64::consts::TAU * f64::from(crossings - 1) / (last_s - first_s);
        assert!(
            (found_rad_s - libm::sqrt(0.2 / 0.01 / J)).abs() < 0.01 * found_rad_s,
            "{found_rad_s}"
        );
    }

    #[test]
    fn a_spring_that_no_period_follows_holds_and_lets_go_at_the_breakaway_torque() {
        // S dt^2 / J = 2e5: an explicit step would be unstable from 4 on.
        let stiff = Parameters {
            presliding_rad: 1e-9,
            stribeck_nm: 0.1,
            stribeck_rad_s: 1.0,
            ..DAHL
        };
        let axis_model = friction(0.1, 1e-4, stiff);
        let (mut speed, mut presliding, mut way) = (0.0, 0.0, 0.0);
        for step in 0..20_000_u32 {
            let force = 0.19 * libm::sin(0.01 * f64::from(step));
            speed = axis_model.speed_after_rad_s(force, 1.0 / J, speed, &mut presliding);
            way += 1e-4 * speed;
            assert!(
                (presliding - force).abs() < 0.01 && f64::abs(way) < 1e-6,
                "{step}: {presliding} {way}"
            );
        }
        (0..1000).for_each(|_| {
            speed = axis_model.speed_after_rad_s(0.22, 1.0 / J, speed, &mut presliding);
        });
        assert!(speed > 0.1, "{speed}");
    }

    #[test]
    fn no_value_makes_it_infinite() {
        let ends = [0.0, 1e-300, 1e5];
        for case in 0..27_usize {
            let [coulomb, stribeck, zone] = [ends[case % 3], ends[case / 3 % 3], ends[case / 9]];
            let parameters = Parameters {
                coulomb_asymmetry_nm: coulomb,
                stribeck_nm: stribeck,
                stribeck_rad_s: zone,
                presliding_rad: zone,
                ..Parameters::NOTHING
            };
            let axis_model = friction(coulomb, 1e-4, parameters);
            let (mut speed, mut presliding) = (0.0, 0.0);
            for force in [0.0, 1.0, -1e3, 0.0, 1e-9] {
                speed = axis_model.speed_after_rad_s(force, 1.0 / J, speed, &mut presliding);
                assert!(
                    speed.is_finite() && presliding.is_finite(),
                    "{coulomb} {stribeck} {zone}"
                );
            }
        }
    }
}
