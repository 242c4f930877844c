//! What is decided outside a script: written the same way on the command line, in snapshots and in pictures.

use std::{fmt, str::FromStr};

/// What is decided outside a script. Where it is `None`, the script decides.
///
/// As text `size=320x200 samples=4 seed=7`, in this order, without what is `None`; `none` where all is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Parameters {
    /// Size in pixels, across and down.
    pub size: Option<(u32, u32)>,
    /// Rays per pixel.
    pub samples: Option<u32>,
    /// Seed.
    pub seed: Option<u64>,
}

impl fmt::Display for Parameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.size.map(|(width, height)| format!("size={width}x{height}"));
        let samples = self.samples.map(|n| format!("samples={n}"));
        let seed = self.seed.map(|n| format!("seed={n}"));
        let all: Vec<String> = [size, samples, seed].into_iter().flatten().collect();
        f.write_str(if all.is_empty() { "none" } else { "" })?;
        f.write_str(&all.join(" "))
    }
}

impl FromStr for Parameters {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parameters = Self::default();
        for word in text.split_whitespace().filter(|word| *word != "none") {
            let bad = || format!("'{word}' is none of size=WxH, samples=N, seed=N");
            let (name, value) = word.split_once('=').ok_or_else(bad)?;
            match name {
                "size" => parameters.size = Some(parse_size(value)?),
                "samples" => parameters.samples = Some(value.parse().map_err(|_| bad())?),
                "seed" => parameters.seed = Some(value.parse().map_err(|_| bad())?),
                _ => return Err(bad()),
            }
        }
        Ok(parameters)
    }
}

/// `640x480` to its two numbers, both at least 1.
pub(crate) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let edge = |digits: &str| digits.parse::<u32>().ok().filter(|&n| n > 0);
    text.split_once(['x', 'X'])
        .and_then(|(width, height)| Some((edge(width)?, edge(height)?)))
        .ok_or_else(|| "expected two whole numbers above 0 with an x between, such as 640x480".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("640x480"), Ok((640, 480)));
        assert_eq!(parse_size("1X1"), Ok((1, 1)));
        for bad in [
            "640",
            "640x",
            "x480",
            "0x480",
            "640x0",
            "-1x5",
            "640 x 480",
            "1x2x3",
            "99999999999x1",
        ] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn text_and_back() {
        for text in [
            "none",
            "size=1x2",
            "size=320x200 samples=4 seed=18446744073709551615",
            "seed=0",
        ] {
            assert_eq!(text.parse::<Parameters>().unwrap().to_string(), text);
        }
        for bad in ["size", "size=3", "radius=1", "seed=-1", "samples=x"] {
            assert!(bad.parse::<Parameters>().is_err(), "{bad}");
        }
    }
}
