//! Paints put together: the least texture that gives the same, and none where a color does.

use std::sync::Arc;

use crate::{
    color::Color,
    diag::Diagnostic,
    import::gltf::item::Item,
    scene::{Paint, Texture},
};

pub(super) const BLACK: Paint = Paint::color(Color::ZERO);

pub(super) fn gray(x: f64) -> Paint {
    Paint::color(Color::splat(x))
}

pub(super) fn dimmed(paint: &Paint, by: Color) -> Paint {
    Paint {
        color: paint.color * by,
        texture: paint.texture.clone(),
    }
}

/// `a` where `mask` is black and `b` where it is white.
pub(super) fn mixed(a: Paint, b: Paint, mask: Paint, item: &Item<'_, '_>) -> Result<Paint, Diagnostic> {
    let is_plain = |paint: &Paint| paint.texture.is_none() || paint.color == Color::ZERO;
    if is_plain(&mask) {
        let m = mask.color;
        if m == Color::ZERO {
            return Ok(a);
        }
        if m == Color::ONE {
            return Ok(b);
        }
        if is_plain(&a) && is_plain(&b) {
            return Ok(Paint::color(a.color * (Color::ONE - m) + b.color * m));
        }
        if a.color == Color::ZERO {
            return Ok(dimmed(&b, m));
        }
        if b.color == Color::ZERO {
            return Ok(dimmed(&a, Color::ONE - m));
        }
    }
    let texture = Texture::mix(a, b, mask).map_err(|error| item.error(error))?;
    Ok(Paint::texture(Arc::new(texture)))
}

/// One paint seen through the other.
pub(super) fn product(a: &Paint, b: &Paint, item: &Item<'_, '_>) -> Result<Paint, Diagnostic> {
    match (&a.texture, &b.texture) {
        (None, _) => Ok(dimmed(b, a.color)),
        (_, None) => Ok(dimmed(a, b.color)),
        _ => mixed(BLACK, a.clone(), b.clone(), item),
    }
}

pub(super) fn inverted(a: &Paint, item: &Item<'_, '_>) -> Result<Paint, Diagnostic> {
    mixed(gray(1.0), BLACK, a.clone(), item)
}
