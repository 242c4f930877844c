//! Shapes that a program makes itself.

use std::{fmt, sync::Arc};

use super::{CrossingSink, Shape, Surface};
use crate::{
    custom::Custom,
    math::{Bounds3, DVec3, Ray},
};

/// A shape of the program's own. It is placed, instanced, shaded, shadowed and seen in mirrors and glass as all others
/// are.
///
/// Every method must give the same answer to the same question, or pictures differ from run to run; to have them the
/// same on every machine too, take functions such as sines from [`math`](crate::math), and nothing fused.
/// What stands for it in hashes is its `Debug` text, see [`Custom`].
///
/// ```
/// use rtscript::{Builder, DVec3, math::{Bounds3, DVec2, Ray}, render::World};
/// use rtscript::shape::{CrossingSink, CustomShape, Shape, Surface};
///
/// /// The plane z = 0 within |x| + |y| <= 1.
/// #[derive(Debug)]
/// struct Diamond;
///
/// impl CustomShape for Diamond {
///     fn name(&self) -> &'static str {
///         "diamond"
///     }
///     fn bounds(&self) -> Option<Bounds3> {
///         Some(Bounds3::new(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)))
///     }
///     fn is_solid(&self) -> bool {
///         false
///     }
///     fn crossings(&self, ray: &Ray, out: &mut dyn CrossingSink) {
///         let t = -ray.origin.z / ray.dir.z;
///         let p = ray.at(t);
///         if p.x.abs() + p.y.abs() <= 1.0 {
///             out.push(t, 0);
///         }
///     }
///     fn surface(&self, p: DVec3, _part: u32) -> Surface {
///         let uv = DVec2::new(p.x, p.y) * 0.5 + 0.5;
///         Surface { normal: DVec3::Z, uv }
///     }
/// }
///
/// let mut b = Builder::new();
/// b.shape(Shape::custom(Diamond))?;
/// let scene = b.finish().value;
/// let ray = Ray::new(DVec3::new(0.2, 0.1, 3.0), DVec3::NEG_Z);
/// assert_eq!(World::compile(&scene)?.raycast(&ray, 9.0).map(|hit| hit.t), Some(3.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait CustomShape: fmt::Debug + Send + Sync {
    /// What messages call it.
    fn name(&self) -> &'static str;

    /// A box around all of it in object space, which must hold every crossing; `None` where it has no end, which makes
    /// every ray try it.
    fn bounds(&self) -> Option<Bounds3>;

    /// True where it encloses a volume, so that a line crosses it an even number of times.
    fn is_solid(&self) -> bool;

    /// Adds all crossings of the ray's whole line, behind its origin too, to `out`. The direction is of any length, and
    /// `t` counts multiples of it, so nothing may be compared with an absolute epsilon. There may be any number: of many,
    /// those are kept that matter to a ray which begins at its origin.
    fn crossings(&self, ray: &Ray, out: &mut dyn CrossingSink);

    /// Normal and texture coordinates at a point `p` on part `part` of the surface, both in object space.
    fn surface(&self, p: DVec3, part: u32) -> Surface;
}

/// Apart from the crossings of our own shapes, which are compiled into one function.
#[cold]
#[inline(never)]
pub(super) fn crossings(shape: &dyn CustomShape, ray: &Ray, out: &mut dyn CrossingSink) {
    shape.crossings(ray, out);
}

impl Shape {
    /// A shape of the program's own.
    #[must_use]
    pub fn custom(shape: impl CustomShape + 'static) -> Self {
        let shared: Arc<dyn CustomShape> = Arc::new(shape);
        Self::Custom(Custom::from(shared))
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Crossings, *};
    use crate::{
        Builder, NoHost, RenderOptions,
        math::DVec2,
        render,
        scene::{Camera, Term},
    };

    /// Nested spheres around the origin: twice as many crossings as radii.
    #[derive(Debug)]
    struct Onion(Vec<f64>);

    impl CustomShape for Onion {
        fn name(&self) -> &'static str {
            "onion"
        }

        fn bounds(&self) -> Option<Bounds3> {
            let most = self.0.iter().copied().fold(0.0, f64::max);
            Some(Bounds3::new(DVec3::splat(-most), DVec3::splat(most)))
        }

        fn is_solid(&self) -> bool {
            true
        }

        fn crossings(&self, ray: &Ray, out: &mut dyn CrossingSink) {
            for radius in &self.0 {
                let mut own = Crossings::default();
                let sphere = super::super::Sphere::new(DVec3::ZERO, *radius).unwrap();
                Shape::Sphere(sphere).crossings(ray, &mut own);
                own.as_slice().iter().for_each(|crossing| out.push(crossing.t, 0));
            }
        }

        fn surface(&self, p: DVec3, _: u32) -> Surface {
            Surface {
                normal: p,
                uv: DVec2::ZERO,
            }
        }
    }

    /// A light behind layers of clear glass, a mirror below.
    fn picture(layers: &[f64], make: impl Fn(&mut Builder, &[f64])) -> String {
        let mut b = Builder::new();
        b.size(24, 24).unwrap();
        b.camera(Camera::new(DVec3::new(0.0, 1.0, 9.0), DVec3::ZERO, DVec3::Y, 40.0).unwrap());
        b.directional(DVec3::new(0.1, 1.0, -1.0), DVec3::ONE).unwrap();
        b.material_mut().diffuse = Term::color(DVec3::new(0.9, 0.4, 0.2));
        b.material_mut().reflection = Some(Term::color(DVec3::splat(0.3)));
        b.push_transform().unwrap();
        b.translate(DVec3::new(0.0, -2.0, 0.0)).unwrap();
        b.shape(Shape::Plane(super::super::Plane)).unwrap();
        b.pop_transform().unwrap();
        b.material_mut().transmission = Term::color(DVec3::splat(0.9));
        b.material_mut().ior = 1.0;
        make(&mut b, layers);
        let scene = b.finish().value;
        render(&scene, &RenderOptions::default(), &NoHost)
            .unwrap()
            .value
            .image
            .hash()
    }

    #[test]
    fn a_shape_of_many_crossings_looks_as_the_shapes_it_is_made_of() {
        let layers = [2.0, 1.8, 1.5, 1.1, 0.6, 0.3];
        let one = picture(&layers, |b, layers| {
            b.shape(Shape::custom(Onion(layers.to_vec()))).unwrap();
        });
        let many = picture(&layers, |b, layers| {
            for radius in layers {
                b.sphere(DVec3::ZERO, *radius).unwrap();
            }
        });
        let fewer = picture(&layers[..5], |b, layers| {
            b.shape(Shape::custom(Onion(layers.to_vec()))).unwrap();
        });
        assert_eq!(one, many);
        assert_ne!(one, fewer);
    }

    #[test]
    fn a_scene_knows_it_by_its_text() {
        let hash = |layers: &[f64]| {
            let mut b = Builder::new();
            b.shape(Shape::custom(Onion(layers.to_vec()))).unwrap();
            let scene = b.finish().value;
            assert!(scene.dump().contains("onion Onion([1.0, "), "{}", scene.dump());
            scene.hash()
        };
        assert_eq!(hash(&[1.0, 0.5]), hash(&[1.0, 0.5]));
        assert_ne!(hash(&[1.0, 0.5]), hash(&[1.0, 0.5 + f64::EPSILON]));
    }
}
