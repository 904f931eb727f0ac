//! `feedwright-lab paper`: the experiments of the paper, its figures and `paper.json`.
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use feedwright::command::{Console, make_folder, printed, wrapped};
use feedwright::{CaptionedFigure, OutputFile, OutputFiles};
use feedwright_sim::{Machine, Watch};
use miette::{IntoDiagnostic, Result};

use crate::command::args::paper::PaperArgs;
use crate::paper::departures::{DepartureResult, Draw, departures, draws, quantile};
use crate::paper::figures::figures;
use crate::paper::{self, Numbers, Paper};

pub(crate) fn run(args: &PaperArgs, console: &Console) -> Result<ExitCode> {
    let machine = Machine::load(&args.machine)?;
    make_folder(&args.out)?;
    let seeds: Vec<u64> = (1..=args.seeds).collect();
    let bar = console.bar(0);
    let made = paper::experiment(&machine, &seeds, &bar)
        .and_then(|paper| Ok((paper, figures(&machine, seeds[0], &bar)?)));
    let rows = args
        .as_printed
        .then(|| departures(&machine, &seeds, &bar))
        .transpose();
    let drawn = args
        .draws
        .map(|count| draws(&machine, count, &bar))
        .transpose();
    bar.clear();
    let ((paper, figures), rows, drawn) = (made?, rows?, drawn?);
    write(&args.out, (&paper, &rows, &drawn), &figures, &bar)?;
    let mut printing = print(&args.out, &paper);
    if let Some(rows) = &rows {
        printing = printing.and_then(|()| print_departures(rows));
    }
    if let Some(drawn) = &drawn {
        printing = printing.and_then(|()| print_draws(drawn));
    }
    printed(printing, ExitCode::SUCCESS)
}

/// Prints a table of Markdown.
fn print_departures(rows: &[DepartureResult]) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let head = "| Printed | Taken | Why | uncorrected | two-dimensional, mean | worst |";
    writeln!(out, "\n{head}\n|---|---|---|---|---|---|")?;
    for row in rows {
        let words = [&row.printed, &row.taken, &row.reason].map(|text| text.replace('|', "\\|"));
        let cell = |n: &Numbers| format!("{:.3} s, {:.1} / {:.1}", n.time_s, n.rms_um, n.max_um);
        let cells = [&row.uncorrected, &row.mean, &row.worst]
            .map(cell)
            .join(" | ");
        writeln!(out, "| {} | {cells} |", words.join(" | "))?;
    }
    Ok(())
}

/// A ratio of a draw, by its name.
type Ratio = (&'static str, fn(&Draw) -> f64);

/// Prints a table of Markdown.
fn print_draws(draws: &[Draw]) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let head = format!(
        "| Of {} draws | best | 5 % | 50 % | 95 % | worst |",
        draws.len()
    );
    writeln!(out, "\n{head}\n|---|--:|--:|--:|--:|--:|")?;
    let ratios: [Ratio; 3] = [
        ("RMS ratio", |draw| draw.rms_ratio),
        ("max ratio", |draw| draw.max_ratio),
        ("time ratio", |draw| draw.time_ratio),
    ];
    for (name, of) in ratios {
        let parts = [0.0, 0.05, 0.5, 0.95, 1.0];
        let cells = parts.map(|part| format!("{:.3}", quantile(draws, of, part)));
        writeln!(out, "| {name} | {} |", cells.join(" | "))?;
    }
    Ok(())
}

/// Writes everything, and moves it to its place only when all is written.
fn write(
    folder: &Path,
    (paper, rows, drawn): (&Paper, &Option<Vec<DepartureResult>>, &Option<Vec<Draw>>),
    figures: &[CaptionedFigure],
    watch: &dyn Watch,
) -> Result<()> {
    fn json(value: &impl serde::Serialize) -> Result<String> {
        Ok(serde_json::to_string_pretty(value).into_diagnostic()? + "\n")
    }
    let mut texts = vec![("paper.json".to_owned(), json(paper)?)];
    if let Some(rows) = rows {
        texts.push(("departures.json".to_owned(), json(rows)?));
    }
    if let Some(drawn) = drawn {
        texts.push(("draws.json".to_owned(), json(drawn)?));
    }
    for CaptionedFigure { number, figure, .. } in figures {
        let name = number.to_lowercase().replace(' ', "_") + ".svg";
        texts.push((name, figure.to_svg()));
    }
    let (mut files, mut complete) = (OutputFiles::default(), Vec::new());
    for (name, text) in texts {
        let mut file = files.start(&folder.join(name))?;
        file.write_all(text.as_bytes()).into_diagnostic()?;
        complete.push(file);
    }
    Ok(OutputFile::commit_all(complete, watch)?)
}

fn print(folder: &Path, paper: &Paper) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let [open, magnitude, both] = ["uncorrected", "magnitude only", "two-dimensional"];
    writeln!(out, "{:>4} {open:>24} {magnitude:>24} {both:>24}", "")?;
    let columns = format!("  {:>8} {:>7} {:>7}", "time s", "RMS um", "max um");
    writeln!(out, "{:>4}{}", "seed", columns.repeat(3))?;
    for seed in &paper.seeds {
        write!(out, "{:>4}", seed.seed)?;
        for cut in [seed.uncorrected, seed.magnitude_only, seed.two_dimensional] {
            write!(
                out,
                " {:>8.3} {:>7.2} {:>7.2}",
                cut.time_s, cut.rms_um, cut.max_um
            )?;
        }
        writeln!(out)?;
    }
    let text = format!(
        "worst seed, two-dimensional against magnitude only: RMS x {:.3}, max x {:.3}; time against uncorrected x {:.3}",
        paper.worst_rms_ratio, paper.worst_max_ratio, paper.worst_time_ratio
    );
    writeln!(out, "{}", wrapped(&text, 2))?;
    writeln!(out, "wrote {}", folder.join("paper.json").display())
}
