//! Arguments of a scene function: from Rhai's values to numbers, vectors, colors and terms, with errors that
//! name the function and the parameter.

use std::sync::Arc;

use rhai::{Array, Dynamic, ImmutableString, Map};

use super::{
    given,
    names::COLORS,
    table::Entry,
    value::{ImageValue, Outcome, ScriptError, TextureValue},
};
use crate::{
    color::{self, Color},
    diag::{Code, nearest_names},
    math::DVec3,
    scene::{Texture, Told},
};

/// The arguments of one call, taken one parameter after another.
pub(crate) struct Call<'c, 'd> {
    pub(crate) entry: &'static Entry,
    args: &'c [&'d mut Dynamic],
    next: usize,
    /// Numbers that were given otherwise than they are told.
    told: Told,
}

/// A color, or a texture times a color.
#[derive(Clone, Debug)]
pub(crate) struct TermValue {
    pub(crate) color: Color,
    pub(crate) texture: Option<Arc<Texture>>,
}

impl<'c, 'd> Call<'c, 'd> {
    pub(crate) fn new(entry: &'static Entry, args: &'c [&'d mut Dynamic]) -> Self {
        Self {
            entry,
            args,
            next: 0,
            told: Told::default(),
        }
    }

    /// How many arguments were given.
    pub(crate) fn len(&self) -> usize {
        self.args.len()
    }

    /// How many are not taken yet.
    pub(crate) fn rest(&self) -> usize {
        self.args.len() - self.next
    }

    /// The next argument, not taken.
    pub(crate) fn peek(&self) -> Option<&Dynamic> {
        self.args.get(self.next).map(|d| &**d)
    }

    /// The next argument as it is.
    pub(crate) fn any(&mut self) -> Outcome<&'c Dynamic> {
        match self.args.get(self.next) {
            Some(d) => {
                self.next += 1;
                Ok(d)
            }
            None => Err(self.wrong_count()),
        }
    }

    /// Ends the list of parameters.
    #[inline]
    pub(crate) fn end(&self) -> Outcome<()> {
        if self.next == self.args.len() {
            Ok(())
        } else {
            Err(self.wrong_count())
        }
    }

    /// A finite number.
    #[inline]
    pub(crate) fn number(&mut self, name: &str) -> Outcome<f64> {
        let d = self.any()?;
        match number_of(d) {
            Some(x) if x.is_finite() => Ok(x),
            Some(x) => Err(self.not_finite(name, x)),
            None => Err(self.wrong_kind(name, "a number", d)),
        }
    }

    /// A number that may be infinite or NaN.
    #[inline]
    pub(crate) fn any_number(&mut self, name: &str) -> Outcome<f64> {
        let d = self.any()?;
        number_of(d).ok_or_else(|| self.wrong_kind(name, "a number", d))
    }

    /// A whole number.
    pub(crate) fn int(&mut self, name: &str) -> Outcome<i64> {
        let d = self.any()?;
        if let Ok(i) = d.as_int() {
            return Ok(i);
        }
        match number_of(d) {
            Some(x) if x.trunc() == x && x.abs() < 9.0e15 => Ok(x as i64),
            Some(x) => Err(self.error(format!("{name} must be a whole number, not {x}"))),
            None => Err(self.wrong_kind(name, "a whole number", d)),
        }
    }

    /// A whole number not below `least`, [within](Call::within) `u32`.
    pub(crate) fn count(&mut self, name: &str, least: u32) -> Outcome<u32> {
        let n = self.int(name)?;
        if n < i64::from(least) {
            return Err(self.error(format!("{name} must be at least {least}, not {n}")));
        }
        Ok(self.within(n))
    }

    /// A count as `u32`: what exceeds it becomes its maximum, which every limit refuses.
    pub(crate) fn within(&self, n: i64) -> u32 {
        self.told.count(n)
    }

    /// A whole number not below `least` from a single value, as in an options map, [within](Call::within) `u32`.
    pub(crate) fn count_from(&self, name: &str, d: &Dynamic, least: u32) -> Outcome<u32> {
        let x = self.number_from(name, d)?;
        if x.trunc() != x || x < f64::from(least) {
            return Err(self.error(format!(
                "{name} must be a whole number of at least {least}, not {x}"
            )));
        }
        if x > f64::from(u32::MAX) {
            self.told.note(u32::MAX, given::exact(d).unwrap_or_default());
        }
        Ok(x as u32)
    }

