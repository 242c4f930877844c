//! Shapes under transforms.

use std::{collections::BTreeMap, sync::Arc};

use super::{
    super::{
        Blob, BlobPart, Capsule, Cone, Cuboid, Cylinder, Disk, Lathe, Plane, Polygon, Prism, Quadric,
        RoundedBox, Sdf, Shape, Sphere, SphereSweep, Superellipsoid, Torus,
    },
    Rng, VASE, is_curved, outlines, ring, shared,
    subject::Alone,
};
use crate::{
    math::{self, DAffine3, DMat3, DVec3},
    spline::Spline,
};

/// Same t, however the shape came to its size and place: by its parameters, or by a matrix under which the
/// ray is seen from a simpler one.
#[test]
fn a_transformed_ray_meets_the_shape_where_the_ray_meets_the_transformed_shape() {
    let mut rng = Rng::new(3);
    let mut checked = 0;
    for _ in 0..20_000 {
        let mut length = || rng.magnitude(-3.0, 3.0);
        let (w, h, d) = (length(), length(), length());
        let at = rng.in_cube() * w;
        let outline = &outlines()[rng.below(3)];
        let points: Vec<DVec3> = outline.iter().map(|p| p.extend(0.0)).collect();
        let any = DAffine3::from_mat3_translation(
            rng.rotation()
                * DMat3::from_diagonal(DVec3::new(w, w * rng.within(0.1, 3.0), w))
                * rng.rotation(),
            at,
        );
        let about_y = DAffine3::from_mat3(math::rotation(DVec3::Y, rng.within(0.0, 360.0)));
        let scaled = |by: DVec3| DAffine3::from_scale(by);
        let moved: Vec<DVec3> = points.iter().map(|p| any.transform_point3(*p)).collect();
        let cases = [
            (
                Shape::Sphere(Sphere::new(at, w).unwrap()),
                Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
                DAffine3::from_translation(at) * scaled(DVec3::splat(w)),
            ),
            (
                Shape::Cuboid(Cuboid::new(DVec3::new(w, h, d)).unwrap()),
                Shape::Cuboid(Cuboid::new(DVec3::ONE).unwrap()),
                scaled(DVec3::new(w, h, d)),
            ),
            (
                Shape::Cylinder(Cylinder::new(w, h).unwrap()),
                Shape::Cylinder(Cylinder::new(0.5, 1.0).unwrap()),
                about_y * scaled(DVec3::new(2.0 * w, h, 2.0 * w)),
            ),
            (
                Shape::Cone(Cone::new(w, h).unwrap()),
                Shape::Cone(Cone::new(0.5, 1.0).unwrap()),
                about_y * scaled(DVec3::new(2.0 * w, h, 2.0 * w)),
            ),
            (
                Shape::Disk(Disk::new(w).unwrap()),
                Shape::Disk(Disk::new(0.5).unwrap()),
                about_y * scaled(DVec3::new(2.0 * w, h, 2.0 * w)),
            ),
            (
                Shape::Torus(Torus::new(w, 0.3 * w).unwrap()),
                Shape::Torus(Torus::new(1.0, 0.3).unwrap()),
                about_y * scaled(DVec3::splat(w)),
            ),
            (
                Shape::Plane(Plane),
                Shape::Plane(Plane),
                about_y * scaled(DVec3::new(w, h, d)),
            ),
            (
                Shape::Polygon(Arc::new(Polygon::new(moved).unwrap())),
                Shape::Polygon(Arc::new(Polygon::new(points).unwrap())),
                any,
            ),
        ];
        for (shape, simple, world_from_simple) in cases {
            checked += agree(&shape, &simple, &world_from_simple, w, &mut rng);
        }
    }
    assert!(checked > 50_000, "{checked}");
}

