//! Values as the language of scripts has them, so that they read back as the same bits.

use std::fmt::{self, Write as _};

use crate::math::DVec3;

/// `[x, y, z]`.
pub(crate) struct Vector(pub(crate) DVec3);

impl fmt::Display for Vector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}]", Components(self.0))
    }
}

/// `x, y, z`.
pub(crate) struct Components(pub(crate) DVec3);

impl fmt::Display for Components {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.0;
        write!(f, "{}, {}, {}", Number(x), Number(y), Number(z))
    }
}

/// A finite number as a literal that reads back as the same bits.
pub(crate) struct Number(pub(crate) f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let x = self.0;
        if x == 0.0 && x.is_sign_negative() {
            // A whole number has no negative zero.
            f.write_str("-0.0")
        } else if x.abs() > 1e15 {
            // Beyond 2^53 a whole number has digits that are not the float's; with a fraction it is a float.
            let text = format!("{x:e}");
            let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
            let fraction = if digits.contains('.') { "" } else { ".0" };
            write!(f, "{digits}{fraction}e{exponent}")
        } else if x != 0.0 && x.abs() < 1e-5 {
            write!(f, "{x:e}")
        } else {
            write!(f, "{x}")
        }
    }
}

/// A string between quotation marks.
pub(crate) struct Text<'a>(pub(crate) &'a str);

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char('"')?;
        for c in self.0.chars() {
            match c {
                '"' => f.write_str("\\\"")?,
                '\\' => f.write_str("\\\\")?,
                '\n' => f.write_str("\\n")?,
                '\r' => f.write_str("\\r")?,
                '\t' => f.write_str("\\t")?,
                c if c.is_control() => write!(f, "\\u{:04x}", u32::from(c))?,
                c => f.write_char(c)?,
            }
        }
        f.write_char('"')
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        for x in [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.1,
            1.0 / 3.0,
            -2.5e-7,
            5e-324,
            1e15,
            999_999_999_999_999.9,
            1e-5,
            -1e16,
            1.5e300,
            f64::MAX,
        ] {
            let text = Number(x).to_string();
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), x.to_bits(), "{text}");
            assert!(
                text.len() < 25 && !text.starts_with('.') && !text.ends_with('.'),
                "{text}"
            );
        }
        assert_eq!(Number(3.0).to_string(), "3");
        assert_eq!(Number(-2.5e-7).to_string(), "-2.5e-7");
        assert_eq!(Number(1e16).to_string(), "1.0e16");
    }

    #[test]
    fn texts_keep_to_one_line() {
        assert_eq!(Text("a\"b\\c\n\u{1}é").to_string(), "\"a\\\"b\\\\c\\n\\u0001é\"");
    }
}