    /// What the function says of its arguments, with the numbers that were given in place of those that it was told.
    #[cold]
    pub(super) fn as_given(&self, mut error: Box<ScriptError>) -> Box<ScriptError> {
        given::note_rounded(&self.told, self.args);
        self.told.put_right(&mut error.message);
        error
    }

    /// A vector of finite numbers, or three of them.
    #[inline]
    pub(crate) fn vec3(&mut self, name: &str) -> Outcome<DVec3> {
        self.triple(name, "a vector")
    }

    /// A color: a vector, three numbers, or a color code.
    pub(crate) fn color(&mut self, name: &str) -> Outcome<Color> {
        if let Some(d) = self.peek()
            && d.is_string()
        {
            let color = self.color_code(name, d)?;
            self.next += 1;
            return Ok(color);
        }
        self.triple(name, "a color")
    }

    /// A color or a texture.
    pub(crate) fn term(&mut self, name: &str) -> Outcome<TermValue> {
        if let Some(texture) = self.peek().and_then(texture_of) {
            self.next += 1;
            return Ok(texture);
        }
        Ok(TermValue {
            color: self.color(name)?,
            texture: None,
        })
    }

    #[inline]
    fn triple(&mut self, name: &str, wanted: &str) -> Outcome<DVec3> {
        if let Some([x, y, z, ..]) = self.args.get(self.next..)
            && let (Some(x), Some(y), Some(z)) = (number_of(x), number_of(y), number_of(z))
        {
            self.next += 3;
            return self.finite(name, DVec3::new(x, y, z));
        }
        self.triple_or_vector(name, wanted)
    }

    #[inline(never)]
    fn triple_or_vector(&mut self, name: &str, wanted: &str) -> Outcome<DVec3> {
        let first = self.any()?;
        if number_of(first).is_none() {
            return self.vector_of(name, wanted, first);
        }
        let [y, z] = match self.args.get(self.next..self.next + 2) {
            Some([y, z]) => [&**y, &**z],
            _ => return Err(self.lone_number(name, wanted)),
        };
        let wrong = if number_of(y).is_none() {
            (y, "y")
        } else {
            (z, "z")
        };
        Err(self.wrong_kind(&format!("{name}.{}", wrong.1), "a number", wrong.0))
    }

    fn vector_of(&self, name: &str, wanted: &str, d: &Dynamic) -> Outcome<DVec3> {
        if let Some(v) = d.read_lock::<DVec3>() {
            return self.finite(name, *v);
        }
        let Some(array) = d.read_lock::<Array>() else {
            return Err(self.wrong_kind(name, wanted, d));
        };
        let [x, y, z] = array.as_slice() else {
            return Err(self
                .error(format!(
                    "{name} must be {wanted} of 3 numbers, not an array of {}",
                    array.len()
                ))
                .class(Code::ArgumentType));
        };
        let component = |d: &Dynamic, axis: &str| {
            number_of(d).ok_or_else(|| self.wrong_kind(&format!("{name}.{axis}"), "a number", d))
        };
        let v = DVec3::new(component(x, "x")?, component(y, "y")?, component(z, "z")?);
        self.finite(name, v)
    }

    #[inline]
    fn finite(&self, name: &str, v: DVec3) -> Outcome<DVec3> {
        if v.is_finite() {
            return Ok(v);
        }
        Err(self.component_not_finite(name, v))
    }

    #[cold]
    fn component_not_finite(&self, name: &str, v: DVec3) -> Box<ScriptError> {
        let bad = v
            .to_array()
            .into_iter()
            .zip(["x", "y", "z"])
            .find(|(x, _)| !x.is_finite());
        let (x, axis) = bad.unwrap_or((f64::NAN, "x"));
        self.not_finite(&format!("{name}.{axis}"), x)
    }

