//! A machine that changes in mid-cut, and how fast a controller is back to its error.
//!
//! The machine is that of the model until half of the cutting time of the uncorrected cut. Then its inertia or its friction doubles, or a
//! blow pushes each axis. Every cut is made with and without the change, by the same noise. Within 1 s after the change the controller has
//! to be back by the rule of `mismatch/recovery.rs`, and its largest error from the change on must not exceed the uncorrected one by more
//! than 1 um.

use feedwright_sim::{Cancelled, Machine, Measurement, Mechanism, PlanCache, Plant, Watch};
use serde::{Deserialize, Serialize};

use super::Difference;
use super::recovery::{BACK_S, ErrorCourse, Pairs};
use crate::never_worse::cut::{Cutter, Figures, ProgramCut};
use crate::never_worse::summary::Quantiles;
use crate::never_worse::{SweepJob, SweepOptions, each};

/// What the largest error may be above the uncorrected one, um.
const MAX_MORE_UM: f64 = 1.0;
/// What a blow moves each axis by at the most, uncorrected, mm: some workpiece or chip gets in the way.
const BLOW_MM: f64 = 0.035;

/// What happens in mid-cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SuddenChange {
    /// Twice the inertia.
    Inertia,
    /// Twice the friction.
    Friction,
    /// A torque impulse.
    Blow,
}

impl SuddenChange {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Inertia, Self::Friction, Self::Blow];

    /// Its name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inertia => "inertia x2",
            Self::Friction => "friction x2",
            Self::Blow => "blow",
        }
    }

    /// What it does to a machine of N axes.
    fn of<const N: usize>(self, machine: &Machine) -> Effect<N> {
        let difference = match self {
            Self::Inertia => Difference::Inertia(2.0),
            Self::Friction => Difference::Friction(2.0),
            Self::Blow => return Effect::Blow(blow_nm_s(machine)),
        };
        let mut machine = machine.clone();
        machine.axes.iter_mut().enumerate().for_each(|(index, axis)| difference.change(axis, index));
        Effect::Machine(Box::new(machine))
    }
}

/// The machine that it becomes, or the impulses that push its axes, N m s.
#[derive(Debug, Clone)]
enum Effect<const N: usize> {
    Machine(Box<Machine>),
    Blow([f64; N]),
}

impl<const N: usize> Effect<N> {
    fn on(&self, plant: &mut Plant<N>) {
        match self {
            Self::Machine(machine) => plant.change_to(machine),
            Self::Blow(impulse_nm_s) => plant.push(*impulse_nm_s),
        }
    }
}

/// Impulses that move each axis by [`BLOW_MM`] while it runs at a steady speed, N m s: found by trying.
fn blow_nm_s<const N: usize>(machine: &Machine) -> [f64; N] {
    /// Speed of the axis, mm/s, and how long it has run, s.
    const RUN: (f64, f64) = (10.0, 1.0);
    /// How long the deviation is looked at, s.
    const LOOKED_S: f64 = 0.3;
    /// Trials: the deviation is nearly proportional to the impulse.
    const TRIALS: u32 = 12;
    let servo_s = machine.period.servo_s;
    let (before, after) = ((RUN.1 / servo_s) as u32, (LOOKED_S / servo_s) as u32);
    let command_mm = |n: u32| [RUN.0 * servo_s * f64::from(n); N];
    let mut plant = Plant::<N>::new(machine, [0.0; N]);
    let [mut impulse_nm_s, mut moved_mm] = [[0.0; N]; 2];
    for n in 0..before {
        plant.step(command_mm(n));
    }
    for trial in 0..TRIALS {
        for (i, impulse) in impulse_nm_s.iter_mut().enumerate() {
            let axis = machine.axis(i);
            let first = axis.inertia_kg_m2 * axis.rad_per_mm() * BLOW_MM * axis.kp_1_s;
            *impulse = if trial == 0 { first } else { *impulse * (BLOW_MM / moved_mm[i]).clamp(0.2, 5.0) };
        }
        let (mut calm, mut pushed) = (plant.clone(), plant.clone());
        pushed.push(impulse_nm_s);
        moved_mm = [0.0; N];
        for n in before..before + after {
            let (calm, pushed) = (calm.step(command_mm(n)).joint_mm, pushed.step(command_mm(n)).joint_mm);
            for i in 0..N {
                moved_mm[i] = moved_mm[i].max((pushed[i] - calm[i]).abs());
            }
        }
    }
    impulse_nm_s
}

