//! A field as rays evaluate it: constants folded into the operations, and in a part of space without what cannot matter
//! there.
//!
//! Where intervals prove that one side of a minimum, maximum or blend always wins, the other is left out (Keeter,
//! "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces", 2020). What is left out changes no bit of any
//! value in that part: only choices between numbers are made in advance, and operations on constants done.

#![allow(
    clippy::indexing_slicing,
    reason = "operations take results of those before them, which are as many as the memory is made for"
)]

use super::{
    field::Field,
    interval::Interval,
    scalar::{Scalar, Slope, cell},
    step::Step,
};

/// What an operation does with the results `a`, `b`, `c` and the numbers `x`, `y`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Code {
    Constant,
    Neg,
    Abs,
    Sqrt,
    Square,
    Sin,
    Cos,
    Pow,
    Wrap,
    Noise,
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    Hypot,
    AddX,
    SubX,
    XSub,
    MulX,
    DivX,
    XDiv,
    MinX,
    MaxX,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Op {
    code: Code,
    a: u16,
    b: u16,
    c: u16,
    x: f64,
    y: f64,
}

impl Op {
    /// How many results it takes.
    fn arity(&self) -> usize {
        match self.code {
            Code::Constant => 0,
            Code::Noise => 3,
            Code::Add | Code::Sub | Code::Mul | Code::Div | Code::Min | Code::Max | Code::Hypot => 2,
            _ => 1,
        }
    }

    fn arguments(&mut self) -> impl Iterator<Item = &mut u16> {
        let arity = self.arity();
        [&mut self.a, &mut self.b, &mut self.c].into_iter().take(arity)
    }
}

/// Results that are there from the beginning: the coordinates.
const AXES: usize = 3;

/// A straight program. The coordinates of the point are results 0 to 2, and those of the operations follow.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tape {
    ops: Box<[Op]>,
    /// Which result is the value.
    result: u16,
}

/// What is known of a result while a tape is made.
#[derive(Clone, Copy)]
enum Value {
    Result(u16),
    Constant(f64),
}

/// A tape that is being made.
#[derive(Default)]
struct Maker {
    ops: Vec<Op>,
}

impl Maker {
    fn push(&mut self, code: Code, [a, b, c]: [u16; 3], [x, y]: [f64; 2]) -> Value {
        self.ops.push(Op { code, a, b, c, x, y });
        Value::Result((self.ops.len() - 1 + AXES) as u16)
    }

    /// A value as a result.
    fn result(&mut self, value: Value) -> u16 {
        match value {
            Value::Result(a) => a,
            Value::Constant(x) => match self.push(Code::Constant, [0; 3], [x, 0.0]) {
                Value::Result(a) => a,
                Value::Constant(_) => 0,
            },
        }
    }

    fn one(&mut self, code: Code, a: Value, numbers: [f64; 2]) -> Value {
        match a {
            Value::Result(a) => self.push(code, [a, 0, 0], numbers),
            Value::Constant(x) => {
                let [y, z] = numbers;
                Value::Constant(match code {
                    Code::Neg => Scalar::neg(x),
                    Code::Abs => Scalar::abs(x),
                    Code::Sqrt => Scalar::sqrt(x),
                    Code::Square => Scalar::square(x),
                    Code::Sin => Scalar::sin(x),
                    Code::Cos => Scalar::cos(x),
                    Code::Pow => Scalar::pow(x, y),
                    Code::Wrap => Scalar::wrap(x, y, z),
                    _ => x,
                })
            }
        }
    }

