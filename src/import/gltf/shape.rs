//! The triangles of a file's meshes, where its nodes place them.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::{
    super::{
        assets::Assets,
        guard::{Checked, Corner, Face},
        text::counted,
    },
    MATERIAL,
    accessor::{Accessor, Shape, accessor},
    bytes::Buffers,
    item::Item,
    uv::Layer,
};
use crate::{
    color::Color,
    diag::{Diagnostic, ErrorKind},
    math::{DAffine3, DVec2, DVec3},
    scene::{Builder, SceneError},
};

const POSITIONS: Shape = Shape {
    kinds: &[("VEC3", 3)],
    is_index: false,
};
const UVS: Shape = Shape {
    kinds: &[("VEC2", 2)],
    is_index: false,
};
/// A fourth number, how solid the vertex is, is not used.
const COLORS: Shape = Shape {
    kinds: &[("VEC3", 3), ("VEC4", 4)],
    is_index: false,
};
const INDICES: Shape = Shape {
    kinds: &[("SCALAR", 1)],
    is_index: true,
};

/// The largest number of a vertex's color: the format says 1 for shares, and floats may be more.
const BRIGHTEST: f64 = 1e6;
/// Triangles between two questions whether to stop.
const TRIANGLES_PER_QUESTION: usize = 4096;

/// Where a mesh stands.
pub(super) struct Place {
    world: DAffine3,
    /// What turns normals, but for their length.
    normals: [DVec3; 3],
    /// Whether it is mirrored, so that triangles run the other way round.
    is_mirrored: bool,
}

impl Place {
    pub(super) fn new(world: DAffine3) -> Self {
        let m = world.matrix3;
        let [x, y, z] = [
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        ];
        let is_mirrored = m.x_axis.dot(x) < 0.0;
        let sign = if is_mirrored { -1.0 } else { 1.0 };
        Self {
            world,
            normals: [x * sign, y * sign, z * sign],
            is_mirrored,
        }
    }

    fn normal(&self, n: DVec3) -> DVec3 {
        let [x, y, z] = self.normals;
        x * n.x + y * n.y + z * n.z
    }
}

/// How the vertices of a primitive make triangles.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

impl Mode {
    /// Triangles of so many vertices.
    fn triangles(self, vertices: usize) -> usize {
        match self {
            Self::Triangles => vertices / 3,
            Self::Strip | Self::Fan => vertices.saturating_sub(2),
        }
    }

    /// The vertices of triangle `i`.
    fn corners(self, i: usize) -> [usize; 3] {
        match self {
            Self::Triangles => [3 * i, 3 * i + 1, 3 * i + 2],
            Self::Strip if i.is_multiple_of(2) => [i, i + 1, i + 2],
            Self::Strip => [i, i + 2, i + 1],
            Self::Fan => [0, i + 1, i + 2],
        }
    }
}

/// Triangles in the making.
pub(super) struct Triangles<'a, 's, 'h> {
    pub(super) checked: Checked<'a>,
    /// The file's materials that are used, in the order of their first use.
    pub(super) materials: Vec<usize>,
    /// Those of them that a primitive with colors has.
    pub(super) colored: BTreeSet<usize>,
    slots: BTreeMap<usize, u32>,
    with_materials: bool,
    buffers: &'s Buffers<'a>,
    pub(super) assets: &'s mut Assets<'h>,
    triangles: usize,
    warned: BTreeSet<&'static str>,
}

impl<'a, 's, 'h> Triangles<'a, 's, 'h> {
    pub(super) fn new(buffers: &'s Buffers<'a>, with_materials: bool, assets: &'s mut Assets<'h>) -> Self {
        Self {
            checked: Checked::default(),
            materials: Vec::new(),
            colored: BTreeSet::new(),
            slots: BTreeMap::new(),
            with_materials,
            buffers,
            assets,
            triangles: 0,
            warned: BTreeSet::new(),
        }
    }

    /// True the first time that it is asked for `what`: one warning is enough.
    pub(super) fn is_first_of(&mut self, what: &'static str) -> bool {
        self.warned.insert(what)
    }

    /// Adds the primitives of a mesh, `weights` being those of the node for its morph targets.
    pub(super) fn add_mesh(
        &mut self,
        root: &Item<'_, 'a>,
        mesh: &Item<'_, 'a>,
        weights: Option<&Item<'_, 'a>>,
        place: &Place,
        builder: &mut Builder,
    ) -> Result<(), Diagnostic> {
        let own = mesh.get("weights")?;
        if let Some(weights) = weights.or(own.as_ref()) {
            let mut is_any = false;
            for weight in weights.entries()? {
                is_any |= weight.number()? != 0.0;
            }
            if is_any && self.is_first_of("weights") {
                let message = "morph targets are not used: the mesh stands as it was made";
                weights.warn(builder, message, None);
            }
        }
        let primitives = mesh.needed("primitives")?;
        for primitive in primitives.entries()? {
            self.add_primitive(root, &primitive, place, builder)?;
        }
        Ok(())
    }

