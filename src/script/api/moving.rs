//! Blocks whose shapes move while light is gathered.

use rhai::{Array, Dynamic};

use super::map;
use crate::{
    math::DVec3,
    scene::AnimatedTransform,
    script::{
        call::{Call, kind_of, number_of},
        lists::tuple,
        options::Options,
        table::{Entry, Group, Kind, Param},
        value::Outcome,
    },
};

const KEYS: &[&str] = &["rotate", "scale", "translate"];

const MOTION: Param = map(
    "motion",
    "translate: how far it moves, a vector; rotate: [x, y, z, degrees] or [axis, degrees], the turn about an axis through the block's origin, more than 360 for more than one; scale: a factor or one for each axis, above 0",
)
.keys(KEYS);

pub(super) const ENTRIES: &[Entry] = &[
    Entry::syntax(Group::Transform, "moving")
        .takes(&[&[
            MOTION,
            Param::new(
                "block",
                Kind::Block,
                "none",
                "statements that make what moves, in an object space of its own under the current matrix",
            ),
        ]])
        .doc("Motion blur: what the block makes moves while the shutter is open, from where it is made, where the motion is 0, to where translate, rotate and scale have taken it, where the motion is 1, evenly in between. A turn is a turn at every moment: a point of a wheel goes along an arc, and translate with rotate rolls it. The motion acts in the space of the current matrix, and the block begins in its origin: translate(...) before the block says where the axis is. Mirrors, glass and shadows show the motion, too. Blocks may stand in each other, in define, and in union, intersection and difference. Lights stand still. shutter(open, close) takes a part of the motion; questions such as raycast and bounds see where it begins. Takes many samples. Saves matrix and material as group { } does.")
        .usage("moving #{ translate: [0.5, 0, 0] } { sphere(0, 0, 0, 0.5); }")
        .example("size(160, 100);\nsamples(36);\ncamera([0, 1.2, 6], [0, 0.2, 0], [0, 1, 0], 38);\nbackground(\"#cfe3f5\");\nambient(0.1, 0.1, 0.12);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfn wheel() {\n  diffuse(0.15, 0.15, 0.18);\n  group { rotate([1, 0, 0], 90); torus(0.7, 0.12); }\n  diffuse(0.8, 0.25, 0.15);\n  for i in 0..6 { group { rotate([0, 0, 1], i * 60); translate(0, 0.35, 0); box(0.14, 0.7, 0.1); } }\n}\ngroup {\n  translate(-1.3, 0.3, 0);\n  moving #{ rotate: [0, 0, 1, -25] } { wheel(); }   // turns in its place\n}\ngroup {\n  translate(1, 0.3, 0);\n  moving #{ translate: [0.36, 0, 0], rotate: [0, 0, 1, -25] } { wheel(); }   // rolls\n}\ngroup { translate(0, -0.52, 0); diffuse(checker(\"#ccc\", \"#567\", 1)); plane(); }")
        .also(&["motionBlur", "motion_blur", "MotionBegin", "ActiveTransform", "TransformTimes", "velocity", "animate", "keyframe"]),
];

/// The motion that a block is given.
pub(in crate::script) fn motion(call: &Call<'_, '_>, given: &Dynamic) -> Outcome<AnimatedTransform> {
    if !given.is_map() {
        return Err(call.wrong_kind("the motion", "a map", given));
    }
    let options = Options::new(call, Some(given), KEYS)?;
    let mut motion = AnimatedTransform::default();
    if let Some(d) = options.get("translate") {
        motion.translate = call.vec3_from("translate", d)?;
    }
    if let Some(d) = options.get("rotate") {
        (motion.axis, motion.degrees) = turn(call, d)?;
    }
    if let Some(d) = options.get("scale") {
        motion.scale = match number_of(d) {
            Some(_) => DVec3::splat(call.number_from("scale", d)?),
            None => call.vec3_from("scale", d)?,
        };
    }
    Ok(motion)
}

/// `[x, y, z, degrees]` or `[axis, degrees]`.
fn turn(call: &Call<'_, '_>, d: &Dynamic) -> Outcome<(DVec3, f64)> {
    let array = d.read_lock::<Array>();
    match array.as_ref().map_or(&[][..], |array| array.as_slice()) {
        [axis, degrees] => {
            let axis = call.vec3_from("the axis of rotate", axis)?;
            Ok((axis, call.number_from("the angle of rotate", degrees)?))
        }
        [_, _, _, _] => {
            let [x, y, z, degrees] = tuple(call, &|| "rotate".to_owned(), d)?;
            Ok((DVec3::new(x, y, z), degrees))
        }
        _ => Err(call
            .error(format!(
                "rotate must be an axis and an angle, [x, y, z, degrees], not {}",
                kind_of(d)
            ))
            .hint("for example rotate: [0, 1, 0, 90]")),
    }
}
