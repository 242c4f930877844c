use super::*;
use crate::scene::{Paint, Texture};

fn points(n: u32) -> impl Iterator<Item = DVec3> {
    (0..n).map(|i| {
        let i = f64::from(i);
        DVec3::new(
            (i * 0.618_034).fract(),
            (i * 0.754_878).fract(),
            (i * 0.569_84).fract(),
        ) * 8.0
            - DVec3::splat(4.0)
    })
}

fn value(kind: PatternKind, p: DVec3) -> f64 {
    Pattern::new(kind).value(p)
}

#[test]
fn every_pattern_stays_within_its_bounds() {
    for &(name, kind) in PatternKind::ALL {
        let mut extent = (f64::INFINITY, f64::NEG_INFINITY);
        for p in points(4000) {
            let t = Pattern::new(kind).wave.of(value(kind, p));
            assert!((0.0..=1.0).contains(&t), "{name} at {p}: {t}");
            extent = (extent.0.min(t), extent.1.max(t));
        }
        assert!(extent.0 < 0.4 && extent.1 > 0.6, "{name}: {extent:?}");
    }
}

#[test]
fn smooth_patterns_are_continuous() {
    use PatternKind as K;
    for kind in [
        K::Linear,
        K::Radial,
        K::Spherical,
        K::Wood,
        K::Marble,
        K::Granite,
        K::Worley,
        K::Cracks,
        K::Noise,
        K::Simplex,
        K::Fbm,
        K::Turbulence,
        K::Ripples,
    ] {
        for p in points(4000) {
            let step = value(kind, p + DVec3::new(1e-7, -1e-7, 1e-7)) - value(kind, p);
            assert!(step.abs() < 1e-4, "{} at {p}: {step}", kind.name());
        }
    }
}

#[test]
fn hexagons_are_those_of_the_nearest_center() {
    // Centers of hexagons of edge 1 with corners on the x axis, each with its color.
    let center = |q: i32, r: i32| {
        let (q, r) = (f64::from(q), f64::from(r));
        DVec3::new(1.5 * q, 0.0, 3.0_f64.sqrt() * (r + q / 2.0))
    };
    for p in points(2000) {
        let flat = DVec3::new(p.x, 0.0, p.z);
        let all = (-8..=8).flat_map(|q| (-8..=8).map(move |r| (q, r)));
        let mut nearest: Vec<(f64, i32)> = all
            .map(|(q, r)| ((center(q, r) - flat).length(), (q - r).rem_euclid(3)))
            .collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        if nearest[1].0 - nearest[0].0 > 1e-9 {
            assert_eq!(
                value(PatternKind::Hexagon, p),
                f64::from(nearest[0].1) * 0.5,
                "{p}"
            );
        }
    }
    // Neighbours differ.
    for (q, r) in [(1, 0), (0, 1), (-1, 1)] {
        assert_ne!(
            value(PatternKind::Hexagon, center(q, r)),
            value(PatternKind::Hexagon, DVec3::ZERO)
        );
    }
}

#[test]
fn bricks_lie_in_rows_half_a_brick_apart() {
    let pattern = Pattern {
        mortar: 0.02,
        ..Pattern::new(PatternKind::Brick)
    };
    // The first mortar joint to the right of x = -0.2 in the row about y = 0 and in the one above.
    let joint = |y: f64| {
        (0..1000)
            .map(|i| -0.2 + f64::from(i) * 1e-3)
            .find(|x| pattern.value(DVec3::new(*x, y, 0.0)) == 0.0)
            .unwrap()
    };
    assert!(
        ((joint(0.25) - joint(0.0)).abs() - 0.25).abs() < 2e-3,
        "{} {}",
        joint(0.0),
        joint(0.25)
    );
    // Share of a row that is mortar, along x.
    let in_mortar = (0..10_000).filter(|i| pattern.value(DVec3::new(f64::from(*i) * 1e-3, 0.0, 0.0)) == 0.0);
    assert!((in_mortar.count() as f64 / 10_000.0 - 0.02 / 0.5).abs() < 2e-3);
}

