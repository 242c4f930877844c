//! The properties that all share, each asked of one line and what it met. The answer is how much was checked.

use super::{
    Rng,
    subject::{Met, Subject},
};
use crate::math::{DVec3, Ray, max_abs};

/// A line and where it crosses.
pub(crate) struct Case<'a> {
    pub(crate) subject: &'a dyn Subject,
    pub(crate) ray: Ray,
    pub(crate) found: Vec<Met>,
}

impl std::fmt::Display for Case<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Case { subject, ray, found } = self;
        write!(f, "{ray:?} on {}: {found:?}", subject.label())
    }
}

impl<'a> Case<'a> {
    pub(crate) fn new(subject: &'a dyn Subject, ray: Ray) -> Self {
        Self {
            subject,
            ray,
            found: subject.crossings(&ray),
        }
    }

    pub(crate) fn random(subject: &'a dyn Subject, rng: &mut Rng) -> Self {
        Self::new(subject, random_ray(subject, rng))
    }

    /// Whether the ray comes from so far away that its rounding is larger than what is looked at.
    fn is_far(&self, sizes: f64) -> bool {
        max_abs(self.ray.origin) > sizes * self.subject.extent().0
    }

    /// The cosine between the ray and the normal: negative where it enters.
    fn facing(&self, met: &Met) -> f64 {
        met.normal.normalize().dot(self.ray.dir.normalize())
    }

    fn edge_distance(&self, met: &Met) -> f64 {
        self.subject.edge_distance(self.ray.at(met.t))
    }
}

/// A ray that means to meet something: at any point of its bounds or just beside, often exactly at an edge, a rim or the
/// center of them, often along an axis, from near and from far, with a direction of any length.
pub(crate) fn random_ray(subject: &dyn Subject, rng: &mut Rng) -> Ray {
    let (size, center) = subject.extent();
    let half = subject.bounds().map_or(DVec3::splat(size), |b| b.size() * 0.5);
    let snapped = [-1.0, 0.0, 1.0];
    let mut coordinate = |half: f64| {
        half * if rng.chance(0.2) {
            snapped[rng.below(3)]
        } else {
            rng.within(-1.2, 1.2)
        }
    };
    let target = center + DVec3::new(coordinate(half.x), coordinate(half.y), coordinate(half.z));
    let mut dir = rng.direction();
    if rng.chance(0.2) {
        dir[rng.below(3)] = 0.0;
        if rng.chance(0.5) {
            dir = [DVec3::X, DVec3::NEG_Y, DVec3::Z][rng.below(3)];
        }
    }
    let origin = target - dir * size * rng.magnitude(-2.0, 3.0);
    Ray::new(origin, dir * rng.magnitude(-6.0, 6.0))
}

/// Crossings are finite, in order, and even in number for solids.
pub(crate) fn are_ordered_and_closed(case: &Case<'_>) -> usize {
    let found = &case.found;
    assert!(found.is_sorted_by(|a, b| a.t <= b.t), "{case}");
    assert!(found.iter().all(|c| c.t.is_finite()), "{case}");
    assert!(
        !case.subject.is_solid() || found.len().is_multiple_of(2),
        "{case}"
    );
    found.len()
}

/// Nothing is crossed outside of the bounds.
pub(crate) fn are_within_bounds(case: &Case<'_>) -> usize {
    let Some(b) = case.subject.bounds() else {
        return 0;
    };
    let slack = slack(case);
    for c in &case.found {
        let p = case.ray.at(c.t);
        let outside = (b.min - p).max(p - b.max).max_element();
        assert!(outside <= slack, "outside by {outside:e}: {case}");
    }
    case.found.len()
}

/// How well the point of a crossing is known: to the rounding of the origin it is computed from.
pub(crate) fn slack(case: &Case<'_>) -> f64 {
    let (size, center) = case.subject.extent();
    case.subject.rounding() * 2e-15 * (size + max_abs(center) + max_abs(case.ray.origin))
}

/// Where a solid is entered its normal is against the ray, where it is left along with it.
pub(crate) fn normals_point_outwards(case: &Case<'_>) -> usize {
    if !case.subject.is_solid() {
        return 0;
    }
    let mut checked = 0;
    for (i, c) in case.found.iter().enumerate() {
        assert!(c.normal.is_finite() && c.normal.length() > 0.0, "{c:?}: {case}");
        let facing = case.facing(c);
        let leaves = i % 2 == 1;
        if facing.abs() > 1e-4 && case.edge_distance(c) >= 1e-9 * case.subject.extent().0 {
            assert_eq!(facing > 0.0, leaves, "{facing} at {i}: {case}");
            checked += 1;
        }
    }
    checked
}

