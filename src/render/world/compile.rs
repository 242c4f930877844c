//! From a [`Scene`] to a [`World`].

mod bounds;
mod transparency;

use std::{borrow::Cow, collections::HashMap};

use rayon::prelude::*;

use super::{
    super::{
        around::Around,
        inspect::{called, placed},
        interrupt::Interrupt,
        lighting::Lamp,
    },
    World,
    csg::Solid,
    fields,
    kept::{KeptTrees, Key},
    level::{Instance, Level, PlacedShape, PlacedSphere, Rare, TriangleRun, TriangleSource},
    placing::{normal_matrix, place, similarity},
    tree,
};
use crate::{
    accel::{Box32, Bvh, Kinds},
    diag::{Diagnostic, Error, ErrorKind},
    host::{Host, NoHost},
    math::{DAffine3, is_singular},
    scene::{Geometry, Group, GroupId, Material, Mesh, MeshId, Object, ROOT_GROUP, Scene, Shutter},
    shape::Shape,
};
use bounds::union;

/// Levels inside levels. Each takes a search's frames of the tracing thread's stack, which without optimisation are
/// 42 kB with the plainest instructions: so many need less than 1.5 MiB with all that calls them, and a thread that
/// nobody has asked more for has 2.
const MAX_NESTING: usize = 32;
/// Primitive numbers stay below this, so that sums of two never overflow.
const MAX_NUMBERS: u64 = 1 << 62;
/// Most triangles that may be cut in two, for each that there is. On architecture a twentieth brings rays all that a tenth
/// does, and takes less memory and time; on scans nothing is worth a cut.
const CUTS: f64 = 0.05;
/// Least number of primitives that is worth another thread.
const PIECE: usize = 1024;
/// Corners that are copied between two looks at the interrupt.
const COPIED: usize = 1 << 16;

impl<'s> World<'s> {
    /// Compiles a scene: each group that is seen once, its tree built on the threads of the current pool.
    ///
    /// # Errors
    /// `Limit` where instances are nested too deep or multiply to more than 2^62 primitives.
    pub fn compile(scene: &'s Scene) -> Result<Self, Error> {
        Self::compile_for(scene, &NoHost)
    }

    /// As [`World::compile`], and asks the host every few milliseconds whether to stop.
    ///
    /// # Errors
    /// As [`World::compile`]; `Cancelled` where the host asks to stop.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, NoHost, render::World};
    /// let mut b = Builder::new();
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// let scene = b.finish().value;
    /// // `NoHost` never asks to stop; the host of a program may, where the scene takes long.
    /// assert_eq!(World::compile_for(&scene, &NoHost)?.primitives(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn compile_for(scene: &'s Scene, host: &dyn Host) -> Result<Self, Error> {
        Self::compile_keeping(scene, None, &Interrupt::new(host))
    }

    /// As [`World::compile_for`], with the trees that are there already. Give the world back to have them kept.
    pub(in crate::render) fn compile_keeping(
        scene: &'s Scene,
        trees: Option<&KeptTrees>,
        interrupt: &Interrupt<'_>,
    ) -> Result<Self, Error> {
        Self::compile_with(scene, CUTS, trees, interrupt)
    }

    /// As [`World::compile`], with trees in which no triangle is cut in two: for the benchmark that sets the builder
    /// beside one that cuts none either.
    ///
    /// # Errors
    /// As [`World::compile`].
    #[doc(hidden)]
    pub fn compile_uncut(scene: &'s Scene) -> Result<Self, Error> {
        Self::compile_with(scene, 0.0, None, &Interrupt::new(&NoHost))
    }

    /// Compiles with at most `cuts` cuts for each triangle, which changes no result, and with the trees that are there
    /// already.
    pub(super) fn compile_with(
        scene: &'s Scene,
        cuts: f64,
        trees: Option<&KeptTrees>,
        interrupt: &Interrupt<'_>,
    ) -> Result<Self, Error> {
        let mut compiler = Compiler {
            scene,
            levels: Vec::new(),
            depths: Vec::new(),
            of_group: HashMap::new(),
            of_mesh: HashMap::new(),
            mesh_uses: mesh_uses(scene),
            cuts,
            trees,
            keys: Vec::new(),
            interrupt,
        };
        let compiled = compiler
            .groups()
            .and_then(|()| fields::prepare(&mut compiler.levels, &scene.settings, interrupt));
        let shutter = scene.camera.shutter;
        let moving = |level: &Level<'_>| matches!(level.rare, Some(Rare::Moving(motion)) if motion.moves());
        let world = World {
            scene,
            moves: shutter.open < shutter.close && compiler.levels.iter().any(moving),
            time: shutter.time(0.5),
            levels: compiler.levels.into(),
            keys: compiler.keys,
            fields: *compiled.as_ref().unwrap_or(&0),
            packets: true,
            interrupt: None,
            lamps: Lamp::of_all(scene).into(),
            around: Around::new(scene),
            is_linked: scene.root().lights.iter().any(|light| !light.links.is_all()),
            shadows_dim: scene.materials.iter().all(Material::only_dims),
            uv_everywhere: false,
            needs_width: scene.textures.iter().any(|texture| texture.asks_for_width()),
            needs_footprint: scene.textures.iter().any(|texture| texture.asks_for_footprint()),
        };
        match (compiled, trees) {
            (Ok(_), _) => Ok(world),
            (Err(e), None) => Err(e),
            (Err(e), Some(trees)) => {
                trees.take_back(world);
                Err(e)
            }
        }
    }
}

