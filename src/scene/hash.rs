//! A scene's identity.

use super::{
    AnimatedTransform, Attenuation, Attribute, Camera, Encoding, Environment, Fog, Geometry, Group, Haze,
    ImageTexture, Light, LightKind, Material, Mesh, Object, Occlusion, Projection, Sampling, Scene, Settings,
    Shutter, Sky, Surroundings, Term, Texels, Texture, Triangle,
};
use crate::{
    math::{DAffine3, DVec2, DVec3},
    shape::Shape,
};

impl Scene {
    /// 128 bits of BLAKE3 over everything that can reach a pixel, as 32 hexadecimal digits: the same on every
    /// machine, whatever the script's lines, comments and names are. Scenes of one hash give one picture; one
    /// picture may come from scenes of several hashes.
    #[must_use]
    pub fn hash(&self) -> String {
        let mut digest = Digest(blake3::Hasher::new());
        // A field that is added must be decided about here.
        let Self {
            settings,
            camera,
            groups,
            materials,
            transforms,
            textures,
            meshes,
            triangles,
            files: _,
            names: _,
        } = self;
        digest.settings(settings);
        digest.camera(camera);
        digest.each(groups, Digest::group);
        digest.each(materials, Digest::material);
        digest.each(transforms, Digest::matrix);
        digest.each(textures, |d, texture| d.texture(self, texture));
        digest.each(meshes, |d, mesh| d.mesh(mesh));
        digest.each(triangles, Digest::triangle);
        digest.0.finalize().to_hex()[..32].to_owned()
    }
}

/// Numbers as their bits, least byte first; lists after their length; choices as a number.
struct Digest(blake3::Hasher);

impl Digest {
    fn int(&mut self, n: u64) {
        self.0.update(&n.to_le_bytes());
    }

    fn ints<const N: usize>(&mut self, numbers: [u32; N]) {
        for n in numbers {
            self.int(u64::from(n));
        }
    }

    fn floats<const N: usize>(&mut self, numbers: [f64; N]) {
        for x in numbers {
            self.float(x);
        }
    }

    fn float(&mut self, x: f64) {
        self.int(x.to_bits());
    }

    fn text(&mut self, text: &str) {
        self.int(text.len() as u64);
        self.0.update(text.as_bytes());
    }

    fn vector(&mut self, v: DVec3) {
        let mut bytes = [0; 24];
        for (place, x) in bytes.as_chunks_mut().0.iter_mut().zip(v.to_array()) {
            *place = x.to_bits().to_le_bytes();
        }
        self.0.update(&bytes);
    }

    fn vectors<const N: usize>(&mut self, vectors: [DVec3; N]) {
        for v in vectors {
            self.vector(v);
        }
    }

    fn each<T>(&mut self, items: &[T], write: impl Fn(&mut Self, &T)) {
        self.int(items.len() as u64);
        for item in items {
            write(self, item);
        }
    }

    fn option<T>(&mut self, value: Option<&T>, write: impl Fn(&mut Self, &T)) {
        self.int(u64::from(value.is_some()));
        if let Some(value) = value {
            write(self, value);
        }
    }

    fn settings(&mut self, settings: &Settings) {
        let Settings {
            width,
            height,
            samples,
            max_depth,
            min_weight,
            background,
            encoding,
            seed,
            surroundings,
            sampling,
            filter,
            adaptive,
            crop,
            edition: _,
        } = settings;
        // The newest is what a scene has that asks for none.
        self.int(u64::from(settings.edition().year()));
        self.ints([*width, *height, *samples, *max_depth]);
        self.vector(*background);
        self.int(match encoding {
            Encoding::Srgb => 0,
            Encoding::Raw => 1,
        });
        self.int(*seed);
        if *min_weight != Settings::MIN_WEIGHT {
            self.text(&format!("{min_weight:?}"));
        }
        if *sampling != Sampling::default() {
            self.text(sampling.name());
        }
        if !filter.is_pixel() {
            self.text(&format!("{filter:?}"));
        }
        if let Some(adaptive) = adaptive {
            self.text(&format!("{adaptive:?}"));
        }
        if let Some(crop) = crop {
            self.text(&format!("{crop:?}"));
        }
        self.surroundings(surroundings);
    }

