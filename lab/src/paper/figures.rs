//! Figures 7 to 10 of Lee, Cho and Jeon (2005), from cuts of the circle with the identifier of one
//! seed.

use feedwright::{COLORS, CaptionedFigure, Figure, LineStyle, Panel, Polyline};
use feedwright_control::{Controller, Gradient, InvertingSettings, TwoDimensional, Uncorrected};
use feedwright_sim::{Machine, RunError, Watch};

use super::curves::Curves;
use super::{Bench, Numbers, RADIUS_MM, magnitude_only, with_gradient, with_rho};

/// The weights of Fig. 7: from none to the paper's choice.
const RHO_OF_FIGURE_7: [f64; 4] = [0.0, 0.0001, 0.001, 0.01];
/// Enlargement of the deviation in Fig. 10. At the paper's 500 a deviation of 25 um is drawn longer
/// than the radius of the circle, and the tool's path turns inside out.
const ENLARGEMENT: f64 = 50.0;

/// A cut and what it came to.
struct Drawn {
    curves: Curves,
    numbers: Numbers,
}

/// All four figures, in order.
///
/// # Errors
/// As [`experiment`](super::experiment).
pub(crate) fn figures(
    machine: &Machine,
    seed: u64,
    watch: &dyn Watch,
) -> Result<Vec<CaptionedFigure>, RunError> {
    watch.begin("drawing", 1);
    let bench = Bench { machine, watch };
    let net = bench.train(seed).net;
    let settings = InvertingSettings::DEFAULT;
    let rho = settings.inversion.rho;
    let draw = |controller: &mut dyn Controller<2>, rho: f64| {
        let mut curves = Curves::default();
        let numbers = bench.cut(controller, &mut [&mut curves], rho)?;
        Ok::<_, RunError>(Drawn { curves, numbers })
    };
    let open = draw(&mut Uncorrected, 0.0)?;
    let both = draw(&mut TwoDimensional::untried(net.clone(), settings), rho)?;
    let same_time = bench.rho_for_time(&net, both.numbers.time_s)?;
    let magnitude = draw(&mut magnitude_only(&net, same_time), same_time)?;
    let magnitude_same_rho = draw(&mut magnitude_only(&net, rho), rho)?;
    let alone = |&rho: &f64| {
        let settings = with_gradient(with_rho(settings, rho), Gradient::Absent);
        draw(&mut TwoDimensional::untried(net.clone(), settings), rho)
    };
    let time_only: Result<Vec<Drawn>, RunError> = RHO_OF_FIGURE_7.iter().map(alone).collect();
    Ok(vec![
        figure_7(&magnitude, &time_only?),
        figure_8(&open, &magnitude, &magnitude_same_rho, &both),
        figure_9(&open, &magnitude, &both),
        figure_10(&open, &magnitude, &both),
    ])
}

fn figure_7(magnitude: &Drawn, time_only: &[Drawn]) -> CaptionedFigure {
    let mut curves = vec![error("magnitude only", magnitude, 0, LineStyle::Dashed)];
    for (i, drawn) in time_only.iter().enumerate() {
        let label = format!("ρ = {}", drawn.numbers.rho.unwrap_or_default());
        curves.push(error(&label, drawn, i + 1, LineStyle::Solid));
    }
    let of =
        |Drawn { numbers: it, .. }: &Drawn| format!("{:.2} s and {:.1} µm", it.time_s, it.max_um);
    let times: Vec<String> = time_only.iter().map(of).collect();
    captioned(
        "Figure 7",
        &format!(
            "Contour error for several weights of the machining time, with the first term of eq. 7 set to zero: a larger \
             ρ is faster and less accurate ({}). The term has the sign of the derivative of eq. 7; as printed in \
             eqs 9 and 10 a larger ρ would be slower.",
            times.join(", ")
        ),
        vec![error_panel("", curves)],
    )
}

