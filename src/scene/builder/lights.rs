//! Lights.

use super::{Builder, SceneError, finite};
use crate::{
    color::Color,
    diag::Code,
    math::DVec3,
    scene::{Attenuation, Light, LightKind, Links, Projector, Spot, Sun, SurfaceLight},
};

impl Builder {
    /// Fall-off of the point and area lights made from now on.
    ///
    /// # Errors
    /// Where a term is negative or not finite, or all are 0.
    pub fn attenuation(&mut self, attenuation: Attenuation) -> Result<(), SceneError> {
        let Attenuation {
            constant,
            linear,
            quadratic,
        } = attenuation;
        let terms = [constant, linear, quadratic];
        if terms.iter().any(|t| !t.is_finite() || *t < 0.0) || terms == [0.0; 3] {
            return Err(SceneError::new(format!(
                "the attenuation's terms must be 0 or greater and not all 0, not {constant}, {linear}, {quadratic}"
            ))
            .hint("attenuation(1, 0, 0) is the default: no fall-off"));
        }
        self.attenuation = attenuation;
        Ok(())
    }

    /// A point light under the current matrix.
    ///
    /// # Errors
    /// Where a number is not finite, or the limit `lights` is passed.
    pub fn point(&mut self, position: DVec3, color: Color) -> Result<(), SceneError> {
        let position = finite("the light's position", position)?;
        self.push_light(
            LightKind::Point {
                position,
                attenuation: self.attenuation,
            },
            color,
        )
    }

    /// A directional light; `direction` points towards the light and is turned by the current matrix.
    ///
    /// # Errors
    /// Where the direction is zero, a number is not finite, or the limit `lights` is passed.
    pub fn directional(&mut self, direction: DVec3, color: Color) -> Result<(), SceneError> {
        let direction = finite("the light's direction", direction)?;
        self.push_light(LightKind::Directional { direction }, color)
    }

