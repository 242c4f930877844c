//! The calls that make a [`Scene`]: matrix stack, material state, shapes, lights, groups.
//!
//! Scripts, importers and Rust programs all build through here, so what a value may be is decided once.

use std::{
    collections::{BTreeMap, HashMap},
    fmt,
    sync::Arc,
};

use super::{
    Attenuation, Camera, Encoding, Geometry, Group, GroupId, Light, LightKind, Material, MaterialId, Mesh,
    MeshId, Object, ROOT_GROUP, Scene, Settings, Texture, TextureId, TransformId, Triangle, TriangleId,
    material::MaterialKey,
};
use crate::{
    color::Color,
    diag::{Diagnostic, ErrorKind, Report, SourceLoc},
    limits::Limits,
    math::{self, DAffine3, DMat3, DVec3, max_abs},
    shape::{Shape, Sphere},
};

/// A value the scene cannot hold. It carries no place: the caller knows the line.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// Whose fault it is, usually [`ErrorKind::Script`].
    pub kind: ErrorKind,
    /// What is wrong: lower case, no full stop.
    pub message: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl SceneError {
    /// A scene error.
    #[must_use]
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::Script,
            message: message.into(),
            hint: None,
        }
    }

    /// A limit was reached: its name in [`Limits`] and its value.
    #[must_use]
    pub fn limit(what: &str, name: &str, value: impl fmt::Display) -> Self {
        Self {
            kind: ErrorKind::Limit,
            message: format!("{what}: the limit '{name}' is {value}"),
            hint: None,
        }
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for SceneError {}

impl From<SceneError> for Diagnostic {
    fn from(e: SceneError) -> Self {
        let diagnostic = Self::error(e.kind, e.message);
        match e.hint {
            Some(hint) => diagnostic.hint(hint),
            None => diagnostic,
        }
    }
}

/// What a `group` or `define` block restores when it is left; see [`Builder::begin_group`].
#[derive(Debug)]
#[must_use = "hand it back to end_group or end_define"]
pub struct GroupMark {
    depth: usize,
    floor: usize,
    ctm: DAffine3,
    material: Material,
    /// The group that was being filled, where the block is a `define`.
    outer: Option<(String, Group)>,
}

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
/// # Ok::<(), rtscript::SceneError>(())
/// ```
#[derive(Debug)]
pub struct Builder {
    scene: Scene,
    limits: Limits,
    /// The group being filled.
    group: Group,
    ctm: DAffine3,
    /// Saved matrices with the place of their push.
    stack: Vec<(DAffine3, SourceLoc)>,
    /// Pops may not go below this height: the height at which the innermost block began.
    floor: usize,
    material: Material,
    material_id: Option<MaterialId>,
    material_ids: HashMap<MaterialKey, MaterialId>,
    attenuation: Attenuation,
    primitives: usize,
    lights: usize,
    loc: SourceLoc,
    warnings: Vec<Diagnostic>,
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
    #[must_use]
    pub fn with_limits(limits: Limits) -> Self {
        Self {
            scene: Scene {
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
            },
            limits,
            group: Group::default(),
            ctm: DAffine3::IDENTITY,
            stack: Vec::new(),
            floor: 0,
            material: Material::default(),
            material_id: None,
            material_ids: HashMap::new(),
            attenuation: Attenuation::default(),
            primitives: 0,
            lights: 0,
            loc: SourceLoc::default(),
            warnings: Vec::new(),
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

    /// A warning at the current place.
    pub fn warn(&mut self, message: impl Into<String>, hint: Option<&str>) {
        let loc = self.loc;
        self.warn_at(message, hint, loc);
    }

    fn warn_at(&mut self, message: impl Into<String>, hint: Option<&str>, loc: SourceLoc) {
        let mut d = Diagnostic::warning(message);
        if let Some(file) = self.scene.files.get(usize::from(loc.file)) {
            d = d.at(file, loc.line, u32::from(loc.column));
        }
        d.hints.extend(hint.map(str::to_owned));
        self.warnings.push(d);
    }

    // ---- Settings and camera ----

    /// The settings as they stand.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.scene.settings
    }

    /// Picture size in pixels.
    ///
    /// # Errors
    /// Where an edge is 0, or the limits `image_side` or `pixels` are passed.
    pub fn size(&mut self, width: u32, height: u32) -> Result<(), SceneError> {
        if width == 0 || height == 0 {
            return Err(SceneError::new(format!(
                "the picture's size must be at least 1 x 1, not {width} x {height}"
            )));
        }
        let what = format!("a picture of {width} x {height} is too large");
        if width.max(height) > self.limits.image_side {
            return Err(SceneError::limit(&what, "image_side", self.limits.image_side));
        }
        if u64::from(width) * u64::from(height) > self.limits.pixels {
            return Err(SceneError::limit(&what, "pixels", self.limits.pixels));
        }
        (self.scene.settings.width, self.scene.settings.height) = (width, height);
        Ok(())
    }

    /// Rays per pixel.
    ///
    /// # Errors
    /// Where `n` is 0 or past the limit `samples`.
    pub fn samples(&mut self, n: u32) -> Result<(), SceneError> {
        if n == 0 {
            return Err(SceneError::new("there must be at least 1 sample per pixel")
                .hint("samples(1) is the default"));
        }
        if n > self.limits.samples {
            return Err(SceneError::limit(
                &format!("{n} samples are too many"),
                "samples",
                self.limits.samples,
            ));
        }
        self.scene.settings.samples = n;
        Ok(())
    }

    /// Secondary bounces, 0 for none.
    ///
    /// # Errors
    /// Past the limit `depth` (at most 64).
    pub fn max_depth(&mut self, n: u32) -> Result<(), SceneError> {
        let most = self.limits.depth.min(Settings::MAX_DEPTH);
        if n > most {
            return Err(SceneError::limit(
                &format!("{n} bounces are too many"),
                "depth",
                most,
            ));
        }
        self.scene.settings.max_depth = n;
        Ok(())
    }

    /// What a ray sees that leaves the scene.
    ///
    /// # Errors
    /// Where a component is not finite.
    pub fn background(&mut self, color: Color) -> Result<(), SceneError> {
        self.scene.settings.background = finite("the background", color)?;
        Ok(())
    }

    /// How linear light becomes 8 bits.
    pub fn encoding(&mut self, encoding: Encoding) {
        self.scene.settings.encoding = encoding;
    }

    /// Seeds every random choice of the renderer.
    pub fn seed(&mut self, seed: u64) {
        self.scene.settings.seed = seed;
    }

    /// The camera; the last call counts.
    pub fn camera(&mut self, camera: Camera) {
        self.scene.camera = camera;
    }

    // ---- Matrix stack ----

    /// The current matrix: world (or group) from object.
    #[must_use]
    pub fn current_transform(&self) -> DAffine3 {
        self.ctm
    }

    /// Saves the current matrix.
    ///
    /// # Errors
    /// Past the limit `transform_depth`.
    pub fn push_transform(&mut self) -> Result<(), SceneError> {
        if self.stack.len() >= self.limits.transform_depth {
            let limit = self.limits.transform_depth;
            return Err(SceneError::limit(
                "too many pushTransform and group levels",
                "transform_depth",
                limit,
            )
            .hint("every pushTransform() wants a popTransform()"));
        }
        self.stack.push((self.ctm, self.loc));
        Ok(())
    }

    /// Restores the matrix saved last.
    ///
    /// # Errors
    /// Where none is saved, or the last was saved outside the current `group` or `define` block.
    pub fn pop_transform(&mut self) -> Result<(), SceneError> {
        if self.stack.len() <= self.floor {
            let inside = if self.floor > 0 { " inside this block" } else { "" };
            return Err(
                SceneError::new(format!("popTransform without a pushTransform before it{inside}"))
                    .hint("each popTransform() undoes one pushTransform(); remove it or add the push"),
            );
        }
        if let Some((ctm, _)) = self.stack.pop() {
            self.ctm = ctm;
        }
        Ok(())
    }

    /// Multiplies the current matrix on the right, so that `m` acts before what was there.
    ///
    /// # Errors
    /// Where the product is not finite or beyond 1e15.
    pub fn multiply(&mut self, m: DAffine3) -> Result<(), SceneError> {
        let product = self.ctm * m;
        let largest = [
            product.matrix3.x_axis,
            product.matrix3.y_axis,
            product.matrix3.z_axis,
            product.translation,
        ]
        .map(max_abs)
        .into_iter()
        .fold(0.0, f64::max);
        if !product.is_finite() || largest > 1e15 {
            return Err(SceneError::new("the current matrix grows beyond 1e15").hint(
                "is a scale or translate repeated in a loop without pushTransform() and popTransform()?",
            ));
        }
        self.ctm = product;
        Ok(())
    }

    /// Moves what is made from now on.
    ///
    /// # Errors
    /// As [`Builder::multiply`].
    pub fn translate(&mut self, by: DVec3) -> Result<(), SceneError> {
        self.multiply(DAffine3::from_translation(finite("the translation", by)?))
    }

    /// Turns what is made from now on about `axis` (any length but 0) by `degrees`, right-handed.
    ///
    /// # Errors
    /// Where the axis is zero, or as [`Builder::multiply`].
    pub fn rotate(&mut self, axis: DVec3, degrees: f64) -> Result<(), SceneError> {
        let length = finite("the rotation's axis", axis)?.length();
        if !(length > 0.0) {
            return Err(
                SceneError::new("the rotation's axis is zero").hint("rotate([0, 1, 0], 45) turns about Y")
            );
        }
        if !degrees.is_finite() {
            return Err(SceneError::new("the rotation's angle is not a finite number"));
        }
        self.multiply(DAffine3::from_mat3(math::rotation(axis / length, degrees)))
    }

    /// Stretches what is made from now on along the axes.
    ///
    /// # Errors
    /// As [`Builder::multiply`].
    pub fn scale(&mut self, by: DVec3) -> Result<(), SceneError> {
        self.multiply(DAffine3::from_mat3(DMat3::from_diagonal(finite(
            "the scale",
            by,
        )?)))
    }

    /// Multiplies by a 4x4 matrix given row by row.
    ///
    /// # Errors
    /// Where it is not affine (last row 0 0 0 1), or as [`Builder::multiply`].
    pub fn mult_matrix(&mut self, rows: &[f64; 16]) -> Result<(), SceneError> {
        if let Some(i) = rows.iter().position(|x| !x.is_finite()) {
            return Err(SceneError::new(format!(
                "number {} of the matrix is not finite",
                i + 1
            )));
        }
        let [a, b, c, x, d, e, f, y, g, h, i, z, last @ ..] = *rows;
        if last != [0.0, 0.0, 0.0, 1.0] {
            return Err(
                SceneError::new(format!("the matrix is not affine: its last row is {last:?}"))
                    .hint("give the 16 numbers row by row; the last row must be 0, 0, 0, 1"),
            );
        }
        let linear = DMat3::from_cols(DVec3::new(a, d, g), DVec3::new(b, e, h), DVec3::new(c, f, i));
        self.multiply(DAffine3::from_mat3_translation(linear, DVec3::new(x, y, z)))
    }

    /// Sets the current matrix to the identity.
    pub fn load_identity(&mut self) {
        self.ctm = DAffine3::IDENTITY;
    }

    // ---- Blocks ----

    /// Saves matrix and material until [`Builder::end_group`].
    ///
    /// # Errors
    /// Past the limit `transform_depth`.
    pub fn begin_group(&mut self) -> Result<GroupMark, SceneError> {
        let floor = self.floor;
        self.push_transform()?;
        self.floor = self.stack.len();
        Ok(GroupMark {
            depth: self.stack.len() - 1,
            floor,
            ctm: self.ctm,
            material: self.material.clone(),
            outer: None,
        })
    }

    /// Restores what [`Builder::begin_group`] saved, however the block was left.
    pub fn end_group(&mut self, mark: GroupMark) {
        self.warn_unpopped(mark.depth + 1);
        self.stack.truncate(mark.depth);
        self.floor = mark.floor;
        self.ctm = mark.ctm;
        self.set_material(mark.material);
    }

    /// Begins a named group in an object space of its own; what is made until [`Builder::end_define`] goes
    /// into it.
    ///
    /// # Errors
    /// Past the limit `transform_depth`.
    pub fn begin_define(&mut self, name: &str) -> Result<GroupMark, SceneError> {
        let mut mark = self.begin_group()?;
        let outer = std::mem::take(&mut self.group);
        self.group.name = name.to_owned();
        self.group.loc = self.loc;
        self.ctm = DAffine3::IDENTITY;
        mark.outer = Some((name.to_owned(), outer));
        Ok(mark)
    }

    /// Ends a define. With `keep`, its name stands for it from now on; without, it is dropped (the block was
    /// left by an error).
    pub fn end_define(&mut self, mut mark: GroupMark, keep: bool) {
        if let Some((name, outer)) = mark.outer.take() {
            let group = std::mem::replace(&mut self.group, outer);
            if keep {
                let id = GroupId(self.scene.groups.len() as u32);
                self.scene.groups.push(group);
                self.scene.names.insert(name, id);
            }
        }
        self.end_group(mark);
    }

    /// Places the group defined as `name` under the current matrix, its lights too.
    ///
    /// # Errors
    /// Where there is no such group yet, the current matrix is singular, or a limit is passed.
    pub fn instance(&mut self, name: &str) -> Result<(), SceneError> {
        let Some(&id) = self.scene.names.get(name) else {
            let known: Vec<&str> = self.scene.names.keys().map(String::as_str).collect();
            let error = SceneError::new(format!("no group is defined as \"{name}\""));
            let near = crate::diag::nearest_names(name, known.iter().copied());
            return Err(match (near.first(), known.is_empty()) {
                (Some(near), _) => error.hint(format!("did you mean \"{near}\"?")),
                (None, true) => error.hint(format!("define \"{name}\" {{ ... }} must come first")),
                (None, false) => error.hint(format!("defined are: {}", known.join(", "))),
            });
        };
        self.require_invertible("an instance")?;
        let lights = self.scene.groups[id.index()].lights.clone();
        for light in lights {
            self.push_light(light.kind, light.color)?;
        }
        self.add(Geometry::Instance(id), 1)
    }

    // ---- Materials and textures ----

    /// The current material.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// The current material, to be changed.
    pub fn material_mut(&mut self) -> &mut Material {
        self.material_id = None;
        &mut self.material
    }

    /// Sets the current material.
    pub fn set_material(&mut self, material: Material) {
        *self.material_mut() = material;
    }

    /// The handle of a material, the same for equal ones.
    pub fn material_id(&mut self, material: &Material) -> MaterialId {
        let materials = &mut self.scene.materials;
        *self.material_ids.entry(material.key()).or_insert_with(|| {
            materials.push(material.clone());
            MaterialId(materials.len() as u32 - 1)
        })
    }

    /// Adds a texture, to be named in a [`Term`](super::Term). The same `Arc` twice gives the same handle.
    pub fn texture(&mut self, texture: &Arc<Texture>) -> TextureId {
        let textures = &mut self.scene.textures;
        let index = textures
            .iter()
            .position(|t| Arc::ptr_eq(t, texture))
            .unwrap_or_else(|| {
                textures.push(Arc::clone(texture));
                textures.len() - 1
            });
        TextureId(index as u32)
    }

    // ---- Shapes ----

    /// A shape under the current matrix in the current material.
    ///
    /// # Errors
    /// Where the current matrix is singular, or the limit `primitives` is passed.
    pub fn shape(&mut self, shape: Shape) -> Result<(), SceneError> {
        self.require_invertible(&format!("a {}", shape.name()))?;
        self.add(Geometry::Shape(shape), 1)
    }

    /// A sphere.
    ///
    /// # Errors
    /// As [`Sphere::new`] and [`Builder::shape`].
    pub fn sphere(&mut self, center: DVec3, radius: f64) -> Result<(), SceneError> {
        self.shape(Shape::Sphere(Sphere::new(center, radius)?))
    }

    /// A triangle, smooth where it has normals. It may lie flat under a singular matrix.
    ///
    /// # Errors
    /// Where a number is not finite, a normal is zero, or the limit `primitives` is passed.
    pub fn triangle(&mut self, positions: [DVec3; 3], normals: Option<[DVec3; 3]>) -> Result<(), SceneError> {
        for p in positions {
            finite("a corner of the triangle", p)?;
        }
        for n in normals.into_iter().flatten() {
            if finite("a normal of the triangle", n)? == DVec3::ZERO {
                return Err(SceneError::new("a normal of the triangle is zero"));
            }
        }
        let id = TriangleId(self.scene.triangles.len() as u32);
        self.scene.triangles.push(Triangle { positions, normals });
        self.add(Geometry::Triangle(id), 1)
    }

    /// A mesh. The same `Arc` twice shares its memory and its acceleration structure.
    ///
    /// # Errors
    /// Where the limit `primitives` is passed.
    pub fn mesh(&mut self, mesh: &Arc<Mesh>) -> Result<(), SceneError> {
        let known = self.scene.meshes.iter().position(|m| Arc::ptr_eq(m, mesh));
        let index = known.unwrap_or_else(|| {
            self.scene.meshes.push(Arc::clone(mesh));
            self.scene.meshes.len() - 1
        });
        self.add(
            Geometry::Mesh(MeshId(index as u32)),
            if known.is_some() { 1 } else { mesh.triangles.len() },
        )
    }

    // ---- Lights ----

    /// Fall-off of the point and area lights made from now on.
    ///
    /// # Errors
    /// Where a term is negative or not finite, or all are 0.
    pub fn attenuation(&mut self, attenuation: Attenuation) -> Result<(), SceneError> {
        let Attenuation {
            constant,
            linear,
            quadratic,
        } = attenuation;
        let terms = [constant, linear, quadratic];
        if terms.iter().any(|t| !t.is_finite() || *t < 0.0) || terms == [0.0; 3] {
            return Err(SceneError::new(format!(
                "the attenuation's terms must be 0 or greater and not all 0, not {constant}, {linear}, {quadratic}"
            ))
            .hint("attenuation(1, 0, 0) is the default: no fall-off"));
        }
        self.attenuation = attenuation;
        Ok(())
    }

    /// A point light under the current matrix.
    ///
    /// # Errors
    /// Where a number is not finite, or the limit `lights` is passed.
    pub fn point(&mut self, position: DVec3, color: Color) -> Result<(), SceneError> {
        let position = finite("the light's position", position)?;
        self.push_light(
            LightKind::Point {
                position,
                attenuation: self.attenuation,
            },
            color,
        )
    }

    /// A directional light; `direction` points towards the light and is turned by the current matrix.
    ///
    /// # Errors
    /// Where the direction is zero, a number is not finite, or the limit `lights` is passed.
    pub fn directional(&mut self, direction: DVec3, color: Color) -> Result<(), SceneError> {
        let direction = finite("the light's direction", direction)?;
        self.push_light(LightKind::Directional { direction }, color)
    }

    /// A parallelogram of `n` x `n` jittered point lights; `color` is the total.
    ///
    /// # Errors
    /// Where `n` is not in 1..=256, a number is not finite, or the limit `lights` is passed.
    pub fn area_light(
        &mut self,
        corner: DVec3,
        edge1: DVec3,
        edge2: DVec3,
        color: Color,
        n: u32,
    ) -> Result<(), SceneError> {
        if !(1..=256).contains(&n) {
            return Err(SceneError::new(format!(
                "an area light has a grid of 1 to 256 points along each edge, not {n}"
            ))
            .hint("areaLight(corner, edge1, edge2, color, 4) takes 16 points"));
        }
        for v in [corner, edge1, edge2] {
            finite("the area light's corner and edges", v)?;
        }
        self.push_light(
            LightKind::Area {
                corner,
                edge1,
                edge2,
                n,
                attenuation: self.attenuation,
            },
            color,
        )
    }

    fn push_light(&mut self, kind: LightKind, color: Color) -> Result<(), SceneError> {
        finite("the light's color", color)?;
        if self.lights >= self.limits.lights {
            return Err(SceneError::limit("too many lights", "lights", self.limits.lights));
        }
        let m = &self.ctm;
        let kind = match kind {
            LightKind::Point {
                position,
                attenuation,
            } => LightKind::Point {
                position: m.transform_point3(position),
                attenuation,
            },
            LightKind::Directional { direction } => {
                let turned = m.transform_vector3(direction);
                let length = turned.length();
                if !(length > 0.0) {
                    return Err(SceneError::new("the light's direction is zero")
                        .hint("directional(direction, color): the direction points towards the light"));
                }
                LightKind::Directional {
                    direction: turned / length,
                }
            }
            LightKind::Area {
                corner,
                edge1,
                edge2,
                n,
                attenuation,
            } => LightKind::Area {
                corner: m.transform_point3(corner),
                edge1: m.transform_vector3(edge1),
                edge2: m.transform_vector3(edge2),
                n,
                attenuation,
            },
        };
        self.lights += 1;
        self.group.lights.push(Light {
            kind,
            color,
            loc: self.loc,
        });
        Ok(())
    }

    // ---- The end ----

    /// The scene as it stands; the builder goes on. Used by `render()` in the middle of a script.
    #[must_use]
    pub fn snapshot(&mut self) -> Scene {
        let root = ROOT_GROUP.index();
        std::mem::swap(&mut self.scene.groups[root], &mut self.group);
        let scene = self.scene.clone();
        std::mem::swap(&mut self.scene.groups[root], &mut self.group);
        scene
    }

    /// Warnings so far, handed over.
    pub fn take_warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.warnings)
    }

    /// The complete scene, with warnings for what looks wrong: a push never popped, nothing to see, no light.
    #[must_use]
    pub fn finish(mut self) -> Report<Scene> {
        self.warn_unpopped(0);
        self.scene.groups[ROOT_GROUP.index()] = self.group;
        let mut warnings = self.warnings;
        warnings.extend(super::validate::warnings(&self.scene));
        Report {
            value: self.scene,
            warnings,
        }
    }

    fn warn_unpopped(&mut self, from: usize) {
        let unpopped: Vec<SourceLoc> = self.stack.iter().skip(from).map(|(_, loc)| *loc).collect();
        for loc in unpopped {
            self.warn_at(
                "pushTransform is never popped",
                Some("add popTransform(), or use group { }"),
                loc,
            );
        }
    }

    fn require_invertible(&self, what: &str) -> Result<(), SceneError> {
        if math::is_singular(&self.ctm.matrix3) {
            return Err(SceneError::new(format!(
                "{what} cannot be placed under a singular matrix: it is flattened to nothing"
            ))
            .hint("is a component of scale(...) 0?"));
        }
        Ok(())
    }

    fn add(&mut self, geometry: Geometry, primitives: usize) -> Result<(), SceneError> {
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
        let transform = self.transform_id();
        self.group.objects.push(Object {
            geometry,
            transform,
            material,
            loc: self.loc,
        });
        Ok(())
    }

    fn transform_id(&mut self) -> TransformId {
        let transforms = &mut self.scene.transforms;
        if self.ctm == DAffine3::IDENTITY {
            return TransformId::IDENTITY;
        }
        if transforms.last() != Some(&self.ctm) {
            transforms.push(self.ctm);
        }
        TransformId(transforms.len() as u32 - 1)
    }
}

fn finite(what: &str, v: DVec3) -> Result<DVec3, SceneError> {
    if v.is_finite() && max_abs(v) <= 1e15 {
        return Ok(v);
    }
    Err(SceneError::new(format!(
        "{what} must be finite numbers within 1e15, not [{}, {}, {}]",
        v.x, v.y, v.z
    )))
}
