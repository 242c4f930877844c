//! Which shapes a light reaches.

use crate::scene::{GroupId, SceneError};

/// Which shapes a light reaches: those of some groups, or those outside of some. A shape is in a group where an instance
/// of it leads to the shape, directly or through others. Whatever stands in the way casts its shadow all the same.
///
/// ```
/// use rtscript::{Builder, scene::Links};
/// let mut b = Builder::new();
/// let mark = b.begin_define("car")?;
/// b.end_define(mark, true);
/// let car = b.group_called("car")?;
/// // The lights that follow reach cars and nothing else.
/// let links = Links::new(Some(vec![car]), Vec::new())?;
/// assert!(!links.is_all() && links.reaches(|group| group == car));
/// b.light_linking(links)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Links {
    only: Option<Vec<GroupId>>,
    except: Vec<GroupId>,
}

impl Links {
    /// Most groups that a light names.
    pub const MOST: usize = 64;

    /// Light for shapes in any of `only`, or for all where that is `None`, but for those in any of `except`.
    ///
    /// # Errors
    /// Where more than 64 groups are named.
    pub fn new(only: Option<Vec<GroupId>>, except: Vec<GroupId>) -> Result<Self, SceneError> {
        let named = only.as_ref().map_or(0, Vec::len) + except.len();
        if named > Self::MOST {
            return Err(SceneError::new(format!(
                "a light is linked to {named} groups, and {} are the most",
                Self::MOST
            ))
            .hint("put what belongs together into one define"));
        }
        Ok(Self { only, except })
    }

    /// Groups that it lights; `None` where all are.
    #[must_use]
    pub fn only(&self) -> Option<&[GroupId]> {
        self.only.as_deref()
    }

    /// Groups that it does not light.
    ///
    /// ```
    /// use rtscript::{Builder, scene::Links};
    /// let mut b = Builder::new();
    /// let mark = b.begin_define("stage")?;
    /// b.end_define(mark, true);
    /// let stage = b.group_called("stage")?;
    /// // Lights everything but the stage.
    /// let links = Links::new(None, vec![stage])?;
    /// assert_eq!((links.only(), links.except()), (None, &[stage][..]));
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn except(&self) -> &[GroupId] {
        &self.except
    }

    /// True where it reaches everything.
    #[must_use]
    pub fn is_all(&self) -> bool {
        self.only.is_none() && self.except.is_empty()
    }

    /// Whether it reaches a shape that these groups lead to.
    #[must_use]
    pub fn reaches(&self, path: impl Fn(GroupId) -> bool) -> bool {
        let is_in = |groups: &[GroupId]| groups.iter().any(|id| path(*id));
        self.only().is_none_or(is_in) && !is_in(&self.except)
    }

    /// All groups that it names.
    pub(crate) fn groups(&self) -> impl Iterator<Item = GroupId> + '_ {
        self.only.iter().flatten().chain(&self.except).copied()
    }
}
