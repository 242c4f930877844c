//! The rest of what Rhai's maths package offers: conversions, properties, reading numbers from text.

use rhai::{EvalAltResult, FuncRegistration, Module, Position};

type Raised<T> = Result<T, Box<EvalAltResult>>;

fn wrong(message: String) -> Box<EvalAltResult> {
    Box::new(EvalAltResult::ErrorArithmetic(message, Position::NONE))
}

/// A float's whole part as an int.
fn to_int(x: f64) -> Raised<i64> {
    // 2^63 is a float, 2^63 - 1 is none: the upper end is left out.
    if (-9_223_372_036_854_775_808.0..9_223_372_036_854_775_808.0).contains(&x) {
        return Ok(x as i64);
    }
    if x.is_nan() {
        return Err(wrong("a whole number cannot be made of NaN".to_owned()));
    }
    Err(wrong(format!(
        "{x} is beyond the whole numbers, which end at 9223372036854775807"
    )))
}

fn parse_int(text: &str, radix: i64) -> Raised<i64> {
    let base = u32::try_from(radix).ok().filter(|r| (2..=36).contains(r));
    let base = base.ok_or_else(|| wrong(format!("a radix lies between 2 and 36, not at {radix}")))?;
    i64::from_str_radix(text.trim(), base)
        .map_err(|_| wrong(format!("{text:.60?} is no whole number of base {base}")))
}

fn parse_float(text: &str) -> Raised<f64> {
    text.trim()
        .parse()
        .map_err(|_| wrong(format!("{text:.60?} is no number")))
}

pub(super) fn extend(module: &mut Module) {
    macro_rules! define {
        ($($name:literal $f:expr;)*) => {
            $(FuncRegistration::new($name).set_into_module(module, $f);)*
        };
    }
    define! {
        "PI" || std::f64::consts::PI;
        "E" || std::f64::consts::E;
        "to_int" to_int;
        "to_int" |i: i64| i;
        "to_int" |c: char| i64::from(u32::from(c));
        "to_float" |i: i64| i as f64;
        "to_float" |x: f64| x;
        "to_radians" f64::to_radians;
        "to_radians" |i: i64| (i as f64).to_radians();
        "to_degrees" f64::to_degrees;
        "to_degrees" |i: i64| (i as f64).to_degrees();
        "parse_int" |s: &str| parse_int(s, 10);
        "parse_int" parse_int;
        "parse_float" parse_float;
        "ceiling" f64::ceil;
        "ceiling" |i: i64| i;
        "int" f64::trunc;
        "int" |i: i64| i;
        "fraction" f64::fract;
        "is_nan" f64::is_nan;
        "is_finite" f64::is_finite;
        "is_infinite" f64::is_infinite;
    }
    macro_rules! properties {
        ($($name:literal $f:expr;)*) => {$(FuncRegistration::new_getter($name).set_into_module(module, |x: &mut f64| $f(*x));)*};
    }
    properties! {
        "floor" f64::floor;
        "ceiling" f64::ceil;
        "round" f64::round;
        "int" f64::trunc;
        "fraction" f64::fract;
        "is_nan" f64::is_nan;
        "is_finite" f64::is_finite;
        "is_infinite" f64::is_infinite;
    }
}
