//! "Did you mean": which names are near to a misspelt one.

/// The candidates nearest to a misspelt `name`, best first, at most three; for "did you mean".
///
/// Distance is Damerau-Levenshtein on lower-case text without underscores, so that `push_transform` and
/// `pushtransform` both find `pushTransform`. Names of more than 256 bytes are near to nothing.
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
    let width = b.len() + 1;
    let mut table = vec![0; (a.len() + 1) * width];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            table[i * width + j] = if i == 0 || j == 0 {
                i + j
            } else {
                let replaced = table[(i - 1) * width + j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let mut best = replaced
                    .min(table[(i - 1) * width + j] + 1)
                    .min(table[i * width + j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    best = best.min(table[(i - 2) * width + j - 2] + 1);
                }
                best
            };
        }
    }
    table[table.len() - 1]
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
