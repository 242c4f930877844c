//! Things of a scene as they are matched: what they are, where they are, how they look, each as a number that is equal
//! exactly where the things are.

use crate::{
    diag::SourceLoc,
    math::{DAffine3, DMat3, DVec3},
    scene::{
        Geometry, Group, GroupId, Light, Material, MaterialId, Mesh, Object, Scene, Term, Texels, Texture,
        compare::Place,
    },
    shape::Shape,
};

/// A scene with what its materials, textures and meshes hold, so that their numbers need not be compared.
pub(super) struct Contents<'a> {
    pub(super) scene: &'a Scene,
    /// Names of the groups, each different.
    pub(super) names: Vec<String>,
    textures: Vec<u128>,
    materials: Vec<u128>,
    meshes: Vec<u128>,
}

/// A thing that may be matched with one of the other scene.
#[derive(Clone)]
pub(super) struct Item<'a> {
    pub(super) thing: Thing<'a>,
    pub(super) name: &'static str,
    pub(super) of: &'a str,
    pub(super) loc: SourceLoc,
    pub(super) place: Place,
    /// Everything about it.
    pub(super) full: u128,
    /// Of what kind it is: only things of one kind are matched.
    pub(super) kind: u128,
    /// Its form, without its place.
    pub(super) form: u128,
    /// How it is turned and stretched.
    pub(super) turn: u128,
    /// How it is turned and stretched, and where it is.
    pub(super) matrix: u128,
    /// How it looks.
    pub(super) looks: u128,
    /// Where it is, in the space of its group.
    pub(super) at: DVec3,
}