    fn color_code(&self, name: &str, d: &Dynamic) -> Outcome<Color> {
        let text = d.clone().into_immutable_string().unwrap_or_default();
        color::from_hex(&text).ok_or_else(|| {
            let error = self.error(format!("{name} must be a color, and {} is no color code", quoted(&text)));
            let known = COLORS.iter().find(|(color, _)| *color == text.to_lowercase());
            let error = match known {
                Some((color, code)) => error.hint(format!("{color} is \"{code}\"")),
                None => error,
            };
            error
                .hint("color codes are \"#rrggbb\" and \"#rgb\"; a color is also [red, green, blue], each from 0 to 1")
        })
    }

    /// A string.
    pub(crate) fn string(&mut self, name: &str) -> Outcome<ImmutableString> {
        let d = self.any()?;
        d.clone()
            .into_immutable_string()
            .map_err(|_| self.wrong_kind(name, "a string", d))
    }

    /// A color or texture from a single value, as in an options map.
    pub(crate) fn term_from(&self, name: &str, d: &Dynamic) -> Outcome<TermValue> {
        if let Some(texture) = texture_of(d) {
            return Ok(texture);
        }
        let color = if d.is_string() {
            self.color_code(name, d)?
        } else {
            if number_of(d).is_some() {
                return Err(self.lone_number(name, "a color"));
            }
            self.vector_of(name, "a color", d)?
        };
        Ok(TermValue { color, texture: None })
    }

    /// The value of an argument that may be infinite or NaN.
    pub(crate) fn number_like(&self, name: &str, d: &Dynamic) -> Outcome<f64> {
        number_of(d).ok_or_else(|| self.wrong_kind(name, "a number", d))
    }

    /// A finite number from a single value, as in an options map.
    pub(crate) fn number_from(&self, name: &str, d: &Dynamic) -> Outcome<f64> {
        match number_of(d) {
            Some(x) => self.finite_number(|| name.to_owned(), x),
            None => Err(self.wrong_kind(name, "a number", d)),
        }
    }

    /// `x`, where it is finite.
    pub(crate) fn finite_number(&self, name: impl FnOnce() -> String, x: f64) -> Outcome<f64> {
        if x.is_finite() {
            return Ok(x);
        }
        Err(self.not_finite(&name(), x))
    }

    /// A vector from a single value, as in an array of points.
    pub(crate) fn vec3_from(&self, name: &str, d: &Dynamic) -> Outcome<DVec3> {
        if number_of(d).is_some() {
            return Err(self.lone_number(name, "a vector"));
        }
        self.vector_of(name, "a vector", d)
    }

    /// Refuses keys of an options map that are not among `known`.
    pub(crate) fn known_keys(&self, map: &Map, known: &[&str]) -> Outcome<()> {
        let Some(key) = map.keys().find(|key| !known.contains(&key.as_str())) else {
            return Ok(());
        };
        let error = self
            .error(format!("unknown key {}", quoted(key)))
            .class(Code::UnknownKey);
        let error = match nearest_names(key, known.iter().copied()).first() {
            Some(near) => error.hint(format!("did you mean {near}?")),
            None => error,
        };
        Err(error.hint(format!("the keys are {}", known.join(", "))))
    }

    /// An error of this function: its name comes first.
    #[cold]
    pub(crate) fn error(&self, message: impl std::fmt::Display) -> Box<ScriptError> {
        ScriptError::new(format!("{}: {message}", self.entry.name))
    }

    /// A value of another kind than `wanted`.
    #[cold]
    pub(crate) fn wrong_kind(&self, name: &str, wanted: &str, given: &Dynamic) -> Box<ScriptError> {
        self.error(format!("{name} must be {wanted}, not {}", kind_of(given)))
            .class(Code::ArgumentType)
            .hint(if given.is_unit() {
                "a function without a result gives nothing, and so does a statement that ends with ';'"
                    .to_owned()
            } else {
                format!("for example {}", self.entry.usage)
            })
    }

    #[cold]
    fn not_finite(&self, name: &str, x: f64) -> Box<ScriptError> {
        let what = if x.is_nan() { "NaN" } else { "infinite" };
        let cause = if x.is_nan() {
            "NaN comes from 0.0 / 0.0 or the root of a negative number"
        } else {
            "infinity comes from a division by 0.0 or a number beyond 1e308"
        };
        self.error(format!("{name} must be a finite number, but it is {what}"))
            .class(Code::NotFinite)
            .hint(cause)
    }

