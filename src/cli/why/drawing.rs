//! Rays drawn into the picture.

use super::Answer;
use crate::{
    color::Color,
    math::DVec3,
    render::{
        Image, RayKind,
        explain::{ExplainedRay, LightSample},
    },
    scene::CameraFrame,
    testing::from_rgb8,
};

/// What the colors mean.
pub(super) const LEGEND: &str = "the pixel white, reflected rays cyan, refracted rays magenta, rays to lights yellow, \
                                 green where tinted, red where blocked";

const PIXEL: [u8; 3] = [255, 255, 255];
const REFLECTED: [u8; 3] = [0, 230, 255];
const REFRACTED: [u8; 3] = [255, 70, 255];
const VISIBLE: [u8; 3] = [255, 220, 0];
const TINTED: [u8; 3] = [60, 220, 60];
const BLOCKED: [u8; 3] = [255, 50, 30];

/// Shadow rays drawn for one light where the camera ray ends, and where other rays end; of more, every so many.
const MOST_SHADOW_RAYS: [usize; 2] = [16, 4];
/// How strong the faintest ray is drawn.
const FAINTEST: f64 = 0.2;
/// The picture stays to be seen under the rays, at this share.
const DIMMED: f64 = 0.5;

/// The picture, dimmed, with the rays of the answer's sample in it.
pub(super) fn draw(image: &Image, answer: &Answer<'_>) -> Image {
    let (width, height) = (image.width(), image.height());
    let bytes = image
        .rgb8()
        .iter()
        .map(|v| (f64::from(*v) * DIMMED) as u8)
        .collect();
    let s = &answer.scene.settings;
    let region = s.region();
    let mut canvas = Canvas {
        width,
        height,
        bytes,
        frame: answer.scene.camera.frame(s.width, s.height),
        corner: [f64::from(region.x), f64::from(region.y)],
    };
    let size = answer
        .sample
        .rays
        .iter()
        .filter_map(|ray| Some(ray.hit.as_ref()?.t));
    let far = size.fold(1.0, f64::max);
    for ray in &answer.sample.rays {
        for light in ray.hit.iter().flat_map(|hit| &hit.lights) {
            let [from_the_first, from_later] = MOST_SHADOW_RAYS;
            let most = if ray.depth > 0 { from_later } else { from_the_first };
            let step = light.samples.len().div_ceil(most).max(1);
            for sample in light.samples.iter().step_by(step) {
                canvas.shadow(ray, sample, far);
            }
        }
    }
    for ray in &answer.sample.rays {
        let color = match ray.kind {
            RayKind::Camera => continue,
            RayKind::Reflected => REFLECTED,
            RayKind::Refracted => REFRACTED,
        };
        let end = ray.hit.as_ref().map_or(far, |hit| hit.t);
        let strength = strength(ray);
        canvas.segment(ray.origin, ray.origin + ray.direction * end, color, strength);
    }
    canvas.mark(answer.pixel);
    // The bytes are meant as they stand, whatever encoding the scene has.
    from_rgb8(width, height, &canvas.bytes)
}

/// The more of what a ray sees reaches the camera, the stronger it is drawn.
fn strength(ray: &ExplainedRay<'_>) -> f64 {
    ray.weight.max_element().clamp(FAINTEST, 1.0)
}

struct Canvas {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
    frame: CameraFrame,
    /// Of the picture in that of the whole frame.
    corner: [f64; 2],
}

impl Canvas {
    fn shadow(&mut self, ray: &ExplainedRay<'_>, sample: &LightSample<'_>, far: f64) {
        let Some(hit) = &ray.hit else { return };
        let color = if sample.visible == Color::ONE {
            VISIBLE
        } else if sample.visible == Color::ZERO {
            BLOCKED
        } else {
            TINTED
        };
        let end = sample.distance.min(10.0 * far);
        let strength = strength(ray);
        self.segment(
            hit.position,
            hit.position + sample.direction * end,
            color,
            strength,
        );
    }

    /// A line in space, as far as it is in the picture.
    fn segment(&mut self, a: DVec3, b: DVec3, color: [u8; 3], strength: f64) {
        for [a, b] in self.frame.paths(a, b) {
            self.line(a, b, color, strength);
        }
    }

    fn line(&mut self, a: [f64; 2], b: [f64; 2], color: [u8; 3], strength: f64) {
        let [left, top] = self.corner;
        let [a, b] = [a, b].map(|[x, y]| [x - left, y - top]);
        let size = [f64::from(self.width), f64::from(self.height)];
        let Some([a, b]) = clipped(a, b, size) else {
            return;
        };
        let ([ax, ay], [bx, by]) = (a, b);
        let steps = (bx - ax).abs().max((by - ay).abs()).ceil().max(1.0);
        for i in 0..=steps as u32 {
            let share = f64::from(i) / steps;
            let (x, y) = (ax + (bx - ax) * share, ay + (by - ay) * share);
            self.set(x as u32, y as u32, color, strength);
        }
    }

    /// Four strokes around a pixel, which itself stays as it is.
    fn mark(&mut self, (x, y): (u32, u32)) {
        for i in 2..=5 {
            self.set(x.wrapping_add(i), y, PIXEL, 1.0);
            self.set(x.wrapping_sub(i), y, PIXEL, 1.0);
            self.set(x, y.wrapping_add(i), PIXEL, 1.0);
            self.set(x, y.wrapping_sub(i), PIXEL, 1.0);
        }
    }

    fn set(&mut self, x: u32, y: u32, color: [u8; 3], strength: f64) {
        if x >= self.width || y >= self.height {
            return;
        }
        let at = 3 * (y as usize * self.width as usize + x as usize);
        if let Some(pixel) = self.bytes.get_mut(at..at + 3) {
            for (old, new) in pixel.iter_mut().zip(color) {
                *old = (f64::from(*old) * (1.0 - strength) + f64::from(new) * strength) as u8;
            }
        }
    }
}

/// The part of a line that lies in the rectangle from 0 to `size` (Liang and Barsky, "A new concept and method for line
/// clipping", 1984).
fn clipped(a: [f64; 2], b: [f64; 2], size: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    if !a.iter().chain(&b).all(|x| x.is_finite()) {
        return None;
    }
    let (mut from, mut to) = (0.0, 1.0);
    for ((a, b), size) in a.into_iter().zip(b).zip(size) {
        let d = b - a;
        for (distance, run) in [(-a, -d), (a - size, d)] {
            // Outside where distance + share * run > 0.
            if run == 0.0 {
                if distance > 0.0 {
                    return None;
                }
                continue;
            }
            let share = -distance / run;
            if run < 0.0 {
                from = f64::max(from, share);
            } else {
                to = f64::min(to, share);
            }
        }
    }
    if !(from <= to) {
        return None;
    }
    let at = |share: f64| [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share];
    Some([at(from), at(to)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_clipped_to_the_picture() {
        let clip = |a, b| clipped(a, b, [10.0, 20.0]);
        assert_eq!(clip([1.0, 2.0], [3.0, 4.0]), Some([[1.0, 2.0], [3.0, 4.0]]));
        assert_eq!(clip([-5.0, 5.0], [15.0, 5.0]), Some([[0.0, 5.0], [10.0, 5.0]]));
        assert_eq!(clip([5.0, 30.0], [5.0, -10.0]), Some([[5.0, 20.0], [5.0, 0.0]]));
        assert_eq!(clip([-1.0, 0.0], [-1.0, 20.0]), None);
        assert_eq!(clip([12.0, 0.0], [30.0, 20.0]), None);
        assert_eq!(clip([f64::NAN, 0.0], [1.0, 1.0]), None);
    }
}
