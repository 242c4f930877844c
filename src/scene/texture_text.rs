//! Textures as the calls of a script that make them.

use std::{fmt::Display, sync::Arc};

use super::{
    ColorMap, Interpolation, Laying, Mapping, Paint, Pattern, Placement, Scene, Texture, TextureFilter, Wave,
    Wrap,
    literal::{Components, Number, Text, Vector},
};
use crate::{color::Color, math::DVec3};

/// A name for a texture, where it has one.
pub(crate) type NameOf<'n> = &'n dyn Fn(&Arc<Texture>) -> Option<String>;

impl Texture {
    /// The call that makes it. A texture within it is written by its name where `name` knows one; a picture that has none shows
    /// as its size.
    pub(crate) fn call(&self, name: NameOf<'_>) -> String {
        match self {
            Self::Image(image) => format!("image({} x {})", image.width, image.height),
            Self::Checker { even, odd, size } => {
                format!("checker({}, {}, {})", Vector(*even), Vector(*odd), Number(*size))
            }
            Self::Custom(texture) => format!("customTexture({})", Text(&texture.identity())),
            Self::VertexColors => "vertexColors()".to_owned(),
            Self::Pattern(pattern) => pattern_call(pattern.pattern(), name),
            Self::Mix(mix) => {
                let [a, b, mask] = mix.paints().map(|paint| paint_text(paint, name));
                format!("mixed({a}, {b}, {mask})")
            }
            Self::Placed(placed) => {
                let mut options = Options::default();
                options.placement(placed.placement(), &Placement::default());
                format!("placed({}, {})", paint_text(placed.paint(), name), options.text())
            }
            Self::Mapped(mapped) => {
                let mut options = Options::default();
                options.laying(mapped.laying());
                let image = mapped.image();
                let image = name(image).unwrap_or_else(|| image.call(name));
                format!("image({image}, {})", options.text())
            }
        }
    }
}

impl Scene {
    /// The number of a texture among those of the scene.
    pub(crate) fn texture_number(&self, texture: &Arc<Texture>) -> Option<usize> {
        self.textures.iter().position(|other| Arc::ptr_eq(other, texture))
    }
}

fn paint_text(paint: &Paint, name: NameOf<'_>) -> String {
    let Some(texture) = &paint.texture else {
        return Vector(paint.color).to_string();
    };
    let text = name(texture).unwrap_or_else(|| texture.call(name));
    if paint.color == Color::ONE {
        text
    } else {
        format!("{text} * vec3({})", Components(paint.color))
    }
}

fn pattern_call(pattern: &Pattern, name: NameOf<'_>) -> String {
    let usual = Pattern::new(pattern.kind);
    let Pattern {
        kind,
        colors,
        wave,
        frequency,
        phase,
        placement,
        detail,
        jitter,
        width,
        size,
        mortar,
        variation,
        from,
        to,
    } = pattern;
    let mut options = Options::default();
    options.colors(colors, &usual.colors, name);
    options.choice("wave", wave, &usual.wave, &Wave::ALL);
    options.number("frequency", *frequency, usual.frequency);
    options.number("phase", *phase, usual.phase);
    options.placement(placement, &usual.placement);
    if (detail.count, placement.octaves) != (usual.detail.count, usual.placement.octaves) {
        // Octaves alone may mean either.
        options.add("detail", detail.count);
    }
    options.number("lacunarity", detail.lacunarity, usual.detail.lacunarity);
    options.number("gain", detail.gain, usual.detail.gain);
    options.number("jitter", *jitter, usual.jitter);
    options.number("width", *width, usual.width);
    options.vector("size", *size, usual.size);
    options.number("mortar", *mortar, usual.mortar);
    options.number("variation", *variation, usual.variation);
    options.vector("from", *from, usual.from);
    options.vector("to", *to, usual.to);
    format!("pattern({}, {})", Text(kind.name()), options.text())
}

/// A map of options, those left out that have their usual values.
#[derive(Default)]
pub(super) struct Options(Vec<String>);

impl Options {
    fn add(&mut self, key: &str, value: impl Display) {
        self.0.push(format!("{key}: {value}"));
    }

    pub(super) fn text(&self) -> String {
        if self.0.is_empty() {
            return "#{}".to_owned();
        }
        format!("#{{ {} }}", self.0.join(", "))
    }

    fn number(&mut self, key: &str, x: f64, usual: f64) {
        if x.to_bits() != usual.to_bits() {
            self.add(key, Number(x));
        }
    }

    fn vector(&mut self, key: &str, v: DVec3, usual: DVec3) {
        if v.to_array().map(f64::to_bits) != usual.to_array().map(f64::to_bits) {
            self.add(key, Vector(v));
        }
    }

    fn choice<T: PartialEq>(&mut self, key: &str, value: &T, usual: &T, all: &[(&str, T)]) {
        if value != usual
            && let Some((name, _)) = all.iter().find(|(_, other)| other == value)
        {
            self.add(key, Text(name));
        }
    }

    fn placement(&mut self, placement: &Placement, usual: &Placement) {
        let Placement {
            scale,
            rotate,
            translate,
            turbulence,
            octaves,
        } = *placement;
        self.vector("scale", scale, usual.scale);
        self.vector("rotate", rotate, usual.rotate);
        self.vector("translate", translate, usual.translate);
        self.number("turbulence", turbulence, usual.turbulence);
        self.number("octaves", f64::from(octaves), f64::from(usual.octaves));
    }

    fn laying(&mut self, laying: &Laying) {
        let usual = Laying::default();
        let Laying {
            mapping,
            filter,
            wrap,
            blend,
            placement,
        } = laying;
        self.choice("mapping", mapping, &usual.mapping, &Mapping::ALL);
        self.choice("filter", filter, &usual.filter, &TextureFilter::ALL);
        self.choice("wrap", wrap, &usual.wrap, &Wrap::ALL);
        self.number("blend", *blend, usual.blend);
        self.placement(placement, &usual.placement);
    }

    fn colors(&mut self, colors: &ColorMap, usual: &ColorMap, name: NameOf<'_>) {
        if colors == usual {
            return;
        }
        let entries = colors.entries().iter();
        let entries: Vec<String> = entries
            .map(|(place, paint)| format!("[{}, {}]", Number(*place), paint_text(paint, name)))
            .collect();
        self.add("colors", format_args!("[{}]", entries.join(", ")));
        // What a script's colors are where it does not say.
        self.choice(
            "interpolate",
            &colors.interpolation(),
            &usual.interpolation(),
            &Interpolation::ALL,
        );
    }
}
