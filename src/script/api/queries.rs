//! What a script may ask about the scene while it builds it.

use std::collections::BTreeMap;

use rhai::{Dynamic, Map};

use super::{string, vec3};
use crate::{
    diag::{ErrorKind, SourceLoc},
    math::{Bounds3, DVec3, Ray},
    render::{Compiled, World},
    scene::{GroupId, Shutter},
    script::{
        call::Call,
        session::State,
        table::{Entry, Group, Param},
        value::{Outcome, ScriptError},
    },
};

const NAME: Param = string("name", "as given to define; without it, what was made so far");
const ORIGIN: Param = vec3("origin", "units", "where the ray begins");
const DIRECTION: Param = vec3("direction", "none", "where it goes, of any length but 0");
const POINT: Param = vec3("point", "units", "a point");

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Queries, "raycast", raycast)
        .takes(&[&[NAME, ORIGIN, DIRECTION], &[ORIGIN, DIRECTION]])
        .returns("map | ()")
        .doc("What a ray meets first: #{ point, normal, distance }, the normal of length 1 on the side that the ray comes from; () where it meets nothing. A definition is compiled for it once. What was made so far is compiled anew where something was added since, so of many rays between many shapes, ask a definition.")
        .usage("raycast(\"car\", [0, 10, 0], [0, -1, 0])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndefine \"hill\" { diffuse(0.3, 0.5, 0.25); scale(2.6, 1.1, 2); sphere(0, -0.6, 0, 1); }\ninstance(\"hill\");\nfor i in 0..60 {\n  let hit = raycast(\"hill\", [random(-2.2, 2.2), 5, random(-1.5, 1.5)], [0, -1, 0]);\n  if hit == () { continue; }\n  group {   // a tree where the ray came down\n    translate(hit.point + vec3(0, 0.25, 0));\n    diffuse(0.1, random(0.3, 0.5), 0.15);\n    cone(0.12, 0.5);\n  }\n}")
        .also(&["trace", "rayCast", "intersect", "ray_cast", "hitTest"]),
    Entry::scene(Group::Queries, "bounds", bounds)
        .takes(&[&[NAME], &[]])
        .returns("map | ()")
        .doc("The box around a definition or what was made so far: #{ min, max, center, size }, all vectors; () where there is nothing, or something without end such as plane(). Around what is turned it may be larger than need be.")
        .usage("bounds(\"car\").max.y")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndefine \"thing\" {\n  diffuse(0.8, 0.25, 0.15);\n  sphere(0, 0.4, 0, 0.7);\n  translate(0.6, -0.3, 0); box(1, 0.4, 0.6);\n}\ninstance(\"thing\");\nlet b = bounds(\"thing\");   // a frame around it\ndiffuse(0.15, 0.15, 0.2);\nfor y in [b.min.y, b.max.y] {\n  group { translate(b.center.x, y, 0); box(b.size.x, 0.04, 0.04); }\n}\nfor x in [b.min.x, b.max.x] {\n  group { translate(x, b.center.y, 0); box(0.04, b.size.y, 0.04); }\n}")
        .also(&["boundingBox", "min_extent", "max_extent", "bbox", "bound_box"]),
    Entry::scene(Group::Queries, "inside", inside)
        .takes(&[&[NAME, POINT], &[POINT]])
        .returns("bool")
        .doc("Whether a point is inside of a solid or a closed mesh.")
        .usage("inside(\"car\", [0, 1, 0])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndefine \"ring\" { rotate(1, 0, 0, 60); torus(1.2, 0.45); }\ndiffuse(0.15, 0.5, 0.4);\nfor x in -16..17 {   // marbles filled into a ring\n  for y in -16..17 {\n    let p = vec3(x, y, 0) * 0.11;\n    if inside(\"ring\", p) { sphere(p, 0.06); }\n  }\n}")
        .also(&["contains", "isInside", "point_in"]),
];

/// Bytes of compiled definitions that are kept. What is more makes room for all.
const KEPT: u64 = 256 << 20;

/// What was compiled for questions and may be asked again.
#[derive(Default)]
pub(in crate::script) struct Queries {
    definitions: BTreeMap<GroupId, Compiled>,
    bounds: BTreeMap<GroupId, Option<Bounds3>>,
    /// What was made so far, when there was so much of it.
    so_far: Option<(Progress, Compiled)>,
    bounds_so_far: Option<(Progress, Option<Bounds3>)>,
}

type Progress = (usize, usize, usize, SourceLoc);

/// What a question is about.
#[derive(Clone, Copy)]
enum Subject {
    Definition(GroupId),
    SoFar,
}

fn subject(call: &mut Call<'_, '_>, state: &State) -> Outcome<Subject> {
    if call.peek().is_some_and(Dynamic::is_string) {
        let name = call.string("name")?;
        return Ok(Subject::Definition(state.builder.defined(&name)?));
    }
    Ok(Subject::SoFar)
}

