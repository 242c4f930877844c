//! The watertight ray-triangle test.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, in f64: corners are moved
//! to the ray's origin and sheared so that the ray runs along one axis; three edge functions then decide. Two
//! triangles that share an edge evaluate the same products with opposite signs, so no ray slips between them.
//! There is no fused multiply-add in it, so the signs are those on every machine.
//!
//! Why no fallback is needed where an edge function is 0: each is a difference of two products, and rounding
//! is monotone, so its sign is never wrong, only 0 where the exact value is nearly 0. As 0 counts as inside,
//! that can only make both neighbours claim the ray, never neither. Where it is 0, the ray must also pass
//! within the ranges of the corners' x and y: a triangle seen from its edge would otherwise claim rays all along
//! the line of that edge, far outside any box around it.
//!
//! What holds at which scale: with coordinates relative to the ray's origin up to 1e150 nothing overflows.
//! Products below 1e-308 vanish, which again only makes more of them 0: an edge claims too much, and a
//! triangle whose three edge functions all vanish counts as degenerate and misses. With edges of 1e-150 and
//! more that takes a triangle thinner than the rounding of its own corners. The direction may have any
//! length from 1e-300 to 1e300.

use crate::math::{DVec3, Ray};

/// What the test needs of a ray, made once per ray.
///
/// ```
/// use rtscript::{DVec3, math::Ray, shape::triangle::{TriangleHit, TriangleRay}};
/// let ray = TriangleRay::new(&Ray { origin: DVec3::new(0.2, 0.2, 1.0), dir: DVec3::NEG_Z });
/// let hit: Option<TriangleHit> = ray.intersect([&DVec3::ZERO, &DVec3::X, &DVec3::Y]);
/// assert!(hit.is_some_and(|hit| (hit.t - 1.0).abs() < 1e-12));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TriangleRay {
    /// The axes in cyclic order, last the one along which the direction is longest: it takes the place of z, its
    /// successors those of x and y.
    axes: [usize; 3],
    /// The origin with its axes in that order.
    origin: [f64; 3],
    /// Shears x and y so that the ray runs along z.
    shear: [f64; 2],
    /// t per unit of z.
    t_per_z: f64,
}

/// Where the line meets a triangle `a`, `b`, `c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Ray parameter, of any sign.
    pub t: f64,
    /// Barycentric weight of `b`, in [0, 1] up to rounding.
    pub u: f64,
    /// Barycentric weight of `c`, in [0, 1] up to rounding; the weight of `a` is `1 - u - v`.
    pub v: f64,
}

