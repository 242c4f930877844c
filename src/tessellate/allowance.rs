//! How much a surface may take.

use std::fmt;

use crate::{
    diag::{Code, ErrorKind},
    limits::Limits,
    scene::SceneError,
};

/// How many triangles a surface may become, and who is asked on the way whether to stop.
///
/// ```
/// use rtscript::{DVec3, Limits, tessellate::{Allowance, Curve}};
/// let limits = Limits::untrusted();
/// let stop = || false;
/// let allowance = Allowance::of(&limits).asking(&stop);
/// let wire = Curve::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], 0.1).mesh(&allowance)?;
/// assert!(!wire.triangles.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct Allowance<'a> {
    triangles: usize,
    stop: Option<&'a dyn Fn() -> bool>,
}

impl fmt::Debug for Allowance<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Allowance")
            .field("triangles", &self.triangles)
            .finish_non_exhaustive()
    }
}

impl<'a> Allowance<'a> {
    /// As many triangles as `limits` lets a scene have primitives, and nobody to ask.
    #[must_use]
    pub fn of(limits: &Limits) -> Self {
        let triangles = limits.primitives.min(u32::MAX as usize / 8);
        Self {
            triangles,
            stop: None,
        }
    }

    /// Asks `stop` every few thousand triangles; true ends the work with [`ErrorKind::Cancelled`].
    #[must_use]
    pub fn asking(self, stop: &'a dyn Fn() -> bool) -> Self {
        Self {
            stop: Some(stop),
            ..self
        }
    }

    /// Refuses a number of triangles that is too large.
    pub(crate) fn triangles(&self, count: usize) -> Result<(), SceneError> {
        if count > self.triangles {
            return Err(SceneError::limit(
                "too many triangles",
                "primitives",
                self.triangles,
            ));
        }
        Ok(())
    }

    /// As [`Allowance::check_stop`], at every so manieth step of many.
    pub(crate) fn check_stop_at(&self, step: usize) -> Result<(), SceneError> {
        match step.is_multiple_of(STEPS_PER_QUESTION) {
            true => self.check_stop(),
            false => Ok(()),
        }
    }

    /// An error where somebody wants the work to end.
    pub(crate) fn check_stop(&self) -> Result<(), SceneError> {
        if self.stop.is_some_and(|stop| stop()) {
            return Err(SceneError {
                kind: ErrorKind::Cancelled,
                code: Code::Cancelled,
                message: "the run was stopped".to_owned(),
                hint: None,
            });
        }
        Ok(())
    }
}

/// Steps between two questions whether to stop: a millisecond's work or less.
pub(crate) const STEPS_PER_QUESTION: usize = 4096;
