//! What several numbers come to.

/// Quadratic mean; not a number of nothing.
pub fn quadratic_mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), value| {
        (sum + value * value, count + 1.0)
    });
    f64::sqrt(sum / count)
}

/// The same; zero of nothing.
pub(crate) fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values = values.into_iter().peekable();
    if values.peek().is_some() {
        quadratic_mean(values)
    } else {
        0.0
    }
}

/// The one in the middle, of an even number the higher of the two; zero of nothing. Reorders the
/// values.
pub(crate) fn middle_of(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The median, lowest and highest; of an even number the mean of the middle two.
pub fn median_and_spread(values: impl IntoIterator<Item = f64>) -> (f64, [f64; 2]) {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let (Some(&low), Some(&high)) = (values.first(), values.last()) else {
        return (f64::NAN, [f64::NAN; 2]);
    };
    let middle = values.len() / 2;
    let median = if values.len().is_multiple_of(2) {
        0.5 * (values[middle - 1] + values[middle])
    } else {
        values[middle]
    };
    (median, [low, high])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_is_the_mean_of_the_middle_two() {
        assert_eq!(median_and_spread([3.0, 1.0, 2.0]), (2.0, [1.0, 3.0]));
        assert_eq!(median_and_spread([4.0, 1.0, 2.0, 3.0]), (2.5, [1.0, 4.0]));
        assert_eq!(median_and_spread([7.0]), (7.0, [7.0, 7.0]));
    }

    #[test]
    fn the_quadratic_mean_follows_its_definition() {
        assert_eq!(quadratic_mean([3.0, 4.0, 0.0, 0.0]), 2.5);
        assert!(quadratic_mean([]).is_nan());
        assert_eq!((rms([3.0, 4.0, 0.0, 0.0]), rms([])), (2.5, 0.0));
    }

    #[test]
    fn the_one_in_the_middle_is_one_of_them() {
        assert_eq!(middle_of(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(middle_of(&mut [4.0, 1.0, 2.0, 3.0]), 3.0);
        assert_eq!(middle_of(&mut []), 0.0);
    }
}
