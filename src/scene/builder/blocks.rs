//! Blocks that restore what they change, and groups with names.

use super::{Builder, Placing, SceneError};
use crate::diag::{Code, nearest_names};
use crate::scene::{Geometry, Group, GroupId, Material};

/// What a `group`, `define`, `difference` or `moving` block restores when it is left; see [`Builder::begin_group`].
///
/// ```
/// use rtscript::{Builder, DVec3, scene::GroupMark};
/// let mut b = Builder::new();
/// let mark: GroupMark = b.begin_define("pair")?;
/// b.sphere(DVec3::NEG_X, 0.5)?;
/// b.sphere(DVec3::X, 0.5)?;
/// b.end_define(mark, true);
/// b.instance("pair")?;
/// assert_eq!(b.finish().value.root().objects.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
#[must_use = "hand it back to end_group, end_define, end_csg or end_moving"]
pub struct GroupMark {
    depth: usize,
    floor: usize,
    ctm: Placing,
    material: Material,
    /// The group that was being filled, where the block fills one of its own.
    outer: Option<(String, Group)>,
}

impl GroupMark {
    /// The group that is being filled again when the block is left.
    pub(super) fn set_outer(&mut self, group: Group) {
        self.outer = Some((String::new(), group));
    }

    pub(super) fn take_outer(&mut self) -> Option<(String, Group)> {
        self.outer.take()
    }
}

impl Builder {
    /// Saves matrix and material until [`Builder::end_group`].
    ///
    /// # Errors
    /// Past the limit `transform_depth`.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, math::DAffine3};
    /// let mut b = Builder::new();
    /// let mark = b.begin_group()?;
    /// b.translate(DVec3::X)?;
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// b.end_group(mark);
    /// // What was moved inside stays there; what comes now is where it was before.
    /// assert_eq!(b.current_transform(), DAffine3::IDENTITY);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
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
        self.ctm = Placing::IDENTITY;
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
        let id = self.defined(name)?;
        self.place(id)
    }

    /// Places the group defined as `name` once for each matrix, given row by row as to
    /// [`Builder::mult_matrix`], under the product of the current matrix with it. Either all are placed or none.
    ///
    /// # Errors
    /// As [`Builder::instance`] and [`Builder::mult_matrix`], naming the matrix, counted from 0.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3};
    /// let mut b = Builder::new();
    /// let mark = b.begin_define("tree")?;
    /// b.sphere(DVec3::Y, 0.5)?;
    /// b.end_define(mark, true);
    /// // Rows of matrices: each tree at its own place along x.
    /// let at = |x| [1.0, 0.0, 0.0, x, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    /// b.instances("tree", &[at(-2.0), at(0.0), at(2.0)])?;
    /// let scene = b.finish().value;
    /// assert_eq!(scene.world_from_object(&scene.root().objects[2]).translation, DVec3::X * 2.0);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn instances(&mut self, name: &str, matrices: &[[f64; 16]]) -> Result<(), SceneError> {
        let id = self.defined(name)?;
        let outer = self.ctm;
        let before = (self.group.objects.len(), self.group.lights.len());
        let counted = (self.primitives, self.lights);
        for (i, rows) in matrices.iter().enumerate() {
            let placed = self.mult_matrix(rows).and_then(|()| self.place(id));
            self.ctm = outer;
            if let Err(e) = placed {
                self.group.objects.truncate(before.0);
                self.group.lights.truncate(before.1);
                (self.primitives, self.lights) = counted;
                return Err(e.of(format_args!("matrix {i}")));
            }
        }
        Ok(())
    }

    fn place(&mut self, id: GroupId) -> Result<(), SceneError> {
        self.require_invertible("an", "instance")?;
        let group = self.scene.groups.get(id.index());
        let lights = group.map(|group| group.lights.clone()).unwrap_or_default();
        for light in lights {
            self.push_linked(light.kind, light.color, light.links)?;
        }
        self.add(Geometry::Instance(id), 1)
    }

    /// The handle of the group defined as `name`.
    ///
    /// # Errors
    /// Where there is no such group yet.
    pub fn group_called(&self, name: &str) -> Result<GroupId, SceneError> {
        self.defined(name)
    }

    /// The group that `define` called `name`.
    pub(crate) fn defined(&self, name: &str) -> Result<GroupId, SceneError> {
        if let Some(&id) = self.scene.names.get(name) {
            return Ok(id);
        }
        let known: Vec<&str> = self.scene.names.keys().map(String::as_str).collect();
        let error = SceneError::new(format!("no group is defined as \"{name}\"")).class(Code::UnknownGroup);
        let near = nearest_names(name, known.iter().copied());
        Err(match (near.first(), known.is_empty()) {
            (Some(near), _) => error.hint(format!("did you mean \"{near}\"?")),
            (None, true) => error.hint(format!("define \"{name}\" {{ ... }} must come first")),
            (None, false) => error.hint(format!("defined are: {}", known.join(", "))),
        })
    }
}
