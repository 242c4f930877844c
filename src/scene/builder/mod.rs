//! The calls that make a [`Scene`]: matrix stack, material state, shapes, lights, groups.
//!
//! Scripts, importers and Rust programs all build through here, so what a value may be is decided once.

mod blocks;
mod csg;
mod lights;
mod moving;
mod placing;
mod queries;
mod settings;
mod shapes;
mod stack;
mod turning;

use std::{collections::BTreeMap, mem::ManuallyDrop};

pub use blocks::GroupMark;
use placing::Placing;

use super::{
    Attenuation, Camera, Geometry, Group, Links, Material, MaterialId, Object, ROOT_GROUP, Scene, SceneError,
    Settings, material::MaterialKey,
};
use crate::{
    diag::{Code, Diagnostic, Report, SourceLoc},
    limits::Limits,
    math::{DAffine3, DVec3, brief, max_abs},
};

/// Builds a [`Scene`] call by call.
///
/// ```
/// use rtscript::{Builder, DVec3};
/// let mut b = Builder::new();
/// b.material_mut().diffuse = rtscript::Term::color(DVec3::new(1.0, 0.2, 0.1));
/// b.directional(DVec3::ONE, DVec3::ONE)?;
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let scene = b.finish().value;
/// assert_eq!(scene.root().objects.len(), 1);
/// # Ok::<(), rtscript::scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct Builder {
    scene: Scene,
    limits: Limits,
    /// The group being filled.
    group: Group,
    /// The current matrix.
    ctm: Placing,
    /// Saved matrices with the place of their push.
    stack: Vec<(Placing, SourceLoc)>,
    /// Pops may not go below this height: the height at which the innermost block began.
    floor: usize,
    material: Material,
    material_id: Option<MaterialId>,
    /// A tree: a table of hashes moves all that it holds when it grows, which with a million materials nothing could interrupt.
    material_ids: BTreeMap<MaterialKey, MaterialId>,
    attenuation: Attenuation,
    links: Links,
    primitives: usize,
    /// A shape of some object has memory of its own.
    shapes_own_memory: bool,
    lights: usize,
    loc: SourceLoc,
    warnings: Vec<Diagnostic>,
    closed_meshes: csg::ClosedMeshes,
}

impl Default for Builder {
    fn default() -> Self {
        Self::new()
    }
}

impl Builder {
    /// An empty scene with every default, under the default [`Limits`].
    #[must_use]
    pub fn new() -> Self {
        Self::with_limits(Limits::default())
    }

