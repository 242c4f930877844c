//! Calls that make lights to the bit.

use std::fmt::{self, Display};

use super::{Writer, calls::Load};
use crate::{
    color::Color,
    math::{DAffine3, DMat3, DVec3},
    scene::{
        Attenuation, Falloff, Group, GroupId, LightForm, LightKind, Links,
        literal::{Components, Number, Text, Vector},
    },
};

/// The call that makes a light of this kind and color.
pub(super) struct LightCall<'a>(pub(super) &'a LightKind, pub(super) Color);

impl Display for LightCall<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let color = Vector(self.1);
        match *self.0 {
            LightKind::Point { position, .. } => write!(f, "light({}, {color});", Vector(position)),
            LightKind::Directional { direction } => write!(f, "directional({}, {color});", Vector(direction)),
            LightKind::Area {
                corner,
                edge1,
                edge2,
                n,
                ..
            } => {
                let (corner, edge1, edge2) = (Vector(corner), Vector(edge1), Vector(edge2));
                write!(f, "areaLight({corner}, {edge1}, {edge2}, {color}, {n});")
            }
            LightKind::Spot(ref spot) => write!(
                f,
                "spot({}, {}, {color}, {}, #{{ penumbra: {}, tightness: {} }});",
                Vector(spot.position()),
                Vector(spot.target()),
                Number(spot.angle()),
                Number(spot.penumbra()),
                Number(spot.tightness())
            ),
            LightKind::Surface(ref surface) => {
                let n = surface.n();
                match surface.form() {
                    LightForm::Rectangle => {
                        write!(f, "areaLight([0, 0, 0], [1, 0, 0], [0, 1, 0], {color}, {n}")?;
                    }
                    LightForm::Disk => write!(f, "diskLight([0, 0, 0], [0, 0, 1], 1, {color}, {n}")?,
                    LightForm::Sphere => write!(f, "sphereLight([0, 0, 0], 1, {color}, {n}")?,
                    LightForm::Mesh(mesh) => {
                        f.write_str("meshLight(#{ positions: [")?;
                        for (i, p) in mesh.triangles().as_flattened().iter().enumerate() {
                            let separator = if i == 0 { "" } else { ", " };
                            write!(f, "{separator}{}", Components(*p))?;
                        }
                        write!(f, "] }}, {color}, {n}")?;
                    }
                }
                f.write_str(match surface.falloff() {
                    Falloff::Attenuation(_) if *surface.form() == LightForm::Rectangle => {
                        ", #{ falloff: \"attenuation\" });"
                    }
                    Falloff::Attenuation(_) => ");",
                    Falloff::Physical => ", #{ falloff: \"physical\" });",
                })
            }
            LightKind::Sun(ref sun) => write!(
                f,
                "directional({}, {color}, #{{ angle: {}, n: {} }});",
                Vector(sun.direction()),
                Number(sun.angle()),
                sun.n()
            ),
            LightKind::Projector(ref projector) => write!(
                f,
                "projector({}, {}, {}, {}, texture_{}, {color});",
                Vector(projector.position()),
                Vector(projector.target()),
                Vector(projector.up()),
                Number(projector.fovy()),
                projector.image().0
            ),
        }
    }
}

/// The arguments of a call that makes `kind`, and the matrix it is made under where that is not the identity.
///
/// A call multiplies what it is given by the current matrix, which turns -0 into 0, and makes a direction as long as 1,
/// which may change the last digit of one that is. What comes closest is taken where no call gives the same bits.
pub(super) fn arguments(kind: &LightKind) -> (Option<DAffine3>, LightKind) {
    if let LightKind::Surface(surface) = kind {
        return (Some(*surface.placing()), LightKind::Surface(surface.unplaced()));
    }
    let tries = lengths(kind).flat_map(|given| {
        let matrix = keeping_signs(&given);
        [(None, given.clone()), (matrix, given)]
    });
    let is_exact = |(matrix, given): &(Option<DAffine3>, LightKind)| {
        let placed = given.placed(&matrix.unwrap_or(DAffine3::IDENTITY));
        placed.is_some_and(|placed| bits(&placed) == bits(kind))
    };
    let found = { tries }.find(is_exact);
    found.unwrap_or_else(|| (None, kind.clone()))
}

/// The light itself, and a direction in other lengths.
fn lengths(kind: &LightKind) -> impl Iterator<Item = LightKind> + use<'_> {
    let longer = (1..=1024u32).map_while(|i| match kind {
        LightKind::Directional { direction } => Some(LightKind::Directional {
            direction: *direction * (1.0 + f64::from(i) / 1024.0),
        }),
        LightKind::Sun(sun) => {
            let longer = sun.direction() * (1.0 + f64::from(i) / 1024.0);
            Some(LightKind::Sun(sun.with_direction(longer)))
        }
        _ => None,
    });
    [kind.clone()].into_iter().chain(longer)
}

/// The vectors of a light, and whether each is a point.
fn vectors(kind: &LightKind) -> Vec<(DVec3, bool)> {
    let vectors = kind.vectors().into_iter();
    vectors.map(|vector| (vector.value, vector.is_point)).collect()
}

fn bits(kind: &LightKind) -> Vec<[u64; 3]> {
    let vectors = vectors(kind).into_iter();
    vectors.map(|(v, _)| v.to_array().map(f64::to_bits)).collect()
}

