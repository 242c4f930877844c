//! From the materials of an MTL file to those of the shading equation.

use super::{
    assets::Assets,
    mtl::{Map, MtlMaterial},
    text::Source,
};
use crate::{
    color::Color,
    diag::Diagnostic,
    host::resolve,
    scene::{Builder, Material, Term},
};

/// Kd where a material gives none: OpenGL's.
const DIFFUSE: f64 = 0.8;

/// The material of the shading equation that looks as the MTL file means it.
///
/// - **Kd** is the diffuse color, times `map_Kd`; with a map alone, white times the map.
/// - **Ka** is, in the format, what share of the scene's ambient light comes back. In our equation the ambient
///   term is the light that comes back, so it needs that light: `light`, the current `ambient(color)` of the
///   script, .2 by default as in OpenGL. The share is at most Kd, and Kd where there is no Ka, times the
///   diffuse map: exporters that write Ka 1 1 1 mean "as the diffuse color", and taken literally it would lay a
///   gray veil over the picture; others repeat Kd as Ka; and a file with Ka 0 0 0 keeps its black shadows.
/// - **Ks** is the highlight, times `map_Ks`, unless `illum` is 0 or 1, models without one. Only `illum` 3 to 9
///   are mirrors; most files have a Ks and mean no mirror.
/// - **Ns** is the exponent of the highlight, **Ke** times `map_Ke` the emission.
/// - **d** (or 1 - `Tr`, where there is no `d`) below 1 lets 1 - d of the light through and leaves d to the diffuse
///   and the ambient term. Glass, `illum` 4, 6, 7 and 9, bends it by **Ni**; the others only fade, so that leaves
///   and decals are no lenses.
///
/// # Errors
/// Where a texture cannot be read, with the line that names it.
pub(super) fn material(
    mtl: &MtlMaterial<'_>,
    light: Color,
    source: &Source<'_>,
    assets: &mut Assets<'_>,
    builder: &mut Builder,
) -> Result<Material, Diagnostic> {
    let mut load = |color: Color, map: &Option<Map<'_>>| -> Result<Term, Diagnostic> {
        let mut term = Term::color(color);
        if let Some(map) = map {
            let path = resolve(source.name, &map.file);
            let texture = assets
                .texture(&path)
                .map_err(|error| source.place(error, map.at))?;
            term.texture = Some(builder.texture(&texture));
        }
        Ok(term)
    };
    let white_under =
        |map: &Option<Map<'_>>, without: f64| Color::splat(if map.is_some() { 1.0 } else { without });

    let illumination = mtl.illumination.unwrap_or(2);
    let solid = mtl.dissolve.or(mtl.transparency.map(|t| 1.0 - t)).unwrap_or(1.0);
    let kd = mtl
        .diffuse
        .unwrap_or_else(|| white_under(&mtl.diffuse_map, DIFFUSE));
    let ka = mtl.ambient.map_or(kd, |ka| ka.min(kd));
    let diffuse_map = &mtl.diffuse_map;
    let ambient_map = if diffuse_map.is_some() {
        diffuse_map
    } else {
        &mtl.ambient_map
    };

    let highlight = illumination >= 2;
    let ks = mtl
        .specular
        .unwrap_or_else(|| white_under(&mtl.specular_map, 0.0));
    let specular = if highlight {
        load(ks, &mtl.specular_map)?
    } else {
        Term::BLACK
    };
    let ke = mtl
        .emission
        .unwrap_or_else(|| white_under(&mtl.emission_map, 0.0));
    let glass = matches!(illumination, 4 | 6 | 7 | 9);
    let default = Material::default();
    Ok(Material {
        ambient: load(light * ka * solid, ambient_map)?,
        emission: load(ke, &mtl.emission_map)?,
        diffuse: load(kd * solid, diffuse_map)?,
        specular,
        shininess: mtl.shininess.unwrap_or(default.shininess),
        reflection: if (3..=9).contains(&illumination) {
            None
        } else {
            Some(Term::BLACK)
        },
        transmission: Term::color(Color::splat(1.0 - solid)),
        ior: if glass {
            mtl.ior.unwrap_or(default.ior)
        } else {
            1.0
        },
        reflectance: None,
        finish: None,
    })
}