    #[cold]
    fn lone_number(&self, name: &str, wanted: &str) -> Box<ScriptError> {
        let hint = if wanted == "a color" {
            "a gray is [0.5, 0.5, 0.5] or \"#888\""
        } else {
            "a vector is [x, y, z], vec3(x, y, z), or three numbers"
        };
        let error = self
            .error(format!("{name} must be {wanted}, not a number"))
            .class(Code::ArgumentType);
        let later = self.args.get(self.next..).unwrap_or_default();
        if wanted == "a vector" && later.iter().any(|d| number_of(d).is_none()) {
            // The vector comes, only later.
            let order = self.entry.signature();
            return error.hint(format!(
                "the order is {}{order}: for example {}",
                self.entry.name, self.entry.usage
            ));
        }
        error.hint(hint)
    }

    #[cold]
    pub(crate) fn wrong_count(&self) -> Box<ScriptError> {
        wrong_count(self.entry, self.args.len())
    }
}

/// The error for a call with a number of arguments that `entry` does not take.
#[cold]
pub(crate) fn wrong_count(entry: &Entry, given: usize) -> Box<ScriptError> {
    ScriptError::new(format!(
        "{} takes {}, not {}",
        entry.name,
        entry.signature(),
        arguments(given)
    ))
    .class(Code::ArgumentCount)
    .hint(format!("for example {}", entry.usage))
}

/// "1 argument", "2 arguments".
pub(crate) fn arguments(n: usize) -> String {
    format!("{n} argument{}", if n == 1 { "" } else { "s" })
}

/// The value of an int or a float.
#[inline(always)]
pub(crate) fn number_of(d: &Dynamic) -> Option<f64> {
    // Rhai looks up the name of whatever else it is, which only an error wants to know.
    if d.is_float() {
        d.as_float().ok()
    } else if d.is_int() {
        d.as_int().ok().map(|i| i as f64)
    } else {
        None
    }
}

/// The texture, where the value is one.
pub(crate) fn texture_of(d: &Dynamic) -> Option<TermValue> {
    if let Some(image) = d.read_lock::<ImageValue>() {
        return Some(TermValue {
            color: Color::ONE,
            texture: Some(Arc::clone(image.texture())),
        });
    }
    d.read_lock::<TextureValue>().map(|t| TermValue {
        color: t.tint,
        texture: Some(Arc::clone(&t.texture)),
    })
}

/// What a value is, for "not a string".
pub(crate) fn kind_of(d: &Dynamic) -> String {
    if let Some(array) = d.read_lock::<Array>() {
        return format!("an array of {}", array.len());
    }
    kind_name(d.type_name())
}

/// A type of Rhai or of ours, with its article.
pub(crate) fn kind_name(type_name: &str) -> String {
    let name = match type_name {
        "i64" | "f64" | "int" | "float" => "a number",
        "()" => "nothing",
        "bool" => "a boolean",
        "char" => "a character",
        "string" | "&str | ImmutableString | String" => "a string",
        "array" => "an array",
        "map" => "a map",
        "blob" => "a blob",
        "Fn" => "a function",
        "vec3" => "a vector",
        "image" => "an image",
        "texture" => "a texture",
        "random stream" => "a random stream",
        "curve" => "a curve",
        "sdf" => "a solid",
        "field" => "a field",
        other if other.ends_with("::DVec3") => "a vector",
        other if other.ends_with("::ImageValue") => "an image",
        other if other.ends_with("::TextureValue") => "a texture",
        other if other.ends_with("::StreamValue") => "a random stream",
        other if other.ends_with("::CurveValue") => "a curve",
        other if other.ends_with("::Sdf") => "a solid",
        other if other.ends_with("::Field") => "a field",
        other if other.ends_with("::ScriptError") || other == "error" => "an error",
        other if other.contains("Range") || other.contains("range") => "a range",
        other => return format!("a value of type {other}"),
    };
    name.to_owned()
}

/// A piece of the script in a message: short, in quotes, without control characters.
pub(crate) fn quoted(text: &str) -> String {
    let mut short: String = text.chars().take(60).collect();
    if short.len() < text.len() {
        short.push_str("...");
    }
    format!("{short:?}")
}
