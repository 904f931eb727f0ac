//! G71 to G72.2: straight passes from the surface down to the profile, then along it, with passes
//! wherever it goes down.
//!
//! Levels are fixed: whole steps of I below the start of the cycle. G71.1 leaves pockets standing.
//! G71.2 cuts nothing but pockets, with levels below the lip of each.

use crate::geometry::plane::{PlaneCurve, PlanePoint, SLACK_MM};
use crate::motion::feed::Speed;
use crate::motion::lathe::MAX_PASSES;
use crate::motion::lathe::pockets::{
    bridged, ends_falling, falls, falls_through, first_at, parted_at_tops,
};
use crate::motion::lathe::profile::Profile;
use crate::state::Interpreter;
use crate::state::lathe::LatheCycle;
use crate::text::diagnostic::{LineFault, Read};

/// Last digit of the code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Extent {
    Everything,
    WithoutPockets,
    PocketsOnly,
}

/// A cycle on its way along the profile.
struct RoughingState {
    depth_mm: f64,
    retraction_mm: f64,
    /// Levels are whole depths below this.
    top: Option<f64>,
    passes: f64,
}

impl RoughingState {
    fn count(&mut self, lathe: &LatheCycle) -> Read<()> {
        self.passes += 1.0;
        if self.passes <= MAX_PASSES {
            return Ok(());
        }
        let message = format!(
            "the depth of a pass of {} mm makes more than {MAX_PASSES} passes",
            self.depth_mm
        );
        Err(LineFault::new("gcode::lathe", lathe.block.at(b'q'), message).hint("make I larger"))
    }
}

impl Interpreter {
    pub(super) fn rough(
        &mut self,
        lathe: &LatheCycle,
        depth_mm: f64,
        retraction_mm: f64,
        left_mm: f64,
    ) -> Read<()> {
        let kind = match lathe.code % 10 {
            1 => Extent::WithoutPockets,
            2 => Extent::PocketsOnly,
            _ => Extent::Everything,
        };
        let mut profile = Profile::new(lathe)?.offset(lathe, left_mm)?;
        let (start, entry) = (profile.start, profile.entry());
        // The last pass must meet something: a profile that ends below the surface goes up to it.
        if let Some(last) = profile.curves.last().map(PlaneCurve::end)
            && last[1] < start[1] - SLACK_MM
        {
            profile.curves.push(PlaneCurve::Line {
                start: last,
                end: [last[0], start[1]],
            });
        }
        let entry_falls = entry[1] < start[1] - SLACK_MM;
        profile.curves = parted_at_tops(profile.curves);
        if kind == Extent::WithoutPockets {
            profile.curves = bridged(&profile.curves, entry_falls);
        }
        let mut roughing = RoughingState {
            depth_mm,
            retraction_mm,
            top: None,
            passes: 0.0,
        };
        self.lathe_line(lathe, profile.plane, start, Speed::Rapid)?;
        if kind != Extent::PocketsOnly {
            roughing.top = Some(start[1]);
            self.rough_to_entry(lathe, &profile, &mut roughing)?;
        }
        let speed = Self::lathe_entry_speed(&profile);
        self.lathe_line(lathe, profile.plane, entry, speed)?;
        let mut before_falls = entry_falls;
        for number in 0..profile.curves.len() {
            let curve = profile.curves[number];
            let lip = curve.start()[1];
            if kind == Extent::PocketsOnly
                && !before_falls
                && falls(&curve)
                && roughing.top.is_none_or(|top| lip >= top - SLACK_MM)
            {
                roughing.top = Some(lip);
                if first_at(&profile.curves[number..], lip).is_none() {
                    let message =
                        "a pocket ends below its lip, above the start of the cycle".to_owned();
                    return Err(lathe
                        .refuse(lathe.line, &message)
                        .hint("start the cycle outside the highest point of the profile"));
                }
            }
            before_falls = ends_falling(&curve);
            self.rough_curve(lathe, &profile, number, &mut roughing)?;
        }
        Ok(())
    }

    /// Passes from the way to the profile's entry.
    fn rough_to_entry(
        &mut self,
        lathe: &LatheCycle,
        profile: &Profile,
        roughing: &mut RoughingState,
    ) -> Read<()> {
        let (start, entry, plane) = (profile.start, profile.entry(), profile.plane);
        let mut pass = 0_u32;
        loop {
            let level = start[1] - f64::from(pass) * roughing.depth_mm;
            if level <= entry[1] + SLACK_MM {
                return Ok(());
            }
            roughing.count(lathe)?;
            let share = (start[1] - level) / (start[1] - entry[1]);
            let begin = [start[0] + share * (entry[0] - start[0]), level];
            let last = profile.curves.last().map_or(0.0, |last| last.end()[0]);
            let hit = [
                first_at(&profile.curves, level).map_or(last, |(_, along)| along),
                level,
            ];
            self.lathe_line(lathe, plane, begin, Speed::Rapid)?;
            self.pass(
                lathe,
                profile,
                [begin, hit],
                Speed::Rapid,
                roughing.retraction_mm,
            )?;
            pass += 1;
        }
    }

    /// Along a curve of the profile, with a pass at each level that it falls through.
    fn rough_curve(
        &mut self,
        lathe: &LatheCycle,
        profile: &Profile,
        number: usize,
        roughing: &mut RoughingState,
    ) -> Read<()> {
        let mut rest = profile.curves[number];
        let others = profile.curves.get(number + 1..).unwrap_or_default();
        let top = roughing.top.filter(|_| falls(&rest));
        let mut step = top.map_or(0.0, |top| {
            ((top - rest.start()[1] - SLACK_MM) / roughing.depth_mm)
                .ceil()
                .max(0.0)
        });
        while let Some(begin) =
            top.and_then(|top| falls_through(&rest, top - step * roughing.depth_mm))
        {
            step += 1.0;
            roughing.count(lathe)?;
            let mut piece = rest;
            piece.set_end(begin);
            rest.set_start(begin);
            self.lathe_curve(lathe, profile.plane, &piece)?;
            let hit = first_at(&[rest], begin[1]).or_else(|| first_at(others, begin[1]));
            let Some((_, along)) = hit else {
                return Err(lathe.refuse(lathe.line, "a pass along it ends nowhere"));
            };
            self.pass(
                lathe,
                profile,
                [begin, [along, begin[1]]],
                Speed::Programmed,
                roughing.retraction_mm,
            )?;
        }
        self.lathe_curve(lathe, profile.plane, &rest)
    }

    /// Cuts straight on, and comes back to where it began.
    pub(super) fn pass(
        &mut self,
        lathe: &LatheCycle,
        profile: &Profile,
        [begin, hit]: [PlanePoint; 2],
        back: Speed,
        most_mm: f64,
    ) -> Read<()> {
        let plane = profile.plane;
        self.lathe_line(lathe, plane, hit, Speed::Programmed)?;
        // Never past the middle of a short pass: the way back leads back.
        let away_mm = most_mm.min(0.5 * (hit[0] - begin[0]).max(0.0));
        let above = hit[1] + away_mm;
        self.lathe_line(lathe, plane, [hit[0] - away_mm, above], Speed::Rapid)?;
        self.lathe_line(lathe, plane, [begin[0] + away_mm, above], Speed::Rapid)?;
        self.lathe_line(lathe, plane, begin, back)
    }
}
