//! Bounds on the speed along a path, place by place.

/// A bound on the speed over the arc length: straight between values that are evenly apart.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedCaps {
    /// Distance of two values, mm.
    pub spacing_mm: f64,
    /// Bounds at the arc lengths 0, `spacing_mm`, 2 `spacing_mm` and so on, mm/s; infinity means no
    /// bound.
    pub caps_mm_s: Vec<f64>,
}

impl SpeedCaps {
    /// No bound.
    pub const fn none(spacing_mm: f64) -> Self {
        Self {
            spacing_mm,
            caps_mm_s: Vec::new(),
        }
    }

    /// Number of the value at a place or before.
    pub fn index(&self, s_mm: f64) -> usize {
        (s_mm / self.spacing_mm).max(0.0) as usize
    }

    /// The bound at a place, mm/s.
    pub fn at(&self, s_mm: f64) -> f64 {
        let first = self.index(s_mm);
        let value = |i: usize| self.caps_mm_s.get(i).copied().unwrap_or(f64::INFINITY);
        let (from, to) = (value(first), value(first + 1));
        if from.is_finite() && to.is_finite() {
            let part = s_mm / self.spacing_mm - first as f64;
            from + part.clamp(0.0, 1.0) * (to - from)
        } else {
            from.min(to)
        }
    }

    /// The smallest bound from one place to another, mm/s.
    pub fn least(&self, from_mm: f64, to_mm: f64) -> f64 {
        (self.index(from_mm)..=self.index(to_mm) + 1)
            .map(|i| self.caps_mm_s.get(i).copied().unwrap_or(f64::INFINITY))
            .fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_straight_between_values_and_the_lower_one_beside_none() {
        let caps = SpeedCaps {
            spacing_mm: 0.5,
            caps_mm_s: vec![10.0, 20.0, f64::INFINITY, 5.0],
        };
        assert_eq!(
            [0.0, 0.25, 0.5, 0.75, 1.25, 1.5, 9.0].map(|s_mm| caps.at(s_mm)),
            [10.0, 15.0, 20.0, 20.0, 5.0, 5.0, f64::INFINITY]
        );
        assert_eq!(caps.least(0.6, 0.7), 20.0);
        assert_eq!(caps.least(0.0, 3.0), 5.0);
    }
}
