//! The advised feedrates hold the tolerance, each way of cutting for itself, and are reported with
//! the conditions of the cut.

use feedwright::{
    Advice, AdviseJob, CONTROLLERS, CorrectJob, CutWay, ErrorPlace, JobError, PageUnits, TARGETS,
};
use feedwright_gcode::Program;
use feedwright_sim::Machine;

fn advice(text: &str, tolerance_um: f64) -> Result<Advice, JobError> {
    job(text, tolerance_um).run(&())
}

fn job(text: &str, tolerance_um: f64) -> AdviseJob {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let mut job = AdviseJob::new(
        Program::from_text("part.ngc", text),
        machine,
        &TARGETS[0],
        tolerance_um,
    );
    job.file_error = CorrectJob::usual_file_error(false);
    job
}

/// Tolerance that the advised feedrates must hold, um.
const TOLERANCE_UM: f64 = 10.0;
/// Decimals of a corrected program: an error moves by no more than the rounding of both
/// coordinates.
const ROUNDED_UM: f64 = 1.0;
/// Two circles from rest to rest, the smaller of which asks for a lower feedrate.
const CIRCLES: &str = "G21 G90 G64\nG2 X0 Y0 I2 J0 F1800\nG4 P0.2\nG2 X0 Y0 I6 J0\nM2\n";

#[test]
fn what_is_advised_holds_and_the_page_says_so() {
    let advice = advice(CIRCLES, TOLERANCE_UM).unwrap();
    assert_eq!(advice.ways.len(), 3);
    for way in &advice.ways {
        let whole = way.whole.unwrap_or_else(|| panic!("{way:?}"));
        let each = way.by_stretch.unwrap_or_else(|| panic!("{way:?}"));
        assert!(
            whole.max_um <= TOLERANCE_UM && each.max_um <= TOLERANCE_UM,
            "{way:?}"
        );
        assert!(each.time_s < 1.02 * whole.time_s, "{way:?}");
        assert!(way.cuts.is_sorted_by(|a, b| a.factor < b.factor), "{way:?}");
    }
    let factor = |way: CutWay| {
        advice
            .ways
            .iter()
            .find(|found| found.way == way)
            .unwrap()
            .whole
            .unwrap()
            .factor
            .unwrap()
    };
    assert!(
        factor(CutWay::Uncorrected) < 1.0 && factor(CutWay::Corrected) >= 1.0,
        "{:?}",
        advice.ways
    );
    let time = |way: usize| advice.ways[way].whole.unwrap().time_s;
    assert!(
        time(0) > 1.2 * time(1) && time(0) > 1.2 * time(2),
        "{:?}",
        advice.ways
    );
    let [small, large] = [0, 1].map(|k: usize| &advice.stretches[k]);
    assert_eq!((small.lines, large.lines), ([2, 2], [4, 4]));
    assert!(
        small.holds_mm_s[0].unwrap() < 0.9 * large.holds_mm_s[0].unwrap(),
        "{:?}",
        advice.stretches
    );
    let page = |units: PageUnits| {
        let mut page = Vec::new();
        advice
            .write_page(&mut page, "part <1>.ngc", "tnv40", units)
            .unwrap();
        String::from_utf8(page).unwrap()
    };
    let (page, inches) = (page(PageUnits::Metric), page(PageUnits::Inch));
    assert!(
        page.contains("part &lt;1&gt;.ngc")
            && page.contains("Simulated.")
            && page.ends_with("</html>\n"),
        "{page}"
    );
    // The programmed feedrate of both circles, 1800 mm/min.
    assert!(
        page.contains("<td>1800</td>") && inches.contains("<td>70.9</td>"),
        "{page}\n{inches}"
    );
    assert!(inches.contains("stays within 0.394 thou: of"), "{inches}");
    for metric in ["µm", " mm/min", "[mm"] {
        assert!(!inches.contains(metric), "{metric}: {inches}");
    }
    assert!(
        !page.contains("NaN") && !page.contains("inf") && page.contains("lqg-identified"),
        "{page}"
    );
    let svg = advice.figure(PageUnits::Metric).to_svg();
    assert!(
        svg.starts_with("<svg") && svg.contains("Largest contour error"),
        "{svg}"
    );
}