/// A matrix that is the identity but for the signs of its zeros, under which the light's vectors keep theirs.
fn keeping_signs(kind: &LightKind) -> Option<DAffine3> {
    let vectors = vectors(kind);
    let has_negative_zero = |v: &DVec3| v.to_array().iter().any(|x| x.to_bits() == 1 << 63);
    if !vectors.iter().any(|(v, _)| has_negative_zero(v)) {
        return None;
    }
    let zero = |is_negative: usize| if is_negative == 1 { -0.0 } else { 0.0 };
    let mut rows = [[0.0; 4]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        let signs = (0..16).map(|n: usize| [0, 1, 2, 3].map(|bit| zero(n >> bit & 1)));
        let mut candidates = signs.map(|mut candidate| {
            if let Some(x) = candidate.get_mut(i) {
                *x = 1.0;
            }
            candidate
        });
        *row = candidates.find(|[a, b, c, t]| {
            vectors.iter().all(|(v, is_point)| {
                let product = a * v.x + b * v.y + c * v.z;
                let placed = if *is_point { product + t } else { product };
                v.to_array().get(i).map(|x| x.to_bits()) == Some(placed.to_bits())
            })
        })?;
    }
    let [x, y, z] = rows.map(|[a, b, c, _]| DVec3::new(a, b, c));
    let linear = DMat3::from_cols(x, y, z).transpose();
    let translation = DVec3::from_array(rows.map(|[.., t]| t));
    Some(DAffine3::from_mat3_translation(linear, translation))
}

impl Writer<'_> {
    pub(super) fn lights(&mut self, group: &Group, part: Option<std::ops::Range<usize>>) -> fmt::Result {
        let lights = part.and_then(|part| group.lights.get(part)).unwrap_or(&[]);
        for light in lights {
            let (matrix, kind) = arguments(&light.kind);
            let attenuation = kind.attenuation().copied().unwrap_or(self.attenuation);
            if attenuation != self.attenuation {
                self.attenuation = attenuation;
                let Attenuation {
                    constant,
                    linear,
                    quadratic,
                } = attenuation;
                self.call(format_args!(
                    "attenuation({}, {}, {});",
                    Number(constant),
                    Number(linear),
                    Number(quadratic)
                ))?;
            }
            self.light_linking(&light.links)?;
            if let LightKind::Projector(projector) = &kind {
                self.register_textures(projector.image().index() + 1)?;
            }
            let call = LightCall(&kind, light.color).to_string();
            let load = matrix.map(|matrix| Load(&matrix).to_string());
            self.under(load.as_deref(), &call, light.loc)?;
        }
        Ok(())
    }

    /// Which groups the lights from here on reach, where that is not so already.
    pub(super) fn light_linking(&mut self, links: &Links) -> fmt::Result {
        if *links == self.links {
            return Ok(());
        }
        self.links = links.clone();
        let end = links.groups().map(|id| id.index() + 1).max().unwrap_or(0);
        self.defines_before(end)?;
        let names = |ids: &[GroupId]| {
            let names = ids.iter().filter_map(|id| self.names.get(id.index()));
            names
                .map(|name| Text(name).to_string())
                .collect::<Vec<_>>()
                .join(", ")
        };
        let only = links.only().map(|only| format!("only: [{}]", names(only)));
        let except = Some(links.except()).filter(|except| !except.is_empty());
        let except = except.map(|except| format!("except: [{}]", names(except)));
        let options: Vec<String> = only.into_iter().chain(except).collect();
        let options = options.join(", ");
        let separator = if options.is_empty() { "" } else { " " };
        // A define that was just written has left what it links its own lights to.
        self.links = links.clone();
        self.call(format_args!(
            "lightLinking(#{{{separator}{options}{separator}}});"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math, scene::Attenuation};

    /// What the call makes of its arguments.
    fn made(kind: &LightKind) -> LightKind {
        let (matrix, given) = arguments(kind);
        given.placed(&matrix.unwrap_or(DAffine3::IDENTITY)).unwrap()
    }

    #[test]
    fn directions_come_back_to_the_bit() {
        let mut needed = 0;
        for i in 1..500 {
            let turn = math::rotation(DVec3::new(1.0, 2.0, 3.0).normalize(), f64::from(i) * 7.7);
            let given = LightKind::Directional {
                direction: DVec3::new(0.3, f64::from(i), 2.0),
            };
            let kind = given.placed(&DAffine3::from_mat3(turn)).unwrap();
            needed += u32::from(bits(&kind.placed(&DAffine3::IDENTITY).unwrap()) != bits(&kind));
            assert_eq!(bits(&made(&kind)), bits(&kind));
        }
        assert!(needed > 0, "some directions take more than themselves");
    }

    #[test]
    fn zeros_keep_their_signs() {
        let zeros = [0.0, -0.0, 1.5, -2.0];
        for i in 0..64 {
            let v = |i: usize| DVec3::new(zeros[i % 4], zeros[i / 4 % 4], zeros[i / 16]);
            let point = LightKind::Point {
                position: v(i),
                attenuation: Attenuation::default(),
            };
            assert_eq!(bits(&made(&point)), bits(&point));
        }
        let area = LightKind::Area {
            corner: DVec3::new(1.0, -0.0, 2.0),
            edge1: DVec3::new(2.0, -0.0, 0.0),
            edge2: DVec3::new(0.0, -0.0, 2.0),
            n: 2,
            attenuation: Attenuation::default(),
        };
        assert_eq!(bits(&made(&area)), bits(&area));
    }
}