/// A plant that changes before servo period `at`.
struct Changing<const N: usize> {
    plant: Plant<N>,
    effect: Effect<N>,
    at: u64,
    passed: u64,
}

impl<const N: usize> Changing<N> {
    fn pass(&mut self, periods: u64) {
        if (self.passed..self.passed + periods).contains(&self.at) {
            self.effect.on(&mut self.plant);
        }
        self.passed += periods;
    }
}

impl<const N: usize> Mechanism for Changing<N> {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        self.pass(1);
        Mechanism::step(&mut self.plant, command_mm)
    }

    fn skip(&mut self, periods: u64) {
        self.pass(periods);
        self.plant.skip(periods);
    }

    fn has_geometry(&self) -> bool {
        self.plant.has_geometry()
    }
}

/// A cut in one way, and its errors.
struct FollowedCut {
    controller: &'static str,
    figures: Figures,
    course: ErrorCourse,
}

/// What is wrong with a cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SuddenFault {
    /// The error is not back within the time.
    NotBack,
    /// The largest error is above the uncorrected one.
    Max,
    /// Not cut to its end, or not with the controller in the loop.
    Lost,
}

impl SuddenFault {
    /// Its name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotBack => "not back",
            Self::Max => "max",
            Self::Lost => "lost",
        }
    }
}

/// A cut in which the machine changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuddenRow {
    /// Program.
    pub program: String,
    /// Machine before the change, for which the controller was made.
    pub machine: String,
    /// What changed.
    pub change: SuddenChange,
    /// Controller.
    pub controller: String,
    /// When, s.
    pub at_s: f64,
    /// Largest error from the change on, um: uncorrected, and with the controller.
    pub max_um: [f64; 2],
    /// Time after the change from which on the error is within what is allowed, s; none where the cut is too short to tell.
    pub back_s: Option<f64>,
    /// RMS error later than 1 s after the change, over that of the cut without the change.
    pub level: Option<f64>,
    /// Why it was not cut to its end, or not with the controller in the loop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<String>,
    /// What is wrong with it.
    pub faults: Vec<SuddenFault>,
}

impl SuddenRow {
    /// With its verdict.
    fn judged(mut self) -> Self {
        let [open_um, own_um] = self.max_um;
        let is_fault = |fault: &SuddenFault| match fault {
            SuddenFault::NotBack => self.back_s.is_some_and(|back_s| back_s > BACK_S),
            SuddenFault::Max => own_um > open_um + MAX_MORE_UM,
            SuddenFault::Lost => self.lost.is_some(),
        };
        self.faults =
            [SuddenFault::NotBack, SuddenFault::Max, SuddenFault::Lost].into_iter().filter(is_fault).collect();
        self
    }
}

/// Cuts with one controller and one change on one machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuddenGroup {
    /// Machine before the change.
    pub machine: String,
    /// What changed.
    pub change: SuddenChange,
    /// Controller.
    pub controller: String,
    /// Number of cuts.
    pub cuts: usize,
    /// Cuts with each fault: not back, largest error, lost.
    pub faults: [usize; 3],
    /// Time after which the error is back, s; of cuts that are long enough.
    pub back_s: Option<Quantiles>,
    /// Median of the level.
    pub level: Option<f64>,
    /// Largest excess of the largest error over the uncorrected one, um; negative where there is none.
    pub max_more_um: f64,
}

