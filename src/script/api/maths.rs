//! Numbers: the functions of mathematics, with the same bits on every machine and for ints as for floats.
//!
//! They stand in the place of Rhai's own, which call std and differ from one system to the next.

use rhai::Dynamic;

use super::{
    number,
    vector::{LERP, lerp},
};
use crate::{
    math,
    script::{
        call::Call,
        power::power,
        table::{Entry, Group, Param},
        value::Outcome,
    },
};

const X: Param = number("x", "none", "a number");
const Y: Param = number("y", "none", "another");
const RADIANS: Param = number("x", "radians", "an angle");

/// A function of one number to a float.
macro_rules! unary {
    ($name:literal, $param:expr, $doc:literal, $usage:literal, $f:expr) => {
        Entry::pure(Group::Maths, $name, |call| {
            let x = call.any_number("x")?;
            call.end()?;
            Ok(Dynamic::from($f(x)))
        })
        .takes(&[&[$param]])
        .returns("float")
        .doc($doc)
        .usage($usage)
        .example(concat!("print(", $usage, ");"))
    };
}

/// A function of two numbers to a float.
macro_rules! binary {
    ($name:literal, [$a:expr, $b:expr], $doc:literal, $usage:literal, $f:expr) => {
        Entry::pure(Group::Maths, $name, |call| {
            let (a, b) = (call.any_number("x")?, call.any_number("y")?);
            call.end()?;
            Ok(Dynamic::from($f(a, b)))
        })
        .takes(&[&[$a, $b]])
        .returns("float")
        .doc($doc)
        .usage($usage)
        .example(concat!("print(", $usage, ");"))
    };
}

/// A function that gives an int for an int and a float for a float.
macro_rules! same_kind {
    ($name:literal, $doc:literal, $usage:literal, $int:expr, $float:expr) => {
        Entry::pure(Group::Maths, $name, |call| {
            if let Some(i) = call.peek().and_then(|d| d.as_int().ok()) {
                let result: Option<i64> = $int(i);
                return match result {
                    Some(i) => Ok(Dynamic::from(i)),
                    None => Err(call.error(format!("{i} has no such int"))),
                };
            }
            let x = call.any_number("x")?;
            call.end()?;
            Ok(Dynamic::from($float(x)))
        })
        .takes(&[&[X]])
        .returns("int | float")
        .doc($doc)
        .usage($usage)
        .example(concat!("print(", $usage, ");"))
    };
}

