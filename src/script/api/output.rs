//! Rendering from the script, and pictures as values.

use std::sync::Arc;

use rhai::{Array, Dynamic, FuncRegistration, Module};

use super::{
    int, map, string,
    views::{one_of, options},
};
use crate::{
    diag::ErrorKind,
    render::{FileOptions, LayerKind},
    scene::{ImageTexture, Region, Texels},
    script::{
        Picture,
        call::Call,
        clock::Clock,
        link::RenderLimits,
        session::{State, limit},
        table::{Entry, Group, Kind, Param},
        value::{ImageValue, Outcome, ScriptError},
    },
};

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Output, "render", render)
        .takes(&[
            &[],
            &[string("name", "the file, its format chosen by the ending: .png, .jpg, .ppm, .exr, .hdr or .pfm")],
            &[
                string("name", "the file, its format chosen by the ending: .png, .jpg, .ppm, .exr, .hdr or .pfm"),
                map("options", "bits: 8 or 16 for .png and .ppm, 16 or 32 for .exr; quality: 1 to 100 for .jpg; layers: an array of \"depth\", \"normal\", \"albedo\", \"uv\", \"object\", \"line\"").keys(&["bits", "quality", "layers"]),
            ],
        ])
        .returns("image")
        .doc("Renders the scene built so far and returns the picture, which can be looked at, or used as a texture; with a name, writes it too. A script that never calls it is rendered once when it ends. Layers are channels of an .exr, named as depth.Z; other formats get files beside the picture, name.depth.png. Files .exr, .hdr and .pfm hold linear light. Only a .png of 8 bits carries the script that it was made from, for rtscript verify and rerun.")
        .usage("render(\"picture.png\")")
        .example("size(160, 120);\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nsphere(0.6, 0.3, 0, 1.2);\nlet picture = render();          // the scene so far, on a screen of its own\nbackground(\"#f3dcb0\");\nambient(0, 0, 0); diffuse(0, 0, 0); emission(picture);\nmesh(#{\n  positions: [[-1.6, -1.1, 1], [0, -1.1, 1], [0, 0.1, 1], [-1.6, 0.1, 1]],\n  uvs: [[0, 0], [1, 0], [1, 1], [0, 1]],\n  indices: [0, 1, 2, 0, 2, 3],\n});\nrender();")
        .also(&["draw", "save", "output", "write", "trace"]),
    Entry::pure(Group::Output, "pixel", pixel)
        .takes(&[&[
            Param::new("image", Kind::Image, "none", "a picture"),
            int("x", "pixels", "column from the left, from 0"),
            int("y", "pixels", "row from the top, from 0"),
        ]])
        .returns("vec3")
        .doc("The color of one pixel of a picture in linear RGB. picture.width and picture.height are its size.")
        .usage("picture.pixel(0, 0)")
        .example("size(32, 24);\nbackground(0.2, 0.4, 0.8);\nlight([0, 0, 5], [1, 1, 1]);\ndiffuse(0.5, 0, 0);\nsphere(0, 0, 0, 1);\nlet picture = render();\nprint(picture.pixel(0, 0));\nprint(picture.pixel(picture.width / 2, picture.height / 2).x);"),
];