    fn add_primitive(
        &mut self,
        root: &Item<'_, 'a>,
        primitive: &Item<'_, 'a>,
        place: &Place,
        builder: &mut Builder,
    ) -> Result<(), Diagnostic> {
        self.assets.check_stop()?;
        let mode = match primitive.get("mode")? {
            None => Mode::Triangles,
            Some(item) => match item.whole()? {
                4 => Mode::Triangles,
                5 => Mode::Strip,
                6 => Mode::Fan,
                0..=3 => {
                    if self.is_first_of("points") {
                        item.warn(
                            builder,
                            "points and lines are left out: only triangles are drawn",
                            None,
                        );
                    }
                    return Ok(());
                }
                n => return Err(item.error(format!("expected 0 to 6, found {n}"))),
            },
        };
        let attributes = primitive.needed("attributes")?;
        let number = attributes.needed("POSITION")?;
        let positions = accessor(&number, root, &POSITIONS, self.buffers, self.assets)?;
        let vertices = positions.count;
        let same_count = |number: &Item<'_, 'a>, accessor: &Accessor<'_>| match accessor.count == vertices {
            true => Ok(()),
            false => Err(number.error(format!(
                "the accessor has {}, and POSITION {vertices}; expected as many",
                counted(accessor.count, "element", "elements")
            ))),
        };
        let normals = match attributes.get("NORMAL")? {
            None => None,
            Some(number) => {
                let normals = accessor(&number, root, &POSITIONS, self.buffers, self.assets)?;
                same_count(&number, &normals)?;
                Some((normals, number.to_string()))
            }
        };
        let material = match primitive.get("material")? {
            Some(number) if self.with_materials => Some(number.index(MATERIAL, root.count(MATERIAL.list)?)?),
            _ => None,
        };
        let layer = Layer::of_material(root, material)?;
        let attribute = layer.attribute();
        let uvs = match attributes.get(&attribute)? {
            None => None,
            Some(number) => {
                let uvs = accessor(&number, root, &UVS, self.buffers, self.assets)?;
                same_count(&number, &uvs)?;
                Some((uvs, number.to_string()))
            }
        };
        let colors = match attributes.get("COLOR_0")? {
            None => None,
            Some(number) => {
                let colors = accessor(&number, root, &COLORS, self.buffers, self.assets)?;
                same_count(&number, &colors)?;
                self.colored.extend(material);
                Some((colors, number.to_string()))
            }
        };
        let indices = match primitive.get("indices")? {
            None => None,
            Some(number) => {
                let indices = accessor(&number, root, &INDICES, self.buffers, self.assets)?;
                Some((indices, number))
            }
        };
        let count = indices.as_ref().map_or(vertices, |(indices, _)| indices.count);
        if mode == Mode::Triangles && !count.is_multiple_of(3) {
            let n = counted(count, "vertex does", "vertices do");
            return Err(primitive.error(format!("{n} not make triangles; expected a multiple of 3")));
        }
        let triangles = mode.triangles(count);
        self.triangles = self.triangles.saturating_add(triangles);
        let most = self.assets.limits().primitives;
        if self.triangles > most {
            let error = SceneError::limit("too many triangles", "primitives", most);
            return Err(primitive.place(error.into()));
        }
        let slot = material.map(|material| {
            *self.slots.entry(material).or_insert_with(|| {
                self.materials.push(material);
                self.materials.len() as u32 - 1
            })
        });
        let face = Face {
            at: primitive.at(),
            material: slot,
            end: 0,
        };
        let mut places = Places::new(vertices, count);
        for i in 0..triangles {
            if i % TRIANGLES_PER_QUESTION == TRIANGLES_PER_QUESTION - 1 {
                self.assets.check_stop()?;
            }
            let mut corners = [Corner {
                position: Corner::NONE,
                uv: Corner::NONE,
                normal: Corner::NONE,
            }; 3];
            for (corner, at) in corners.iter_mut().zip(mode.corners(i)) {
                let vertex = match &indices {
                    None => at,
                    Some((indices, number)) => match indices.number(at, 0) as usize {
                        vertex if vertex < vertices => vertex,
                        vertex => {
                            return Err(number.error(format!(
                                "entry {at} is vertex {vertex}, but there are {vertices}, numbered from 0"
                            )));
                        }
                    },
                };
                let known = places.place(vertex);
                if *known == NOWHERE {
                    *known = self.vertex(&number, vertex, &positions, &normals, (&uvs, &layer), place)?;
                    self.color(&number, vertex, &colors)?;
                }
                let [position, normal, uv] = *known;
                *corner = Corner { position, uv, normal };
            }
            if place.is_mirrored {
                corners.swap(1, 2);
            }
            self.checked.corners.extend(corners);
            let end = self.checked.corners.len();
            self.checked.faces.push(Face { end, ..face });
        }
        Ok(())
    }

    /// Adds a vertex: where its position, its normal and its texture coordinates are.
    fn vertex(
        &mut self,
        number: &Item<'_, 'a>,
        i: usize,
        positions: &Accessor<'_>,
        normals: &Option<(Accessor<'_>, String)>,
        (uvs, layer): (&Option<(Accessor<'_>, String)>, &Layer),
        place: &Place,
    ) -> Result<[u32; 3], Diagnostic> {
        let error = |way: &str, what: &str, values: &[f64], wanted: &str| {
            let values: Vec<String> = values.iter().map(ToString::to_string).collect();
            let message = format!(
                "{way}: {what} of vertex {i} is {}; expected {wanted}",
                values.join(", ")
            );
            number.place(Diagnostic::error(ErrorKind::Input, message))
        };
        let p = place
            .world
            .transform_point3(DVec3::from_array(positions.element(i)));
        if !(p.abs().max_element() <= 1e15 && p.is_finite()) {
            let (way, p) = (number.to_string(), p.to_array());
            return Err(error(&way, "the place", &p, "a place within 1e15 of the origin"));
        }
        let lists = &mut self.checked;
        lists.positions.push(p);
        let mut at = [lists.positions.len() as u32 - 1, Corner::NONE, Corner::NONE];
        if let Some((normals, way)) = normals {
            let n = DVec3::from_array(normals.element(i));
            if !n.is_finite() {
                return Err(error(way, "the normal", &n.to_array(), "numbers"));
            }
            let n = place.normal(n);
            lists.normals.push(if n.is_finite() { n } else { DVec3::ZERO });
            at[1] = lists.normals.len() as u32 - 1;
        }
        if let Some((uvs, way)) = uvs {
            let uv = layer.place(DVec2::from_array(uvs.element(i)));
            if !(uv.abs().max_element() <= 1e15 && uv.is_finite()) {
                return Err(error(
                    way,
                    "the texture coordinates",
                    &uv.to_array(),
                    "numbers within 1e15",
                ));
            }
            lists.uvs.push(uv);
            at[2] = lists.uvs.len() as u32 - 1;
        }
        Ok(at)
    }
}

impl<'a> Triangles<'a, '_, '_> {
    /// Gives the vertex that was added last its color; white where it has none and others have.
    fn color(
        &mut self,
        number: &Item<'_, 'a>,
        i: usize,
        colors: &Option<(Accessor<'_>, String)>,
    ) -> Result<(), Diagnostic> {
        let Checked {
            positions,
            colors: all,
            ..
        } = &mut self.checked;
        let Some((colors, way)) = colors else {
            if !all.is_empty() {
                all.push(Color::ONE);
            }
            return Ok(());
        };
        let color: [f64; 3] = colors.element(i);
        // Exporters round beyond the ends.
        if !color.iter().all(|x| (-1e-3..=BRIGHTEST).contains(x)) {
            let [r, g, b] = color;
            let message = format!(
                "{way}: the color {r}, {g}, {b} of vertex {i}; expected numbers from 0 to {BRIGHTEST}"
            );
            return Err(number.place(Diagnostic::error(ErrorKind::Input, message)));
        }
        all.resize(positions.len() - 1, Color::ONE);
        all.push(Color::from_array(color).max(Color::ZERO));
        Ok(())
    }
}

/// A vertex that was not added yet.
const NOWHERE: [u32; 3] = [Corner::NONE; 3];

/// Where the vertices of a primitive are. Of a long list that others use too, only a few may be its own.
enum Places {
    All(Vec<[u32; 3]>),
    Few(HashMap<usize, [u32; 3]>),
}

impl Places {
    fn new(vertices: usize, uses: usize) -> Self {
        if vertices / 4 <= uses {
            Self::All(vec![NOWHERE; vertices])
        } else {
            Self::Few(HashMap::new())
        }
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "whoever asks has compared the number with that of the vertices"
    )]
    fn place(&mut self, vertex: usize) -> &mut [u32; 3] {
        match self {
            Self::All(places) => &mut places[vertex],
            Self::Few(places) => places.entry(vertex).or_insert(NOWHERE),
        }
    }
}
