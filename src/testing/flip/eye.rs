//! What the eye gets of a picture: colors after the contrast sensitivity of its channels, edges and points.

use super::Window;
use crate::{
    color::linear_from_srgb,
    math::{self, DMat3, DVec3, PI},
};

/// Width of the feature detectors in degrees, `w` (section 4.2).
const FEATURE_WIDTH: f64 = 0.082;

/// Parameters `a` and `b` of the Gaussians that are the eye's contrast sensitivity to each of the three opponent
/// channels (section 4.1, table 1). That of blue and yellow is a sum of two.
const LUMINANCE: [f64; 2] = [1.0, 0.0047];
const RED_GREEN: [f64; 2] = [1.0, 0.0053];
const BLUE_YELLOW: [[f64; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];

/// XYZ of the white point D65, that is of linear RGB (1, 1, 1).
const WHITE: DVec3 = DVec3::new(0.950_428_545, 1.0, 1.088_900_371);

/// XYZ from linear RGB with the primaries of Rec. 709 and the white point D65, in columns.
const XYZ_FROM_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(
        10_135_552.0 / 24_577_794.0,
        2_613_072.0 / 12_288_897.0,
        1_425_312.0 / 73_733_382.0,
    ),
    DVec3::new(
        8_788_810.0 / 24_577_794.0,
        8_788_810.0 / 12_288_897.0,
        8_788_810.0 / 73_733_382.0,
    ),
    DVec3::new(
        4_435_075.0 / 24_577_794.0,
        887_015.0 / 12_288_897.0,
        70_074_185.0 / 73_733_382.0,
    ),
);

/// One-dimensional filters; each has its middle in the middle of the list.
pub(super) struct Filters {
    luminance: Vec<f64>,
    red_green: Vec<f64>,
    blue_yellow: [Vec<f64>; 2],
    /// A Gaussian, and its first and second derivatives: edges and points.
    feature: [Vec<f64>; 3],
}

impl Filters {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let widest = BLUE_YELLOW[0][1];
        // Three standard deviations (section 4.1).
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i64;
        let gaussian = |[_, b]: [f64; 2]| -> Vec<f64> {
            let at = |i: i64| math::exp(-PI * PI * square(i as f64 / pixels_per_degree) / b);
            (-radius..=radius).map(at).collect()
        };
        // Each Gaussian over the plane is a product of two over a line, each with the root of its factor; the sum of
        // both over the plane is 1.
        let terms = BLUE_YELLOW.map(|[a, b]| {
            let factor = (a * (PI / b).sqrt()).sqrt();
            gaussian([a, b]).iter().map(|g| factor * g).collect::<Vec<f64>>()
        });
        let norm = terms
            .iter()
            .map(|term| square(term.iter().sum::<f64>()))
            .sum::<f64>()
            .sqrt();
        Self {
            luminance: normalized(gaussian(LUMINANCE)),
            red_green: normalized(gaussian(RED_GREEN)),
            blue_yellow: terms.map(|term| term.iter().map(|g| g / norm).collect()),
            feature: feature_filters(0.5 * FEATURE_WIDTH * pixels_per_degree),
        }
    }

    /// Pixels from the middle of the widest filter to its end.
    pub(super) fn radius(&self) -> usize {
        self.luminance.len().max(self.feature[0].len()) / 2
    }
}

/// A Gaussian of this standard deviation in pixels, and its derivatives, of which the positive and the negative
/// weights each sum to 1 (section 4.2).
fn feature_filters(deviation: f64) -> [Vec<f64>; 3] {
    let radius = (3.0 * deviation).ceil() as i64;
    let line = |weight: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        let at = |i: i64| {
            let x = i as f64;
            weight(x, math::exp(-x * x / (2.0 * deviation * deviation)))
        };
        (-radius..=radius).map(at).collect()
    };
    [
        normalized(line(&|_, g| g)),
        normalized(line(&|x, g| -x * g)),
        normalized(line(&|x, g| (x * x / (deviation * deviation) - 1.0) * g)),
    ]
}

/// Positive weights divided by their sum, negative ones by the size of theirs.
fn normalized(mut weights: Vec<f64>) -> Vec<f64> {
    let positive: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = weights.iter().filter(|w| **w < 0.0).sum();
    for w in &mut weights {
        *w /= if *w > 0.0 { positive } else { -negative };
    }
    weights
}

/// What the eye gets of one of the two pictures within the window.
pub(super) struct Side {
    /// Colors in Lab with Hunt's adjustment after the eye's filter.
    pub(super) seen: Vec<DVec3>,
    /// Strength of edges and of points.
    pub(super) features: Vec<[f64; 2]>,
}

