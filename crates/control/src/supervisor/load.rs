//! Question: can the load that the filter of an axis finds be real?
//!
//! ```text
//! |load| > Tmax / 3      the model of the axis is wrong: other gains, another inertia
//! ```
//!
//! Evidence: the load that explains the innovations.

/// Largest load that is plausible, as a part of the torque limit: about the load that a drive with
/// three times its rated torque for a moment can hold.
const LARGEST_LOAD: f64 = 1.0 / 3.0;

/// Returns true if a load is plausible for a drive with this torque limit. NaN is not.
pub(crate) fn is_possible(load_nm: f64, torque_limit_nm: f64) -> bool {
    load_nm.abs() <= LARGEST_LOAD * torque_limit_nm
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_of_the_torque_is_a_load_and_more_is_a_wrong_model() {
        let loads_nm = [0.0, -2.9, 2.9, 3.1, -3.1, f64::NAN];
        assert_eq!(
            loads_nm.map(|nm| is_possible(nm, 9.0)),
            [true, true, true, false, false, false]
        );
    }
}