/// Points beside a crossing lie in the plane that its normal says.
pub(crate) fn normals_agree_with_finite_differences(case: &Case<'_>) -> usize {
    if case.is_far(100.0) {
        return 0;
    }
    let ray = &case.ray;
    // A step well below the smallest radius of the samples and well above the rounding of the origin.
    let step = 1e-6 * case.subject.extent().0;
    let (e1, e2) = ray.dir.normalize().any_orthonormal_pair();
    let beside = |c: &Met, e: DVec3| {
        let moved = Ray::new(ray.origin + e * step, ray.dir);
        let p = ray.at(c.t);
        let same = case.subject.crossings(&moved).into_iter();
        let mut same = same.filter(|d| d.patch == c.patch).map(|d| moved.at(d.t));
        same.find(|q| q.distance(p) < 10.0 * step).map(|q| q - p)
    };
    let mut checked = 0;
    for c in &case.found {
        if case.facing(c).abs() <= 0.3 || case.edge_distance(c) < 1e2 * step {
            continue;
        }
        if let (Some(a), Some(b)) = (beside(c, e1), beside(c, e2)) {
            let (measured, normal) = (a.cross(b).normalize(), c.normal.normalize());
            let off = measured.cross(normal).length();
            assert!(
                off < 2e-2,
                "{measured} is not {normal}, off by {off}, at {c:?}: {case}"
            );
            checked += 1;
        }
    }
    checked
}

/// A ray that starts on a surface meets what the line meets next, and never its own start.
pub(crate) fn starts_are_left_out(case: &Case<'_>) -> usize {
    let Case { subject, ray, found } = case;
    let size = subject.extent().0;
    let near = 1e-6 * size / ray.dir.length();
    let apart = found.windows(2).all(|w| w[1].t - w[0].t > 1e3 * near);
    // Along an edge or through a rim, the start's rounding decides which side of it the line is.
    let clear = |c: &Met| case.facing(c).abs() > 1e-2 && case.edge_distance(c) > 1e-6 * size;
    if !apart || case.is_far(1e3) || !found.iter().all(clear) {
        return 0;
    }
    for (i, start) in found.iter().enumerate() {
        let next = subject.onwards(ray, start, near);
        let wanted = found.get(i + 1).map(|c| (c.t - start.t, c.patch));
        let same = match (next, wanted) {
            // Where two patches meet, it may be either.
            (Some(a), Some(b)) => {
                let off = (a.0 - b.0).abs();
                off < near && (a.1 == b.1 || off < 1e-9 * near)
            }
            (a, b) => a.is_none() && b.is_none(),
        };
        assert!(same, "{next:?} is not {wanted:?} from {i}: {case}");
    }
    found.len()
}

/// No crossing is missing and none is made up: walking along the line, what is asked of points changes exactly where
/// crossings are. How many points were inside, and how many outside.
pub(crate) fn sides_change_at_crossings(case: &Case<'_>, points: usize, rng: &mut Rng) -> [usize; 2] {
    let Case { subject, ray, found } = case;
    let mut checked = [0; 2];
    if !subject.is_solid() {
        return checked;
    }
    let (size, center) = subject.extent();
    let nearest = (center - ray.origin).dot(ray.dir) / ray.dir.length_squared();
    for _ in 0..points {
        let t = nearest + rng.within(-2.0, 2.0) * size / ray.dir.length();
        // Beside a crossing, the rounding of the point decides.
        let away = slack(case) / ray.dir.length();
        if found.iter().any(|c| (c.t - t).abs() <= away) {
            continue;
        }
        if let Some(inside) = subject.contains(ray.at(t)) {
            let before = found.iter().filter(|c| c.t < t).count();
            assert_eq!(before % 2 == 1, inside, "at {t}: {case}");
            checked[usize::from(!inside)] += 1;
        }
    }
    checked
}

/// A moved ray meets the moved thing where the ray meets the thing: `moved` is `plain` under `from_plain`. What all but
/// touches is left to rounding.
pub(crate) fn moves_with_its_ray(
    moved: &dyn Subject,
    plain: &dyn Subject,
    plain_from: impl Fn(&Ray) -> Ray,
    ray: Ray,
) -> usize {
    let case = Case::new(moved, ray);
    let other = Case::new(plain, plain_from(&ray));
    let size = moved.extent().0;
    let near = 1e-7 * size / ray.dir.length();
    let (found, seen) = (&case.found, &other.found);
    let is_close = |found: &[Met]| found.windows(2).any(|w| w[1].t - w[0].t < 1e3 * near);
    let is_edge = |c: &Met| moved.edge_distance(ray.at(c.t)) < 1e-6 * size;
    let touches = |case: &Case<'_>| case.found.iter().any(|c| case.facing(c).abs() < 1e-6);
    let grazes = is_close(found) || touches(&case) || found.iter().any(is_edge);
    if found.len() != seen.len() {
        let there = is_close(seen) || touches(&other) || seen.iter().any(is_edge);
        assert!(grazes || there, "but {seen:?}: {case}");
        return 0;
    }
    if grazes || case.is_far(1e3) {
        return 0;
    }
    for (a, b) in found.iter().zip(seen) {
        // Along a surface, rounding moves the crossing far.
        if case.facing(a).abs() > 1e-4 {
            assert!(
                (a.t - b.t).abs() < near,
                "off by {:e}: but {seen:?}: {case}",
                a.t - b.t
            );
            assert_eq!(a.patch, b.patch, "but {seen:?}: {case}");
        }
    }
    found.len()
}