/// How often each mesh is placed.
fn mesh_uses(scene: &Scene) -> Vec<u32> {
    let mut uses = vec![0; scene.meshes.len()];
    for object in scene.groups.iter().flat_map(|group| &group.objects) {
        if let Geometry::Mesh(id) = object.geometry {
            uses[id.index()] += 1;
        }
    }
    uses
}

struct Compiler<'s, 'k> {
    scene: &'s Scene,
    levels: Vec<Level<'s>>,
    /// Nesting below each level.
    depths: Vec<usize>,
    of_group: HashMap<GroupId, u32>,
    of_mesh: HashMap<MeshId, u32>,
    mesh_uses: Vec<u32>,
    /// Most triangles that may be cut in two, for each that there is.
    cuts: f64,
    /// Trees of earlier compilations, if those are kept, and what the trees of this one are made from.
    trees: Option<&'k KeptTrees>,
    keys: Vec<Key>,
    interrupt: &'k Interrupt<'k>,
}

impl<'s> Compiler<'s, '_> {
    /// Compiles all groups that are seen.
    fn groups(&mut self) -> Result<(), Error> {
        for id in groups_inside_out(self.scene) {
            let level = self.group(id)?;
            self.of_group.insert(id, level);
        }
        Ok(())
    }

    fn go_on(&self) -> Result<(), Error> {
        match self.interrupt.poll() {
            true => Err(self.interrupt.reason().into()),
            false => Ok(()),
        }
    }

    /// Compiles one group whose inner groups are compiled.
    fn group(&mut self, id: GroupId) -> Result<u32, Error> {
        let scene = self.scene;
        let group = &scene.groups[id.index()];
        let mut level = Level {
            group: Some(id),
            // The root is where rays begin: things stand side by side in it.
            rare: rare(group).filter(|_| id != ROOT_GROUP),
            ..Level::default()
        };
        self.reserve(&mut level, &group.objects);
        let mut depth = 0;
        for (index, object) in group.objects.iter().enumerate() {
            if index.is_multiple_of(PIECE) {
                self.go_on()?;
            }
            let index = index as u32;
            let placing = scene.world_from_object(object);
            match &object.geometry {
                Geometry::Triangle(id) => {
                    let triangle = &scene.triangles[id.index()];
                    let first = level.vertices.len() as u32;
                    level
                        .runs
                        .push(run(&level, index, TriangleSource::Single(*id), &placing));
                    level
                        .vertices
                        .to_mut()
                        .extend(triangle.positions.map(|p| place(&placing, p)));
                    level.triangles.to_mut().push([first, first + 1, first + 2]);
                }
                // A flattened mesh has no space of its own that a ray could be taken to.
                Geometry::Mesh(id) if self.mesh_uses[id.index()] == 1 || is_singular(&placing.matrix3) => {
                    level
                        .runs
                        .push(run(&level, index, TriangleSource::Mesh(*id), &placing));
                    self.append_mesh(&mut level, &scene.meshes[id.index()], &placing)?;
                }
                Geometry::Mesh(id) => {
                    let inner = self.mesh(*id)?;
                    depth = depth.max(1 + self.depths[inner as usize]);
                    level.instances.push(instance(inner, index, &placing));
                }
                Geometry::Instance(id) => {
                    let Some(&inner) = self.of_group.get(id) else {
                        continue;
                    };
                    depth = depth.max(1 + self.depths[inner as usize]);
                    level.instances.push(instance(inner, index, &placing));
                }
                Geometry::Shape(shape) => push_shape(&mut level, shape, index, &placing),
                Geometry::Csg(id, _) | Geometry::Moving(id) => {
                    let Some(&inner) = self.of_group.get(id) else {
                        continue;
                    };
                    depth = depth.max(1 + self.depths[inner as usize]);
                    level.instances.push(instance(inner, index, &placing));
                }
            }
        }
        match depth > MAX_NESTING {
            true => Err(self.nested_too_deep(&level, group)),
            false => self.finish(level, depth),
        }
    }

    /// What is said of the first object of a group whose levels are too many.
    #[cold]
    fn nested_too_deep(&self, level: &Level<'_>, group: &Group) -> Error {
        let is_too_deep = |instance: &&Instance| {
            let below = self.depths.get(instance.level as usize);
            below.is_some_and(|below| *below >= MAX_NESTING)
        };
        let deepest = level.instances.iter().find(is_too_deep);
        let object = deepest.and_then(|instance| group.objects.get(instance.object as usize));
        let what = object.map_or("this".to_owned(), |object| called(self.scene, object));
        let message = format!(
            "instances and solids are nested more than {MAX_NESTING} levels deep: {what} is one level too many"
        );
        let d = Diagnostic::error(ErrorKind::Limit, message).hint(
            "a function that makes the shapes nests nothing: call it where instance() stands, or put more into each level",
        );
        match object {
            Some(object) => placed(self.scene, d, object.loc),
            None => d,
        }
        .into()
    }

    /// Makes room for what the objects will need, so that nothing grows by doubling.
    fn reserve(&self, level: &mut Level<'s>, objects: &[Object]) {
        let (mut vertices, mut triangles, mut spheres) = (0, 0, 0);
        for object in objects {
            match &object.geometry {
                Geometry::Triangle(_) => {
                    vertices += 3;
                    triangles += 1;
                }
                Geometry::Mesh(id) if self.mesh_uses[id.index()] == 1 => {
                    vertices += self.scene.meshes[id.index()].positions.len();
                    triangles += self.scene.meshes[id.index()].triangles.len();
                }
                Geometry::Shape(Shape::Sphere(_)) => spheres += 1,
                _ => {}
            }
        }
        level.vertices.to_mut().reserve_exact(vertices);
        level.triangles.to_mut().reserve_exact(triangles);
        level.spheres.reserve_exact(spheres);
    }

    fn append_mesh(&self, level: &mut Level<'s>, mesh: &'s Mesh, placing: &DAffine3) -> Result<(), Error> {
        // Nothing came before, and no room was made for anything that is to come.
        let is_all = level.vertices.is_empty() && level.vertices.to_mut().capacity() <= mesh.positions.len();
        if is_all && *placing == DAffine3::IDENTITY {
            level.vertices = Cow::Borrowed(&mesh.positions);
            level.triangles = Cow::Borrowed(&mesh.triangles);
            return Ok(());
        }
        let first = level.vertices.len() as u32;
        let vertices = level.vertices.to_mut();
        for piece in mesh.positions.chunks(COPIED) {
            vertices.extend(piece.iter().map(|p| place(placing, *p)));
            self.go_on()?;
        }
        let triangles = level.triangles.to_mut();
        for piece in mesh.triangles.chunks(COPIED) {
            triangles.extend(piece.iter().map(|t| t.map(|i| i + first)));
            self.go_on()?;
        }
        Ok(())
    }

    /// The level of a mesh that is placed several times.
    fn mesh(&mut self, id: MeshId) -> Result<u32, Error> {
        if let Some(&level) = self.of_mesh.get(&id) {
            return Ok(level);
        }
        let mut level = Level::default();
        level.runs.push(run(
            &level,
            Level::NO_OBJECT,
            TriangleSource::Mesh(id),
            &DAffine3::IDENTITY,
        ));
        self.append_mesh(&mut level, &self.scene.meshes[id.index()], &DAffine3::IDENTITY)?;
        let level = self.finish(level, 0)?;
        self.of_mesh.insert(id, level);
        Ok(level)
    }

    /// Numbers the level's primitives and builds its tree.
    fn finish(&mut self, mut level: Level<'s>, depth: usize) -> Result<u32, Error> {
        let mut numbers = (level.primitives() - level.instances.len()) as u64;
        for instance in &mut level.instances {
            instance.first_number = numbers;
            numbers = numbers.saturating_add(self.levels[instance.level as usize].numbers);
        }
        if numbers > MAX_NUMBERS {
            return Err(limit(
                "instances inside instances multiply to more than 2^62 shapes".to_owned(),
            ));
        }
        level.numbers = numbers;
        level.transparent = self.transparency(&level);

        let kinds = Kinds {
            triangles: level.triangles.len(),
            spheres: level.spheres.len(),
        };
        // Room for what cuts add, so that nothing is moved for it.
        let mut primitives = Vec::with_capacity(Bvh::room(level.primitives(), kinds, self.cuts));
        primitives.par_extend(
            (0..level.primitives() as u32)
                .into_par_iter()
                .with_min_len(PIECE)
                .map(|index| self.boxed(&level, index)),
        );
        let (blocks, others) = primitives.split_at(kinds.triangles + kinds.spheres);
        let around = union(blocks);
        level.extent = f64::from(around.extent());
        let extents = level
            .cuboids()
            .map(|(index, ..)| primitives[index as usize].bounds().extent());
        level.cuboid_extent = extents.fold(0.0, f32::max);
        let around = around.union(&union(others));
        level.bounds = around.extent().is_finite().then(|| around.to_bounds());
        let has_end = level.bounds.is_some();
        match level.rare {
            None => {}
            Some(Rare::Solid(solid)) => level.bounds = solid.bounds(&self.parts(&level, solid.parts)),
            Some(Rare::Moving(motion)) => {
                let Shutter { open, close } = self.scene.camera.shutter;
                level.bounds = level.bounds.map(|bounds| motion.swept(&bounds, open, close));
            }
        }
        if !has_end {
            let everywhere = |index: &u32| primitives[*index as usize].bounds() == Box32::EVERYTHING;
            level.unbounded = (0..primitives.len() as u32).filter(everywhere).collect();
            primitives.retain(|primitive| primitive.bounds() != Box32::EVERYTHING);
        }
        level.has_opaque_tree = level.transparent.is_empty()
            || !level.instances.is_empty()
            || (0..level.primitives() as u32).any(|index| {
                !level.may_be_transparent(index) && level.unbounded.binary_search(&index).is_err()
            });
        self.go_on()?;
        let kept = self.trees.map(|trees| (trees, Key::of(&level, &primitives)));
        if !kept.is_some_and(|(trees, key)| trees.lend(&key, &mut level)) {
            tree::build(&mut level, primitives, kinds, self.cuts, self.interrupt);
        }
        self.go_on()?;
        self.keys.extend(kept.map(|(_, key)| key));
        self.levels.push(level);
        self.depths.push(depth);
        Ok(self.levels.len() as u32 - 1)
    }
}