/// As [`shared::moves_with_its_ray`], of a shape `s` times as large as a unit.
fn agree(shape: &Shape, simple: &Shape, world_from_simple: &DAffine3, s: f64, rng: &mut Rng) -> usize {
    let (moved, plain) = (
        Alone { shape, s },
        Alone {
            shape: simple,
            s: 1.0,
        },
    );
    let ray = shared::random_ray(&moved, rng);
    let inverse = world_from_simple.inverse();
    shared::moves_with_its_ray(&moved, &plain, |ray| ray.transformed(&inverse), ray)
}

/// A curve's points are moved with it, a sum's coefficients turned against the matrix.
#[test]
fn a_transformed_ray_meets_the_curved_shape_where_the_ray_meets_the_transformed_one() {
    let mut rng = Rng::new(4);
    let mut checked = BTreeMap::new();
    for _ in 0..150 {
        for (shape, simple, world_from_simple) in curved(&mut rng) {
            let s = world_from_simple.matrix3.x_axis.length();
            *checked.entry(shape.name()).or_insert(0) += (0..if is_curved(&shape) { 4 } else { 40 })
                .map(|_| agree(&shape, &simple, &world_from_simple, s, &mut rng))
                .sum::<usize>();
        }
    }
    assert!(
        checked.len() == 9 && checked.values().all(|n| *n > 200),
        "{checked:?}"
    );
}

/// A shape by its parameters, a simpler one, and the matrix that makes the one of the other.
type Pair = (Shape, Shape, DAffine3);

/// Every shape that has curves, of random size and place where its parameters can say so.
fn curved(rng: &mut Rng) -> Vec<Pair> {
    let mut length = || rng.magnitude(-3.0, 3.0);
    let (w, h) = (length(), length());
    let round = DAffine3::from_mat3(math::rotation(DVec3::Y, rng.within(0.0, 360.0)));
    let even = DAffine3::from_scale(DVec3::splat(w));
    let turned = DAffine3::from_mat3_translation(rng.rotation() * w, rng.in_cube() * w);
    let mut pairs = vec![
        (
            Shape::Capsule(Capsule::new(0.3 * w, w).unwrap()),
            Shape::Capsule(Capsule::new(0.3, 1.0).unwrap()),
            round * even,
        ),
        (
            Shape::RoundedBox(RoundedBox::new(DVec3::new(1.0, 0.6, 2.0) * w, 0.1 * w).unwrap()),
            Shape::RoundedBox(RoundedBox::new(DVec3::new(1.0, 0.6, 2.0), 0.1).unwrap()),
            even,
        ),
        superellipsoid(rng),
        quadric(rng),
        (
            Shape::Isosurface(Arc::new(Sdf::sphere(0.5 * w).unwrap().isosurface().unwrap())),
            Shape::Isosurface(Arc::new(Sdf::sphere(0.5).unwrap().isosurface().unwrap())),
            round * even,
        ),
    ];
    pairs.extend(swept(rng, round, w, h));
    let kind = [Spline::Linear, Spline::CatmullRom][rng.below(2)];
    let points = [
        [0.0, 0.0, 0.0, 0.3],
        [1.0, 0.5, 0.0, 0.1],
        [1.5, -0.5, 1.0, 0.4],
        [0.0, -0.5, 1.5, 0.2],
    ];
    let sweep = |points: Vec<[f64; 4]>| Shape::SphereSweep(Arc::new(SphereSweep::new(points, kind).unwrap()));
    let moved = points.map(|[x, y, z, r]| {
        let p = turned.transform_point3(DVec3::new(x, y, z));
        [p.x, p.y, p.z, r * w]
    });
    pairs.push((sweep(moved.to_vec()), sweep(points.to_vec()), turned));
    let parts = [
        BlobPart::ball(DVec3::ZERO, 1.0, 1.0),
        BlobPart::ball(DVec3::new(1.1, 0.2, 0.0), 0.9, 1.5),
        BlobPart::rod(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(0.0, 1.5, 0.5), 0.6, 1.2),
    ];
    let blob = |parts: &[BlobPart]| Shape::Blob(Arc::new(Blob::new(0.4, parts.to_vec()).unwrap()));
    let moved = parts.map(|part| BlobPart {
        from: turned.transform_point3(part.from),
        to: turned.transform_point3(part.to),
        radius: part.radius * w,
        ..part
    });
    pairs.push((blob(&moved), blob(&parts), turned));
    pairs
}