/// Needs 7 s of processor time: searches for a feedrate that does not exist.
#[test]
fn what_no_feedrate_holds_is_said_and_a_program_that_cuts_nothing_is_refused() {
    let out_of_reach = advice("G21 G90 G64\nG2 X0 Y0 I1 J0 F1800\nM2\n", 0.001).unwrap();
    assert!(
        !out_of_reach.holds() && out_of_reach.stretches[0].holds_mm_s == [None; 3],
        "{out_of_reach:?}"
    );
    // A machine with feedforward overruns the end of a rapid at any feedrate. The feedrate that
    // holds on the way is reported as well.
    let mut job = job(
        "G21 G90 G64\nG0 X30\nG3 X30 Y0 I-8 J0 F3000\nM2\n",
        TOLERANCE_UM,
    );
    job.machine = Machine::load("stiff".as_ref()).unwrap();
    job.controller = CONTROLLERS.find("feedforward").unwrap();
    let overrun = job.run(&()).unwrap();
    let nearest = overrun.ways[0].nearest.unwrap();
    assert_eq!(
        (overrun.ways[0].whole, nearest.lines, nearest.place),
        (None, [3, 3], ErrorPlace::Start)
    );
    let sentence = nearest.sentence("um", overrun.programmed_mm_s[1]);
    assert!(
        sentence.contains("where line 3 begins; beside the ends of stretches at"),
        "{sentence}"
    );
    assert!(
        nearest.why().contains("a dwell (G4) before line 3 would"),
        "{}",
        nearest.why()
    );
    assert!(
        overrun.stretches[0]
            .cell(0, PageUnits::Metric)
            .starts_with('(')
            && overrun.ways[1].whole.is_some(),
        "{overrun:?}"
    );
    assert!(
        overrun.stretches[0]
            .remark("um")
            .unwrap()
            .ends_with("um, start"),
        "{overrun:?}"
    );
    let error = advice("G21 G0 X5\nM2\n", 10.0).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("has no feed motion: there is nothing to cut"),
        "{error}"
    );
}

/// Needs 11 s of processor time: two searches for the best feedrate, and two corrections.
///
/// A machine file counts as uncertain as `correct` takes it: the cuts at the programmed feed are
/// those of `correct`.
#[test]
fn a_machine_file_is_as_uncertain_as_it_is_for_a_correction() {
    for is_file in [true, false] {
        let mut job = job(CIRCLES, TOLERANCE_UM);
        // A typing mistake, or chance: 4 % between the gains of two axes.
        job.machine.axes[1].kp_1_s *= 1.04;
        job.file_error = CorrectJob::usual_file_error(is_file);
        let mut same = CorrectJob::new(job.program.clone(), job.machine.clone(), job.target);
        same.file_error = job.file_error;
        let (advice, corrected) = (job.run(&()).unwrap(), same.run(&()).unwrap());
        assert_eq!(advice.assumed, corrected.assumed);
        assert_eq!(advice.assumed.is_some(), is_file);
        let cut = |way: usize| {
            advice.ways[way]
                .cuts
                .iter()
                .find(|cut| cut.factor == Some(1.0))
                .unwrap()
                .max_um
        };
        assert_eq!(cut(0), corrected.uncorrected.max_um, "{is_file}");
        // The text of a corrected program has its coordinates rounded to 1 um.
        assert!(
            (cut(1) - corrected.corrected.max_um).abs() < ROUNDED_UM,
            "{is_file}: {} {:?}",
            cut(1),
            corrected.corrected
        );
        let mut page = Vec::new();
        advice
            .write_page(&mut page, "part.ngc", "tnv40", PageUnits::Metric)
            .unwrap();
        assert_eq!(
            String::from_utf8(page)
                .unwrap()
                .contains("kp_1_s is taken as"),
            is_file
        );
    }
}
