//! G5, G5.1, G5.2/G5.3 and G6.2 as exact splines.
//!
//! G5 is a cubic and G5.1 a quadratic Bezier curve; G5.2 collects control points with weights for a
//! clamped uniform NURBS until G5.3; G6.2 gives order, knots, weights and control points itself. An
//! interpreter that turns them into chords or arcs loses what the path stage needs; the curve is
//! handed on as it is.

use std::sync::Arc;

use crate::canon::{Plane, Shape, Spline};
use crate::motion::feed::{Speed, others};
use crate::state::Interpreter;
use crate::state::carried_over::Collected;
use crate::state::frame::Position;
use crate::text::block::Block;
use crate::text::codes::{AXES, bit, spelled};
use crate::text::diagnostic::{LineFault, Read};

/// Control points of one curve: each costs 32 bytes, and no curve of a CAM system has more than
/// some hundreds.
const MAX_POINTS: usize = 100_000;
/// Order of a curve. LinuxCNC takes 3 up; beyond 10 the basis loses digits.
const ORDERS: (i64, i64) = (2, 10);
/// Distance of the first control point of G6.2 from the position, mm: what three printed decimals
/// leave.
const START_WITHIN_MM: f64 = 0.01;

impl Interpreter {
    /// G5 and G5.1.
    pub(crate) fn bezier(&mut self, block: &Block, code: u16) -> Read<()> {
        self.check_spline(block, code)?;
        let unit = self.modal.unit_mm;
        let target = self.target(block)?;
        if !block.has(b'x') && !block.has(b'y') {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                format!("{} has no end: X and Y are missing", spelled(code)),
            ));
        }
        let pair = |one: u8, two: u8| {
            (block.has(one) || block.has(two))
                .then(|| [one, two].map(|letter| block.get(letter).unwrap_or(0.0) * unit))
        };
        if block.has(b'i') != block.has(b'j') {
            let at = block.at_any(bit(b'i') | bit(b'j'));
            return Err(LineFault::new(
                "gcode::spline",
                at,
                "the first control point needs both I and J, or neither",
            ));
        }
        let first = match (pair(b'i', b'j'), self.carried.bezier_end) {
            (Some(offset), _) => offset,
            (None, Some([p, q])) if code == 50 => [-p, -q],
            _ => {
                return Err(LineFault::new(
                    "gcode::spline",
                    block.whole(),
                    "I and J (first control point) are missing",
                ));
            }
        };
        let start = self.at;
        let mut points = vec![start];
        points.push(shifted(start, first));
        let mut end_offset = None;
        if code == 50 {
            if block.has(b'p') != block.has(b'q') || !block.has(b'p') {
                return Err(LineFault::new(
                    "gcode::spline",
                    block.whole(),
                    "G5 needs P and Q (second control point, from the end)",
                ));
            }
            let offset = pair(b'p', b'q').unwrap_or_default();
            points.push(shifted(target, offset));
            end_offset = Some(offset);
        }
        points.push(target);
        let degree = points.len() - 1;
        let mut knots = vec![0.0; degree + 1];
        knots.resize(2 * (degree + 1), 1.0);
        let control_mm = points
            .iter()
            .map(|point| self.machine_point(point))
            .collect();
        let spline = Spline {
            degree,
            knots,
            control_mm,
            weights: vec![1.0; degree + 1],
        };
        self.spline_to(block, spline, target)?;
        self.carried.bezier_end = end_offset;
        // The next line needs its own G5.
        self.modal.motion = 800;
        Ok(())
    }

    /// One line of G5.2.
    pub(crate) fn nurbs_point(&mut self, block: &Block) -> Read<()> {
        self.check_spline(block, 52)?;
        let has_point = block.has(b'x') || block.has(b'y');
        if self.carried.collected.is_none() {
            let order = if block.has(b'l') {
                self.integer(block, b'l', ORDERS.0, ORDERS.1)? as usize
            } else {
                3
            };
            let first = self.machine_point(&self.at);
            let weight = if has_point {
                1.0
            } else {
                self.weight(block, b'p')?
            };
            self.carried.collected = Some(Collected {
                code: 52,
                order,
                start: self.at,
                points: vec![first],
                weights: vec![weight],
                knots: Vec::new(),
            });
            if !has_point {
                return Ok(());
            }
        }
        if !(block.has(b'x') && block.has(b'y')) {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                "a control point of G5.2 needs both X and Y",
            ));
        }
        if !block.has(b'p') {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                "a control point of G5.2 needs its weight P",
            ));
        }
        let weight = self.weight(block, b'p')?;
        // In G91 every point is a distance from the start of the curve.
        self.at = self
            .carried
            .collected
            .as_ref()
            .map_or(self.at, |collected| collected.start);
        let target = self.target(block)?;
        self.collect(block, target, weight)
    }

    /// G5.3: the curve of G5.2 is complete.
    pub(crate) fn nurbs_end(&mut self, block: &Block) -> Read<()> {
        let Some(collected) = self
            .carried
            .collected
            .take()
            .filter(|collected| collected.code == 52)
        else {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                "G5.3 ends a curve that no G5.2 began",
            ));
        };
        let (count, order) = (collected.points.len(), collected.order);
        if count < order {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                format!(
                    "a curve of order {order} needs at least {order} control points, this has {count}"
                ),
            ));
        }
        let spans = count - order + 1;
        let knots = (0..count + order)
            .map(|n| (n + 1).saturating_sub(order).min(spans) as f64)
            .collect();
        self.modal.motion = 800;
        let spline = Spline {
            degree: order - 1,
            knots,
            control_mm: collected.points,
            weights: collected.weights,
        };
        self.spline_to(block, spline, self.at)
    }

    /// One line of G6.2: a control point with weight R and knot K, or a closing knot alone.
    pub(crate) fn nurbs_with_knots(&mut self, block: &Block) -> Read<()> {
        let Some(knot) = block.get(b'k') else {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                "every line of G6.2 needs its knot K",
            ));
        };
        if self.carried.collected.is_none() {
            self.begin_with_knots(block)?;
        }
        let last = self
            .carried
            .collected
            .as_ref()
            .and_then(|collected| collected.knots.last().copied());
        if last.is_some_and(|last| knot < last) {
            return Err(LineFault::new(
                "gcode::spline",
                block.at(b'k'),
                format!("the knot K{knot} is below the one before it"),
            ));
        }
        if block.has_axes() {
            let weight = if block.has(b'r') {
                self.weight(block, b'r')?
            } else {
                1.0
            };
            let target = self.target(block)?;
            self.collect(block, target, weight)?;
        }
        let Some(collected) = &mut self.carried.collected else {
            return Ok(());
        };
        collected.knots.push(knot);
        if collected.knots.len() < collected.points.len() + collected.order || block.has_axes() {
            return Ok(());
        }
        let Some(collected) = self.carried.collected.take() else {
            return Ok(());
        };
        self.complete(block, collected)
    }

    /// The first line of G6.2: its order P, and that it begins where the tool is.
    fn begin_with_knots(&mut self, block: &Block) -> Read<()> {
        if !block.has(b'p') {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                "the first line of G6.2 needs the order P",
            ));
        }
        let order = self.integer(block, b'p', ORDERS.0, ORDERS.1)? as usize;
        let target = self.target(block)?;
        let (first, here) = (self.machine_point(&target), self.machine_point(&self.at));
        let away = (0..3)
            .map(|axis| (first[axis] - here[axis]).powi(2))
            .sum::<f64>()
            .sqrt();
        if away > START_WITHIN_MM {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                format!("the curve begins {away:.4} mm from the position; the limit is {START_WITHIN_MM} mm"),
            )
            .hint("move to the first control point before G6.2"));
        }
        self.carried.collected = Some(Collected {
            code: 62,
            order,
            start: self.at,
            points: Vec::new(),
            weights: Vec::new(),
            knots: Vec::new(),
        });
        Ok(())
    }

    /// The curve of G6.2 has all its knots.
    fn complete(&mut self, block: &Block, collected: Collected) -> Read<()> {
        self.modal.motion = 800;
        let (order, count) = (collected.order, collected.points.len());
        let knots = collected.knots;
        if count < order || knots[order - 1] >= knots[count] {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                format!("{count} control points and their knots make no curve of order {order}"),
            ));
        }
        if knots[0] != knots[order - 1] || knots[count] != knots[count + order - 1] {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                format!(
                    "the first {order} and the last {order} knots must be equal, so that the curve ends at its end points"
                ),
            ));
        }
        let spline = Spline {
            degree: order - 1,
            knots,
            control_mm: collected.points,
            weights: collected.weights,
        };
        self.spline_to(block, spline, self.at)
    }

    /// Fails if a spline is still incomplete at this line.
    pub(crate) fn check_no_curve(&mut self, block: &Block) -> Read<()> {
        match self.carried.collected.take() {
            None => Ok(()),
            Some(collected) => {
                let end = if collected.code == 52 {
                    "G5.3"
                } else {
                    "its last knots K"
                };
                Err(LineFault::new(
                    "gcode::spline",
                    block.whole(),
                    format!(
                        "the curve of {} is not complete: {end} is missing",
                        spelled(collected.code)
                    ),
                ))
            }
        }
    }

    fn check_spline(&self, block: &Block, code: u16) -> Read<()> {
        if self.modal.plane != Plane::Xy {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                format!("{} needs the XY plane G17", spelled(code)),
            )
            .hint("curves lie in XY only; write G17 before the curve, or cut it in another plane by lines and arcs"));
        }
        let others = block.set & AXES & !(bit(b'x') | bit(b'y'));
        if others != 0 {
            return Err(LineFault::new(
                "gcode::spline",
                block.at_any(others),
                format!("{} moves X and Y only", spelled(code)),
            ));
        }
        if self.compensates() {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                format!("{} cannot run with cutter compensation", spelled(code)),
            ));
        }
        Ok(())
    }

    fn weight(&self, block: &Block, letter: u8) -> Read<f64> {
        let weight = block.get(letter).unwrap_or(1.0);
        if weight > 0.0 {
            return Ok(weight);
        }
        Err(LineFault::new(
            "gcode::spline",
            block.at(letter),
            format!("the weight {weight} of a control point must be above 0"),
        ))
    }

    fn collect(&mut self, block: &Block, target: Position, weight: f64) -> Read<()> {
        let point = self.machine_point(&target);
        self.at = target;
        let Some(collected) = &mut self.carried.collected else {
            return Ok(());
        };
        if collected.points.len() == MAX_POINTS {
            return Err(LineFault::new(
                "gcode::spline",
                block.whole(),
                format!("the curve has more than {MAX_POINTS} control points"),
            ));
        }
        collected.points.push(point);
        collected.weights.push(weight);
        Ok(())
    }

    fn machine_point(&self, program: &Position) -> [f64; 3] {
        let machine = self.frame.to_machine(program);
        [machine[0], machine[1], machine[2]]
    }

    fn spline_to(&mut self, block: &Block, mut spline: Spline, target: Position) -> Read<()> {
        let machine = self.frame.to_machine(&target);
        let start = std::mem::replace(&mut self.here, machine);
        self.at = target;
        if let Some(first) = spline.control_mm.first_mut() {
            *first = [start[0], start[1], start[2]];
        }
        let feed_mm_s = self.feed_for(block, spline.length_mm())?;
        let others = others(&start, &machine, 0.0);
        self.push_motion(
            Speed::Programmed,
            &start,
            Shape::Spline(Arc::new(spline)),
            feed_mm_s,
            others,
        );
        Ok(())
    }
}

fn shifted(mut point: Position, [x, y]: [f64; 2]) -> Position {
    point[0] += x;
    point[1] += y;
    point
}