    /// Nothing where there are none, as it was before there could be any; what there is has a name before it.
    fn surroundings(&mut self, surroundings: &Surroundings) {
        let Surroundings {
            environment,
            occlusion,
            fog,
            haze,
        } = surroundings;
        if let Some(Environment {
            sky,
            strength,
            rotation,
            n,
        }) = environment
        {
            self.text("environment");
            match sky {
                Sky::Gradient {
                    zenith,
                    horizon,
                    ground,
                } => {
                    self.int(0);
                    self.vectors([*zenith, *horizon, *ground]);
                }
                Sky::Image(id) => self.ints([1, id.0]),
                Sky::Daylight {
                    sun,
                    turbidity,
                    ground,
                } => {
                    self.int(2);
                    self.vectors([*sun, *ground]);
                    self.float(*turbidity);
                }
            }
            self.vector(*strength);
            self.float(*rotation);
            self.int(u64::from(*n));
        }
        if let Some(Occlusion { distance, n }) = occlusion {
            self.text("occlusion");
            self.float(*distance);
            self.int(u64::from(*n));
        }
        if let Some(Fog {
            color,
            distance,
            base,
            height,
        }) = fog
        {
            self.text("fog");
            self.vector(*color);
            self.floats([*distance, *base]);
            self.option(height.as_ref(), |d, height| d.float(*height));
        }
        if let Some(Haze {
            density,
            albedo,
            forward,
            n,
        }) = haze
        {
            self.text("haze");
            self.vector(*albedo);
            self.floats([*density, *forward]);
            self.int(u64::from(*n));
        }
    }

    fn camera(&mut self, camera: &Camera) {
        let Camera {
            eye,
            at,
            up,
            projection,
            lens,
            stereo,
            motion,
            shutter,
        } = camera;
        self.vectors([*eye, *at, *up]);
        // What there is not is not told of, as it was before there could be.
        match projection {
            Projection::Perspective { fovy } => self.float(*fovy),
            other => self.text(&format!("{other:?}")),
        }
        if let Some(lens) = lens {
            self.text(&format!("{lens:?}"));
        }
        if let Some(stereo) = stereo {
            self.text(&format!("{stereo:?}"));
        }
        if let Some(motion) = motion {
            self.text(&format!("{motion:?}"));
        }
        if *shutter != Shutter::default() {
            self.text(&format!("{shutter:?}"));
        }
    }

    fn group(&mut self, group: &Group) {
        let Group {
            name: _,
            objects,
            lights,
            loc: _,
            // Told by the object that stands for it.
            csg: _,
            motion,
        } = group;
        self.each(objects, Self::object);
        self.each(lights, Self::light);
        if let Some(AnimatedTransform {
            translate,
            axis,
            degrees,
            scale,
        }) = motion
        {
            self.text("motion");
            self.vectors([*translate, *axis, *scale]);
            self.float(*degrees);
        }
    }

    fn object(&mut self, object: &Object) {
        let Object {
            geometry,
            transform,
            material,
            loc: _,
        } = object;
        match geometry {
            Geometry::Shape(Shape::Sphere(sphere)) => {
                self.int(0);
                self.vector(sphere.center());
                self.float(sphere.radius());
            }
            // Rare kinds by their text, in which numbers are the shortest that read back as the same.
            Geometry::Shape(shape) => {
                self.int(1);
                self.text(&format!("{shape:?}"));
            }
            Geometry::Triangle(id) => self.ints([2, id.0]),
            Geometry::Mesh(id) => self.ints([3, id.0]),
            Geometry::Instance(id) => self.ints([4, id.0]),
            Geometry::Csg(id, op) => self.ints([5, id.0, *op as u32]),
            Geometry::Moving(id) => self.ints([6, id.0]),
        }
        self.int(u64::from(transform.0));
        self.int(u64::from(material.0));
    }

    fn light(&mut self, light: &Light) {
        let Light {
            kind,
            color,
            links,
            loc: _,
        } = light;
        self.vector(*color);
        // Nothing where it reaches all, as it was before there was anything else.
        if !links.is_all() {
            self.text("links");
            self.int(u64::from(links.only().is_some()));
            self.each(links.only().unwrap_or_default(), |d, id| d.int(u64::from(id.0)));
            self.each(links.except(), |d, id| d.int(u64::from(id.0)));
        }
        match kind {
            LightKind::Point {
                position,
                attenuation,
            } => {
                self.int(0);
                self.vector(*position);
                self.attenuation(attenuation);
            }
            LightKind::Directional { direction } => {
                self.int(1);
                self.vector(*direction);
            }
            LightKind::Area {
                corner,
                edge1,
                edge2,
                n,
                attenuation,
            } => {
                self.int(2);
                self.vectors([*corner, *edge1, *edge2]);
                self.int(u64::from(*n));
                self.attenuation(attenuation);
            }
            kind => {
                self.int(3);
                self.text(kind.word());
                self.each(&kind.vectors(), |d, vector| d.vector(vector.value));
                self.each(&kind.numbers(), |d, (_, number)| d.float(*number));
                self.option(kind.attenuation(), Self::attenuation);
                self.each(kind.triangles(), |d, corners| d.vectors(*corners));
            }
        }
    }

