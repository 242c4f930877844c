//! Surfaces by functions and control points.

use rhai::{Array, Dynamic, FnPtr};

use super::{
    heights::{made, place, within},
    map,
};
use crate::{
    math::DVec3,
    scene::SceneError,
    script::{
        call::{Call, kind_of},
        caller::{Caller, Failure},
        options::Options,
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
    tessellate::{Allowance, BezierPatches, Parametric},
};

const SURFACE_KEYS: [&str; 5] = ["columns", "rows", "tolerance", "u", "v"];
const PATCH_KEYS: [&str; 1] = ["tolerance"];

pub(super) const ENTRIES: &[Entry] = &[
    Entry::calling(Group::Assets, "surface", surface)
        .takes(&[&[
            Param::new("f", Kind::Function, "object units", "the point [x, y, z] for each u and v"),
            map(
                "options",
                "u and v: from where to where they go, [0, 1] each; tolerance: how far triangles may be off the surface, its size / 1000; columns and rows: cells to begin with, 8 each",
            )
            .or("#{ }")
            .keys(&SURFACE_KEYS),
        ]])
        .doc("A surface by its formula, made into triangles that lie within the tolerance of it: many where it bends, few where it is flat. Sides that come together, as those of a tube or a torus, are joined, and sides that are one point, as the poles of a ball; a surface that closes so has an inside and may be glass. Columns and rows say how finely it is looked at first: what is smaller than a cell may be missed.")
        .usage("surface(|u, v| [u, sin(3 * u) * v, v])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ncamera([0, 3, 5], [0, 0, 0], [0, 1, 0], 40);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.85, 0.4, 0.3); specular(0.3, 0.3, 0.3); shininess(40);\nsurface(|u, v| {                  // a knotted tube with three lobes\n  let r = 0.35 + 0.12 * cos(3 * u);\n  let d = 1.35 + r * cos(v);\n  [d * cos(u), r * sin(v) + 0.25 * sin(3 * u), d * sin(u)]\n}, #{ u: [0, TAU], v: [0, TAU], columns: 12, tolerance: 0.02 });")
        .also(&["parametric", "isoparametric", "parametricSurface", "plot3d", "tessellate"]),
    Entry::scene(Group::Assets, "bezierPatch", bezier_patch)
        .takes(&[&[
            Param::new(
                "points",
                Kind::Array,
                "object units",
                "16 points, four rows of four; or a list of such patches",
            ),
            map("options", "tolerance: how far triangles may be off the surface, its size / 1000")
                .or("#{ }")
                .keys(&PATCH_KEYS),
        ]])
        .doc("Bicubic Bezier patches, as teapots are made of: a patch goes through the four corners of its points, and the others pull it. Patches with the same points along a side meet there without a crack.")
        .usage("bezierPatch([[0,0,0], [1,0,0], [2,0,0], [3,0,0],  [0,0,1], [1,1,1], [2,1,1], [3,0,1],  [0,0,2], [1,1,2], [2,1,2], [3,0,2],  [0,0,3], [1,0,3], [2,0,3], [3,0,3]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ncamera([2, 3, 5], [0, 0, 0], [0, 1, 0], 36);\ndirectional([-2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.25, 0.5, 0.75); specular(0.4, 0.4, 0.4); shininess(40);\nlet heights = [0.9, -0.6, 0, 0,   -0.4, 2.4, -1, 0.4,   0, -1, 2, -0.4,   0, 0.3, -0.6, 1];\nlet points = [];\nfor i in 0..16 { points.push([i % 4 - 1.5, heights[i], i / 4 - 1.5]); }\nbezierPatch(points);\ndiffuse(0.8, 0.3, 0.2);\nfor p in points { sphere(p, 0.06); }")
        .also(&["bicubic_patch", "bicubicPatch", "patch", "teapot", "nurbs"]),
];

fn surface(call: &mut Call<'_, '_>, caller: &Caller<'_, '_>) -> Result<Dynamic, Failure> {
    let given = call.any()?;
    let options = match call.rest() {
        0 => None,
        _ => Some(call.any()?),
    };
    call.end()?;
    let Some(f) = given.clone().try_cast::<FnPtr>() else {
        return Err(call.wrong_kind("f", "a function of u and v", given).into());
    };
    let options = Options::new(call, options, &SURFACE_KEYS)?;
    let default = Parametric::default();
    let parametric = Parametric {
        u: range(call, &options, "u")?,
        v: range(call, &options, "v")?,
        tolerance: options.positive("tolerance")?,
        columns: options.count("columns", 3, 1000)?.unwrap_or(default.columns),
        rows: options.count("rows", 3, 1000)?.unwrap_or(default.rows),
    };
    let mut point = |u: f64, v: f64| -> Result<DVec3, Failure> {
        let result = caller.call(&f, (u, v), || {
            call.error("f must take two numbers, u and v")
                .hint(format!("for example {}", call.entry.usage))
        })?;
        let name = || format!("f({u}, {v})");
        if result.is_unit() {
            return Err(call
                .error(format!("f must give a point, but {} gives nothing", name()))
                .hint("the point stands last in the function, without a ';' behind it")
                .into());
        }
        call.vec3_from(&name(), &result).map_err(Failure::Said)
    };
    // Time is looked at by the function that is called: it is the script's.
    let limits = caller.with(|state| Ok(state.limits.clone()))?;
    let allowance = Allowance::of(&limits);
    let mesh = parametric
        .mesh(&mut point, &allowance)
        .map_err(|failure| match failure {
            Failure::Said(mut error) if !error.message.starts_with("surface: ") => {
                error.message = format!("surface: {}", error.message);
                Failure::Said(error)
            }
            other => other,
        })?;
    within(caller, |allowance| allowance.triangles(mesh.triangles.len()))?;
    place(caller, &mesh)
}

/// Two numbers.
fn range(call: &Call<'_, '_>, options: &Options<'_, '_, '_>, key: &str) -> Outcome<[f64; 2]> {
    let Some(given) = options.get(key) else {
        return Ok([0.0, 1.0]);
    };
    crate::script::lists::tuple(call, &|| key.to_owned(), given)
}

fn bezier_patch(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let options = match call.rest() {
        0 => None,
        _ => Some(call.any()?),
    };
    call.end()?;
    let options = Options::new(call, options, &PATCH_KEYS)?;
    let Some(array) = given.read_lock::<Array>() else {
        return Err(call.wrong_kind("points", "an array of 16 points", given));
    };
    let is_list = array
        .first()
        .and_then(|first| first.read_lock::<Array>())
        .is_some_and(|first| first.first().is_some_and(|d| d.is_array() || d.is::<DVec3>()));
    let patches: Outcome<Vec<[DVec3; 16]>> = if is_list {
        array
            .iter()
            .enumerate()
            .map(|(i, d)| match d.read_lock::<Array>() {
                Some(points) => patch(call, &format!("points[{i}]"), &points),
                None => Err(call.error(format!(
                    "points[{i}] must be an array of 16 points, not {}",
                    kind_of(d)
                ))),
            })
            .collect()
    } else {
        patch(call, "points", &array).map(|patch| vec![patch])
    };
    let patches = BezierPatches {
        patches: patches?,
        tolerance: options.positive("tolerance")?,
    };
    let mesh = made(state, |allowance| {
        let of = |error: SceneError| error.of(format_args!("bezierPatch"));
        patches.mesh(allowance).map_err(of)
    })?;
    state.builder.mesh(&std::sync::Arc::new(mesh))?;
    DONE
}

fn patch(call: &Call<'_, '_>, name: &str, points: &Array) -> Outcome<[DVec3; 16]> {
    let read: Outcome<Vec<DVec3>> = points
        .iter()
        .enumerate()
        .map(|(i, d)| call.vec3_from(&format!("{name}[{i}]"), d))
        .collect();
    let read = read?;
    let count = read.len();
    read.try_into().map_err(|_| {
        call.error(format!(
            "{name} must be 16 points, four rows of four, not {count}"
        ))
    })
}
