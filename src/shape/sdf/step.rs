//! The steps of a field's program: what they are, as text, and what tells them apart.

use std::fmt;

/// A step of a program; what it takes are results of steps before it.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Step {
    /// A coordinate of the point.
    Axis(u8),
    Constant(f64),
    Neg(u32),
    Abs(u32),
    Sqrt(u32),
    Square(u32),
    Sin(u32),
    Cos(u32),
    Pow(u32, f64),
    /// See [`Scalar::wrap`](super::scalar::Scalar::wrap): period, most periods from 0.
    Wrap(u32, f64, f64),
    Add(u32, u32),
    Sub(u32, u32),
    Mul(u32, u32),
    Div(u32, u32),
    Min(u32, u32),
    Max(u32, u32),
    /// The root of the sum of both squares.
    Hypot(u32, u32),
    Noise(u32, u32, u32),
}

/// What tells steps apart, to the bit.
pub(super) type Key = (u8, u64, u64, u64);

impl Step {
    pub(super) fn key(self) -> Key {
        let int = u64::from;
        match self {
            Self::Axis(i) => (0, u64::from(i), 0, 0),
            Self::Constant(x) => (1, x.to_bits(), 0, 0),
            Self::Neg(a) => (2, int(a), 0, 0),
            Self::Abs(a) => (3, int(a), 0, 0),
            Self::Sqrt(a) => (4, int(a), 0, 0),
            Self::Square(a) => (5, int(a), 0, 0),
            Self::Sin(a) => (6, int(a), 0, 0),
            Self::Cos(a) => (7, int(a), 0, 0),
            Self::Pow(a, e) => (8, int(a), e.to_bits(), 0),
            Self::Wrap(a, p, n) => (9, int(a), p.to_bits(), n.to_bits()),
            Self::Add(a, b) => (10, int(a), int(b), 0),
            Self::Sub(a, b) => (11, int(a), int(b), 0),
            Self::Mul(a, b) => (12, int(a), int(b), 0),
            Self::Div(a, b) => (13, int(a), int(b), 0),
            Self::Min(a, b) => (14, int(a), int(b), 0),
            Self::Max(a, b) => (15, int(a), int(b), 0),
            Self::Hypot(a, b) => (17, int(a), int(b), 0),
            Self::Noise(a, b, c) => (16, int(a), int(b), int(c)),
        }
    }

    /// The same step on other results.
    pub(super) fn moved(self, to: impl Fn(u32) -> u32) -> Self {
        match self {
            Self::Axis(_) | Self::Constant(_) => self,
            Self::Neg(a) => Self::Neg(to(a)),
            Self::Abs(a) => Self::Abs(to(a)),
            Self::Sqrt(a) => Self::Sqrt(to(a)),
            Self::Square(a) => Self::Square(to(a)),
            Self::Sin(a) => Self::Sin(to(a)),
            Self::Cos(a) => Self::Cos(to(a)),
            Self::Pow(a, e) => Self::Pow(to(a), e),
            Self::Wrap(a, p, n) => Self::Wrap(to(a), p, n),
            Self::Add(a, b) => Self::Add(to(a), to(b)),
            Self::Sub(a, b) => Self::Sub(to(a), to(b)),
            Self::Mul(a, b) => Self::Mul(to(a), to(b)),
            Self::Div(a, b) => Self::Div(to(a), to(b)),
            Self::Min(a, b) => Self::Min(to(a), to(b)),
            Self::Max(a, b) => Self::Max(to(a), to(b)),
            Self::Hypot(a, b) => Self::Hypot(to(a), to(b)),
            Self::Noise(a, b, c) => Self::Noise(to(a), to(b), to(c)),
        }
    }
}

impl Step {
    /// A step from its text, which may take the results of `before` others.
    pub(super) fn read(text: &str, before: usize) -> Option<Self> {
        let mut words = text.split(' ');
        let name = words.next()?;
        let arguments: Vec<&str> = words.collect();
        let result = |i: usize| {
            let index: u32 = arguments.get(i)?.parse().ok()?;
            ((index as usize) < before).then_some(index)
        };
        let number = |i: usize| arguments.get(i)?.parse::<f64>().ok();
        let count = match name {
            "p0" | "p1" | "p2" => 0,
            "neg" | "abs" | "sqrt" | "square" | "sin" | "cos" => 1,
            "wrap" | "noise" => 3,
            "pow" | "add" | "sub" | "mul" | "div" | "min" | "max" | "hypot" => 2,
            _ => 0,
        };
        if arguments.len() != count {
            return None;
        }
        Some(match name {
            "p0" => Self::Axis(0),
            "p1" => Self::Axis(1),
            "p2" => Self::Axis(2),
            "neg" => Self::Neg(result(0)?),
            "abs" => Self::Abs(result(0)?),
            "sqrt" => Self::Sqrt(result(0)?),
            "square" => Self::Square(result(0)?),
            "sin" => Self::Sin(result(0)?),
            "cos" => Self::Cos(result(0)?),
            "pow" => Self::Pow(result(0)?, number(1)?),
            "wrap" => Self::Wrap(result(0)?, number(1)?, number(2)?),
            "add" => Self::Add(result(0)?, result(1)?),
            "sub" => Self::Sub(result(0)?, result(1)?),
            "mul" => Self::Mul(result(0)?, result(1)?),
            "div" => Self::Div(result(0)?, result(1)?),
            "min" => Self::Min(result(0)?, result(1)?),
            "max" => Self::Max(result(0)?, result(1)?),
            "hypot" => Self::Hypot(result(0)?, result(1)?),
            "noise" => Self::Noise(result(0)?, result(1)?, result(2)?),
            constant => Self::Constant(constant.parse().ok()?),
        })
    }
}

impl fmt::Debug for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Axis(i) => write!(f, "p{i}"),
            Self::Constant(x) => write!(f, "{x:?}"),
            Self::Neg(a) => write!(f, "neg {a}"),
            Self::Abs(a) => write!(f, "abs {a}"),
            Self::Sqrt(a) => write!(f, "sqrt {a}"),
            Self::Square(a) => write!(f, "square {a}"),
            Self::Sin(a) => write!(f, "sin {a}"),
            Self::Cos(a) => write!(f, "cos {a}"),
            Self::Pow(a, e) => write!(f, "pow {a} {e:?}"),
            Self::Wrap(a, p, n) => write!(f, "wrap {a} {p:?} {n:?}"),
            Self::Add(a, b) => write!(f, "add {a} {b}"),
            Self::Sub(a, b) => write!(f, "sub {a} {b}"),
            Self::Mul(a, b) => write!(f, "mul {a} {b}"),
            Self::Div(a, b) => write!(f, "div {a} {b}"),
            Self::Min(a, b) => write!(f, "min {a} {b}"),
            Self::Max(a, b) => write!(f, "max {a} {b}"),
            Self::Hypot(a, b) => write!(f, "hypot {a} {b}"),
            Self::Noise(a, b, c) => write!(f, "noise {a} {b} {c}"),
        }
    }
}