    /// A parallelogram of `n` x `n` jittered point lights; `color` is the total.
    ///
    /// # Errors
    /// Where `n` is not in 1..=256, a number is not finite, or the limit `lights` is passed.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3};
    /// let mut b = Builder::new();
    /// // A unit square above the scene; what its 4 x 4 points send is white light in all.
    /// b.area_light(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, DVec3::ONE, 4)?;
    /// assert_eq!(b.finish().value.root().lights[0].kind.points(), 16);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn area_light(
        &mut self,
        corner: DVec3,
        edge1: DVec3,
        edge2: DVec3,
        color: Color,
        n: u32,
    ) -> Result<(), SceneError> {
        if !(1..=256).contains(&n) {
            return Err(SceneError::new(format!(
                "an area light has a grid of 1 to 256 points along each edge, not {n}"
            ))
            .hint("areaLight(corner, edge1, edge2, color, 4) takes 16 points"));
        }
        for v in [corner, edge1, edge2] {
            finite("the area light's corner and edges", v)?;
        }
        self.push_light(
            LightKind::Area {
                corner,
                edge1,
                edge2,
                n,
                attenuation: self.attenuation,
            },
            color,
        )
    }

    /// A light that shines into a cone under the current matrix, which moves its two points and leaves its angles; see
    /// [`Spot::new`].
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, scene::Spot};
    /// let mut b = Builder::new();
    /// let (from, at) = (DVec3::new(0.0, 5.0, 0.0), DVec3::ZERO);
    /// b.spot(Spot::new(from, at, (30.0, 5.0), 0.0, b.current_attenuation())?, DVec3::ONE)?;
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// Where the current matrix makes position and target one, a number is not finite, or the limit `lights` is passed.
    pub fn spot(&mut self, spot: Spot, color: Color) -> Result<(), SceneError> {
        finite("the light's position", spot.position())?;
        finite("the light's target", spot.target())?;
        self.push_light(LightKind::Spot(spot), color)
    }

    /// A light that is a surface, under the current matrix.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, scene::{Falloff, SurfaceLight}};
    /// let mut b = Builder::new();
    /// let (center, down) = (DVec3::new(0.0, 3.0, 0.0), DVec3::NEG_Y);
    /// b.surface_light(SurfaceLight::disk(center, down, 0.5, 4, Falloff::Physical)?, DVec3::splat(9.0))?;
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// Where a number is not finite, the current matrix flattens a sphere, or the limits `lights` or, by the triangles of
    /// a mesh, `primitives` are passed.
    pub fn surface_light(&mut self, light: SurfaceLight, color: Color) -> Result<(), SceneError> {
        self.push_light(LightKind::Surface(light), color)
    }

    /// Parallel light with soft shadows; its direction is turned by the current matrix.
    ///
    /// # Errors
    /// Where the direction becomes zero, a number is not finite, or the limit `lights` is passed.
    pub fn sun(&mut self, sun: Sun, color: Color) -> Result<(), SceneError> {
        finite("the light's direction", sun.direction())?;
        self.push_light(LightKind::Sun(sun), color)
    }

    /// A projector of pictures, under the current matrix.
    ///
    /// # Errors
    /// Where the current matrix leaves no direction, a number is not finite, or the limit `lights` is passed.
    pub fn projector(&mut self, projector: Projector, color: Color) -> Result<(), SceneError> {
        for v in [projector.position(), projector.target(), projector.up()] {
            finite("the projector's position, target and up", v)?;
        }
        self.push_light(LightKind::Projector(projector), color)
    }

    /// The fall-off of the lights made now; see [`Builder::attenuation`].
    #[must_use]
    pub fn current_attenuation(&self) -> Attenuation {
        self.attenuation
    }

    /// Which shapes the lights reach that are made from now on; all of them at the start.
    ///
    /// ```
    /// use rtscript::{Builder, DVec3, scene::Links};
    /// let mut b = Builder::new();
    /// let mark = b.begin_define("car")?;
    /// b.sphere(DVec3::ZERO, 1.0)?;
    /// b.end_define(mark, true);
    /// b.instance("car")?;
    /// let car = b.group_called("car")?;
    /// b.light_linking(Links::new(Some(vec![car]), Vec::new())?)?;
    /// b.point(DVec3::splat(5.0), DVec3::ONE)?;
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// Where a group is not one of this scene.
    pub fn light_linking(&mut self, links: Links) -> Result<(), SceneError> {
        if links.groups().any(|id| id.index() >= self.scene.groups.len()) {
            return Err(SceneError::new(
                "a light is linked to a group that this scene does not have",
            ));
        }
        self.links = links;
        Ok(())
    }

    pub(super) fn push_light(&mut self, kind: LightKind, color: Color) -> Result<(), SceneError> {
        self.push_linked(kind, color, self.links.clone())
    }

    pub(super) fn push_linked(
        &mut self,
        kind: LightKind,
        color: Color,
        links: Links,
    ) -> Result<(), SceneError> {
        finite("the light's color", color)?;
        self.require_no_solid()?;
        if self.lights >= self.limits.lights {
            return Err(SceneError::limit("too many lights", "lights", self.limits.lights));
        }
        let triangles = kind.triangles().len();
        self.primitives = self.primitives.saturating_add(triangles);
        if triangles > 0 && self.primitives > self.limits.primitives {
            return Err(SceneError::limit(
                "too many shapes",
                "primitives",
                self.limits.primitives,
            ));
        }
        let kind = match kind {
            LightKind::Directional { .. } | LightKind::Sun(_) => {
                kind.placed(self.ctm.matrix()).ok_or_else(|| {
                    SceneError::new("the light's direction is zero")
                        .hint("directional(direction, color): the direction points towards the light")
                })?
            }
            _ => kind.placed(self.ctm.matrix()).ok_or_else(|| {
                SceneError::new("the current matrix flattens the light to nothing")
                    .class(Code::SingularMatrix)
                    .hint("is a component of scale(...) 0?")
            })?,
        };
        self.lights += 1;
        self.group.lights.push(Light {
            kind,
            color,
            links,
            loc: self.loc,
        });
        Ok(())
    }
}
