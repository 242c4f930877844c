//! Fields: numbers that depend on the point, as flat programs.

use std::{
    collections::BTreeMap,
    fmt,
    ops::{Add, Div, Mul, Neg, Sub},
    sync::Arc,
};

use super::{
    scalar::Scalar,
    step::{Key, Step},
};
use crate::scene::SceneError;

/// A number that depends on the point, as an expression of its coordinates: `x * x + y * y - 1`.
///
/// It is a flat program without loops, of at most [`Field::MOST_STEPS`] steps; what several parts of an expression have
/// in common is calculated once. Operators make programs of programs; one that would grow beyond the limit is NaN
/// everywhere, which [`Isosurface::new`](super::Isosurface::new) refuses with the reason.
///
/// The square root and powers of negative numbers are 0.
///
/// ```
/// use rtscript::{DVec3, shape::Field};
/// let [x, y, z] = Field::point();
/// let ball = (x.square() + y.square() + z.square()).sqrt() - 1.0;
/// assert_eq!(ball.at(DVec3::new(3.0, 0.0, 4.0)), 4.0);
/// ```
#[derive(Clone, PartialEq)]
pub struct Field {
    steps: Arc<[Step]>,
}

impl fmt::Debug for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.steps.iter()).finish()
    }
}

/// Puts programs together.
#[derive(Default)]
struct Assembler {
    steps: Vec<Step>,
    known: BTreeMap<Key, u32>,
}

impl Assembler {
    /// The result of a step, which is added where there is none like it.
    fn step(&mut self, step: Step) -> u32 {
        let steps = &mut self.steps;
        *self.known.entry(step.key()).or_insert_with(|| {
            steps.push(step);
            steps.len() as u32 - 1
        })
    }

    /// The result of a program at the point whose coordinates are results.
    fn include(&mut self, field: &Field, point: Option<[u32; 3]>) -> u32 {
        let mut results: Vec<u32> = Vec::with_capacity(field.steps.len());
        for step in field.steps.iter() {
            let result = match (step, point) {
                (Step::Axis(i), Some(point)) => point.get(usize::from(*i)).copied().unwrap_or(0),
                _ => self.step(step.moved(|a| results.get(a as usize).copied().unwrap_or(0))),
            };
            results.push(result);
        }
        results.last().copied().unwrap_or(0)
    }

    fn finish(mut self, result: u32) -> Field {
        // What is made of something too long is too long.
        let is_none = |step: &Step| matches!(step, Step::Constant(x) if x.is_nan());
        if self.steps.len() > Field::MOST_STEPS || self.steps.iter().any(is_none) {
            return Field::constant(f64::NAN);
        }
        // The result stands last.
        if result as usize + 1 != self.steps.len() {
            let zero = self.step(Step::Constant(0.0));
            self.steps.push(Step::Add(result, zero));
        }
        Field {
            steps: self.steps.into(),
        }
    }
}

impl Field {
    /// Steps of the longest program.
    pub const MOST_STEPS: usize = 4096;

    /// The coordinates of the point.
    #[must_use]
    pub fn point() -> [Self; 3] {
        [0, 1, 2].map(|i| Self::of(Step::Axis(i)))
    }

    /// The same number everywhere.
    #[must_use]
    pub fn constant(x: f64) -> Self {
        Self::of(Step::Constant(x))
    }

    fn of(step: Step) -> Self {
        Self {
            steps: Arc::new([step]),
        }
    }

    /// The program as text, a step after the other: what [`Field::from_program`] reads back.
    #[must_use]
    pub fn program(&self) -> String {
        let steps: Vec<String> = self.steps.iter().map(|step| format!("{step:?}")).collect();
        steps.join("; ")
    }

    /// The field of a program's text.
    ///
    /// # Errors
    /// Where it is no program: a step is unknown, or takes the result of one that does not come before it.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Field};
    /// let [x, _, z] = Field::point();
    /// let text = x.hypot(&z).program();
    /// let read = Field::from_program(&text)?;
    /// assert_eq!(read.at(DVec3::new(3.0, 7.0, 4.0)), 5.0);
    /// // A step that there is not.
    /// assert!(Field::from_program("Guess(1)").is_err());
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn from_program(text: &str) -> Result<Self, SceneError> {
        let mut steps = Vec::new();
        for (i, text) in text.split("; ").enumerate() {
            let step = Step::read(text, steps.len()).ok_or_else(|| {
                SceneError::new(format!("step {i} of the field's program is none: {text:?}"))
            })?;
            if steps.len() == Self::MOST_STEPS {
                return Err(SceneError::limit(
                    "the field is too long a program",
                    "steps of a field",
                    Self::MOST_STEPS,
                ));
            }
            steps.push(step);
        }
        Ok(Self { steps: steps.into() })
    }

