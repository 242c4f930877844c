//! Relief: a shading normal that is turned as a height or a picture of normals says.

use crate::{
    color::{self, Color},
    math::{DVec2, DVec3, Ray},
    render::{
        microfacet::frame,
        world::{Hit, SurfacePoint, World},
    },
    scene::{Finish, Term},
};

/// How far apart the points are that relief is measured at, as a share of the ray's length: about half a pixel, so that an edge is
/// seen and a grain too fine to be seen is not. (PBR 10.5.3 takes half a pixel, too.)
const STEP: f64 = 5e-4;

/// Turns the shading normal as the relief says.
pub(super) fn relieve<'s>(
    world: &World<'s>,
    finish: &Finish,
    hit: &Hit,
    ray: &Ray,
    at: &mut SurfacePoint<'s>,
) {
    if finish.bump.is_none() && finish.normal_map.is_none() {
        return;
    }
    let n = at.shading_normal;
    let (t, b) = frame(n);
    let moved = |offset: DVec3| world.beside(hit, ray, at, offset);
    let trial = at.scale.max(1e-3) * 1e-6;
    // World units in one of the shape's, along each direction.
    let stretched = |dir: DVec3| {
        let object = moved(dir * trial)?.object_position() - at.object_position();
        Some(trial / object.length()).filter(|s| s.is_finite())
    };
    let (Some(along_t), Some(along_b)) = (stretched(t), stretched(b)) else {
        return;
    };
    let step = ((at.position - ray.origin).length() * STEP).max(trial);
    let corners = [t * step, t * -step, b * step, b * -step].map(moved);
    let [Some(t1), Some(t0), Some(b1), Some(b0)] = corners else {
        return;
    };
    // Heights count outward, and the normal looks to the eye.
    let side = if at.from_front { 1.0 } else { -1.0 };
    let mut normal = n;
    if let Some(map) = &finish.normal_map {
        let round = |d: DVec2| DVec2::new(d.x - (d.x + 0.5).floor(), d.y - (d.y + 0.5).floor());
        let (dt, db) = (round(t1.uv - t0.uv), round(b1.uv - b0.uv));
        let det = dt.x * db.y - dt.y * db.x;
        let along_u = (t * db.y - b * dt.y) / det;
        let along_v = (b * dt.x - t * db.x) / det;
        if let Some(texture) = world.scene.textures.get(map.texture.index())
            && (along_u + along_v).is_finite()
        {
            let texel = texture.lookup(&at.texture_point());
            // A picture's bytes are the numbers themselves here, and no light.
            let texel = if texture.is_srgb() {
                Color::new(
                    color::srgb_from_linear(texel.x),
                    color::srgb_from_linear(texel.y),
                    color::srgb_from_linear(texel.z),
                )
            } else {
                texel
            };
            let [x, y, z] = (texel * 2.0 - Color::ONE).to_array();
            let (u, v) = (along_u / along_u.length(), along_v / along_v.length());
            let strength = Term::number_of(world.term(&map.strength, at));
            normal = (u * x + v * y) * (strength * side) + n * z.max(1e-3);
            normal /= normal.length();
        }
    }
    if let Some(bump) = &finish.bump {
        let height = |at: &SurfacePoint<'_>| {
            color::luminance(world.term(&bump.texture, at)) * Term::number_of(world.term(&bump.height, at))
        };
        let slope_t = (height(&t1) - height(&t0)) * along_t / (2.0 * step);
        let slope_b = (height(&b1) - height(&b0)) * along_b / (2.0 * step);
        normal -= (t * slope_t + b * slope_b) * side;
        normal /= normal.length();
    }
    if normal.is_finite() {
        at.shading_normal = normal;
    }
}
