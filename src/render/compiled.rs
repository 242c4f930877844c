//! A scene and its compiled form in one value.

use std::fmt;

use self_cell::self_cell;

use super::{interrupt::Interrupt, world::World};
use crate::{
    diag::Error,
    host::{Host, NoHost},
    scene::Scene,
};

/// What a [`World`] refers to.
struct Owner {
    scene: Scene,
    interrupt: Interrupt<'static>,
}

self_cell!(
    struct Cell {
        owner: Box<Owner>,
        #[covariant]
        dependent: World,
    }
);

/// A scene together with its [`World`], for programs that keep one and ask it now and then.
///
/// ```
/// use rtscript::{Builder, DVec3, math::Ray, render::Compiled};
/// let mut b = Builder::new();
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let compiled = Compiled::new(b.finish().value)?;
/// let down = Ray::new(DVec3::new(0.0, 5.0, 0.0), DVec3::NEG_Y);
/// assert_eq!(compiled.world().raycast(&down, f64::INFINITY).map(|hit| hit.t), Some(4.0));
/// assert!(compiled.world().is_inside(DVec3::new(0.5, 0.5, 0.5)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Compiled(Cell);

impl Compiled {
    /// Compiles a scene and keeps both.
    ///
    /// # Errors
    /// As [`World::compile`].
    pub fn new(scene: Scene) -> Result<Self, Error> {
        Self::for_host(scene, Box::new(NoHost))
    }

    /// As [`Compiled::new`], for a host that is asked whether to stop: now, and during every question that may take
    /// long, which then has any answer.
    ///
    /// # Errors
    /// As [`World::compile_for`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, Host, diag::ErrorKind, host::HostError, render::Compiled};
    ///
    /// struct Closing;
    ///
    /// impl Host for Closing {
    ///     fn read(&self, path: &str, _max_bytes: u64) -> Result<Vec<u8>, HostError> {
    ///         Err(HostError::new(ErrorKind::Denied, format!("{path}: nothing is read here")))
    ///     }
    ///
    ///     fn should_stop(&self) -> bool {
    ///         true
    ///     }
    /// }
    ///
    /// let mut b = Builder::new();
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// let scene = b.finish().value;
    /// let stopped = Compiled::for_host(scene.clone(), Box::new(Closing)).expect_err("it wants to stop");
    /// assert_eq!(stopped.kind(), ErrorKind::Cancelled);
    /// assert!(!Compiled::for_host(scene, Box::new(rtscript::NoHost))?.is_stopped());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn for_host(scene: Scene, host: Box<dyn Host>) -> Result<Self, Error> {
        let interrupt = Interrupt::asking(host);
        let cell = Cell::try_new(Box::new(Owner { scene, interrupt }), |owner| {
            let Owner { scene, interrupt } = &**owner;
            let mut world = World::compile_keeping(scene, None, interrupt)?;
            world.interrupt = Some(interrupt);
            Ok(world)
        });
        cell.map(Self)
    }

    /// The compiled form.
    #[must_use]
    pub fn world(&self) -> &World<'_> {
        self.0.borrow_dependent()
    }

    /// Whether the host wanted to stop during any question.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.0.borrow_owner().interrupt.is_stopped()
    }

    /// The scene that was compiled.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.0.borrow_owner().scene
    }
}

impl fmt::Debug for Compiled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Compiled").field("world", self.world()).finish()
    }
}