    /// An empty scene with every default.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, Limits};
    /// // As much as a script of a stranger may do.
    /// let mut limits = Limits::untrusted();
    /// limits.primitives = 2;
    /// let mut b = Builder::with_limits(limits);
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// b.sphere(DVec3::X, 1.0)?;
    /// assert!(b.sphere(DVec3::Y, 1.0).is_err());
    /// assert_eq!(b.limits().primitives, 2);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn with_limits(limits: Limits) -> Self {
        Self {
            scene: empty(),
            limits,
            group: Group::default(),
            ctm: Placing::IDENTITY,
            stack: Vec::new(),
            floor: 0,
            material: Material::default(),
            material_id: None,
            material_ids: BTreeMap::new(),
            attenuation: Attenuation::default(),
            links: Links::default(),
            primitives: 0,
            shapes_own_memory: false,
            lights: 0,
            loc: SourceLoc::default(),
            warnings: Vec::new(),
            closed_meshes: csg::ClosedMeshes::default(),
        }
    }

    /// The limits that are enforced.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Index of a source file's name, for [`SourceLoc::file`].
    pub fn file(&mut self, name: &str) -> u16 {
        let files = &mut self.scene.files;
        let index = files.iter().position(|f| f == name).unwrap_or_else(|| {
            files.push(name.to_owned());
            files.len() - 1
        });
        u16::try_from(index).unwrap_or(u16::MAX)
    }

    /// The place that everything made from now on carries.
    pub fn set_loc(&mut self, loc: SourceLoc) {
        self.loc = loc;
    }

    /// The place that everything made now carries.
    #[must_use]
    pub fn loc(&self) -> SourceLoc {
        self.loc
    }

    /// A warning of the class `code` at the current place.
    ///
    /// ```
    /// use rtscript::{Builder, diag::{Code, SourceLoc}};
    /// // A reader of files of its own says where in its file something looks wrong.
    /// let mut b = Builder::new();
    /// let file = b.file("stars.txt");
    /// b.set_loc(SourceLoc { file, line: 7, column: 1 });
    /// b.warn(Code::IgnoredInput, "the star has no color", Some("write one behind its place"));
    /// assert_eq!(b.loc().line, 7);
    /// let warnings = b.take_warnings();
    /// assert_eq!(warnings[0].message, "the star has no color");
    /// // They were handed over: the scene has none left to tell but that it is empty.
    /// assert!(b.finish().warnings.iter().all(|w| w.code == Code::EmptyScene));
    /// ```
    pub fn warn(&mut self, code: Code, message: impl Into<String>, hint: Option<&str>) {
        let loc = self.loc;
        self.warn_at(code, message, hint, loc);
    }

    fn warn_at(&mut self, code: Code, message: impl Into<String>, hint: Option<&str>, loc: SourceLoc) {
        let mut d = Diagnostic::warning(code, message);
        if let Some(file) = self.scene.files.get(usize::from(loc.file)) {
            d = d.at(file, loc.line, u32::from(loc.column));
        }
        if let Some(hint) = hint {
            d = d.hint(hint);
        }
        self.warnings.push(d);
    }

    /// A copy of the scene as it stands; the builder goes on.
    #[must_use]
    pub fn snapshot(&mut self) -> Scene {
        swap_root(&mut self.scene, &mut self.group);
        let scene = self.scene.clone();
        swap_root(&mut self.scene, &mut self.group);
        scene
    }

    /// As [`Builder::snapshot`], without a copy: the scene itself, until [`Builder::take_back`].
    pub(crate) fn lend(&mut self) -> Scene {
        let mut scene = std::mem::replace(&mut self.scene, empty());
        swap_root(&mut scene, &mut self.group);
        scene
    }

    /// Goes on with the scene that was lent.
    pub(crate) fn take_back(&mut self, mut scene: Scene) {
        swap_root(&mut scene, &mut self.group);
        self.scene = scene;
    }

    /// Warnings so far that were not taken.
    pub(crate) fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Warns again of what another builder warned of.
    pub(crate) fn repeat_warnings(&mut self, warnings: &[Diagnostic]) {
        for file in warnings.iter().filter_map(|warning| warning.file.as_deref()) {
            self.file(file);
        }
        self.warnings.extend_from_slice(warnings);
    }

    /// Warnings so far, handed over.
    pub fn take_warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.warnings)
    }

    /// The complete scene, with warnings for what looks wrong: a push never popped, nothing to see, no light.
    #[must_use]
    pub fn finish(mut self) -> Report<Scene> {
        self.warn_unpopped(0);
        swap_root(&mut self.scene, &mut self.group);
        let mut warnings = self.warnings;
        warnings.extend(super::validate::warnings(&self.scene));
        Report {
            value: self.scene,
            warnings,
        }
    }

    /// Frees what was made, without a look at every object where none has memory of its own: millions take four times as long
    /// to look at as to give back.
    pub(crate) fn discard(mut self) {
        if self.shapes_own_memory {
            return;
        }
        for group in self.scene.groups.iter_mut().chain([&mut self.group]) {
            let objects = std::mem::take(&mut group.objects).into_iter();
            drop(objects.map(ManuallyDrop::new).collect::<Vec<_>>());
        }
    }

    fn warn_unpopped(&mut self, from: usize) {
        let unpopped: Vec<SourceLoc> = self.stack.iter().skip(from).map(|(_, loc)| *loc).collect();
        for loc in unpopped {
            self.warn_at(
                Code::PushWithoutPop,
                "pushTransform is never popped",
                Some("add popTransform(), or use group { }"),
                loc,
            );
        }
    }

    /// Refuses a current matrix under which `what` ("sphere") would be flattened.
    #[inline]
    fn require_invertible(&mut self, article: &str, what: &str) -> Result<(), SceneError> {
        if self.ctm.is_singular() {
            return Err(SceneError::new(format!(
                "{article} {what} cannot be placed under a singular matrix: it is flattened to nothing"
            ))
            .class(Code::SingularMatrix)
            .hint("is a component of scale(...) 0?"));
        }
        Ok(())
    }

    #[inline(always)]
    fn add(&mut self, geometry: Geometry, primitives: usize) -> Result<(), SceneError> {
        if let Some(op) = self.group.csg {
            self.require_inside(op, &geometry)?;
        }
        self.primitives = self.primitives.saturating_add(primitives);
        if self.primitives > self.limits.primitives {
            return Err(SceneError::limit(
                "too many shapes",
                "primitives",
                self.limits.primitives,
            ));
        }
        let material = match self.material_id {
            Some(id) => id,
            None => {
                let material = self.material.clone();
                let id = self.material_id(&material);
                self.material_id = Some(id);
                id
            }
        };
        self.shapes_own_memory |= matches!(&geometry, Geometry::Shape(shape) if shape.owns_memory());
        let transform = self.ctm.id(&mut self.scene.transforms);
        self.group.objects.push(Object {
            geometry,
            transform,
            material,
            loc: self.loc,
        });
        Ok(())
    }
}

/// Exchanges the root of a scene and a group that is being filled.
fn swap_root(scene: &mut Scene, group: &mut Group) {
    if let Some(root) = scene.groups.get_mut(ROOT_GROUP.index()) {
        std::mem::swap(root, group);
    }
}

/// A scene of nothing, with every default.
fn empty() -> Scene {
    Scene {
        settings: Settings::default(),
        camera: Camera::default(),
        groups: vec![Group::default()],
        materials: Vec::new(),
        transforms: vec![DAffine3::IDENTITY],
        textures: Vec::new(),
        meshes: Vec::new(),
        triangles: Vec::new(),
        files: Vec::new(),
        names: BTreeMap::new(),
    }
}

#[inline]
fn finite(what: &str, v: DVec3) -> Result<DVec3, SceneError> {
    if v.is_finite() && max_abs(v) <= 1e15 {
        return Ok(v);
    }
    Err(SceneError::new(format!(
        "{what} must be finite numbers within 1e15, not {}",
        brief(v)
    ))
    .class(Code::NotFinite))
}
