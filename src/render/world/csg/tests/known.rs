//! Solids of which it is known what they are: by a formula, by another way to make them, or by what is said of them.

use std::sync::Arc;

use super::{box_mesh, crossings};
use crate::{
    Builder, DVec3, NoHost, RenderOptions,
    math::{self, Bounds3, DVec2, Ray},
    render::{
        render,
        world::{Probe, World},
    },
    scene::{Camera, CsgOp, Term, Texture},
    shape::{CrossingSink, Crossings, Cuboid, CustomShape, Cylinder, Disk, Plane, Shape, Sphere, Surface},
};

/// The volume within [-2, 2]^3, by the chords of a grid of lines.
fn volume(build: impl Fn(&mut Builder)) -> f64 {
    const N: i32 = 200;
    let mut b = Builder::new();
    build(&mut b);
    let scene = b.finish().value;
    let world = World::compile(&scene).unwrap();
    let step = 4.0 / f64::from(N);
    let mut sum = 0.0;
    for i in 0..N * N {
        let place = |k: i32| (f64::from(k) + 0.5) * step - 2.0;
        // Askew, so that nothing lines up with the grid.
        let ray = Ray::new(
            DVec3::new(place(i % N) + 1e-4, place(i / N) + 2e-4, 5.0),
            DVec3::NEG_Z,
        );
        let found = crossings(&world, &ray);
        sum += found.chunks(2).map(|pair| pair[1].0 - pair[0].0).sum::<f64>();
    }
    sum * step * step
}

#[test]
fn volumes_are_those_of_the_closed_forms() {
    let pi = math::PI;
    let both = |op: CsgOp, first: Shape, second: Shape, turn: f64, apart: f64| {
        volume(|b| {
            let mark = b.begin_csg(op).unwrap();
            b.shape(first.clone()).unwrap();
            b.translate(DVec3::new(apart, 0.0, 0.0)).unwrap();
            b.rotate(DVec3::Z, turn).unwrap();
            b.shape(second.clone()).unwrap();
            b.end_csg(mark, true).unwrap();
        })
    };
    let sphere = || Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0).unwrap());
    let pipe = |radius| Shape::Cylinder(Cylinder::new(radius, 3.0).unwrap());
    let cube = || Shape::Cuboid(Cuboid::new(DVec3::splat(2.0)).unwrap());
    let lens = pi * (4.0 + 1.2) * (2.0 - 1.2) * (2.0 - 1.2) / 12.0;
    let ball = 4.0 / 3.0 * pi;
    for (found, expected) in [
        (both(CsgOp::Intersection, sphere(), sphere(), 0.0, 1.2), lens),
        (both(CsgOp::Union, sphere(), sphere(), 0.0, 0.8), {
            2.0 * ball - pi * (4.0 + 0.8) * 1.2 * 1.2 / 12.0
        }),
        (both(CsgOp::Difference, sphere(), sphere(), 0.0, 1.2), ball - lens),
        // Steinmetz' solid of two cylinders.
        (
            both(CsgOp::Intersection, pipe(1.0), pipe(1.0), 90.0, 0.0),
            16.0 / 3.0,
        ),
        (
            both(CsgOp::Difference, cube(), pipe(0.5), 0.0, 0.0),
            8.0 - pi * 0.25 * 2.0,
        ),
        // All that lies below.
        (
            both(CsgOp::Intersection, sphere(), Shape::Plane(Plane), 30.0, 0.0),
            ball / 2.0,
        ),
        (
            both(CsgOp::Difference, sphere(), Shape::Plane(Plane), 30.0, 0.0),
            ball / 2.0,
        ),
    ] {
        assert!((found - expected).abs() < 6e-3, "{found}, not {expected}");
    }
}

