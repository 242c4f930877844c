//! Values of the script that Rhai does not have: textures, and the error a scene function raises.

use std::{fmt, sync::Arc};

use rhai::{Dynamic, EvalAltResult, Position};

use crate::{
    color::Color,
    diag::{Code, Diagnostic, ErrorKind},
    host::HostError,
    scene::{ImageTexture, SceneError, Texture},
};

/// A picture in a script: what `image("x.png")` and `render()` return.
#[derive(Clone, Debug)]
pub(crate) struct ImageValue(Arc<Texture>);

impl ImageValue {
    pub(crate) fn new(image: ImageTexture) -> Self {
        Self(Arc::new(Texture::Image(image)))
    }

    /// The picture, where `texture` is one.
    pub(crate) fn of(texture: &Arc<Texture>) -> Option<Self> {
        matches!(**texture, Texture::Image(_)).then(|| Self(Arc::clone(texture)))
    }

    pub(crate) fn texture(&self) -> &Arc<Texture> {
        &self.0
    }

    pub(crate) fn image(&self) -> Option<&ImageTexture> {
        match &*self.0 {
            Texture::Image(image) => Some(image),
            _ => None,
        }
    }
}

impl fmt::Display for ImageValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.image() {
            Some(i) => write!(f, "image({} x {})", i.width, i.height),
            None => write!(f, "image"),
        }
    }
}

/// A texture in a script, times a color: what `checker(...)` and `image * 0.5` return.
#[derive(Clone, Debug)]
pub(crate) struct TextureValue {
    pub(crate) texture: Arc<Texture>,
    pub(crate) tint: Color,
}

impl fmt::Display for TextureValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &*self.texture {
            Texture::Image(i) => write!(f, "texture({} x {})", i.width, i.height),
            Texture::Checker { size, .. } => write!(f, "texture(checker, {size})"),
            Texture::Custom(texture) => write!(f, "texture({})", texture.identity()),
            Texture::Pattern(pattern) => write!(f, "texture({})", pattern.pattern().kind.name()),
            Texture::Mix(_) => write!(f, "texture(mixed)"),
            Texture::Placed(_) => write!(f, "texture(placed)"),
            Texture::Mapped(_) => write!(f, "texture(image)"),
            Texture::VertexColors => write!(f, "texture(vertexColors)"),
        }
    }
}

/// What a scene function has to say against its arguments, without a place: the engine knows it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScriptError {
    pub(crate) kind: ErrorKind,
    pub(crate) code: Code,
    pub(crate) message: String,
    pub(crate) hints: Vec<String>,
    /// Where it was raised, once it was: Rhai forgets the place of what ends a run inside a function.
    pub(crate) place: Option<(Option<String>, Position)>,
    /// The error of a file that the script names, where that file is at fault: its place is there.
    pub(crate) of_file: Option<Box<Diagnostic>>,
}

/// The result of a scene function.
pub(crate) type Outcome<T = Dynamic> = Result<T, Box<ScriptError>>;

impl ScriptError {
    #[cold]
    pub(crate) fn new(message: impl Into<String>) -> Box<Self> {
        Self::of_kind(ErrorKind::Script, message)
    }

    #[cold]
    pub(crate) fn of_kind(kind: ErrorKind, message: impl Into<String>) -> Box<Self> {
        Box::new(Self {
            kind,
            code: kind.into(),
            message: message.into(),
            hints: Vec::new(),
            place: None,
            of_file: None,
        })
    }

    /// An error of a file. Without a place of its own it belongs to the call that names the file.
    #[cold]
    pub(crate) fn from_file(d: Diagnostic) -> Box<Self> {
        Box::new(Self {
            kind: d.kind,
            code: d.code,
            message: d.message.clone(),
            hints: d.hints.clone(),
            place: None,
            of_file: d.file.is_some().then(|| Box::new(d)),
        })
    }

    pub(crate) fn class(mut self: Box<Self>, code: Code) -> Box<Self> {
        self.code = code;
        self
    }

    pub(crate) fn hint(mut self: Box<Self>, hint: impl Into<String>) -> Box<Self> {
        self.hints.push(hint.into());
        self
    }

    /// As [`ScriptError::raise`], for a place known better than by the engine.
    #[cold]
    pub(crate) fn raise_in(mut self: Box<Self>, source: Option<&str>, pos: Position) -> Box<EvalAltResult> {
        self.place = Some((source.map(str::to_owned), pos));
        self.raise(pos)
    }

    /// As the engine carries it. What a script must not catch ends the run at once.
    #[cold]
    #[expect(clippy::boxed_local, reason = "errors travel in boxes")]
    pub(crate) fn raise(self: Box<Self>, pos: Position) -> Box<EvalAltResult> {
        let ends_the_run = matches!(
            self.kind,
            ErrorKind::Limit | ErrorKind::Cancelled | ErrorKind::Internal
        );
        let value = Dynamic::from(*self);
        Box::new(if ends_the_run {
            EvalAltResult::ErrorTerminated(value, pos)
        } else {
            EvalAltResult::ErrorRuntime(value, pos)
        })
    }
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl From<SceneError> for Box<ScriptError> {
    fn from(e: SceneError) -> Self {
        Self::new(ScriptError {
            kind: e.kind,
            code: e.code,
            message: e.message,
            hints: e.hint.into_iter().collect(),
            place: None,
            of_file: None,
        })
    }
}

impl From<HostError> for Box<ScriptError> {
    fn from(e: HostError) -> Self {
        ScriptError::from_file(e.diagnostic())
    }
}