    fn two(&mut self, code: Code, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(a), Value::Constant(b)) => Value::Constant(match code {
                Code::Add => a + b,
                Code::Sub => a - b,
                Code::Mul => a * b,
                Code::Div => a / b,
                Code::Min => Scalar::min(a, b),
                Code::Max => Scalar::max(a, b),
                _ => Scalar::hypot(a, b),
            }),
            (Value::Result(a), Value::Constant(x)) => {
                // Only what leaves every bit as it is.
                let is_idle = match code {
                    Code::Sub => x.to_bits() == 0,
                    Code::Mul | Code::Div => x == 1.0,
                    _ => false,
                };
                let code = match code {
                    _ if is_idle => return Value::Result(a),
                    Code::Add => Code::AddX,
                    Code::Sub => Code::SubX,
                    Code::Mul => Code::MulX,
                    Code::Div => Code::DivX,
                    Code::Min => Code::MinX,
                    Code::Max => Code::MaxX,
                    _ => {
                        let b = self.result(Value::Constant(x));
                        return self.push(code, [a, b, 0], [0.0; 2]);
                    }
                };
                self.push(code, [a, 0, 0], [x, 0.0])
            }
            (Value::Constant(x), Value::Result(b)) => {
                // Sums and products are the same either way around; which of two equal ends of a minimum is taken is not.
                let code = match code {
                    Code::Add => Code::AddX,
                    Code::Mul if x == 1.0 => return Value::Result(b),
                    Code::Mul => Code::MulX,
                    Code::Sub => Code::XSub,
                    Code::Div => Code::XDiv,
                    _ => {
                        let a = self.result(Value::Constant(x));
                        return self.push(code, [a, b, 0], [0.0; 2]);
                    }
                };
                self.push(code, [b, 0, 0], [x, 0.0])
            }
            (Value::Result(a), Value::Result(b)) => self.push(code, [a, b, 0], [0.0; 2]),
        }
    }

    fn noise(&mut self, p: [Value; 3]) -> Value {
        if let [Value::Constant(x), Value::Constant(y), Value::Constant(z)] = p {
            return Value::Constant(Scalar::noise([x, y, z]));
        }
        let p = p.map(|value| self.result(value));
        self.push(Code::Noise, p, [0.0; 2])
    }

    /// The tape of a value, without what it does not need.
    fn finish(mut self, value: Value) -> Tape {
        let result = usize::from(self.result(value));
        let mut needed = vec![false; self.ops.len() + AXES];
        needed[result] = true;
        for (i, op) in self.ops.iter_mut().enumerate().rev() {
            if needed[i + AXES] {
                op.arguments().for_each(|a| needed[usize::from(*a)] = true);
            }
        }
        let mut moved: Vec<u16> = (0..needed.len() as u16).collect();
        let mut ops = Vec::with_capacity(self.ops.len());
        for (i, mut op) in self.ops.into_iter().enumerate() {
            if needed[i + AXES] {
                op.arguments().for_each(|a| *a = moved[usize::from(*a)]);
                moved[i + AXES] = (ops.len() + AXES) as u16;
                ops.push(op);
            }
        }
        Tape {
            ops: ops.into(),
            result: moved[result],
        }
    }
}

impl Tape {
    pub(super) fn new(field: &Field) -> Self {
        let mut maker = Maker::default();
        let mut values: Vec<Value> = Vec::with_capacity(field.len());
        for step in field.steps() {
            let of = |i: u32| values.get(i as usize).copied().unwrap_or(Value::Constant(0.0));
            let mut one = |code, a| maker.one(code, of(a), [0.0; 2]);
            let value = match *step {
                Step::Axis(i) => Value::Result(u16::from(i)),
                Step::Constant(x) => Value::Constant(x),
                Step::Neg(a) => one(Code::Neg, a),
                Step::Abs(a) => one(Code::Abs, a),
                Step::Sqrt(a) => one(Code::Sqrt, a),
                Step::Square(a) => one(Code::Square, a),
                Step::Sin(a) => one(Code::Sin, a),
                Step::Cos(a) => one(Code::Cos, a),
                Step::Pow(a, e) => maker.one(Code::Pow, of(a), [e, 0.0]),
                Step::Wrap(a, p, n) => maker.one(Code::Wrap, of(a), [p, n]),
                Step::Add(a, b) => maker.two(Code::Add, of(a), of(b)),
                Step::Sub(a, b) => maker.two(Code::Sub, of(a), of(b)),
                Step::Mul(a, b) => maker.two(Code::Mul, of(a), of(b)),
                Step::Div(a, b) => maker.two(Code::Div, of(a), of(b)),
                Step::Min(a, b) => maker.two(Code::Min, of(a), of(b)),
                Step::Max(a, b) => maker.two(Code::Max, of(a), of(b)),
                Step::Hypot(a, b) => maker.two(Code::Hypot, of(a), of(b)),
                Step::Noise(a, b, c) => maker.noise([of(a), of(b), of(c)]),
            };
            values.push(value);
        }
        let value = values.last().copied().unwrap_or(Value::Constant(0.0));
        maker.finish(value)
    }

