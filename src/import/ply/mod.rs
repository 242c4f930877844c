//! PLY meshes (Turk, "The PLY polygon file format", 1994): ascii, and binary of both byte orders.

mod body;
mod header;

use self::{
    body::{Body, Item},
    header::{Element, Format, Header, Scalar},
};
use super::{
    assembly,
    assets::Assets,
    guard::{Checked, Corner, Face},
    text::{Source, lines, quoted},
    wavefront,
};
use crate::{
    color::{Color, linear_from_srgb},
    diag::{Diagnostic, ErrorKind},
    math::{DVec2, DVec3},
    scene::{Builder, Mesh, SceneError},
};

/// Bytes in which a header ends.
const LONGEST_HEADER: usize = 1 << 16;
/// The largest number of a color that is no share of a whole.
const BRIGHTEST: f64 = 1e6;
/// Elements between two questions whether to stop: a millisecond's work.
const ELEMENTS_PER_QUESTION: usize = 4096;

/// Whether a file says that it is a PLY file.
pub(super) fn is_ply(bytes: &[u8]) -> bool {
    matches!(bytes, [b'p', b'l', b'y', b'\n' | b'\r', ..])
}

/// The mesh in a PLY file: polygons, cut into triangles, or triangle strips; with the vertices' normals and texture
/// coordinates and colors. Warnings, such as that a face has no area, go to the builder.
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
const COLOR: [&[&str]; 3] = [
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
];
const CORNERS: &[&str] = &["vertex_indices", "vertex_index"];

/// Where the numbers of a vertex stand that are used.
struct Columns {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    uv: Option<[usize; 2]>,
    color: Option<Channels>,
}

/// Where the color of a vertex stands, and of which type its numbers are.
struct Channels {
    places: [usize; 3],
    kinds: [Scalar; 3],
}

impl Channels {
    /// `None` where no property is one of a color.
    ///
    /// # Errors
    /// Where one of them is missing.
    fn of(element: &Element, source: &Source<'_>) -> Result<Option<Self>, Diagnostic> {
        let found = COLOR.map(|names| element.find(names));
        let [Some(r), Some(g), Some(b)] = found else {
            let missing = COLOR.iter().zip(found).find(|(_, place)| place.is_none());
            let first = found.into_iter().flatten().next();
            let first = first.and_then(|place| element.properties.get(place));
            return match (missing.and_then(|(names, _)| names.first()), first) {
                // A property r may be a radius.
                (Some(name), Some(first)) if first.name.len() > 1 => {
                    let message = format!(
                        "the vertices have a property {}, but none called '{name}'; a color takes red, green and blue",
                        quoted(&first.name)
                    );
                    let line = declared(source, element, Some(&first.name));
                    let hint = format!("add a property '{name}', or leave out the others of the color");
                    Err(source.error(line, message).hint(hint))
                }
                _ => Ok(None),
            };
        };
        let places = [r, g, b];
        let kinds = places.map(|place| element.properties.get(place).map_or(Scalar::U8, |p| p.kind));
        Ok(Some(Self { places, kinds }))
    }

    /// The scene-linear color: whole numbers are sRGB, as in pictures, others are linear.
    fn color(&self, values: &[f64], body: &Body<'_>, item: Item<'_>) -> Result<Color, Diagnostic> {
        let mut color = [0.0; 3];
        for ((place, kind), channel) in self.places.iter().zip(self.kinds).zip(&mut color) {
            let value = values.get(*place).copied().unwrap_or(0.0);
            let full = kind.full();
            let most = full.unwrap_or(BRIGHTEST);
            if !(0.0..=most).contains(&value) {
                let name = item.element.properties.get(*place).map_or("", |p| &p.name);
                return Err(body.error(format!(
                    "expected a number from 0 to {most} for {} in {item}, found {value}",
                    quoted(name)
                )));
            }
            *channel = full.map_or(value, |full| linear_from_srgb(value / full));
        }
        Ok(Color::from_array(color))
    }
}