/// What an [`Item`] is.
#[derive(Clone, Copy)]
pub(super) enum Thing<'a> {
    Object(&'a Object),
    Light(&'a Light),
}

/// Numbers and texts into one number.
pub(super) struct Digest(blake3::Hasher);

impl Digest {
    pub(super) fn new(kind: &str) -> Self {
        let mut digest = Self(blake3::Hasher::new());
        digest.text(kind);
        digest
    }

    fn int(&mut self, n: u64) {
        self.0.update(&n.to_le_bytes());
    }

    fn id(&mut self, n: u128) {
        self.0.update(&n.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.int(text.len() as u64);
        self.0.update(text.as_bytes());
    }

    /// The sign of a zero does not count.
    fn floats(&mut self, numbers: impl IntoIterator<Item = f64>) {
        for x in numbers {
            self.int((x + 0.0).to_bits());
        }
    }

    fn vector(&mut self, v: DVec3) {
        self.floats(v.to_array());
    }

    /// A difference of two points, but for the rounding of a move of both.
    fn offset(&mut self, v: DVec3) {
        for x in v.to_array() {
            self.int(((x * f64::from(1 << 30)).round() as i64).cast_unsigned());
        }
    }

    pub(super) fn done(self) -> u128 {
        let mut bytes = [0; 16];
        self.0.finalize_xof().fill(&mut bytes);
        u128::from_le_bytes(bytes)
    }
}

impl<'a> Contents<'a> {
    pub(super) fn new(scene: &'a Scene, names: Vec<String>) -> Self {
        let textures: Vec<u128> = scene.textures.iter().map(|texture| of_texture(texture)).collect();
        let materials: Vec<u128> = scene
            .materials
            .iter()
            .map(|material| of_material(material, &textures))
            .collect();
        let meshes = scene
            .meshes
            .iter()
            .map(|mesh| of_mesh(mesh, &materials))
            .collect();
        Self {
            scene,
            names,
            textures,
            materials,
            meshes,
        }
    }

    /// What a term holds.
    pub(super) fn term(&self, term: &Term) -> u128 {
        of_term(term, &self.textures)
    }

    fn material(&self, id: MaterialId) -> u128 {
        self.materials.get(id.index()).copied().unwrap_or(0)
    }

    /// Everything about each object.
    pub(super) fn digests(&self, objects: &[Object]) -> Vec<u128> {
        objects.iter().map(|object| self.full(object)).collect()
    }

    fn full(&self, object: &Object) -> u128 {
        let mut digest = Digest::new(object.geometry.name());
        self.geometry(&mut digest, &object.geometry);
        let m = self.scene.world_from_object(object);
        digest.floats(m.to_cols_array());
        if object.geometry.group().is_none() {
            digest.id(self.material(object.material));
        }
        digest.done()
    }

    /// All that the call that made it was given.
    fn geometry(&self, digest: &mut Digest, geometry: &Geometry) {
        match geometry {
            Geometry::Shape(Shape::Sphere(sphere)) => {
                digest.vector(sphere.center());
                digest.floats([sphere.radius()]);
            }
            Geometry::Shape(shape) => digest.text(&format!("{shape:?}")),
            Geometry::Triangle(id) => {
                if let Some(triangle) = self.scene.triangles.get(id.index()) {
                    triangle.positions.iter().for_each(|p| digest.vector(*p));
                    triangle.normals.iter().flatten().for_each(|n| digest.vector(*n));
                }
            }
            Geometry::Mesh(id) => digest.id(self.meshes.get(id.index()).copied().unwrap_or(0)),
            Geometry::Instance(id) | Geometry::Csg(id, _) => {
                digest.text(self.names.get(id.index()).map_or("", String::as_str));
            }
            Geometry::Moving(id) => {
                digest.text(self.names.get(id.index()).map_or("", String::as_str));
                let group = self.scene.groups.get(id.index());
                if let Some(motion) = group.and_then(|group| group.motion) {
                    digest.text(&motion.to_string());
                }
            }
        }
    }

    /// The form, and the point of the object's own space that says where it is.
    fn form(&self, geometry: &Geometry) -> (u128, DVec3) {
        let mut digest = Digest::new("form");
        let from = |points: &[DVec3], digest: &mut Digest| {
            let first = points.first().copied().unwrap_or(DVec3::ZERO);
            points.iter().for_each(|p| digest.offset(*p - first));
            first
        };
        let at = match geometry {
            Geometry::Shape(Shape::Sphere(sphere)) => {
                digest.floats([sphere.radius()]);
                sphere.center()
            }
            Geometry::Shape(Shape::Polygon(polygon)) => from(polygon.points(), &mut digest),
            Geometry::Triangle(id) => match self.scene.triangles.get(id.index()) {
                Some(triangle) => {
                    triangle.normals.iter().flatten().for_each(|n| digest.vector(*n));
                    from(&triangle.positions, &mut digest)
                }
                None => DVec3::ZERO,
            },
            other => {
                self.geometry(&mut digest, other);
                DVec3::ZERO
            }
        };
        (digest.done(), at)
    }

    /// Where the point of an object is that says where it is, and how the object is turned and stretched.
    pub(super) fn placing(&self, object: &Object) -> (DMat3, DVec3) {
        let m = self.scene.world_from_object(object);
        let (_, at) = self.form(&object.geometry);
        (m.matrix3, m.transform_point3(at))
    }
}

/// The objects of a group with these numbers.
pub(super) fn objects<'a>(
    contents: &Contents<'a>,
    group: &'a Group,
    which: &[u32],
    place: &dyn Fn(SourceLoc) -> Place,
) -> Vec<Item<'a>> {
    let item = |object: &'a Object| {
        let scene = contents.scene;
        let (form, _) = contents.form(&object.geometry);
        let (linear, at) = contents.placing(object);
        let of = match object.geometry {
            Geometry::Instance(id) => scene
                .groups
                .get(id.index())
                .map_or("", |group| group.name.as_str()),
            _ => "",
        };
        let mut kind = Digest::new(object.geometry.name());
        if let Geometry::Instance(id) = object.geometry {
            kind.text(contents.names.get(id.index()).map_or("", String::as_str));
        }
        let mut matrix = Digest::new("matrix");
        matrix.floats(DAffine3::from_mat3_translation(linear, at).to_cols_array());
        let mut turn = Digest::new("turn");
        turn.floats(linear.to_cols_array());
        Item {
            turn: turn.done(),
            thing: Thing::Object(object),
            name: object.geometry.name(),
            of,
            loc: object.loc,
            place: place(object.loc),
            full: contents.full(object),
            kind: kind.done(),
            form,
            matrix: matrix.done(),
            looks: match object.geometry.group() {
                Some(_) => 0,
                None => contents.material(object.material),
            },
            at,
        }
    };
    which
        .iter()
        .filter_map(|i| group.objects.get(*i as usize))
        .map(item)
        .collect()
}

/// Which groups a light reaches, by their names.
pub(super) fn linked(scene: &Scene, light: &Light) -> String {
    let names = |ids: &[GroupId]| {
        let names = ids.iter().map(|id| {
            let group = scene.groups.get(id.index());
            group.map_or("", |group| group.name.as_str())
        });
        names.collect::<Vec<_>>().join(", ")
    };
    let only = light.links.only().map_or("all".to_owned(), names);
    match light.links.except() {
        [] => only,
        except => format!("{only} except {}", names(except)),
    }
}

