//! "Did you mean": which names are near to a misspelt one.

/// The candidates nearest to a misspelt `name`, best first, at most three; for "did you mean".
///
/// Distance is Damerau-Levenshtein on lower-case text without underscores, so that `push_transform` and
/// `pushtransform` both find `pushTransform`. Names of more than 256 bytes are near to nothing.
///
/// ```
/// use rtscript::diag::nearest_names;
/// assert_eq!(nearest_names("spere", ["sphere", "plane"]), ["sphere"]);
/// ```
#[must_use]
pub fn nearest_names<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let fold = |s: &str| {
        s.chars()
            .filter(|c| *c != '_')
            .flat_map(char::to_lowercase)
            .collect::<Vec<_>>()
    };
    // Names come from files too, and the table of distances is as large as the product of both lengths.
    if name.len() > 256 {
        return Vec::new();
    }
    let wanted = fold(name);
    let bound = (wanted.len() / 3).max(1);
    let mut found: Vec<(usize, &str)> = candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= 256)
        .map(|candidate| (edit_distance(&wanted, &fold(candidate)), candidate))
        .filter(|(distance, _)| *distance <= bound)
        .collect();
    found.sort_unstable();
    found.dedup();
    found
        .into_iter()
        .take(3)
        .map(|(_, candidate)| candidate)
        .collect()
}

/// Number of insertions, deletions, replacements and swaps of neighbours between two words (Damerau, 1964).
fn edit_distance(a: &[char], b: &[char]) -> usize {
    // Rows of the table of distances between the beginnings of both: the one before the last, the last, and the next.
    let mut earlier: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    let mut before_a = None;
    for (i, &ca) in a.iter().enumerate() {
        let mut next = Vec::with_capacity(last.len());
        next.push(i + 1);
        let mut left = i + 1;
        let mut before_b = None;
        for ((j, &cb), pair) in b.iter().enumerate().zip(last.windows(2)) {
            let &[above_left, above] = pair else { break };
            let mut best = (above_left + usize::from(ca != cb)).min(above + 1).min(left + 1);
            let swapped = before_a == Some(cb) && before_b == Some(ca);
            if let Some(swap) = earlier.get(j.wrapping_sub(1)).filter(|_| swapped) {
                best = best.min(swap + 1);
            }
            next.push(best);
            (left, before_b) = (best, Some(cb));
        }
        earlier = std::mem::replace(&mut last, next);
        before_a = Some(ca);
    }
    last.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_names_see_through_case_and_underscores() {
        let names = ["pushTransform", "popTransform", "sphere", "scale", "diffuse"];
        assert_eq!(
            nearest_names("push_transform", names),
            ["pushTransform", "popTransform"]
        );
        assert_eq!(nearest_names("shpere", names), ["sphere"]);
        assert_eq!(nearest_names("difuse", names), ["diffuse"]);
        assert!(nearest_names("quaternion", names).is_empty());
        let long = "x".repeat(1 << 20);
        assert!(nearest_names(&long, [long.as_str()]).is_empty());
    }
}
