//! A scene as stable text, for people, snapshots and differences.

use std::{
    fmt::{self, Write as _},
    sync::Arc,
};

use super::{
    Encoding, Geometry, Group, Light, LightKind, Material, Mesh, Object, Projection, ROOT_GROUP, Sampling,
    Scene, Settings, Shutter, Term, Texels, Texture,
};
use crate::{
    diag::SourceLoc,
    math::{DAffine3, DVec3},
    shape::Shape,
};

pub(super) fn projection(projection: &Projection) -> String {
    match *projection {
        Projection::Perspective { fovy } => format!("fovy {fovy}"),
        Projection::Orthographic { height } => format!("orthographic height {height}"),
        Projection::Fisheye { angle, full_frame } => {
            let full = if full_frame { " full" } else { "" };
            format!("fisheye angle {angle}{full}")
        }
        Projection::Panorama { angle, fovy } => format!("panorama angle {angle} fovy {fovy}"),
        Projection::Cylindrical { angle, fovy } => {
            let fovy = fovy.map_or(String::new(), |fovy| format!(" fovy {fovy}"));
            format!("cylindrical angle {angle}{fovy}")
        }
    }
}

impl Scene {
    /// The whole scene as text, one entity a line, the same on every machine. Numbers are the shortest that
    /// read back as the same; a term of a material that has its default is left out.
    #[must_use]
    pub fn dump(&self) -> String {
        self.dump_short(usize::MAX)
    }

    /// As [`Scene::dump`], but of each list (the objects of a group, its lights, materials, ...) only the first
    /// `limit` entries, then how many more there are and a hash of their text.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3};
    /// let mut b = Builder::new();
    /// for i in 0..1000 {
    ///     b.sphere(DVec3::X * f64::from(i), 0.4)?;
    /// }
    /// let scene = b.finish().value;
    /// let short = scene.dump_short(3);
    /// assert!(short.len() < 2000 && scene.dump().len() > 20_000);
    /// assert!(short.contains("997 more"), "{short}");
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn dump_short(&self, limit: usize) -> String {
        let mut out = String::new();
        self.write_settings(&mut out);
        numbered(&mut out, limit, "file", &self.files, |line, name| {
            write!(line, " {name:?}")
        });
        for (i, group) in self.groups.iter().enumerate() {
            self.write_group(&mut out, limit, i, group);
        }
        numbered(&mut out, limit, "material", &self.materials, write_material);
        numbered(&mut out, limit, "texture", &self.textures, |line, texture| {
            line.push(' ');
            write_texture(line, self, texture)
        });
        numbered(&mut out, limit, "mesh", &self.meshes, |line, mesh| {
            line.push(' ');
            write_mesh(line, mesh)
        });
        out
    }

    fn write_settings(&self, out: &mut String) {
        let s = &self.settings;
        let encoding = match s.encoding {
            Encoding::Srgb => "srgb",
            Encoding::Raw => "raw",
        };
        if let Some(edition) = s.edition {
            out.push_str(&format!("edition {edition}\n"));
        }
        let c = &self.camera;
        let lines = [
            format!("size {} {}", s.width, s.height),
            format!("samples {} max_depth {} seed {}", s.samples, s.max_depth, s.seed),
            format!("background {} encoding {encoding}", Vector(s.background)),
            format!(
                "camera eye {} at {} up {} {}",
                Vector(c.eye),
                Vector(c.at),
                Vector(c.up),
                projection(&c.projection)
            ),
        ];
        let rare = [
            c.lens.map(|lens| format!("lens {lens:?}")),
            c.stereo.map(|stereo| format!("stereo {stereo:?}")),
            c.motion.map(|motion| format!("motion {motion:?}")),
            (c.shutter != Shutter::default())
                .then(|| format!("shutter {} {}", c.shutter.open, c.shutter.close)),
            (s.min_weight != Settings::MIN_WEIGHT).then(|| format!("min_weight {}", s.min_weight)),
            (s.sampling != Sampling::default()).then(|| format!("sampler {}", s.sampling.name())),
            (!s.filter.is_pixel()).then(|| format!("filter {} {}", s.filter.kind.name(), s.filter.radius)),
            s.adaptive
                .map(|a| format!("adaptive error {} min {}", a.error, a.min)),
            s.crop.map(|crop| format!("crop {crop:?}")),
        ];
        let rare = rare.into_iter().flatten();
        for line in lines.into_iter().chain(rare).chain(s.surroundings.lines()) {
            out.push_str(&line);
            out.push('\n');
        }
    }

