//! Highlights that are left out because nobody can see them.

use super::*;
use crate::{
    render::{integrator::Counts, interrupt::Interrupt, tiles, world::World},
    scene::Scene,
};

/// Balls of glass and mirrors, some in the shadow of others, and lights one of which takes light away.
fn scene(background: Color, kt: f64) -> Scene {
    let mut b = Builder::new();
    b.size(40, 30).unwrap();
    b.max_depth(6).unwrap();
    b.background(background).unwrap();
    b.camera(Camera::new(DVec3::new(0.3, 2.0, 7.0), DVec3::ZERO, DVec3::Y, 40.0).unwrap());
    b.point(DVec3::new(4.0, 6.0, 5.0), Color::new(0.9, 0.8, 0.7))
        .unwrap();
    b.point(DVec3::new(-5.0, 3.0, 2.0), Color::new(0.3, -0.2, 0.4))
        .unwrap();
    b.directional(DVec3::new(0.1, 1.0, 0.2), Color::splat(0.2))
        .unwrap();
    b.material_mut().ambient = Term::BLACK;
    b.material_mut().specular = Term::color(Color::new(0.6, 0.5, 0.7));
    b.material_mut().shininess = 120.0;
    for i in 0..9 {
        let share = if i % 3 == 0 { 0.0 } else { kt };
        b.material_mut().transmission = Term::color(Color::new(share, 0.9 * share, share));
        b.material_mut().reflection = Some(Term::color(Color::splat(0.3)));
        b.sphere(
            DVec3::new(
                f64::from(i % 3) - 1.0,
                0.2 * f64::from(i % 2),
                f64::from(i / 3) - 1.0,
            ) * 1.1,
            0.5,
        )
        .unwrap();
    }
    b.finish().value
}

fn trace(world: &World<'_>) -> (Vec<[u64; 3]>, Counts) {
    let settings = &world.scene.settings;
    let interrupt = Interrupt::new(&NoHost);
    let (image, counts) =
        tiles::trace(world, settings, &RenderOptions::default(), &NoHost, &interrupt).unwrap();
    let pixels = image.pixels().iter().map(|p| p.map(f64::to_bits));
    (pixels.collect(), counts)
}

#[test]
fn what_is_left_out_changes_no_bit() {
    for (background, kt) in [
        (Color::new(0.3, 0.4, 0.6), 0.9),
        (Color::ZERO, 0.9),
        (Color::new(0.1, -0.2, 1e-12), 0.9),
        (Color::new(0.3, 0.4, 0.6), 1.1),
    ] {
        let scene = scene(background, kt);
        let mut world = World::compile(&scene).unwrap();
        assert_eq!(world.shadows_dim, kt < 1.0);
        let (pixels, counts) = trace(&world);
        world.shadows_dim = false;
        let (all_pixels, all) = trace(&world);
        assert_eq!(pixels, all_pixels);
        if kt < 1.0 {
            assert!(counts.shadow < all.shadow, "{} of {}", counts.shadow, all.shadow);
        }
        if kt < 1.0 && background.x > 0.2 {
            assert!(
                counts.shadow * 3 < all.shadow * 2,
                "{} of {}",
                counts.shadow,
                all.shadow
            );
        }
    }
}
