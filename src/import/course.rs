//! The scene format of the ray-tracing homework of UCSD CSE167 and edX CSE167x (Ravi Ramamoorthi).

use super::{
    command::Command,
    text::{Source, counted, lines, words},
};
use crate::{
    diag::{Code, Diagnostic, ErrorKind, SourceLoc},
    math::DVec3,
    scene::{Builder, Camera, Encoding, SceneError, Term, Told},
};

/// What a scene file of the course says beyond the scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Course {
    /// The name after the last `output`: where the picture was meant to go.
    pub output: Option<String>,
}

/// Builds the scene of a file in the course's format, `source`, called `name` in messages.
///
/// One command a line; `#` begins a comment. The builder should be fresh: the format's defaults are the
/// builder's. Sets the encoding to raw. The current matrix acts where a `tri`, `trinormal` or `sphere` stands,
/// not where its vertices are listed; lights stand under the current matrix as in OpenGL; point lights keep the
/// attenuation in force when they are made. Of several `size`, `camera` or `output` lines the last counts.
/// A file may end without its last `popTransform`: the course's own scenes do.
///
/// # Errors
/// An unknown command, a wrong number of values, a value that is no finite number, a vertex that is not
/// listed yet, or whatever the [`Builder`] refuses; with file, line and column.
///
/// ```
/// use rtscript::{Builder, import::{Course, load_course}};
/// let text = "size 64 48\noutput ball.png\ncamera 0 0 4 0 0 0 0 1 0 45\nsphere 0 0 0 1\n";
/// let mut b = Builder::new();
/// let Course { output, .. } = load_course("ball.test", text, &mut b).map_err(rtscript::Error::from)?;
/// assert_eq!(output.as_deref(), Some("ball.png"));
/// assert_eq!(b.finish().value.root().objects.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load_course(name: &str, source: &str, builder: &mut Builder) -> Result<Course, Diagnostic> {
    let source = Source::new(name, source, ErrorKind::Input);
    let mut loader = Loader {
        file: builder.file(name),
        source,
        builder,
        vertices: Vec::new(),
        smooth_vertices: Vec::new(),
        pushes: 0,
        has_size: false,
        has_camera: false,
        course: Course::default(),
    };
    loader.load()?;
    Ok(loader.course)
}

/// Commands after line `last` that cannot be read, at most nine: what else is wrong with a file whose first error is
/// there.
///
/// ```
/// use rtscript::{Builder, import::{further_course_errors, load_course}};
/// let text = "size 64\nsphere 0 0 0 1\nsphere 0 0\n";
/// let first = load_course("ball.test", text, &mut Builder::new()).unwrap_err();
/// let more = further_course_errors("ball.test", text, first.line);
/// assert_eq!((first.line, more[0].line), (1, 3));
/// ```
#[must_use]
pub fn further_errors(name: &str, source: &str, last: u32) -> Vec<Diagnostic> {
    const MOST: usize = 9;
    let source = Source::new(name, source, ErrorKind::Input);
    lines(source.text)
        .skip(last as usize)
        .filter_map(|line| Command::parse(&source, line).err())
        .take(MOST)
        .collect()
}

struct Loader<'a, 'b> {
    file: u16,
    source: Source<'a>,
    builder: &'b mut Builder,
    /// The list of `vertex`.
    vertices: Vec<DVec3>,
    /// The list of `vertexnormal`: position and normal.
    smooth_vertices: Vec<(DVec3, DVec3)>,
    /// Matrices saved and not yet restored.
    pushes: usize,
    has_size: bool,
    has_camera: bool,
    course: Course,
}

impl Loader<'_, '_> {
    fn load(&mut self) -> Result<(), Diagnostic> {
        self.builder.encoding(Encoding::Raw);
        for (number, line) in (1u32..).zip(lines(self.source.text)) {
            let Some((word, command)) = Command::parse(&self.source, line)? else {
                continue;
            };
            let column = line.len() - line.trim_ascii_start().len() + 1;
            self.builder.set_loc(SourceLoc {
                line: number,
                column: u16::try_from(column).unwrap_or(u16::MAX),
                file: self.file,
            });
            self.run(command).map_err(|fault| {
                let value = fault.value.and_then(|place| words(line).nth(1 + place));
                self.source.place(fault.error.into(), value.unwrap_or(word))
            })?;
        }
        self.builder.set_loc(SourceLoc {
            file: self.file,
            ..SourceLoc::default()
        });
        // Nothing follows that a matrix left over could act on.
        for _ in 0..self.pushes {
            let restored = self.builder.pop_transform();
            debug_assert!(restored.is_ok());
        }
        if !self.has_size {
            self.builder.warn(
                Code::IgnoredInput,
                "the picture has no size, so it is 640 x 480",
                Some("begin the file with: size 640 480"),
            );
        }
        if !self.has_camera {
            self.builder.warn(
                Code::IgnoredInput,
                "there is no camera, so it stands at 0 0 5 and looks at the origin",
                Some("write: camera eyex eyey eyez centerx centery centerz upx upy upz fovy"),
            );
        }
        Ok(())
    }

