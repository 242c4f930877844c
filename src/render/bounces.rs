//! How much light a rough mirror keeps, and what to give back of the rest.
//!
//! Light that one of the tiny mirrors of [`Ggx`] throws at another is lost where each is looked at alone. How much is left in all is
//! the directional albedo, tabulated here over roughness and angle. Scaling the mirror by its inverse gives all of it back (Turquin,
//! "Practical multiple scattering compensation for microfacet models", 2019); where mirrors are no perfect ones, each further
//! bounce loses light and gains color (Kulla and Conty, "Revisiting physically based shading at Imageworks", SIGGRAPH 2017).

#![allow(
    clippy::indexing_slicing,
    reason = "places in the tables are clamped to their sizes"
)]

#[cfg(doc)]
use super::microfacet::Ggx;
use crate::color::Color;

/// Entries along each side of the table.
const SIDE: usize = 24;

/// The share of white light from all sides that is mirrored to an eye, in 65535ths: a row for each roughness from 0 to 1, in it the
/// square root of the cosine from 0 to 1. The integral of what [`Ggx::visible`] samples by Gauss-Legendre quadrature, 96 points each
/// way, which a test of this file repeats.
#[rustfmt::skip]
const KEPT: [[u16; SIDE]; SIDE] = [
    [65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535,
     65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535],
    [64816, 58462, 63212, 65060, 65392, 65481, 65511, 65520, 65525, 65532, 65533, 65534,
     65534, 65534, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535, 65535],
    [65353, 62427, 58460, 60437, 63212, 64529, 65060, 65284, 65392, 65447, 65481, 65495,
     65511, 65517, 65520, 65523, 65525, 65528, 65533, 65534, 65534, 65535, 65535, 65535],
    [65454, 64054, 60610, 58443, 59356, 61499, 63196, 64198, 64746, 65046, 65217, 65318,
     65378, 65420, 65446, 65467, 65477, 65486, 65499, 65503, 65505, 65507, 65508, 65509],
    [65489, 64675, 62396, 59778, 58406, 58869, 60376, 61951, 63157, 63964, 64479, 64803,
     65012, 65148, 65238, 65304, 65345, 65381, 65400, 65422, 65435, 65440, 65445, 65448],
    [65505, 64963, 63394, 61243, 59294, 58332, 58577, 59641, 60959, 62155, 63090, 63767,
     64241, 64570, 64799, 64959, 65072, 65157, 65218, 65263, 65295, 65327, 65341, 65350],
    [65512, 65116, 63956, 62263, 60418, 58924, 58194, 58328, 59098, 60168, 61260, 62216,
     62985, 63572, 64011, 64335, 64573, 64751, 64882, 64982, 65062, 65117, 65172, 65204],
    [65517, 65201, 64287, 62921, 61306, 59747, 58559, 57979, 58036, 58601, 59460, 60416,
     61328, 62124, 62778, 63300, 63707, 64021, 64264, 64452, 64599, 64711, 64800, 64870],
    [65518, 65247, 64475, 63322, 61920, 60446, 59114, 58136, 57634, 57642, 58063, 58759,
     59587, 60432, 61217, 61907, 62487, 62965, 63352, 63662, 63910, 64107, 64264, 64402],
    [65519, 65268, 64575, 63560, 62306, 60936, 59594, 58431, 57598, 57154, 57110, 57421,
     57983, 58691, 59454, 60205, 60899, 61514, 62042, 62487, 62857, 63163, 63415, 63629],
    [65519, 65271, 64620, 63670, 62512, 61223, 59908, 58678, 57643, 56901, 56485, 56404,
     56624, 57072, 57672, 58351, 59052, 59730, 60356, 60918, 61409, 61833, 62194, 62506],
    [65517, 65264, 64618, 63700, 62578, 61336, 60041, 58780, 57638, 56689, 56001, 55592,
     55477, 55615, 55960, 56456, 57050, 57693, 58342, 58967, 59548, 60075, 60544, 60946],
    [65516, 65250, 64583, 63655, 62543, 61304, 60008, 58714, 57494, 56414, 55523, 54856,
     54446, 54277, 54338, 54594, 55001, 55514, 56091, 56697, 57305, 57891, 58443, 58957],
    [65513, 65229, 64526, 63563, 62417, 61151, 59825, 58490, 57203, 56011, 54961, 54092,
     53433, 52993, 52774, 52755, 52916, 53229, 53654, 54159, 54713, 55287, 55862, 56420],
    [65511, 65200, 64444, 63420, 62218, 60897, 59515, 58118, 56748, 55455, 54272, 53233,
     52364, 51688, 51205, 50921, 50817, 50884, 51094, 51423, 51840, 52326, 52849, 53381],
    [65507, 65166, 64343, 63248, 61963, 60559, 59094, 57611, 56151, 54747, 53436, 52245,
     51194, 50304, 49587, 49049, 48685, 48489, 48450, 48548, 48766, 49080, 49477, 49917],
    [65504, 65125, 64231, 63037, 61655, 60149, 58578, 56988, 55418, 53898, 52454, 51115,
     49897, 48817, 47886, 47112, 46498, 46044, 45743, 45582, 45557, 45648, 45842, 46114],
    [65500, 65081, 64101, 62805, 61302, 59677, 57980, 56267, 54570, 52918, 51337, 49850,
     48468, 47210, 46082, 45093, 44248, 43547, 42986, 42567, 42277, 42108, 42056, 42096],
    [65496, 65036, 63959, 62543, 60912, 59149, 57314, 55461, 53621, 51826, 50100, 48460,
     46919, 45489, 44177, 42990, 41933, 41003, 40204, 39528, 38980, 38548, 38227, 38003],
    [65491, 64988, 63810, 62265, 60489, 58575, 56588, 54581, 52588, 50640, 48761, 46965,
     45265, 43670, 42185, 40816, 39563, 38429, 37410, 36507, 35715, 35033, 34452, 33966],
    [65486, 64935, 63647, 61963, 60035, 57961, 55811, 53639, 51485, 49377, 47338, 45384,
     43525, 41771, 40124, 38586, 37160, 35843, 34634, 33530, 32527, 31624, 30814, 30089],
    [65482, 64879, 63475, 61649, 59559, 57314, 54992, 52649, 50325, 48052, 45852, 43739,
     41726, 39818, 38018, 36328, 34747, 33272, 31901, 30630, 29455, 28372, 27375, 26457],
    [65478, 64819, 63298, 61316, 59060, 56639, 54139, 51618, 49122, 46680, 44318, 42049,
     39886, 37832, 35893, 34067, 32351, 30745, 29241, 27838, 26530, 25312, 24178, 23124],
    [65473, 64756, 63111, 60975, 58541, 55940, 53255, 50555, 47883, 45275, 42753, 40334,
     38028, 35840, 33773, 31827, 29999, 28285, 26680, 25180, 23779, 22470, 21249, 20112],
];