/// It has a single size, so only turns and mirrors that leave it as it is can tell.
fn superellipsoid(rng: &mut Rng) -> Pair {
    let shape = Superellipsoid::new(rng.within(0.3, 2.0), rng.within(0.3, 2.0)).unwrap();
    let quarter = math::rotation(DVec3::Y, 90.0 * rng.below(4) as f64);
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, if rng.chance(0.5) { 1.0 } else { -1.0 }, -1.0));
    let shape = Shape::Superellipsoid(shape);
    (shape.clone(), shape, DAffine3::from_mat3(quarter * mirror))
}

/// An ellipsoid under any matrix M: of x^T A x = 1 becomes (M^-1 x)^T A (M^-1 x) = 1.
fn quadric(rng: &mut Rng) -> Pair {
    let stretch = DVec3::new(rng.within(0.3, 2.0), rng.within(0.3, 2.0), rng.within(-2.0, -0.3));
    let linear = rng.rotation() * DMat3::from_diagonal(stretch) * rng.rotation();
    let m = DAffine3::from_mat3_translation(linear, rng.in_cube());
    let [a, b, c] = [2.0, 3.0, 5.0];
    let inverse = m.inverse();
    let (i, t) = (inverse.matrix3, inverse.translation);
    let q = i.transpose() * DMat3::from_diagonal(DVec3::new(a, b, c)) * i;
    let linear = i.transpose() * (DVec3::new(a, b, c) * t) * 2.0;
    let constant = (DVec3::new(a, b, c) * t).dot(t) - 1.0;
    let moved = [
        q.x_axis.x,
        q.y_axis.y,
        q.z_axis.z,
        2.0 * q.x_axis.y,
        2.0 * q.x_axis.z,
        2.0 * q.y_axis.z,
        linear.x,
        linear.y,
        linear.z,
        constant,
    ];
    let quadric = |c| Shape::Quadric(Arc::new(Quadric::new(c, None).unwrap()));
    let plain = [a, b, c, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
    (quadric(moved), quadric(plain), m)
}

/// Outlines of splines follow what is done to their points.
fn swept(rng: &mut Rng, round: DAffine3, w: f64, h: f64) -> [Pair; 2] {
    let kind = [Spline::Linear, Spline::CatmullRom][rng.below(2)];
    let star = ring(10);
    let (sin, cos) = math::sin_cos_degrees(rng.within(0.0, 360.0));
    let around = DMat3::from_cols(DVec3::new(cos, 0.0, -sin), DVec3::Y, DVec3::new(sin, 0.0, cos));
    let flat = DAffine3::from_mat3_translation(
        around * DMat3::from_diagonal(DVec3::new(w, h, rng.within(0.5, 2.0) * w)),
        DVec3::new(rng.within(-1.0, 1.0), 0.0, rng.within(-1.0, 1.0)) * w,
    );
    let foot = |[x, z]: [f64; 2]| {
        let p = flat.transform_point3(DVec3::new(x, 0.0, z));
        [p.x, p.z]
    };
    let prism = |outline: Vec<[f64; 2]>, height| {
        Shape::Prism(Arc::new(Prism::new(vec![outline], kind, height).unwrap()))
    };
    let lathe =
        |points: &[[f64; 2]]| Shape::Lathe(Arc::new(Lathe::new(points.to_vec(), kind, false).unwrap()));
    let up = h * rng.within(-1.0, 1.0);
    let grown = VASE.map(|[r, y]| [r * w, y * h + up]);
    let taller = DAffine3::from_translation(DVec3::Y * up) * DAffine3::from_scale(DVec3::new(w, h, w));
    [
        (
            prism(star.iter().map(|p| foot(*p)).collect(), 0.7 * h),
            prism(star, 0.7),
            flat,
        ),
        (lathe(&grown), lathe(&VASE), taller * round),
    ]
}
