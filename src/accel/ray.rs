//! Rays in f32, prepared for the conservative tests of boxes and of blocks.

use super::{cuboids, four::F4};
use crate::math::{DVec3, Ray, larger};

/// A power of two.
pub(super) const fn power(exponent: i32) -> f32 {
    f32::from_bits(((127 + exponent) as u32) << 23)
}

/// A ray rounded to f32.
#[derive(Clone, Copy, Debug)]
pub struct Ray32 {
    origin: F4,
    dir: F4,
    /// Sizes of the coordinates.
    far: F4,
    long: F4,
    range: Numbers,
}

/// What a ray's numbers allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Numbers {
    /// No product of them leaves the range of f32, nor does the inverse of a direction along any axis.
    Usual,
    /// The same, but that the ray may be all but perpendicular to an axis.
    Across,
    /// Some may.
    Extreme,
    /// No direction, or a number that is not finite: the ray meets nothing.
    Aimless,
}

/// Usual coordinates are below this, and usual directions between it and its inverse.
const LARGE: f32 = power(60);

impl Ray32 {
    /// Rounds a ray.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let (origin, dir) = (F4::rounded(&ray.origin), F4::rounded(&ray.dir));
        let (far, long) = (origin.abs(), dir.abs());
        // The fourth lane is 0.
        let small = far.add(long).below(F4::splat(LARGE));
        let range = match F4::splat(1.0 / LARGE).below(long).and(small).bits() {
            7 => Numbers::Usual,
            along => Numbers::unusual(ray, along, small.bits()),
        };
        Self {
            origin,
            dir,
            far,
            long,
            range,
        }
    }
}

impl Numbers {
    /// For the lanes `along` which the direction is long enough, and those that are `small` enough.
    #[cold]
    fn unusual(ray: &Ray, along: u32, small: u32) -> Self {
        if small == 15 && along != 0 {
            Self::Across
        } else if ray.origin.is_finite() && ray.dir.is_finite() && ray.dir != DVec3::ZERO {
            Self::Extreme
        } else {
            Self::Aimless
        }
    }
}

/// The largest of the first three lanes.
#[inline(always)]
fn largest(v: F4) -> f32 {
    let [x, y, z, _] = v.to_array();
    larger(larger(x, y), z)
}

/// A ray prepared for box tests.
///
/// With r = 1/d, the distance to a plane p is p r - o r: one fused operation where there is one. For the entry
/// into a box it must not come out too large, for the exit not too small. The error of o r, the rounding of o
/// itself and that of p r where it is rounded are 3 units of 2^-24 |o r|: of o r two values are kept, 6 such units
/// to either side of it. The other errors, those of r, of p r beyond o r, and of the result, are 4 units relative
/// to the distance: the exit's r is stretched by 16. Distances that are negative may then be off in the other
/// direction, but stay negative, which is all that is asked of them.
#[derive(Clone, Copy, Debug)]
pub struct RayBox {
    /// Planes to take for entry and exit, by axis: bytes from the first of a node's.
    pub(super) near: [usize; 3],
    pub(super) far: [usize; 3],
    /// r, and r stretched.
    pub(super) inverse_near: [f32; 4],
    pub(super) inverse_far: [f32; 4],
    /// -o r, made less and made more.
    pub(super) offset_near: [f32; 4],
    pub(super) offset_far: [f32; 4],
}

/// Bytes of the planes of eight boxes.
const PLANE: usize = size_of::<[f32; 8]>();

/// Planes of entry and exit, by axis, for the signs of a direction.
const PLANES: [[[usize; 3]; 2]; 8] = {
    let mut planes = [[[0, PLANE, 2 * PLANE], [3 * PLANE, 4 * PLANE, 5 * PLANE]]; 8];
    let mut signs = 0;
    while signs < 8 {
        let mut axis = 0;
        while axis < 3 {
            let turned = 3 * PLANE * (signs >> axis & 1);
            planes[signs][0][axis] += turned;
            planes[signs][1][axis] -= turned;
            axis += 1;
        }
        signs += 1;
    }
    planes
};

impl RayBox {
    /// Prepares a ray for boxes whose coordinates are at most `extent` in size.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray32, extent: f32) -> Self {
        if ray.range != Numbers::Usual || extent >= LARGE {
            return Self::unusual(ray, extent);
        }
        Self::of(ray, F4::splat(1.0).div(ray.long))
    }

    /// With these inverses of the direction's size along each axis.
    #[inline(always)]
    fn of(ray: &Ray32, inverse: F4) -> Self {
        let sign = ray.dir.sign();
        let inverse = inverse.flip(sign);
        let stretched = inverse.mul(F4::splat(1.0 + 8.0 * f32::EPSILON));
        let away = F4::splat(0.0).sub(ray.origin);
        let margin = ray
            .far
            .mul(F4::splat(3.0 * f32::EPSILON))
            .add(F4::splat(f32::MIN_POSITIVE))
            .mul(stretched.abs());
        let [near, far] = PLANES[sign.bits() as usize & 7];
        Self {
            near,
            far,
            inverse_near: inverse.to_array(),
            inverse_far: stretched.to_array(),
            offset_near: away.mul(inverse).sub(margin).to_array(),
            offset_far: away.mul(stretched).add(margin).to_array(),
        }
    }

    /// Lets a ray whose numbers leave the range of f32 into all boxes, and one that aims nowhere into none.
    #[cold]
    #[inline(never)]
    fn unusual(ray: &Ray32, extent: f32) -> Self {
        let far = match ray.range {
            Numbers::Usual | Numbers::Across if extent < LARGE => {
                return Self::of(ray, bounded(ray, extent));
            }
            Numbers::Aimless => -f32::MAX,
            _ => f32::MAX,
        };
        Self {
            near: PLANES[0][0],
            far: PLANES[0][1],
            inverse_near: [f32::MIN_POSITIVE; 4],
            inverse_far: [f32::MIN_POSITIVE; 4],
            offset_near: [-far; 4],
            offset_far: [far; 4],
        }
    }
}

