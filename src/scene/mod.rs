//! The description of a picture: plain data, complete, validated, printable.
//!
//! A [`Scene`] is what a [`Builder`] leaves behind. Every default is resolved in it, every handle is an index
//! into one of its vectors, and every entity knows the line that made it. It never sees Rhai, the command line
//! or the file system, and it holds no acceleration structure: [`render`](mod@crate::render) compiles it for that.

mod animated;
mod bounds;
mod builder;
mod camera;
mod color_map;
pub mod compare;
mod composed;
mod csg;
mod custom;
mod dispersion;
mod dump;
mod edition;
mod error;
mod extract;
mod finish;
mod finish_text;
mod hash;
mod light;
pub(crate) mod literal;
mod mapped;
mod material;
mod mesh;
mod pattern;
mod placement;
mod pyramid;
mod settings;
mod source;
mod surroundings;
mod texture;
mod texture_text;
mod told;
mod validate;

pub use crate::custom::Custom;
pub use animated::AnimatedTransform;
pub use builder::{Builder, GroupMark};
pub use camera::{Camera, CameraFrame, Eye, Focus, Lens, Motion, Projection, Shutter, Stereo, StereoLayout};
pub use color_map::{ColorMap, Interpolation, Paint};
pub use composed::{MixTexture, PlacedTexture};
pub use csg::CsgOp;
pub use custom::{CustomReflectance, CustomTexture, ShadingPoint};
pub(crate) use dispersion::D_LINE;
pub use dispersion::Dispersion;
pub use edition::Edition;
pub use error::SceneError;
pub(crate) use finish::mean as finish_mean;
pub use finish::{Absorption, Bump, ClearCoat, Conductor, Finish, NormalMap};
pub(crate) use finish_text::number_text;
pub(crate) use light::around;
pub use light::{
    Attenuation, Falloff, Light, LightForm, LightKind, LightMesh, Links, Projector, Spot, Sun, SurfaceLight,
};
pub use mapped::{Laying, MappedImage, Mapping, TextureFilter, Wrap};
pub use material::{Material, Term};
pub use mesh::{Attribute, Mesh};
pub use pattern::{Pattern, PatternKind, PatternTexture, Wave};
pub use placement::Placement;
pub use pyramid::Pyramid;
pub use settings::{Adaptive, Crop, Encoding, Filter, FilterKind, Region, Sampling, Settings};
pub use source::AssetFiles;
pub(crate) use source::{MeshFile, write as write_source};
pub use surroundings::{Environment, Fog, Haze, Occlusion, Sky, Surroundings};
pub use texture::{Footprint, ImageTexture, Texels, Texture, TexturePoint};
pub(crate) use told::Told;

use std::{collections::BTreeMap, sync::Arc};

use crate::{
    diag::SourceLoc,
    math::{DAffine3, DVec3},
    shape::Shape,
};

macro_rules! handle {
    ($($(#[$doc:meta])* $name:ident)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
            pub struct $name(pub u32);

            impl $name {
                /// The index as `usize`.
                #[must_use]
                pub const fn index(self) -> usize {
                    self.0 as usize
                }
            }
        )*
    };
}

handle! {
    /// Index into [`Scene::materials`].
    MaterialId
    /// Index into [`Scene::transforms`].
    TransformId
    /// Index into [`Scene::textures`].
    TextureId
    /// Index into [`Scene::meshes`].
    MeshId
    /// Index into [`Scene::triangles`].
    TriangleId
    /// Index into [`Scene::groups`].
    GroupId
}

impl MaterialId {
    /// In [`Mesh::face_materials`]: the face looks as the object that places the mesh.
    pub const INHERIT: Self = Self(u32::MAX);
}

impl TransformId {
    /// The identity, always the first transform of a scene.
    pub const IDENTITY: Self = Self(0);
}

/// The group that is seen: the first of [`Scene::groups`].
pub const ROOT_GROUP: GroupId = GroupId(0);

/// What an [`Object`] is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A shape of its own object space.
    Shape(Shape),
    /// A single triangle.
    Triangle(TriangleId),
    /// A mesh.
    Mesh(MeshId),
    /// Another placing of a defined group.
    Instance(GroupId),
    /// The solid that a group with [`Group::csg`] is, in the place where it was made.
    Csg(GroupId, CsgOp),
    /// What a group with [`Group::motion`] holds, as it moves from the place where it was made.
    Moving(GroupId),
}

impl Geometry {
    /// What the script calls it: `sphere`, `tri`, `mesh`, `instance`, `difference`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Shape(shape) => shape.name(),
            Self::Triangle(_) => "tri",
            Self::Mesh(_) => "mesh",
            Self::Instance(_) => "instance",
            Self::Csg(_, op) => op.name(),
            Self::Moving(_) => "moving",
        }
    }

    /// The group that stands in its place: of an instance, of a solid that is put together, of what moves together.
    #[must_use]
    pub const fn group(&self) -> Option<GroupId> {
        match self {
            Self::Instance(id) | Self::Csg(id, _) | Self::Moving(id) => Some(*id),
            Self::Shape(_) | Self::Triangle(_) | Self::Mesh(_) => None,
        }
    }
}

