//! STL meshes, ascii and binary: triangles, flat.

use std::collections::HashMap;

use super::{
    assembly,
    assets::Assets,
    guard::{Checked, Corner, Face},
    text::{Source, counted, lines, number, quoted},
    wavefront,
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    math::DVec3,
    scene::{Builder, Mesh, SceneError},
};

/// Text that says nothing, and the count of triangles.
const HEADER: usize = 84;
/// A normal, three corners and two bytes that mean something to some programs.
const TRIANGLE: usize = 50;
/// Triangles between two questions whether to stop.
const TRIANGLES_PER_QUESTION: usize = 4096;

/// How many triangles the header of a binary file claims.
fn claimed(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

fn is_binary(bytes: &[u8]) -> bool {
    // Many binary files begin with 'solid' too; their size gives them away.
    claimed(bytes).is_some_and(|n| n.checked_mul(TRIANGLE) == bytes.len().checked_sub(HEADER))
}

/// Whether a file that is not called so looks like an STL file.
pub(super) fn is_stl(bytes: &[u8]) -> bool {
    let head = bytes.get(..512).unwrap_or(bytes);
    let has_facet = head.windows(5).any(|w| w == b"facet");
    (bytes.starts_with(b"solid") && has_facet) || is_binary(bytes) && bytes.len() > HEADER
}

/// The mesh in an STL file. Corners at one place are one vertex. The normals that the file has are those of the triangles and
/// are not read.
///
/// # Errors
/// With the line, or for what is binary with the byte, where the file is malformed; where it has no triangle with an area, or
/// a limit is passed.
pub(super) fn read(
    path: &str,
    bytes: &[u8],
    assets: &Assets<'_>,
    builder: &mut Builder,
) -> Result<Mesh, Diagnostic> {
    if !is_binary(bytes) && bytes.trim_ascii_start().starts_with(b"solid") {
        let text = wavefront::text(path, bytes)?;
        let source = Source::new(path, &text, ErrorKind::Input);
        let checked = ascii(&source, assets)?;
        return assembly::mesh(&source, checked, assets, builder);
    }
    let source = Source::new(path, "", ErrorKind::Input);
    let checked = binary(&source, bytes, assets)?;
    assembly::mesh(&source, checked, assets, builder)
}

/// Triangles in the making.
struct Soup<'a, 's> {
    checked: Checked<'a>,
    known: HashMap<[u64; 3], u32>,
    assets: &'s Assets<'s>,
}

impl<'a, 's> Soup<'a, 's> {
    fn new(assets: &'s Assets<'s>) -> Self {
        Self {
            checked: Checked::default(),
            known: HashMap::new(),
            assets,
        }
    }

    /// Adds a triangle.
    ///
    /// # Errors
    /// Where it is one too many, or the host asks to stop.
    fn add(&mut self, corners: [DVec3; 3], at: &'a str) -> Result<(), Diagnostic> {
        let count = self.checked.faces.len();
        let most = self.assets.limits().primitives;
        if count >= most {
            return Err(SceneError::limit("too many triangles", "primitives", most).into());
        }
        if count % TRIANGLES_PER_QUESTION == TRIANGLES_PER_QUESTION - 1 {
            self.assets.check_stop()?;
        }
        for p in corners {
            // Zeros of both signs are one place.
            let p = p + DVec3::ZERO;
            let positions = &mut self.checked.positions;
            let position = *self
                .known
                .entry(p.to_array().map(f64::to_bits))
                .or_insert_with(|| {
                    positions.push(p);
                    positions.len() as u32 - 1
                });
            self.checked.corners.push(Corner {
                position,
                uv: Corner::NONE,
                normal: Corner::NONE,
            });
        }
        self.checked.faces.push(Face {
            at,
            material: None,
            end: self.checked.corners.len(),
        });
        Ok(())
    }

    fn finish(self, source: &Source<'_>) -> Result<Checked<'a>, Diagnostic> {
        if self.checked.faces.is_empty() {
            let error = Diagnostic::error(ErrorKind::Input, "the file has no triangles");
            let hint =
                "expected at least one facet; a program that exports nothing selected writes such files";
            return Err(error.at(source.name, 0, 0).hint(hint));
        }
        Ok(self.checked)
    }
}

fn binary<'a>(source: &Source<'a>, bytes: &[u8], assets: &Assets<'_>) -> Result<Checked<'a>, Diagnostic> {
    let error = |message: String| Diagnostic::error(ErrorKind::Input, message).at(source.name, 0, 0);
    let Some(count) = claimed(bytes) else {
        return Err(error(format!(
            "it is no STL file: expected 'solid' or a header of {HEADER} bytes, found {}",
            counted(bytes.len(), "byte", "bytes")
        ))
        .hint("the file is cut off, or it is no STL file"));
    };
    let body = bytes.get(HEADER..).unwrap_or(&[]);
    let (triangles, _) = body.as_chunks::<TRIANGLE>();
    let Some(triangles) = triangles.get(..count) else {
        return Err(error(format!(
            "the header claims {}, but the {} after it hold {}",
            counted(count, "triangle", "triangles"),
            counted(body.len(), "byte", "bytes"),
            counted(triangles.len(), "triangle", "triangles")
        ))
        .hint("the file is cut off, or it is no STL file"));
    };
    let mut soup = Soup::new(assets);
    for (i, triangle) in triangles.iter().enumerate() {
        let (numbers, _) = triangle.as_chunks::<4>();
        let mut corners = [DVec3::ZERO; 3];
        // The first three numbers are the normal.
        let places = corners
            .iter_mut()
            .zip(numbers.get(3..).unwrap_or(&[]).as_chunks::<3>().0);
        for (k, (corner, place)) in places.enumerate() {
            *corner = DVec3::from_array(place.map(|bytes| f64::from(f32::from_le_bytes(bytes))));
            let number = corner.to_array().into_iter().position(|x| !(x.abs() <= 1e15));
            if let Some(axis) = number {
                let at = HEADER + i * TRIANGLE + 4 * (3 + 3 * k + axis);
                let x = corner.to_array().get(axis).copied().unwrap_or(f64::NAN);
                return Err(error(format!(
                    "expected a number within 1e15, found {x} at byte {at}, in triangle {} of {count}",
                    i + 1
                ))
                .hint("the file is damaged; export it again"));
            }
        }
        soup.add(corners, source.text)?;
    }
    soup.finish(source)
}

/// `solid`, then for each triangle `facet normal x y z`, `outer loop`, three times `vertex x y z`, `endloop`, `endfacet`.
fn ascii<'a>(source: &Source<'a>, assets: &Assets<'_>) -> Result<Checked<'a>, Diagnostic> {
    let mut soup = Soup::new(assets);
    let mut corners: Vec<DVec3> = Vec::new();
    // Where the facet began that is not ended yet.
    let mut open: Option<&'a str> = None;
    let mut steps = 0usize;
    for line in lines(source.text) {
        steps += 1;
        if steps.is_multiple_of(8 * TRIANGLES_PER_QUESTION) {
            assets.check_stop()?;
        }
        let mut words = line.split_ascii_whitespace();
        let Some(word) = words.next() else { continue };
        // Some programs write capitals.
        match (word.to_ascii_lowercase().as_str(), open) {
            // Names may hold anything, and so may what some write between.
            ("solid" | "endsolid", None) => {}
            ("facet", None) => open = Some(word),
            ("outer", Some(_)) | ("endloop", Some(_)) => {}
            ("vertex", Some(_)) => {
                let mut p = [0.0; 3];
                for slot in &mut p {
                    let Some(next) = words.next() else {
                        let given = line.split_ascii_whitespace().count() - 1;
                        let message = format!("vertex takes 3 numbers (x y z), not {given}");
                        return Err(source.error(word, message).hint("write: vertex x y z"));
                    };
                    *slot = number(next).map_err(|message| source.error(next, message))?;
                }
                if let Some(surplus) = words.next() {
                    let message = format!("vertex takes 3 numbers (x y z), found {} too", quoted(surplus));
                    return Err(source.error(surplus, message).hint("write: vertex x y z"));
                }
                if corners.len() == 3 {
                    let error = source.error(word, "a facet has 3 vertices, this is the fourth");
                    return Err(
                        error.hint("STL has triangles only: cut the polygon, a facet for each triangle")
                    );
                }
                corners.push(DVec3::from_array(p));
            }
            ("endfacet", Some(at)) => {
                let [a, b, c] = corners[..] else {
                    let message = format!("a facet has 3 vertices, this one {}", corners.len());
                    let hint = "write 'vertex x y z' three times before endfacet";
                    return Err(source.error(word, message).hint(hint));
                };
                soup.add([a, b, c], at).map_err(|error| match error.kind {
                    ErrorKind::Limit => source.place(error, at),
                    _ => error,
                })?;
                corners.clear();
                open = None;
            }
            (_, inside) => {
                let wanted = match inside {
                    Some(_) => "outer loop, vertex, endloop or endfacet",
                    None => "facet or endsolid",
                };
                return Err(source.error(word, format!("expected {wanted}, found {}", quoted(word))));
            }
        }
    }
    if let Some(at) = open {
        let error = source.error(at, "the file ends in this facet: expected endfacet");
        return Err(error.hint("the file is cut off"));
    }
    soup.finish(source)
}

#[cfg(test)]
mod tests {
    use crate::{
        Builder, Limits, MemoryHost,
        diag::Diagnostic,
        import::{AssetCache, Assets, load_mesh},
        scene::Mesh,
    };

    fn load(name: &str, bytes: &[u8]) -> Result<Mesh, Diagnostic> {
        let (host, limits) = (MemoryHost::new().with(name, bytes), Limits::default());
        let mut cache = AssetCache::default();
        let mut assets = Assets::new(&host, &limits, &mut cache);
        let mesh = load_mesh(name, &mut assets, &mut Builder::new())?;
        let mut mesh = Mesh::clone(&mesh);
        mesh.name.clear();
        Ok(mesh)
    }

    const CORNERS: [[[f32; 3]; 3]; 2] = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, -0.0]],
        [[0.0, 1.0, 0.0], [1.0, 0.0, -0.0], [1.0, 1.5, 0.0]],
    ];

    fn binary() -> Vec<u8> {
        let mut bytes = b"solid, but not of text".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(2u32.to_le_bytes());
        for triangle in CORNERS {
            bytes.extend([0; 12]);
            bytes.extend(triangle.into_iter().flatten().flat_map(f32::to_le_bytes));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn text() -> String {
        let mut text = "solid a name of its own\r\n".to_owned();
        for triangle in CORNERS {
            text += "FACET NORMAL 0 0 1\r\nouter loop\r\n";
            for [x, y, z] in triangle {
                text += &format!("vertex {x:e} {y} {z}\r\n");
            }
            text += "endloop\r\nendfacet\r\n";
        }
        text + "endsolid\r\n"
    }

    #[test]
    fn text_and_bytes_give_the_same_mesh_with_common_corners() {
        let mesh = load("a.stl", &binary()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!((mesh.positions.len(), mesh.normals.clone()), (4, None));
        assert_eq!(load("a.stl", text().as_bytes()).unwrap(), mesh);
        // Whatever they are called.
        assert_eq!(load("a.mesh", &binary()).unwrap(), mesh);
        assert_eq!(load("a.mesh", text().as_bytes()).unwrap(), mesh);
    }

    #[test]
    fn what_is_cut_off_is_said() {
        let whole = binary();
        for end in 0..whole.len() {
            assert!(load("a.stl", &whole[..end]).is_err(), "up to {end}");
        }
        let message = |bytes: &[u8]| {
            let error = load("a.stl", bytes).unwrap_err();
            (error.line, error.message)
        };
        assert_eq!(
            message(&[b' '; 84]),
            (
                0,
                "the header claims 538976288 triangles, but the 0 bytes after it hold 0 triangles".to_owned()
            )
        );
        assert_eq!(
            message(b"short"),
            (
                0,
                "it is no STL file: expected 'solid' or a header of 84 bytes, found 5 bytes".to_owned()
            )
        );
        let mut nan = whole.clone();
        nan[84 + 50 + 12 + 8..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        assert_eq!(
            message(&nan),
            (
                0,
                "expected a number within 1e15, found NaN at byte 154, in triangle 2 of 2".to_owned()
            )
        );
        let text = text();
        let cut = text.rfind("endloop").unwrap();
        assert_eq!(
            message(&text.as_bytes()[..cut]),
            (9, "the file ends in this facet: expected endfacet".to_owned())
        );
        let twice = text.replacen("endloop\r\n", "vertex 1 2 3\r\n", 1);
        assert_eq!(
            message(twice.as_bytes()),
            (7, "a facet has 3 vertices, this is the fourth".to_owned())
        );
    }
}
