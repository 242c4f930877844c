//! Closed meshes hold every ray that starts inside them: aimed at vertices, edges and faces, at any scale, moved,
//! turned, mirrored and placed as instances.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::{collections::HashMap, sync::Arc};

use rtscript::{
    Builder, DVec3,
    math::{DAffine3, DMat3, Ray, cos, pow, rotation, sin, sin_cos_degrees},
    render::World,
    scene::Mesh,
};

/// A closed mesh and points inside it, each with the whole mesh around it.
struct Vessel {
    mesh: Arc<Mesh>,
    inside: Vec<DVec3>,
}

fn vessel(name: &str, positions: Vec<DVec3>, triangles: Vec<[u32; 3]>, inside: Vec<DVec3>) -> Vessel {
    let mut sides = HashMap::new();
    for t in &triangles {
        for k in 0..3 {
            *sides.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
        }
    }
    for (&(a, b), &count) in &sides {
        assert!(
            count == 1 && sides.get(&(b, a)) == Some(&1),
            "{name} is not closed at {a}, {b}"
        );
    }
    Vessel {
        mesh: Arc::new(Mesh::new(name, positions, triangles).unwrap()),
        inside,
    }
}

/// The icosahedron with every triangle cut into four `cuts` times, each vertex at `radius` of its direction.
fn icosphere(name: &str, cuts: u32, radius: impl Fn(DVec3) -> f64) -> Vessel {
    let g = 0.5 + 0.5 * 5f64.sqrt();
    let mut positions: Vec<DVec3> = Vec::new();
    for i in 0..3 {
        for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
            let mut p = [0.0; 3];
            (p[(i + 1) % 3], p[(i + 2) % 3]) = (a, b);
            positions.push(DVec3::from(p).normalize());
        }
    }
    let mut triangles = Vec::new();
    let neighbors = |a: DVec3, b: DVec3| a.distance_squared(b) < 1.2;
    for a in 0..12u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|i| positions[i as usize]);
                if neighbors(p, q) && neighbors(q, r) && neighbors(r, p) {
                    let outward = (q - p).cross(r - p).dot(p) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..cuts {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    for p in &mut positions {
        *p *= radius(*p);
    }
    vessel(
        name,
        positions,
        triangles,
        vec![DVec3::ZERO, DVec3::new(0.05, -0.03, 0.01)],
    )
}

/// A cube of edge 2 whose faces are grids of `n` by `n` squares: every edge of it lies in a coordinate plane's
/// parallel, and so does every box around its triangles.
fn cube(n: u32) -> Vessel {
    let mut positions = Vec::new();
    let mut numbers = HashMap::new();
    let mut triangles = Vec::new();
    let mut number = |p: [u32; 3]| {
        *numbers.entry(p).or_insert_with(|| {
            positions.push(DVec3::from(p.map(|x| 2.0 * f64::from(x) / f64::from(n) - 1.0)));
            positions.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        for side in [0, n] {
            for i in 0..n {
                for j in 0..n {
                    let mut corner = |di: u32, dj: u32| {
                        let mut p = [0; 3];
                        (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, i + di, j + dj);
                        number(p)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    triangles.extend(if side == n {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, c, b], [a, d, c]]
                    });
                }
            }
        }
    }
    let inside = vec![DVec3::ZERO, DVec3::splat(0.5), DVec3::new(0.1, 0.25, -0.7)];
    vessel("cube", positions, triangles, inside)
}

/// A torus of radii 1 and `r` from `n` by `m` squares. With few of one and many of the other its triangles are
/// needles.
fn torus(r: f64, n: u32, m: u32) -> Vessel {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let (sin_a, cos_a) = sin_cos_degrees(360.0 * f64::from(i) / f64::from(n));
            let (sin_b, cos_b) = sin_cos_degrees(360.0 * f64::from(j) / f64::from(m));
            let from_axis = 1.0 + r * cos_b;
            positions.push(DVec3::new(from_axis * cos_a, r * sin_b, from_axis * sin_a));
            let at = |i: u32, j: u32| i % n * m + j % m;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    // On the circle that runs through the tube's middle, at corners of the polygon the tube follows.
    let inside = (0..n)
        .step_by(n as usize / 3)
        .map(|i| {
            let (s, c) = sin_cos_degrees(360.0 * f64::from(i) / f64::from(n));
            DVec3::new(c, 0.0, s)
        })
        .collect();
    vessel("torus", positions, triangles, inside)
}

fn vessels(fine: bool) -> Vec<Vessel> {
    let lumpy = |p: DVec3| 1.0 + 0.2 * sin(5.0 * p.x + 1.0) * cos(4.0 * p.y) + 0.15 * sin(9.0 * p.z);
    let more = u32::from(fine);
    vec![
        icosphere("icosphere", 2 + 2 * more, |_| 1.0),
        icosphere("lumpy ball", 3 + 2 * more, lumpy),
        cube(8 + 24 * more),
        torus(0.4, 48, 24),
        torus(0.3, 6, 400),
    ]
}

#[derive(Clone, Copy, Debug)]
enum Placing {
    /// One mesh under one matrix.
    Mesh,
    /// Each triangle by itself.
    Triangles,
    /// A mesh placed twice keeps its space, and rays are taken there.
    Shared,
    /// An instance in an instance, stretched and mirrored.
    Nested,
}

fn build(b: &mut Builder, mesh: &Arc<Mesh>, m: DAffine3, placing: Placing) {
    match placing {
        Placing::Mesh => {
            b.multiply(m).unwrap();
            b.mesh(mesh).unwrap();
        }
        Placing::Triangles => {
            b.multiply(m).unwrap();
            for face in 0..mesh.triangles.len() {
                b.triangle(mesh.corners(face), None).unwrap();
            }
        }
        Placing::Shared => {
            b.multiply(m).unwrap();
            b.mesh(mesh).unwrap();
            b.translate(DVec3::new(50.0, 0.0, 0.0)).unwrap();
            b.mesh(mesh).unwrap();
        }
        Placing::Nested => {
            let mark = b.begin_define("inner").unwrap();
            b.rotate(DVec3::new(1.0, 1.0, 0.0), 77.0).unwrap();
            b.mesh(mesh).unwrap();
            b.end_define(mark, true);
            let mark = b.begin_define("outer").unwrap();
            b.scale(DVec3::new(-1.0, 2.0, 0.25)).unwrap();
            b.instance("inner").unwrap();
            b.end_define(mark, true);
            b.multiply(m * outer_from_mesh().inverse()).unwrap();
            b.instance("outer").unwrap();
        }
    }
}

/// What [`Placing::Nested`] does to its mesh between the two definitions.
fn outer_from_mesh() -> DAffine3 {
    let turn = rotation(DVec3::new(1.0, 1.0, 0.0).normalize(), 77.0);
    DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(-1.0, 2.0, 0.25)) * turn)
}

struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn unit(&mut self) -> f64 {
        self.next() as f64 / (1u64 << 31) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        self.next() as usize % n
    }

    /// A vertex, a point of an edge or a point of a face.
    fn aim(&mut self, mesh: &Mesh) -> DVec3 {
        let [a, b, c] = mesh.corners(self.below(mesh.triangles.len()));
        match self.below(4) {
            0 => a,
            1 => a + (b - a) * self.unit(),
            2 => (b + c) * 0.5,
            _ => a + (b - a) * self.unit() + (c - a) * (self.unit() * 0.01),
        }
    }
}

/// Shoots about `total` rays and counts those that nothing stops.
fn leaks(total: usize, fine: bool) -> (usize, Vec<String>) {
    let exponents = [-6, -4, -2, 0, 2, 4, 6];
    let placings = [
        Placing::Mesh,
        Placing::Triangles,
        Placing::Shared,
        Placing::Nested,
    ];
    let moves = [
        DAffine3::IDENTITY,
        DAffine3::from_mat3_translation(
            rotation(DVec3::new(1.0, -2.0, 0.5).normalize(), 33.0),
            DVec3::new(20.0, -3.0, 7.0),
        ),
    ];
    let vessels = vessels(fine);
    let each = total.div_ceil(vessels.len() * exponents.len() * placings.len() * moves.len());
    let mut numbers = Numbers(1);
    let (mut shot, mut out) = (0, Vec::new());
    for vessel in &vessels {
        for exponent in exponents {
            for placing in placings {
                for (moved, movement) in moves.iter().enumerate() {
                    let scale = DVec3::splat(pow(10.0, f64::from(exponent)));
                    let m = DAffine3::from_scale(scale) * *movement;
                    let mut b = Builder::new();
                    build(&mut b, &vessel.mesh, m, placing);
                    let scene = b.finish().value;
                    let world = World::compile(&scene).unwrap();
                    for _ in 0..each {
                        let origin = vessel.inside[numbers.below(vessel.inside.len())];
                        let aim = numbers.aim(&vessel.mesh);
                        let (origin, aim) = (m.transform_point3(origin), m.transform_point3(aim));
                        let mut dir = aim - origin;
                        if numbers.below(2) == 0 {
                            dir = dir.normalize();
                        }
                        let ray = Ray::new(origin, dir);
                        let held = world.nearest_t(&ray, f64::INFINITY).is_some();
                        let blocked = world.is_occluded(&ray, f64::INFINITY);
                        shot += 1;
                        if !(held && blocked) {
                            out.push(format!(
                                "{} at 1e{exponent}, {placing:?}, moved {moved}: from {origin} to {aim}, \
                                 nearest found {held}, any found {blocked}",
                                vessel.mesh.name
                            ));
                        }
                    }
                }
            }
        }
    }
    (shot, out)
}

#[test]
fn closed_meshes_hold_every_ray() {
    let (shot, out) = leaks(200_000, false);
    assert!(shot >= 200_000);
    assert!(
        out.is_empty(),
        "{} of {shot} rays escape: {:#?}",
        out.len(),
        &out[..out.len().min(5)]
    );
}

/// For releases: `cargo test --release --test leaks -- --ignored`.
#[test]
#[ignore = "10 million rays take 10 s in a release build, minutes without"]
fn closed_meshes_hold_ten_million_rays() {
    let (shot, out) = leaks(10_000_000, true);
    assert!(shot >= 10_000_000);
    assert!(
        out.is_empty(),
        "{} of {shot} rays escape: {:#?}",
        out.len(),
        &out[..out.len().min(5)]
    );
}
