//! A scene as a script of its own: one entity a line, without loops, variables or functions.

mod blocks;
mod calls;
mod camera;
mod lights;
mod materials;
mod mesh;
mod order;
mod textures;

use std::{
    collections::BTreeMap,
    fmt::{self, Display, Write},
};

use self::{
    calls::Call,
    order::{NEVER, Order},
    textures::is_named,
};
pub(in crate::scene) use self::{
    camera::{adaptive, camera, crop, filter, lens, motion, shutter, stereo},
    order::{names, own_lights},
};
use super::{
    Attenuation, Encoding, Geometry, Links, MaterialId, MeshId, Object, Sampling, Scene, Settings, TextureId,
    literal::{Components, Number, Text},
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
        if s.min_weight != Settings::MIN_WEIGHT {
            self.call(format_args!("minWeight({});", Number(s.min_weight)))?;
        }
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
}