impl TriangleRay {
    /// Prepares a ray. One without direction, or with numbers that are not finite, meets nothing.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.dir;
        let axes = Self::axes(d);
        let [dx, dy, dz] = ordered(axes, &d);
        // Under an infinite direction every t would be 0; NaN makes it miss, as it does without a direction.
        let dz = if d.is_finite() { dz } else { f64::NAN };
        Self {
            axes,
            origin: ordered(axes, &ray.origin),
            shear: [dx / dz, dy / dz],
            t_per_z: 1.0 / dz,
        }
    }

    /// The axes in the order in which the test takes them: across, across, along the direction `d`, which is the
    /// first of those along which it is longest.
    #[inline(always)]
    pub(super) fn axes(d: DVec3) -> [usize; 3] {
        let [x, y, z] = d.abs().to_array();
        if x >= y && x >= z {
            [1, 2, 0]
        } else if y >= z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        }
    }

    /// A point as the ray sees it: x and y across the ray, which runs along z through x = y = 0. It depends
    /// on the ray and the point only, so surfaces that share a point agree about it.
    #[inline]
    #[must_use]
    pub(super) fn sheared(&self, p: DVec3) -> [f64; 3] {
        self.shear(ordered(self.axes, &p))
    }

    #[inline(always)]
    fn shear(&self, [px, py, pz]: [f64; 3]) -> [f64; 3] {
        let [ox, oy, oz] = self.origin;
        let z = pz - oz;
        [(px - ox) - self.shear[0] * z, (py - oy) - self.shear[1] * z, z]
    }

    /// t of the z of [`TriangleRay::sheared`].
    #[inline]
    #[must_use]
    pub(super) fn t_at(&self, z: f64) -> f64 {
        z * self.t_per_z
    }

    /// Where the line meets the triangle, seen from either side; t is not limited. A degenerate triangle and
    /// one seen exactly from its edge are not met.
    #[inline(always)]
    #[must_use]
    pub fn intersect(&self, [a, b, c]: [&DVec3; 3]) -> Option<TriangleHit> {
        let [ax, ay, az] = self.shear(ordered(self.axes, a));
        let [bx, by, bz] = self.shear(ordered(self.axes, b));
        let [cx, cy, cz] = self.shear(ordered(self.axes, c));
        // Twice the areas opposite a, b and c, in one order of factors for each edge.
        let wa = cx * by - cy * bx;
        let wb = ax * cy - ay * cx;
        let wc = bx * ay - by * ax;
        // Written so that NaN is outside, and without short circuits: the outcome cannot be predicted.
        let front = (wa >= 0.0) & (wb >= 0.0) & (wc >= 0.0);
        let back = (wa <= 0.0) & (wb <= 0.0) & (wc <= 0.0);
        let det = wa + wb + wc;
        if !(front | back) | (det == 0.0) {
            return None;
        }
        let on_edge = (wa == 0.0) | (wb == 0.0) | (wc == 0.0);
        if on_edge && !(spans(ax, bx, cx) & spans(ay, by, cy)) {
            return None;
        }
        // Weights first, t from them: their product with z would leave the range of f64 long before they do.
        let per_det = 1.0 / det;
        let (mut wa, mut u, mut v) = (wa * per_det, wb * per_det, wc * per_det);
        if det.abs() <= SLIVER * ((cx * by).abs() + (ax * cy).abs() + (bx * ay).abs()) {
            [wa, u, v] = along_the_longest_edge([(ax, ay), (bx, by), (cx, cy)]);
        }
        let t = (wa * az + u * bz + v * cz) * self.t_per_z;
        t.is_finite().then_some(TriangleHit { t, u, v })
    }
}

impl TriangleRay {
    /// As [`TriangleRay::intersect`], where it matters how often a closed mesh is crossed: a line through an edge that
    /// two triangles share crosses one of them where it changes sides, both or neither where it does not. Where the line
    /// meets an edge or a corner to the bit, it is taken as moved across by an infinitely small step, the same for all
    /// triangles (Edelsbrunner and Mücke, "Simulation of Simplicity", 1990).
    #[must_use]
    pub(crate) fn cross(&self, [a, b, c]: [&DVec3; 3]) -> Option<TriangleHit> {
        let [ax, ay, az] = self.sheared(*a);
        let [bx, by, bz] = self.sheared(*b);
        let [cx, cy, cz] = self.sheared(*c);
        let wa = cx * by - cy * bx;
        let wb = ax * cy - ay * cx;
        let wc = bx * ay - by * ax;
        let side = |w: f64, (px, py): (f64, f64), (qx, qy): (f64, f64)| {
            // With the line moved by (e, e^2), e -> 0, an edge function of 0 becomes e (py - qy) + e^2 (qx - px).
            let next = if py == qy { qx - px } else { py - qy };
            if w == 0.0 { next > 0.0 } else { w > 0.0 }
        };
        let (a, b, c) = ((ax, ay), (bx, by), (cx, cy));
        let [sa, sb, sc] = [side(wa, c, b), side(wb, a, c), side(wc, b, a)];
        let det = wa + wb + wc;
        if sa != sb || sb != sc || det == 0.0 {
            return None;
        }
        let per_det = 1.0 / det;
        let (mut wa, mut u, mut v) = (wa * per_det, wb * per_det, wc * per_det);
        let products = (c.0 * b.1).abs() + (a.0 * c.1).abs() + (b.0 * a.1).abs();
        if det.abs() <= SLIVER * products {
            [wa, u, v] = along_the_longest_edge([a, b, c]);
        }
        let t = (wa * az + u * bz + v * cz) * self.t_per_z;
        t.is_finite().then_some(TriangleHit { t, u, v })
    }
}

