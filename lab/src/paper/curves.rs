//! The rows of one cut of the circle, as curves to draw.

use feedwright_sim::{Row, Sink};

/// Curves of a cut, as in the figures of the paper.
#[derive(Debug, Default)]
pub(super) struct Curves {
    /// Time and contour error, s and um.
    pub(super) error: Vec<[f64; 2]>,
    /// Time and commanded feedrate, s and mm/s.
    pub(super) feed: Vec<[f64; 2]>,
    /// The programmed path, mm.
    pub(super) path: Vec<[f64; 2]>,
    /// The command, mm.
    pub(super) command: Vec<[f64; 2]>,
    /// The tool, mm.
    pub(super) tool: Vec<[f64; 2]>,
    last: Option<Row>,
}

impl Sink for Curves {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        self.error.push([row.t_s, row.contour_error_mm * 1e3]);
        self.path.push([row.path_mm[0], row.path_mm[1]]);
        self.command.push([row.cmd_mm[0], row.cmd_mm[1]]);
        self.tool.push([row.act_mm[0], row.act_mm[1]]);
        if let Some(last) = self.last.replace(*row) {
            let [dx, dy] = [0, 1].map(|i| row.cmd_mm[i] - last.cmd_mm[i]);
            self.feed
                .push([row.t_s, libm::hypot(dx, dy) / (row.t_s - last.t_s)]);
        }
        Ok(())
    }
}
