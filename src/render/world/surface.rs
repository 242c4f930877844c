//! What a hit looks like: point, normals, texture coordinates, material.

use super::{
    World,
    level::{Level, Primitive, TriangleRun, TriangleSource},
    placing::normal_matrix,
    query::Hit,
};
use crate::{
    color::Color,
    math::{DAffine3, DVec2, DVec3, Ray, larger, max_abs},
    render::microfacet::frame,
    scene::{Attribute, Footprint, Material, MaterialId, Object, Term, TexturePoint},
};

/// A point on a surface, ready for shading.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint<'s> {
    /// In world space.
    pub(crate) position: DVec3,
    /// Unit normal for shading in world space, turned to the side of the true surface that the ray came from.
    pub(crate) shading_normal: DVec3,
    /// Unit normal of the true surface in world space, turned to the side that the ray came from.
    pub(crate) geometric_normal: DVec3,
    /// Whether the ray came from the front: the outside of a solid.
    pub(crate) from_front: bool,
    pub(crate) material: &'s Material,
    /// Size of the numbers that `position` was computed from.
    pub(crate) scale: f64,
    pub(crate) uv: DVec2,
    object_position: DVec3,
    /// Outward, of any length; 0 where no texture asks for it.
    object_normal: DVec3,
    /// How wide a pixel is there, in the object's space and in texture coordinates; 0 where no texture asks.
    width: [f64; 2],
    /// What it covers there, where textures ask. Elsewhere than in the point, which is copied often.
    pub(crate) footprint: Option<&'s Footprint>,
    /// What the corners of a mesh with colors give the point.
    color: Option<Color>,
}

impl SurfacePoint<'_> {
    /// As textures see it.
    pub(crate) fn texture_point(&self) -> TexturePoint {
        TexturePoint {
            uv: self.uv,
            position: self.object_position,
            normal: self.object_normal,
            width: self.width,
            footprint: self.footprint.copied(),
            color: self.color,
        }
    }

    /// In the space of the shape.
    pub(crate) fn object_position(&self) -> DVec3 {
        self.object_position
    }
}

/// A surface in the space of its level.
struct LocalSurface {
    /// Outward, not a unit vector.
    geometric: DVec3,
    /// Interpolated; `None` where it is the same.
    shading: Option<DVec3>,
    uv: DVec2,
    /// The point in the object's space, where solid textures live.
    object_position: DVec3,
    /// See [`SurfacePoint`].
    object_normal: DVec3,
    /// [`MaterialId::INHERIT`] where whatever places the level decides.
    material: MaterialId,
    color: Option<Color>,
}

