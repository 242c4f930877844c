//! Meshes that come from no file, as the numbers that they are made of.

use std::fmt::{self, Display};

use super::{Components, Number, Writer};
use crate::scene::{Attribute, Mesh};

impl Writer<'_> {
    /// The lists of a mesh, a vertex or a triangle a line.
    pub(super) fn mesh(&mut self, mesh: &Mesh) -> fmt::Result {
        self.list("positions", mesh.positions.iter().map(|p| Components(*p)))?;
        let triple = |[a, b, c]: &[u32; 3]| format!("{a}, {b}, {c}");
        self.list("indices", mesh.triangles.iter().map(triple))?;
        if let Some(normals) = &mesh.normals {
            self.list("normals", normals.values.iter().map(|n| Components(*n)))?;
            self.own_indices("normalIndices", mesh, &normals.indices)?;
        }
        if let Some(uvs) = &mesh.uvs {
            let pair = |uv: &crate::math::DVec2| format!("{}, {}", Number(uv.x), Number(uv.y));
            self.list("uvs", uvs.values.iter().map(pair))?;
            self.own_indices("uvIndices", mesh, &uvs.indices)?;
        }
        if let Some(colors) = &mesh.colors {
            self.list("colors", colors.values.iter().map(|c| Components(*c)))?;
            self.own_indices("colorIndices", mesh, &colors.indices)?;
        }
        Ok(())
    }

    /// The indices of normals, uvs or colors where they are not those of the positions.
    fn own_indices(&mut self, name: &str, mesh: &Mesh, indices: &[[u32; 3]]) -> fmt::Result {
        if *indices == *mesh.triangles {
            return Ok(());
        }
        let number = |index: u32| {
            if index == Attribute::<f64>::NONE {
                -1
            } else {
                i64::from(index)
            }
        };
        let triple = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(number);
            format!("{a}, {b}, {c}")
        };
        self.list(name, indices.iter().map(triple))
    }

    fn list(&mut self, name: &str, items: impl Iterator<Item = impl Display>) -> fmt::Result {
        self.call(format_args!("    {name}: ["))?;
        for item in items {
            self.call(format_args!("        {item},"))?;
        }
        self.call("    ],")
    }
}
