//! `feedwright-lab paper`: the experiments of the paper, its figures and `paper.json`.
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use feedwright::command::{Console, make_folder, printed, wrapped};
use feedwright::{CaptionedFigure, OutputFile, OutputFiles};
use feedwright_sim::{Machine, Watch};
use miette::{IntoDiagnostic, Result};

use crate::command::args::paper::PaperArgs;
use crate::paper::figures::figures;
use crate::paper::{self, Paper, page};

pub(crate) fn run(args: &PaperArgs, console: &Console) -> Result<ExitCode> {
    let machine = Machine::load(&args.machine)?;
    make_folder(&args.out)?;
    let seeds: Vec<u64> = (1..=args.seeds).collect();
    let bar = console.bar(0);
    let made =
        paper::experiment(&machine, &seeds, &bar).and_then(|paper| Ok((paper, figures(&machine, seeds[0], &bar)?)));
    bar.clear();
    let (paper, figures) = made?;
    write(&args.out, &paper, &figures, &bar)?;
    printed(print(&args.out, &paper), ExitCode::SUCCESS)
}

/// Writes everything, and moves it to its place only when all is written.
fn write(folder: &Path, paper: &Paper, figures: &[CaptionedFigure], watch: &dyn Watch) -> Result<()> {
    let (mut files, mut complete) = (OutputFiles::default(), Vec::new());
    let mut start = |name: &str, write: &dyn Fn(&mut OutputFile) -> std::io::Result<()>| -> Result<()> {
        let mut file = files.start(&folder.join(name))?;
        write(&mut file).into_diagnostic()?;
        complete.push(file);
        Ok(())
    };
    start("paper.json", &|file| {
        serde_json::to_writer_pretty(&mut *file, paper)?;
        file.write_all(b"\n")
    })?;
    for figure in figures {
        let name = figure.number.to_lowercase().replace(' ', "_") + ".svg";
        start(&name, &|file| file.write_all(figure.figure.to_svg().as_bytes()))?;
    }
    start("paper.html", &|file| page::write(file, paper, figures))?;
    OutputFile::commit_all(complete, watch)?;
    Ok(())
}

fn print(folder: &Path, paper: &Paper) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{:>4} {:>24} {:>24} {:>24}", "", "uncorrected", "magnitude only", "two-dimensional")?;
    writeln!(out, "{:>4}{}", "seed", format!("  {:>8} {:>7} {:>7}", "time s", "RMS um", "max um").repeat(3))?;
    for seed in &paper.seeds {
        write!(out, "{:>4}", seed.seed)?;
        for cut in [seed.uncorrected, seed.magnitude_only, seed.two_dimensional] {
            write!(out, " {:>8.3} {:>7.2} {:>7.2}", cut.time_s, cut.rms_um, cut.max_um)?;
        }
        writeln!(out)?;
    }
    let text = format!(
        "worst seed, two-dimensional against magnitude only: RMS x {:.3}, max x {:.3}; time against uncorrected x {:.3}",
        paper.worst_rms_ratio, paper.worst_max_ratio, paper.worst_time_ratio
    );
    writeln!(out, "{}", wrapped(&text, 2))?;
    writeln!(out, "wrote {}", folder.join("paper.html").display())
}
