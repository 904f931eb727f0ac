//! Records a cut at evenly spaced places of the path: the planned speed, and the distance of the
//! tool when it passed.

use std::collections::VecDeque;
use std::io;

use feedwright_plan::vector::{distance, sub};
use feedwright_sim::{Row, Sink};

/// Number of rows that are kept to find the place of the tool's foot.
const KEPT: usize = 1000;

/// A place of the path in a cut.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CutPlace {
    /// Vector from the foot to the tool at the largest distance, mm.
    pub(super) away_mm: [f64; 3],
    /// Largest contour error, mm; 0 if nothing is cut here.
    pub(super) error_mm: f64,
    pub(super) line: u32,
    /// Planned speed, mm/s.
    pub(super) speed_mm_s: f64,
}

/// Sorts the data of rows by places.
#[derive(Debug)]
pub(super) struct CutPlaces {
    pub(super) spacing_mm: f64,
    pub(super) places: Vec<CutPlace>,
    /// Places of the command where the tool may still be.
    behind: VecDeque<(f64, [f64; 3])>,
    /// Place, mm, and planned speed, mm/s, of the last row.
    last: Option<(f64, f64)>,
    last_foot_mm: f64,
    pub(super) time_s: f64,
}

impl CutPlaces {
    /// Creates the record of a path with `count` places.
    pub(super) fn new(spacing_mm: f64, count: usize) -> Self {
        let places = vec![CutPlace::default(); count];
        Self {
            spacing_mm,
            places,
            behind: VecDeque::new(),
            last: None,
            last_foot_mm: 0.0,
            time_s: 0.0,
        }
    }

    /// Largest error, um, and the line that is cut there.
    pub(super) fn worst(&self) -> (f64, u32) {
        let worst = self
            .places
            .iter()
            .max_by(|a, b| a.error_mm.total_cmp(&b.error_mm));
        worst.map_or((0.0, 0), |place| (1e3 * place.error_mm, place.line))
    }

    fn index(&self, s_mm: f64) -> usize {
        ((s_mm / self.spacing_mm).round().max(0.0) as usize).min(self.places.len() - 1)
    }

    /// Records that the plan has reached a place with a speed. Speeds between the places are
    /// interpolated.
    fn planned(&mut self, s_mm: f64, speed_mm_s: f64) {
        let (from_mm, from_mm_s) = self.last.unwrap_or((s_mm, speed_mm_s));
        let first = (from_mm / self.spacing_mm).ceil().max(0.0) as usize;
        for i in first..self.places.len() {
            let at_mm = i as f64 * self.spacing_mm;
            if at_mm > s_mm {
                break;
            }
            let part = if s_mm > from_mm {
                ((at_mm - from_mm) / (s_mm - from_mm)).clamp(0.0, 1.0)
            } else {
                1.0
            };
            self.places[i].speed_mm_s = from_mm_s + part * (speed_mm_s - from_mm_s);
        }
        self.last = Some((s_mm, speed_mm_s));
    }

    /// Returns the place of the tool, mm: the place passed by the command that is nearest to the
    /// tool's foot.
    fn foot_mm(&mut self, row: &Row) -> f64 {
        self.behind.push_back((row.s_mm, row.path_mm));
        if self.behind.len() > KEPT {
            self.behind.pop_front();
        }
        while let [Some(here), Some(next)] = [0, 1].map(|i| self.behind.get(i))
            && distance(next.1, row.foot_mm) <= distance(here.1, row.foot_mm)
        {
            self.behind.pop_front();
        }
        self.behind.front().map_or(row.s_mm, |&(s_mm, _)| s_mm)
    }
}

impl Sink for CutPlaces {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        self.time_s = row.t_s;
        self.planned(row.s_mm, row.feed_plan_mm_s);
        let foot_mm = self.foot_mm(row);
        let (from, to) = (self.index(self.last_foot_mm), self.index(foot_mm));
        self.last_foot_mm = foot_mm;
        if row.cutting {
            let error_mm = row.contour_error_mm.abs();
            // The tool has also passed the places between.
            let first = if to > from { from + 1 } else { to };
            for place in &mut self.places[first..=to] {
                if error_mm > place.error_mm {
                    *place = CutPlace {
                        away_mm: sub(row.act_mm, row.foot_mm),
                        error_mm,
                        line: row.line,
                        ..*place
                    };
                }
            }
        }
        Ok(())
    }
}
