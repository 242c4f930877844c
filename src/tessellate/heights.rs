//! Height fields.

use super::{Allowance, allowance::STEPS_PER_QUESTION};
use crate::{
    math::{DVec2, DVec3},
    scene::{Attribute, Mesh, SceneError},
};

/// Heights over a grid: a row of numbers after the other, the first row at the far side, z = -0.5.
///
/// ```
/// use rtscript::tessellate::Heights;
/// assert!(Heights::new(2, 2, vec![0.0; 4]).is_ok());
/// // Four places, three heights.
/// assert!(Heights::new(2, 2, vec![0.0; 3]).is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    columns: usize,
    rows: usize,
    values: Vec<f64>,
}

impl Heights {
    /// Heights of `columns` times `rows` points.
    ///
    /// # Errors
    /// Where there are fewer than 2 columns or rows, not as many values as points, or a value is not finite or beyond 1e15.
    pub fn new(columns: usize, rows: usize, values: Vec<f64>) -> Result<Self, SceneError> {
        if columns < 2 || rows < 2 {
            return Err(SceneError::new(format!(
                "a height field takes at least 2 x 2 heights, not {columns} x {rows}"
            )));
        }
        if columns.checked_mul(rows) != Some(values.len()) {
            return Err(SceneError::new(format!(
                "a height field of {columns} x {rows} takes as many heights, not {}",
                values.len()
            )));
        }
        let wrong = values.iter().position(|h| !(h.abs() <= 1e15));
        if let Some(at) = wrong {
            return Err(SceneError::new(format!(
                "the height in row {}, column {} is not a number within 1e15",
                at / columns,
                at % columns
            )));
        }
        Ok(Self {
            columns,
            rows,
            values,
        })
    }

    /// The place of a column and a row in the unit square: x and z, each from -0.5 to 0.5.
    ///
    /// ```
    /// use rtscript::tessellate::Heights;
    /// // The first column and row are the far left corner, the last ones the near right.
    /// assert_eq!(Heights::place(3, 5, 0, 0), (-0.5, -0.5));
    /// assert_eq!(Heights::place(3, 5, 2, 4), (0.5, 0.5));
    /// ```
    #[must_use]
    pub fn place(columns: usize, rows: usize, column: usize, row: usize) -> (f64, f64) {
        let along = |i: usize, n: usize| i as f64 / (n.max(2) - 1) as f64 - 0.5;
        (along(column, columns), along(row, rows))
    }

    fn at(&self, column: usize, row: usize) -> f64 {
        self.values
            .get(row * self.columns + column)
            .copied()
            .unwrap_or(0.0)
    }

    /// Change of the height for a unit in x and in z, by central differences, at the edge one-sided.
    fn slope(&self, column: usize, row: usize) -> (f64, f64) {
        let (left, right) = (column.saturating_sub(1), (column + 1).min(self.columns - 1));
        let (far, near) = (row.saturating_sub(1), (row + 1).min(self.rows - 1));
        let along = |rise: f64, steps: usize, n: usize| rise * (n - 1) as f64 / steps as f64;
        (
            along(
                self.at(right, row) - self.at(left, row),
                right - left,
                self.columns,
            ),
            along(
                self.at(column, near) - self.at(column, far),
                near - far,
                self.rows,
            ),
        )
    }

    fn point(&self, column: usize, row: usize) -> DVec3 {
        let (x, z) = Self::place(self.columns, self.rows, column, row);
        DVec3::new(x, self.at(column, row), z)
    }
}

/// A height field over the unit square: x and z from -0.5 to 0.5, heights along y.
///
/// ```
/// use rtscript::{Limits, tessellate::{Allowance, HeightField, Heights}};
/// let hill = Heights::new(3, 3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])?;
/// let mesh = HeightField::new(hill).mesh(&Allowance::of(&Limits::default()))?;
/// assert_eq!(mesh.bounds().size().y, 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    /// The heights.
    pub heights: Heights,
    /// Whether it is shaded as the smooth surface through its points. Default: true.
    pub smooth: bool,
    /// Where its floor is, in object units, if it has walls and a floor and so is closed. Default: none.
    pub base: Option<f64>,
    /// Whether uvs are the centers of the pixels of a picture that has a pixel for each height, so that a texture of the
    /// same picture lies as its heights do; else they are x + 0.5 and 0.5 - z. Default: false.
    pub of_pixels: bool,
}

impl HeightField {
    /// A smooth, open field.
    #[must_use]
    pub const fn new(heights: Heights) -> Self {
        Self {
            heights,
            smooth: true,
            base: None,
            of_pixels: false,
        }
    }