impl<'s> World<'s> {
    /// The surface where `ray` met `hit`.
    pub(crate) fn surface(&self, hit: &Hit, ray: &Ray) -> Option<SurfacePoint<'s>> {
        self.surface_at::<false>(hit, ray, ray.at(hit.t))
    }

    /// Puts [`World::surface`] where it is wanted: a point is too large to be moved there.
    #[inline(never)]
    pub(crate) fn surface_into(&self, hit: &Hit, ray: &Ray, at: &mut Option<SurfacePoint<'s>>) {
        *at = self.surface_at::<false>(hit, ray, ray.at(hit.t));
    }

    /// The surface of the same primitive that goes on beside a hit of `ray` at `at`, as if the primitive were flat there:
    /// where textures are asked what they change into.
    #[cold]
    #[inline(never)]
    pub(crate) fn beside(
        &self,
        hit: &Hit,
        ray: &Ray,
        at: &SurfacePoint<'_>,
        offset: DVec3,
    ) -> Option<SurfacePoint<'s>> {
        self.surface_at::<true>(hit, ray, at.position + offset)
    }

    /// A place near the primitive with this number, such as one inside of the solid that it belongs to, as its textures see it.
    /// Texture coordinates there are those of some point of the primitive.
    #[cold]
    #[inline(never)]
    pub(crate) fn place_near(&self, number: u64, ray: &Ray, position: DVec3) -> Option<TexturePoint> {
        let near = self.surface_at::<true>(&Hit::of(number), ray, position)?;
        Some(near.texture_point())
    }

    /// Tells textures how wide a pixel is at a hit: `width` across the ray, which the slant of the surface stretches (the cones
    /// of Amanatides, "Ray tracing with cones", SIGGRAPH 1984).
    #[cold]
    #[inline(never)]
    pub(crate) fn measure(&self, hit: &Hit, ray: &Ray, at: &mut SurfacePoint<'s>, width: f64) {
        let cosine = at.geometric_normal.dot(ray.dir).abs().max(0.05);
        let width = width / cosine;
        let (t, b) = frame(at.geometric_normal);
        let mut widest = [0.0f64; 2];
        for dir in [t, b] {
            // A short way, so that the seam of texture coordinates is told from a wide pixel.
            if let Some(beside) = self.beside(hit, ray, at, dir * (width * SHORT_WAY)) {
                let uv = beside.uv - at.uv;
                let uv = DVec2::new(uv.x - (uv.x + 0.5).floor(), uv.y - (uv.y + 0.5).floor());
                let space = (beside.object_position - at.object_position).length();
                widest[0] = widest[0].max(space / SHORT_WAY);
                widest[1] = widest[1].max(uv.length() / SHORT_WAY);
            }
        }
        at.width = widest;
    }

    /// What a pixel covers at a hit, `width` being its width across the ray: the ellipse in which the surface cuts the cone about
    /// the ray (Akenine-Möller et al., "Improved shader and texture level of detail using ray cones", JCGT 2021).
    #[cold]
    #[inline(never)]
    pub(crate) fn footprint(
        &self,
        hit: &Hit,
        ray: &Ray,
        at: &SurfacePoint<'s>,
        width: f64,
    ) -> Option<Footprint> {
        let n = at.geometric_normal;
        let sideways = n.cross(ray.dir);
        let across = if sideways.length() > 1e-9 {
            sideways / sideways.length()
        } else {
            frame(n).0
        };
        let away = across.cross(n);
        let cosine = n.dot(ray.dir).abs().max(LEAST_COSINE);
        let axis = |dir: DVec3, length: f64| {
            let beside = self.beside(hit, ray, at, dir * (length * SHORT_WAY))?;
            let uv = beside.uv - at.uv;
            let uv = DVec2::new(uv.x - (uv.x + 0.5).floor(), uv.y - (uv.y + 0.5).floor());
            let space = beside.object_position - at.object_position;
            Some((space / SHORT_WAY, uv / SHORT_WAY))
        };
        let (long, short) = (axis(away, width / cosine)?, axis(across, width)?);
        Some(Footprint {
            space: [long.0, short.0],
            uv: [long.1, short.1],
        })
    }

    /// The surface of the primitive that `ray` met, at `position`, which is `BESIDE` the hit or the hit itself.
    #[inline(always)]
    fn surface_at<const BESIDE: bool>(
        &self,
        hit: &Hit,
        ray: &Ray,
        position: DVec3,
    ) -> Option<SurfacePoint<'s>> {
        let scene = self.scene;
        let mut level = self.root()?;
        let mut number = hit.number;
        let mut level_from_world = DAffine3::IDENTITY;
        let mut nested = false;
        // Seen from within: cut out of a solid, or out of what is cut out of one.
        let mut inverted = false;
        // The object that placed the innermost level, whose material a shared mesh takes.
        let mut placing_material = None;
        let local = loop {
            let (primitive, rest) = level.by_number(number);
            if level.rare.is_some() {
                inverted ^= Self::is_cut(level, primitive);
                level_from_world = self.moved_from_world(level, level_from_world);
            }
            let Primitive::Instance(i) = primitive else {
                let p = if nested {
                    level_from_world.transform_point3(position)
                } else {
                    position
                };
                break self.local_surface::<BESIDE>(level, primitive, hit, p)?;
            };
            let instance = level.instances.get(i as usize)?;
            placing_material = self.object(level, instance.object).map(|object| object.material);
            level_from_world = if nested {
                instance.inner_from_outer * level_from_world
            } else {
                instance.inner_from_outer
            };
            nested = true;
            level = self.levels.get(instance.level as usize)?;
            number = rest;
        };
        let material = match local.material {
            MaterialId::INHERIT => placing_material?,
            own => own,
        };
        let to_world = |n: DVec3| {
            let n = if nested {
                level_from_world.matrix3.transpose() * n
            } else {
                n
            };
            n / n.length()
        };
        let mut geometric_normal = to_world(local.geometric);
        if inverted {
            geometric_normal = -geometric_normal;
        }
        let from_front = geometric_normal.dot(ray.dir) < 0.0;
        if !from_front {
            geometric_normal = -geometric_normal;
        }
        let shading_normal = match local.shading.map(to_world) {
            Some(n) if n.is_finite() => {
                if n.dot(geometric_normal) < 0.0 {
                    -n
                } else {
                    n
                }
            }
            _ => geometric_normal,
        };
        Some(SurfacePoint {
            position,
            shading_normal,
            geometric_normal,
            from_front,
            material: scene.materials.get(material.index())?,
            scale: larger(max_abs(ray.origin), max_abs(position)),
            uv: local.uv,
            object_position: local.object_position,
            object_normal: local.object_normal,
            width: [0.0; 2],
            footprint: None,
            color: local.color,
        })
    }

    /// The material of the primitive with this number.
    pub(super) fn material(&self, number: u64) -> Option<&'s Material> {
        self.scene.materials.get(self.material_id(number)?.index())
    }

    /// The handle of [`World::material`].
    pub(crate) fn material_id(&self, mut number: u64) -> Option<MaterialId> {
        let mut level = self.root()?;
        let mut placing_material = MaterialId::INHERIT;
        loop {
            let (primitive, rest) = level.by_number(number);
            let object = match primitive {
                Primitive::Triangle(i) => {
                    let run = level.run(i)?;
                    if let Some(own) = self.face_material(run, i) {
                        return Some(own);
                    }
                    run.object
                }
                Primitive::Sphere(i) => level.spheres.get(i as usize)?.object,
                Primitive::Shape(i) => level.shapes.get(i as usize)?.object,
                Primitive::Instance(i) => {
                    let instance = level.instances.get(i as usize)?;
                    placing_material = self.object(level, instance.object)?.material;
                    level = self.levels.get(instance.level as usize)?;
                    number = rest;
                    continue;
                }
            };
            return Some(
                self.object(level, object)
                    .map_or(placing_material, |object| object.material),
            );
        }
    }

    /// Whether a primitive belongs to what is cut out of the solid that its level is.
    #[cold]
    fn is_cut(level: &Level<'_>, primitive: Primitive) -> bool {
        let object = match primitive {
            Primitive::Triangle(i) => level.run(i).map(|run| run.object),
            Primitive::Sphere(i) => level.spheres.get(i as usize).map(|sphere| sphere.object),
            Primitive::Shape(i) => level.shapes.get(i as usize).map(|placed| placed.object),
            Primitive::Instance(i) => level.instances.get(i as usize).map(|instance| instance.object),
        };
        object.is_some_and(|object| level.is_cut_by(object))
    }

    /// The material of a triangle that does not look as the object that places it.
    fn face_material(&self, run: &TriangleRun, triangle: u32) -> Option<MaterialId> {
        let TriangleSource::Mesh(id) = run.source else {
            return None;
        };
        let face = (triangle - run.first) as usize;
        let own = self.scene.meshes.get(id.index())?.face_materials.get(face)?;
        Some(*own).filter(|own| *own != MaterialId::INHERIT)
    }

    /// The object with this index in the group that a level was made from.
    pub(super) fn object(&self, level: &Level, index: u32) -> Option<&'s Object> {
        let group = level.group?;
        self.scene.groups.get(group.index())?.objects.get(index as usize)
    }

    /// `p` is the hit in the level's space.
    #[inline(always)]
    fn local_surface<const BESIDE: bool>(
        &self,
        level: &Level,
        primitive: Primitive,
        hit: &Hit,
        p: DVec3,
    ) -> Option<LocalSurface> {
        match primitive {
            Primitive::Triangle(i) => self.triangle_surface::<BESIDE>(level, level.run(i)?, i, hit, p),
            Primitive::Sphere(i) => {
                let sphere = level.spheres.get(i as usize)?;
                let object = self.object(level, sphere.object)?;
                let normal = p - sphere.center;
                let mut local = LocalSurface {
                    geometric: normal,
                    shading: None,
                    uv: DVec2::ZERO,
                    object_position: p,
                    object_normal: DVec3::ZERO,
                    material: object.material,
                    color: None,
                };
                if self.is_textured(object.material)
                    && let crate::scene::Geometry::Shape(shape) = &object.geometry
                {
                    local.object_position =
                        self.scene.world_from_object(object).inverse().transform_point3(p);
                    let surface = shape.surface(local.object_position, 0);
                    (local.uv, local.object_normal) = (surface.uv, surface.normal);
                }
                Some(local)
            }
            Primitive::Shape(i) => {
                let placed = level.shapes.get(i as usize)?;
                let object = self.object(level, placed.object)?;
                let object_position = placed.object_from_level.transform_point3(p);
                let (normal, uv, object_normal) = if self.is_textured(object.material) {
                    let surface = placed.shape.surface(object_position, hit.part);
                    (surface.normal, surface.uv, surface.normal)
                } else {
                    let normal = placed.shape.normal(object_position, hit.part);
                    (normal, DVec2::ZERO, DVec3::ZERO)
                };
                Some(LocalSurface {
                    geometric: placed.object_from_level.matrix3.transpose() * normal,
                    shading: None,
                    uv,
                    object_position,
                    object_normal,
                    material: object.material,
                    color: None,
                })
            }
            Primitive::Instance(_) => None,
        }
    }

    fn triangle_surface<const BESIDE: bool>(
        &self,
        level: &Level,
        run: &TriangleRun,
        triangle: u32,
        hit: &Hit,
        p: DVec3,
    ) -> Option<LocalSurface> {
        let [a, b, c] = level.corners(triangle);
        let cross = (b - a).cross(c - a);
        let geometric = if run.mirrored { -cross } else { cross };
        let (u, v) = if BESIDE {
            coordinates([a, b, c], p)
        } else {
            (hit.u, hit.v)
        };
        let weights = [1.0 - u - v, u, v];
        let face = (triangle - run.first) as usize;
        let object = self.object(level, run.object);
        let textured = self.has_textures();
        let (normals, uvs, color) = match run.source {
            TriangleSource::Single(id) => (self.scene.triangles.get(id.index())?.normals, None, None),
            TriangleSource::Mesh(id) => {
                let mesh = self.scene.meshes.get(id.index())?;
                (
                    mesh.normals.as_ref().and_then(|normals| normals.corners(face)),
                    textured.then(|| mesh.uvs.as_ref()?.corners(face)).flatten(),
                    match &mesh.colors {
                        Some(colors) if textured => color(colors, face, weights),
                        _ => None,
                    },
                )
            }
        };
        let shading = normals.and_then(|[na, nb, nc]| {
            // Interpolated as unit vectors, whatever lengths the file gives them.
            let n = unit(na) * weights[0] + unit(nb) * weights[1] + unit(nc) * weights[2];
            let n = match (&run.normal_matrix, run.source, object) {
                (Some(matrix), _, _) => **matrix * n,
                (None, TriangleSource::Single(_), Some(object)) => {
                    let placing = self.scene.world_from_object(object);
                    if placing == DAffine3::IDENTITY {
                        n
                    } else {
                        normal_matrix(&placing) * n
                    }
                }
                _ => n,
            };
            (n.is_finite() && n != DVec3::ZERO).then_some(n)
        });
        let uv = uvs.map_or(DVec2::new(u, v), |[ua, ub, uc]| {
            ua * weights[0] + ub * weights[1] + uc * weights[2]
        });
        let material = self
            .face_material(run, triangle)
            .or(object.map(|object| object.material))
            .unwrap_or(MaterialId::INHERIT);
        let (object_position, object_normal) = match object {
            // A shared mesh is in its own space.
            Some(object) if textured => {
                let placing = self.scene.world_from_object(object);
                if placing == DAffine3::IDENTITY {
                    (p, geometric)
                } else {
                    let normal = placing.matrix3.transpose() * geometric;
                    (placing.inverse().transform_point3(p), normal)
                }
            }
            _ => (p, geometric),
        };
        Some(LocalSurface {
            geometric,
            shading,
            uv,
            object_position,
            object_normal,
            material,
            color,
        })
    }

    fn has_textures(&self) -> bool {
        !self.scene.textures.is_empty() || self.uv_everywhere
    }

    #[inline(always)]
    fn is_textured(&self, material: MaterialId) -> bool {
        self.has_textures() && (self.uv_everywhere || self.has_texture(material))
    }

    #[inline(never)]
    fn has_texture(&self, material: MaterialId) -> bool {
        let material = self.scene.materials.get(material.index());
        material.is_some_and(|material| material.is_textured())
    }

    /// The value of a material's term at a point.
    pub(crate) fn term(&self, term: &Term, at: &SurfacePoint<'_>) -> DVec3 {
        self.term_at(term, || at.texture_point())
    }

    /// As [`World::term`] for any place.
    #[inline(always)]
    pub(crate) fn term_at(&self, term: &Term, at: impl FnOnce() -> TexturePoint) -> DVec3 {
        match term.texture.and_then(|id| self.scene.textures.get(id.index())) {
            Some(texture) => term.color * texture.lookup(&at()),
            None => term.color,
        }
    }
}

/// No surface is taken to be more aslant than that.
const LEAST_COSINE: f64 = 1e-3;

/// The share of a pixel's width over which texture coordinates are looked at.
const SHORT_WAY: f64 = 1.0 / 1024.0;

/// Barycentric coordinates of the point of a triangle's plane that is nearest to `p`, for its second and third corner.
fn coordinates([a, b, c]: [DVec3; 3], p: DVec3) -> (f64, f64) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let n = ab.cross(ac);
    let area2 = n.dot(n);
    (n.dot(ap.cross(ac)) / area2, n.dot(ab.cross(ap)) / area2)
}

/// What the corners of a mesh's triangle give a point in it.
#[cold]
#[inline(never)]
fn color(colors: &Attribute<Color>, face: usize, weights: [f64; 3]) -> Option<Color> {
    let [a, b, c] = colors.corners(face)?;
    let mixed = a * weights[0] + b * weights[1] + c * weights[2];
    // Beside the triangle the nearest of its colors goes on.
    Some(mixed.max(a.min(b).min(c)).min(a.max(b).max(c)))
}

fn unit(n: DVec3) -> DVec3 {
    n / n.length()
}
