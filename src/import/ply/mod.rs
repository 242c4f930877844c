//! PLY meshes (Turk, "The PLY polygon file format", 1994): ascii, and binary of both byte orders.

mod body;
mod header;

use self::{
    body::{Body, Item},
    header::{Element, Format, Header},
};
use super::{
    assembly,
    assets::Assets,
    guard::{Checked, Corner, Face, Ignored},
    text::{Source, lines, quoted},
    wavefront,
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    math::{DVec2, DVec3},
    scene::{Builder, Mesh, SceneError},
};

/// Bytes in which a header ends.
const LONGEST_HEADER: usize = 1 << 16;
/// Elements between two questions whether to stop: a millisecond's work.
const ELEMENTS_PER_QUESTION: usize = 4096;

/// Whether a file says that it is a PLY file.
pub(super) fn is_ply(bytes: &[u8]) -> bool {
    matches!(bytes, [b'p', b'l', b'y', b'\n' | b'\r', ..])
}

/// The mesh in a PLY file: polygons, cut into triangles, or triangle strips; with the vertices' normals and texture
/// coordinates. Warnings, such as that colors are not used, go to the builder.
///
/// # Errors
/// With the line, or for what is binary with the byte, where the file is malformed; where it has no faces, or a limit is
/// passed.
pub(super) fn read(
    path: &str,
    bytes: &[u8],
    assets: &Assets<'_>,
    builder: &mut Builder,
) -> Result<Mesh, Diagnostic> {
    let start = after_header(bytes);
    let head = bytes
        .get(..start.unwrap_or(LONGEST_HEADER.min(bytes.len())))
        .unwrap_or(bytes);
    let head = wavefront::text(path, head)?;
    let head = Source::new(path, &head, ErrorKind::Input);
    let header = Header::read(&head)?;
    if header.format == Format::Ascii {
        let text = wavefront::text(path, bytes)?;
        let source = Source::new(path, &text, ErrorKind::Input);
        let body = Body::text(source, lines(source.text).skip(header.lines));
        return elements(&source, &header, body, assets, builder);
    }
    let body = Body::bytes(head, bytes, start.unwrap_or(bytes.len()), header.format);
    elements(&head, &header, body, assets, builder)
}

/// Where the header ends: behind the end of its last line, which ends as the first one does.
fn after_header(bytes: &[u8]) -> Option<usize> {
    const LAST: &[u8] = b"end_header";
    let head = bytes.get(..LONGEST_HEADER).unwrap_or(bytes);
    let is_line_end = |b: &u8| matches!(b, b'\n' | b'\r');
    let at = head
        .windows(LAST.len() + 1)
        .position(|w| w.first().is_some_and(is_line_end) && w.get(1..) == Some(LAST))?;
    let line_end = at + 1 + LAST.len() + bytes.get(at + 1 + LAST.len()..)?.iter().position(is_line_end)?;
    let has_two = bytes.starts_with(b"ply\r\n");
    Some(line_end + if has_two { 2 } else { 1 })
}

const POSITION: [&[&str]; 3] = [&["x"], &["y"], &["z"]];
const NORMAL: [&[&str]; 3] = [&["nx"], &["ny"], &["nz"]];
const UV: [&[&str]; 2] = [&["u", "s", "texture_u"], &["v", "t", "texture_v"]];
const COLOR: &[&str] = &["red", "r", "diffuse_red"];
const CORNERS: &[&str] = &["vertex_indices", "vertex_index"];

/// Where the numbers of a vertex stand that are used.
struct Columns {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    uv: Option<[usize; 2]>,
}

impl Columns {
    fn of(element: &Element, source: &Source<'_>) -> Result<Self, Diagnostic> {
        let [x, y, z] = POSITION.map(|names| element.find(names));
        let (Some(x), Some(y), Some(z)) = (x, y, z) else {
            let error = Diagnostic::error(ErrorKind::Input, "the vertices have no properties x, y and z");
            return Err(error.at(source.name, 0, 0));
        };
        let normal = match NORMAL.map(|names| element.find(names)) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        let uv = match UV.map(|names| element.find(names)) {
            [Some(u), Some(v)] => Some([u, v]),
            _ => None,
        };
        let position = [x, y, z];
        let used = position
            .iter()
            .chain(normal.iter().flatten())
            .chain(uv.iter().flatten());
        let list = used
            .filter_map(|i| element.properties.get(*i))
            .find(|p| p.count.is_some());
        if let Some(list) = list {
            let message = format!(
                "the vertices' property {} is a list; expected a number",
                quoted(&list.name)
            );
            return Err(Diagnostic::error(ErrorKind::Input, message).at(source.name, 0, 0));
        }
        Ok(Self { position, normal, uv })
    }
}