/// The groups that are seen: those the root places, directly or not, inner ones first, and last the root.
fn groups_inside_out(scene: &Scene) -> Vec<GroupId> {
    let mut seen = vec![false; scene.groups.len()];
    let mut open = vec![ROOT_GROUP];
    let mut found = Vec::new();
    while let Some(group) = open.pop() {
        for object in &scene.groups[group.index()].objects {
            if let Some(inner) = object.geometry.group()
                && !seen[inner.index()]
            {
                seen[inner.index()] = true;
                found.push(inner);
                open.push(inner);
            }
        }
    }
    // A group can only place groups that were defined before it.
    found.sort_unstable();
    found.push(ROOT_GROUP);
    found
}

/// What the level of a group is more than things that stand side by side.
fn rare(group: &Group) -> Option<Rare> {
    let solid = |op| Solid {
        op,
        parts: group.objects.len() as u32,
    };
    let solid = group.csg.map(solid).map(Rare::Solid);
    solid.or(group.motion.map(Rare::Moving))
}

fn limit(message: String) -> Error {
    Diagnostic::error(ErrorKind::Limit, message)
        .hint("define fewer levels of groups inside groups")
        .into()
}

fn run(level: &Level, object: u32, source: TriangleSource, placing: &DAffine3) -> TriangleRun {
    let mirrored = placing.matrix3.determinant() < 0.0;
    let moved_mesh = matches!(source, TriangleSource::Mesh(_)) && *placing != DAffine3::IDENTITY;
    TriangleRun {
        first: level.triangles.len() as u32,
        object,
        source,
        mirrored,
        normal_matrix: moved_mesh.then(|| Box::new(normal_matrix(placing))),
    }
}

fn instance(level: u32, object: u32, placing: &DAffine3) -> Instance {
    Instance {
        level,
        object,
        inner_from_outer: placing.inverse(),
        first_number: 0,
    }
}

fn push_shape(level: &mut Level, shape: &Shape, object: u32, placing: &DAffine3) {
    if let (Shape::Sphere(sphere), Some(scale)) = (shape, similarity(&placing.matrix3)) {
        let center = place(placing, sphere.center());
        level.spheres.push(PlacedSphere {
            center,
            radius: sphere.radius() * scale,
            object,
        });
        return;
    }
    level.shapes.push(PlacedShape {
        shape: shape.clone(),
        object_from_level: placing.inverse(),
        object,
    });
}