/// A checkered floor with glass on it.
fn picture(glass: impl Fn(&mut Builder)) -> String {
    let mut b = Builder::new();
    b.size(48, 36).unwrap();
    b.camera(Camera::new(DVec3::new(0.0, 2.0, 6.0), DVec3::ZERO, DVec3::Y, 40.0).unwrap());
    b.directional(DVec3::new(0.5, 1.0, 0.4), DVec3::ONE).unwrap();
    b.area_light(DVec3::new(-3.0, 4.0, 1.0), DVec3::X, DVec3::Z, DVec3::ONE, 2)
        .unwrap();
    let checker = Texture::Checker {
        even: DVec3::splat(0.8),
        odd: DVec3::splat(0.2),
        size: 0.7,
    };
    let checker = b.texture(&Arc::new(checker));
    b.push_transform().unwrap();
    b.translate(DVec3::new(0.0, -1.6, 0.0)).unwrap();
    b.material_mut().diffuse = Term {
        color: DVec3::ONE,
        texture: Some(checker),
    };
    b.shape(Shape::Plane(Plane)).unwrap();
    b.pop_transform().unwrap();
    b.material_mut().diffuse = Term::color(DVec3::splat(0.1));
    b.material_mut().transmission = Term::color(DVec3::new(0.9, 0.8, 0.7));
    b.material_mut().reflection = Some(Term::color(DVec3::splat(0.1)));
    b.material_mut().ior = 1.5;
    glass(&mut b);
    let scene = b.finish().value;
    render(&scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image
        .hash()
}

/// A ball with a hollow: the inner surface looks inwards.
#[derive(Debug)]
struct Hollow;

impl CustomShape for Hollow {
    fn name(&self) -> &'static str {
        "hollow"
    }

    fn bounds(&self) -> Option<Bounds3> {
        Some(Bounds3::new(DVec3::splat(-1.5), DVec3::splat(1.5)))
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn crossings(&self, ray: &Ray, out: &mut dyn CrossingSink) {
        for (part, radius) in [(0, 1.5), (1, 1.1)] {
            let mut own = Crossings::default();
            Shape::Sphere(Sphere::new(DVec3::ZERO, radius).unwrap()).crossings(ray, &mut own);
            own.as_slice()
                .iter()
                .for_each(|crossing| out.push(crossing.t, part));
        }
    }

    fn surface(&self, p: DVec3, part: u32) -> Surface {
        let normal = if part == 0 { p } else { -p };
        Surface {
            normal,
            uv: DVec2::ZERO,
        }
    }
}

#[test]
fn glass_bends_light_as_the_same_solid_of_one_piece_does() {
    let ball = picture(|b| b.sphere(DVec3::ZERO, 1.5).unwrap());
    let united = picture(|b| {
        let mark = b.begin_csg(CsgOp::Union).unwrap();
        b.sphere(DVec3::ZERO, 1.5).unwrap();
        b.sphere(DVec3::new(0.2, 0.1, 0.0), 0.7).unwrap();
        b.end_csg(mark, true).unwrap();
    });
    assert_eq!(ball, united, "nothing is left of what is inside");
    let cut = |b: &mut Builder| {
        let mark = b.begin_csg(CsgOp::Difference).unwrap();
        b.sphere(DVec3::ZERO, 1.5).unwrap();
        b.sphere(DVec3::ZERO, 1.1).unwrap();
        b.end_csg(mark, true).unwrap();
    };
    let hollow = picture(|b| b.shape(Shape::custom(Hollow)).unwrap());
    assert_eq!(hollow, picture(cut));
    assert_ne!(hollow, ball);
    let placed = picture(|b| {
        let mark = b.begin_define("hollow").unwrap();
        cut(b);
        b.end_define(mark, true);
        b.instance("hollow").unwrap();
    });
    assert_eq!(hollow, placed, "as an instance");
}

#[test]
fn the_cut_is_of_what_cuts() {
    let mut b = Builder::new();
    let mark = b.begin_csg(CsgOp::Difference).unwrap();
    b.material_mut().ior = 1.1;
    b.shape(Shape::Cuboid(Cuboid::new(DVec3::splat(2.0)).unwrap()))
        .unwrap();
    b.material_mut().ior = 1.2;
    b.sphere(DVec3::Y, 0.5).unwrap();
    b.end_csg(mark, true).unwrap();
    let scene = b.finish().value;
    let world = World::compile(&scene).unwrap();
    for (x, ior, y) in [(0.9, 1.1, 1.0), (0.0, 1.2, 0.5)] {
        let ray = Ray::new(DVec3::new(x, 3.0, 0.0), DVec3::NEG_Y);
        let hit = world.nearest(&Probe::from_space(ray), 9.0).unwrap();
        let at = world.surface(&hit, &ray).unwrap();
        assert_eq!((at.material.ior, at.position.y), (ior, y));
        assert_eq!((at.from_front, at.shading_normal), (true, DVec3::Y));
        assert_eq!(world.objects_of(hit.number).len(), 2, "the solid, then its part");
    }
}

#[test]
fn many_holes_are_one_solid() {
    let mut b = Builder::new();
    let mark = b.begin_csg(CsgOp::Difference).unwrap();
    b.shape(Shape::Cuboid(Cuboid::new(DVec3::new(30.0, 1.0, 30.0)).unwrap()))
        .unwrap();
    for i in 0..500 {
        b.push_transform().unwrap();
        b.translate(DVec3::new(
            f64::from(i % 25) - 12.0,
            0.0,
            f64::from(i / 25) - 10.0,
        ))
        .unwrap();
        b.shape(Shape::Cylinder(Cylinder::new(0.3, 2.0).unwrap()))
            .unwrap();
        b.pop_transform().unwrap();
    }
    b.end_csg(mark, true).unwrap();
    let scene = b.finish().value;
    let world = World::compile(&scene).unwrap();
    // Along a row: in and out at each hole, beyond what is kept without memory.
    let ray = Ray::new(DVec3::new(-20.0, 0.1, 0.0), DVec3::X);
    assert_eq!(crossings(&world, &ray).len(), 2 + 2 * 25);
    let down = |x: f64| world.is_occluded(&Ray::new(DVec3::new(x, 5.0, 0.0), DVec3::NEG_Y), 9.0);
    assert!(!down(0.0) && down(0.5));
}

#[test]
fn what_has_no_inside_is_refused() {
    let mut b = Builder::new();
    let mark = b.begin_define("flat").unwrap();
    b.shape(Shape::Disk(Disk::new(1.0).unwrap())).unwrap();
    b.end_define(mark, true);
    let mark = b.begin_csg(CsgOp::Union).unwrap();
    let mut open = box_mesh(DVec3::ONE);
    open.triangles.pop();
    for (made, said) in [
        (
            b.shape(Shape::Disk(Disk::new(1.0).unwrap())),
            "a disk has no inside",
        ),
        (
            b.triangle([DVec3::ZERO, DVec3::X, DVec3::Y], None),
            "a tri has no inside",
        ),
        (b.mesh(&Arc::new(open)), "the mesh \"box\" is not closed"),
        (
            b.instance("flat"),
            "\"flat\" holds something without an inside, the disk",
        ),
        (b.point(DVec3::ONE, DVec3::ONE), "a light is no part of a solid"),
    ] {
        let error = made.unwrap_err();
        assert!(error.message.starts_with(said), "{}", error.message);
    }
    b.end_csg(mark, true).unwrap();
    let report = b.finish();
    assert!(report.value.root().objects.is_empty());
    assert!(report.warnings.iter().any(|w| w.message == "the union is empty"));
}
