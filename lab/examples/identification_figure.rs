//! `identification_figure LOG FIT SCORE SHOWN FILE.svg`: the first axis of a log, as measured and
//! as predicted by its identified model and by a linear model.
//!
//! Times are written FROM:TO, s: the times that are fitted, the times that are scored, and the part
//! of the latter that the figure shows.

use std::ops::Range;
use std::path::Path;

use feedwright::{LogJob, following_figure};
use feedwright_ident::{Columns, Log};

type Failure = Box<dyn std::error::Error>;

fn times(text: &str) -> Result<Range<f64>, Failure> {
    let (from, to) = text.split_once(':').ok_or("write times as FROM:TO, s")?;
    Ok(from.parse()?..to.parse()?)
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [log, fit, score, shown, out] = &arguments[..] else {
        return Err("LOG FIT SCORE SHOWN FILE.svg are needed".into());
    };
    let job = LogJob {
        times_s: Some([times(fit)?, times(score)?]),
        ..LogJob::default()
    };
    let found = job.run(Log::read(Path::new(log), &Columns::default())?, &())?;
    std::fs::write(out, following_figure(&found, 0, times(shown)?).to_svg())?;
    Ok(())
}