    pub(super) fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// How many steps it takes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Never: the shortest is a constant.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// The number, where it is the same everywhere.
    ///
    /// ```
    /// use rtscript::shape::Field;
    /// let [x, ..] = Field::point();
    /// assert_eq!(Field::constant(2.5).as_constant(), Some(2.5));
    /// assert_eq!(x.as_constant(), None);
    /// ```
    #[must_use]
    pub fn as_constant(&self) -> Option<f64> {
        match *self.steps {
            [Step::Constant(x)] => Some(x),
            _ => None,
        }
    }

    /// # Errors
    /// Where it is not a program of the length that is allowed.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        if self.as_constant().is_some_and(f64::is_nan) {
            return Err(SceneError::limit(
                "the field is too long an expression",
                "steps of a field",
                Self::MOST_STEPS,
            ));
        }
        Ok(())
    }

    fn one(&self, step: impl Fn(u32) -> Step) -> Self {
        let mut all = Assembler::default();
        let a = all.include(self, None);
        let result = all.step(step(a));
        all.finish(result)
    }

    fn two(&self, other: &Self, step: impl Fn(u32, u32) -> Step) -> Self {
        let mut all = Assembler::default();
        let a = all.include(self, None);
        let b = all.include(other, None);
        let result = all.step(step(a, b));
        all.finish(result)
    }

    /// The field of other points: `self` at the point with these coordinates.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Field};
    /// // What is at x + 1 comes to x: the field moves to the left.
    /// let [x, y, z] = Field::point();
    /// let wave = x.sin();
    /// let moved = wave.moved_to(&[&x + 1.0, y, z]);
    /// assert_eq!(moved.at(DVec3::ZERO), wave.at(DVec3::X));
    /// ```
    #[must_use]
    pub fn moved_to(&self, point: &[Self; 3]) -> Self {
        let mut all = Assembler::default();
        let at = [0, 1, 2].map(|i: usize| point.get(i).map_or(0, |field| all.include(field, None)));
        let result = all.include(self, Some(at));
        all.finish(result)
    }

    /// The square.
    #[must_use]
    pub fn square(&self) -> Self {
        self.one(Step::Square)
    }

    /// The size, without the sign.
    #[must_use]
    pub fn abs(&self) -> Self {
        self.one(Step::Abs)
    }

    /// The square root.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        self.one(Step::Sqrt)
    }

    /// The sine of an angle in radians.
    #[must_use]
    pub fn sin(&self) -> Self {
        self.one(Step::Sin)
    }

    /// The cosine of an angle in radians.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Field};
    /// // The gyroid, of which Sdf::gyroid is the wall.
    /// let [x, y, z] = Field::point();
    /// let gyroid = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
    /// assert_eq!(gyroid.at(DVec3::ZERO), 0.0);
    /// ```
    #[must_use]
    pub fn cos(&self) -> Self {
        self.one(Step::Cos)
    }

    /// To the power of a number: products for whole ones up to 64, which also take negative fields.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Field};
    /// let [x, ..] = Field::point();
    /// assert_eq!(x.pow(3.0).at(DVec3::X * -2.0), -8.0);
    /// // A root of what is negative is 0.
    /// assert_eq!(x.pow(0.5).at(DVec3::X * -2.0), 0.0);
    /// ```
    #[must_use]
    pub fn pow(&self, exponent: f64) -> Self {
        if exponent < 0.0 {
            return Self::constant(1.0) / self.pow(-exponent);
        }
        if exponent > 64.0 || exponent != exponent.trunc() {
            return self.one(|a| Step::Pow(a, exponent));
        }
        let mut rest = exponent as u32;
        let (mut result, mut power) = (None, self.clone());
        while rest > 0 {
            if rest % 2 == 1 {
                result = Some(result.map_or_else(|| power.clone(), |r: Self| r * &power));
            }
            power = power.square();
            rest /= 2;
        }
        result.unwrap_or_else(|| Self::constant(1.0))
    }

    /// The lesser of both.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Field};
    /// // Above a floor with a step in it: the lesser of two heights above ground.
    /// let [x, y, _] = Field::point();
    /// let ground = y.min(&x.max(&(&y - 1.0)));
    /// assert_eq!(ground.at(DVec3::new(-1.0, 3.0, 0.0)), 2.0);
    /// assert_eq!(ground.at(DVec3::new(5.0, 3.0, 0.0)), 3.0);
    /// ```
    #[must_use]
    pub fn min(&self, other: &Self) -> Self {
        self.two(other, Step::Min)
    }

    /// The greater of both.
    #[must_use]
    pub fn max(&self, other: &Self) -> Self {
        self.two(other, Step::Max)
    }

    /// The root of the sum of the squares of both: a length, of which bounds are known better than of its parts.
    #[must_use]
    pub fn hypot(&self, other: &Self) -> Self {
        self.two(other, Step::Hypot)
    }

    /// How far it is from the nearest whole multiple of `period`, with sign; of those at most `most` periods from 0.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Field};
    /// // A row of walls at x = -4, -2, 0, 2 and 4, none beyond.
    /// let [x, ..] = Field::point();
    /// let walls = x.wrap(2.0, 2.0).abs() - 0.1;
    /// let is_wall = |x| walls.at(DVec3::X * x) < 0.0;
    /// assert!(is_wall(-4.0) && is_wall(2.05) && !is_wall(1.0) && !is_wall(6.0));
    /// ```
    #[must_use]
    pub fn wrap(&self, period: f64, most: f64) -> Self {
        self.one(|a| Step::Wrap(a, period, most))
    }

    /// Gradient noise at the point with these coordinates, between -1 and 1, as the function `noise` of scripts has it.
    ///
    /// ```
    /// use rtscript::{DVec3, shape::Field};
    /// // Hills that are four units across and up to one high.
    /// let [x, y, z] = Field::point();
    /// let hills = y - Field::noise(&[x * 0.25, Field::constant(0.0), z * 0.25]);
    /// let at = |y| hills.at(DVec3::new(1.0, y, 2.0));
    /// assert!(at(-1.1) < 0.0 && at(1.1) > 0.0);
    /// ```
    #[must_use]
    pub fn noise(point: &[Self; 3]) -> Self {
        let mut all = Assembler::default();
        let [a, b, c] = [0, 1, 2].map(|i: usize| point.get(i).map_or(0, |field| all.include(field, None)));
        let result = all.step(Step::Noise(a, b, c));
        all.finish(result)
    }

    /// Its value at a point.
    #[must_use]
    pub fn at(&self, p: crate::math::DVec3) -> f64 {
        self.run(p.to_array(), &mut Vec::new())
    }

    /// Its value in numbers of any kind; `results` is memory to be used again.
    pub(super) fn run<T: Scalar>(&self, point: [T; 3], results: &mut Vec<T>) -> T {
        results.clear();
        results.reserve(self.steps.len());
        let mut last = T::constant(0.0);
        for step in self.steps.iter() {
            let of = |i: u32| results.get(i as usize).copied().unwrap_or(last);
            last = match *step {
                Step::Axis(i) => point.get(usize::from(i)).copied().unwrap_or(last),
                Step::Constant(x) => T::constant(x),
                Step::Neg(a) => of(a).neg(),
                Step::Abs(a) => of(a).abs(),
                Step::Sqrt(a) => of(a).sqrt(),
                Step::Square(a) => of(a).square(),
                Step::Sin(a) => of(a).sin(),
                Step::Cos(a) => of(a).cos(),
                Step::Pow(a, e) => of(a).pow(e),
                Step::Wrap(a, p, n) => of(a).wrap(p, n),
                Step::Add(a, b) => of(a).add(of(b)),
                Step::Sub(a, b) => of(a).sub(of(b)),
                Step::Mul(a, b) => of(a).mul(of(b)),
                Step::Div(a, b) => of(a).div(of(b)),
                Step::Min(a, b) => of(a).min(of(b)),
                Step::Max(a, b) => of(a).max(of(b)),
                Step::Hypot(a, b) => of(a).hypot(of(b)),
                Step::Noise(a, b, c) => T::noise([of(a), of(b), of(c)]),
            };
            results.push(last);
        }
        last
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident)*) => {
        $(
            impl $trait<&Field> for &Field {
                type Output = Field;
                fn $method(self, other: &Field) -> Field {
                    self.two(other, Step::$trait)
                }
            }
            impl $trait for Field {
                type Output = Field;
                fn $method(self, other: Field) -> Field {
                    (&self).$method(&other)
                }
            }
            impl $trait<&Field> for Field {
                type Output = Field;
                fn $method(self, other: &Field) -> Field {
                    (&self).$method(other)
                }
            }
            impl $trait<f64> for Field {
                type Output = Field;
                fn $method(self, other: f64) -> Field {
                    (&self).$method(&Field::constant(other))
                }
            }
            impl $trait<f64> for &Field {
                type Output = Field;
                fn $method(self, other: f64) -> Field {
                    self.$method(&Field::constant(other))
                }
            }
        )*
    };
}

operators! { Add add Sub sub Mul mul Div div }

impl Neg for &Field {
    type Output = Field;
    fn neg(self) -> Field {
        self.one(Step::Neg)
    }
}

impl Neg for Field {
    type Output = Field;
    fn neg(self) -> Field {
        -&self
    }
}
