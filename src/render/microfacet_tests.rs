use super::*;

/// A direction at `degrees` from the normal.
fn slanted(degrees: f64) -> DVec3 {
    let (sin, cos) = math::sin_cos_degrees(degrees);
    DVec3::new(sin, 0.0, cos)
}

/// Points of the unit square, evenly spread (Roberts' R2 sequence).
fn square(n: u32) -> impl Iterator<Item = DVec2> {
    (0..n).map(move |i| {
        let i = f64::from(i) + 0.5;
        DVec2::new(
            (i * 0.754_877_666_246_692_8).fract(),
            (i * 0.569_840_290_998_053_3).fract(),
        )
    })
}

/// The mean over a hemisphere of what `response` makes of a lamp's light: what it sends on where white light comes from all
/// sides. A lamp's response has pi times the reflectance, so the mean over the solid angle is 2 pi / pi.
fn albedo(n: u32, response: impl Fn(DVec3) -> f64) -> f64 {
    let sum: f64 = square(n)
        .map(|u| {
            let (z, phi) = (u.x, 2.0 * PI * u.y);
            let r = (1.0 - z * z).sqrt();
            response(DVec3::new(r * math::cos(phi), r * math::sin(phi), z))
        })
        .sum();
    2.0 * sum / f64::from(n)
}

#[test]
fn dielectrics_mirror_as_the_tables_say() {
    // Glass of 1.5: 4 % straight on, Brewster's angle, all of it beyond the critical angle.
    assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-12);
    assert!((fresnel_dielectric(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-12);
    assert_eq!(fresnel_dielectric(0.0, 1.5), 1.0);
    // 45 and 60 degrees (Hecht, "Optics", 4.6, from sine and tangent of the angles' sum and difference).
    for (degrees, expected) in [(45.0, 0.050_240), (60.0, 0.089_186), (80.0, 0.387_704)] {
        let (sin, cos) = math::sin_cos_degrees(degrees);
        let inside = math::asin(sin / 1.5);
        let outside = math::asin(sin);
        let s = math::sin(outside - inside) / math::sin(outside + inside);
        let p = math::tan(outside - inside) / math::tan(outside + inside);
        let found = fresnel_dielectric(cos, 1.5);
        assert!((found - 0.5 * (s * s + p * p)).abs() < 1e-12, "{degrees}");
        assert!((found - expected).abs() < 2e-4, "{degrees}: {found}");
    }
    let brewster = math::atan(1.5);
    let cos = math::cos(brewster);
    let s = math::sin(2.0 * brewster - PI / 2.0);
    assert!((fresnel_dielectric(cos, 1.5) - 0.5 * s * s).abs() < 1e-12);
    let critical = math::cos(math::asin(1.0 / 1.5));
    assert!(fresnel_dielectric(critical + 1e-3, 1.0 / 1.5) < 1.0);
    assert_eq!(fresnel_dielectric(critical - 1e-3, 1.0 / 1.5), 1.0);
}

#[test]
fn metals_mirror_by_the_complex_formula() {
    // Straight on: ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2).
    for (eta, k) in [(0.143, 3.98), (1.66, 8.8), (0.2, 0.0), (2.5, 1.0)] {
        let expected = ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k);
        assert!((fresnel_conductor(1.0, eta, k) - expected).abs() < 1e-12);
        assert!((fresnel_conductor(0.0, eta, k) - 1.0).abs() < 1e-12);
    }
    // Without absorption it is a dielectric.
    for i in 0..=20 {
        let cosine = f64::from(i) / 20.0;
        let difference = fresnel_conductor(cosine, 1.5, 0.0) - fresnel_dielectric(cosine, 1.5);
        assert!(difference.abs() < 1e-9, "{cosine}: {difference}");
    }
}