fn elements<'a>(
    source: &Source<'a>,
    header: &Header,
    mut body: Body<'a>,
    assets: &Assets<'_>,
    builder: &mut Builder,
) -> Result<Mesh, Diagnostic> {
    let nowhere = |message: &str| Diagnostic::error(ErrorKind::Input, message).at(source.name, 0, 0);
    let vertices = header.elements.iter().find(|e| e.name == "vertex");
    let Some(vertices) = vertices else {
        return Err(nowhere("the file has no element 'vertex'"));
    };
    let is_faces = |e: &&Element| matches!(e.name.as_str(), "face" | "tristrips") && e.count > 0;
    if !header.elements.iter().any(|e| is_faces(&e)) {
        let error = nowhere("the file has no faces");
        return Err(
            error.hint("a mesh is made of an element 'face' with vertex_indices; points alone are not drawn")
        );
    }
    let columns = Columns::of(vertices, source)?;
    let mut reader = Reader {
        checked: Checked::default(),
        vertices: vertices.count,
        has_normals: columns.normal.is_some(),
        has_uvs: columns.uv.is_some(),
        triangles: 0,
        assets,
    };
    for element in header.elements.iter().filter(|e| !e.properties.is_empty()) {
        match element.name.as_str() {
            "vertex" => reader.vertices(&mut body, element, &columns)?,
            "face" | "tristrips" => reader.faces(&mut body, element)?,
            _ => {
                for index in 0..element.count {
                    reader.ask(index)?;
                    let item = Item { element, index };
                    body.begin(item)?;
                    for property in &element.properties {
                        body.skip(property, item)?;
                    }
                    body.end(item)?;
                }
            }
        }
    }
    let mut checked = reader.checked;
    let mut unused = Ignored::default();
    if vertices.find(COLOR).is_some() {
        unused.colors.add(source.text.get(..0).unwrap_or_default());
    }
    let colors = |_| "the colors of the vertices are not used".to_owned();
    checked.unused = Ignored::default();
    let mesh = assembly::mesh(source, checked, assets, builder)?;
    unused.colors.warn(source, builder, colors, None);
    Ok(mesh)
}

struct Reader<'a, 's> {
    checked: Checked<'a>,
    /// How many the header says there are.
    vertices: usize,
    has_normals: bool,
    has_uvs: bool,
    triangles: usize,
    assets: &'s Assets<'s>,
}

