//! Decisions from the bytes of a fuzzer: a mutation of a byte changes one decision, and not the
//! grammar.

/// Bytes that decisions are taken from. After their end, every decision is the first choice.
pub(crate) struct Draw<'a> {
    rest: &'a [u8],
}

impl<'a> Draw<'a> {
    pub(crate) const fn new(rest: &'a [u8]) -> Self {
        Self { rest }
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Returns the bytes that no decision was taken from.
    pub(crate) const fn rest(&self) -> &'a [u8] {
        self.rest
    }

    pub(crate) fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.rest.split_first() else {
            return 0;
        };
        self.rest = rest;
        *first
    }

    /// Returns a number from 0 to one less than `limit`.
    pub(crate) fn below(&mut self, limit: u8) -> u8 {
        self.byte() % limit
    }

    pub(crate) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[usize::from(self.byte()) % from.len()]
    }

    /// Returns a part from 0 to 1, from two bytes.
    pub(crate) fn part(&mut self) -> f64 {
        f64::from(u16::from_le_bytes([self.byte(), self.byte()])) / f64::from(u16::MAX)
    }

    /// Returns a number of the usual size, rarely an absurd one.
    pub(crate) fn number(&mut self, reach: f64) -> f64 {
        match self.byte() {
            0..=23 => 0.0,
            24..=200 => (f64::from(self.below(201)) - 100.0) * reach / 100.0,
            201..=247 => (2.0 * self.part() - 1.0) * reach,
            _ => self.pick(&[1e-9, -1e-9, 1e6, -1e6, 1e300, 1e-300, 0.1, 1.0 / 3.0]),
        }
    }

    /// Returns any double, NaN and infinities included.
    pub(crate) fn double(&mut self) -> f64 {
        match self.byte() {
            0..=63 => 0.0,
            64..=127 => self.pick(&[
                f64::NAN,
                f64::INFINITY,
                f64::NEG_INFINITY,
                f64::MAX,
                f64::MIN_POSITIVE,
                -0.0,
            ]),
            _ => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))),
        }
    }
}