#[test]
fn the_tiny_mirrors_cover_the_surface() {
    for roughness in [0.2, 0.5, 1.0] {
        let ggx = Ggx::new(roughness).unwrap();
        // Their projected areas sum to 1, straight on and, those that are seen, from any side (PBR 9.17). Sampled by slope, since
        // they are dense about the normal.
        let area = |w: DVec3| {
            let n = 200_000;
            let sum: f64 = square(n)
                .map(|u| {
                    let (cos2, alpha2) = (
                        (1.0 - u.x) / (1.0 + (ggx.alpha * ggx.alpha - 1.0) * u.x),
                        ggx.alpha * ggx.alpha,
                    );
                    let (z, phi) = (cos2.sqrt(), 2.0 * PI * u.y);
                    let r = (1.0 - cos2).max(0.0).sqrt();
                    let h = DVec3::new(r * math::cos(phi), r * math::sin(phi), z);
                    let e = (alpha2 - 1.0) * cos2 + 1.0;
                    let pdf = alpha2 * z / (PI * e * e);
                    ggx.d(h) * w.dot(h).max(0.0) / pdf
                })
                .sum();
            sum / f64::from(n)
        };
        assert!((area(DVec3::Z) - 1.0).abs() < 1e-2, "{roughness}");
        for degrees in [30.0, 60.0, 80.0] {
            let w = slanted(degrees);
            let seen = area(w) * ggx.g1(w) / w.z;
            assert!((seen - 1.0).abs() < 2e-2, "{roughness} {degrees}: {seen}");
        }
    }
}

#[test]
fn visible_normals_come_as_often_as_their_density_says() {
    const ACROSS: usize = 12;
    const AROUND: usize = 16;
    for (roughness, degrees) in [(0.4, 0.0), (0.4, 50.0), (0.8, 75.0), (1.0, 85.0)] {
        let (ggx, w) = (Ggx::new(roughness).unwrap(), slanted(degrees));
        let place = |h: DVec3| {
            let phi = math::atan2(h.y, h.x) / (2.0 * PI) + 0.5;
            let bin = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
            bin(h.z, ACROSS) * AROUND + bin(phi, AROUND)
        };
        let n = 200_000u32;
        let sampler = crate::render::sampler::Sampler::new(11, 0, 0, 0);
        let mut counts = vec![0.0; ACROSS * AROUND];
        for i in 0..u64::from(n) {
            let h = ggx.visible(w, DVec2::new(sampler.get(2 * i), sampler.get(2 * i + 1)));
            assert!((h.length() - 1.0).abs() < 1e-9 && h.z >= 0.0);
            counts[place(h)] += 1.0;
        }
        // The density integrated over each cell of equal solid angle.
        let fine = 24;
        let (mut chi2, mut degrees_of_freedom, mut rest) = (0.0, 0.0, (0.0, 0.0));
        for (cell, count) in counts.iter().enumerate() {
            let (row, column) = ((cell / AROUND) as f64, (cell % AROUND) as f64);
            let mut density = 0.0;
            for i in 0..fine {
                for j in 0..fine {
                    let z = (row + (f64::from(i) + 0.5) / f64::from(fine)) / ACROSS as f64;
                    let phi =
                        2.0 * PI * ((column + (f64::from(j) + 0.5) / f64::from(fine)) / AROUND as f64 - 0.5);
                    let r = (1.0 - z * z).sqrt();
                    density += ggx.pdf(w, DVec3::new(r * math::cos(phi), r * math::sin(phi), z));
                }
            }
            let solid_angle = 2.0 * PI / (ACROSS * AROUND) as f64;
            let expected = f64::from(n) * density / f64::from(fine * fine) * solid_angle;
            // The innermost row is too steep for the quadrature; all others are compared.
            if row as usize == ACROSS - 1 || expected < 20.0 {
                rest = (rest.0 + count, rest.1 + expected);
                continue;
            }
            chi2 += (count - expected) * (count - expected) / expected;
            degrees_of_freedom += 1.0;
        }
        // Four standard deviations of the chi-square distribution.
        let bound = degrees_of_freedom + 4.0 * f64::sqrt(2.0 * degrees_of_freedom);
        assert!(
            chi2 < bound,
            "{roughness} {degrees}: {chi2} of {degrees_of_freedom}"
        );
        assert!(
            (rest.0 - rest.1).abs() < 0.02 * f64::from(n),
            "{roughness} {degrees}: {rest:?}"
        );
    }
}