    fn write_group(&self, out: &mut String, limit: usize, index: usize, group: &Group) {
        let name = if index == ROOT_GROUP.index() {
            "root".to_owned()
        } else {
            format!("{:?}", group.name)
        };
        list(out, limit, std::iter::once(name), |line, name| {
            let (objects, lights) = (group.objects.len(), group.lights.len());
            write!(line, "group {index} {name} objects {objects} lights {lights}")?;
            if let Some(motion) = group.motion {
                write!(line, " motion {motion}")?;
            }
            write_loc(line, group.loc)
        });
        numbered(out, limit, "  object", &group.objects, |line, object| {
            line.push(' ');
            self.write_object(line, object)
        });
        numbered(out, limit, "  light", &group.lights, |line, light| {
            line.push(' ');
            write_light(line, light)
        });
    }

    fn write_object(&self, line: &mut String, object: &Object) -> fmt::Result {
        match &object.geometry {
            Geometry::Shape(Shape::Custom(shape)) => write!(line, "{} {}", shape.name(), shape.identity())?,
            Geometry::Shape(shape) => write!(line, "{}{}", shape.name(), fields(&format!("{shape:?}")))?,
            Geometry::Triangle(id) => {
                write!(line, "tri")?;
                if let Some(triangle) = self.triangles.get(id.index()) {
                    for p in triangle.positions {
                        write!(line, " ({})", Vector(p))?;
                    }
                    for n in triangle.normals.into_iter().flatten() {
                        write!(line, " normal ({})", Vector(n))?;
                    }
                }
            }
            Geometry::Mesh(id) => write!(line, "mesh {}", id.0)?,
            Geometry::Instance(id) => write!(line, "instance {}", id.0)?,
            Geometry::Csg(id, op) => write!(line, "{op} {}", id.0)?,
            Geometry::Moving(id) => write!(line, "moving {}", id.0)?,
        }
        if object.geometry.group().is_none() {
            write!(line, " material {}", object.material.0)?;
        }
        let matrix = self.world_from_object(object);
        if matrix != DAffine3::IDENTITY {
            write!(line, " matrix")?;
            write_rows(line, &matrix)?;
        }
        write_loc(line, object.loc)
    }
}

/// Writes the lines of a list, the first `limit` in full.
fn list<T>(
    out: &mut String,
    limit: usize,
    items: impl Iterator<Item = T>,
    write: impl Fn(&mut String, T) -> fmt::Result,
) {
    let mut rest = blake3::Hasher::new();
    let mut more = 0u64;
    let mut line = String::new();
    for (i, item) in items.enumerate() {
        line.clear();
        // Writing into a String does not fail.
        let _ = write(&mut line, item);
        line.push('\n');
        if i < limit {
            out.push_str(&line);
        } else {
            more += 1;
            rest.update(line.as_bytes());
        }
    }
    if more > 0 {
        let hash = rest.finalize().to_hex();
        let _ = writeln!(out, "  and {more} more, hash {}", &hash[..32]);
    }
}

/// Writes a list whose lines begin with what they are and their number.
fn numbered<T>(
    out: &mut String,
    limit: usize,
    what: &str,
    items: &[T],
    write: impl Fn(&mut String, &T) -> fmt::Result,
) {
    list(out, limit, items.iter().enumerate(), |line, (i, item)| {
        write!(line, "{what} {i}")?;
        write(line, item)
    });
}

/// Three numbers with blanks between.
struct Vector(DVec3);

impl fmt::Display for Vector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.0.x, self.0.y, self.0.z)
    }
}

/// The upper three rows of a matrix.
fn write_rows(line: &mut String, m: &DAffine3) -> fmt::Result {
    let (a, t) = (m.matrix3, m.translation);
    for (i, t) in t.to_array().into_iter().enumerate() {
        write!(line, " [{} {t}]", Vector(a.row(i)))?;
    }
    Ok(())
}

