//! Values of a parameter in a sweep, as they are typed.

/// Most values of one parameter.
const MOST: usize = 10_000;

/// `0.1..1:10` are ten numbers from 0.1 to 1 with equal steps, `1..4` the whole numbers from 1 to 4, `a,b,c` these
/// three, anything else itself.
///
/// # Errors
/// What is wrong with a range.
pub(super) fn values(text: &str) -> Result<Vec<String>, String> {
    let Some((first, rest)) = text.split_once("..") else {
        return Ok(text.split(',').map(str::to_owned).collect());
    };
    let (last, count) = match rest.split_once(':') {
        Some((last, count)) => (last, Some(count)),
        None => (rest, None),
    };
    let number = |text: &str| {
        let number = text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| format!("'{text}' is no number; a range is 0.1..1:10 or 1..4"))
    };
    let (a, b) = (number(first)?, number(last)?);
    let Some(count) = count else {
        let whole = |text: &str| text.trim().parse::<i64>();
        let (Ok(a), Ok(b)) = (whole(first), whole(last)) else {
            return Err(format!(
                "how many values has '{text}'? write {text}:10 for ten of them"
            ));
        };
        let steps = b.abs_diff(a);
        if steps >= MOST as u64 {
            return Err(format!("'{text}' has more than {MOST} values"));
        }
        let sign = if b < a { -1 } else { 1 };
        return Ok((0..=steps as i64).map(|i| (a + sign * i).to_string()).collect());
    };
    let count = count
        .trim()
        .parse::<usize>()
        .ok()
        .filter(|n| (1..=MOST).contains(n));
    let count =
        count.ok_or_else(|| format!("expected a number of values from 1 to {MOST} after the colon"))?;
    if count == 1 {
        return Ok(vec![first.trim().to_owned()]);
    }
    let steps = (count - 1) as f64;
    Ok((0..count)
        .map(|i| tidy(a + (b - a) * (i as f64 / steps)))
        .collect())
}

/// The shortest text of a number that is the same to 12 figures: 0.30000000000000004 is 0.3.
fn tidy(x: f64) -> String {
    let short: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    short.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_lists_and_single_values() {
        let of = |text: &str| values(text).unwrap().join(" ");
        assert_eq!(of("0.1..1:10"), "0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1");
        assert_eq!(of("1..4"), "1 2 3 4");
        assert_eq!(of("2..-1"), "2 1 0 -1");
        assert_eq!(of("1..-1:3"), "1 0 -1");
        assert_eq!(of("5..9:1"), "5");
        assert_eq!(of("red,green"), "red green");
        assert_eq!(of("0.5"), "0.5");
        assert_eq!(of("true,false"), "true false");
        assert_eq!(of(""), "");
        for bad in [
            "a..b",
            "0.5..1",
            "1..2:0",
            "1..2:x",
            "0..1000000",
            "..",
            "1..NaN:3",
            "1..inf:3",
            "0..1:99999",
        ] {
            assert!(values(bad).is_err(), "{bad}");
        }
    }
}
