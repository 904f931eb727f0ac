//! Range and ticks of an axis.

/// Returns the range of the data, with `margin` times its span left free at either end. `values`
/// that are not finite do not count.
pub(super) fn range(values: impl Iterator<Item = f64>, margin: f64) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for v in values.filter(|v| v.is_finite()) {
        low = low.min(v);
        high = high.max(v);
    }
    if low > high {
        return [0.0, 1.0];
    }
    // Data that is constant except for rounding is drawn in the middle of a range of a tenth of its
    // size: its ticks are then short numbers.
    let size = low.abs().max(high.abs());
    if high - low <= 1e-6 * size {
        let (middle, half) = (
            0.5 * (low + high),
            if size > 0.0 { 0.05 * size } else { 0.5 },
        );
        return [middle - half, middle + half];
    }
    let span = high - low;
    [low - margin * span, high + margin * span]
}

/// Returns ticks at multiples of 1, 2 or 5 times a power of ten, about `wanted` of them, with their
/// texts.
pub(super) fn ticks([low, high]: [f64; 2], wanted: f64) -> Vec<(f64, String)> {
    let raw = (high - low) / wanted.max(1.0);
    let power = libm::pow(10f64, libm::log10(raw).floor());
    let step = match raw / power {
        x if x < 1.5 => power,
        x if x < 3.5 => 2.0 * power,
        x if x < 7.5 => 5.0 * power,
        _ => 10.0 * power,
    };
    let decimals = (-(libm::log10(step) + 1e-9).floor()).clamp(0.0, 12.0) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last)
        .map(|k| {
            let value = k as f64 * step;
            (value, crate::report::text::fixed(value, decimals))
        })
        .collect()
}

/// Returns ticks of a logarithmic axis whose range is in powers of ten: at 1, 2 and 5 times each
/// power, or at the powers alone if that is too many.
pub(super) fn ticks_of_powers([low, high]: [f64; 2], wanted: f64) -> Vec<(f64, String)> {
    let powers = (low.floor() as i32)..=(high.ceil() as i32);
    let at = |digits: &[f64]| -> Vec<(f64, String)> {
        let numbers = powers
            .clone()
            .flat_map(|power| digits.iter().map(move |digit| (*digit, power)));
        numbers
            .map(|(digit, power)| {
                (
                    f64::from(power) + libm::log10(digit),
                    digit * 10f64.powi(power),
                    power,
                )
            })
            .filter(|(place, ..)| (low - 1e-9..=high + 1e-9).contains(place))
            .map(|(place, number, power)| {
                (
                    place,
                    crate::report::text::fixed(number, usize::try_from(-power).unwrap_or(0)),
                )
            })
            .collect()
    };
    let all = at(&[1.0, 2.0, 5.0]);
    if all.len() as f64 <= 2.0 * wanted {
        all
    } else {
        at(&[1.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let texts = |r, n| ticks(r, n).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(
            texts([-20.0, 31.0], 5.0),
            ["−20", "−10", "0", "10", "20", "30"]
        );
        assert_eq!(texts([0.0, 1.76], 4.0), ["0.0", "0.5", "1.0", "1.5"]);
        assert_eq!(texts([0.0, 0.001], 2.0), ["0.0000", "0.0005", "0.0010"]);
    }

    #[test]
    fn a_constant_has_short_labels() {
        let values = [3_000.0, 3_000.000_000_1, 2_999.999_999_9];
        let shown = range(values.into_iter(), 0.04);
        assert!(shown[0] < 2900.0 && shown[1] > 3100.0, "{shown:?}");
        assert!(
            ticks(shown, 5.0).iter().all(|tick| tick.1.len() <= 4),
            "{:?}",
            ticks(shown, 5.0)
        );
        assert_eq!(range([0.0, 0.0].into_iter(), 0.04), [-0.5, 0.5]);
        assert_eq!(range([0.0, 1e-12].into_iter(), 0.0), [0.0, 1e-12]);
    }

    #[test]
    fn ticks_of_powers_are_numbers() {
        let texts = |r, n| {
            ticks_of_powers(r, n)
                .into_iter()
                .map(|t| t.1)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            texts([-2.0, 0.5], 5.0),
            ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"]
        );
        assert_eq!(texts([-1.5, 3.0], 4.0), ["0.1", "1", "10", "100", "1000"]);
        let places = ticks_of_powers([0.0, 0.4], 5.0)
            .into_iter()
            .map(|t| t.0)
            .collect::<Vec<_>>();
        assert_eq!(places, [0.0, libm::log10(2f64)]);
    }
}
