//! A workpiece on a machine: its table, and the errors side by side.

use std::io::{self, Write};

use feedwright::{
    BASELINE, BEST, COLORS, Figure, Knows, PagePart, Panel, Polyline, escaped, number, write_table_end,
    write_table_head,
};

use super::ours;
use crate::compare::competitor::Knowledge;
use crate::compare::table::{ComparisonRow, knows};

/// A ratio that is coloured: further from 1 than this.
const NOTABLE: f64 = 0.02;

/// Its heading, and what the uncorrected cut and the default come to there; `machines` is how many there are in the comparison.
pub(super) fn part(index: usize, rows: &[ComparisonRow], folded: bool, machines: usize) -> PagePart {
    let rms =
        |name: &str| rows.iter().find(|row| row.controller == name).map(|row| format!("{name} {}", number(row.rms_um)));
    let both: Vec<String> = [BASELINE, BEST].into_iter().filter_map(rms).collect();
    let (contour, machine) = (&rows[0].contour, &rows[0].machine);
    let (group, short) = if machines > 1 { (contour.clone(), machine) } else { (String::new(), contour) };
    PagePart {
        note: if both.is_empty() { String::new() } else { format!("{} µm RMS", both.join(", ")) },
        folded,
        group,
        short: Some(short.clone()),
        ..PagePart::new(&format!("cell-{index}"), format!("{contour} on {machine}"))
    }
}

/// Its table and its figure.
pub(super) fn write(out: &mut impl Write, rows: &[ComparisonRow]) -> io::Result<()> {
    let has_joints = rows.iter().any(|row| row.joint_rms_um.is_some());
    let measured = ["controller", "time, s", "RMS, µm", "max, µm"];
    let joints: &[&str] = if has_joints { &["RMS by encoders, µm", "max by encoders, µm"] } else { &[] };
    let ratios = ["uncut, µm", "time ratio", "RMS ratio", "max ratio"];
    let command = ["command off, µm", "command, m/s²", "torque, N m", ""];
    write_table_head(out, measured.into_iter().chain(joints.iter().copied()).chain(ratios).chain(command))?;
    rows.iter().try_for_each(|row| write_row(out, row, has_joints))?;
    write_table_end(out)?;
    let caption = "Contour error over the cut, each controller on a scale of its own.";
    writeln!(out, "<figure>{}<figcaption>{caption}</figcaption></figure>", errors(rows).to_html())
}

fn write_row(out: &mut impl Write, row: &ComparisonRow, has_joints: bool) -> io::Result<()> {
    write!(out, "<tr{}><td>{}</td><td>{:.3}</td>", ours(&row.controller), escaped(&row.controller), row.time_s)?;
    for (um, spread_um) in [(row.rms_um, row.rms_spread_um), (row.max_um, row.max_spread_um)] {
        write!(out, "<td>{}{}</td>", number(um), spread(row, spread_um))?;
    }
    if has_joints {
        let [rms, max] = [row.joint_rms_um, row.joint_max_um].map(|um| um.map_or(String::new(), number));
        write!(out, "<td>{rms}</td><td>{max}</td>")?;
    }
    write!(out, "<td>{}</td>", number(row.uncut_um))?;
    for ratio in [row.time_ratio, row.rms_ratio, row.max_ratio] {
        let class = if ratio < 1.0 - NOTABLE {
            " class=\"better\""
        } else if ratio > 1.0 + NOTABLE {
            " class=\"worse\""
        } else {
            ""
        };
        write!(out, "<td{class}>{ratio:.3}</td>")?;
    }
    let command = [row.max_deviation_um, row.accel_mm_s2 * 1e-3, row.peak_torque_nm].map(number).join("</td><td>");
    writeln!(out, "<td>{command}</td><td class=\"note\">{}</td></tr>", escaped(&row.note().unwrap_or_default()))
}

/// The lowest and the highest of all noise seeds, where there are several.
fn spread(row: &ComparisonRow, [low, high]: [f64; 2]) -> String {
    if row.seeds > 1 { format!("<small>{} to {}</small>", number(low), number(high)) } else { String::new() }
}

/// A range from minus to plus one, two or five times a power of ten: its ends have ticks.
fn rounded_up(most: f64) -> [f64; 2] {
    let power = libm::pow(10_f64, libm::log10(most).floor());
    let end = [1.0, 2.0, 5.0, 10.0].map(|lead| lead * power).into_iter().find(|&end| end >= most).unwrap_or(most);
    [-end, end]
}

/// Error over the cut: uncorrected, the best peer that knows no model, and the default, each on its own scale.
fn errors(rows: &[ComparisonRow]) -> Figure {
    let peers = rows.iter().filter(|row| {
        let blind = matches!(knows(row), Some(Knows::Nothing | Knows::Identified));
        let own = !row.controller.ends_with(Knowledge::Unseen.suffix());
        blind && own && row.completed && row.controller != BASELINE && !row.controller.starts_with(BEST)
    });
    let peer = peers.min_by(|a, b| a.rms_um.total_cmp(&b.rms_um));
    let named = |name: &str| rows.iter().find(|row| row.controller == name);
    let shown: Vec<&ComparisonRow> = [named(BASELINE), peer, named(BEST)].into_iter().flatten().collect();
    let panel = |(row, color): (&&ComparisonRow, &str)| {
        let step = 1.0 / row.error_um.len().max(1) as f64;
        let points = row.error_um.iter().enumerate().map(|(i, &e)| [i as f64 * step * row.time_s, f64::from(e)]);
        Panel {
            title: row.controller.clone(),
            x_title: "Time [s]".to_owned(),
            y_title: "Contour error [µm]".to_owned(),
            curves: vec![Polyline { points: points.collect(), color: color.to_owned(), ..Polyline::default() }],
            y_range: Some(row.max_spread_um[1]).filter(|&most| row.completed && most > 0.0).map(rounded_up),
            ..Panel::default()
        }
    };
    Figure { panels: shown.iter().zip(COLORS).map(panel).collect(), columns: 3, aspect: 0.7 }
}
