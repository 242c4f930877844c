//! Smooth noise that is the same everywhere.

use rhai::Dynamic;

use super::{number, vec3};
use crate::{
    math::DVec3,
    script::{
        call::Call,
        table::{Entry, Group},
        value::Outcome,
    },
};

pub(super) const ENTRIES: &[Entry] = &[
    Entry::pure(Group::Random, "noise", noise)
        .takes(&[
            &[number("x", "none", "along a line")],
            &[
                number("x", "none", "in a plane"),
                number("y", "none", "in a plane"),
            ],
            &[vec3("v", "none", "in space")],
        ])
        .returns("float")
        .doc("Smooth noise between -1 and 1, 0 at whole numbers: hills of about one unit in size. It does not depend on the seed; add an offset to see another part of it.")
        .usage("noise(0.3, 1.7)")
        .example("background(\"#cfe3f5\");\nlight([3, 8, 4], [1, 1, 1]);\ndiffuse(0.3, 0.6, 0.3);\ncamera([0, 5, 8], [0, -0.3, 0], [0, 1, 0], 40);\nfor x in -12..13 {\n  for z in -12..13 {\n    sphere(x * 0.25, noise(x * 0.25, z * 0.25) * 1.2, z * 0.25, 0.16);\n  }\n}")
        .also(&["perlin", "simplex", "snoise"]),
];

fn noise(call: &mut Call<'_, '_>) -> Outcome {
    let p = match call.len() {
        2 => DVec3::new(call.number("x")?, call.number("y")?, 0.0),
        1 if call.peek().is_some_and(|d| d.is_int() || d.is_float()) => {
            DVec3::new(call.number("x")?, 0.0, 0.0)
        }
        _ => call.vec3("v")?,
    };
    call.end()?;
    if p.abs().max_element() > 1e9 {
        return Err(call.error("beyond 1e9 there is no noise, for want of digits"));
    }
    Ok(Dynamic::from(gradient_noise(p)))
}

/// Gradient noise with Perlin's fifth-degree fade and twelve gradients ("Improving noise", SIGGRAPH 2002), the
/// gradients chosen by an integer hash instead of a table, so that nothing repeats.
fn gradient_noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let fade = f.map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
    let [i, j, k] = cell.to_array().map(|c| c as i64);
    let corner = |x: i64, y: i64, z: i64| {
        let d = f - DVec3::new(x as f64, y as f64, z as f64);
        slope(hash(i + x, j + y, k + z), d)
    };
    let along_x = |y, z| lerp(corner(0, y, z), corner(1, y, z), fade.x);
    let along_y = |z| lerp(along_x(0, z), along_x(1, z), fade.y);
    lerp(along_y(0), along_y(1), fade.z)
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// The dot product of `d` with one of the directions to the middles of a cube's twelve edges.
fn slope(hash: u64, d: DVec3) -> f64 {
    let [a, b] = match hash % 12 / 4 {
        0 => [d.x, d.y],
        1 => [d.x, d.z],
        _ => [d.y, d.z],
    };
    let signed = |bit: u64, x: f64| if hash & bit == 0 { x } else { -x };
    signed(1, a) + signed(2, b)
}

/// Three whole numbers to 64 well-mixed bits, by the finalizer of SplitMix64 (see `random.rs`).
fn hash(x: i64, y: i64, z: i64) -> u64 {
    [x, y, z].into_iter().fold(0x6e6f_6973_6500_0000, |h, c| {
        super::random::mix(h ^ c.cast_unsigned().wrapping_mul(0x9e37_79b9_7f4a_7c15))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_bounded_and_zero_at_whole_points() {
        let mut extent = (0.0f64, 0.0f64);
        for i in 0..4000 {
            let p = DVec3::new(0.371, 0.913, 0.577) * (f64::from(i) * 0.37);
            let n = gradient_noise(p);
            extent = (extent.0.min(n), extent.1.max(n));
            let step = gradient_noise(p + DVec3::splat(1e-6)) - n;
            assert!(step.abs() < 1e-5, "{p}: {step}");
        }
        assert!(
            extent.0 > -1.0 && extent.0 < -0.6 && extent.1 < 1.0 && extent.1 > 0.6,
            "{extent:?}"
        );
        assert_eq!(gradient_noise(DVec3::new(3.0, -7.0, 12.0)), 0.0);
        assert_ne!(
            gradient_noise(DVec3::splat(0.5)),
            gradient_noise(DVec3::splat(256.5))
        );
    }
}