impl SuddenGroup {
    fn of(first: &SuddenRow, rows: &[SuddenRow]) -> Self {
        let key = |row: &SuddenRow| (row.machine.clone(), row.change, row.controller.clone());
        let cuts: Vec<&SuddenRow> = rows.iter().filter(|row| key(row) == key(first)).collect();
        let having = |fault: SuddenFault| cuts.iter().filter(|row| row.faults.contains(&fault)).count();
        let (machine, change, controller) = key(first);
        Self {
            machine,
            change,
            controller,
            cuts: cuts.len(),
            faults: [SuddenFault::NotBack, SuddenFault::Max, SuddenFault::Lost].map(having),
            back_s: Quantiles::of(cuts.iter().filter_map(|row| row.back_s).collect()),
            level: Quantiles::of(cuts.iter().filter_map(|row| row.level).collect()).map(|level| level.median),
            max_more_um: cuts.iter().map(|row| row.max_um[1] - row.max_um[0]).fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// All of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuddenSummary {
    /// By machine, change and controller.
    pub groups: Vec<SuddenGroup>,
    /// All cuts.
    pub rows: Vec<SuddenRow>,
    /// Cuts that are not judged, because the uncorrected cut is lost.
    pub not_judged: usize,
}

/// Cuts all programs with every change and every controller, each on the machine of its job.
///
/// # Errors
/// An end from outside.
pub fn sudden(jobs: &[SweepJob], options: &SweepOptions, watch: &dyn Watch) -> Result<SuddenSummary, Cancelled> {
    let work = |job: &SweepJob, cutter: &mut Cutter| match job.program.axes {
        2 => of_program::<2>(job, cutter, watch),
        _ => of_program::<3>(job, cutter, watch),
    };
    let of_jobs = each(jobs, options, watch, work)?;
    let rows: Vec<SuddenRow> = of_jobs.concat();
    let not_judged = of_jobs.len() * options.controllers.len() * SuddenChange::ALL.len() - rows.len();
    let mut groups: Vec<SuddenGroup> = Vec::new();
    let is_of = |group: &SuddenGroup, row: &SuddenRow| {
        (&group.machine, group.change, &group.controller) == (&row.machine, row.change, &row.controller)
    };
    for row in &rows {
        if !groups.iter().any(|group| is_of(group, row)) {
            groups.push(SuddenGroup::of(row, &rows));
        }
    }
    Ok(SuddenSummary { groups, rows, not_judged })
}

/// Cuts a program in every way, without a change and with each.
fn of_program<const N: usize>(
    SweepJob { program, machine, .. }: &SweepJob,
    cutter: &mut Cutter,
    watch: &dyn Watch,
) -> Result<Vec<SuddenRow>, Cancelled> {
    if machine.axis_count() < N {
        return Ok(vec![]);
    }
    let plan = PlanCache::default();
    let calm = ProgramCut::on(machine, program, &plan, watch);
    let mut cut_all = |cut: &ProgramCut<'_>| -> Result<Vec<FollowedCut>, Cancelled> {
        let ways = 0..cutter.ways();
        let one = |way: usize| {
            let mut course = ErrorCourse { servo_s: cut.servo_s, ..ErrorCourse::default() };
            let figures = cutter.cut(way, cut, &mut [&mut course])?;
            Ok(FollowedCut { controller: cutter.name(way), figures, course })
        };
        ways.map(one).collect()
    };
    let before = cut_all(&calm)?;
    let Some(at) = before[0].course.middle() else { return Ok(vec![]) };
    let mut rows = Vec::new();
    for change in SuddenChange::ALL {
        let effect = change.of::<N>(machine);
        let plant = |start_mm: [f64; 3], seed: u64| -> Box<dyn Mechanism> {
            let plant = Plant::<N>::with_seed(machine, std::array::from_fn(|i| start_mm[i]), seed);
            // Laps of practice have other seeds, and no change.
            let at = if seed == machine.noise.seed { at as u64 } else { u64::MAX };
            Box::new(Changing { plant, effect: effect.clone(), at, passed: 0 })
        };
        let after = cut_all(&ProgramCut { run: calm.run.plant(&plant), ..calm })?;
        if before[0].figures.lost.is_none() && after[0].figures.lost.is_none() {
            let row = |way: usize| {
                let pair = |way: usize| [&before[way].course, &after[way].course];
                let pairs = Pairs { open: pair(0), own: pair(way), at };
                SuddenRow {
                    program: program.name.clone(),
                    machine: machine.name.clone(),
                    change,
                    controller: after[way].controller.to_owned(),
                    at_s: at as f64 * calm.servo_s,
                    max_um: [pairs.open[1].max_um(at), pairs.own[1].max_um(at)],
                    back_s: pairs.back_s(),
                    level: pairs.level(),
                    lost: after[way].figures.lost.clone(),
                    faults: vec![],
                }
            };
            rows.extend((1..after.len()).map(|way| row(way).judged()));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::never_worse::program::{Length, SweepProgram};
    use feedwright::FEEDFORWARD;
    use feedwright_sim::Run;
    use std::sync::Arc;

    #[test]
    fn the_largest_error_and_an_end_without_the_controller_are_faults() {
        let row = |max_um, back_s, lost: Option<&str>| SuddenRow {
            program: "p".to_owned(),
            machine: "m".to_owned(),
            change: SuddenChange::Blow,
            controller: "c".to_owned(),
            at_s: 1.0,
            max_um,
            back_s,
            level: None,
            lost: lost.map(str::to_owned),
            faults: vec![],
        };
        let faults = |row: SuddenRow| row.judged().faults;
        assert!(faults(row([10.0, 10.9], Some(0.9), None)).is_empty());
        assert_eq!(faults(row([10.0, 11.1], None, None)), [SuddenFault::Max]);
        assert_eq!(faults(row([10.0, 12.0], Some(1.1), Some("faded"))).len(), 3);
    }

    #[test]
    fn a_blow_moves_an_axis_by_what_is_meant_wherever_it_is_in_its_motion() {
        for name in ["workshop", "stiff", "tnv40", "router"] {
            let machine = Machine::load(name.as_ref()).expect("built in");
            let impulse_nm_s = blow_nm_s::<2>(&machine);
            // Twice as fast as where the impulse was found, and at another time.
            let command_mm = |n: u32| [20.0 * machine.period.servo_s * f64::from(n); 2];
            let mut calm = Plant::<2>::new(&machine, [0.0; 2]);
            (0..3000).for_each(|n| {
                calm.step(command_mm(n));
            });
            let mut pushed = calm.clone();
            pushed.push(impulse_nm_s);
            let mut moved_mm = [0.0_f64; 2];
            for n in 3000..4000 {
                let (calm, pushed) = (calm.step(command_mm(n)).joint_mm, pushed.step(command_mm(n)).joint_mm);
                (0..2).for_each(|i| moved_mm[i] = moved_mm[i].max((pushed[i] - calm[i]).abs()));
            }
            assert!(moved_mm.iter().all(|mm| (0.02..0.05).contains(mm)), "{name}: {moved_mm:?} mm");
        }
    }

    #[test]
    fn a_change_to_the_same_machine_is_none_and_the_others_come_when_they_are_to() {
        let machine = Arc::new(Machine::load("workshop".as_ref()).expect("built in"));
        let length = Length { machine: &machine, limit_s: 60.0 };
        let text = "G21 F1500\nG1 X5\nG4 P2\nG2 X5 Y0 I5 J0\nG2 X5 Y0 I5 J0\nG1 X0\nM2\n";
        let program = Arc::new(SweepProgram::from_text("arc", text, length).expect("a program"));
        let course = |run: Run<'_>| {
            let mut course = ErrorCourse { servo_s: machine.period.servo_s, ..ErrorCourse::default() };
            run.cut_steps::<2>(&program.steps, &mut feedwright_control::Uncorrected, &mut [&mut course])
                .expect("a cut");
            course.errors_um
        };
        let calm = course(Run::on(&machine));
        let at = calm.len() / 2;
        let changed = |effect: &Effect<2>| {
            let plant = |start_mm: [f64; 3], seed: u64| -> Box<dyn Mechanism> {
                let plant = Plant::<2>::with_seed(&machine, [start_mm[0], start_mm[1]], seed);
                Box::new(Changing { plant, effect: effect.clone(), at: at as u64, passed: 0 })
            };
            course(Run::on(&machine).plant(&plant))
        };
        assert!(calm == changed(&Effect::Machine(Box::new((*machine).clone()))));
        for change in SuddenChange::ALL {
            let errors_um = changed(&change.of::<2>(&machine));
            assert_eq!(calm[..at], errors_um[..at], "{}", change.name());
            assert_ne!(calm[at..], errors_um[at..], "{}", change.name());
        }
        let job = SweepJob { program, machine: machine.clone(), model: machine.clone() };
        let summary = sudden(&[job], &SweepOptions::of(vec![&FEEDFORWARD]), &()).expect("nobody ends it");
        assert_eq!((summary.rows.len(), summary.groups.len(), summary.not_judged), (3, 3, 0));
        let open_um: Vec<f64> = summary.rows.iter().map(|row| row.max_um[0]).collect();
        assert!(
            open_um.iter().all(|um| *um > 1.0) && summary.rows.iter().all(|row| row.back_s.is_some()),
            "{summary:?}"
        );
    }
}
