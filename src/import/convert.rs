//! From the course's scene format to a script that gives the same picture.

use super::{
    command::Command,
    course::load_course,
    text::{Source, lines},
};
use crate::{
    diag::{Diagnostic, ErrorKind},
    math::DVec3,
    scene::{
        Builder,
        literal::{Components, Number, Vector},
    },
};

/// Triangles in a row from which on they are written as a table and a loop.
const TABLE_FROM: usize = 24;
/// Width of a table's lines in characters.
const TABLE_WIDTH: usize = 100;

/// A script that builds the same scene, command by command, with the comments in their places.
///
/// Vertices become arrays where the first of them is listed. Numbers are written so that they read back as the
/// same bits. Comments that hold a command, as the spare cameras in the course's scenes do, become comments that
/// hold a call. The script renders to the name its user gives; an `output` line is kept as a comment.
///
/// # Errors
/// The same as [`load_course`]: what does not load is not converted.
///
/// ```
/// use rtscript::import::script_from_course;
/// let script = script_from_course("ball.test", "size 64 48\nsphere 0 0 0 1\n").map_err(rtscript::Error::from)?;
/// assert!(script.contains("sphere("));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn script_from_course(name: &str, source: &str) -> Result<String, Diagnostic> {
    load_course(name, source, &mut Builder::new())?;
    let source = Source::new(name, source, ErrorKind::Input);
    let mut script = Script::default();
    for line in lines(source.text) {
        match Command::parse(&source, line)? {
            Some((_, Command::Vertex(p))) => script.vertices.push(p),
            Some((_, Command::VertexNormal(p, n))) => script.smooth_vertices.push((p, n)),
            _ => {}
        }
    }
    script.line(&format!(
        "// {}, converted from the scene format of CSE167",
        name.replace(char::is_control, " ")
    ));
    script.line("encoding(\"raw\");");
    script.line("");
    for line in lines(source.text) {
        let command = Command::parse(&source, line)?.map(|(_, command)| command);
        script.command(command, comment(line));
    }
    script.flush_triangles();
    while script.pushes > 0 {
        script.pushes -= 1;
        script.line("popTransform();");
    }
    Ok(script.text)
}

/// The text of a line's comment.
fn comment(line: &str) -> Option<&str> {
    let mut at_word = true;
    for (i, c) in line.char_indices() {
        if c == '#' && at_word {
            return line.get(i + 1..).map(str::trim_end);
        }
        at_word = c.is_ascii_whitespace();
    }
    None
}

/// A script in the making.
#[derive(Default)]
struct Script {
    text: String,
    /// All vertices of the file. They do not depend on where they are listed, so one array holds them.
    vertices: Vec<DVec3>,
    smooth_vertices: Vec<(DVec3, DVec3)>,
    has_vertices: bool,
    has_smooth_vertices: bool,
    /// Triangles not written yet: many in a row make a table.
    triangles: Vec<[usize; 3]>,
    are_smooth: bool,
    /// Matrices saved and not yet restored.
    pushes: usize,
}

impl Script {
    fn line(&mut self, line: &str) {
        if !line.is_empty() {
            for _ in 0..self.pushes.min(8) {
                self.text.push_str("    ");
            }
            self.text.push_str(line);
        } else if self.text.ends_with("\n\n") {
            return;
        }
        self.text.push('\n');
    }

    fn command(&mut self, command: Option<Command<'_>>, comment: Option<&str>) {
        if let Some(Command::Tri(corners) | Command::TriNormal(corners)) = command {
            let is_smooth = matches!(command, Some(Command::TriNormal(_)));
            // Those before it are to be written as what they are.
            if is_smooth != self.are_smooth || comment.is_some() {
                self.flush_triangles();
            }
            self.are_smooth = is_smooth;
            if comment.is_none() {
                self.triangles.push(corners);
                return;
            }
        }
        self.flush_triangles();
        let comment = comment.map(commented);
        let line = match command {
            Some(Command::Tri(corners) | Command::TriNormal(corners)) => {
                Some(self.tri(corners.map(|i| i.to_string())))
            }
            Some(Command::Vertex(_)) => {
                self.list_vertices();
                None
            }
            Some(Command::VertexNormal(..)) => {
                self.list_smooth_vertices();
                None
            }
            Some(Command::Output(name)) => Some(format!("// output {name}")),
            Some(Command::PopTransform) => {
                self.pushes = self.pushes.saturating_sub(1);
                call(&Command::PopTransform)
            }
            Some(command) => call(&command),
            None => Some(String::new()),
        };
        match (line, comment) {
            (Some(line), Some(comment)) if line.is_empty() => self.line(&comment),
            (Some(line), Some(comment)) => self.line(&format!("{line} {comment}")),
            (Some(line), None) => self.line(&line),
            (None, Some(comment)) => self.line(&comment),
            (None, None) => {}
        }
        if command == Some(Command::PushTransform) {
            self.pushes += 1;
        }
    }

    fn list_vertices(&mut self) {
        if !self.has_vertices {
            self.has_vertices = true;
            let vertices = std::mem::take(&mut self.vertices);
            self.list("v", vertices);
        }
    }

