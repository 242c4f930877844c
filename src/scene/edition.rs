//! Editions: what a scene may rely on to stay as it is.

use std::fmt;

use super::SceneError;

/// A set of defaults and numerics that stays as it is for good: a scene that asks for an edition gives the same pixels
/// in every later version of rtscript. `docs/editions.md` says exactly what an edition fixes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Edition {
    /// The first one.
    E2026,
}

impl Edition {
    /// Every edition, the oldest first.
    pub const ALL: &[Self] = &[Self::E2026];

    /// The newest: what a scene has that asks for none.
    pub const LATEST: Self = Self::E2026;

    /// The year that names it.
    #[must_use]
    pub const fn year(self) -> u32 {
        match self {
            Self::E2026 => 2026,
        }
    }

    /// The edition of a year.
    ///
    /// # Errors
    /// Where there is none; the message lists those that are known.
    ///
    /// ```
    /// use rtscript::scene::Edition;
    /// assert_eq!(Edition::from_year(2026)?.year(), 2026);
    /// let error = Edition::from_year(1066).expect_err("there was none then");
    /// assert!(error.to_string().contains("2026"));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn from_year(year: i64) -> Result<Self, SceneError> {
        let is_it = |edition: &&Self| i64::from(edition.year()) == year;
        Self::ALL.iter().find(is_it).copied().ok_or_else(|| {
            let known: Vec<String> = Self::ALL.iter().map(Self::to_string).collect();
            let known = known.join(", ");
            SceneError::new(format!("there is no edition {year}; known are {known}")).hint(
                if year > i64::from(Self::LATEST.year()) {
                    "a newer rtscript may know it".to_owned()
                } else {
                    format!("edition({}) is the newest", Self::LATEST)
                },
            )
        })
    }

    /// Refuses a second edition that is not the first.
    pub(super) fn agree(self, second: Self) -> Result<(), SceneError> {
        if self == second {
            return Ok(());
        }
        Err(disagreement(self.year(), second.year()))
    }
}

fn disagreement(first: u32, second: u32) -> SceneError {
    SceneError::new(format!(
        "the scene has edition {first} already and cannot have edition {second}, too"
    ))
    .hint("a scene has one edition: keep one of the two calls")
}

/// The year.
impl fmt::Display for Edition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.year())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_year_leads_to_its_edition_and_back() {
        for edition in Edition::ALL {
            assert_eq!(Edition::from_year(i64::from(edition.year())), Ok(*edition));
        }
        assert!(Edition::ALL.is_sorted());
        assert_eq!(Edition::ALL.last(), Some(&Edition::LATEST));
    }

    #[test]
    fn an_unknown_year_is_told_what_is_known() {
        let of = |year| {
            let e = Edition::from_year(year).unwrap_err();
            (e.message, e.hint.unwrap())
        };
        let (message, hint) = of(2031);
        assert_eq!(message, "there is no edition 2031; known are 2026");
        assert_eq!(hint, "a newer rtscript may know it");
        assert_eq!(of(-1).1, "edition(2026) is the newest");
    }

    #[test]
    fn two_editions_disagree() {
        assert_eq!(Edition::E2026.agree(Edition::E2026), Ok(()));
        assert_eq!(
            disagreement(2026, 2029).message,
            "the scene has edition 2026 already and cannot have edition 2029, too"
        );
    }
}
