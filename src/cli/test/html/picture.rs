//! Pictures within the page.

use crate::{
    cli::picture::base64,
    output::{Format, encode},
    render::Image,
    testing::{Region, channels_apart, flip, from_rgb8},
};

/// A picture as an element of the page. `None` for one without pixels or too large for its format.
pub(super) fn img(image: &Image, alt: &str) -> Option<String> {
    if image.width() == 0 || image.height() == 0 {
        return None;
    }
    let png = encode(image, Format::Png).ok()?;
    Some(format!(
        "<img alt=\"{alt}\" width=\"{}\" height=\"{}\" draggable=\"false\" src=\"data:image/png;base64,{}\">",
        image.width(),
        image.height(),
        base64(&png)
    ))
}

/// FLIP's error in the color map magma; `None` where the sizes differ.
pub(super) fn heat(expected: &Image, actual: &Image) -> Option<Image> {
    flip(expected, actual).map(|map| map.heat_picture())
}

/// The difference of each channel, brightened until the largest is white, and the factor that does it. White where
/// only one picture has a pixel.
pub(super) fn difference(expected: &Image, actual: &Image) -> (Image, f64) {
    let (e, a) = (expected.rgb8(), actual.rgb8());
    let (width, height) = covering(expected, actual);
    let at = |bytes: &[u8], image: &Image, x: u32, y: u32| -> Option<[u8; 3]> {
        let index = y as usize * image.width() as usize + x as usize;
        (x < image.width()).then(|| bytes.as_chunks::<3>().0.get(index).copied())?
    };
    let mut bytes: Vec<u8> = Vec::with_capacity(width as usize * height as usize * 3);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        bytes.extend(match (at(&e, expected, x, y), at(&a, actual, x, y)) {
            (Some(e), Some(a)) => channels_apart(e, a),
            (None, None) => [0; 3],
            _ => [255; 3],
        });
    }
    let max = u32::from(bytes.iter().copied().max().unwrap_or(0).max(1));
    bytes
        .iter_mut()
        .for_each(|b| *b = (u32::from(*b) * 255 / max) as u8);
    (from_rgb8(width, height, &bytes), 255.0 / f64::from(max))
}

/// Size of the smallest picture that covers both.
pub(super) fn covering(a: &Image, b: &Image) -> (u32, u32) {
    (a.width().max(b.width()), a.height().max(b.height()))
}

/// The outline of what changed, in a picture of this size. Half a pixel outside, so that it hides none that changed.
pub(super) fn outline(region: &Region, (width, height): (u32, u32)) -> String {
    let before = |v: u32| f64::from(v) - 0.5;
    format!(
        "<svg class=\"region\" viewBox=\"0 0 {width} {height}\" aria-hidden=\"true\"><rect x=\"{}\" y=\"{}\" \
         width=\"{}\" height=\"{}\"/></svg>",
        before(region.left),
        before(region.top),
        u64::from(region.width) + 1,
        u64::from(region.height) + 1
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_difference_is_brightened_and_covers_both() {
        let a = from_rgb8(2, 1, &[10, 20, 30, 40, 50, 60]);
        let b = from_rgb8(2, 1, &[10, 20, 30, 40, 53, 61]);
        let (picture, factor) = difference(&a, &b);
        assert_eq!(picture.rgb8(), [0, 0, 0, 0, 255, 85]);
        assert_eq!(factor, 85.0);
        let (picture, factor) = difference(&a, &from_rgb8(1, 2, &[10, 20, 30, 0, 0, 0]));
        assert_eq!((picture.width(), picture.height(), factor), (2, 2, 1.0));
        assert_eq!(picture.rgb8(), [0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 0]);
    }

    #[test]
    fn no_pixels_no_element() {
        assert_eq!(img(&from_rgb8(0, 0, &[]), "x"), None);
        let element = img(&from_rgb8(1, 1, &[1, 2, 3]), "x").unwrap();
        assert!(element.contains("width=\"1\" height=\"1\"") && element.contains("base64,iVBORw0KGgo"));
    }
}
