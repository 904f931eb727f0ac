//! `feedwright cache`: what is kept between runs.

use std::io::Write;
use std::process::ExitCode;
use std::time::SystemTime;

use miette::{Result, miette};

use crate::command::args::CacheArgs;
use crate::command::message::printed;
use crate::store::{MOST_BYTES, user_cache};

const KB: f64 = 1e3;

pub(crate) fn run(args: &CacheArgs) -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    let Some(cache) = user_cache() else {
        let reported = writeln!(
            out,
            "nothing is kept: FEEDWRIGHT_CACHE is empty, or there is no home folder"
        );
        return printed(reported, ExitCode::SUCCESS);
    };
    let shown = cache.folder().display();
    let failed = |error: std::io::Error| {
        miette!(
            help = "name another folder in FEEDWRIGHT_CACHE, or leave it empty to keep nothing",
            "{shown}: the folder of what is kept cannot be used: {error}"
        )
    };
    if args.clear {
        let removed = cache.clear().map_err(failed)?;
        return printed(
            writeln!(out, "removed {} from {shown}", counted(removed)),
            ExitCode::SUCCESS,
        );
    }
    let files = cache.files().map_err(failed)?;
    let bytes: u64 = files.iter().map(|file| file.bytes).sum();
    let [kept_kb, most_kb] = [bytes, MOST_BYTES].map(|bytes| bytes as f64 / KB);
    let models = counted(files.len());
    let mut reported = writeln!(
        out,
        "{shown}\n{models}, {kept_kb:.0} kB of at most {most_kb:.0} kB"
    );
    let now = SystemTime::now();
    let age_days = |used: SystemTime| {
        now.duration_since(used)
            .map_or(0.0, |age| age.as_secs_f64() / 86400.0)
    };
    if let Some(oldest) = files
        .iter()
        .map(|file| age_days(file.used))
        .reduce(f64::max)
    {
        reported =
            reported.and_then(|()| writeln!(out, "the oldest was used {oldest:.1} days ago"));
    }
    printed(reported, ExitCode::SUCCESS)
}

fn counted(models: usize) -> String {
    format!(
        "{models} identified model{}",
        if models == 1 { "" } else { "s" }
    )
}