/// Where the area that the ray sees of a triangle is this small a share of the products that it is the difference of,
/// the edge functions still have their signs, but how they compare is rounding.
const SLIVER: f64 = 1e-10;

/// The weights of the corners of a triangle that the ray sees as a line: those of the point of its longest edge that is next
/// to the ray. Any other split would be a hit away from the ray, where a tree that looks at the triangle's box finds none.
#[cold]
#[inline(never)]
fn along_the_longest_edge([a, b, c]: [(f64, f64); 3]) -> [f64; 3] {
    let along = |p: (f64, f64), q: (f64, f64)| {
        let (x, y) = (q.0 - p.0, q.1 - p.1);
        let length_squared = x * x + y * y;
        let share = (-(p.0 * x + p.1 * y) / length_squared).clamp(0.0, 1.0);
        (length_squared, share)
    };
    let [(ab, on_ab), (bc, on_bc), (ca, on_ca)] = [along(a, b), along(b, c), along(c, a)];
    if ab >= bc && ab >= ca {
        [1.0 - on_ab, on_ab, 0.0]
    } else if bc >= ca {
        [0.0, 1.0 - on_bc, on_bc]
    } else {
        [on_ca, 0.0, 1.0 - on_ca]
    }
}

/// Whether 0 lies in the range of three numbers.
#[inline(always)]
pub(super) fn spans(a: f64, b: f64, c: f64) -> bool {
    ((a <= 0.0) | (b <= 0.0) | (c <= 0.0)) & ((a >= 0.0) | (b >= 0.0) | (c >= 0.0))
}

/// The components in another order.
#[inline(always)]
#[allow(clippy::indexing_slicing, reason = "the order is one of 0, 1 and 2")]
fn ordered([kx, ky, kz]: [usize; 3], v: &DVec3) -> [f64; 3] {
    let v: &[f64; 3] = v.as_ref();
    [v[kx], v[ky], v[kz]]
}

#[cfg(test)]
mod tests {
    use super::{super::suite::Rng, *};

    #[test]
    fn what_is_seen_as_a_line_is_met_where_it_is() {
        // Its corners lie on a line that the ray's line meets behind the ray's origin, where x is 0.
        let corners = [
            &DVec3::new(0.0, 3.0, 0.5),
            &DVec3::new(0.0, 3.5, 0.0),
            &DVec3::new(0.0, 0.5, 3.0),
        ];
        let ray = Ray {
            origin: DVec3::new(0.06000000000000005, 2.1, 1.5),
            dir: DVec3::new(0.5144957554255265, 0.8574929257125441, 0.0),
        };
        let found = TriangleRay::new(&ray).intersect(corners);
        let away = |hit: TriangleHit| (ray.origin + ray.dir * hit.t - DVec3::new(0.0, 2.0, 1.5)).length();
        assert!(found.is_none_or(|hit| away(hit) < 1e-12), "{found:?}");
    }

    #[test]
    fn slivers_are_met_at_the_ray_or_not_at_all() {
        let mut rng = Rng::new(11);
        let mut met = 0;
        for _ in 0..20_000 {
            let [a, b] = [rng.in_cube(), rng.in_cube()];
            let along = |s: f64| a + (b - a) * s;
            let near = rng.in_cube() * [0.0, 1e-17, 1e-13][(rng.unit() * 3.0) as usize];
            let corners = [a, along(rng.unit()) + near, b];
            let aim = along(rng.unit());
            let origin = rng.in_cube() * 4.0;
            let dir = (aim - origin).normalize();
            let ray = TriangleRay::new(&Ray { origin, dir });
            let [a, b, c] = &corners;
            if let Some(hit) = ray.intersect([a, b, c]) {
                met += 1;
                let away = (origin + dir * hit.t - aim).length();
                assert!(away < 1e-4, "{corners:?} {origin} {dir} {hit:?} {away}");
            }
        }
        assert!(met > 100, "{met}");
    }

    /// A closed convex mesh around the origin.
    struct Solid {
        points: Vec<DVec3>,
        triangles: Vec<[usize; 3]>,
    }

