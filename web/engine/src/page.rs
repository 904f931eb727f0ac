//! Functions of the page that the module imports: for reports while a request is answered, and for
//! texts that the page keeps for the next request.

use std::io;
use std::sync::{Mutex, PoisonError};

use feedwright::KeptTexts;
use feedwright::sim::{Row, Sink, Watch};

#[cfg(target_arch = "wasm32")]
mod imports {
    #[expect(
        unsafe_code,
        reason = "the attribute names where the functions come from"
    )]
    #[link(wasm_import_module = "page")]
    unsafe extern "C" {
        /// Reports the progress of a stage: its name as text in the memory of the module, and
        /// thousandths.
        pub(super) safe fn progress(stage: usize, bytes: usize, thousandths: u32);
        /// Draws `count` points of a cut: x, y, z in mm and the contour error in um, as 32-bit
        /// floats.
        pub(super) safe fn cut(points: usize, count: usize);
        /// Finds a text with this name. Returns its length in bytes, or a negative number if the
        /// page has no such text.
        pub(super) safe fn find(name: usize, bytes: usize) -> i32;
        /// Writes the text that was found to the address `into`.
        pub(super) safe fn take(into: usize);
        /// Keeps a text with this name.
        pub(super) safe fn keep(name: usize, name_bytes: usize, text: usize, bytes: usize);
    }
}

#[cfg(not(target_arch = "wasm32"))]
mod imports {
    pub(super) fn progress(_stage: usize, _bytes: usize, _thousandths: u32) {}
    pub(super) fn cut(_points: usize, _count: usize) {}
    pub(super) fn find(_name: usize, _bytes: usize) -> i32 {
        -1
    }
    pub(super) fn take(_into: usize) {}
    pub(super) fn keep(_name: usize, _name_bytes: usize, _text: usize, _bytes: usize) {}
}

/// Thousandths of a stage between two reports of its progress.
const STEP: u64 = 10;

#[derive(Debug, Default)]
struct Stage {
    name: String,
    steps: u64,
    done: u64,
    reported: u64,
}

/// Watch that reports the progress of a stage to the page.
#[derive(Debug, Default)]
pub(crate) struct PageWatch(Mutex<Stage>);

impl Watch for PageWatch {
    fn begin(&self, stage: &str, steps: u64) {
        let mut now = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *now = Stage {
            name: stage.to_owned(),
            steps: steps.max(1),
            done: 0,
            reported: 0,
        };
        imports::progress(now.name.as_ptr() as usize, now.name.len(), 0);
    }

    fn advance(&self, steps: u64) {
        let mut now = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        now.done += steps;
        let thousandths = (1000 * now.done / now.steps.max(1)).min(1000);
        if thousandths >= now.reported + STEP {
            now.reported = thousandths;
            imports::progress(
                now.name.as_ptr() as usize,
                now.name.len(),
                thousandths as u32,
            );
        }
    }
}

/// Models that the page keeps for later requests.
pub(crate) struct PageTexts;

impl KeptTexts for PageTexts {
    fn read(&self, name: &str) -> Option<String> {
        let mut text =
            vec![0; usize::try_from(imports::find(name.as_ptr() as usize, name.len())).ok()?];
        imports::take(text.as_mut_ptr() as usize);
        String::from_utf8(text).ok()
    }

    fn write(&self, name: &str, text: &str) {
        imports::keep(
            name.as_ptr() as usize,
            name.len(),
            text.as_ptr() as usize,
            text.len(),
        );
    }
}

/// Number of points that are collected before the page gets them.
const POINTS: usize = 256;

/// Sink that draws the cut on the page while it is computed.
#[derive(Debug)]
pub(crate) struct PageCut {
    /// Smallest distance between two points, mm.
    apart_mm: f64,
    last_mm: [f64; 3],
    points: Vec<[f32; 4]>,
}

impl PageCut {
    /// Creates a sink for points that are at least `apart_mm` apart.
    pub(crate) fn new(apart_mm: f64) -> Self {
        Self {
            apart_mm,
            last_mm: [f64::INFINITY; 3],
            points: Vec::with_capacity(POINTS),
        }
    }

    /// Sends the last points to the page.
    pub(crate) fn flush(&mut self) {
        imports::cut(self.points.as_ptr() as usize, self.points.len());
        self.points.clear();
    }
}

impl Sink for PageCut {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        let squares = row
            .act_mm
            .iter()
            .zip(self.last_mm)
            .map(|(now, last)| (now - last) * (now - last));
        if squares.sum::<f64>() < self.apart_mm * self.apart_mm {
            return Ok(());
        }
        self.last_mm = row.act_mm;
        let [x, y, z] = row.act_mm.map(|mm| mm as f32);
        let error_um = if row.cutting {
            1e3 * row.contour_error_mm as f32
        } else {
            f32::NAN
        };
        self.points.push([x, y, z, error_um]);
        if self.points.len() == POINTS {
            self.flush();
        }
        Ok(())
    }
}