    fn attenuation(&mut self, attenuation: &Attenuation) {
        let Attenuation {
            constant,
            linear,
            quadratic,
        } = attenuation;
        self.floats([*constant, *linear, *quadratic]);
    }

    fn material(&mut self, material: &Material) {
        let Material {
            ambient,
            emission,
            diffuse,
            specular,
            shininess,
            reflection,
            transmission,
            ior,
            reflectance,
            finish,
        } = material;
        for term in [ambient, emission, diffuse, specular, transmission] {
            self.term(term);
        }
        self.option(reflection.as_ref(), Self::term);
        self.floats([*shininess, *ior]);
        // Nothing where there is none, as it was before there could be one.
        if let Some(reflectance) = reflectance {
            self.text(&reflectance.identity());
        }
        if let Some(finish) = finish {
            self.text(&format!(
                "finish {}",
                finish.text(&|id| format!("texture_{}", id.0))
            ));
        }
    }

    fn term(&mut self, term: &Term) {
        let Term { color, texture } = term;
        self.vector(*color);
        self.option(texture.as_ref(), |d, id| d.int(u64::from(id.0)));
    }

    fn matrix(&mut self, matrix: &DAffine3) {
        let m = matrix.matrix3;
        self.vectors([m.x_axis, m.y_axis, m.z_axis, matrix.translation]);
    }

    fn texture(&mut self, scene: &Scene, texture: &Texture) {
        match texture {
            Texture::Image(image) => {
                let ImageTexture {
                    name: _,
                    width,
                    height,
                    texels,
                } = image;
                self.ints([0, *width, *height]);
                match texels {
                    Texels::Srgb8(texels) => {
                        self.int(0);
                        self.0.update(texels.as_flattened());
                    }
                    Texels::Linear(texels) => {
                        self.int(1);
                        self.each(texels, |d, texel| d.vector(DVec3::from_array(*texel)));
                    }
                }
            }
            Texture::Checker { even, odd, size } => {
                self.int(1);
                self.vectors([*even, *odd]);
                self.float(*size);
            }
            Texture::Custom(texture) => {
                self.int(2);
                self.text(&texture.identity());
            }
            Texture::VertexColors => self.int(4),
            // Their numbers are in the text as the shortest that read back as the same.
            Texture::Pattern(_) | Texture::Mix(_) | Texture::Placed(_) | Texture::Mapped(_) => {
                self.int(3);
                self.text(&texture.call(&|part| Some(format!("texture_{}", scene.texture_number(part)?))));
            }
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        let Mesh {
            name: _,
            positions,
            triangles,
            normals,
            uvs,
            colors,
            face_materials,
        } = mesh;
        self.each(positions, |d, p| d.vector(*p));
        self.each(triangles, Self::corners);
        self.option(normals.as_ref(), |d, normals| {
            d.attribute(normals, |d, n: &DVec3| d.vector(*n));
        });
        self.option(uvs.as_ref(), |d, uvs| {
            d.attribute(uvs, |d, uv: &DVec2| d.floats(uv.to_array()));
        });
        self.each(face_materials, |d, id| d.int(u64::from(id.0)));
        // Nothing where there are none: what is older keeps its hash.
        if let Some(colors) = colors {
            self.text("colors");
            self.attribute(colors, |d, color: &DVec3| d.vector(*color));
        }
    }

    fn attribute<T>(&mut self, attribute: &Attribute<T>, write: impl Fn(&mut Self, &T)) {
        let Attribute { values, indices } = attribute;
        self.each(values, write);
        self.each(indices, Self::corners);
    }

    fn corners(&mut self, corners: &[u32; 3]) {
        let mut bytes = [0; 12];
        for (place, n) in bytes.as_chunks_mut().0.iter_mut().zip(corners) {
            *place = n.to_le_bytes();
        }
        self.0.update(&bytes);
    }

    fn triangle(&mut self, triangle: &Triangle) {
        let Triangle { positions, normals } = triangle;
        self.vectors(*positions);
        self.option(normals.as_ref(), |d, normals| d.vectors(*normals));
    }
}

#[cfg(test)]
mod tests;
