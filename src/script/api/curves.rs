//! Tubes along curves.

use std::sync::Arc;

use rhai::Array;

use super::{heights::made, map};
use crate::{
    math::DVec3,
    scene::SceneError,
    script::{
        call::{Call, number_of},
        lists::{number, tuples},
        options::Options,
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
    tessellate::{Curve, CurveEnd, CurveKind},
};

const KEYS: [&str; 5] = ["closed", "ends", "kind", "sides", "tolerance"];

pub(super) const ENTRIES: &[Entry] = &[Entry::scene(Group::Assets, "curve", curve)
    .takes(&[&[
        Param::new("points", Kind::List, "object units", "points of the curve"),
        Param::new("radius", Kind::Any, "object units", "one number, or an array of one for each point; greater than 0"),
        map(
            "options",
            "kind: \"catmullRom\", through all points; \"bezier\", a point, two that pull, a point and so on; or \"linear\"; closed: whether it leads back to its beginning, false; ends: \"round\" or \"flat\"; sides: 12; tolerance: how far its middle may be off the curve, a tenth of the smallest radius",
        )
        .or("#{ }")
        .keys(&KEYS),
    ]])
    .doc("A tube along a smooth curve, as thick as wires, branches or hairs are, its radius changing as smoothly. It is closed by its ends, so it may be glass. Made of triangles with smooth normals: few sides are enough where it is thin.")
    .usage("curve([[0, 0, 0], [1, 1, 0], [2, 0, 0]], 0.1)")
    .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.85, 0.4, 0.2);\nlet points = []; let radii = [];\nfor i in 0..25 {                  // a horn\n  let a = 0.55 * i;\n  let r = 1.5 - 0.045 * i;\n  points.push([r * cos(a), 0.11 * i - 1.4, r * sin(a)]);\n  radii.push(0.32 - 0.012 * i);\n}\ncurve(points, radii);\ndiffuse(0.2, 0.5, 0.3);\nfor k in 0..40 {                  // grass\n  let x = -2 + 0.1 * k;\n  curve([[x, -1.6, 1.2], [x + 0.05, -1.1, 1.2], [x + 0.3 * sin(9.0 * k), -0.8, 1.3]], [0.03, 0.02, 0.003], #{ sides: 4 });\n}")
    .also(&["tube", "sphere_sweep", "spline", "hair", "wire", "sweep", "path", "rope"])];

fn curve(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let radius = call.any()?;
    let options = match call.rest() {
        0 => None,
        _ => Some(call.any()?),
    };
    call.end()?;
    let options = Options::new(call, options, &KEYS)?;
    let points: Vec<DVec3> = tuples::<3>(call, "points", given)?
        .into_iter()
        .map(DVec3::from_array)
        .collect();
    let radii = if let Some(array) = radius.read_lock::<Array>() {
        let numbers = array.iter().enumerate();
        numbers
            .map(|(i, d)| number(call, || format!("radius[{i}]"), d))
            .collect::<Outcome<Vec<f64>>>()?
    } else if number_of(radius).is_some() {
        vec![call.number_from("radius", radius)?; points.len()]
    } else {
        return Err(call.wrong_kind("radius", "a number or an array of one for each point", radius));
    };
    let kinds = [
        ("catmullRom", CurveKind::CatmullRom),
        ("bezier", CurveKind::Bezier),
        ("linear", CurveKind::Linear),
    ];
    let ends = [("round", CurveEnd::Round), ("flat", CurveEnd::Flat)];
    let curve = Curve {
        points,
        radii,
        kind: options.choice("kind", &kinds, CurveKind::default())?,
        ends: options.choice("ends", &ends, CurveEnd::default())?,
        is_closed: options.flag("closed", false)?,
        sides: options.count("sides", 3, 256)?.unwrap_or(12),
        tolerance: options.positive("tolerance")?,
    };
    let mesh = made(state, |allowance| {
        let of = |error: SceneError| error.of(format_args!("curve"));
        curve.mesh(allowance).map_err(of)
    })?;
    state.builder.mesh(&Arc::new(mesh))?;
    DONE
}
