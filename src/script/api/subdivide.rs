//! Subdivision surfaces.

use std::sync::Arc;

use rhai::{Array, Dynamic, Map};

use super::{
    assets::{self, with_assets},
    heights::made,
    int, map, string,
};
use crate::{
    import::load_polygons,
    math::{DVec2, DVec3},
    scene::SceneError,
    script::{
        call::{Call, kind_of},
        lists::{number, tuples},
        options::Options,
        session::State,
        table::{DONE, Entry, Group, Param},
        value::Outcome,
    },
    tessellate::{Cage, Scheme},
};

const CAGE_KEYS: [&str; 8] = [
    "colorIndices",
    "colors",
    "creases",
    "faces",
    "indices",
    "positions",
    "uvIndices",
    "uvs",
];
const KEYS: [&str; 2] = ["limit", "scheme"];
const LEVELS: Param = int("levels", "none", "how often each face is divided, 0 to 8").or("2");
const OPTIONS: Param = map(
    "options",
    "scheme: \"catmullClark\" or \"loop\", else loop where all faces are triangles; limit: whether corners are moved to where endless division would bring them, true",
)
.or("#{ }")
.keys(&KEYS);

pub(super) const ENTRIES: &[Entry] = &[Entry::scene(Group::Assets, "subdivide", subdivide)
    .takes(&[
        &[
            map(
                "cage",
                "positions; faces: arrays of three or more corners each, counted from 0, or indices: triangles; creases: [corner, corner, sharpness] each, sharp for so many levels; uvs: pairs, one for each position, or with uvIndices in the form of faces one for each corner of them; colors and colorIndices: as uvs, linear RGB or color codes",
            )
            .keys(&CAGE_KEYS),
            LEVELS,
            OPTIONS,
        ],
        &[
            string("file", "an OBJ file, relative to the script that names it, of polygons"),
            LEVELS,
            OPTIONS,
        ],
    ])
    .doc("A smooth surface from a coarse cage of faces: Catmull-Clark for polygons, Loop for triangles, with the normals of the smooth surface. Rims stay, and so do creases. Texture coordinates and colors are divided within each face, so that seams stay. A closed cage gives a closed mesh, as glass needs it. A file gives its shape alone, in the current material.")
    .usage("subdivide(#{ positions: [[-1, -1, 0], [1, -1, 0], [1, 1, 1], [-1, 1, 0]], faces: [[0, 1, 2, 3]] }, 3)")
    .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ncamera([1.5, 2.2, 5], [0, 0, 0], [0, 1, 0], 38);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet cube = #{\n  positions: [[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [1, 1, -1], [-1, -1, 1], [1, -1, 1], [-1, 1, 1], [1, 1, 1]],\n  faces: [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]],\n};\ndiffuse(0.8, 0.5, 0.2);\ngroup { translate(-1.3, 0, 0); rotate(0, 1, 0, 20); subdivide(cube, 3); }\ncube.creases = [[2, 3, 9], [3, 7, 9], [7, 6, 9], [6, 2, 9]];   // a sharp rim above\ndiffuse(0.3, 0.5, 0.8);\ngroup { translate(1.3, 0, 0); rotate(0, 1, 0, 20); subdivide(cube, 3); }")
    .also(&["subdivision", "catmullClark", "loop", "smoothMesh", "subsurf"])];

fn subdivide(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let levels = match call.rest() {
        0 => 2,
        _ => call.count("levels", 0)?,
    };
    let options = match call.rest() {
        0 => None,
        _ => Some(call.any()?),
    };
    call.end()?;
    let options = Options::new(call, options, &KEYS)?;
    let mut cage = if let Some(data) = given.read_lock::<Map>() {
        cage(call, &data)?
    } else if let Ok(file) = given.clone().into_immutable_string() {
        let polygons = with_assets(state, &file, |path, assets, _| {
            load_polygons(path, assets).map_err(Box::new)
        })?;
        Cage {
            uvs: polygons.uvs,
            ..Cage::new(polygons.positions, polygons.faces, 0)
        }
    } else {
        return Err(call.wrong_kind("cage", "a map of arrays or the name of an OBJ file", given));
    };
    cage.levels = levels;
    let schemes = [("catmullClark", Scheme::CatmullClark), ("loop", Scheme::Loop)];
    cage.scheme = options.choice("scheme", &schemes, Scheme::Auto)?;
    cage.to_the_limit = options.flag("limit", true)?;
    let mesh = made(state, |allowance| {
        let of = |error: SceneError| error.of(format_args!("subdivide"));
        cage.mesh(allowance).map_err(of)
    })?;
    state.builder.mesh(&Arc::new(mesh))?;
    DONE
}