/// The lights of a group from its own calls: those that instances bring are told of where they are defined.
pub(super) fn lights<'a>(
    scene: &'a Scene,
    group: &'a Group,
    place: &dyn Fn(SourceLoc) -> Place,
) -> Vec<Item<'a>> {
    let item = |light: &'a Light| {
        let (name, vectors) = (light.kind.name(), light.kind.vectors());
        let at = vectors.first().map_or(DVec3::ZERO, |first| first.value);
        let mut form = Digest::new(name);
        for vector in vectors.iter().skip(1) {
            form.vector(vector.value);
        }
        for corner in light.kind.triangles().as_flattened() {
            form.vector(*corner);
        }
        form.floats(light.kind.numbers().into_iter().map(|(_, number)| number));
        let mut matrix = Digest::new("at");
        matrix.vector(at);
        let mut looks = Digest::new("light");
        looks.vector(light.color);
        if !light.links.is_all() {
            looks.text(&linked(scene, light));
        }
        if let Some(a) = light.kind.attenuation() {
            looks.floats([a.constant, a.linear, a.quadratic]);
        }
        let (form, matrix, looks) = (form.done(), matrix.done(), looks.done());
        let mut full = Digest::new(name);
        [form, matrix, looks].into_iter().for_each(|part| full.id(part));
        Item {
            turn: 0,
            thing: Thing::Light(light),
            name,
            of: "",
            loc: light.loc,
            place: place(light.loc),
            full: full.done(),
            kind: Digest::new(name).done(),
            form,
            matrix,
            looks,
            at,
        }
    };
    let own = crate::scene::source::own_lights(scene, group).into_iter();
    own.flat_map(|part| group.lights.get(part).unwrap_or(&[]))
        .map(item)
        .collect()
}

fn of_texture(texture: &Texture) -> u128 {
    let mut digest = Digest::new("texture");
    match texture {
        Texture::Image(image) => {
            digest.int(u64::from(image.width));
            match &image.texels {
                Texels::Srgb8(texels) => {
                    digest.0.update(texels.as_flattened());
                }
                Texels::Linear(texels) => digest.floats(texels.as_flattened().iter().copied()),
            }
        }
        Texture::Checker { even, odd, size } => {
            digest.vector(*even);
            digest.vector(*odd);
            digest.floats([*size]);
        }
        Texture::Custom(texture) => digest.text(&texture.identity()),
        Texture::VertexColors => digest.text("vertexColors"),
        Texture::Pattern(_) | Texture::Mix(_) | Texture::Placed(_) | Texture::Mapped(_) => {
            // A picture by what it shows, wherever it stands.
            let name = |part: &std::sync::Arc<Texture>| {
                matches!(**part, Texture::Image(_)).then(|| of_texture(part).to_string())
            };
            digest.text(&texture.call(&name));
        }
    }
    digest.done()
}

fn of_term(term: &Term, textures: &[u128]) -> u128 {
    let mut digest = Digest::new("term");
    digest.vector(term.color);
    digest.id(term
        .texture
        .map_or(0, |id| textures.get(id.index()).copied().unwrap_or(1)));
    digest.done()
}

fn of_material(material: &Material, textures: &[u128]) -> u128 {
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
    let mut digest = Digest::new("material");
    for term in [ambient, emission, diffuse, specular, transmission] {
        digest.id(of_term(term, textures));
    }
    digest.id(reflection.as_ref().map_or(0, |term| of_term(term, textures)));
    digest.floats([*shininess, *ior]);
    if let Some(reflectance) = reflectance {
        digest.text(&reflectance.identity());
    }
    if let Some(finish) = finish {
        digest.text(&finish.text(&|id| textures.get(id.index()).copied().unwrap_or(1).to_string()));
    }
    digest.done()
}

fn of_mesh(mesh: &Mesh, materials: &[u128]) -> u128 {
    let Mesh {
        name: _,
        positions,
        triangles,
        normals,
        uvs,
        colors,
        face_materials,
    } = mesh;
    let mut digest = Digest::new("mesh");
    let indices = |digest: &mut Digest, corners: &[[u32; 3]]| {
        digest.int(corners.len() as u64);
        corners
            .as_flattened()
            .iter()
            .for_each(|i| digest.int(u64::from(*i)));
    };
    digest.int(positions.len() as u64);
    positions.iter().for_each(|p| digest.vector(*p));
    indices(&mut digest, triangles);
    if let Some(normals) = normals {
        normals.values.iter().for_each(|n| digest.vector(*n));
        indices(&mut digest, &normals.indices);
    }
    if let Some(uvs) = uvs {
        uvs.values.iter().for_each(|uv| digest.floats(uv.to_array()));
        indices(&mut digest, &uvs.indices);
    }
    if let Some(colors) = colors {
        colors.values.iter().for_each(|color| digest.vector(*color));
        indices(&mut digest, &colors.indices);
    }
    for id in face_materials {
        digest.id(materials.get(id.index()).copied().unwrap_or(0));
    }
    digest.done()
}