fn render(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let name = match call.rest() {
        0 => None,
        _ => Some(call.string("name")?),
    };
    let (file, layers) = file_options(call)?;
    call.end()?;
    if let Some(name) = &name {
        file.check(name).map_err(|why| call.error(why))?;
    }
    if name.as_ref().is_some_and(|n| n.trim().is_empty()) {
        return Err(call
            .error("name must not be empty")
            .hint("for example render(\"picture.png\")"));
    }
    if state.pictures.len() >= state.limits.pictures {
        return Err(limit("too many pictures", "pictures", state.limits.pictures));
    }
    let mut scene = state.builder.lend();
    let settings = scene.settings.clone();
    if state.dry {
        (
            scene.settings.width,
            scene.settings.height,
            scene.settings.samples,
        ) = (1, 1, 1);
        scene.settings.crop = None;
    }
    let clock = Clock::start();
    // Where no scene comes back, nobody is left who could render, and the run is over.
    let limits = RenderLimits {
        layers: if state.dry { Vec::new() } else { layers },
        time: state.limits.render_time,
        rays: state.limits.rays,
        spent: state.spent,
    };
    let result = match state.host.render(scene, limits) {
        Some((mut scene, result)) => {
            scene.settings = settings.clone();
            state.builder.take_back(scene);
            result.map_err(|e| ScriptError::from_file(*e.diagnostic))
        }
        None => Err(stopped()),
    };
    state.rendering = state.rendering.saturating_add(clock.elapsed());
    let report = result?;
    state.spent.add(&report.value.stats);
    // What looks wrong about one pixel says nothing.
    if !state.dry {
        state.warnings.extend(report.warnings);
    }
    let image = Arc::new(report.value.image.with_file_options(file));
    if let Some(name) = &name {
        state.host.write_shared(name, &image)?;
    }
    let Region { width, height, .. } = settings.region();
    let texels = match image.pixels() {
        [pixel] => vec![*pixel; width as usize * height as usize],
        pixels => pixels.to_vec(),
    };
    let value = ImageValue::new(ImageTexture {
        name: name.as_deref().unwrap_or("render()").to_owned(),
        width,
        height,
        texels: Texels::Linear(texels),
    });
    state.pictures.push(Picture {
        name: name.map(|n| n.to_string()),
        image: Arc::unwrap_or_clone(image),
        stats: report.value.stats,
    });
    Ok(Dynamic::from(value))
}

/// How the picture is to be written, and what else it is to hold.
fn file_options(call: &mut Call<'_, '_>) -> Outcome<(FileOptions, Vec<LayerKind>)> {
    let (mut file, mut layers) = (FileOptions::default(), Vec::new());
    let Some(options) = options(call, &["bits", "quality", "layers"])? else {
        return Ok((file, layers));
    };
    let byte = |key: &str| {
        let Some(d) = options.get(key) else {
            return Ok(None);
        };
        let n = call.number_from(key, d)?;
        match n.trunc() == n && (0.0..256.0).contains(&n) {
            true => Ok(Some(n as u8)),
            false => Err(call.error(format!("{key} must be a whole number, as 8 or 16, not {n}"))),
        }
    };
    (file.bits, file.quality) = (byte("bits")?, byte("quality")?);
    if let Some(given) = options.get("layers") {
        let Some(names) = given.read_lock::<Array>() else {
            return Err(call.wrong_kind("layers", "an array of names", given));
        };
        for name in names.iter() {
            let text = name.clone().into_immutable_string();
            let text = text.map_err(|_| call.wrong_kind("layers", "an array of names", name))?;
            let kind = one_of(call, "a layer", &text, &LayerKind::NAMES)?;
            if !layers.contains(&kind) {
                layers.push(kind);
            }
        }
    }
    Ok((file, layers))
}

#[cold]
fn stopped() -> Box<ScriptError> {
    ScriptError::of_kind(ErrorKind::Cancelled, "the run was stopped")
}

fn pixel(call: &mut Call<'_, '_>) -> Outcome {
    let given = call.any()?;
    let Some(value) = given.read_lock::<ImageValue>() else {
        return Err(call.wrong_kind("image", "an image", given));
    };
    let (x, y) = (call.int("x")?, call.int("y")?);
    call.end()?;
    let Some(image) = value.image() else {
        return Err(call.wrong_kind("image", "an image", given));
    };
    let inside = |i: i64, n: u32| u32::try_from(i).ok().filter(|i| *i < n);
    match (inside(x, image.width), inside(y, image.height)) {
        (Some(x), Some(y)) => Ok(Dynamic::from(image.texel(x, y))),
        _ => Err(call
            .error(format!(
                "there is no pixel ({x}, {y}) in an image of {} x {}",
                image.width, image.height
            ))
            .hint("columns and rows count from 0")),
    }
}

/// Properties of pictures.
pub(super) fn extend(module: &mut Module) {
    module.set_custom_type::<ImageValue>("image");
    for name in ["to_string", "to_debug"] {
        FuncRegistration::new(name).set_into_module(module, |i: &mut ImageValue| i.to_string());
    }
    FuncRegistration::new_getter("width").set_into_module(module, |i: &mut ImageValue| {
        i.image().map_or(0, |i| i64::from(i.width))
    });
    FuncRegistration::new_getter("height").set_into_module(module, |i: &mut ImageValue| {
        i.image().map_or(0, |i| i64::from(i.height))
    });
}
