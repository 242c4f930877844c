//! Meshes that come from no file, as the numbers that they are made of.

use std::fmt::{self, Display};

use super::{Components, Number, Writer};
use crate::scene::Mesh;

impl Writer<'_> {
    /// The lists of a mesh, a vertex or a triangle a line.
    pub(super) fn mesh(&mut self, mesh: &Mesh) -> fmt::Result {
        self.list("positions", mesh.positions.iter().map(|p| Components(*p)))?;
        let triple = |[a, b, c]: &[u32; 3]| format!("{a}, {b}, {c}");
        self.list("indices", mesh.triangles.iter().map(triple))?;
        if let Some(normals) = &mesh.normals {
            self.list("normals", normals.values.iter().map(|n| Components(*n)))?;
        }
        if let Some(uvs) = &mesh.uvs {
            let pair = |uv: &crate::math::DVec2| format!("{}, {}", Number(uv.x), Number(uv.y));
            self.list("uvs", uvs.values.iter().map(pair))?;
        }
        Ok(())
    }

    fn list(&mut self, name: &str, items: impl Iterator<Item = impl Display>) -> fmt::Result {
        self.call(format_args!("    {name}: ["))?;
        for item in items {
            self.call(format_args!("        {item},"))?;
        }
        self.call("    ],")
    }
}