    fn list_smooth_vertices(&mut self) {
        if !self.has_smooth_vertices {
            self.has_smooth_vertices = true;
            let (positions, normals) = std::mem::take(&mut self.smooth_vertices).into_iter().unzip();
            self.list("p", positions);
            self.list("n", normals);
        }
    }

    fn list(&mut self, name: &str, vectors: Vec<DVec3>) {
        self.line(&format!("let {name} = ["));
        for v in vectors {
            self.line(&format!("    {},", Vector(v)));
        }
        self.line("];");
    }

    fn flush_triangles(&mut self) {
        let triangles = std::mem::take(&mut self.triangles);
        if triangles.len() < TABLE_FROM {
            for corners in triangles {
                let line = self.tri(corners.map(|i| i.to_string()));
                self.line(&line);
            }
            return;
        }
        self.line("for t in [");
        let mut row = String::new();
        for [a, b, c] in triangles {
            let entry = format!("[{a}, {b}, {c}],");
            if !row.is_empty() && row.len() + entry.len() >= TABLE_WIDTH {
                self.line(&row);
                row.clear();
            }
            row.push_str(if row.is_empty() { "    " } else { " " });
            row.push_str(&entry);
        }
        self.line(&row);
        self.line("] {");
        let line = self.tri([0, 1, 2].map(|i| format!("t[{i}]")));
        self.line(&format!("    {line}"));
        self.line("}");
    }

    fn tri(&self, [a, b, c]: [String; 3]) -> String {
        if self.are_smooth {
            format!("tri(p[{a}], p[{b}], p[{c}], n[{a}], n[{b}], n[{c}]);")
        } else {
            format!("tri(v[{a}], v[{b}], v[{c}]);")
        }
    }
}

/// A comment as the script has it; where it holds a command, that command's call.
fn commented(text: &str) -> String {
    let source = Source::new("", text, ErrorKind::Input);
    if let Ok(Some((_, command))) = Command::parse(&source, text)
        && let Some(call) = call(&command)
    {
        return format!("// {call}");
    }
    // Three slashes, or two and an exclamation mark, would begin documentation.
    let space = if text.starts_with(['/', '!']) { " " } else { "" };
    format!("//{space}{text}")
}

/// The call that does what a command does, where the command stands for itself.
fn call(command: &Command<'_>) -> Option<String> {
    Some(match *command {
        Command::Size(width, height) => format!("size({width}, {height});"),
        Command::MaxDepth(n) => format!("maxDepth({n});"),
        Command::Camera { eye, at, up, fovy } => {
            format!(
                "camera({}, {}, {}, {});",
                Vector(eye),
                Vector(at),
                Vector(up),
                Number(fovy)
            )
        }
        Command::Sphere(center, radius) => format!("sphere({}, {});", Vector(center), Number(radius)),
        Command::Translate(by) => format!("translate({});", Components(by)),
        Command::Rotate(axis, degrees) => format!("rotate({}, {});", Vector(axis), Number(degrees)),
        Command::Scale(by) => format!("scale({});", Components(by)),
        Command::PushTransform => "pushTransform();".to_owned(),
        Command::PopTransform => "popTransform();".to_owned(),
        Command::Directional(direction, color) => {
            format!("directional({}, {});", Vector(direction), Vector(color))
        }
        Command::Point(position, color) => format!("point({}, {});", Vector(position), Vector(color)),
        Command::Attenuation(a) => format!(
            "attenuation({}, {}, {});",
            Number(a.constant),
            Number(a.linear),
            Number(a.quadratic)
        ),
        Command::Ambient(color) => format!("ambient({});", Components(color)),
        Command::Diffuse(color) => format!("diffuse({});", Components(color)),
        Command::Specular(color) => format!("specular({});", Components(color)),
        Command::Shininess(exponent) => format!("shininess({});", Number(exponent)),
        Command::Emission(color) => format!("emission({});", Components(color)),
        Command::Output(_)
        | Command::Capacity
        | Command::Vertex(_)
        | Command::VertexNormal(..)
        | Command::Tri(_)
        | Command::TriNormal(_) => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_begin_where_a_word_begins() {
        assert_eq!(comment("# a"), Some(" a"));
        assert_eq!(comment("sphere 0 0 0 1 # a # b  "), Some(" a # b"));
        assert_eq!(comment("output a#b.png"), None);
        assert_eq!(comment("\t#"), Some(""));
    }

    #[test]
    fn comments_stay_comments() {
        assert_eq!(commented(" hello"), "// hello");
        assert_eq!(
            commented("camera 0 0 4 0 0 0 0 1 0 30"),
            "// camera([0, 0, 4], [0, 0, 0], [0, 1, 0], 30);"
        );
        assert_eq!(commented(" point of the scene"), "// point of the scene");
        assert_eq!(commented("tri 0 1 2"), "//tri 0 1 2");
        assert_eq!(commented("// x"), "// // x");
        assert_eq!(commented("!x"), "// !x");
        assert_eq!(commented(""), "//");
    }
}
