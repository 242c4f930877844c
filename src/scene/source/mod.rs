//! A scene as a script of its own: one entity a line, without loops, variables or functions.

mod calls;
mod camera;
mod lights;
mod mesh;
mod order;
mod textures;

use std::{
    collections::BTreeMap,
    fmt::{self, Display, Write},
    sync::Arc,
};

use self::{
    calls::{Call, Load, Said},
    order::{NEVER, Order, next_uses},
    textures::is_named,
};
pub(in crate::scene) use self::{
    camera::{adaptive, camera, crop, filter, lens, motion, shutter, stereo},
    order::{names, own_lights},
};
use super::{
    Attenuation, CsgOp, Encoding, Finish, Geometry, Group, GroupId, ImageTexture, LightKind, Links, Material,
    MaterialId, MeshId, Object, ROOT_GROUP, Sampling, Scene, Term, Texels, Texture, TextureId, TransformId,
    literal::{Components, Number, Text, Vector},
    number_text,
};
use crate::diag::SourceLoc;

/// The files that textures and meshes of a scene were read from, as the host knows them: relative to the folder of the
/// script.
///
/// ```
/// use rtscript::{NoHost, RunOptions, Script, scene::AssetFiles};
/// let script = Script::compile("a.rhai", "sphere(0, 0, 0, 1);", &Default::default())?;
/// let run = script.run(&NoHost, &RunOptions::default())?.value;
/// let files: &AssetFiles = run.files();
/// assert!(files.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AssetFiles {
    pub(crate) textures: BTreeMap<TextureId, String>,
    pub(crate) meshes: BTreeMap<MeshId, MeshFile>,
}

impl AssetFiles {
    /// True where the scene is made of its script alone.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.textures.is_empty() && self.meshes.is_empty()
    }
}

/// The file that a mesh was read from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct MeshFile {
    pub(crate) path: String,
    /// Its materials were read, too.
    pub(crate) with_materials: bool,
}

/// Writes the scene as a script, each object after its place where `places` says so; see
/// [`Run::write_source`](crate::script::Run::write_source).
pub(crate) fn write(scene: &Scene, files: &AssetFiles, places: bool, out: &mut dyn Write) -> fmt::Result {
    let mut writer = Writer {
        scene,
        files,
        places,
        out,
        names: names(scene),
        order: Order::new(scene),
        is_named: is_named(scene),
        has_finishes: scene.materials.iter().any(|m| m.finish.is_some()),
        next_texture: 0,
        latest: vec![NEVER; scene.transforms.len()],
        material: None,
        attenuation: Attenuation::default(),
        links: Links::default(),
        depth: 0,
    };
    writer.settings()?;
    writer.textures()?;
    writer.surroundings()?;
    writer.out.write_char('\n')?;
    let bound = scene.groups.len();
    writer.group(scene.root(), bound)?;
    writer.defines_before(bound)?;
    writer.register_textures(scene.textures.len())
}

struct Writer<'a> {
    scene: &'a Scene,
    files: &'a AssetFiles,
    places: bool,
    out: &'a mut dyn Write,
    /// Names of the groups.
    names: Vec<String>,
    order: Order,
    /// For each texture whether objects name it themselves, or nothing does: not those that only files bring.
    is_named: Vec<bool>,
    /// Whether any material goes beyond the shading equation.
    has_finishes: bool,
    /// The first texture that no material has had yet.
    next_texture: usize,
    /// For [`next_uses`].
    latest: Vec<u32>,
    /// The current material where it is known.
    material: Option<MaterialId>,
    attenuation: Attenuation,
    links: Links,
    /// Blocks and saved matrices around the line.
    depth: usize,
}

/// A matrix that is saved because more objects than one stand under it.
struct Saved {
    transform: TransformId,
    /// The next object under it.
    next: u32,
}