pub(super) const ENTRIES: &[Entry] = &[
    unary!(
        "sin",
        RADIANS,
        "Sine of an angle in radians.",
        "sin(PI / 2)",
        math::sin
    ),
    unary!(
        "cos",
        RADIANS,
        "Cosine of an angle in radians.",
        "cos(PI)",
        math::cos
    ),
    unary!(
        "tan",
        RADIANS,
        "Tangent of an angle in radians.",
        "tan(PI / 4)",
        math::tan
    ),
    unary!(
        "asin",
        X,
        "Arc sine in radians, of x from -1 to 1.",
        "asin(1)",
        math::asin
    ),
    unary!(
        "acos",
        X,
        "Arc cosine in radians, of x from -1 to 1.",
        "acos(0)",
        math::acos
    ),
    Entry::pure(Group::Maths, "atan", atan)
        .takes(&[
            &[X],
            &[
                number("y", "none", "the side opposite the angle"),
                number("x", "none", "the side beside the angle"),
            ],
        ])
        .returns("float")
        .doc("Arc tangent in radians; with two numbers the angle of the point (x, y), from -PI to PI.")
        .usage("atan(1, -1)")
        .example("print(atan(1));\nprint(atan(1, -1));"),
    binary!(
        "atan2",
        [
            number("y", "none", "the side opposite the angle"),
            number("x", "none", "the side beside the angle")
        ],
        "The angle of the point (x, y) in radians, from -PI to PI.",
        "atan2(1, -1)",
        math::atan2
    ),
    unary!("sinh", X, "Hyperbolic sine.", "sinh(1)", math::sinh),
    unary!("cosh", X, "Hyperbolic cosine.", "cosh(1)", math::cosh),
    unary!("tanh", X, "Hyperbolic tangent.", "tanh(1)", math::tanh),
    unary!("asinh", X, "Inverse hyperbolic sine.", "asinh(1)", math::asinh),
    unary!(
        "acosh",
        X,
        "Inverse hyperbolic cosine, of x at or above 1.",
        "acosh(2)",
        math::acosh
    ),
    unary!(
        "atanh",
        X,
        "Inverse hyperbolic tangent, of x between -1 and 1.",
        "atanh(0.5)",
        math::atanh
    ),
    unary!("sqrt", X, "Square root; NaN below 0.", "sqrt(2)", f64::sqrt),
    unary!("cbrt", X, "Cube root.", "cbrt(27)", math::cbrt),
    unary!("exp", X, "e to the power x.", "exp(1)", math::exp),
    unary!("ln", X, "Natural logarithm.", "ln(E)", math::ln),
    Entry::pure(Group::Maths, "log", log)
        .takes(&[&[X, number("base", "none", "the base of the logarithm").or("10")]])
        .returns("float")
        .doc("Logarithm to base 10, or to the base given.")
        .usage("log(8, 2)")
        .example("print(log(1000));\nprint(log(8, 2));"),
    unary!("log2", X, "Logarithm to base 2.", "log2(8)", math::log2),
    unary!("log10", X, "Logarithm to base 10.", "log10(1000)", math::log10),
    Entry::pure(Group::Maths, "pow", |call| {
        let (x, y) = (call.any()?, call.any()?);
        call.end()?;
        power(x, y)
    })
    .takes(&[&[X, number("y", "none", "the exponent")]])
    .returns("int | float")
    .doc("x to the power y, as x ** y.")
    .usage("pow(2, 10)")
    .example("print(pow(2, 0.5));\nprint(2 ** 10);"),
    binary!(
        "hypot",
        [X, Y],
        "Length of the hypotenuse over the sides x and y.",
        "hypot(3, 4)",
        math::hypot
    ),
    unary!(
        "radians",
        number("x", "degrees", "an angle"),
        "Degrees to radians.",
        "radians(180)",
        f64::to_radians
    )
    .also(&["deg2rad", "deg", "toRadians"]),
    unary!(
        "degrees",
        RADIANS,
        "Radians to degrees.",
        "degrees(PI)",
        f64::to_degrees
    )
    .also(&["rad2deg", "toDegrees"]),
    unary!(
        "smooth",
        X,
        "0 below 0, 1 above 1, and between them 3 x^2 - 2 x^3, without a corner.",
        "smooth(0.3)",
        smooth
    )
    .also(&["smoothstep", "ease"]),
    same_kind!(
        "abs",
        "The number without its sign.",
        "abs(-3)",
        i64::checked_abs,
        f64::abs
    ),
    Entry::pure(Group::Maths, "sign", |call| {
        let x = call.any_number("x")?;
        call.end()?;
        Ok(Dynamic::from(i64::from(x > 0.0) - i64::from(x < 0.0)))
    })
    .takes(&[&[X]])
    .returns("int")
    .doc("1 above 0, -1 below 0, and 0 for 0.")
    .usage("sign(-3.5)")
    .example("print(sign(-3.5));"),
    same_kind!(
        "floor",
        "The nearest whole number below.",
        "floor(2.7)",
        Some,
        f64::floor
    ),
    same_kind!(
        "ceil",
        "The nearest whole number above.",
        "ceil(2.2)",
        Some,
        f64::ceil
    )
    .also(&["ceiling"]),
    same_kind!(
        "round",
        "The nearest whole number, halves away from 0.",
        "round(2.5)",
        Some,
        f64::round
    ),
    Entry::pure(Group::Maths, "min", |call| extreme(call, i64::min, |a, b| a <= b))
        .takes(&[&[X, Y]])
        .returns("int | float")
        .doc("The smaller of two numbers.")
        .usage("min(1, 2)")
        .example("print(min(1, 2.5));"),
    Entry::pure(Group::Maths, "max", |call| extreme(call, i64::max, |a, b| a >= b))
        .takes(&[&[X, Y]])
        .returns("int | float")
        .doc("The greater of two numbers.")
        .usage("max(1, 2)")
        .example("print(max(1, 2.5));"),
    Entry::pure(Group::Maths, "clamp", clamp)
        .takes(&[&[
            X,
            number("least", "none", "what x is at least"),
            number("most", "none", "what x is at most"),
        ]])
        .returns("int | float")
        .doc("x, but not below least and not above most.")
        .usage("clamp(1.5, 0, 1)")
        .example("print(clamp(1.5, 0, 1));")
        .also(&["constrain", "limit"]),
    Entry::pure(Group::Maths, "lerp", lerp)
        .takes(LERP)
        .returns("float | vec3")
        .doc("From a to b as t goes from 0 to 1, for numbers and vectors; also a.lerp(b, t).")
        .usage("lerp(10, 20, 0.5)")
        .example("print(lerp(10, 20, 0.25));\nprint(lerp([0, 0, 0], [1, 2, 3], 0.5));")
        .also(&["interpolate"]),
    Entry::pure(Group::Maths, "mix", lerp)
        .takes(LERP)
        .returns("float | vec3")
        .doc("The same as lerp, under the name shading languages give it.")
        .usage("mix([1, 0, 0], [0, 0, 1], 0.5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..5 {\n  diffuse(mix([0.8, 0.1, 0.1], [0.1, 0.2, 0.8], i / 4.0));\n  sphere(i - 2, 0, 0, 0.45);\n}")
        .also(&["blend"]),
];

