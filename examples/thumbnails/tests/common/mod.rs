//! Scripts of strangers.

#![allow(dead_code)]

macro_rules! scripts {
    ($folder:literal: $($name:literal)*) => {
        [$(($name, include_str!(concat!("../../scripts/", $folder, "/", $name, ".rhai")))),*]
    };
}

/// What the service is for. Each takes some milliseconds.
pub const GOOD: [(&str, &str); 5] = scripts!("good": "balls" "glass" "hills" "marble" "soft");

/// What wants more than it is given: each ends at a limit, or at the deadline.
pub const HOSTILE: [(&str, &str); 21] = scripts!("hostile":
    "arrays" "caught" "chain" "copies" "crowd" "doubling" "endless" "frames" "giant" "hoard" "levels" "lights" "million" "mirrors" "nonsense"
    "outside" "print" "recursion" "strings" "throw" "unclosed");

/// A script that the service has not seen, with the same picture.
pub fn fresh(script: &str, number: usize) -> String {
    format!("{script}// {number}\n")
}

/// The value below which this part of them lies, from 0 to 1.
pub fn percentile<T: Copy + PartialOrd>(values: &mut [T], part: f64) -> Option<T> {
    values.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let last = values.len().checked_sub(1)?;
    values.get((last as f64 * part).round() as usize).copied()
}
