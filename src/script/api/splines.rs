//! Curves as values of the script.

use std::{fmt, sync::Arc};

use rhai::{Array, Dynamic, FuncRegistration, Module};

use super::{int, number};
use crate::{
    math::DVec3,
    script::{
        call::Call,
        lists::tuples,
        session::{State, limit},
        table::{Entry, Group, Kind, Param},
        value::Outcome,
    },
    spline::{self, Piece, Spline},
};

const POINTS: Param = Param::new("points", Kind::List, "units", "points, each of three numbers");
const CLOSED: Param =
    Param::new("closed", Kind::Any, "none", "true goes back to the first point").or("false");
const CURVE: Param = Param::new("curve", Kind::Curve, "none", "the curve");
const T: Param = number(
    "t",
    "none",
    "from 0 at the beginning to 1 at the end, every piece taking the same part of it",
);

pub(super) const ENTRIES: &[Entry] = &[
    Entry::pure(Group::Curves, "catmullRom", |call| curve(call, Spline::CatmullRom))
        .takes(&[&[POINTS, CLOSED]])
        .returns("curve")
        .doc("A smooth curve through all points. Its length in units is curve.length.")
        .usage("catmullRom([[0, 0, 0], [1, 2, 0], [3, 1, 0]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet points = [[-2, -1, 0], [-1, 1, 0], [0.4, 0.8, 0], [0.2, -1, 0], [2, -0.4, 0]];\nlet way = catmullRom(points);\ndiffuse(0.8, 0.25, 0.15);\nfor p in points { sphere(p, 0.17); }\ndiffuse(0.2, 0.3, 0.4);\nfor p in points(way, 60) { sphere(p, 0.06); }")
        .also(&["spline", "cubic_spline", "natural_spline", "curveVertex", "splinePoint"]),
    Entry::pure(Group::Curves, "bezier", |call| curve(call, Spline::Bezier))
        .takes(&[&[POINTS, CLOSED]])
        .returns("curve")
        .doc("Cubic Bezier curves one after another: a point on the curve, two that pull it, a point on the curve, and so on; 4 points, 7, 10. A closed one takes 3, 6, 9 and returns to the first.")
        .usage("bezier([[0, 0, 0], [0, 2, 0], [2, 2, 0], [2, 0, 0]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet pulls = [[-1.8, -1, 0], [-1.8, 2, 0], [1.8, 2, 0], [1.8, -1, 0]];\nlet arch = bezier(pulls);\ndiffuse(0.8, 0.25, 0.15);\nfor p in pulls { sphere(p, 0.1); }\ndiffuse(0.5, 0.45, 0.4);\nfor t in linspace(0, 1, 13) {\n  group {   // stones that stand across the curve\n    translate(arch.position(t)); alignTo(arch.tangent(t));\n    box(0.4, 0.3, 0.5);\n  }\n}")
        .also(&["bezierCurve", "bezierPoint", "bezierVertex", "cubicBezier"]),
    Entry::pure(Group::Curves, "polyline", |call| curve(call, Spline::Linear))
        .takes(&[&[POINTS, CLOSED]])
        .returns("curve")
        .doc("Straight from point to point.")
        .usage("polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet fence = polyline([[-1.5, 0, -1], [1.5, 0, -1], [1.5, 0, 1], [-1.5, 0, 1]], true);\ncamera([0, 4, 5], [0, 0, 0], [0, 1, 0], 35);\ndiffuse(0.7, 0.55, 0.35);\nfor p in points(fence, 41) {\n  group { translate(p); cylinder(0.05, 0.6); }\n}")
        .also(&["linear_spline", "path", "line"]),
    Entry::pure(Group::Curves, "position", position)
        .takes(&[&[CURVE, T]])
        .returns("vec3")
        .doc("The point of a curve at t; also curve.position(t).")
        .usage("curve.position(0.5)")
        .example("let curve = bezier([[0, 0, 0], [0, 2, 0], [2, 2, 0], [2, 0, 0]]);\nprint(curve.position(0.5));")
        .also(&["pointAt", "curvePoint", "evaluate"]),
    Entry::pure(Group::Curves, "tangent", tangent)
        .takes(&[&[CURVE, T]])
        .returns("vec3")
        .doc("The direction in which a curve goes at t, of length 1; also curve.tangent(t).")
        .usage("curve.tangent(0.5)")
        .example("let curve = bezier([[0, 0, 0], [0, 2, 0], [2, 2, 0], [2, 0, 0]]);\nprint(curve.tangent(0.5));")
        .also(&["direction", "curveTangent", "derivative"]),
    Entry::scene(Group::Curves, "points", points)
        .takes(&[&[CURVE, int("n", "none", "how many, at least 2")]])
        .returns("array")
        .doc("Points of a curve at even distances along it, from its beginning to its end; also curve.points(n).")
        .usage("curve.points(20)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet way = catmullRom([[-2, -1, 0], [-1.8, 1, 0], [-1.5, -1, 0], [2, 1, 0]]);\ndiffuse(0.8, 0.25, 0.15);\nfor p in way.points(40) { sphere(p, 0.08); }")
        .also(&["divide", "resample", "evenly", "getSpacedPoints"]),
];

/// A curve as scripts hold it.
#[derive(Clone, Debug)]
pub(in crate::script) struct CurveValue {
    kind: Spline,
    pieces: Arc<[Piece<3>]>,
}

impl fmt::Display for CurveValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} pieces", self.kind.name(), self.pieces.len())
    }
}

impl CurveValue {
    /// How long the curve is up to the end of each of [`PARTS`] parts of each piece.
    fn lengths(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let parts = self
            .pieces
            .iter()
            .flat_map(|piece| (0..PARTS).map(move |i| part_length(piece, f64::from(i) / f64::from(PARTS))));
        parts
            .map(|length| {
                sum += length;
                sum
            })
            .collect()
    }
}

