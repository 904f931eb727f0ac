//! The page of the experiments: every seed in a table, and the figures.

use std::io::{self, Write};

use feedwright::{
    CaptionedFigure, PagePart, figure_parts, number, write_figure_part, write_foot, write_head, write_table_end,
    write_table_head,
};

use super::{Numbers, Paper};

const TITLE: &str = "Two-dimensional feedrate control";
const INTRODUCTION: &str = "The experiments of S. S. Lee, J. H. Cho and G. J. Jeon, \"Two dimensional feedrate control for \
    high performance CNC machine tools\" (IFAC 2005), section 4: a circle of 10 mm radius at 50 mm/s on a model of the \
    TNV-40, repeated with feedwright. Everything here is simulated.";

/// Writes it.
///
/// # Errors
/// Where `out` takes no more.
pub fn write(out: &mut impl Write, paper: &Paper, figures: &[CaptionedFigure]) -> io::Result<()> {
    let seeds = PagePart::new("seeds", "Every seed");
    let parts: Vec<PagePart> = figure_parts(figures).chain([seeds.clone()]).collect();
    write_head(out, "figures", TITLE, INTRODUCTION, &parts)?;
    for (part, entry) in parts.iter().zip(figures) {
        write_figure_part(out, part, entry)?;
    }
    seeds.begin(out)?;
    write_seeds(out, paper)?;
    PagePart::end(out)?;
    write_foot(out)
}

fn write_seeds(out: &mut impl Write, paper: &Paper) -> io::Result<()> {
    writeln!(
        out,
        "<p>Machining time, RMS and largest contour error of each training. In the worst of them two-dimensional control leaves {:.3} of the \
         RMS and {:.3} of the largest error of control of the magnitude only in the same time, and takes {:.3} of the time of the uncorrected cut.</p>",
        paper.worst_rms_ratio, paper.worst_max_ratio, paper.worst_time_ratio
    )?;
    let cuts = ["uncorrected", "magnitude only", "magnitude only, same ρ", "two-dimensional"];
    let heads = cuts.iter().flat_map(|cut| ["s", "RMS µm", "max µm"].map(|unit| format!("{cut}, {unit}")));
    let heads: Vec<String> = std::iter::once("seed".to_owned()).chain(heads).collect();
    write_table_head(out, heads.iter().map(String::as_str))?;
    for seed in &paper.seeds {
        write!(out, "<tr><td>{}</td>", seed.seed)?;
        let cuts = [seed.uncorrected, seed.magnitude_only, seed.magnitude_only_same_rho, seed.two_dimensional];
        for Numbers { time_s, rms_um, max_um, .. } in cuts {
            write!(out, "<td>{time_s:.3}</td><td>{}</td><td>{}</td>", number(rms_um), number(max_um))?;
        }
        out.write_all(b"</tr>\n")?;
    }
    write_table_end(out)
}
