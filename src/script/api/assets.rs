//! Files and arrays that become meshes and textures.

use std::sync::Arc;

use rhai::{Array, Dynamic, Map};

use super::{map, patterns, string};
use crate::{
    color::Color,
    diag::{Diagnostic, ErrorKind},
    host::resolve,
    import::{Assets, load_mesh, load_mesh_shape, mesh_from_arrays, set_colors, set_normals, set_uvs},
    math::{DVec2, DVec3},
    scene::{Builder, ImageTexture, Mesh, SceneError, Texels},
    script::{
        call::{Call, kind_of, number_of},
        lists::{tuple, tuples, tuples_with},
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::{ImageValue, Outcome, ScriptError},
    },
};

const KEYS: [&str; 8] = [
    "colorIndices",
    "colors",
    "indices",
    "normalIndices",
    "normals",
    "positions",
    "uvIndices",
    "uvs",
];
const MESH_OPTIONS: [&str; 1] = ["materials"];

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Assets, "mesh", mesh)
        .takes(&[
            &[string("file", "an OBJ, PLY, STL or glTF file, relative to the script that names it")],
            &[map("data", "positions, and any of indices, normals, normalIndices, uvs, uvIndices, colors and colorIndices").keys(&KEYS)],
            &[
                string("file", "an OBJ, PLY, STL or glTF file, relative to the script that names it"),
                map("options", "materials: whether to read the file's materials; true unless given").keys(&MESH_OPTIONS),
            ],
        ])
        .doc("A triangle mesh: from a file, OBJ with its normals, materials and textures, PLY with normals, texture coordinates and colors, which diffuse(vertexColors()) shows, STL, or glTF 2.0 (.gltf or .glb), the meshes of its scene where its nodes place them, with materials of metal and roughness and their textures; with #{ materials: false } its shape alone, in the current material; or from arrays. positions and normals are points or one flat list, uvs are pairs or one flat list, colors are linear RGB or color codes, each also a blob of floats as write_le writes them; indices count from 0, three for each triangle. Without indices every three positions are a triangle; without normals the mesh is flat. normals, uvs and colors, which vertexColors() shows, belong to the positions, one each, unless normalIndices, uvIndices or colorIndices say for each corner of the triangles which of them it has, -1 for none.")
        .usage("mesh(#{ positions: [[0, 0, 0], [1, 0, 0], [0, 1, 0]] })")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.85, 0.6, 0.25);\ngroup {\n  translate(-1.2, -0.7, 0);\n  rotate(0, 1, 0, 25);\n  mesh(#{                       // a tent\n    positions: [[-1, 0, 1], [1, 0, 1], [0, 1.5, 1], [-1, 0, -1], [1, 0, -1], [0, 1.5, -1]],\n    indices: [0, 1, 2,  1, 4, 5,  1, 5, 2,  0, 2, 5,  0, 5, 3,  3, 5, 4],\n  });\n}\ndiffuse(0.2, 0.5, 0.7);\ntranslate(1.2, 0, 0); rotate(0, 1, 0, 20); scale(0.7);\nmesh(\"tetrahedron.obj\");")
        .also(&["obj", "ply", "stl", "gltf", "glb", "pbr", "model", "loadObj", "import", "triangleMesh"]),
    Entry::scene(Group::Assets, "image", image)
        .takes(&[
            &[string("file", "a PNG, JPEG or Radiance (.hdr) file, relative to the script that names it")],
            &[map("data", "width, height and pixels: colors row by row from the top")],
            &[
                Param::new("image", Kind::Image, "none", "a file as above, or an image"),
                map("options", "mapping: \"uv\" (the shape's own coordinates), \"planar\" (along z), \"spherical\", \"cylindrical\" (around y) or \"box\" (from each side, melting over blend), all but uv laying the picture on the cube from -0.5 to 0.5; filter: \"bilinear\", \"nearest\", \"mip\" (smaller copies for what is far away) or \"anisotropic\" (the same, but sharp where it is seen aslant, as floors are); wrap: \"repeat\", \"clamp\", \"mirror\" or \"black\"; scale, rotate, translate, turbulence, octaves: where it lies").keys(&patterns::LAYING),
            ],
        ])
        .returns("image")
        .doc("A picture from a file, or from numbers: linear RGB of each pixel as points, as one flat list, or as a blob of floats as write_le writes them. It can be looked at (.width, .height, .pixel(x, y)) and stands wherever a color of a material may; times a number or a color it is dimmed or tinted. With options it is a texture laid on shapes in another way.")
        .usage("image(\"wood.png\")")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet wood = image(\"wood.png\");\ndiffuse(wood);\nsphere(-1.2, 0, 0, 1.1);\ndiffuse(image(wood, #{ mapping: \"box\" }) * vec3(1, 0.6, 0.5));   // stained\ngroup { translate(1.2, 0, 0); rotate(1, 2, 0, 40); scale(1.5, 1.5, 1.5); box(); }")
        .also(&["texture", "loadImage", "loadTexture", "picture"]),
];

/// Runs `load` on the files of the current source. An error that belongs to a file keeps its place there.
pub(super) fn with_assets<T>(
    state: &mut State,
    path: &str,
    load: impl FnOnce(&str, &mut Assets<'_>, &mut Builder) -> Result<T, Box<Diagnostic>>,
) -> Outcome<T> {
    let host_path = state.host_path(path);
    let loc = state.builder.loc();
    let host = state.timed_host();
    let mut assets = Assets::new(&host, &state.limits, &mut state.assets);
    let loaded = load(&host_path, &mut assets, &mut state.builder);
    state.builder.set_loc(loc);
    loaded.map_err(|mut d| {
        if d.kind == ErrorKind::Cancelled {
            return state.stopped();
        }
        // As the reader knows the file: next to the script.
        let main = state.sources.first().map_or("", |s| s.name.as_str());
        d.file = d.file.map(|file| resolve(main, &file).into());
        ScriptError::from_file(*d)
    })
}

/// The picture in a file, as `image(file)` reads it.
pub(super) fn picture(call: &Call<'_, '_>, state: &mut State, file: &str) -> Outcome<ImageValue> {
    let texture = with_assets(state, file, |path, assets, _| {
        assets.texture(path).map_err(Box::new)
    })?;
    ImageValue::of(&texture).ok_or_else(|| call.error("file is no picture"))
}

fn image(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    if call.len() == 2 {
        return image_laid(call, state);
    }
    if let Some(data) = call
        .peek()
        .and_then(|d| d.read_lock::<Map>().map(|map| map.clone()))
    {
        call.any()?;
        call.end()?;
        let image = image_from_numbers(call, state, &data)?;
        state.assets.count("the image", &image, &state.limits)?;
        return Ok(Dynamic::from(ImageValue::new(image)));
    }
    let file = call.string("file")?;
    call.end()?;
    Ok(Dynamic::from(picture(call, state, &file)?))
}

/// `image("wood.png", #{ mapping: "box" })`, or of a picture that was read before.
fn image_laid(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let texture = if let Some(image) = given.read_lock::<ImageValue>() {
        Arc::clone(image.texture())
    } else if let Ok(file) = given.clone().into_immutable_string() {
        Arc::clone(picture(call, state, &file)?.texture())
    } else {
        return Err(call.wrong_kind("image", "the name of a file or an image", given));
    };
    let options = patterns::options(call, &patterns::LAYING)?;
    patterns::laid(call, state, texture, &options)
}

/// `image(#{ width: 2, height: 1, pixels: [1, 0, 0,  0, 1, 0] })`.
fn image_from_numbers(call: &Call<'_, '_>, state: &State, data: &Map) -> Outcome<ImageTexture> {
    call.known_keys(data, &["height", "pixels", "width"])?;
    let missing = |name: &str| {
        call.error(format!("the map needs {name}"))
            .hint("for example image(#{ width: 2, height: 1, pixels: [[1, 0, 0], [0, 0, 1]] })")
    };
    let side = |name: &str| -> Outcome<u32> {
        let d = data.get(name).ok_or_else(|| missing(name))?;
        let n = index(call, || name.to_owned(), d)?;
        let side = u32::try_from(n).ok().filter(|n| *n > 0);
        let side = side.ok_or_else(|| call.error(format!("{name} must be at least 1, not {n}")))?;
        let limit = state.limits.texture_side;
        if side > limit {
            let what = format!("an image of {side} texels along an edge is too large");
            return Err(SceneError::limit(&what, "texture_side", limit).into());
        }
        Ok(side)
    };
    let (width, height) = (side("width")?, side("height")?);
    let pixels = data.get("pixels").ok_or_else(|| missing("pixels"))?;
    let texels = tuples::<3>(call, "pixels", pixels)?;
    let wanted = u64::from(width) * u64::from(height);
    if texels.len() as u64 != wanted {
        return Err(call.error(format!(
            "pixels has {} colors, but an image of {width} x {height} takes {wanted}",
            texels.len()
        )));
    }
    Ok(ImageTexture {
        name: "image".to_owned(),
        width,
        height,
        texels: Texels::Linear(texels),
    })
}

fn mesh(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let with_materials = match call.rest() {
        0 => true,
        _ => wants_materials(call)?,
    };
    call.end()?;
    let mesh = if let Some(data) = given.read_lock::<Map>() {
        Arc::new(from_arrays(call, &data)?)
    } else if let Ok(file) = given.clone().into_immutable_string() {
        with_assets(state, &file, |path, assets, builder| {
            let load = if with_materials {
                load_mesh
            } else {
                load_mesh_shape
            };
            load(path, assets, builder).map_err(Box::new)
        })?
    } else {
        return Err(call
            .error(format!(
                "it takes the name of an OBJ, PLY, STL or glTF file or a map of arrays, not {}",
                kind_of(given)
            ))
            .hint(format!("for example {}", call.entry.usage)));
    };
    state.builder.mesh(&mesh)?;
    DONE
}

/// The options of `mesh(file, #{ materials: false })`.
fn wants_materials(call: &mut Call<'_, '_>) -> Outcome<bool> {
    let options = call.any()?;
    let Some(options) = options.read_lock::<Map>() else {
        return Err(call.wrong_kind("options", "a map", options));
    };
    call.known_keys(&options, &MESH_OPTIONS)?;
    match options.get("materials") {
        Some(wanted) => wanted
            .as_bool()
            .map_err(|_| call.wrong_kind("materials", "true or false", wanted)),
        None => Ok(true),
    }
}

/// The triangles of a map of positions and indices.
pub(super) fn mesh_data(call: &Call<'_, '_>, data: &Map) -> Outcome<Mesh> {
    call.known_keys(data, &["indices", "positions"])?;
    from_arrays(call, data)
}

fn from_arrays(call: &Call<'_, '_>, data: &Map) -> Outcome<Mesh> {
    call.known_keys(data, &KEYS)?;
    let Some(positions) = data.get("positions") else {
        return Err(call
            .error("the map needs positions")
            .hint(format!("for example {}", call.entry.usage)));
    };
    let vectors = |name: &str, d: &Dynamic| -> Outcome<Vec<DVec3>> {
        let flat = tuples::<3>(call, name, d)?;
        Ok(flat.into_iter().map(DVec3::from_array).collect())
    };
    let optional = |name: &str| data.get(name).filter(|d| !d.is_unit());
    let positions = vectors("positions", positions)?;
    let normals = optional("normals").map(|d| vectors("normals", d)).transpose()?;
    let uvs = optional("uvs").map(|d| tuples::<2>(call, "uvs", d)).transpose()?;
    let uvs: Option<Vec<DVec2>> = uvs.map(|uvs| uvs.into_iter().map(DVec2::from_array).collect());
    let own = |name: &str| optional(name).map(|d| indices(call, name, d)).transpose();
    let (triangles, of_normals, of_uvs) = (own("indices")?, own("normalIndices")?, own("uvIndices")?);
    let colors = optional("colors").map(|d| colors(call, d)).transpose()?;
    let of_colors = own("colorIndices")?;
    for (values, given, own) in [
        ("normals", normals.is_some(), of_normals.is_some()),
        ("uvs", uvs.is_some(), of_uvs.is_some()),
        ("colors", colors.is_some(), of_colors.is_some()),
    ] {
        if own && !given {
            return Err(call.error(format!("there are indices of {values}, but no {values}")));
        }
    }
    let (normals, own_normals) = match of_normals {
        Some(indices) => (None, normals.map(|normals| (normals, indices))),
        None => (normals, None),
    };
    let (uvs, own_uvs) = match of_uvs {
        Some(indices) => (None, uvs.map(|uvs| (uvs, indices))),
        None => (uvs, None),
    };
    let mut mesh = mesh_from_arrays(positions, triangles.as_deref(), normals, uvs)?;
    if let Some((normals, indices)) = own_normals {
        set_normals(&mut mesh, normals, &indices)?;
    }
    if let Some((uvs, indices)) = own_uvs {
        set_uvs(&mut mesh, uvs, &indices)?;
    }
    if let Some(colors) = colors {
        set_colors(&mut mesh, colors, of_colors.as_deref())?;
    }
    Ok(mesh)
}

/// Colors of vertices: numbers, or color codes.
pub(super) fn colors(call: &Call<'_, '_>, d: &Dynamic) -> Outcome<Vec<Color>> {
    let colors = tuples_with::<3>(call, "colors", d, |name, d| {
        if d.is_string() {
            return Ok(call.term_from(&name(), d)?.color.to_array());
        }
        tuple(call, name, d)
    })?;
    Ok(colors.into_iter().map(Color::from_array).collect())
}

/// Ints, nested in threes or one flat list.
fn indices(call: &Call<'_, '_>, name: &str, d: &Dynamic) -> Outcome<Vec<i64>> {
    let Some(array) = d.read_lock::<Array>() else {
        return Err(call.wrong_kind(name, "an array", d));
    };
    let mut all = Vec::with_capacity(array.len());
    for (i, d) in array.iter().enumerate() {
        if let Some(triangle) = d.read_lock::<Array>() {
            if triangle.len() != 3 {
                return Err(call
                    .error(format!("{name}[{i}] must be 3 ints, not {}", triangle.len()))
                    .hint("cut it into triangles: a, b, c, d is a, b, c and a, c, d"));
            }
            for (j, d) in triangle.iter().enumerate() {
                all.push(index(call, || format!("{name}[{i}][{j}]"), d)?);
            }
        } else {
            all.push(index(call, || format!("{name}[{i}]"), d)?);
        }
    }
    Ok(all)
}

fn index(call: &Call<'_, '_>, name: impl FnOnce() -> String, d: &Dynamic) -> Outcome<i64> {
    if let Ok(i) = d.as_int() {
        return Ok(i);
    }
    match number_of(d) {
        Some(x) if x.trunc() == x && x.abs() < 9.0e15 => Ok(x as i64),
        Some(x) => Err(call.error(format!("{} must be a whole number, not {x}", name()))),
        None => Err(call.error(format!("{} must be a whole number, not {}", name(), kind_of(d)))),
    }
}
