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
use crate::paper::{self, Paper};

pub(crate) fn run(args: &PaperArgs, console: &Console) -> Result<ExitCode> {
    let machine = Machine::load(&args.machine)?;
    make_folder(&args.out)?;
    let seeds: Vec<u64> = (1..=args.seeds).collect();
    let bar = console.bar(0);
    let made = paper::experiment(&machine, &seeds, &bar)
        .and_then(|paper| Ok((paper, figures(&machine, seeds[0], &bar)?)));
    let printed_rows = args
        .as_printed
        .then(|| departures(&machine, &seeds, &bar))
        .transpose();
    let drawn = args
        .draws
        .map(|count| draws(&machine, count, &bar))
        .transpose();
    bar.clear();
    let (paper, figures) = made?;
    let extra = Extra {
        departures: printed_rows?,
        draws: drawn?,
    };
    write(&args.out, &paper, &figures, &extra, &bar)?;
    printed(
        print(&args.out, &paper).and_then(|()| extra.print()),
        ExitCode::SUCCESS,
    )
}

/// Results requested in addition to the experiments.
struct Extra {
    departures: Option<Vec<DepartureResult>>,
    draws: Option<Vec<Draw>>,
}

impl Extra {
    /// Prints both as tables of Markdown.
    fn print(&self) -> std::io::Result<()> {
        let mut out = std::io::stdout().lock();
        if let Some(rows) = &self.departures {
            writeln!(
                out,
                "\n| Printed | Taken | Why | uncorrected | two-dimensional, mean | worst |"
            )?;
            writeln!(out, "|---|---|---|---|---|---|")?;
            let escaped = |text: &str| text.replace('|', "\\|");
            for DepartureResult {
                printed,
                taken,
                reason,
                uncorrected,
                worst,
                mean,
            } in rows
            {
                let [printed, taken, reason] = [printed, taken, reason].map(|text| escaped(text));
                let cell = |n: &paper::Numbers| {
                    format!("{:.3} s, {:.1} / {:.1}", n.time_s, n.rms_um, n.max_um)
                };
                let cells = [uncorrected, mean, worst].map(cell).join(" | ");
                writeln!(out, "| {printed} | {taken} | {reason} | {cells} |")?;
            }
        }
        if let Some(draws) = &self.draws {
            writeln!(
                out,
                "\n| Of {} draws | best | 5 % | 50 % | 95 % | worst |\n|---|--:|--:|--:|--:|--:|",
                draws.len()
            )?;
            let row = |out: &mut std::io::StdoutLock<'_>, name: &str, of: fn(&Draw) -> f64| {
                let cells = [0.0, 0.05, 0.5, 0.95, 1.0]
                    .map(|part| format!("{:.3}", quantile(draws, of, part)));
                writeln!(out, "| {name} | {} |", cells.join(" | "))
            };
            row(&mut out, "RMS ratio", |draw| draw.rms_ratio)?;
            row(&mut out, "max ratio", |draw| draw.max_ratio)?;
            row(&mut out, "time ratio", |draw| draw.time_ratio)?;
        }
        Ok(())
    }
}

/// Writes everything, and moves it to its place only when all is written.
fn write(
    folder: &Path,
    paper: &Paper,
    figures: &[CaptionedFigure],
    extra: &Extra,
    watch: &dyn Watch,
) -> Result<()> {
    let (mut files, mut complete) = (OutputFiles::default(), Vec::new());
    let mut start =
        |name: &str, write: &dyn Fn(&mut OutputFile) -> std::io::Result<()>| -> Result<()> {
            let mut file = files.start(&folder.join(name))?;
            write(&mut file).into_diagnostic()?;
            complete.push(file);
            Ok(())
        };
    fn json(file: &mut OutputFile, value: &impl serde::Serialize) -> std::io::Result<()> {
        serde_json::to_writer_pretty(&mut *file, value)?;
        file.write_all(b"\n")
    }
    start("paper.json", &|file| json(file, paper))?;
    if let Some(rows) = &extra.departures {
        start("departures.json", &|file| json(file, rows))?;
    }
    if let Some(draws) = &extra.draws {
        start("draws.json", &|file| json(file, draws))?;
    }
    for figure in figures {
        let name = figure.number.to_lowercase().replace(' ', "_") + ".svg";
        start(&name, &|file| {
            file.write_all(figure.figure.to_svg().as_bytes())
        })?;
    }
    OutputFile::commit_all(complete, watch)?;
    Ok(())
}

fn print(folder: &Path, paper: &Paper) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "{:>4} {:>24} {:>24} {:>24}",
        "", "uncorrected", "magnitude only", "two-dimensional"
    )?;
    writeln!(
        out,
        "{:>4}{}",
        "seed",
        format!("  {:>8} {:>7} {:>7}", "time s", "RMS um", "max um").repeat(3)
    )?;
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