/// Asks the world of `subject`.
///
/// # Errors
/// Where it cannot be compiled, or the script's time was over before there was an answer.
fn ask<T>(state: &mut State, subject: Subject, question: impl FnOnce(&World<'_>) -> T) -> Outcome<T> {
    let progress = state.builder.progress();
    let is_known = match subject {
        Subject::Definition(id) => state.queries.definitions.contains_key(&id),
        Subject::SoFar => {
            let so_far = &state.queries.so_far;
            so_far.as_ref().is_some_and(|(known, _)| *known == progress)
        }
    };
    let host = state.timed_host();
    if !is_known {
        let scene = match subject {
            Subject::Definition(id) => state.builder.extract(id),
            Subject::SoFar => state.builder.scene_so_far(),
        };
        let mut scene = scene.ok_or_else(|| ScriptError::new("there is no such definition"))?;
        // What moves is where its motion begins, whatever part of it the picture will show.
        scene.camera.shutter = Shutter {
            open: 0.0,
            close: 0.0,
        };
        let compiled = match Compiled::for_host(scene, Box::new(host)) {
            Ok(compiled) => compiled,
            Err(e) if e.diagnostic.kind == ErrorKind::Cancelled => return Err(state.stopped()),
            Err(e) => return Err(ScriptError::from_file(*e.diagnostic)),
        };
        let queries = &mut state.queries;
        match subject {
            Subject::Definition(id) => {
                let kept: u64 = queries.definitions.values().map(|c| c.world().bytes()).sum();
                if kept.saturating_add(compiled.world().bytes()) > KEPT {
                    queries.definitions.clear();
                }
                queries.definitions.insert(id, compiled);
            }
            Subject::SoFar => queries.so_far = Some((progress, compiled)),
        }
    }
    let compiled = match subject {
        Subject::Definition(id) => state.queries.definitions.get(&id),
        Subject::SoFar => state.queries.so_far.as_ref().map(|(_, compiled)| compiled),
    };
    let compiled = compiled.ok_or_else(|| ScriptError::new("there is no such definition"))?;
    let answer = question(compiled.world());
    if compiled.is_stopped() {
        return Err(state.stopped());
    }
    Ok(answer)
}

fn raycast(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let subject = subject(call, state)?;
    let (origin, direction) = (call.vec3("origin")?, call.vec3("direction")?);
    call.end()?;
    if direction == DVec3::ZERO {
        return Err(call.error("direction must have a length, and this one is 0"));
    }
    let ray = Ray::new(origin, direction);
    let Some(hit) = ask(state, subject, |world| world.raycast(&ray, f64::INFINITY))? else {
        return Ok(Dynamic::UNIT);
    };
    let point = ray.at(hit.t);
    Ok(map([
        ("point", Dynamic::from(point)),
        ("normal", Dynamic::from(hit.normal)),
        ("distance", Dynamic::from(hit.t * direction.length())),
    ]))
}

fn inside(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let subject = subject(call, state)?;
    let point = call.vec3("point")?;
    call.end()?;
    let answer = ask(state, subject, |world| world.is_inside(point))?;
    Ok(Dynamic::from(answer))
}

fn bounds(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let subject = subject(call, state)?;
    call.end()?;
    let progress = state.builder.progress();
    let queries = &state.queries;
    let known = match subject {
        Subject::Definition(id) => queries.bounds.get(&id).copied(),
        Subject::SoFar => {
            let known = queries.bounds_so_far.filter(|(known, _)| *known == progress);
            known.map(|(_, bounds)| bounds)
        }
    };
    let bounds = match known {
        Some(bounds) => bounds,
        // All that there is is looked at, which a step of the script must not do for ever.
        None if state.time_left().is_zero() => return Err(state.too_long()),
        None => match subject {
            Subject::Definition(id) => {
                let bounds = state.builder.bounds_of(id);
                state.queries.bounds.insert(id, bounds);
                bounds
            }
            Subject::SoFar => {
                let bounds = state.builder.bounds_so_far();
                state.queries.bounds_so_far = Some((progress, bounds));
                bounds
            }
        },
    };
    Ok(match bounds.filter(|b| !b.is_empty()) {
        None => Dynamic::UNIT,
        Some(b) => map([
            ("min", Dynamic::from(b.min)),
            ("max", Dynamic::from(b.max)),
            ("center", Dynamic::from(b.center())),
            ("size", Dynamic::from(b.size())),
        ]),
    })
}

fn map<const N: usize>(entries: [(&str, Dynamic); N]) -> Dynamic {
    let map: Map = entries
        .into_iter()
        .map(|(key, value)| (key.into(), value))
        .collect();
    Dynamic::from(map)
}
