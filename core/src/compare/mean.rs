//! What several numbers come to: over noise seeds, and over workpieces.

/// Quadratic mean; not a number of nothing.
pub fn quadratic_mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    f64::sqrt(sum / count)
}

/// The median, lowest and highest; of an even number the mean of the middle two.
pub(super) fn median_and_spread(values: impl IntoIterator<Item = f64>) -> (f64, [f64; 2]) {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let (Some(&low), Some(&high)) = (values.first(), values.last()) else { return (f64::NAN, [f64::NAN; 2]) };
    let middle = values.len() / 2;
    let median =
        if values.len().is_multiple_of(2) { 0.5 * (values[middle - 1] + values[middle]) } else { values[middle] };
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
    fn the_quadratic_mean_is_that_of_the_definition() {
        assert_eq!(quadratic_mean([3.0, 4.0, 0.0, 0.0]), 2.5);
        assert!(quadratic_mean([]).is_nan());
    }
}