/// The mean of each row over all directions, weighted by the cosine.
#[rustfmt::skip]
const MEAN: [u16; SIDE] = [
    65535, 65534, 65518, 65445, 65280, 65001, 64576, 63911, 63047, 61901, 60477, 58771,
    56806, 54574, 52112, 49455, 46648, 43741, 40783, 37825, 34912, 32086, 29377, 26813,
];

/// Where between which entries `x` from 0 to 1 lies.
fn place(x: f64) -> (usize, f64) {
    let x = x.clamp(0.0, 1.0) * (SIDE - 1) as f64;
    let below = (x.floor() as usize).min(SIDE - 2);
    (below, x - below as f64)
}

/// What a perfect mirror of this roughness keeps of white light, seen at this angle.
fn kept(roughness: f64, cosine: f64) -> f64 {
    let ((row, down), (column, right)) = (place(roughness), place(cosine.max(0.0).sqrt()));
    let along = |row: usize| {
        let [a, b] = [KEPT[row][column], KEPT[row][column + 1]].map(f64::from);
        a * (1.0 - right) + b * right
    };
    (along(row) * (1.0 - down) + along(row + 1) * down) / 65535.0
}

fn mean_kept(roughness: f64) -> f64 {
    let (row, down) = place(roughness);
    let [a, b] = [MEAN[row], MEAN[row + 1]].map(f64::from);
    (a * (1.0 - down) + b * down) / 65535.0
}