fn figure_8(open: &Drawn, magnitude: &Drawn, same_rho: &Drawn, both: &Drawn) -> CaptionedFigure {
    let curves = |magnitude: &Drawn| {
        vec![
            error("uncorrected", open, 3, LineStyle::Dotted),
            error("magnitude only", magnitude, 1, LineStyle::Dashed),
            error("two-dimensional", both, 2, LineStyle::Solid),
        ]
    };
    let (of, than) = (both.numbers, magnitude.numbers);
    let (at, time) = (than.rho.unwrap_or_default(), than.time_s);
    captioned(
        "Figure 8",
        &format!(
            "Contour error of both methods. (a) In the same machining time, {time:.3} s (magnitude only at rho = {at:.5}): \
             RMS {:.2} against {:.2} µm, max {:.1} against {:.1} µm. (b) At the same rho.",
            of.rms_um, than.rms_um, of.max_um, than.max_um
        ),
        vec![
            error_panel("(a) same machining time", curves(magnitude)),
            error_panel("(b) same rho", curves(same_rho)),
        ],
    )
}

fn figure_9(open: &Drawn, magnitude: &Drawn, both: &Drawn) -> CaptionedFigure {
    let feed = |label: &str, drawn: &Drawn, color: usize, line: LineStyle| {
        curve(label, drawn.curves.feed.clone(), color, line)
    };
    let curves = vec![
        feed("uncorrected", open, 3, LineStyle::Dotted),
        feed("magnitude only", magnitude, 1, LineStyle::Dashed),
        feed("two-dimensional", both, 2, LineStyle::Solid),
    ];
    captioned(
        "Figure 9",
        "Magnitude of the commanded feedrate. The magnitudes are much the same; what differs is the direction.",
        vec![panel("", "Time [s]", "Feedrate [mm/s]", curves)],
    )
}

fn figure_10(open: &Drawn, magnitude: &Drawn, both: &Drawn) -> CaptionedFigure {
    let view = |title: &str, Drawn { curves: of, .. }: &Drawn| {
        let path = open.curves.path.clone();
        let curves = vec![
            curve("programmed path", path, 0, LineStyle::Thin),
            curve("command", enlarged(&of.command), 2, LineStyle::Solid),
            curve("tool", enlarged(&of.tool), 1, LineStyle::Dashed),
        ];
        Panel {
            equal_axes: true,
            ..panel(title, "X [mm]", "Y [mm]", curves)
        }
    };
    let views = vec![
        view("(a) magnitude only", magnitude),
        view("(b) two-dimensional", both),
    ];
    let mut captioned = captioned(
        "Figure 10",
        &format!(
            "Desired trajectories on the x-y plane (deviation {ENLARGEMENT} times enlarged): the command of the two-dimensional method leaves \
             the programmed path so that the tool does not."
        ),
        views,
    );
    (captioned.figure.columns, captioned.figure.aspect) = (2, 1.0);
    captioned
}

/// Radial deviation from the circle, enlarged.
fn enlarged(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let enlarge = |&[x, y]: &[f64; 2]| {
        let (dx, dy) = (x - RADIUS_MM, y);
        let radius = libm::hypot(dx, dy);
        let drawn = RADIUS_MM + ENLARGEMENT * (radius - RADIUS_MM);
        [RADIUS_MM + dx / radius * drawn, dy / radius * drawn]
    };
    points.iter().map(enlarge).collect()
}

fn error_panel(title: &str, curves: Vec<Polyline>) -> Panel {
    panel(title, "Time [s]", "Contour error [µm]", curves)
}

fn error(label: &str, drawn: &Drawn, color: usize, line: LineStyle) -> Polyline {
    curve(label, drawn.curves.error.clone(), color, line)
}

fn curve(label: &str, points: Vec<[f64; 2]>, color: usize, line: LineStyle) -> Polyline {
    Polyline {
        label: label.to_owned(),
        points,
        line,
        color: COLORS[color % COLORS.len()].to_owned(),
    }
}

fn panel(title: &str, x_title: &str, y_title: &str, curves: Vec<Polyline>) -> Panel {
    Panel {
        title: title.to_owned(),
        x_title: x_title.to_owned(),
        y_title: y_title.to_owned(),
        curves,
        ..Panel::default()
    }
}

fn captioned(number: &str, caption: &str, panels: Vec<Panel>) -> CaptionedFigure {
    CaptionedFigure {
        figure: Figure {
            panels,
            ..Figure::default()
        },
        number: number.to_owned(),
        caption: caption.to_owned(),
    }
}