    /// Its triangles: two for each square of the grid, cut along the diagonal that rises less, which keeps ridges whole;
    /// with a base, walls and a floor around its middle.
    ///
    /// # Errors
    /// Where the base is not below all heights or not within 1e15, or the triangles are too many.
    pub fn mesh(&self, allowance: &Allowance<'_>) -> Result<Mesh, SceneError> {
        let (columns, rows) = (self.heights.columns, self.heights.rows);
        let around = 2 * (columns - 1) + 2 * (rows - 1);
        let squares = (columns - 1).saturating_mul(rows - 1);
        let walls = if self.base.is_some() { 3 * around } else { 0 };
        allowance.triangles(squares.saturating_mul(2).saturating_add(walls))?;
        if let Some(base) = self.base {
            let lowest = self.heights.values.iter().copied().fold(f64::INFINITY, f64::min);
            if !(base < lowest && base >= -1e15) {
                return Err(SceneError::new(format!(
                    "base must be below the lowest height, {lowest}, not {base}"
                ))
                .hint("the base is where the floor of a solid field lies, for example base: -0.1"));
            }
        }
        let mut field = Field {
            heights: &self.heights,
            of_pixels: self.of_pixels,
            positions: Vec::with_capacity(columns * rows),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles: Vec::new(),
            normal_indices: Vec::new(),
        };
        field.top(allowance)?;
        if let Some(base) = self.base {
            field.walls(base);
        }
        let uv_indices = field.triangles.clone();
        let mut mesh = Mesh::new("heightField", field.positions, field.triangles)?;
        if self.smooth {
            mesh.normals = Some(Attribute {
                values: field.normals,
                indices: field.normal_indices,
            });
        }
        mesh.uvs = Some(Attribute {
            values: field.uvs,
            indices: uv_indices,
        });
        Ok(mesh)
    }
}

/// A mesh in the making; uvs belong to the positions, one each.
struct Field<'a> {
    heights: &'a Heights,
    of_pixels: bool,
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    uvs: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    normal_indices: Vec<[u32; 3]>,
}