    fn run(&mut self, command: Command<'_>) -> Result<(), Fault> {
        let builder = &mut *self.builder;
        let told = Told::default();
        match command {
            Command::Size(width, height) => {
                self.has_size = true;
                builder
                    .size(told.count(width), told.count(height))
                    .map_err(|error| told.as_given(error))?;
            }
            Command::MaxDepth(n) => builder
                .max_depth(told.count(n))
                .map_err(|error| told.as_given(error))?,
            Command::Output(name) => self.course.output = Some(name.to_owned()),
            Command::Camera { eye, at, up, fovy } => {
                self.has_camera = true;
                builder.camera(Camera::new(eye, at, up, fovy)?);
            }
            Command::Sphere(center, radius) => builder.sphere(center, radius)?,
            Command::Capacity => {}
            Command::Vertex(position) => self.vertices.push(position),
            Command::VertexNormal(position, normal) => self.smooth_vertices.push((position, normal)),
            Command::Tri(indices) => {
                let [a, b, c] = each(indices, |i| listed(&self.vertices, i, "vertex"))?;
                builder.triangle([a, b, c], None)?;
            }
            Command::TriNormal(indices) => {
                let [a, b, c] = each(indices, |i| smooth(&self.smooth_vertices, i))?;
                builder.triangle([a.0, b.0, c.0], Some([a.1, b.1, c.1]))?;
            }
            Command::Translate(by) => builder.translate(by)?,
            Command::Rotate(axis, degrees) => builder.rotate(axis, degrees)?,
            Command::Scale(by) => builder.scale(by)?,
            Command::PushTransform => {
                builder.push_transform()?;
                self.pushes += 1;
            }
            Command::PopTransform => {
                builder.pop_transform()?;
                self.pushes = self.pushes.saturating_sub(1);
            }
            Command::Directional(direction, color) => builder.directional(direction, color)?,
            Command::Point(position, color) => builder.point(position, color)?,
            Command::Attenuation(attenuation) => builder.attenuation(attenuation)?,
            Command::Ambient(color) => builder.material_mut().ambient = Term::color(color),
            Command::Diffuse(color) => builder.material_mut().diffuse = Term::color(color),
            Command::Specular(color) => builder.material_mut().specular = Term::color(color),
            Command::Shininess(exponent) => builder.material_mut().shininess = exponent,
            Command::Emission(color) => builder.material_mut().emission = Term::color(color),
        }
        Ok(())
    }
}

/// What is wrong with a command, and which of its values is to blame, where one is.
struct Fault {
    error: SceneError,
    value: Option<usize>,
}

impl From<SceneError> for Fault {
    fn from(error: SceneError) -> Self {
        Self { error, value: None }
    }
}

/// What is listed under the numbers of three vertices.
fn each<T>(indices: [usize; 3], listed: impl Fn(usize) -> Result<T, SceneError>) -> Result<[T; 3], Fault> {
    let [a, b, c] = indices;
    let at = |place: usize, index: usize| {
        listed(index).map_err(|error| Fault {
            error,
            value: Some(place),
        })
    };
    Ok([at(0, a)?, at(1, b)?, at(2, c)?])
}

/// Entry `index` of the list that the command `what` fills.
fn listed<T: Copy>(list: &[T], index: usize, what: &str) -> Result<T, SceneError> {
    list.get(index).copied().ok_or_else(|| {
        let error = malformed(format!(
            "there is no {what} {index}: {} before this line",
            counted(
                list.len(),
                &format!("{what} comes"),
                &format!("{what} lines come")
            ),
        ));
        match (list.len(), what) {
            (0, "vertex") => {
                error.hint("trinormal takes the vertices of vertexnormal lines, tri those of vertex lines")
            }
            (0, _) => {
                error.hint("tri takes the vertices of vertex lines, trinormal those of vertexnormal lines")
            }
            (n, _) => error.hint(format!("they are counted from 0, so the last is {}", n - 1)),
        }
    })
}

fn smooth(list: &[(DVec3, DVec3)], index: usize) -> Result<(DVec3, DVec3), SceneError> {
    let vertex = listed(list, index, "vertexnormal")?;
    if vertex.1 == DVec3::ZERO {
        let error = malformed(format!("the normal of vertexnormal {index} is zero"));
        return Err(error.hint("a normal is a direction: vertexnormal x y z nx ny nz"));
    }
    Ok(vertex)
}

/// A fault of the file itself, where what the builder refuses is a fault of the scene.
fn malformed(message: String) -> SceneError {
    SceneError {
        kind: ErrorKind::Input,
        code: Code::MalformedFile,
        ..SceneError::new(message)
    }
}
