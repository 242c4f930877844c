//! A clear sky and its sun.

use crate::{
    color::Color,
    math::{self, DVec3, PI},
};

/// Candela per square meter, in thousands, that are 1.
const UNIT: f64 = 20.0;
/// Lux, in thousands, of the sun outside of the air.
const SUN: f64 = 127.5;

/// Colors of the sky by Preetham, Shirley and Smits ("A practical analytic model for daylight", 1999): Perez's function of the
/// angles to the zenith and to the sun, for the luminance and both chromaticities.
#[derive(Clone, Debug)]
pub(super) struct Daylight {
    sun: DVec3,
    /// Of Y, x and y: the five coefficients, and the value at the zenith over the function's there.
    perez: [([f64; 5], f64); 3],
}

impl Daylight {
    /// A sky with the sun in the direction `sun`.
    pub(super) fn new(sun: DVec3, turbidity: f64) -> Self {
        let sun = sun / sun.length();
        let t = turbidity;
        let theta = math::acos(sun.y.clamp(0.0, 1.0));
        let coefficients = [
            [
                0.1787 * t - 1.4630,
                -0.3554 * t + 0.4275,
                -0.0227 * t + 5.3251,
                0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703,
            ],
            [
                -0.0193 * t - 0.2592,
                -0.0665 * t + 0.0008,
                -0.0004 * t + 0.2125,
                -0.0641 * t - 0.8989,
                -0.0033 * t + 0.0452,
            ],
            [
                -0.0167 * t - 0.2608,
                -0.0950 * t + 0.0092,
                -0.0079 * t + 0.2102,
                -0.0441 * t - 1.6537,
                -0.0109 * t + 0.0529,
            ],
        ];
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta);
        let luminance = (4.0453 * t - 4.9710) * math::tan(chi) - 0.2155 * t + 2.4192;
        let chromaticity = |rows: [[f64; 4]; 3]| {
            let [a, b, c] = rows.map(|[a, b, c, d]| ((a * theta + b) * theta + c) * theta + d);
            (a * t + b) * t + c
        };
        let zenith = [
            luminance.max(0.0),
            chromaticity([
                [0.00166, -0.00375, 0.00209, 0.0],
                [-0.02903, 0.06377, -0.03202, 0.00394],
                [0.11693, -0.21196, 0.06052, 0.25886],
            ]),
            chromaticity([
                [0.00275, -0.00610, 0.00317, 0.0],
                [-0.04214, 0.08970, -0.04153, 0.00516],
                [0.15346, -0.26756, 0.06670, 0.26688],
            ]),
        ];
        let mut perez = [([0.0; 5], 0.0); 3];
        for ((place, coefficients), zenith) in perez.iter_mut().zip(coefficients).zip(zenith) {
            *place = (
                coefficients,
                zenith / function(&coefficients, 1.0, sun.y.clamp(0.0, 1.0), theta),
            );
        }
        Self { sun, perez }
    }

    /// The light of the sky in the direction of a unit vector that does not point below the horizon.
    pub(super) fn color(&self, dir: DVec3) -> Color {
        let cosine = dir.dot(self.sun).clamp(-1.0, 1.0);
        let gamma = math::acos(cosine);
        // The function is not defined on the horizon.
        let up = dir.y.max(0.01);
        let [luminance, x, y] = self
            .perez
            .map(|(coefficients, scale)| scale * function(&coefficients, up, cosine, gamma));
        rgb(luminance.max(0.0) / UNIT, x, y)
    }
}

/// (1 + A e^(B / cos theta)) (1 + C e^(D gamma) + E cos^2 gamma).
fn function([a, b, c, d, e]: &[f64; 5], up: f64, cosine: f64, gamma: f64) -> f64 {
    (1.0 + a * math::exp(b / up)) * (1.0 + c * math::exp(d * gamma) + e * cosine * cosine)
}

/// Linear sRGB of a luminance and a chromaticity (IEC 61966-2-1), without negative parts.
fn rgb(luminance: f64, x: f64, y: f64) -> Color {
    if !(y > 0.0) {
        return Color::ZERO;
    }
    let (big_x, big_z) = (x / y * luminance, (1.0 - x - y) / y * luminance);
    Color::new(
        3.2406 * big_x - 1.5372 * luminance - 0.4986 * big_z,
        -0.9689 * big_x + 1.8758 * luminance + 0.0415 * big_z,
        0.0557 * big_x - 0.2040 * luminance + 1.0570 * big_z,
    )
    .max(Color::ZERO)
}

/// What arrives of the sun through the air, in the unit of lights: the paper's transmittances at 615, 535 and 445 nm by
/// molecules, by haze of the turbidity's amount, and by ozone.
pub(crate) fn sunlight(sun: DVec3, turbidity: f64) -> Color {
    let height = (sun.y / sun.length()).clamp(0.0, 1.0);
    let degrees = math::acos(height).to_degrees();
    // Kasten's relative optical mass, in the paper's form.
    let mass = 1.0 / (height + 0.15 * math::pow(93.885 - degrees, -1.253));
    let haze = 0.04608 * turbidity - 0.04586;
    let through = |micrometers: f64, ozone: f64| {
        let molecules = 0.008735 * math::pow(micrometers, -4.08);
        let aerosol = haze * math::pow(micrometers, -1.3);
        math::exp(-(molecules + aerosol + ozone * 0.35) * mass)
    };
    let color = Color::new(through(0.615, 0.115), through(0.535, 0.07), through(0.445, 0.003));
    color * (SUN / PI / UNIT)
}