impl Columns {
    fn of(element: &Element, source: &Source<'_>) -> Result<Self, Diagnostic> {
        let [x, y, z] = POSITION.map(|names| element.find(names));
        let (Some(x), Some(y), Some(z)) = (x, y, z) else {
            let error = source.error(
                declared(source, element, None),
                "the vertices have no properties x, y and z",
            );
            return Err(
                error.hint("expected the lines: property float x, property float y, property float z")
            );
        };
        let normal = match NORMAL.map(|names| element.find(names)) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        let uv = match UV.map(|names| element.find(names)) {
            [Some(u), Some(v)] => Some([u, v]),
            _ => None,
        };
        let color = Channels::of(element, source)?;
        let position = [x, y, z];
        let used = position
            .iter()
            .chain(normal.iter().flatten())
            .chain(uv.iter().flatten())
            .chain(color.iter().flat_map(|color| &color.places));
        let list = used
            .filter_map(|i| element.properties.get(*i))
            .find(|p| p.count.is_some());
        if let Some(list) = list {
            let message = format!(
                "the vertices' property {} is a list; expected a number",
                quoted(&list.name)
            );
            let error = source.error(declared(source, element, Some(&list.name)), message);
            return Err(error.hint(format!("write: property float {}", list.name)));
        }
        Ok(Self {
            position,
            normal,
            uv,
            color,
        })
    }
}

/// The line of the header that declares an element, or a property of it.
fn declared<'a>(source: &Source<'a>, element: &Element, property: Option<&str>) -> &'a str {
    let mut lines = lines(source.text);
    let begins = |line: &&str| {
        let mut words = line.split_ascii_whitespace();
        words.next() == Some("element") && words.next() == Some(element.name.as_str())
    };
    let line = lines.find(begins).unwrap_or(source.text);
    let Some(property) = property else {
        return line;
    };
    let is_it = |line: &&str| line.split_ascii_whitespace().next_back() == Some(property);
    lines.find(is_it).unwrap_or(line)
}

/// The line that ends the header.
fn end_of<'a>(source: &Source<'a>) -> &'a str {
    let mut lines = lines(source.text);
    let end = lines.find(|line| line.trim_ascii() == "end_header");
    end.unwrap_or(source.text)
}

fn elements<'a>(
    source: &Source<'a>,
    header: &Header,
    mut body: Body<'a>,
    assets: &Assets<'_>,
    builder: &mut Builder,
) -> Result<Mesh, Diagnostic> {
    let vertices = header.elements.iter().find(|e| e.name == "vertex");
    let Some(vertices) = vertices else {
        let error = source.error(end_of(source), "the file has no element 'vertex'");
        return Err(error
            .hint("expected the line 'element vertex' with their number, and their properties x, y and z"));
    };
    let is_faces = |e: &&Element| matches!(e.name.as_str(), "face" | "tristrips") && e.count > 0;
    if !header.elements.iter().any(|e| is_faces(&e)) {
        let empty = header
            .elements
            .iter()
            .find(|e| matches!(e.name.as_str(), "face" | "tristrips"));
        let line = empty.map_or_else(|| end_of(source), |e| declared(source, e, None));
        let error = source.error(line, "the file has no faces");
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
            "face" | "tristrips" => reader.faces(source, &mut body, element)?,
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
    assembly::mesh(source, reader.checked, assets, builder)
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
            if let Some(color) = &columns.color {
                let color = color.color(&values, body, item)?;
                self.checked.colors.push(color);
            }
        }
        Ok(())
    }

    fn faces(
        &mut self,
        source: &Source<'_>,
        body: &mut Body<'a>,
        element: &Element,
    ) -> Result<(), Diagnostic> {
        let corners = element.find(CORNERS);
        let is_list = |i: &usize| element.properties.get(*i).is_some_and(|p| p.count.is_some());
        let Some(corners) = corners.filter(is_list) else {
            let message = format!("element {} has no list 'vertex_indices'", quoted(&element.name));
            let error = source.error(declared(source, element, None), message);
            return Err(error.hint("write: property list uchar int vertex_indices"));
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
                let error = body.error(format!("{item} has {n} corners; expected 3 or more"));
                return Err(error.hint("lines and points are no faces: leave them out"));
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
mod tests;
