//! Light of one wavelength, for glass that bends its colors apart.

use std::sync::LazyLock;

use crate::{
    color::Color,
    math::{self, DVec3},
    scene::{D_LINE, Dispersion},
};

/// Ends of the visible spectrum in nanometers.
const RANGE: (f64, f64) = (400.0, 700.0);

/// Bands of equal width that the spectrum is cut into.
const BANDS: usize = 60;

/// What each band is worth.
struct Bands {
    /// The share of samples that fall into the bands up to and including each.
    reached: [f64; BANDS],
    /// The color of a sample there: over all samples their mean is white.
    color: [Color; BANDS],
}

static SPECTRUM: LazyLock<Bands> = LazyLock::new(bands);

/// The wavelength in nanometers that a random number in [0, 1) stands for, and the color that a sample of it has. The mean color
/// over all numbers is white.
#[allow(
    clippy::indexing_slicing,
    reason = "the number of a band is less than that of bands"
)]
pub(super) fn wavelength(u: f64) -> (f64, Color) {
    let bands = &*SPECTRUM;
    let band = bands
        .reached
        .partition_point(|reached| *reached <= u)
        .min(BANDS - 1);
    let before = if band == 0 { 0.0 } else { bands.reached[band - 1] };
    let within = ((u - before) / (bands.reached[band] - before)).clamp(0.0, 1.0);
    let width = (RANGE.1 - RANGE.0) / BANDS as f64;
    (RANGE.0 + width * (band as f64 + within), bands.color[band])
}

#[allow(clippy::indexing_slicing, reason = "bands are gone through by their numbers")]
fn bands() -> Bands {
    let width = (RANGE.1 - RANGE.0) / BANDS as f64;
    let mut color: [Color; BANDS] = std::array::from_fn(|band| {
        // Colors that no screen shows are cut off at its gamut.
        rgb_of(matching(RANGE.0 + width * (band as f64 + 0.5))).max(Color::ZERO)
    });
    let white = color.iter().fold(Color::ZERO, |sum, c| sum + *c);
    let mut reached = [0.0; BANDS];
    let mut sum = 0.0;
    for band in 0..BANDS {
        // As many samples as the band has of the three colors' light.
        let share = (color[band] / white).dot(DVec3::splat(1.0 / 3.0));
        color[band] = color[band] / white / share;
        sum += share;
        reached[band] = sum;
    }
    Bands { reached, color }
}

/// CIE 1931 x, y and z of a wavelength in nanometers, by the fits of Wyman, Sloan and Shirley ("Simple analytic approximations to the
/// CIE XYZ color matching functions", JCGT 2013).
fn matching(nm: f64) -> DVec3 {
    let lobe = |height: f64, center: f64, below: f64, above: f64| {
        let t = (nm - center) * if nm < center { below } else { above };
        height * math::exp(-0.5 * t * t)
    };
    DVec3::new(
        lobe(0.362, 442.0, 0.0624, 0.0374)
            + lobe(1.056, 599.8, 0.0264, 0.0323)
            + lobe(-0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    )
}

/// XYZ to linear RGB with Rec. 709 primaries (IEC 61966-2-1).
fn rgb_of(xyz: DVec3) -> Color {
    Color::new(
        DVec3::new(3.240_624_2, -1.537_208, -0.498_628_6).dot(xyz),
        DVec3::new(-0.968_930_7, 1.875_756_1, 0.041_517_5).dot(xyz),
        DVec3::new(0.055_710_1, -0.204_021_1, 1.056_995_9).dot(xyz),
    )
}

/// Wavelengths of Fraunhofer's lines d, F and C in micrometers, by which glass is described.
const LINES: [f64; 3] = [D_LINE, 0.486_13, 0.656_27];

/// The B of Cauchy's formula n = A + B / wavelength^2, in square micrometers, of a glass with index `ior` at the d line and Abbe
/// number `abbe`: (n_d - 1) / (n_F - n_C).
pub(super) fn cauchy_b(ior: f64, abbe: f64) -> f64 {
    let [_, f, c] = LINES;
    (ior - 1.0) / (abbe * (1.0 / (f * f) - 1.0 / (c * c)))
}

/// The index of refraction at a wavelength in nanometers of a glass that has `ior` at the d line.
pub(super) fn index_at(ior: f64, b: f64, nm: f64) -> f64 {
    let [d, ..] = LINES;
    let micrometers = nm * 1e-3;
    ior + b * (1.0 / (micrometers * micrometers) - 1.0 / (d * d))
}

/// The index of refraction at a wavelength in nanometers of what has one by its own formula, and `ior` at the d line.
pub(super) fn shifted_index(own: &Dispersion, ior: f64, nm: f64) -> f64 {
    let at = |micrometers| own.index(micrometers).unwrap_or(0.0);
    let [d, ..] = LINES;
    ior + (at(nm * 1e-3) - at(d))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_wavelengths_together_are_white() {
        let n = 100_000;
        let mut sum = Color::ZERO;
        let mut before = RANGE.0;
        for i in 0..n {
            let (nm, color) = wavelength((f64::from(i) + 0.5) / f64::from(n));
            assert!(nm >= before && nm <= RANGE.1, "{nm}");
            assert!(
                color.min_element() >= 0.0 && color.max_element() <= 3.001,
                "{nm}: {color}"
            );
            before = nm;
            sum += color;
        }
        let mean = sum / f64::from(n);
        assert!((mean - Color::ONE).abs().max_element() < 1e-3, "{mean}");
        assert!(wavelength(0.0).0 >= RANGE.0 && wavelength(1.0).0 <= RANGE.1);
    }

    #[test]
    fn the_rainbow_is_in_order() {
        let color_at = |nm: f64| {
            let all = (0..10_000).map(|i| wavelength(f64::from(i) / 10_000.0));
            let near = all.min_by(|a, b| (a.0 - nm).abs().total_cmp(&(b.0 - nm).abs()));
            near.unwrap().1
        };
        let (blue, green, red) = (color_at(450.0), color_at(530.0), color_at(640.0));
        assert!(blue.z > 2.0 * blue.x.max(blue.y), "{blue}");
        assert!(green.y > 2.0 * green.x.max(green.z), "{green}");
        assert!(red.x > 2.0 * red.y.max(red.z), "{red}");
    }

    #[test]
    fn glass_has_its_abbe_number() {
        // Schott N-BK7 and the dense flint SF11.
        for (ior, abbe, f, c) in [
            (1.5168, 64.17, 1.5224, 1.5143),
            (1.784_72, 25.68, 1.806_46, 1.775_99),
        ] {
            let b = cauchy_b(ior, abbe);
            let at = |line: f64| index_at(ior, b, line * 1e3);
            let [d, lf, lc] = LINES;
            assert!((at(d) - ior).abs() < 1e-12);
            assert!(((at(d) - 1.0) / (at(lf) - at(lc)) - abbe).abs() < 1e-9);
            // Cauchy's formula is not the glass's own, but near it.
            assert!(
                (at(lf) - f).abs() < 2e-3 && (at(lc) - c).abs() < 2e-3,
                "{} {}",
                at(lf),
                at(lc)
            );
        }
    }
}