fn cage(call: &Call<'_, '_>, data: &Map) -> Outcome<Cage> {
    call.known_keys(data, &CAGE_KEYS)?;
    let missing = |what: &str| {
        call.error(format!("the map needs {what}"))
            .hint(format!("for example {}", call.entry.usage))
    };
    let positions = data.get("positions").ok_or_else(|| missing("positions"))?;
    let positions = tuples::<3>(call, "positions", positions)?;
    let faces = match (data.get("faces"), data.get("indices")) {
        (Some(faces), None) => polygons(call, "faces", faces)?,
        (None, Some(indices)) => triangles(call, "indices", indices)?,
        (Some(_), Some(_)) => return Err(call.error("the map has faces and indices; expected one of them")),
        (None, None) => return Err(missing("faces")),
    };
    let mut cage = Cage::new(positions.into_iter().map(DVec3::from_array).collect(), faces, 0);
    if let Some(creases) = data.get("creases") {
        for (i, [a, b, sharpness]) in tuples::<3>(call, "creases", creases)?.into_iter().enumerate() {
            let name = || format!("creases[{i}]");
            cage.creases
                .push(([corner(call, name, a)?, corner(call, name, b)?], sharpness));
        }
    }
    let own = |name: &str| match data.get(name) {
        Some(own) if data.contains_key("faces") => polygons(call, name, own).map(Some),
        Some(own) => triangles(call, name, own).map(Some),
        None => Ok(None),
    };
    if let Some(uvs) = data.get("uvs") {
        let uvs = tuples::<2>(call, "uvs", uvs)?;
        let uvs: Vec<DVec2> = uvs.into_iter().map(DVec2::from_array).collect();
        let faces = own("uvIndices")?;
        cage.uvs = of_faces(call, "uv", &uvs, faces.as_ref().unwrap_or(&cage.faces))?;
    } else if data.contains_key("uvIndices") {
        return Err(call.error("there are indices of uvs, but no uvs"));
    }
    if let Some(colors) = data.get("colors") {
        let colors = assets::colors(call, colors)?;
        let faces = own("colorIndices")?;
        cage.colors = of_faces(call, "color", &colors, faces.as_ref().unwrap_or(&cage.faces))?;
    } else if data.contains_key("colorIndices") {
        return Err(call.error("there are indices of colors, but no colors"));
    }
    Ok(cage)
}

/// The values with these numbers, face by face.
fn of_faces<T: Copy>(
    call: &Call<'_, '_>,
    what: &str,
    values: &[T],
    faces: &[Vec<u32>],
) -> Outcome<Vec<Vec<T>>> {
    let value = |face: usize, corner: &u32| {
        values.get(*corner as usize).copied().ok_or_else(|| {
            let count = values.len();
            call.error(format!(
                "face {face} has {what} {corner}, but there are {count}, numbered from 0"
            ))
        })
    };
    let face = |(i, face): (usize, &Vec<u32>)| face.iter().map(|corner| value(i, corner)).collect();
    faces.iter().enumerate().map(face).collect()
}

/// Threes of numbers, or one flat list.
fn triangles(call: &Call<'_, '_>, name: &str, given: &Dynamic) -> Outcome<Vec<Vec<u32>>> {
    let triangles = tuples::<3>(call, name, given)?;
    let triangle = |(i, t): (usize, &[f64; 3])| {
        t.iter()
            .map(|x| corner(call, || format!("{name}[{i}]"), *x))
            .collect()
    };
    triangles.iter().enumerate().map(triangle).collect()
}

fn polygons(call: &Call<'_, '_>, name: &str, given: &Dynamic) -> Outcome<Vec<Vec<u32>>> {
    let Some(faces) = given.read_lock::<Array>() else {
        return Err(call.wrong_kind(name, "an array of arrays of corners", given));
    };
    let face = |(i, face): (usize, &Dynamic)| -> Outcome<Vec<u32>> {
        let Some(corners) = face.read_lock::<Array>() else {
            return Err(call.error(format!(
                "{name}[{i}] must be an array of corners, not {}",
                kind_of(face)
            )));
        };
        let corners = corners.iter().enumerate();
        corners
            .map(|(j, d)| {
                let name = || format!("{name}[{i}][{j}]");
                corner(call, name, number(call, name, d)?)
            })
            .collect()
    };
    faces.iter().enumerate().map(face).collect()
}

/// The number of a position.
fn corner(call: &Call<'_, '_>, name: impl Fn() -> String, x: f64) -> Outcome<u32> {
    if x.trunc() == x && (0.0..f64::from(u32::MAX)).contains(&x) {
        return Ok(x as u32);
    }
    Err(call.error(format!("{} must be the number of a position, not {x}", name())))
}
