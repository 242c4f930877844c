//! What must hold for scenes as a whole, whatever they show.

#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use proptest::prelude::*;
use rtscript::{
    Builder, DVec3, Image, NoHost, RenderOptions, Scene, Term,
    math::{DAffine3, rotation},
    render,
    render::World,
    scene::{Camera, Mesh},
    shape::{Cone, Cuboid, Cylinder, Disk, Shape, Torus},
};

fn picture(scene: &Scene) -> Image {
    render(scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image
}

/// Some of everything, under `m`; `pushes` more levels of the matrix stack around each thing.
fn still_life(m: DAffine3, seed: u64, pushes: usize) -> Builder {
    let mut state = seed;
    let mut next = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut b = Builder::new();
    b.size(48, 36).unwrap();
    let up = m.transform_vector3(DVec3::Y);
    let eye = m.transform_point3(DVec3::new(1.0, 2.0, 9.0));
    b.camera(Camera::new(eye, m.transform_point3(DVec3::ZERO), up, 40.0).unwrap());
    b.multiply(m).unwrap();
    b.point(DVec3::new(4.0, 7.0, 6.0), DVec3::splat(0.7)).unwrap();
    b.directional(DVec3::new(-1.0, 1.0, 0.5), DVec3::splat(0.4))
        .unwrap();
    for kind in 0..7 {
        let material = b.material_mut();
        material.diffuse = Term::color(DVec3::new(next(), next(), next()) * 0.7);
        material.specular = Term::color(DVec3::splat(0.3 * next()));
        material.shininess = 30.0;
        for _ in 0..=pushes {
            b.push_transform().unwrap();
        }
        b.translate(DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5) * 6.0)
            .unwrap();
        b.rotate(DVec3::new(next(), next(), 0.5), 360.0 * next()).unwrap();
        b.scale(DVec3::new(0.5 + next(), 0.5 + next(), 0.5 + next()))
            .unwrap();
        match kind {
            0 => b.sphere(DVec3::ZERO, 1.0).unwrap(),
            1 => b
                .shape(Shape::Cuboid(Cuboid::new(DVec3::splat(1.5)).unwrap()))
                .unwrap(),
            2 => b
                .shape(Shape::Cylinder(Cylinder::new(0.6, 1.8).unwrap()))
                .unwrap(),
            3 => b.shape(Shape::Cone(Cone::new(0.8, 1.5).unwrap())).unwrap(),
            4 => b.shape(Shape::Torus(Torus::new(0.8, 0.3).unwrap())).unwrap(),
            5 => b.shape(Shape::Disk(Disk::new(1.2).unwrap())).unwrap(),
            _ => b
                .triangle([DVec3::X * 2.0, DVec3::Y * 2.0, DVec3::Z * 2.0], None)
                .unwrap(),
        }
        for _ in 0..=pushes {
            b.pop_transform().unwrap();
        }
    }
    b
}

fn differing(a: &Image, b: &Image, tolerance: f64) -> usize {
    let far = |(a, b): (&[f64; 3], &[f64; 3])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > tolerance);
    a.pixels()
        .iter()
        .zip(b.pixels())
        .filter(|pair| far(*pair))
        .count()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Turning, moving or mirroring the whole scene with its camera and lights changes nothing but rounding. (A
    /// mirror turns the picture over, so it stays among the rotations here.)
    #[test]
    fn an_isometry_of_the_whole_scene_changes_nothing(
        seed in any::<u64>(),
        axis in prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from),
        degrees in 0.0..360.0f64,
        offset in prop::array::uniform3(-50.0..50.0f64).prop_map(DVec3::from),
    ) {
        prop_assume!(axis.length() > 1e-3);
        let m = DAffine3::from_mat3_translation(rotation(axis.normalize(), degrees), offset);
        let plain = picture(&still_life(DAffine3::IDENTITY, seed, 0).finish().value);
        let moved = picture(&still_life(m, seed, 0).finish().value);
        // A ray through the very edge of something may fall to either side.
        let count = differing(&plain, &moved, 1e-6);
        prop_assert!(count <= 2, "{} pixels differ", count);
    }

    #[test]
    fn more_pushes_and_pops_change_no_bit(seed in any::<u64>(), pushes in 1..5usize) {
        let plain = picture(&still_life(DAffine3::IDENTITY, seed, 0).finish().value);
        let pushed = picture(&still_life(DAffine3::IDENTITY, seed, pushes).finish().value);
        prop_assert_eq!(plain.hash(), pushed.hash());
    }
}

/// A bumpy sheet of `2 n^2` triangles.
fn sheet(n: u32) -> Mesh {
    let at = |i: u32| f64::from(i) / f64::from(n) - 0.5;
    let height = |x: f64, z: f64| 0.1 * rtscript::math::sin(9.0 * x) * rtscript::math::cos(7.0 * z);
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            positions.push(DVec3::new(at(i), height(at(i), at(j)), at(j)));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            triangles.push([a, a + n + 1, a + n + 2]);
            triangles.push([a, a + n + 2, a + 1]);
        }
    }
    Mesh::new("sheet", positions, triangles).unwrap()
}

#[test]
fn ten_thousand_instances_take_the_memory_of_one_and_a_matrix_each() {
    let world_bytes = |count: u32| {
        let mut b = Builder::new();
        b.size(64, 48).unwrap();
        b.camera(Camera::new(DVec3::new(0.0, 60.0, 120.0), DVec3::ZERO, DVec3::Y, 50.0).unwrap());
        b.directional(DVec3::ONE, DVec3::ONE).unwrap();
        b.material_mut().diffuse = Term::color(DVec3::ONE);
        let mark = b.begin_define("sheet").unwrap();
        b.mesh(&Arc::new(sheet(71))).unwrap();
        b.end_define(mark, true);
        for i in 0..count {
            b.push_transform().unwrap();
            b.translate(DVec3::new(
                f64::from(i % 100) - 50.0,
                0.0,
                f64::from(i / 100) - 50.0,
            ))
            .unwrap();
            b.rotate(DVec3::Y, f64::from(i)).unwrap();
            b.instance("sheet").unwrap();
            b.pop_transform().unwrap();
        }
        let scene = b.finish().value;
        let lit = picture(&scene).pixels().iter().filter(|p| p[0] > 0.3).count();
        let world = World::compile(&scene).unwrap();
        assert!(world.primitives() >= 10_000);
        (world.bytes(), lit)
    };
    let (one, _) = world_bytes(1);
    let (all, lit) = world_bytes(10_000);
    assert!(lit > 500, "they are seen: {lit}");
    let each = (all - one) / 9_999;
    assert!(each < 256, "{each} bytes for each instance");
    assert!(all < 2 * one + 10_000 * 256, "{all} bytes, one takes {one}");
}

#[test]
fn a_mesh_placed_twice_is_kept_once_without_a_define() {
    let bytes = |copies: u32| {
        let mut b = Builder::new();
        let mesh = Arc::new(sheet(40));
        for i in 0..copies {
            b.translate(DVec3::X * f64::from(i)).unwrap();
            b.mesh(&mesh).unwrap();
        }
        let scene = b.finish().value;
        World::compile(&scene).unwrap().bytes()
    };
    assert!(bytes(100) < bytes(2) + 98 * 256);
}
