//! `,R` and `,C` of Fanuc: the corner at the end of a block. `dialects/fanuc/corners.rs` cuts it.

use std::ops::Range;

use crate::text::block::{Block, strange};
use crate::text::diagnostic::{LineFault, Read};
use crate::text::expression::{Evaluator, ParameterSource};

/// A corner at the end of a motion.
#[derive(Debug, Clone)]
pub(crate) struct CornerWord {
    /// `,R`, not `,C`.
    pub(crate) is_round: bool,
    pub(crate) value: f64,
    pub(crate) has_point: bool,
    pub(crate) at: Range<usize>,
}

impl Block {
    /// `,R2.` or `,C1.`.
    #[cold]
    pub(super) fn read_corner<V: ParameterSource>(
        &mut self,
        evaluator: &mut Evaluator<'_, V>,
        start: usize,
    ) -> Read<()> {
        evaluator.cursor.bump();
        let letter = evaluator.cursor.peek();
        if !matches!(letter, b'r' | b'c') {
            return Err(strange(evaluator.cursor.bytes, start));
        }
        evaluator.cursor.bump();
        let value = evaluator.value()?;
        let at = start..evaluator.cursor.at;
        if self.corner.is_some() {
            return Err(
                LineFault::new("gcode::repeated", at, "the line already has a corner")
                    .hint("a corner is ,R or ,C"),
            );
        }
        let written = &evaluator.cursor.bytes[at.clone()];
        let has_point = [b'.', b'#', b'['].iter().any(|byte| written.contains(byte));
        self.corner = Some(CornerWord {
            is_round: letter == b'r',
            value,
            has_point,
            at,
        });
        Ok(())
    }
}
