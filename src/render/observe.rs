//! Watching the integrator at work. What is explained is what was computed, because there is only one computation: the
//! integrator tells an [`Observer`] each step, and a render's observer is `()`, of which nothing is left in the program.

use super::{
    around::Air,
    lighting::Lit,
    world::{Hit, Probe, SurfacePoint, World},
};
use crate::{color::Color, math::Ray};

/// Where a ray comes from.
///
/// ```
/// use rtscript::render::RayKind;
/// // What a pixel starts with.
/// assert_ne!(RayKind::Camera, RayKind::Reflected);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// The camera.
    Camera,
    /// A mirror.
    Reflected,
    /// A transparent surface.
    Refracted,
}

/// Light that a shadow ray was sent for.
pub(super) struct Arrived<'a> {
    pub(super) probe: &'a Probe,
    /// How far the shadow ray looks.
    pub(super) reach: f64,
    /// What arrives where nothing is in between.
    pub(super) arriving: Color,
    /// Share that comes through.
    pub(super) visible: Color,
    /// What was added to the light that the point sends out.
    pub(super) added: Color,
}

/// Is told what happens along the rays of one sample, a ray after the other: a mirrored ray with all that follows
/// from it comes before the refracted one.
pub(super) trait Observer {
    /// False for the one that nothing is to be prepared for.
    const WATCHES: bool = true;

    /// A ray sets out.
    fn ray(&mut self, _ray: &Ray, _weight: Color, _depth: u32) {}
    /// Of what it sees only this share gets back to its start, so that it has this weight.
    fn dimmed(&mut self, _weight: Color) {}
    /// Between its start and what it sees there is air.
    fn air(&mut self, _air: &Air) {}
    /// It meets nothing, and sees this.
    fn background(&mut self, _seen: Color, _added: Color) {}
    /// It meets a surface.
    fn surface(&mut self, _hit: &Hit, _ray: &Ray, _at: &SurfacePoint<'_>) {}
    /// The lights from now on are those of this number.
    fn light(&mut self, _index: usize) {}
    /// The light sends this.
    fn arrived(&mut self, _lit: &Lit<'_>, _light: &Arrived<'_>) {}
    /// All lights have been asked.
    fn shaded(&mut self, _ambient: Color, _emission: Color, _direct: Color, _added: Color) {}
    /// A ray may go on from the surface, which sends out `share` of what it sees; `followed` tells whether it does.
    /// The refracted one is told of first.
    fn branch(&mut self, _kind: RayKind, _share: Color, _weight: Color, _followed: bool) {}
    /// Nothing is refracted: this share goes to the mirror.
    fn total_reflection(&mut self, _share: Color) {}
    /// As [`Observer::branch`] where no ray goes on, because the path is as deep as it may be.
    fn ended(&mut self, _kind: RayKind, _share: Color, _weight: Color, _is_strong: bool) {}
    /// No ray goes on, because the path is as deep as it may be.
    fn deepest(&mut self, _world: &World<'_>, _at: &SurfacePoint<'_>, _ray: &Ray, _weight: Color) {}
}

impl Observer for () {
    const WATCHES: bool = false;
}

/// Tells an observer of the rays that would go on where none does.
pub(super) struct AtTheEnd<'o, O>(pub(super) &'o mut O);

impl<O: Observer> Observer for AtTheEnd<'_, O> {
    fn branch(&mut self, kind: RayKind, share: Color, weight: Color, followed: bool) {
        self.0.ended(kind, share, weight, followed);
    }

    fn total_reflection(&mut self, share: Color) {
        self.0.total_reflection(share);
    }
}
