//! Question: how does an offset return to the path? It comes to rest at zero within an acceleration.
//!
//! ```text
//! v(o) = min(o / T, sqrt(c A o))     a = (v - v(o)) / dt, at most A
//! ```
//!
//! toward zero, in each axis: near the plan the offset decays with the time constant T; farther
//! away it brakes along the parabola that A allows, with a margin c.

use crate::vector::bounded;

/// T, s: twice the time constant of a usual position loop, so that the tool follows without a
/// transient of its own.
const TIME_S: f64 = 0.03;
/// c: 2 uses all of A.
pub(super) const MARGIN: f64 = 1.2;
/// Offset and speed below which a fade is over, mm and mm/s.
const NONE_MM: f64 = 1e-6;
const NONE_MM_S: f64 = 1e-3;

/// Returns the acceleration of the next period, mm/s^2, at most `most_mm_s2`, of an offset in one
/// axis that fades to zero.
#[inline]
pub fn fade_acceleration(offset_mm: f64, offset_mm_s: f64, period_s: f64, most_mm_s2: f64) -> f64 {
    let wanted_mm_s = wanted_mm_s(offset_mm, most_mm_s2);
    bounded(
        (wanted_mm_s - offset_mm_s) / period_s,
        -most_mm_s2,
        most_mm_s2,
    )
}

/// Returns the speed of a fade at this offset.
#[inline]
fn wanted_mm_s(offset_mm: f64, most_mm_s2: f64) -> f64 {
    let distance_mm = offset_mm.abs();
    let speed = (distance_mm / TIME_S).min(libm::sqrt(MARGIN * most_mm_s2 * distance_mm));
    if offset_mm > 0.0 { -speed } else { speed }
}

/// Returns the initial speed of the fade of an offset that was reached in one step. The fade need
/// not continue at the speed of that step, unless the step leads back to the plan and can be braked
/// there.
#[inline]
pub(super) fn begins_mm_s(offset_mm: f64, stepped_mm_s: f64, most_mm_s2: f64) -> f64 {
    let wanted_mm_s = wanted_mm_s(offset_mm, most_mm_s2);
    bounded(stepped_mm_s, wanted_mm_s.min(0.0), wanted_mm_s.max(0.0))
}

/// Returns true if the fade is over.
#[inline]
pub(super) fn is_over<const N: usize>(offset_mm: [f64; N], offset_mm_s: [f64; N]) -> bool {
    (0..N).all(|axis| offset_mm[axis].abs() < NONE_MM && offset_mm_s[axis].abs() < NONE_MM_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_that_stepped_where_it_is_does_not_go_on_beyond() {
        let most = 400.0;
        for offset in [0.3, 0.01, -0.2] {
            let wanted = wanted_mm_s(offset, most);
            assert_eq!(begins_mm_s(offset, -wanted, most), 0.0);
            assert_eq!(begins_mm_s(offset, 100.0 * wanted, most), wanted);
            assert_eq!(begins_mm_s(offset, 0.5 * wanted, most), 0.5 * wanted);
            let (mut o, mut v): (f64, f64) =
                (offset, begins_mm_s(offset, 300.0 * offset.signum(), most));
            for _ in 0..2000 {
                let a = fade_acceleration(o, v, 0.001, most);
                (o, v) = (o + 0.001 * (v + 0.0005 * a), v + 0.001 * a);
                assert!(o.abs() <= offset.abs(), "{offset}: {o}");
            }
            assert!(is_over([o], [v]), "{offset}: {o} {v}");
        }
        assert_eq!(begins_mm_s(0.0, 50.0, most), 0.0);
    }

    #[test]
    fn an_offset_comes_to_rest_at_zero_within_the_acceleration_whatever_its_speed() {
        let period_s = 0.003;
        for (offset, speed) in [
            (0.5, 0.0),
            (0.5, 10.0),
            (-0.02, 3.0),
            (1e-3, -8.0),
            (0.0, 0.0),
        ] {
            for most in [50.0, 400.0, 4000.0] {
                let (mut o, mut v) = (offset, speed);
                let mut farthest = 0.0_f64;
                for _ in 0..1000 {
                    let a = fade_acceleration(o, v, period_s, most);
                    assert!(a.abs() <= most);
                    o += period_s * (v + 0.5 * period_s * a);
                    v += period_s * a;
                    farthest = farthest.max(o.abs());
                }
                assert!(is_over([o], [v]), "{offset} {speed} {most}: {o} {v}");
                let coasts = speed * speed / (2.0 * most) + speed.abs() * period_s;
                assert!(
                    farthest <= offset.abs() + 1.5 * coasts + 1e-3,
                    "{offset} {speed} {most}: {farthest}"
                );
            }
        }
    }
}