    impl Solid {
        fn icosphere(rounds: usize) -> Self {
            let g = 0.5 * (1.0 + 5f64.sqrt());
            let mut points = Vec::new();
            for (x, y) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
                points.extend([
                    DVec3::new(0.0, x, y),
                    DVec3::new(x, y, 0.0),
                    DVec3::new(y, 0.0, x),
                ]);
            }
            let mut triangles = Vec::new();
            for a in 0..12 {
                for b in a + 1..12 {
                    for c in b + 1..12 {
                        let near = |i: usize, j: usize| points[i].distance(points[j]) < 2.1;
                        if near(a, b) && near(b, c) && near(c, a) {
                            triangles.push([a, b, c]);
                        }
                    }
                }
            }
            for _ in 0..rounds {
                let mut midpoint = |a: usize, b: usize| {
                    let p = (points[a] + points[b]) * 0.5;
                    points.iter().position(|q| *q == p).unwrap_or_else(|| {
                        points.push(p);
                        points.len() - 1
                    })
                };
                triangles = triangles
                    .iter()
                    .flat_map(|&[a, b, c]| {
                        let [d, e, f] = [midpoint(a, b), midpoint(b, c), midpoint(c, a)];
                        [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
                    })
                    .collect();
            }
            for p in &mut points {
                *p = p.normalize();
            }
            Self { points, triangles }
        }

        /// A cube whose faces are grids of `n` by `n` squares in two triangles each.
        fn cube(n: usize) -> Self {
            let (mut points, mut triangles) = (Vec::new(), Vec::new());
            for axis in 0..3 {
                for side in [-1.0, 1.0] {
                    let first = points.len();
                    for i in 0..=n {
                        for j in 0..=n {
                            let (u, v) = (i as f64 / n as f64 * 2.0 - 1.0, j as f64 / n as f64 * 2.0 - 1.0);
                            let mut p = DVec3::splat(side);
                            p[(axis + 1) % 3] = u;
                            p[(axis + 2) % 3] = v;
                            points.push(p);
                        }
                    }
                    for i in 0..n {
                        for j in 0..n {
                            let a = first + i * (n + 1) + j;
                            let (b, c, d) = (a + n + 1, a + n + 2, a + 1);
                            triangles.extend([[a, b, c], [a, c, d]]);
                        }
                    }
                }
            }
            Self { points, triangles }
        }

        /// A tetrahedron around the origin, not too flat.
        fn tetrahedron(rng: &mut Rng) -> Self {
            loop {
                let points: Vec<DVec3> = (0..4).map(|_| rng.in_cube()).collect();
                let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
                let depth = triangles.iter().map(|&[a, b, c]: &[usize; 3]| {
                    let n = (points[b] - points[a]).cross(points[c] - points[a]).normalize();
                    let other = points[6 - a - b - c];
                    let (own, others) = (n.dot(points[a]), n.dot(points[a] - other));
                    own / others.signum()
                });
                if depth.fold(f64::INFINITY, f64::min) > 1e-3 {
                    return Self { points, triangles };
                }
            }
        }

        fn hits(&self, place: impl Fn(DVec3) -> DVec3, ray: &Ray) -> Vec<f64> {
            let test = TriangleRay::new(ray);
            let corners = |t: &[usize; 3]| t.map(|i| place(self.points[i]));
            self.triangles
                .iter()
                .filter_map(|t| {
                    let [a, b, c] = corners(t);
                    test.intersect([&a, &b, &c]).map(|hit| hit.t)
                })
                .collect()
        }
    }

    fn solids(rng: &mut Rng) -> Vec<(Solid, usize)> {
        let mut solids = vec![
            (Solid::icosphere(0), 20_000),
            (Solid::icosphere(2), 20_000),
            (Solid::cube(1), 20_000),
            (Solid::cube(5), 20_000),
        ];
        solids.extend((0..400).map(|_| (Solid::tetrahedron(rng), 100)));
        solids
    }

    /// A corner, the middle of an edge, any point of an edge, or of a face, of a random triangle.
    fn target(solid: &Solid, rng: &mut Rng) -> DVec3 {
        let [a, b, c] = solid.triangles[rng.below(solid.triangles.len())].map(|i| solid.points[i]);
        match rng.below(4) {
            0 => a,
            1 => (a + b) * 0.5,
            2 => a + (b - a) * rng.unit(),
            _ => a + (b - a) * rng.unit() * 0.5 + (c - a) * rng.unit() * 0.5,
        }
    }