#[test]
fn a_rough_mirror_in_a_furnace_keeps_within_its_light() {
    for roughness in [0.1, 0.3, 0.6, 1.0] {
        let ggx = Ggx::new(roughness).unwrap();
        for degrees in [0.0, 40.0, 70.0, 85.0] {
            let w = slanted(degrees);
            // By sampled rays: what single scattering keeps.
            let n = 20_000;
            let kept: f64 = square(n)
                .map(|u| {
                    let h = ggx.visible(w, u);
                    let onward = h * (2.0 * w.dot(h)) - w;
                    if onward.z > 0.0 { ggx.share(w, onward) } else { 0.0 }
                })
                .sum::<f64>()
                / f64::from(n);
            assert!(kept <= 1.0 + 1e-9 && kept > 0.3, "{roughness} {degrees}: {kept}");
            if roughness == 1.0 && degrees == 0.0 {
                // Mirrors in all directions alike: the integral of c / (1 + c).
                assert!((kept - (1.0 - math::ln(2.0))).abs() < 2e-3, "{kept}");
            }
            if roughness < 0.2 {
                assert!(kept > 0.95, "{roughness} {degrees}: {kept}");
            }
            // By lamps all around: the same, so that a lamp and its picture in the mirror agree.
            if roughness >= 0.6 {
                let lit = albedo(400_000, |l| ggx.highlight(w, l, (w + l).normalize()));
                assert!(
                    (lit - kept).abs() < 0.01,
                    "{roughness} {degrees}: {lit} by lamps, {kept} by rays"
                );
            }
        }
    }
}

#[test]
fn matt_surfaces_keep_within_their_light_and_begin_with_lambert() {
    for sigma in [0.0, 0.2, 0.5, 1.0] {
        for degrees in [0.0, 30.0, 60.0, 85.0] {
            let w = slanted(degrees);
            let white = albedo(100_000, |l| oren_nayar(sigma, w, l));
            assert!(white <= 1.0 + 1e-3 && white > 0.6, "{sigma} {degrees}: {white}");
            if sigma == 0.0 {
                assert!((white - 1.0).abs() < 1e-3, "{degrees}: {white}");
            }
        }
    }
    // Lambert is the limit, and light goes both ways alike.
    for (a, b) in [(20.0, 70.0), (60.0, -50.0), (0.0, 45.0)] {
        let (a, b) = (slanted(a), slanted(b));
        assert_eq!(oren_nayar(0.0, a, b), b.z);
        assert!((oren_nayar(1e-9, a, b) - b.z).abs() < 1e-8);
        let there = oren_nayar(0.7, a, b) / b.z;
        let back = oren_nayar(0.7, b, a) / a.z;
        assert!((there - back).abs() < 1e-12);
    }
    // The moon is as bright at its rim as in its middle: flatter than Lambert where light comes from behind the eye.
    let full = |degrees: f64| oren_nayar(1.0, slanted(degrees), slanted(degrees));
    assert!(full(60.0) / full(0.0) > 0.9);
}

#[test]
fn frames_are_right_handed() {
    for n in [DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::new(0.6, -0.48, 0.64)] {
        let (a, b) = frame(n);
        assert!(a.dot(b).abs() < 1e-12 && a.dot(n).abs() < 1e-12 && (a.length() - 1.0).abs() < 1e-12);
        assert!((a.cross(b) - n).length() < 1e-12, "{n}");
    }
}