impl<'a> Reader<'a, '_> {
    fn ask(&self, index: usize) -> Result<(), Diagnostic> {
        if index % ELEMENTS_PER_QUESTION == ELEMENTS_PER_QUESTION - 1 {
            self.assets.check_stop()?;
        }
        Ok(())
    }

    fn vertices(
        &mut self,
        body: &mut Body<'a>,
        element: &Element,
        columns: &Columns,
    ) -> Result<(), Diagnostic> {
        let room = body.room_for(element);
        self.checked.positions.reserve(room);
        let mut values = vec![0.0; element.properties.len()];
        for index in 0..element.count {
            self.ask(index)?;
            let item = Item { element, index };
            body.begin(item)?;
            for (property, value) in element.properties.iter().zip(&mut values) {
                match property.count {
                    Some(_) => body.skip(property, item)?,
                    None => *value = body.number(property.kind, item, &property.name)?,
                }
            }
            body.end(item)?;
            let at = |i: usize| values.get(i).copied().unwrap_or(0.0);
            self.checked
                .positions
                .push(DVec3::from_array(columns.position.map(at)));
            if let Some(normal) = columns.normal {
                self.checked.normals.push(DVec3::from_array(normal.map(at)));
            }
            if let Some(uv) = columns.uv {
                self.checked.uvs.push(DVec2::from_array(uv.map(at)));
            }
        }
        Ok(())
    }

    fn faces(&mut self, body: &mut Body<'a>, element: &Element) -> Result<(), Diagnostic> {
        let corners = element.find(CORNERS);
        let is_list = |i: &usize| element.properties.get(*i).is_some_and(|p| p.count.is_some());
        let Some(corners) = corners.filter(is_list) else {
            let what = quoted(&element.name);
            return Err(body.nowhere(format!("element {what} has no list 'vertex_indices'")));
        };
        let is_strip = element.name == "tristrips";
        let mut indices = Vec::new();
        for index in 0..element.count {
            self.ask(index)?;
            let item = Item { element, index };
            body.begin(item)?;
            for (i, property) in element.properties.iter().enumerate() {
                let Some(kind) = property.count.filter(|_| i == corners) else {
                    body.skip(property, item)?;
                    continue;
                };
                let count = body.count(property, kind, item)?;
                indices.clear();
                indices.reserve(count);
                for _ in 0..count {
                    let value = body.number(property.kind, item, &property.name)?;
                    indices.push(self.index(body, value, item, is_strip)?);
                }
            }
            body.end(item)?;
            if is_strip {
                self.strips(body, &indices)?;
            } else if indices.len() < 3 {
                let n = indices.len();
                return Err(body.error(format!("{item} has {n} corners; expected 3 or more")));
            } else {
                self.face(body, &indices)?;
            }
        }
        Ok(())
    }

    /// The number of a vertex; `u32::MAX` for the -1 that ends a strip.
    fn index(&self, body: &Body<'_>, value: f64, item: Item<'_>, is_strip: bool) -> Result<u32, Diagnostic> {
        if is_strip && value == -1.0 {
            return Ok(Corner::NONE);
        }
        if value < 0.0 || value.fract() != 0.0 || !(value < self.vertices.min(Corner::NONE as usize) as f64) {
            return Err(body.error(format!(
                "expected the number of a vertex below {}, counted from 0, found {value} in {item}",
                self.vertices
            )));
        }
        Ok(value as u32)
    }

    fn face(&mut self, body: &Body<'a>, indices: &[u32]) -> Result<(), Diagnostic> {
        self.triangles = self.triangles.saturating_add(indices.len().saturating_sub(2));
        let most = self.assets.limits().primitives;
        if self.triangles > most {
            let error = SceneError::limit("too many triangles", "primitives", most);
            let message = body.error(String::new());
            return Err(Diagnostic {
                file: message.file,
                line: message.line,
                ..error.into()
            });
        }
        let value = |has: bool, i: u32| if has { i } else { Corner::NONE };
        self.checked.corners.extend(indices.iter().map(|&i| Corner {
            position: i,
            uv: value(self.has_uvs, i),
            normal: value(self.has_normals, i),
        }));
        self.checked.faces.push(Face {
            at: body.place(),
            material: None,
            end: self.checked.corners.len(),
        });
        Ok(())
    }

    /// Triangles of strips: every other one runs the other way round.
    fn strips(&mut self, body: &Body<'a>, indices: &[u32]) -> Result<(), Diagnostic> {
        for strip in indices.split(|i| *i == Corner::NONE) {
            for (k, w) in strip.windows(3).enumerate() {
                if let [a, b, c] = *w {
                    let face = if k % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    self.face(body, &face)?;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        Builder, Limits, MemoryHost,
        diag::Diagnostic,
        import::{AssetCache, Assets, load_mesh},
        scene::Mesh,
    };

    fn load(bytes: &[u8]) -> Result<Mesh, Diagnostic> {
        let (host, limits) = (MemoryHost::new().with("a.ply", bytes), Limits::default());
        let mut cache = AssetCache::default();
        let mut assets = Assets::new(&host, &limits, &mut cache);
        load_mesh("a.ply", &mut assets, &mut Builder::new()).map(|mesh| Mesh::clone(&mesh))
    }

    /// A quad with normals and texture coordinates in a format, and an element that nobody knows before it.
    fn quad(format: &str, end: &str) -> Vec<u8> {
        let head = [
            "ply",
            &format!("format {format} 1.0"),
            "comment \u{e9}",
            "element thing 2",
            "property list uchar short stuff",
            "element vertex 4",
            "property float x",
            "property float y",
            "property double z",
            "property char nx",
            "property char ny",
            "property char nz",
            "property float u",
            "property float v",
            "element face 1",
            "property list ushort int vertex_indices",
            "property uint flags",
            "end_header",
            "",
        ];
        let mut bytes = head.join(end).into_bytes();
        let vertices = [(0i8, 0i8), (2, 0), (2, 1), (0, 1)];
        if format == "ascii" {
            let mut lines = vec!["2 7 -7".to_owned(), "0".to_owned()];
            lines.extend(vertices.map(|(x, y)| format!("{x} {y}.5 -1 0 0 1 {x} {y}")));
            lines.push("4 0 1 2 3 9".to_owned());
            bytes.extend(lines.join(end).into_bytes());
            return bytes;
        }
        let big = format == "binary_big_endian";
        macro_rules! put {
            ($($x:expr),*) => { $( bytes.extend(if big { $x.to_be_bytes().to_vec() } else { $x.to_le_bytes().to_vec() }); )* };
        }
        put!(2u8, 7i16, -7i16, 0u8);
        for (x, y) in vertices {
            put!(
                f32::from(x),
                f32::from(y) + 0.5,
                -1f64,
                0i8,
                0i8,
                1i8,
                f32::from(x),
                f32::from(y)
            );
        }
        put!(4u16, 0i32, 1i32, 2i32, 3i32, 9u32);
        bytes
    }

    #[test]
    fn every_format_gives_the_same_mesh() {
        let first = load(&quad("ascii", "\n")).unwrap();
        assert_eq!(first.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(first.bounds().max.to_array(), [2.0, 1.5, -1.0]);
        assert_eq!(
            first.normals.as_ref().unwrap().corners(1).unwrap()[2].to_array(),
            [0.0, 0.0, 1.0]
        );
        assert_eq!(
            first.uvs.as_ref().unwrap().corners(0).unwrap()[1].to_array(),
            [2.0, 0.0]
        );
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            for end in ["\n", "\r\n", "\r"] {
                assert_eq!(load(&quad(format, end)).unwrap(), first, "{format} {end:?}");
            }
        }
    }

    #[test]
    fn strips_are_triangles_that_face_one_way() {
        let strip = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
            element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
            0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 1 2\n";
        let mesh = load(strip.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [0, 1, 2]]);
    }

    #[test]
    fn whatever_is_cut_off_or_changed_ends_with_an_answer() {
        let mut rng = 12345u64;
        let mut below = |n: usize| {
            rng = rng
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (rng >> 33) as usize % n
        };
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            let whole = quad(format, "\n");
            // The last of its numbers is not needed as text, where it is shortened.
            for end in 0..whole.len() - 1 {
                assert!(load(&whole[..end]).is_err(), "{format} up to {end}");
            }
            for _ in 0..2000 {
                let mut bytes = whole.clone();
                for _ in 0..1 + below(4) {
                    let at = below(bytes.len());
                    bytes[at] = below(256) as u8;
                }
                if let Err(error) = load(&bytes) {
                    assert!(!error.message.is_empty() && error.message.len() < 4096);
                }
            }
        }
    }

    #[test]
    fn claims_take_neither_memory_nor_time() {
        let head = |count: &str, properties: &str| {
            format!(
                "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
                 property float z\nelement face 4000000000\n{properties}end_header\n\0\0\0@\0\0\0\0"
            )
        };
        let list = "property list uint int vertex_indices\n";
        for (text, said) in [
            (
                head("4294967295", list),
                "the file ends at byte 186, in 'vertex' 1 of 4294967295",
            ),
            (
                head("0", list),
                "'vertex_indices' in 'face' 1 of 4000000000 is to have 1073741824 numbers, but there are at most 1, before byte 174",
            ),
            (head("0", ""), "no face of the file has an area"),
            (
                head("99999999999999999999999", list),
                "expected how many there are, found '99999999999999999999999'",
            ),
        ] {
            let message = load(text.as_bytes()).unwrap_err().message;
            let plain = |text: &str| {
                text.split(|c: char| c.is_ascii_digit())
                    .next()
                    .unwrap_or_default()
                    .to_owned()
            };
            assert_eq!(plain(&message), plain(said), "{message}");
        }
    }
}