    #[test]
    fn no_ray_into_a_closed_mesh_slips_through_an_edge_or_a_corner() {
        let mut rng = Rng::new(31);
        for (solid, rays) in solids(&mut rng) {
            for i in 0..rays {
                let scale = rng.magnitude(-6.0, 6.0);
                let at = if rng.chance(0.5) {
                    DVec3::ZERO
                } else {
                    rng.in_cube() * 10.0 * scale
                };
                let turn = if rng.chance(0.5) {
                    crate::math::DMat3::IDENTITY
                } else {
                    rng.rotation()
                };
                let place = |p: DVec3| turn * p * scale + at;
                let aim = place(target(&solid, &mut rng));
                // Through the aim to a point well inside.
                let inner = place(rng.in_cube() * 1e-4);
                let origin = aim + (aim - inner) * rng.magnitude(-2.0, 2.0);
                let ray = Ray::new(origin, (aim - origin) * rng.magnitude(-6.0, 6.0));
                let t_aim = (aim - origin).dot(ray.dir) / ray.dir.length_squared();
                let t_inner = (inner - origin).dot(ray.dir) / ray.dir.length_squared();
                let near = 1e-9 * (t_inner - t_aim) + 1e-12 * t_aim;
                let found = solid.hits(place, &ray);
                let entered = found.iter().any(|t| (t - t_aim).abs() < near);
                assert!(entered, "ray {i} enters unseen at {t_aim}: {found:?}: {ray:?}");
                let left = found.iter().any(|&t| t > t_inner);
                assert!(left, "ray {i} leaves unseen: {found:?}: {ray:?}");

                let from_inside = Ray::new(inner, (aim - inner) * rng.magnitude(-6.0, 6.0));
                let found = solid.hits(place, &from_inside);
                assert!(
                    found.iter().any(|&t| t > 0.0),
                    "ray {i} gets out: {from_inside:?}"
                );
                assert!(
                    found.iter().any(|&t| t < 0.0),
                    "ray {i} came from nowhere: {from_inside:?}"
                );
            }
        }
    }

    #[test]
    fn the_same_holds_at_the_ends_of_what_numbers_can_be() {
        let mut rng = Rng::new(32);
        let solid = Solid::icosphere(1);
        for scale in [1e-150, 1e-120, 1e120, 1e150] {
            for i in 0..10_000 {
                let place = |p: DVec3| p * scale;
                let inner = place(rng.in_cube() * 1e-2);
                let aim = place(target(&solid, &mut rng));
                let ray = Ray::new(inner, (aim - inner).normalize() * rng.magnitude(-150.0, 150.0));
                let found = solid.hits(place, &ray);
                assert!(
                    found.iter().any(|&t| t > 0.0),
                    "ray {i} at {scale:e} gets out: {ray:?}"
                );
                for t in found {
                    let radius = ray.at(t).length() / scale;
                    assert!(
                        (0.7..1.01).contains(&radius),
                        "ray {i} at {scale:e} ends at {radius}"
                    );
                }
            }
        }
    }

    #[test]
    fn barycentric_weights_and_t_name_the_same_point() {
        let mut rng = Rng::new(33);
        let mut met = 0;
        for _ in 0..100_000 {
            let scale = rng.magnitude(-6.0, 6.0);
            let [a, b, c] = [0; 3].map(|_| rng.in_cube() * scale);
            let (wb, wc) = (rng.within(-0.2, 1.2), rng.within(-0.2, 1.2));
            let p = a + (b - a) * wb + (c - a) * wc;
            let n = (b - a).cross(c - a) / (scale * scale);
            let d = rng.direction();
            if n.length() < 0.05 || n.normalize().dot(d).abs() < 0.05 {
                continue;
            }
            let ray = Ray::new(
                p - d * scale * rng.within(-10.0, 10.0),
                d * rng.magnitude(-6.0, 6.0),
            );
            let hit = TriangleRay::new(&ray).intersect([&a, &b, &c]);
            let clear = wb.min(wc).min(1.0 - wb - wc);
            if clear.abs() > 1e-10 {
                assert_eq!(hit.is_some(), clear > 0.0, "{wb} {wc} {ray:?} {a} {b} {c}");
            }
            let Some(hit) = hit else { continue };
            met += 1;
            assert!(
                (hit.u - wb).abs() < 1e-11 && (hit.v - wc).abs() < 1e-11,
                "{hit:?}, not {wb} {wc}"
            );
            let by_weights = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
            let off = by_weights.distance(ray.at(hit.t));
            assert!(off < 1e-12 * scale, "{off:e} apart at scale {scale:e}");
        }
        assert!(met > 15_000, "{met}");
    }