impl Writer<'_> {
    /// Writes a line: indentation, what `write` writes, the place.
    fn line(&mut self, write: impl FnOnce(&mut dyn Write) -> fmt::Result, loc: SourceLoc) -> fmt::Result {
        for _ in 0..self.depth.min(8) {
            self.out.write_str("    ")?;
        }
        write(self.out)?;
        if self.places && loc.line > 0 {
            let file = self.scene.files.get(usize::from(loc.file));
            let file = file.map_or("", String::as_str).replace(char::is_control, " ");
            write!(self.out, " // {file}:{}", loc.line)?;
            if loc.column > 0 {
                write!(self.out, ":{}", loc.column)?;
            }
        }
        self.out.write_char('\n')
    }

    fn call(&mut self, call: impl Display) -> fmt::Result {
        self.line(|out| write!(out, "{call}"), SourceLoc::default())
    }

    fn settings(&mut self) -> fmt::Result {
        let (s, c) = (&self.scene.settings, &self.scene.camera);
        let encoding = match s.encoding {
            Encoding::Srgb => "srgb",
            Encoding::Raw => "raw",
        };
        self.call(format_args!("edition({});", s.edition()))?;
        self.call(format_args!("size({}, {});", s.width, s.height))?;
        self.call(format_args!("samples({});", s.samples))?;
        self.call(format_args!("maxDepth({});", s.max_depth))?;
        match s.seed.cast_signed() {
            // The one number that has no literal of its own.
            i64::MIN => self.call(format_args!("seed({} - 1);", i64::MIN + 1))?,
            seed => self.call(format_args!("seed({seed});"))?,
        }
        self.call(format_args!("background({});", Components(s.background)))?;
        self.call(format_args!("encoding(\"{encoding}\");"))?;
        if s.sampling != Sampling::default() {
            self.call(format_args!("sampler({});", Text(s.sampling.name())))?;
        }
        if !s.filter.is_pixel() {
            self.call(filter(&s.filter))?;
        }
        for call in s.adaptive.iter().map(adaptive) {
            self.call(call)?;
        }
        for call in s.crop.iter().map(crop).chain(camera(c)) {
            self.call(call)?;
        }
        Ok(())
    }

    /// A constant for each texture but those that the files of meshes bring with them: what shares a texture goes on
    /// sharing it.
    fn textures(&mut self) -> fmt::Result {
        let scene = self.scene;
        let of_files = scene
            .textures
            .iter()
            .enumerate()
            .filter(|(i, _)| self.is_named.get(*i) == Some(&true));
        let named: Vec<_> = of_files.collect();
        if !named.is_empty() {
            self.out.write_char('\n')?;
        }
        for (i, texture) in named {
            let id = TextureId(u32::try_from(i).unwrap_or(u32::MAX));
            match (&**texture, self.files.textures.get(&id)) {
                (_, Some(path)) => self.call(format_args!("const texture_{i} = image({});", Text(path)))?,
                (Texture::Checker { even, odd, size }, None) => self.call(format_args!(
                    "const texture_{i} = checker({}, {}, {});",
                    Vector(*even),
                    Vector(*odd),
                    Number(*size)
                ))?,
                (Texture::Image(image), None) => self.image(i, image)?,
                (
                    Texture::Pattern(_)
                    | Texture::Mix(_)
                    | Texture::Placed(_)
                    | Texture::Mapped(_)
                    | Texture::VertexColors,
                    None,
                ) => {
                    let name = |part: &Arc<Texture>| Some(format!("texture_{}", scene.texture_number(part)?));
                    let call = texture.call(&name);
                    self.call(format_args!("const texture_{i} = {call};"))?;
                }
                (Texture::Custom(texture), None) => self.call(format_args!(
                    "const texture_{i} = customTexture({});",
                    Text(&texture.identity())
                ))?,
            }
        }
        Ok(())
    }

    /// Environment, ambient occlusion, fog and haze.
    fn surroundings(&mut self) -> fmt::Result {
        let surroundings = &self.scene.settings.surroundings;
        if let Some(id) = surroundings.texture() {
            self.register_textures(id.index() + 1)?;
        }
        for call in surroundings.texts().into_iter().flatten() {
            self.call(format_args!("{call};"))?;
        }
        Ok(())
    }

    /// A picture that no file holds.
    fn image(&mut self, i: usize, image: &ImageTexture) -> fmt::Result {
        let (width, height) = (image.width, image.height);
        self.call(format_args!(
            "const texture_{i} = image(#{{ width: {width}, height: {height}, pixels: ["
        ))?;
        match &image.texels {
            Texels::Linear(texels) => {
                for [r, g, b] in texels {
                    self.call(format_args!(
                        "    {}, {}, {},",
                        Number(*r),
                        Number(*g),
                        Number(*b)
                    ))?;
                }
            }
            Texels::Srgb8(_) => {
                for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                    self.call(format_args!("    {},", Components(image.texel(x, y))))?;
                }
            }
        }
        self.call("] });")
    }

    /// The textures before number `end` that nothing has yet get their numbers.
    fn register_textures(&mut self, end: usize) -> fmt::Result {
        while self.next_texture < end {
            let i = self.next_texture;
            if self.is_named.get(i) == Some(&true) {
                self.call(format_args!("group {{ emission(texture_{i}); }}"))?;
            }
            self.next_texture += 1;
        }
        Ok(())
    }

    /// Lights, objects and the groups among them.
    fn group(&mut self, group: &Group, bound: usize) -> fmt::Result {
        let next = next_uses(group, &mut self.latest);
        let mut lights = own_lights(self.scene, group).into_iter();
        self.lights(group, lights.next())?;
        let mut saved: Vec<Saved> = Vec::new();
        for (object, next) in group.objects.iter().zip(next) {
            while self.order.next_group < bound && !self.order.has_come(self.scene, object) {
                let id = self.order.next_define(self.scene, bound);
                self.define(id)?;
            }
            match object.geometry {
                Geometry::Csg(id, op) => self.csg(&mut saved, id.index(), op)?,
                Geometry::Moving(id) => self.moving(&mut saved, (object, next), id.index())?,
                _ => self.placed(&mut saved, object, next)?,
            }
            self.order.see(self.scene, object);
            if order::brought(self.scene, object).is_some() {
                self.lights(group, lights.next())?;
            }
        }
        self.restore(&mut saved, 0)
    }

    fn defines_before(&mut self, bound: usize) -> fmt::Result {
        while self.order.next_group < bound {
            let id = self.order.next_define(self.scene, bound);
            self.define(id)?;
        }
        Ok(())
    }

    fn define(&mut self, id: usize) -> fmt::Result {
        let scene = self.scene;
        let (Some(group), Some(name)) = (scene.groups.get(id), self.names.get(id)) else {
            self.order.next_group = id + 1;
            return Ok(());
        };
        debug_assert!(id != ROOT_GROUP.index());
        if group.is_in_place() {
            self.order.next_group = id + 1;
            return Ok(());
        }
        let head = format!("define {} {{", Text(name));
        self.line(|out| out.write_str(&head), group.loc)?;
        let outside = self.material.take();
        self.depth += 1;
        self.group(group, id)?;
        self.defines_before(id)?;
        self.depth -= 1;
        self.material = outside;
        self.order.next_group = id + 1;
        self.call("}")
    }

    /// The block of a solid that is put together.
    fn csg(&mut self, saved: &mut Vec<Saved>, id: usize, op: CsgOp) -> fmt::Result {
        let scene = self.scene;
        let Some(group) = scene.groups.get(id) else {
            return Ok(());
        };
        let needed = saved.iter().rposition(|s| s.next != NEVER).map_or(0, |i| i + 1);
        self.restore(saved, needed)?;
        self.line(|out| write!(out, "{op} {{"), group.loc)?;
        let outside = self.material;
        self.depth += 1;
        if !saved.is_empty() {
            self.call("loadIdentity();")?;
        }
        self.group(group, id)?;
        self.defines_before(id)?;
        self.depth -= 1;
        self.material = outside;
        self.order.next_group = id + 1;
        self.call("}")
    }

    /// The block of what moves together, under the matrix of the place from which it moves.
    fn moving(&mut self, saved: &mut Vec<Saved>, (object, next): (&Object, u32), id: usize) -> fmt::Result {
        let scene = self.scene;
        let Some((group, motion)) = scene
            .groups
            .get(id)
            .and_then(|group| Some((group, group.motion?)))
        else {
            return Ok(());
        };
        let load = self.matrix(saved, object, next)?;
        let outside = load.map_or(String::new(), |load| format!("group {{ {load} "));
        self.line(|out| write!(out, "{outside}moving {motion} {{"), group.loc)?;
        let material = self.material;
        self.depth += 1;
        self.group(group, id)?;
        self.defines_before(id)?;
        self.depth -= 1;
        self.material = material;
        self.order.next_group = id + 1;
        self.call(if outside.is_empty() { "}" } else { "} }" })
    }

    /// An object under its matrix.
    fn placed(&mut self, saved: &mut Vec<Saved>, object: &Object, next: u32) -> fmt::Result {
        let load = self.matrix(saved, object, next)?;
        self.material(object)?;
        self.object(load.as_deref(), object)
    }

    /// Makes the matrix of an object the current one, where others after it stand under it, too; the call that does so
    /// for it alone where they do not.
    fn matrix(
        &mut self,
        saved: &mut Vec<Saved>,
        object: &Object,
        next: u32,
    ) -> Result<Option<String>, fmt::Error> {
        let id = object.transform;
        if let Some(at) = saved.iter().rposition(|s| s.transform == id) {
            self.restore(saved, at + 1)?;
            if let Some(saved) = saved.last_mut() {
                saved.next = next;
            }
            return Ok(None);
        }
        let needed = saved.iter().rposition(|s| s.next != NEVER).map_or(0, |i| i + 1);
        self.restore(saved, needed)?;
        if id == TransformId::IDENTITY {
            return Ok((!saved.is_empty()).then_some("loadIdentity();".to_owned()));
        }
        let load = Load(&self.scene.world_from_object(object)).to_string();
        if next == NEVER {
            return Ok(Some(load));
        }
        self.call(format_args!("pushTransform(); {load}"))?;
        self.depth += 1;
        saved.push(Saved { transform: id, next });
        Ok(None)
    }

    /// Goes back to where `depth` matrices are saved.
    fn restore(&mut self, saved: &mut Vec<Saved>, depth: usize) -> fmt::Result {
        while saved.len() > depth {
            saved.pop();
            self.depth = self.depth.saturating_sub(1);
            self.call("popTransform();")?;
        }
        Ok(())
    }

    /// The material of an object, where it is not the current one.
    fn material(&mut self, object: &Object) -> fmt::Result {
        let material = self.scene.materials.get(object.material.index());
        let Some(material) = material.filter(|_| self.material != Some(object.material)) else {
            return Ok(());
        };
        self.material = Some(object.material);
        let textures = material.textures().into_iter();
        let new: Vec<usize> = textures.map(|(_, id)| id.index()).collect();
        let mut numbers = self.next_texture;
        for i in new.iter().copied().filter(|i| *i >= self.next_texture) {
            numbers += usize::from(i == numbers);
        }
        let end = new.iter().max().map_or(0, |last| last + 1);
        if numbers < end {
            self.register_textures(end)?;
        }
        self.next_texture = self.next_texture.max(end);
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
        let own = reflectance.as_ref().map_or_else(String::new, |own| {
            format!(", reflectance: {}", Text(&own.identity()))
        });
        let varying = |of: fn(&Finish) -> Option<Term>, number: f64| {
            let term = finish.as_deref().and_then(of).unwrap_or(Term::number(number));
            number_text(&term, &|id| format!("texture_{}", id.0))
        };
        let shininess = varying(|finish| finish.shininess, *shininess);
        let ior = varying(|finish| finish.ior, *ior);
        let finish = if self.has_finishes {
            // What a material does not have must be taken away from the one before.
            let finish = finish.as_deref().cloned().unwrap_or_default();
            format!(", {}", finish.whole_text(&|id| format!("texture_{}", id.0)))
        } else {
            String::new()
        };
        let reflection = reflection.map_or("()".to_owned(), |term| Said(term).to_string());
        self.call(format_args!(
            "material(#{{ ambient: {}, emission: {}, diffuse: {}, specular: {}, shininess: {shininess}, \
             reflection: {reflection}, transmission: {}, ior: {ior}{own}{finish} }});",
            Said(*ambient),
            Said(*emission),
            Said(*diffuse),
            Said(*specular),
            Said(*transmission)
        ))
    }

    /// An object, under a matrix of its own where `load` sets one.
    fn object(&mut self, load: Option<&str>, object: &Object) -> fmt::Result {
        let scene = self.scene;
        let mesh = match object.geometry {
            Geometry::Mesh(id) => scene
                .meshes
                .get(id.index())
                .map(|mesh| (mesh, self.files.meshes.get(&id))),
            _ => None,
        };
        if let Some((_, Some(file))) = mesh {
            self.skip_textures_of(object);
            let options = if file.with_materials {
                ""
            } else {
                ", #{ materials: false }"
            };
            let call = format!("mesh({}{options});", Text(&file.path));
            return self.under(load, &call, object.loc);
        }
        if let Some((mesh, None)) = mesh {
            self.under_begin(load)?;
            self.mesh(mesh)?;
            return self.under_end(load, object.loc);
        }
        let call = Call {
            scene,
            object,
            names: &self.names,
        }
        .to_string();
        self.under(load, &call, object.loc)
    }

    fn under(&mut self, load: Option<&str>, call: &str, loc: SourceLoc) -> fmt::Result {
        self.line(
            |out| match load {
                Some(load) => write!(out, "group {{ {load} {call} }}"),
                None => out.write_str(call),
            },
            loc,
        )
    }

    fn under_begin(&mut self, load: Option<&str>) -> fmt::Result {
        match load {
            Some(load) => self.call(format_args!("group {{ {load} mesh(#{{")),
            None => self.call("mesh(#{"),
        }
    }

    fn under_end(&mut self, load: Option<&str>, loc: SourceLoc) -> fmt::Result {
        self.line(
            |out| out.write_str(if load.is_some() { "}); }" } else { "});" }),
            loc,
        )
    }

    /// The textures of a mesh's own materials get their numbers as it is read.
    fn skip_textures_of(&mut self, object: &Object) {
        let Geometry::Mesh(id) = object.geometry else {
            return;
        };
        if !self.order.is_new_mesh(id) {
            return;
        }
        let scene = self.scene;
        let faces = scene
            .meshes
            .get(id.index())
            .into_iter()
            .flat_map(|mesh| &mesh.face_materials);
        for id in faces {
            let material = scene.materials.get(id.index());
            for (_, texture) in material.into_iter().flat_map(Material::textures) {
                self.next_texture = self.next_texture.max(texture.index() + 1);
            }
        }
    }

    /// Which groups the lights from here on reach, where that is not so already.
    fn light_linking(&mut self, links: &Links) -> fmt::Result {
        if *links == self.links {
            return Ok(());
        }
        self.links = links.clone();
        let end = links.groups().map(|id| id.index() + 1).max().unwrap_or(0);
        self.defines_before(end)?;
        let names = |ids: &[GroupId]| {
            let names = ids.iter().filter_map(|id| self.names.get(id.index()));
            names
                .map(|name| Text(name).to_string())
                .collect::<Vec<_>>()
                .join(", ")
        };
        let only = links.only().map(|only| format!("only: [{}]", names(only)));
        let except = Some(links.except()).filter(|except| !except.is_empty());
        let except = except.map(|except| format!("except: [{}]", names(except)));
        let options: Vec<String> = only.into_iter().chain(except).collect();
        let options = options.join(", ");
        let separator = if options.is_empty() { "" } else { " " };
        // A define that was just written has left what it links its own lights to.
        self.links = links.clone();
        self.call(format_args!(
            "lightLinking(#{{{separator}{options}{separator}}});"
        ))
    }

    fn lights(&mut self, group: &Group, part: Option<std::ops::Range<usize>>) -> fmt::Result {
        let lights = part.and_then(|part| group.lights.get(part)).unwrap_or(&[]);
        for light in lights {
            let (matrix, kind) = lights::arguments(&light.kind);
            let attenuation = kind.attenuation().copied().unwrap_or(self.attenuation);
            if attenuation != self.attenuation {
                self.attenuation = attenuation;
                let Attenuation {
                    constant,
                    linear,
                    quadratic,
                } = attenuation;
                self.call(format_args!(
                    "attenuation({}, {}, {});",
                    Number(constant),
                    Number(linear),
                    Number(quadratic)
                ))?;
            }
            self.light_linking(&light.links)?;
            if let LightKind::Projector(projector) = &kind {
                self.register_textures(projector.image().index() + 1)?;
            }
            let call = lights::LightCall(&kind, light.color).to_string();
            let load = matrix.map(|matrix| Load(&matrix).to_string());
            self.under(load.as_deref(), &call, light.loc)?;
        }
        Ok(())
    }
}