/// One placed thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// What it is.
    pub geometry: Geometry,
    /// Where it is: world (or group) from object.
    pub transform: TransformId,
    /// How it looks. An instance, what is put together and what moves together ignore it: their groups' objects have
    /// their own.
    pub material: MaterialId,
    /// The call that made it.
    pub loc: SourceLoc,
}

/// A single triangle with its corners and, where it is smooth, its vertex normals, in object space.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::Triangle};
/// let mut b = Builder::new();
/// b.triangle([DVec3::ZERO, DVec3::X, DVec3::Y], None)?;
/// let scene = b.finish().value;
/// let [Triangle { positions, normals }] = &scene.triangles[..] else { panic!("one triangle") };
/// assert!(positions[1] == DVec3::X && normals.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Triangle {
    /// Corners; counter-clockwise is the front.
    pub positions: [DVec3; 3],
    /// Vertex normals, not necessarily unit vectors.
    pub normals: Option<[DVec3; 3]>,
}

/// Objects in one space: the root, what `define` named, the parts of one solid, or what moves together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// The name given by `define`; empty for the root, `difference` and so on for the parts of a solid, `moving` for what
    /// moves together.
    pub name: String,
    /// Objects in the order they were made.
    pub objects: Vec<Object>,
    /// Lights in the order they were made, in this group's space. Placing an instance copies them.
    pub lights: Vec<Light>,
    /// The block that made it.
    pub loc: SourceLoc,
    /// How its objects make one solid; `None` where they stand side by side.
    pub csg: Option<CsgOp>,
    /// How it moves while light is gathered, before the matrix of what stands for it; `None` where it stands still.
    pub motion: Option<AnimatedTransform>,
}

impl Group {
    /// Whether it was made in the place where it is seen, by a block without a name: parts of a solid, what moves.
    #[must_use]
    pub(crate) const fn is_in_place(&self) -> bool {
        self.csg.is_some() || self.motion.is_some()
    }
}

/// A complete picture description.
///
/// ```
/// use rtscript::{Builder, DVec3, scene::{Geometry, Group, Object}};
/// let mut b = Builder::new();
/// b.translate(DVec3::X)?;
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let scene = b.finish().value;
/// let root: &Group = scene.root();
/// let ball: &Object = &root.objects[0];
/// assert!(matches!(ball.geometry, Geometry::Shape(_)));
/// assert_eq!(scene.world_from_object(ball).translation, DVec3::X);
/// assert_eq!(scene.holds()[0], ("objects", 1));
/// println!("{}", scene.dump());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    /// Edition, size, samples, depth, background, encoding, seed.
    pub settings: Settings,
    /// The camera.
    pub camera: Camera,
    /// All groups; the first is the root, and an instance's group comes before the group that holds it.
    pub groups: Vec<Group>,
    /// All distinct materials.
    pub materials: Vec<Material>,
    /// All transforms; the first is the identity.
    pub transforms: Vec<DAffine3>,
    /// All textures.
    pub textures: Vec<Arc<Texture>>,
    /// All meshes.
    pub meshes: Vec<Arc<Mesh>>,
    /// All single triangles.
    pub triangles: Vec<Triangle>,
    /// Names of the files that [`SourceLoc::file`] counts.
    pub files: Vec<String>,
    /// Names given by `define`.
    pub names: BTreeMap<String, GroupId>,
}

impl Scene {
    /// The group that is seen.
    ///
    /// # Panics
    /// Where a program took it out of [`Scene::groups`]: every scene is made with it.
    #[must_use]
    #[allow(clippy::indexing_slicing, reason = "every scene is made with its root")]
    pub fn root(&self) -> &Group {
        &self.groups[ROOT_GROUP.index()]
    }

    /// What there is in it, with how many: all groups together, instances not counted out. What there is none of is
    /// left out.
    #[must_use]
    pub fn holds(&self) -> Vec<(&'static str, u64)> {
        let objects = || self.groups.iter().flat_map(|group| &group.objects);
        let instances = objects().filter(|object| matches!(object.geometry, Geometry::Instance(_)));
        let solids = self.groups.iter().filter(|group| group.csg.is_some()).count();
        let moving = self.groups.iter().filter(|group| group.motion.is_some()).count();
        let faces: usize = self.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let lists = [
            ("objects", objects().count()),
            ("instances", instances.count()),
            ("groups", self.groups.len() - 1 - solids - moving),
            ("joined solids", solids),
            ("moving groups", moving),
            ("triangles", faces + self.triangles.len()),
            ("lights", self.groups.iter().map(|group| group.lights.len()).sum()),
            ("materials", self.materials.len()),
            ("textures", self.textures.len()),
        ];
        let held = lists.into_iter().filter(|(_, count)| *count > 0);
        held.map(|(what, count)| (what, count as u64)).collect()
    }

    /// World (or group) from object of an object.
    ///
    /// # Panics
    /// Where the object is not one of this scene.
    #[must_use]
    #[allow(
        clippy::indexing_slicing,
        reason = "the builder gives out handles of what is there"
    )]
    pub fn world_from_object(&self, object: &Object) -> DAffine3 {
        self.transforms[object.transform.index()]
    }
}

const _: fn() = || {
    fn is_send_sync<T: Send + Sync>() {}
    is_send_sync::<Scene>();
};

// Scenes have millions of objects: one with a matrix of its own takes at most this many bytes.
const _: () = assert!(size_of::<Object>() + size_of::<DAffine3>() <= 152);
