//! A name for each class of errors and warnings, which tests, editors and searches can rely on where the words of a
//! message may change.

use super::ErrorKind;

macro_rules! codes {
    ($($variant:ident $name:literal $severity:ident $explanation:literal)*) => {
        /// The class of a [`Diagnostic`](super::Diagnostic). Names and meanings stay; classes may be added.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Code {
            $(#[doc = $explanation] $variant,)*
        }

        impl Code {
            /// All classes: errors, then warnings.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The name: lower case, words joined by hyphens.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// What it means and what to do about it, in a few sentences.
            ///
            /// ```
            /// use rtscript::diag::Code;
            /// // What `rtscript explain no-light` prints.
            /// let code = Code::from_name("no-light").expect("there is such a class");
            /// assert_eq!(code, Code::NoLight);
            /// assert!(!code.explanation().is_empty());
            /// ```
            #[must_use]
            pub const fn explanation(self) -> &'static str {
                match self { $(Self::$variant => $explanation,)* }
            }

            /// Whether such a diagnostic ends the run or is a warning.
            #[must_use]
            pub const fn severity(self) -> super::Severity {
                match self { $(Self::$variant => super::Severity::$severity,)* }
            }
        }
    };
}

codes! {
    Syntax "syntax" Error "The text is not a script: something stands where the language has no place for it. Often a ';', a ',' or a bracket is missing just before the place shown."
    Unclosed "unclosed" Error "A bracket, a brace or a string is opened and never closed. The place shown is where the text ends; what was opened is above it."
    ReservedWord "reserved-word" Error "The word belongs to the language, or is kept for it, and cannot name anything. Choose another name."
    NotAvailable "not-available" Error "Rhai has it, scene scripts do not: it could reach the world outside, or give other results on other machines."
    UnknownFunction "unknown-function" Error "No function has this name. `rtscript help` lists those of the language, and `fn name(x) { }` defines your own."
    UnknownVariable "unknown-variable" Error "No variable has this name here. Declare it by `let name = value;` before. A function sees its parameters and what it declares itself; what stands outside of it only as `global::NAME`, of a `const`."
    UnknownModule "unknown-module" Error "No module is imported under this name. `import \"file\" as name;` reads file.rhai beside the script."
    UnknownProperty "unknown-property" Error "The value has no property of this name. Vectors have .x .y .z, images .width and .height; maps have what was put into them."
    UnknownKey "unknown-key" Error "The options of this function have no entry of this name. The message lists those that there are."
    UnknownGroup "unknown-group" Error "`instance(name)` places what `define name { }` made before. No group of this name is defined above the call."
    UnknownParameter "unknown-parameter" Error "A value was given by -D to a parameter that the script does not declare by `param(name, default)`."
    DuplicateFunction "duplicate-function" Error "Two functions have one name and the same number of parameters. Rename one of them, or let one do both."
    ArgumentCount "argument-count" Error "The function takes another number of arguments. `rtscript help NAME` shows its forms."
    ArgumentType "argument-type" Error "An argument is of another kind than the function takes there: a string for a number, a number for a vector. Whole numbers and fractions are never told apart."
    InvalidValue "invalid-value" Error "A value is of the right kind, but out of the range in which it means something: a negative radius, a picture of no pixels, an axis of no length."
    NotFinite "not-finite" Error "A number is infinite or NaN. Infinity comes from a division by 0.0, NaN from 0.0 / 0.0 or the root of a negative number."
    OperandTypes "operand-types" Error "The operator does not work between these two. An array does not calculate: vec3(x, y, z) does."
    Arithmetic "arithmetic" Error "A calculation with whole numbers has no result: a division by 0, or a number beyond 63 bits. Fractions (1.0 / x) have no such end."
    IndexRange "index-range" Error "There is nothing at this place: elements, characters and pixels are counted from 0."
    ConstantChanged "constant-changed" Error "A `const`, a constant of the language or a value that is no variable was to be changed. Declare a variable by `let`."
    Thrown "thrown" Error "The script itself ended the run by `throw`; the message is its own."
    PopWithoutPush "pop-without-push" Error "Each `popTransform()` undoes one `pushTransform()` before it in the same block. There is none left to undo."
    NotClosed "not-closed" Error "What `union`, `intersection` and `difference` put together must have an inside: solids, closed meshes, planes, and groups of such things. A disk, a triangle or a mesh with a hole has none."
    SingularMatrix "singular-matrix" Error "The current matrix flattens space to a plane, a line or a point, so the shape would have no volume. A component of `scale` is 0, or became it by a multiplication."
    ImportCircle "import-circle" Error "Modules import one another, so that none of them can be first. Put what both need into a third."
    UnreadableFile "unreadable-file" Error "A file that was to be read is missing or cannot be opened. Names are looked up beside the script."
    MalformedFile "malformed-file" Error "A file was read, and what it holds is not what its kind demands."
    Limit "limit" Error "A limit was reached that keeps a script from taking all of a machine. The message names it and its value; where rtscript is embedded, its host sets the limits."
    Denied "denied" Error "The host refuses access: a script reads below its own folder and writes below the current one."
    Output "output" Error "The picture cannot be written where it was to be written."
    Cancelled "cancelled" Error "The run was stopped, by a signal or by the host."
    Failed "failed" Error "Some of what was asked for failed; the messages above it say why."
    Internal "internal" Error "A fault of rtscript itself. Please report it with the script."
    EmptyScene "empty-scene" Warning "There is nothing to be seen: no shape was made, or only inside of a `define` that nothing places."
    EmptySolid "empty-solid" Warning "A `union`, an `intersection` or a `difference` was left without a shape in it, so there is no solid."
    NoLight "no-light" Warning "There is no light, and nothing glows by ambient or emission, so all is black. `light([5, 5, 5], [1, 1, 1])` adds one."
    OutOfView "out-of-view" Warning "All there is lies outside of what the camera sees. `camera(from, at, up, fovy)` says where it stands, which point it looks at, and how wide it sees."
    Unlit "unlit" Warning "No light reaches anything that is in view, so the picture is black or shows nothing but ambient; the message says what keeps the light away."
    CameraInside "camera-inside" Warning "The camera stands inside a solid that lets no light through, and no light is in there with it."
    LightInside "light-inside" Warning "A light stands inside a solid that lets no light through, so it lights only the inside. Move the light or the solid, or give the solid a `transmission`."
    CoincidentFaces "coincident-faces" Warning "Two surfaces lie in one place, so rounding decides at each point which is seen. Move one of them by a little."
    PushWithoutPop "push-without-pop" Warning "A `pushTransform()` has no `popTransform()`, so what follows stands under its matrix. `group { }` undoes itself."
    UnseenShape "unseen-shape" Warning "No ray met any shape that this line made: not from the camera, not by way of a mirror or glass. It lies outside of the view, behind something, or is smaller than the distance of the rays."
    UnreachedLine "unreached-line" Warning "The run came by this line at no time: a condition never held, a loop had nothing to run through, or a function was never called."
    ExchangedArguments "exchanged-arguments" Warning "Two arguments look as if each were meant for the other's place. `rtscript help NAME` shows the order."
    InvalidSamples "invalid-samples" Warning "Some rays came back with a color that is no finite number and count as black. Colors or lights are beyond 1e150."
    InexactText "inexact-text" Warning "The flat text of a scene does not give the very same picture, or not in this place; the message says why."
    IgnoredInput "ignored-input" Warning "A file holds something that is left out, so the picture may lack what other programs show."
}

impl Code {
    /// The class of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|code| code.name() == name)
    }
}

/// The class of an error of which nothing more is known.
impl From<ErrorKind> for Code {
    fn from(kind: ErrorKind) -> Self {
        match kind {
            ErrorKind::Script => Self::InvalidValue,
            ErrorKind::Input => Self::MalformedFile,
            ErrorKind::Output => Self::Output,
            ErrorKind::Limit => Self::Limit,
            ErrorKind::Denied => Self::Denied,
            ErrorKind::Cancelled => Self::Cancelled,
            ErrorKind::Internal => Self::Internal,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_has_a_name_and_an_explanation_of_its_own() {
        for (i, code) in Code::ALL.iter().enumerate() {
            let name = code.name();
            assert!(name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{name}");
            assert_eq!(Code::from_name(name), Some(*code));
            assert!(code.explanation().ends_with('.'), "{name}");
            let others = &Code::ALL[i + 1..];
            assert!(
                others
                    .iter()
                    .all(|other| other.explanation() != code.explanation())
            );
        }
        assert_eq!(Code::from_name("no-such-code"), None);
    }
}
