//! The band of a prediction: the errors of several machines that fit the same recording.

use serde::Serialize;

use super::text::number;

/// Share of the machines that stay within the upper end of the band.
const SHARE: f64 = 0.9;

/// Errors of machines that fit the recording of a model, each cut with the controller of that
/// model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Band {
    /// Machines that were cut.
    pub machines: usize,
    /// Machines whose servo loop is unstable: their errors are not in the band.
    pub diverged: usize,
    /// Length of the beginning of the cut that the band covers, s; `None` if it covers the whole
    /// cut.
    pub first_s: Option<f64>,
    /// RMS contour error, um.
    pub rms_um: BandErrors,
    /// Largest contour error, um.
    pub max_um: BandErrors,
    /// RMS contour error at the encoders, um, if the machine has geometry errors that the encoders
    /// do not measure and all was cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_rms_um: Option<BandErrors>,
    /// Largest contour error at the encoders, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) joint_max_um: Option<BandErrors>,
}

/// One error over the machines of a band, um.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BandErrors {
    /// The median.
    pub median: f64,
    /// The value that a further machine exceeds with a probability of one in ten: of n machines,
    /// the value of rank 0.9 (n + 1), or the largest if there are fewer than nine.
    pub p90: f64,
}

impl BandErrors {
    /// Computes the band of errors in any order; `None` if there are no errors.
    pub(crate) fn of(mut errors_um: Vec<f64>) -> Option<Self> {
        errors_um.sort_by(f64::total_cmp);
        let n = errors_um.len();
        let rank = (SHARE * (n + 1) as f64).ceil() as usize;
        let p90 = *errors_um.get(rank.min(n).checked_sub(1)?)?;
        let median = 0.5 * (errors_um.get((n - 1) / 2)? + errors_um.get(n / 2)?);
        Some(Self { median, p90 })
    }
}

impl Band {
    /// Describes the band in one sentence.
    pub fn sentence(&self) -> String {
        let Self {
            machines,
            diverged,
            first_s,
            rms_um,
            max_um,
            joint_rms_um,
            joint_max_um,
        } = self;
        let both = |rms: &BandErrors, max: &BandErrors| {
            format!(
                "RMS {} um in the median and {} um at 90 %, largest error {} and {} um",
                number(rms.median),
                number(rms.p90),
                number(max.median),
                number(max.p90)
            )
        };
        let beginning = first_s.map_or_else(String::new, |first_s| {
            format!(", the first {first_s:.0} s of the cut")
        });
        let joints = joint_rms_um.as_ref().zip(joint_max_um.as_ref());
        let tool = both(rms_um, max_um);
        let joints = joints
            .map(|(rms, max)| both(rms, max))
            .filter(|joints| *joints != tool);
        let joints =
            joints.map_or_else(String::new, |joints| format!("; by the encoders: {joints}"));
        let lost = if *diverged == 0 {
            String::new()
        } else {
            format!("; {diverged} more fit the recording, and their servo loops are unstable")
        };
        format!(
            "band of {machines} machines that fit the recording as well{beginning}: {}{joints}{lost}",
            both(rms_um, max_um)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_says_what_the_encoders_see_and_which_loops_are_unstable_where_there_is_something_to_say()
     {
        let [small, large] = [1.0, 4.0].map(|median| BandErrors {
            median,
            p90: 2.0 * median,
        });
        let band = Band {
            machines: 9,
            diverged: 0,
            first_s: None,
            rms_um: small,
            max_um: large,
            joint_rms_um: Some(small),
            joint_max_um: Some(large),
        };
        let tool = "RMS 1.00 um in the median and 2.00 um at 90 %, largest error 4.00 and 8.00 um";
        assert_eq!(
            band.sentence(),
            format!("band of 9 machines that fit the recording as well: {tool}")
        );
        let all = Band {
            diverged: 2,
            first_s: Some(5.0),
            joint_rms_um: Some(large),
            ..band
        };
        assert_eq!(
            all.sentence(),
            format!(
                "band of 9 machines that fit the recording as well, the first 5 s of the cut: {tool}; by the encoders: \
                 RMS 4.00 um in the median and 8.00 um at 90 %, largest error 4.00 and 8.00 um; 2 more fit the recording, and their \
                 servo loops are unstable"
            )
        );
    }

    #[test]
    fn one_in_ten_is_beyond_the_band_where_there_are_nine_machines_and_more() {
        let of = |n: usize| BandErrors::of((1..=n).rev().map(|error| error as f64).collect());
        assert_eq!(of(0), None);
        assert_eq!(
            of(1),
            Some(BandErrors {
                median: 1.0,
                p90: 1.0
            })
        );
        assert_eq!(
            of(8),
            Some(BandErrors {
                median: 4.5,
                p90: 8.0
            })
        );
        assert_eq!(
            of(9),
            Some(BandErrors {
                median: 5.0,
                p90: 9.0
            })
        );
        assert_eq!(
            of(19),
            Some(BandErrors {
                median: 10.0,
                p90: 18.0
            })
        );
    }
}