    #[test]
    fn both_sides_and_both_directions_count_and_edges_belong_to_it() {
        let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let hit = |o: [f64; 3], d: [f64; 3]| {
            TriangleRay::new(&Ray::new(o.into(), d.into())).intersect([&a, &b, &c])
        };
        let expected = Some(TriangleHit {
            t: 2.0,
            u: 0.25,
            v: 0.5,
        });
        assert_eq!(hit([0.25, 0.5, 4.0], [0.0, 0.0, -2.0]), expected);
        assert_eq!(hit([0.25, 0.5, -4.0], [0.0, 0.0, 2.0]), expected);
        let behind = Some(TriangleHit {
            t: -2.0,
            u: 0.25,
            v: 0.5,
        });
        assert_eq!(hit([0.25, 0.5, 4.0], [0.0, 0.0, 2.0]), behind);
        for corner in [a, b, c, (a + b) * 0.5, (b + c) * 0.5] {
            let o = corner + DVec3::Z;
            assert!(hit(o.to_array(), [0.0, 0.0, -1.0]).is_some(), "{corner}");
        }
        assert!(hit([0.51, 0.5, 4.0], [0.0, 0.0, -2.0]).is_none());
        assert!(hit([-1.0, 0.2, 0.0], [1.0, 0.0, 0.0]).is_none(), "in its plane");
    }

    #[test]
    fn degenerate_triangles_and_rays_that_are_none_miss() {
        let ray = Ray::new(DVec3::new(0.0, 0.0, 1.0), DVec3::NEG_Z);
        let test = TriangleRay::new(&ray);
        assert!(test.intersect([&DVec3::ZERO; 3]).is_none(), "a point");
        assert!(
            test.intersect([&-DVec3::X, &DVec3::ZERO, &DVec3::X]).is_none(),
            "a line"
        );
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let [a, b, c] = [-DVec3::X - DVec3::Y, DVec3::X, DVec3::Y];
            assert!(test.intersect([&a, &b, &c]).is_some());
            for i in 0..3 {
                let spoil = |mut v: DVec3| {
                    v[i] = bad;
                    v
                };
                assert!(test.intersect([&spoil(a), &b, &c]).is_none(), "{bad} in a corner");
                let ray = Ray::new(spoil(ray.origin), ray.dir);
                assert!(
                    TriangleRay::new(&ray).intersect([&a, &b, &c]).is_none(),
                    "{bad} in the origin"
                );
                let ray = Ray::new(DVec3::Z, spoil(DVec3::NEG_Z));
                assert!(
                    TriangleRay::new(&ray).intersect([&a, &b, &c]).is_none(),
                    "{bad} in the direction"
                );
            }
            let still = Ray::new(DVec3::ZERO, DVec3::ZERO);
            assert!(TriangleRay::new(&still).intersect([&a, &b, &c]).is_none());
        }
    }

    #[test]
    fn a_triangle_seen_from_its_edge_ends_at_its_corners() {
        let thin = 0.0008151194408677121;
        let points = [
            DVec3::new(0.0, 0.5, 0.0),
            DVec3::new(0.0, -1.5, -2.0),
            DVec3::new(thin, -0.5 + thin, -1.0 + thin),
        ];
        let scale = 1e-12;
        let [a, b, c] = points.map(|p| p * scale);
        let ray = Ray::new(DVec3::new(-0.5, 2.0, 1.5) * scale, DVec3::X);
        assert_eq!(TriangleRay::new(&ray).intersect([&a, &b, &c]), None);
    }
}