/// Points that the mean over all directions is taken at.
const ANGLES: u32 = 8;

/// What to multiply a rough mirror by, so that what is thrown from one of its tiny mirrors to another is not lost. `share` is what
/// these mirror at an angle with this cosine.
pub(super) fn compensation(roughness: f64, cosine: f64, share: impl Fn(f64) -> Color) -> Color {
    // Cosines whose squares are evenly spread stand for equal parts of what arrives.
    let angles = (0..ANGLES).map(|i| ((f64::from(i) + 0.5) / f64::from(ANGLES)).sqrt());
    let sum = angles.fold(Color::ZERO, |sum, cosine| sum + share(cosine));
    let mean_share = (sum / f64::from(ANGLES)).clamp(Color::ZERO, Color::ONE);
    let mean_kept = mean_kept(roughness);
    // The sum over all further bounces, which is 1 where none loses light.
    let further = mean_share * mean_kept / (Color::ONE - mean_share * (1.0 - mean_kept));
    let kept = kept(roughness, cosine);
    Color::ONE + further * ((1.0 - kept) / kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::{self, DVec2, DVec3},
        render::microfacet::Ggx,
    };

    /// What is kept by a mirror of this roughness seen at this angle, by many samples.
    fn by_samples(roughness: f64, cosine: f64) -> f64 {
        let Some(ggx) = Ggx::new(roughness) else {
            return 1.0;
        };
        let eye = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let side = 128;
        let mut sum = 0.0;
        for i in 0..side * side {
            let u = DVec2::new(f64::from(i % side) + 0.5, f64::from(i / side) + 0.5) / f64::from(side);
            let h = ggx.visible(eye, u);
            let onward = h * (2.0 * eye.dot(h)) - eye;
            if onward.z > 0.0 {
                sum += ggx.share(eye, onward);
            }
        }
        sum / f64::from(side * side)
    }

    #[test]
    fn a_white_mirror_gives_back_all_light() {
        for roughness in [0.1, 0.2, 0.35, 0.5, 0.63, 0.75, 0.9, 1.0] {
            for cosine in [0.06, 0.15, 0.3, 0.5, 0.71, 0.9, 1.0] {
                let back = by_samples(roughness, cosine) * compensation(roughness, cosine, |_| Color::ONE).x;
                assert!((0.99..1.01).contains(&back), "{roughness} {cosine}: {back}");
            }
        }
    }

    #[test]
    fn the_means_are_those_of_the_rows() {
        for row in 0..SIDE {
            let roughness = row as f64 / (SIDE - 1) as f64;
            let n = 2000;
            let sum: f64 = (0..n)
                .map(|i| kept(roughness, ((f64::from(i) + 0.5) / f64::from(n)).sqrt()))
                .sum();
            let mean = sum / f64::from(n);
            assert!((mean - mean_kept(roughness)).abs() < 2e-3, "{row}: {mean}");
        }
        // Mirrors in all directions alike keep 1 - ln 2 of what comes straight on.
        assert!((kept(1.0, 1.0) - (1.0 - math::ln(2.0))).abs() < 1e-4);
    }

    #[test]
    fn further_bounces_lose_light_and_gain_color() {
        let gold = Color::new(0.97, 0.8, 0.35);
        let boost = compensation(0.8, 0.6, |_| gold);
        assert!(boost.x > boost.y && boost.y > boost.z && boost.z > 1.0, "{boost}");
        // Each bounce of a gray mirror keeps half: a geometric series, whose first term is the share that is thrown on.
        let (kept, mean) = (kept(0.8, 0.6), mean_kept(0.8));
        let mut series = 0.0;
        let mut thrown = 1.0 - kept;
        for _ in 0..60 {
            // Of what is on its way between the mirrors, this share leaves after a bounce, and the rest goes on.
            thrown *= 0.5;
            series += thrown * mean;
            thrown *= 1.0 - mean;
        }
        let found = compensation(0.8, 0.6, |_| Color::splat(0.5)).x;
        let expected = 1.0 + series / kept;
        assert!((found - expected).abs() < 1e-9, "{found} and not {expected}");
        assert_eq!(compensation(0.0, 0.5, |_| gold), Color::ONE);
    }
}
