use std::sync::Arc;

use super::*;
use crate::scene::Builder;

fn scene(spheres: u32) -> Scene {
    let mut b = Builder::new();
    b.file("a.rhai");
    b.size(64, 48).unwrap();
    b.set_loc(SourceLoc {
        line: 3,
        column: 1,
        file: 0,
    });
    b.point(DVec3::new(5.0, 5.0, 5.0), DVec3::ONE).unwrap();
    b.material_mut().diffuse = Term::color(DVec3::new(1.0, 0.2, 0.1));
    b.material_mut().shininess = 20.0;
    for i in 0..spheres {
        b.sphere(DVec3::new(f64::from(i), 10.05, -0.5), 1.0).unwrap();
    }
    b.translate(DVec3::new(0.1, 0.0, -2.0)).unwrap();
    b.triangle([DVec3::ZERO, DVec3::X, DVec3::Y], None).unwrap();
    let mesh = Mesh::new("m.obj", vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    b.mesh(&Arc::new(mesh)).unwrap();
    b.finish().value
}

#[test]
fn the_dump_says_all() {
    let dump = scene(1).dump();
    let (text, hash) = dump.trim_end().rsplit_once(' ').unwrap();
    assert_eq!(hash.len(), 32);
    assert_eq!(
        text,
        "\
size 64 48
samples 1 max_depth 5 seed 0
background 0 0 0 encoding srgb
camera eye 0 0 5 at 0 0 0 up 0 1 0 fovy 45
file 0 \"a.rhai\"
group 0 root objects 3 lights 1
  object 0 sphere { center: (0, 10.05, -0.5), radius: 1 } material 0 at 3:1
  object 1 tri (0 0 0) (1 0 0) (0 1 0) material 0 matrix [1 0 0 0.1] [0 1 0 0] [0 0 1 -2] at 3:1
  object 2 mesh 0 material 0 matrix [1 0 0 0.1] [0 1 0 0] [0 0 1 -2] at 3:1
  light 0 point 5 5 5 color 1 1 1 at 3:1
material 0 diffuse 1 0.2 0.1 shininess 20
mesh 0 \"m.obj\" vertices 3 triangles 1 bounds (0 0 0) (1 1 0) hash"
    );
}

#[test]
fn a_short_dump_still_tells_long_lists_apart() {
    let short = scene(1_000).dump_short(20);
    assert!(short.contains("  and 982 more, hash "), "{short}");
    assert!(short.lines().count() < 40);
    assert_ne!(
        short,
        scene(1_001)
            .dump_short(20)
            .replace("1003", "1002")
            .replace("983", "982")
    );
    assert_eq!(scene(5).dump_short(20), scene(5).dump());
}

#[test]
fn numbers_lose_only_their_empty_fraction() {
    assert_eq!(
        fields("Cone(Cone { radius: 10.05, height: 100.0, k: 0.001, big: 1e20 })"),
        " { radius: 10.05, height: 100, k: 0.001, big: 1e20 }"
    );
    assert_eq!(fields("Plane(Plane)"), "");
}