    /// How many operations it takes.
    pub(super) fn len(&self) -> usize {
        self.ops.len()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.ops)
    }

    /// Its value in numbers of any kind; `results` is memory to be used again, and holds all results afterwards.
    pub(super) fn run<T: Scalar>(&self, point: [T; 3], results: &mut Vec<T>) -> T {
        let count = self.ops.len() + AXES;
        if results.len() < count {
            results.resize(count, T::constant(0.0));
        }
        let results = &mut results[..count];
        results[..AXES].copy_from_slice(&point);
        for (i, op) in self.ops.iter().enumerate() {
            let a = results[usize::from(op.a)];
            let b = || results[usize::from(op.b)];
            let x = op.x;
            let value = match op.code {
                Code::Constant => T::constant(x),
                Code::Neg => a.neg(),
                Code::Abs => a.abs(),
                Code::Sqrt => a.sqrt(),
                Code::Square => a.square(),
                Code::Sin => a.sin(),
                Code::Cos => a.cos(),
                Code::Pow => a.pow(x),
                Code::Wrap => a.wrap(x, op.y),
                Code::Noise => T::noise([a, b(), results[usize::from(op.c)]]),
                Code::Add => a.add(b()),
                Code::Sub => a.sub(b()),
                Code::Mul => a.mul(b()),
                Code::Div => a.div(b()),
                Code::Min => a.min(b()),
                Code::Max => a.max(b()),
                Code::Hypot => a.hypot(b()),
                Code::AddX => a.add_constant(x),
                Code::SubX => a.sub_constant(x),
                Code::XSub => T::constant(x).sub(a),
                Code::MulX => a.mul_constant(x),
                Code::DivX => a.div_constant(x),
                Code::XDiv => T::constant(x).div(a),
                Code::MinX => a.min(T::constant(x)),
                Code::MaxX => a.max(T::constant(x)),
            };
            results[i + AXES] = value;
        }
        results[usize::from(self.result)]
    }

    /// The tape for the part of space in which `results` are those of its operations; `None` where nothing can be left
    /// out.
    pub(super) fn within<const N: usize>(&self, results: &[Slope<N>]) -> Option<Self> {
        let mut maker = Maker::default();
        let mut values: Vec<Value> = (0..AXES as u16).map(Value::Result).collect();
        // Whether a result is made of numbers with bounds only, so that none of them is NaN.
        let mut sound: Vec<bool> = vec![true; AXES];
        let mut has_changed = false;
        for (i, mut op) in self.ops.iter().copied().enumerate() {
            let (a, b) = (usize::from(op.a), usize::from(op.b));
            let bounds = |i: usize| results[i].v;
            let own = bounds(i + AXES);
            let is_sound = own.width() < f64::INFINITY && op.arguments().all(|a| sound[usize::from(*a)]);
            let choice = if is_sound {
                choice(&op, bounds)
            } else {
                Choice::None
            };
            has_changed |= choice != Choice::None;
            let x = Value::Constant(op.x);
            let (a, b) = (values[a], values[b]);
            let value = match (choice, op.code) {
                (Choice::First, _) => a,
                (Choice::Second, Code::MinX | Code::MaxX) => x,
                (Choice::Second, _) => b,
                (Choice::Negated, _) => maker.one(Code::Neg, a, [0.0; 2]),
                (Choice::Less(by), _) => maker.two(Code::Sub, a, Value::Constant(by)),
                (_, Code::Constant) => x,
                (_, Code::Noise) => maker.noise([a, b, values[usize::from(op.c)]]),
                (_, Code::AddX) => maker.two(Code::Add, a, x),
                (_, Code::SubX) => maker.two(Code::Sub, a, x),
                (_, Code::XSub) => maker.two(Code::Sub, x, a),
                (_, Code::MulX) => maker.two(Code::Mul, a, x),
                (_, Code::DivX) => maker.two(Code::Div, a, x),
                (_, Code::XDiv) => maker.two(Code::Div, x, a),
                (_, Code::MinX) => maker.two(Code::Min, a, x),
                (_, Code::MaxX) => maker.two(Code::Max, a, x),
                (_, code) if op.arity() == 2 => maker.two(code, a, b),
                (_, code) => maker.one(code, a, [op.x, op.y]),
            };
            values.push(value);
            sound.push(is_sound);
        }
        has_changed.then(|| maker.finish(values[usize::from(self.result)]))
    }
}

/// What an operation comes to in a part of space.
#[derive(Clone, Copy, PartialEq)]
enum Choice {
    /// Itself.
    None,
    /// The first of what it takes, or the other, which may be a number.
    First,
    Second,
    /// The first, with the other sign, or less by a number.
    Negated,
    Less(f64),
}

/// What the bounds of what an operation takes tell of it.
fn choice(op: &Op, bounds: impl Fn(usize) -> Interval) -> Choice {
    let left = bounds(usize::from(op.a));
    let one_of = |first: bool, second: bool| match (first, second) {
        (true, _) => Choice::First,
        (_, true) => Choice::Second,
        _ => Choice::None,
    };
    let right = || bounds(usize::from(op.b));
    match op.code {
        Code::Min => one_of(left.hi < right().lo, right().hi < left.lo),
        Code::Max => one_of(left.lo > right().hi, right().lo > left.hi),
        Code::MinX => one_of(left.hi < op.x, op.x < left.lo),
        Code::MaxX => one_of(left.lo > op.x, op.x > left.hi),
        Code::Abs if left.lo > 0.0 => Choice::First,
        Code::Abs if left.hi < 0.0 => Choice::Negated,
        Code::Wrap => {
            let [lo, hi] = [left.lo, left.hi].map(|x| cell(x, op.x, op.y));
            if lo == hi {
                Choice::Less(op.x * lo)
            } else {
                Choice::None
            }
        }
        _ => Choice::None,
    }
}