impl Field<'_> {
    fn add(&mut self, p: DVec3) -> u32 {
        self.positions.push(p);
        let uv = DVec2::new(p.x + 0.5, 0.5 - p.z);
        self.uvs.push(if self.of_pixels {
            let count = DVec2::new(self.heights.columns as f64, self.heights.rows as f64);
            (uv * (count - DVec2::ONE) + DVec2::splat(0.5)) / count
        } else {
            uv
        });
        self.positions.len() as u32 - 1
    }

    fn top(&mut self, allowance: &Allowance<'_>) -> Result<(), SceneError> {
        let heights = self.heights;
        let (columns, rows) = (heights.columns, heights.rows);
        for row in 0..rows {
            if (row * columns) % STEPS_PER_QUESTION < columns {
                allowance.check_stop()?;
            }
            for column in 0..columns {
                self.add(heights.point(column, row));
                let (dx, dz) = heights.slope(column, row);
                self.normals.push(DVec3::new(-dx, 1.0, -dz).normalize());
            }
        }
        for row in 1..rows {
            if (row * columns) % STEPS_PER_QUESTION < columns {
                allowance.check_stop()?;
            }
            for column in 1..columns {
                let id = |column: usize, row: usize| (row * columns + column) as u32;
                let height = |column: usize, row: usize| heights.at(column, row);
                let [a, b, c, d] = [
                    id(column - 1, row - 1),
                    id(column - 1, row),
                    id(column, row),
                    id(column, row - 1),
                ];
                let down = (height(column - 1, row - 1) - height(column, row)).abs();
                let up = (height(column - 1, row) - height(column, row - 1)).abs();
                self.triangles.extend(if down <= up {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, b, d], [b, c, d]]
                });
            }
        }
        self.normal_indices.clone_from(&self.triangles);
        Ok(())
    }

    /// The edge of the field once around, counter-clockwise seen from above, each side with the normal of its wall.
    fn edge(&self) -> Vec<(u32, DVec3)> {
        let (columns, rows) = (self.heights.columns, self.heights.rows);
        let id = |column: usize, row: usize| (row * columns + column) as u32;
        let left = (0..rows - 1).map(|row| (id(0, row), DVec3::NEG_X));
        let near = (0..columns - 1).map(|column| (id(column, rows - 1), DVec3::Z));
        let right = (1..rows).rev().map(|row| (id(columns - 1, row), DVec3::X));
        let far = (1..columns).rev().map(|column| (id(column, 0), DVec3::NEG_Z));
        left.chain(near).chain(right).chain(far).collect()
    }

    fn walls(&mut self, base: f64) {
        let edge = self.edge();
        let corner = |id: u32| self.positions.get(id as usize).copied().unwrap_or_default();
        let below: Vec<DVec3> = edge
            .iter()
            .map(|(id, _)| DVec3 {
                y: base,
                ..corner(*id)
            })
            .collect();
        let first = self.positions.len() as u32;
        for p in below {
            self.add(p);
        }
        let middle = self.add(DVec3::Y * base);
        let count = edge.len() as u32;
        let down = self.normals.len() as u32;
        self.normals.push(DVec3::NEG_Y);
        let next = edge.iter().cycle().skip(1);
        for ((i, (a, normal)), (b, _)) in (0..).zip(&edge).zip(next) {
            let (c, d) = (first + i, first + (i + 1) % count);
            self.normals.push(*normal);
            let n = self.normals.len() as u32 - 1;
            self.triangles.extend([[*a, c, d], [*a, d, *b], [middle, d, c]]);
            self.normal_indices.extend([[n; 3], [n; 3], [down; 3]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::suite, *};
    use crate::{Limits, math};

    fn allowance() -> Allowance<'static> {
        Allowance::of(&Limits::default())
    }

    fn waves(columns: usize, rows: usize) -> Heights {
        let values = (0..columns * rows).map(|i| {
            let (x, z) = Heights::place(columns, rows, i % columns, i / columns);
            0.2 * math::sin(5.0 * x) * math::cos(4.0 * z)
        });
        Heights::new(columns, rows, values.collect()).unwrap()
    }

    #[test]
    fn a_solid_field_is_closed_and_has_the_volume_under_it() {
        for (columns, rows) in [(2, 2), (2, 5), (17, 9)] {
            let mut field =
                HeightField::new(Heights::new(columns, rows, vec![0.75; columns * rows]).unwrap());
            field.base = Some(-0.25);
            let mesh = field.mesh(&allowance()).unwrap();
            suite::check_closed(&mesh);
            assert!((suite::volume(&mesh) - 1.0).abs() < 1e-12);
            field.heights = waves(columns, rows);
            let mesh = field.mesh(&allowance()).unwrap();
            suite::check_closed(&mesh);
            suite::check_normals(&mesh, 0.2);
        }
    }

    #[test]
    fn normals_are_those_of_the_surface() {
        let mut field = HeightField::new(waves(201, 301));
        let mesh = field.mesh(&allowance()).unwrap();
        assert_eq!(mesh.triangles.len(), 2 * 200 * 300);
        let normals = mesh.normals.as_ref().unwrap();
        for (p, n) in mesh.positions.iter().zip(&normals.values) {
            let dx = math::cos(5.0 * p.x) * math::cos(4.0 * p.z);
            let dz = -0.8 * math::sin(5.0 * p.x) * math::sin(4.0 * p.z);
            let expected = DVec3::new(-dx, 1.0, -dz).normalize();
            let at_the_edge = p.x.abs().max(p.z.abs()) > 0.499;
            assert!(
                n.dot(expected) > if at_the_edge { 0.9999 } else { 0.9999999 },
                "{p}"
            );
        }
        field.smooth = false;
        assert_eq!(field.mesh(&allowance()).unwrap().normals, None);
    }

    #[test]
    fn uvs_are_the_places_or_the_centers_of_pixels() {
        let mut field = HeightField::new(waves(4, 2));
        let uvs = |field: &HeightField| field.mesh(&allowance()).unwrap().uvs.unwrap().values;
        assert_eq!(uvs(&field)[0], DVec2::new(0.0, 1.0));
        field.of_pixels = true;
        assert_eq!(uvs(&field)[0], DVec2::new(0.125, 0.75));
        assert_eq!(uvs(&field)[7], DVec2::new(0.875, 0.25));
    }

    #[test]
    fn ridges_are_not_cut_across() {
        let heights = Heights::new(3, 3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]).unwrap();
        let mesh = HeightField::new(heights).mesh(&allowance()).unwrap();
        let along = mesh.triangles.iter().filter(|t| t.contains(&0) && t.contains(&4));
        assert_eq!(along.count(), 2);
        let across = mesh.triangles.iter().filter(|t| t.contains(&1) && t.contains(&3));
        assert_eq!(across.count(), 0);
    }

    #[test]
    fn what_is_no_field_is_refused() {
        let message = |columns, rows, values| Heights::new(columns, rows, values).unwrap_err().message;
        assert_eq!(
            message(1, 3, vec![0.0; 3]),
            "a height field takes at least 2 x 2 heights, not 1 x 3"
        );
        assert_eq!(
            message(2, 2, vec![0.0; 3]),
            "a height field of 2 x 2 takes as many heights, not 3"
        );
        assert_eq!(
            message(2, 2, vec![0.0, 0.0, 0.0, f64::NAN]),
            "the height in row 1, column 1 is not a number within 1e15"
        );
        let mut field = HeightField::new(Heights::new(2, 2, vec![0.5; 4]).unwrap());
        for base in [0.5, 0.6, f64::NAN, -1e300] {
            field.base = Some(base);
            let error = field.mesh(&allowance()).unwrap_err();
            assert_eq!(
                error.message,
                format!("base must be below the lowest height, 0.5, not {base}")
            );
        }
        let few = Limits {
            primitives: 7,
            ..Limits::default()
        };
        field.base = None;
        field.heights = waves(3, 3);
        assert!(field.mesh(&Allowance::of(&few)).is_err());
        let stop = Allowance::of(&Limits::default()).asking(&|| true);
        assert_eq!(
            field.mesh(&stop).unwrap_err().kind,
            crate::diag::ErrorKind::Cancelled
        );
    }
}
