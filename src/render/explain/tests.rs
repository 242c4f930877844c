//! What is explained is what is rendered, to the bit.

use proptest::prelude::*;

use super::*;
use crate::{
    Builder, NoHost, Scene,
    render::{Image, RenderOptions, render},
    scene::{Attenuation, Environment, Falloff, Fog, Haze, Occlusion, Sky, Spot, SurfaceLight, Term},
    shape::{Cuboid, Plane, Shape, Torus},
};

fn picture(scene: &Scene, single_rays: bool) -> Image {
    let options = RenderOptions {
        single_rays,
        ..RenderOptions::default()
    };
    render(scene, &options, &NoHost).unwrap().value.image
}

/// Things of glass, metal and plaster, one in another, under lights of every kind.
fn room(numbers: &[f64; 40], samples: u32, depth: u32, cells: u32) -> Scene {
    let mut next = numbers.iter().copied().cycle();
    let mut next = || next.next().unwrap_or(0.5);
    let mut b = Builder::new();
    b.size(10, 8).unwrap();
    b.samples(samples).unwrap();
    b.max_depth(depth).unwrap();
    b.background(DVec3::new(0.1, 0.2, 0.3)).unwrap();
    b.attenuation(Attenuation {
        constant: 1.0,
        linear: 0.0,
        quadratic: 0.01 * next(),
    })
    .unwrap();
    b.point(DVec3::new(4.0 * next() - 2.0, 4.0, 3.0), DVec3::splat(0.6))
        .unwrap();
    b.directional(DVec3::new(next() - 0.5, 1.0, next()), DVec3::splat(0.3))
        .unwrap();
    let corner = DVec3::new(-3.0 + next(), 5.0, -1.0);
    b.area_light(corner, DVec3::X * 2.0, DVec3::Z * 2.0, DVec3::splat(0.5), cells)
        .unwrap();
    let spot = Spot::new(corner, DVec3::ZERO, (25.0, 10.0), 0.0, b.current_attenuation()).unwrap();
    b.spot(spot, DVec3::splat(0.5)).unwrap();
    let center = DVec3::new(2.0, 3.0, 2.0 * next());
    let ball = SurfaceLight::sphere(center, 0.5, cells.min(4), Falloff::Physical).unwrap();
    b.surface_light(ball, DVec3::splat(4.0)).unwrap();
    if next() > 0.4 {
        let sky = Sky::Gradient {
            zenith: DVec3::new(0.1, 0.2, 0.4),
            horizon: DVec3::splat(0.4),
            ground: DVec3::ZERO,
        };
        b.environment(Some(
            Environment::new(sky, DVec3::ONE, 0.0, cells.min(3)).unwrap(),
        ))
        .unwrap();
    }
    if next() > 0.5 {
        b.ambient_occlusion(Some(Occlusion::new(2.0, 2).unwrap()));
    }
    if next() > 0.5 {
        b.fog(Some(Fog::new(DVec3::splat(0.3), 20.0, 0.0, Some(3.0)).unwrap()));
    }
    if next() > 0.5 {
        b.haze(Some(Haze::new(0.05, DVec3::new(1.0, 0.9, 0.8), 0.2, 3).unwrap()));
    }
    for i in 0..7 {
        let kind = (3.0 * next()) as u32;
        let material = b.material_mut();
        *material = Default::default();
        material.diffuse = Term::color(DVec3::new(next(), next(), next()) * 0.6);
        material.emission = Term::color(DVec3::splat(0.05 * next()));
        if kind > 0 {
            material.specular = Term::color(DVec3::splat(0.5 * next()));
            material.shininess = 20.0;
        }
        if kind > 1 {
            material.diffuse = Term::BLACK;
            material.transmission = Term::color(DVec3::new(0.9, 0.9 * next(), 0.8));
            material.ior = 1.0 + next();
        }
        b.push_transform().unwrap();
        b.translate(DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5) * 4.0)
            .unwrap();
        match i % 3 {
            0 => b.sphere(DVec3::ZERO, 0.4 + next()).unwrap(),
            1 => b
                .shape(Shape::Cuboid(Cuboid::new(DVec3::splat(0.4 + next())).unwrap()))
                .unwrap(),
            _ => b.shape(Shape::Torus(Torus::new(0.8, 0.3).unwrap())).unwrap(),
        }
        b.pop_transform().unwrap();
    }
    b.translate(DVec3::NEG_Y * 2.0).unwrap();
    b.shape(Shape::Plane(Plane)).unwrap();
    b.finish().value
}

fn near(a: Color, b: Color) -> bool {
    (a - b).abs().max_element() <= 1e-12 * b.abs().max_element()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn the_parts_add_up_to_the_rendered_pixel(
        numbers in prop::array::uniform(0.0..1.0f64),
        samples in 1..6u32,
        depth in 0..7u32,
        cells in 1..12u32,
    ) {
        let scene = room(&numbers, samples, depth, cells);
        let (alone, together) = (picture(&scene, true), picture(&scene, false));
        let world = World::compile(&scene).unwrap();
        for (x, y) in (0..8).flat_map(|y| (0..10).map(move |x| (x, y))) {
            let explained = world.explain(x, y, &NoHost).unwrap();
            prop_assert_eq!(Some(explained.value), alone.pixel(x, y));
            prop_assert_eq!(Some(explained.value), together.pixel(x, y));
            for sample in &explained.samples {
                prop_assert_eq!(sample.sum(), sample.value);
                let added = sample.rays.iter().fold(Color::ZERO, |sum, ray| sum + ray.added);
                prop_assert_eq!(added, sample.value);
                for (i, ray) in sample.rays.iter().enumerate() {
                    let Some(hit) = &ray.hit else { continue };
                    prop_assert_eq!(hit.local(), hit.ambient + hit.emission + hit.direct);
                    for branch in &hit.branches {
                        if let BranchOutcome::Followed(child) = branch.outcome {
                            let child = &sample.rays[child];
                            prop_assert_eq!((child.parent, child.kind), (Some(i), branch.kind));
                            prop_assert_eq!((child.weight, child.depth), (branch.weight, ray.depth + 1));
                            prop_assert!(child.origin == hit.position);
                        }
                    }
                    for light in hit.lights.iter().flat_map(|light| &light.samples) {
                        prop_assert!(near(light.diffuse + light.specular, light.added), "{:?}", light);
                        let through = light.obstacles.iter().fold(Color::ONE, |share, o| share * o.share);
                        prop_assert_eq!(through, light.visible);
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_not_there_is_not_explained() {
    let scene = room(&[0.5; 40], 2, 2, 2);
    let world = World::compile(&scene).unwrap();
    let error = |result: Result<ExplainedSample<'_>, Error>| result.unwrap_err().diagnostic.message;
    assert_eq!(
        error(world.explain_sample(10, 0, 0, &NoHost)),
        "there is no pixel 10,0 in a picture of 10 x 8: they count from 0,0 at the top left"
    );
    assert_eq!(
        error(world.explain_sample(0, 0, 2, &NoHost)),
        "there is no sample 2: a pixel has 2 here, counted from 0"
    );
}