/// ` at 3:1`, or ` at 0:3:1` with the file's number where it is not the first; nothing where the line is unknown.
fn write_loc(line: &mut String, loc: SourceLoc) -> fmt::Result {
    match loc {
        SourceLoc { line: 0, .. } => Ok(()),
        SourceLoc { file: 0, .. } => write!(line, " at {}:{}", loc.line, loc.column),
        _ => write!(line, " at {}:{}:{}", loc.file, loc.line, loc.column),
    }
}

fn write_light(line: &mut String, light: &Light) -> fmt::Result {
    let attenuation = match &light.kind {
        LightKind::Point {
            position,
            attenuation,
        } => {
            write!(line, "point {}", Vector(*position))?;
            Some(attenuation)
        }
        LightKind::Directional { direction } => {
            write!(line, "directional {}", Vector(*direction))?;
            None
        }
        LightKind::Area {
            corner,
            edge1,
            edge2,
            n,
            attenuation,
        } => {
            let (corner, edge1, edge2) = (Vector(*corner), Vector(*edge1), Vector(*edge2));
            write!(line, "area {corner} edges ({edge1}) ({edge2}) grid {n}")?;
            Some(attenuation)
        }
        kind => {
            line.write_str(kind.word())?;
            for vector in kind.vectors() {
                write!(line, " {} {}", vector.name, Vector(vector.value))?;
            }
            for (name, number) in kind.numbers() {
                write!(line, " {name} {number}")?;
            }
            kind.attenuation()
        }
    };
    write!(line, " color {}", Vector(light.color))?;
    if let Some(a) = attenuation.filter(|a| **a != super::Attenuation::default()) {
        write!(line, " attenuation {} {} {}", a.constant, a.linear, a.quadratic)?;
    }
    let ids = |groups: &[super::GroupId]| groups.iter().map(|id| format!(" {}", id.0)).collect::<String>();
    if let Some(only) = light.links.only() {
        write!(line, " only{}", ids(only))?;
    }
    if !light.links.except().is_empty() {
        write!(line, " except{}", ids(light.links.except()))?;
    }
    write_loc(line, light.loc)
}

impl Material {
    /// Its terms that are not the default's, as a dump has them.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        // Writing into a String does not fail.
        let _ = write_material(&mut text, self);
        text.trim_start().to_owned()
    }
}

fn write_material(line: &mut String, material: &Material) -> fmt::Result {
    let default = Material::default();
    let terms = [
        ("ambient", material.ambient, default.ambient),
        ("emission", material.emission, default.emission),
        ("diffuse", material.diffuse, default.diffuse),
        ("specular", material.specular, default.specular),
        ("transmission", material.transmission, default.transmission),
    ];
    for (name, term, default) in terms {
        if term != default {
            write!(line, " {name}")?;
            write_term(line, &term)?;
        }
    }
    if let Some(term) = &material.reflection {
        write!(line, " reflection")?;
        write_term(line, term)?;
    }
    if material.shininess != default.shininess {
        write!(line, " shininess {}", material.shininess)?;
    }
    if material.ior != default.ior {
        write!(line, " ior {}", material.ior)?;
    }
    if let Some(reflectance) = &material.reflectance {
        write!(line, " reflectance {reflectance:?}")?;
    }
    if let Some(finish) = &material.finish {
        let text = finish.text(&|id| format!("texture_{}", id.0));
        write!(line, " {text}")?;
    }
    if *material == default {
        write!(line, " default")?;
    }
    Ok(())
}

fn write_term(line: &mut String, term: &Term) -> fmt::Result {
    write!(line, " {}", Vector(term.color))?;
    match term.texture {
        Some(id) => write!(line, " texture {}", id.0),
        None => Ok(()),
    }
}