#[test]
fn gradients_are_linear_between_their_ends() {
    let pattern = Pattern {
        from: DVec3::new(1.0, 2.0, 3.0),
        to: DVec3::new(3.0, 2.0, 3.0),
        ..Pattern::new(PatternKind::Linear)
    };
    assert_eq!(pattern.value(DVec3::new(1.5, -7.0, 0.0)), 0.25);
    assert_eq!(value(PatternKind::Angular, DVec3::new(0.0, 3.0, 1.0)), 0.25);
    assert_eq!(value(PatternKind::Angular, DVec3::new(0.0, 3.0, -1.0)), 0.75);
    assert_eq!(value(PatternKind::Radial, DVec3::new(3.0, 9.0, 4.0)), 5.0);
}

#[test]
fn waves_go_up_and_down() {
    let at = |wave: Wave, x: f64| wave.of(x);
    assert_eq!(
        [
            at(Wave::Ramp, 1.25),
            at(Wave::Triangle, 1.25),
            at(Wave::Clamp, 1.25)
        ],
        [0.25, 0.75, 1.0]
    );
    assert_eq!(
        [at(Wave::Triangle, 0.25), at(Wave::Triangle, -0.25)],
        [0.25, 0.25]
    );
    assert!((at(Wave::Sine, 1.5) - 0.5).abs() < 1e-12);
}

#[test]
fn a_placed_pattern_is_the_pattern_at_the_point_before() {
    let plain = Texture::pattern(Pattern::new(PatternKind::Noise)).unwrap();
    let placement = Placement {
        scale: DVec3::new(2.0, 1.0, 0.5),
        rotate: DVec3::new(30.0, 0.0, 90.0),
        translate: DVec3::new(1.0, 2.0, 3.0),
        ..Placement::default()
    };
    let placed = Texture::placed(Paint::texture(std::sync::Arc::new(plain.clone())), placement).unwrap();
    let own = Texture::pattern(Pattern {
        placement,
        ..Pattern::new(PatternKind::Noise)
    })
    .unwrap();
    for p in points(200) {
        // Scaled, then turned about x and then z, then moved.
        let turned =
            math::rotation(DVec3::Z, 90.0) * (math::rotation(DVec3::X, 30.0) * (p * placement.scale));
        let there = turned + placement.translate;
        let expected = plain.color(crate::math::DVec2::ZERO, p);
        for texture in [&placed, &own] {
            let found = texture.color(crate::math::DVec2::ZERO, there);
            assert!(
                (found - expected).abs().max_element() < 1e-9,
                "{p}: {found} and not {expected}"
            );
        }
    }
}

#[test]
fn textures_within_textures_come_to_an_end() {
    let mut texture = std::sync::Arc::new(Texture::Checker {
        even: Color::ONE,
        odd: Color::ZERO,
        size: 1.0,
    });
    let message = loop {
        let paint = Paint::texture(std::sync::Arc::clone(&texture));
        match Texture::mix(paint.clone(), paint.clone(), paint) {
            Ok(mix) => texture = std::sync::Arc::new(mix),
            Err(e) => break e.message,
        }
    };
    assert!(message.contains("256"), "{message}");
}

#[test]
fn numbers_out_of_range_are_refused_by_name() {
    let refused = |change: &dyn Fn(&mut Pattern)| {
        let mut pattern = Pattern::new(PatternKind::Brick);
        change(&mut pattern);
        Texture::pattern(pattern).unwrap_err().message
    };
    assert!(refused(&|p| p.placement.scale.y = 0.0).starts_with("scale"));
    assert!(refused(&|p| p.placement.octaves = 99).starts_with("octaves"));
    assert!(refused(&|p| p.variation = f64::NAN).starts_with("variation"));
    assert!(refused(&|p| p.size.x = -1.0).starts_with("size"));
    assert!(refused(&|p| p.to = p.from).starts_with("from and to"));
}