impl Side {
    pub(super) fn new(bytes: &[u8], width: usize, window: &Window, filters: &Filters) -> Self {
        let mut linear = [0.0; 256];
        for (byte, linear) in linear.iter_mut().enumerate() {
            *linear = linear_from_srgb(byte as f64 / 255.0);
        }
        let mut planes = [const { Vec::new() }; 3];
        for y in window.rows.clone() {
            let row = &bytes.as_chunks::<3>().0[y * width..][window.columns.clone()];
            for rgb in row {
                let rgb = DVec3::from_array(rgb.map(|b| linear[usize::from(b)]));
                let opponent = opponent_from_xyz(XYZ_FROM_RGB * rgb);
                planes
                    .iter_mut()
                    .zip(opponent)
                    .for_each(|(plane, v)| plane.push(v));
            }
        }
        let size = [window.columns.len(), window.rows.len()];
        let filtered = |plane: &[f64], across: &[f64], down: &[f64]| filter(plane, size, across, down);
        let [luminance, red_green, blue_yellow] = &planes;

        let l = filtered(luminance, &filters.luminance, &filters.luminance);
        let rg = filtered(red_green, &filters.red_green, &filters.red_green);
        let [by, by2] = [0, 1].map(|i: usize| {
            let line = &filters.blue_yellow[i];
            filtered(blue_yellow, line, line)
        });
        let rgb_from_xyz = XYZ_FROM_RGB.inverse();
        let opponent = |i: usize| [l[i], rg[i], by[i] + by2[i]];
        let seen = (0..l.len())
            .map(|i| seen_color(opponent(i), &rgb_from_xyz))
            .collect();

        let gray: Vec<f64> = luminance.iter().map(|y| (y + 16.0) / 116.0).collect();
        let [gaussian, edge, point] = &filters.feature;
        let strengths = |detector: &[f64]| {
            let across = filtered(&gray, detector, gaussian);
            let down = filtered(&gray, gaussian, detector);
            let pairs = across.into_iter().zip(down);
            pairs.map(|(x, y)| (x * x + y * y).sqrt()).collect::<Vec<f64>>()
        };
        let (edges, points) = (strengths(edge), strengths(point));
        Self {
            seen,
            features: edges.into_iter().zip(points).map(|(e, p)| [e, p]).collect(),
        }
    }
}

/// Filters a picture of this width and height by the product of two filters. Beyond the edges stand the pixels of
/// the edges.
fn filter(plane: &[f64], [width, height]: [usize; 2], across: &[f64], down: &[f64]) -> Vec<f64> {
    let radius = across.len() / 2;
    let mut padded = vec![0.0; width + 2 * radius];
    let mut rows = vec![0.0; plane.len()];
    for (row, out) in plane.chunks(width).zip(rows.chunks_mut(width)) {
        padded[..radius].fill(row[0]);
        padded[radius..radius + width].copy_from_slice(row);
        padded[radius + width..].fill(row[width - 1]);
        for (i, weight) in across.iter().enumerate() {
            add(out, *weight, &padded[i..i + width]);
        }
    }
    let radius = down.len() / 2;
    let mut filtered = vec![0.0; plane.len()];
    for (y, out) in filtered.chunks_mut(width).enumerate() {
        for (i, weight) in down.iter().enumerate() {
            let from = (y + i).saturating_sub(radius).min(height - 1);
            add(out, *weight, &rows[from * width..(from + 1) * width]);
        }
    }
    filtered
}

/// `sums += weight * values`.
fn add(sums: &mut [f64], weight: f64, values: &[f64]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// The linear opponent space YCxCz (section 4.1).
fn opponent_from_xyz(xyz: DVec3) -> [f64; 3] {
    let [x, y, z] = (xyz / WHITE).to_array();
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// A filtered color in Lab, where chroma counts less in the dark (Hunt's effect, section 4.1).
fn seen_color([l, rg, by]: [f64; 3], rgb_from_xyz: &DMat3) -> DVec3 {
    let y = (l + 16.0) / 116.0;
    let xyz = DVec3::new(y + rg / 500.0, y, y - by / 200.0) * WHITE;
    // Filtering may leave the range of the screen.
    let rgb = (*rgb_from_xyz * xyz).clamp(DVec3::ZERO, DVec3::ONE);
    hunt_lab(rgb)
}

/// A linear color in CIELAB with a and b scaled by L / 100.
pub(super) fn hunt_lab(rgb: DVec3) -> DVec3 {
    let [x, y, z] = (XYZ_FROM_RGB * rgb / WHITE).to_array().map(|t| {
        const DELTA: f64 = 6.0 / 29.0;
        if t > DELTA * DELTA * DELTA {
            math::cbrt(t)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    });
    let l = 116.0 * y - 16.0;
    DVec3::new(l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z))
}

/// The distance HyAB: lightness by its difference, chroma by its Euclidean distance (section 4.1).
pub(super) fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

fn square(x: f64) -> f64 {
    x * x
}
