//! What operators and functions make of their values: NISTIR 6556, section 3.3.2, with the
//! comparisons that LinuxCNC added.

use crate::text::diagnostic::Short;

/// Two values closer than this are equal to EQ and NE, as in LinuxCNC.
const EQUAL_WITHIN: f64 = 1e-4;

/// An operator between two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operator {
    Power,
    Times,
    Over,
    Modulo,
    Plus,
    Minus,
    Equal,
    Unequal,
    Greater,
    AtLeast,
    Less,
    AtMost,
    And,
    Or,
    Xor,
}

/// Every operator with its spelling and binding strength. `**` stands before `*`.
pub(super) const OPERATORS: [(&[u8], Operator, u8); 15] = [
    (b"**", Operator::Power, 5),
    (b"*", Operator::Times, 4),
    (b"/", Operator::Over, 4),
    (b"mod", Operator::Modulo, 4),
    (b"+", Operator::Plus, 3),
    (b"-", Operator::Minus, 3),
    (b"eq", Operator::Equal, 2),
    (b"ne", Operator::Unequal, 2),
    (b"gt", Operator::Greater, 2),
    (b"ge", Operator::AtLeast, 2),
    (b"lt", Operator::Less, 2),
    (b"le", Operator::AtMost, 2),
    (b"and", Operator::And, 1),
    (b"or", Operator::Or, 1),
    (b"xor", Operator::Xor, 1),
];

impl Operator {
    pub(super) fn apply(self, left: f64, right: f64) -> Result<f64, String> {
        let (base, power) = (Short(left), Short(right));
        let truth = |value: bool| Ok(f64::from(u8::from(value)));
        let (is_left, is_right) = (left != 0.0, right != 0.0);
        match self {
            Self::Power if left < 0.0 && right.fract() != 0.0 => Err(format!(
                "{base} cannot be raised to {power}: a negative base needs an integer exponent"
            )),
            Self::Power => Ok(libm::pow(left, right)),
            Self::Times => Ok(left * right),
            Self::Over | Self::Modulo if right == 0.0 => Err(format!("{base} is divided by zero")),
            Self::Over => Ok(left / right),
            Self::Modulo => Ok(left.rem_euclid(right)),
            Self::Plus => Ok(left + right),
            Self::Minus => Ok(left - right),
            Self::Equal => truth((left - right).abs() < EQUAL_WITHIN),
            Self::Unequal => truth((left - right).abs() >= EQUAL_WITHIN),
            Self::Greater => truth(left > right),
            Self::AtLeast => truth(left >= right),
            Self::Less => truth(left < right),
            Self::AtMost => truth(left <= right),
            Self::And => truth(is_left && is_right),
            Self::Or => truth(is_left || is_right),
            Self::Xor => truth(is_left != is_right),
        }
    }
}

/// A function of one argument; what it cannot be of is said.
pub(super) fn apply_function(name: &[u8], x: f64) -> Result<f64, String> {
    let outside = |range: &str| {
        Err(format!(
            "{}[{}] does not exist: the argument must be {range}",
            String::from_utf8_lossy(name),
            Short(x)
        ))
    };
    match name {
        b"abs" => Ok(x.abs()),
        b"acos" | b"asin" if x.abs() > 1.0 => outside("between -1 and 1"),
        b"acos" => Ok(libm::acos(x).to_degrees()),
        b"asin" => Ok(libm::asin(x).to_degrees()),
        b"cos" => Ok(libm::cos(x.to_radians())),
        b"exp" => Ok(libm::exp(x)),
        b"fix" => Ok(x.floor()),
        b"fup" => Ok(x.ceil()),
        b"ln" if x <= 0.0 => outside("positive"),
        b"ln" => Ok(libm::log(x)),
        b"round" => Ok(x.round()),
        b"sin" => Ok(libm::sin(x.to_radians())),
        b"sqrt" if x < 0.0 => outside("zero or positive"),
        b"sqrt" => Ok(x.sqrt()),
        _ => Ok(libm::tan(x.to_radians())),
    }
}

/// Share of two values up to which Fanuc's macros count them as equal: rounding of a few sums.
const SAME_WITHIN: f64 = 1e-12;

/// A variable of Fanuc without a value counts as 0 in sums.
pub(super) const fn without_vacancy(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value }
}

impl Operator {
    /// Applies the operator as Fanuc macros do: a vacant variable equals only another vacant one;
    /// AND, OR and XOR join the bits of integers; values are equal up to the relative difference
    /// `SAME_WITHIN`.
    pub(super) fn apply_to_variables(self, left: f64, right: f64) -> Result<f64, String> {
        let truth = |value: bool| Ok(f64::from(u8::from(value)));
        let is_same = (left.is_nan() && right.is_nan())
            || (left - right).abs() <= SAME_WITHIN * left.abs().max(right.abs());
        let [left, right] = [left, right].map(without_vacancy);
        let bits =
            |join: fn(i64, i64) -> i64| Ok(join(left.round() as i64, right.round() as i64) as f64);
        match self {
            Self::Equal => truth(is_same),
            Self::Unequal => truth(!is_same),
            Self::And => bits(|left, right| left & right),
            Self::Or => bits(|left, right| left | right),
            Self::Xor => bits(|left, right| left ^ right),
            _ => self.apply(left, right),
        }
    }
}