/// Parts into which a piece is cut to be measured.
const PARTS: u32 = 16;

/// The length of a part of a piece from `u` on, by the rule of Gauss with three points, which is exact to the sixth order.
fn part_length(piece: &Piece<3>, u: f64) -> f64 {
    let speed = |x: f64| DVec3::from_array(piece.derivative(u + x / f64::from(PARTS))).length();
    let offset = 0.5 * 0.6f64.sqrt();
    (5.0 * speed(0.5 - offset) + 8.0 * speed(0.5) + 5.0 * speed(0.5 + offset)) / (18.0 * f64::from(PARTS))
}

fn curve(call: &mut Call<'_, '_>, kind: Spline) -> Outcome {
    let d = call.any()?;
    let points: Vec<[f64; 3]> = tuples(call, "points", d)?;
    let closed = match call.rest() {
        0 => false,
        _ => {
            let d = call.any()?;
            d.as_bool()
                .map_err(|_| call.wrong_kind("closed", "true or false", d))?
        }
    };
    call.end()?;
    let pieces = kind
        .pieces(&points, closed)
        .map_err(|wrong| call.error(format!("points must be {wrong}")))?;
    Ok(Dynamic::from(CurveValue {
        kind,
        pieces: pieces.into(),
    }))
}

/// The curve that a call names next.
fn given(call: &mut Call<'_, '_>) -> Outcome<CurveValue> {
    let d = call.any()?;
    let curve = d.read_lock::<CurveValue>().map(|curve| curve.clone());
    curve.ok_or_else(|| call.wrong_kind("curve", "a curve", d))
}

/// A curve and a place on it.
fn place(call: &mut Call<'_, '_>) -> Outcome<(CurveValue, f64)> {
    let (curve, t) = (given(call)?, call.number("t")?);
    call.end()?;
    Ok((curve, t))
}

fn position(call: &mut Call<'_, '_>) -> Outcome {
    let (curve, t) = place(call)?;
    let point = spline::position(&curve.pieces, t).unwrap_or_default();
    Ok(Dynamic::from(DVec3::from_array(point)))
}

fn tangent(call: &mut Call<'_, '_>) -> Outcome {
    let (curve, t) = place(call)?;
    let direction = DVec3::from_array(spline::tangent(&curve.pieces, t).unwrap_or_default());
    let length = direction.length();
    if !(length > 0.0 && length.is_finite()) {
        return Err(call.error("the curve goes nowhere there: its points fall together"));
    }
    Ok(Dynamic::from(direction / length))
}

fn points(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let curve = given(call)?;
    let n = call.count("n", 2)?;
    call.end()?;
    let most = state.limits.array_len;
    // Each point is three numbers, as limits count them.
    if n as usize > most {
        return Err(limit(
            &format!("a list of {n} points is too long"),
            "array_len",
            most,
        ));
    }
    let lengths = curve.lengths();
    let whole = lengths.last().copied().unwrap_or(0.0);
    let parts = f64::from(PARTS);
    let mut part = 0;
    let point = |i: u32| {
        let wanted = whole * (f64::from(i) / f64::from(n - 1));
        while part + 1 < lengths.len() && lengths.get(part).is_some_and(|end| *end < wanted) {
            part += 1;
        }
        let end = lengths.get(part).copied().unwrap_or(0.0);
        let start = part
            .checked_sub(1)
            .and_then(|i| lengths.get(i))
            .copied()
            .unwrap_or(0.0);
        let within = if end > start {
            (wanted - start) / (end - start)
        } else {
            0.0
        };
        let piece = curve.pieces.get(part / PARTS as usize);
        let u = (f64::from(part as u32 % PARTS) + within.clamp(0.0, 1.0)) / parts;
        let point = piece.map_or([0.0; 3], |piece| piece.position(u));
        Dynamic::from(DVec3::from_array(point))
    };
    Ok(Dynamic::from((0..n).map(point).collect::<Array>()))
}

/// Properties of curves.
pub(super) fn extend(module: &mut Module) {
    module.set_custom_type::<CurveValue>("curve");
    for name in ["to_string", "to_debug"] {
        FuncRegistration::new(name).set_into_module(module, |c: &mut CurveValue| c.to_string());
    }
    FuncRegistration::new_getter("length").set_into_module(module, |c: &mut CurveValue| {
        c.lengths().last().copied().unwrap_or(0.0)
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_those_of_circles_and_lines() {
        // The usual approximation of a quarter circle, whose length is off by less than 3e-4 of the circle's.
        let k = 0.552_284_749_8;
        let quarter = [[1.0, 0.0, 0.0], [1.0, k, 0.0], [k, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let of = |kind: Spline, points: &[[f64; 3]]| CurveValue {
            kind,
            pieces: kind.pieces(points, false).unwrap().into(),
        };
        let length = of(Spline::Bezier, &quarter).lengths()[15];
        // By adaptive quadrature to 15 digits elsewhere: 1.5709...
        assert!((length - std::f64::consts::FRAC_PI_2).abs() < 3e-4, "{length}");
        let chords: f64 = {
            let piece = of(Spline::Bezier, &quarter).pieces[0];
            let at = |i: i32| DVec3::from_array(piece.position(f64::from(i) / 20_000.0));
            (0..20_000).map(|i| at(i).distance(at(i + 1))).sum()
        };
        assert!((length - chords).abs() < 1e-8, "{length} {chords}");
        let corner = of(Spline::Linear, &[[0.0; 3], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]]);
        assert!((corner.lengths()[31] - 7.0).abs() < 1e-14);
    }
}