fn atan(call: &mut Call<'_, '_>) -> Outcome {
    let result = if call.len() == 1 {
        math::atan(call.any_number("x")?)
    } else {
        math::atan2(call.any_number("y")?, call.any_number("x")?)
    };
    call.end()?;
    Ok(Dynamic::from(result))
}

fn log(call: &mut Call<'_, '_>) -> Outcome {
    let x = call.any_number("x")?;
    let base = if call.rest() > 0 {
        call.any_number("base")?
    } else {
        10.0
    };
    call.end()?;
    // Base 2 and 10 have functions of their own, which are exact at whole powers.
    Ok(Dynamic::from(if base == 10.0 {
        math::log10(x)
    } else if base == 2.0 {
        math::log2(x)
    } else {
        math::ln(x) / math::ln(base)
    }))
}

fn smooth(x: f64) -> f64 {
    let x = if x > 0.0 { x.min(1.0) } else { 0.0 };
    x * x * (3.0 - 2.0 * x)
}

/// Ints as they are, where all of them are ints.
fn all_ints<const N: usize>(values: [&Dynamic; N]) -> Option<[i64; N]> {
    let mut ints = [0; N];
    for (to, from) in ints.iter_mut().zip(values) {
        *to = from.as_int().ok()?;
    }
    Some(ints)
}

/// The one of two numbers that is preferred: an int of ints, a float elsewhere, so that a quotient of the
/// result is no surprise.
fn extreme(
    call: &mut Call<'_, '_>,
    of_ints: fn(i64, i64) -> i64,
    of_floats: fn(f64, f64) -> bool,
) -> Outcome {
    let (a, b) = (call.any()?, call.any()?);
    call.end()?;
    if let Some([a, b]) = all_ints([a, b]) {
        return Ok(Dynamic::from(of_ints(a, b)));
    }
    let (x, y) = (call.number_like("x", a)?, call.number_like("y", b)?);
    Ok(Dynamic::from(if of_floats(x, y) { x } else { y }))
}

fn clamp(call: &mut Call<'_, '_>) -> Outcome {
    let (x, least, most) = (call.any()?, call.any()?, call.any()?);
    call.end()?;
    let (v, lo, hi) = (
        call.number_like("x", x)?,
        call.number_like("least", least)?,
        call.number_like("most", most)?,
    );
    if !(lo <= hi) {
        return Err(call.error(format!(
            "least must not exceed most, but {lo} is not at most {hi}"
        )));
    }
    if let Some([x, least, most]) = all_ints([x, least, most]) {
        return Ok(Dynamic::from(x.clamp(least, most)));
    }
    Ok(Dynamic::from(if v < lo {
        lo
    } else if v > hi {
        hi
    } else {
        v
    }))
}