/// Inverses of the direction's size along each axis: along those that the ray is all but perpendicular to, as large as
/// products with coordinates allow. 0 times an inverse is 0, and a ray in the plane of a face is inside.
fn bounded(ray: &Ray32, extent: f32) -> F4 {
    let inverse = F4::splat(1.0).div(ray.long);
    if F4::splat(power(-66)).below(ray.long).bits() & 7 == 7 {
        return inverse;
    }
    let m = larger(largest(ray.far), extent);
    inverse.min(F4::splat(power(125) / larger(m, 1.0)))
}

/// A ray prepared for the tests of a level's blocks; `blocks.rs` derives the errors, and what M, D and L are.
#[derive(Clone, Copy, Debug)]
pub struct RayBlock {
    pub(super) origin: [f32; 4],
    pub(super) dir: [f32; 4],
    /// D.
    pub(super) long: f32,
    /// Error of edge functions, to be multiplied by D and L, and that of the distance's numerator, by L^2.
    pub(super) slack: f32,
    /// Added to each of them, for what is lost to underflow: at most 2^-149 of a product, which at most four
    /// numbers of the size of M or D then multiply, so that this is ample and not itself lost.
    pub(super) slack_least: f32,
}

impl RayBlock {
    /// `slack` of a unit of M.
    const SLACK: f32 = 22.0 * power(-24);
    /// Error of the determinant, to be multiplied by D and L^2.
    pub(super) const SLACK_DET: f32 = 10.0 * power(-24);

    /// Prepares a ray for a level whose coordinates are at most `extent` in size.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray32, extent: f32) -> Self {
        let [x, y, z, _] = ray.long.to_array();
        let d = x + y + z;
        let m = larger(largest(ray.far), extent);
        // What leaves the range of f32 leaves every question to f64.
        let m = if larger(m, d) < power(36) {
            m
        } else {
            f32::INFINITY
        };
        Self {
            origin: ray.origin.to_array(),
            dir: ray.dir.to_array(),
            long: d,
            slack: Self::SLACK * m,
            slack_least: power(-120) * (m + d + 1.0),
        }
    }
}

/// A ray prepared for the tests of a level's boxes; `cuboids.rs` derives the error, and what M and S are.
#[derive(Clone, Copy, Debug)]
pub struct RayCuboid {
    pub(super) origin: [f32; 4],
    pub(super) dir: [f32; 4],
    /// How far a box's faces are moved, to be multiplied by S. Infinite where every box is possible.
    pub(super) slack: f32,
}

impl RayCuboid {
    /// Prepares a ray for a level whose boxes' coordinates are at most `extent` in size.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray32, extent: f32) -> Self {
        let m = larger(largest(ray.far), extent);
        let long = largest(ray.long);
        let usual = (power(-40)..power(40)).contains(&long);
        Self {
            origin: ray.origin.to_array(),
            dir: ray.dir.to_array(),
            slack: if usual { cuboids::slack(m) } else { f32::INFINITY },
        }
    }
}

/// What the tests of spheres need besides.
#[derive(Clone, Copy, Debug)]
pub struct RaySphere {
    /// 1 / |d|^2.
    pub(super) inverse_dd: f32,
    /// 1 / |d|.
    pub(super) inverse_length: f32,
    /// Error of the distance between a sphere's center and the ray, in units of 2^-24 M: 7 by the difference f
    /// of center and start, at most 3.5 M long, 38 by the parameter of the nearest point, 17 by what is
    /// subtracted from f and by d: 66 are taken. Infinite, which makes every sphere possible and none certain, where
    /// what squares and products lose to underflow is more than the 3.5 that are left: with d between 2^-40 and 2^40
    /// and M at least 2^-50 the margin of a squared distance is 2^-139, what three squares lose is 2^-147.
    pub(super) slack: f32,
}

impl RaySphere {
    /// Prepares a ray that is prepared for blocks.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &RayBlock) -> Self {
        let [x, y, z, _] = ray.dir;
        let inverse_dd = 1.0 / (x * x + y * y + z * z);
        let usual = (power(-80)..power(80)).contains(&inverse_dd) && ray.slack > RayBlock::SLACK * power(-50);
        let slack = if usual { 3.0 * ray.slack } else { f32::INFINITY };
        Self {
            inverse_dd,
            inverse_length: inverse_dd.sqrt(),
            slack,
        }
    }
}
