//! Text.

use std::sync::Arc;

use rhai::{Dynamic, Map};

use super::{assets::with_assets, heights::made, map, string};
use crate::{
    diag::Code,
    script::{
        call::Call,
        options::Options,
        session::State,
        table::{DONE, Entry, Group, Param},
        value::Outcome,
    },
    tessellate::{Align, Text, VerticalAlign},
};

const KEYS: [&str; 9] = [
    "align",
    "depth",
    "font",
    "kerning",
    "letterSpacing",
    "lineSpacing",
    "size",
    "tolerance",
    "valign",
];
const STRING: Param = string("string", "the characters; \\n begins a line");
const OPTIONS: Param = map(
    "options",
    "font: a TrueType or OpenType file (.ttf, .otf, .ttc), else the built-in one; size: the em, capitals being about 0.7 of it, 1; depth: 0.2; align: \"left\", \"center\" or \"right\"; valign: \"baseline\", \"top\", \"middle\" or \"bottom\"; kerning: true; lineSpacing: 1; letterSpacing: 0; tolerance: how far edges may be off the curves, size / 1000",
)
.or("#{ }")
.keys(&KEYS);

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Assets, "text", text)
        .takes(&[&[STRING, OPTIONS]])
        .doc("Letters as solids, standing on y = 0 in the plane z = 0 with half of their depth before and behind it, looking towards +z. Each is closed, with walls that are smooth along curves and sharp at corners, so text may be glass. The built-in font is DejaVu Sans with Latin, Greek and the usual signs. Right-to-left scripts and ligatures are not put together. depth: 0 makes flat faces.")
        .usage("text(\"Hello\", #{ size: 1, align: \"center\" })")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ncamera([0.8, 1.2, 4], [0, 0.25, 0], [0, 1, 0], 36);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.85, 0.35, 0.2); specular(0.3, 0.3, 0.3); shininess(40); reflection(0, 0, 0);\ntext(\"Ray & Wave\", #{ size: 0.5, depth: 0.2, align: \"center\" });\ndiffuse(checker(\"#eee\", \"#9ab\", 0.5));\nplane();")
        .also(&["letters", "font", "linear_extrude", "label", "string3d", "ttf", "otf"]),
    Entry::scene(Group::Assets, "textSize", text_size)
        .takes(&[&[STRING, OPTIONS]])
        .returns("map")
        .doc("How large text with the same options is: #{ width, height, ascent, descent, lines }. width is that of the longest line; height goes from the top of the first line to the bottom of the last; ascent and descent are what lies above the first and below the last baseline.")
        .usage("textSize(\"Hello\", #{ size: 1 }).width")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet options = #{ size: 1.1, align: \"center\", valign: \"middle\" };\nlet size = textSize(\"a sign\", options);\ndiffuse(0.95, 0.9, 0.7);\ngroup { translate(0, 0, -0.15); box(size.width + 0.4, size.height + 0.2, 0.1); }\ndiffuse(0.2, 0.25, 0.4);\ntext(\"a sign\", options);")
        .also(&["textWidth", "measureText", "textBounds"]),
];

/// The text that a call describes.
fn described(call: &mut Call<'_, '_>, state: &mut State) -> Outcome<Text> {
    let string = call.string("string")?;
    let options = match call.rest() {
        0 => None,
        _ => Some(call.any()?),
    };
    call.end()?;
    let options = Options::new(call, options, &KEYS)?;
    let default = Text::new(&string);
    let font = match options.text("font")? {
        None => default.font.clone(),
        Some(file) => with_assets(state, &file, |path, assets, _| {
            assets.font(path).map_err(Box::new)
        })?,
    };
    let aligns = [
        ("left", Align::Left),
        ("center", Align::Center),
        ("right", Align::Right),
    ];
    let vertical = [
        ("baseline", VerticalAlign::Baseline),
        ("top", VerticalAlign::Top),
        ("middle", VerticalAlign::Middle),
        ("bottom", VerticalAlign::Bottom),
    ];
    Ok(Text {
        font,
        size: options.number("size")?.unwrap_or(default.size),
        depth: options.number("depth")?.unwrap_or(default.depth),
        align: options.choice("align", &aligns, default.align)?,
        vertical_align: options.choice("valign", &vertical, default.vertical_align)?,
        kerning: options.flag("kerning", default.kerning)?,
        line_spacing: options.number("lineSpacing")?.unwrap_or(default.line_spacing),
        letter_spacing: options.number("letterSpacing")?.unwrap_or(default.letter_spacing),
        tolerance: options.number("tolerance")?,
        ..default
    })
}

fn text(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let text = described(call, state)?;
    let (mesh, missing) = made(state, |allowance| {
        let of = |error: crate::scene::SceneError| error.of(format_args!("text"));
        let mesh = text.mesh(allowance).map_err(of)?;
        Ok((mesh, text.missing(allowance).map_err(of)?))
    })?;
    if let Some(first) = missing.first() {
        let others = match missing.len() {
            1 => String::new(),
            n => format!(", nor {} others of the text", n - 1),
        };
        let message = format!("the font has no character {first:?}{others}: a box stands in its place");
        let hint = "text(\"...\", #{ font: \"file.ttf\" }) takes another font";
        state.builder.warn(Code::IgnoredInput, message, Some(hint));
    }
    if let Some(mesh) = mesh {
        state.builder.mesh(&Arc::new(mesh))?;
    }
    DONE
}

fn text_size(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let text = described(call, state)?;
    let size = made(state, |allowance| {
        let size = text.measure(allowance);
        size.map_err(|error| error.of(format_args!("textSize")))
    })?;
    let mut map = Map::new();
    for (name, value) in [
        ("width", size.width),
        ("height", size.height),
        ("ascent", size.ascent),
        ("descent", size.descent),
    ] {
        map.insert(name.into(), Dynamic::from(value));
    }
    map.insert("lines".into(), Dynamic::from(size.lines as i64));
    Ok(Dynamic::from(map))
}