fn write_texture(line: &mut String, scene: &Scene, texture: &Texture) -> fmt::Result {
    match texture {
        Texture::Image(image) => {
            let mut hasher = blake3::Hasher::new();
            let encoding = match &image.texels {
                Texels::Srgb8(texels) => {
                    hasher.update(texels.as_flattened());
                    "srgb"
                }
                Texels::Linear(texels) => {
                    update(&mut hasher, texels.as_flattened().iter().map(|v| v.to_bits()));
                    "linear"
                }
            };
            let hash = hasher.finalize().to_hex();
            let (name, width, height) = (&image.name, image.width, image.height);
            write!(
                line,
                "image {name:?} {width} x {height} {encoding} hash {}",
                &hash[..32]
            )
        }
        Texture::Checker { even, odd, size } => {
            write!(
                line,
                "checker even {} odd {} size {size}",
                Vector(*even),
                Vector(*odd)
            )
        }
        Texture::Custom(texture) => write!(line, "custom {texture:?}"),
        Texture::VertexColors => line.write_str("vertex colors"),
        Texture::Pattern(_) | Texture::Mix(_) | Texture::Placed(_) | Texture::Mapped(_) => {
            let name = |part: &Arc<Texture>| Some(format!("texture_{}", scene.texture_number(part)?));
            line.write_str(&texture.call(&name))
        }
    }
}

fn write_mesh(line: &mut String, mesh: &Mesh) -> fmt::Result {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    write!(line, "{:?} vertices {vertices} triangles {triangles}", mesh.name)?;
    let bounds = mesh.bounds();
    if !bounds.is_empty() {
        write!(line, " bounds ({}) ({})", Vector(bounds.min), Vector(bounds.max))?;
    }
    let mut hasher = blake3::Hasher::new();
    update(
        &mut hasher,
        mesh.positions.iter().flat_map(|p| p.to_array()).map(f64::to_bits),
    );
    update(
        &mut hasher,
        mesh.triangles.iter().flatten().map(|&i| u64::from(i)),
    );
    if let Some(normals) = &mesh.normals {
        write!(line, " normals {}", normals.values.len())?;
        update(
            &mut hasher,
            normals.values.iter().flat_map(|n| n.to_array()).map(f64::to_bits),
        );
        update(
            &mut hasher,
            normals.indices.iter().flatten().map(|&i| u64::from(i)),
        );
    }
    if let Some(uvs) = &mesh.uvs {
        write!(line, " uvs {}", uvs.values.len())?;
        update(
            &mut hasher,
            uvs.values.iter().flat_map(|t| t.to_array()).map(f64::to_bits),
        );
        update(&mut hasher, uvs.indices.iter().flatten().map(|&i| u64::from(i)));
    }
    if let Some(colors) = &mesh.colors {
        write!(line, " colors {}", colors.values.len())?;
        update(
            &mut hasher,
            colors.values.iter().flat_map(|c| c.to_array()).map(f64::to_bits),
        );
        update(
            &mut hasher,
            colors.indices.iter().flatten().map(|&i| u64::from(i)),
        );
    }
    if !mesh.face_materials.is_empty() {
        let mut used: Vec<_> = mesh.face_materials.clone();
        used.sort_unstable();
        used.dedup();
        let names = used.iter().map(|id| match *id {
            super::MaterialId::INHERIT => "own".to_owned(),
            id => id.0.to_string(),
        });
        write!(line, " materials {}", names.collect::<Vec<_>>().join(" "))?;
        update(&mut hasher, mesh.face_materials.iter().map(|id| u64::from(id.0)));
    }
    write!(line, " hash {}", &hasher.finalize().to_hex()[..32])
}

/// Feeds numbers as little-endian bytes, so that the hash is the same on every machine.
fn update(hasher: &mut blake3::Hasher, numbers: impl Iterator<Item = u64>) {
    for number in numbers {
        hasher.update(&number.to_le_bytes());
    }
}

/// From the derived `Sphere(Sphere { center: DVec3(0.0, 1.5, 0.0), radius: 1.0 })` to
/// ` { center: (0, 1.5, 0), radius: 1 }`; nothing for a shape without parameters. A shape that keeps derived
/// numbers beside its parameters writes its `Debug` by hand, without them.
fn fields(debug: &str) -> String {
    let Some(fields) = debug.find('{').and_then(|start| debug[start..].strip_suffix(')')) else {
        return String::new();
    };
    let fields = fields.replace("DVec3(", "(").replace("DVec2(", "(");
    let mut text = String::from(" ");
    let mut rest = fields.as_str();
    while let Some(i) = rest.find(".0") {
        let after = rest[i + 2..].chars().next();
        let keep = if after.is_some_and(|c| c.is_ascii_digit()) {
            i + 2
        } else {
            i
        };
        text.push_str(&rest[..keep]);
        rest = &rest[i + 2..];
    }
    text + rest
}

#[cfg(test)]
mod tests;
