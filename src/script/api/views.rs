//! Cameras other than the perspective pinhole: projections, the lens, two eyes, a part of the picture; where samples lie.

use rhai::Map;

use super::{int, map, number, string, vec3};
use crate::{
    diag::nearest_names,
    scene::{
        Adaptive, Camera, Crop, Filter, FilterKind, Focus, Lens, Motion, Projection, Region, Sampling,
        SceneError, Shutter, Stereo, StereoLayout,
    },
    script::{
        call::{Call, quoted},
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
};

const FROM: Param = vec3("from", "world units", "where the camera stands");
const AT: Param = vec3("at", "world units", "the point in the middle of the picture");
const UP: Param = vec3("up", "none", "a direction that points up in the picture");
const CIRCLE: Param = number(
    "angle",
    "degrees",
    "what the circle spans, above 0 and at most 360",
);
const WIDTH: Param = number(
    "angle",
    "degrees",
    "what the width spans, above 0 and at most 360",
);
const RADIUS: Param = number("radius", "world units", "radius of the aperture; 0 is a pinhole");
const LAST_FROM: Param = vec3("from", "world units", "where the camera stands in the end");
const LAST_AT: Param = vec3(
    "at",
    "world units",
    "the point in the middle of the picture in the end",
);

const FOCUS: Param = Param::new(
    "focus",
    Kind::NumberOrVec3,
    "world units",
    "distance from the camera along its view, or a point that is sharp; else the point looked at",
);
const APERTURE: Param = map(
    "options",
    "blades: edges of the aperture, 3 to 64, 0 for a circle; rotation of the polygon in degrees",
)
.keys(&["blades", "rotation"]);

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Camera, "orthographic", orthographic)
        .takes(&[&[
            FROM,
            AT,
            UP,
            number("height", "world units", "how much of the world the height of the picture shows, above 0"),
        ]])
        .doc("A camera with parallel rays: what is far away is as large as what is near, as in plans and isometric drawings. The rays leave the plane through from; what lies behind it is not seen.")
        .usage("orthographic([5, 5, 5], [0, 0, 0], [0, 1, 0], 6)")
        .example("orthographic([6, 5, 6], [0, 0, 0], [0, 1, 0], 6.5);\nbackground(\"#cfe3f5\");\nambient(0.1, 0.1, 0.12);\ndirectional([1, 3, 2], [0.9, 0.9, 0.9]);\nfor x in -2..3 { for z in -2..3 {\n  diffuse(hsv(x * 30 + z * 50 + 200, 0.6, 0.9));\n  group { translate(x, 0, z); scale(0.9, 1 + 0.4 * ((x * z) % 3), 0.9); box(); }\n} }")
        .also(&["ortho", "glOrtho", "isometric", "parallel"]),
    Entry::scene(Group::Camera, "fisheye", fisheye)
        .takes(&[
            &[FROM, AT, UP, CIRCLE],
            &[
                FROM,
                AT,
                UP,
                CIRCLE,
                string("frame", "\"circle\": the circle touches the nearer edges of the picture; \"full\": it goes through the corners"),
            ],
        ])
        .doc("A camera that sees around corners: distance from the middle of the picture goes with the angle to the view (equidistant), and angle degrees fit into a circle. Outside the circle the picture is black.")
        .usage("fisheye([0, 1, 0], [0, 1, -1], [0, 1, 0], 180)")
        .example("size(240, 160);\nfisheye([0, 0.4, 0], [0, 0.4, -1], [0, 1, 0], 200);\nsamples(4);\nbackground(\"#cfe3f5\");\nambient(0.1, 0.1, 0.12);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..24 {\n  let angle = i * 15;\n  diffuse(hsv(angle, 0.6, 0.9));\n  group { rotate([0, 1, 0], angle); translate(0, 0, -3); box(0.4, 2, 0.4); }\n}\ngroup { translate(0, -1, 0); diffuse(checker(\"#fff\", \"#567\", 1)); plane(); }")
        .also(&["equidistant", "allsky", "dome", "domemaster"]),
    Entry::scene(Group::Camera, "panorama", panorama)
        .takes(&[
            &[FROM, AT, UP],
            &[
                FROM,
                AT,
                UP,
                WIDTH,
                number("fovy", "degrees", "what the height spans, above 0 and at most 180"),
            ],
        ])
        .doc("A camera that sees everything around it: columns are degrees of longitude, rows degrees of latitude (equirectangular), as viewers of 360-degree pictures and environment maps have it. Without angles 360 by 180 degrees, which pictures twice as wide as high show undistorted at the horizon.")
        .usage("panorama([0, 1, 0], [0, 1, -1], [0, 1, 0])")
        .example("size(240, 120);\npanorama([0, 0.4, 0], [0, 0.4, -1], [0, 1, 0]);\nsamples(4);\nbackground(\"#cfe3f5\");\nambient(0.1, 0.1, 0.12);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..12 {\n  let angle = i * 30;\n  diffuse(hsv(angle, 0.6, 0.9));\n  group { rotate([0, 1, 0], angle); translate(0, 0, -3); sphere(0, 0, 0, 0.5); }\n}\ngroup { translate(0, -1, 0); diffuse(checker(\"#fff\", \"#567\", 1)); plane(); }")
        .also(&["equirectangular", "spherical", "latlong", "vr", "360"]),
    Entry::scene(Group::Camera, "cylindrical", cylindrical)
        .takes(&[
            &[FROM, AT, UP, WIDTH],
            &[
                FROM,
                AT,
                UP,
                WIDTH,
                number("fovy", "degrees", "vertical field of view, between 0 and 180"),
            ],
        ])
        .doc("A camera whose picture is a cylinder around it, unrolled: columns are degrees, and what stands upright stays straight. Without fovy the height follows from the picture's size so that nothing is stretched at the height of the camera.")
        .usage("cylindrical([0, 1, 0], [0, 1, -1], [0, 1, 0], 180)")
        .example("size(240, 80);\ncylindrical([0, 0.4, 0], [0, 0.4, -1], [0, 1, 0], 220);\nsamples(4);\nbackground(\"#cfe3f5\");\nambient(0.1, 0.1, 0.12);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..12 {\n  let angle = i * 30;\n  diffuse(hsv(angle, 0.6, 0.9));\n  group { rotate([0, 1, 0], angle); translate(0, 0, -3); box(0.5, 2, 0.5); }\n}\ngroup { translate(0, -1, 0); diffuse(checker(\"#fff\", \"#567\", 1)); plane(); }")
        .also(&["cylinderCamera", "panoramic"]),
    Entry::scene(Group::Camera, "lens", lens)
        .takes(&[
            &[RADIUS],
            &[
                RADIUS,
                FOCUS,
            ],
            &[
                RADIUS,
                FOCUS,
                APERTURE,
            ],
            &[
                RADIUS,
                APERTURE,
            ],
        ])
        .doc("Depth of field: puts a thin lens into the camera. What is as far away as focus is sharp; the rest is blurred, bright points in the shape of the aperture. Takes many samples. Perspective and orthographic cameras have lenses. The last call counts, for cameras that come after it as well.")
        .usage("lens(0.1, [0, 0, 0])")
        .example("size(160, 100);\ncamera([0, 1.2, 6], [0, 0.2, 0], [0, 1, 0], 35);\nlens(0.25, [0, 0, 1.5], #{ blades: 6 });\nsamples(36);\nbackground(\"#182030\");\nambient(0.05, 0.05, 0.06);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..6 {\n  diffuse(hsv(i * 50, 0.7, 0.9));\n  sphere(i * 0.7 - 2, -0.3, 4 - i * 1.6, 0.45);\n}\ngroup { translate(0, -0.75, 0); diffuse(checker(\"#ccc\", \"#456\", 1)); plane(); }")
        .also(&["aperture", "focal_point", "dof", "depthOfField", "bokeh", "fstop"]),
    Entry::scene(Group::Camera, "cameraTo", camera_to)
        .takes(&[
            &[
                LAST_FROM,
                LAST_AT,
            ],
            &[
                LAST_FROM,
                LAST_AT,
                vec3("up", "none", "a direction that points up in the picture in the end"),
            ],
        ])
        .doc("Moves the camera while light is gathered, which blurs what it passes: from where the camera before it stands, in straight lines at an even pace. Takes many samples. A new camera stands still.")
        .usage("cameraTo([0.2, 1, 5], [0.2, 0, 0])")
        .example("size(160, 100);\ncamera([-0.25, 1, 5], [0, 0, 0], [0, 1, 0], 40);\ncameraTo([0.25, 1, 5], [0, 0, 0]);\nsamples(36);\nbackground(\"#cfe3f5\");\nambient(0.1, 0.1, 0.12);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..5 {\n  diffuse(hsv(i * 60, 0.6, 0.9));\n  sphere(i * 0.9 - 1.8, 0, 3 - i * 1.5, 0.5);\n}\ngroup { translate(0, -0.5, 0); diffuse(checker(\"#fff\", \"#567\", 1)); plane(); }")
        .also(&["motionBlur", "cameraMotion", "pan", "dolly"]),
    Entry::scene(Group::Camera, "shutter", shutter)
        .takes(&[&[
            number("open", "none", "when the shutter opens, as a share of the motion"),
            number("close", "none", "when it closes, up to 1"),
        ]])
        .doc("The part of the motion of the camera and of what is moving that is seen: from open to close, where the motion goes from 0 to 1. A shutter that opens and closes at one time shows a single moment. Default: 0 and 1. The last call counts, for cameras that come after it as well.")
        .usage("shutter(0, 0.5)")
        .example("size(160, 100);\ncamera([0, 1, 6], [0, 0, 0], [0, 1, 0], 40);\ncameraTo([0, 1, 3.5], [0, 0, 0]);\nshutter(0.5, 0.75);\nsamples(36);\nbackground(\"#cfe3f5\");\nambient(0.1, 0.1, 0.12);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..12 {\n  diffuse(hsv(i * 30, 0.6, 0.9));\n  group { rotate([0, 0, 1], i * 30); translate(1.4, 0, 0); sphere(0, 0, 0, 0.3); }\n}")
        .also(&["exposure", "shutterSpeed", "shutter_angle"]),
    Entry::scene(Group::Camera, "stereo", stereo)
        .takes(&[
            &[number("separation", "world units", "from eye to eye; 0 is one eye")],
            &[
                number("separation", "world units", "from eye to eye; 0 is one eye"),
                map("options", "layout: \"side-by-side\", \"top-bottom\" or \"anaglyph\" (red and cyan); convergence: the distance at which both eyes see the same, or \"parallel\"")
                    .keys(&["layout", "convergence"]),
            ],
        ])
        .doc("Two eyes beside each other, each with a half of the picture, or one color of it. What lies at the distance of convergence seems to lie in the picture, nearer things before it: of flat cameras (perspective, orthographic) by default as far as the point looked at, of others endless. In panoramas each column is seen by eyes that look that way. The last call counts, for cameras that come after it as well.")
        .usage("stereo(0.065, #{ layout: \"anaglyph\" })")
        .example("size(240, 120);\ncamera([0, 1, 5], [0, 0, 0], [0, 1, 0], 40);\nstereo(0.3, #{ layout: \"side-by-side\" });\nsamples(4);\nbackground(\"#cfe3f5\");\nambient(0.1, 0.1, 0.12);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nfor i in 0..5 {\n  diffuse(hsv(i * 60, 0.6, 0.9));\n  sphere(i * 0.7 - 1.4, 0, 2 - i, 0.5);\n}\ngroup { translate(0, -0.5, 0); diffuse(checker(\"#fff\", \"#567\", 1)); plane(); }")
        .also(&["3d", "anaglyph", "interocular", "vr180"]),
    Entry::scene(Group::Camera, "sampler", sampler)
        .takes(&[&[string("name", "\"stratified\": jittered in strata; \"sobol\": Owen-scrambled points of Sobol's sequence, which spread more evenly over lights and lens")]])
        .doc("How the samples of a pixel are spread over the pixel, the lens and the lights. Default: \"stratified\". With \"sobol\" a power of two of samples is best.")
        .usage("sampler(\"sobol\")")
        .example("size(160, 120);\nsamples(16);\nsampler(\"sobol\");\nambient(0.05, 0.05, 0.06);\nbackground(\"#cfe3f5\");\nareaLight([-1, 3, 2], [2, 0, 0], [0, 0, 2], [1, 1, 1], 1);\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, -0.2, 0, 0.8);\ngroup { translate(0, -1, 0); diffuse(0.8, 0.8, 0.8); plane(); }")
        .also(&["sobolSampler", "lowDiscrepancy", "quasiMonteCarlo"]),
    Entry::scene(Group::Camera, "filter", filter)
        .takes(&[
            &[string("name", "\"box\", \"tent\", \"gaussian\", \"mitchell\" or \"blackmanHarris\"")],
            &[
                string("name", "\"box\", \"tent\", \"gaussian\", \"mitchell\" or \"blackmanHarris\""),
                number("radius", "pixels", "where the filter ends, from the middle of the pixel; above 0 and at most 16; else 0.5 for box, 1 for tent, 1.5 for gaussian and blackmanHarris, 2 for mitchell"),
            ],
        ])
        .doc("What the surroundings of a pixel count for in it: wider filters make edges smoother, mitchell sharpens them. Each pixel draws its samples from the filter. Takes several samples. Default: \"box\" with a radius of 0.5, the pixel itself.")
        .usage("filter(\"mitchell\")")
        .example("size(160, 100);\nsamples(36);\nfilter(\"gaussian\", 1.5);\nbackground(\"#cfe3f5\");\nambient(0.3, 0.3, 0.3);\ndirectional([2, 4, 3], [0.7, 0.7, 0.7]);\ncamera([0, 1, 5], [0, 0.4, 0], [0, 1, 0], 45);\ndiffuse(checker(\"#fff\", \"#a33\", 0.5));\nplane();")
        .also(&["pixelFilter", "reconstructionFilter", "antialias"]),
    Entry::scene(Group::Camera, "adaptive", adaptive)
        .takes(&[
            &[number("error", "none", "largest error of a pixel, where 1 is from black to white; 0 takes all samples")],
            &[map("options", "error; min: samples that every pixel has, at least 2, by default 8; max: samples of the pixels that need most, as samples(max)").keys(&["error", "min", "max"])],
        ])
        .doc("Antialiasing where it is needed: every pixel has a few samples, and then twice as many again and again until its error is below a bound or it has as many as samples(n) says. The error is the standard error of the pixel's mean as the screen shows it. Pixels that look alike but differ much from a neighbor are looked at again, too. The last call counts.")
        .usage("adaptive(#{ error: 0.01, min: 8, max: 128 })")
        .example("size(160, 120);\nadaptive(#{ error: 0.01, min: 8, max: 64 });\nsampler(\"sobol\");\nambient(0.05, 0.05, 0.06);\nbackground(\"#cfe3f5\");\nareaLight([-1, 3, 2], [2, 0, 0], [0, 0, 2], [1, 1, 1], 1);\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, -0.2, 0, 0.8);\ngroup { translate(0, -1, 0); diffuse(0.8, 0.8, 0.8); plane(); }")
        .also(&["adaptiveSampling", "noiseThreshold", "antialias_threshold", "am3"]),
    Entry::scene(Group::Camera, "crop", crop)
        .takes(&[
            &[
                int("x", "pixels", "first column, from 0"),
                int("y", "pixels", "first row from the top, from 0"),
                int("width", "pixels", "columns, at least 1"),
                int("height", "pixels", "rows, at least 1"),
            ],
            &[map("part", "left, top, right and bottom, each from 0 to 1, as shares of the picture").keys(&["left", "top", "right", "bottom"])],
        ])
        .doc("Renders a part of the picture only, with the very pixels that the whole picture has there. In shares of the picture the part stays the same where its size changes. Where the command is given --region, that counts instead.")
        .usage("crop(#{ left: 0.25, top: 0.25, right: 0.75, bottom: 0.75 })")
        .example("size(320, 240);\ncrop(#{ left: 0.3, top: 0.2, right: 0.8, bottom: 0.6 });\nbackground(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nfor i in 0..60 { sphere(i % 10 - 4.5, i / 10 - 2.5, 0, 0.4); }")
        .also(&["region", "renderBorder", "Start_Column", "window", "subregion"]),
];

fn place(call: &mut Call<'_, '_>) -> Outcome<[crate::math::DVec3; 3]> {
    Ok([call.vec3("from")?, call.vec3("at")?, call.vec3("up")?])
}

/// Places a camera of a projection, with the lens and the eyes there are.
fn view(state: &mut State, [eye, at, up]: [crate::math::DVec3; 3], projection: Projection) -> Outcome {
    state
        .builder
        .view(Camera::with_projection(eye, at, up, projection)?)?;
    DONE
}

fn orthographic(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let place = place(call)?;
    let height = call.number("height")?;
    call.end()?;
    view(state, place, Projection::Orthographic { height })
}

fn fisheye(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let place = place(call)?;
    let angle = call.number("angle")?;
    let full_frame = match call.rest() {
        0 => false,
        _ => {
            let name = call.string("frame")?;
            one_of(call, "frame", &name, &[("circle", false), ("full", true)])?
        }
    };
    call.end()?;
    view(state, place, Projection::Fisheye { angle, full_frame })
}

fn panorama(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let place = place(call)?;
    let (angle, fovy) = match call.rest() {
        0 => (360.0, 180.0),
        _ => (call.number("angle")?, call.number("fovy")?),
    };
    call.end()?;
    view(state, place, Projection::Panorama { angle, fovy })
}

fn cylindrical(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let place = place(call)?;
    let angle = call.number("angle")?;
    let fovy = match call.rest() {
        0 => None,
        _ => Some(call.number("fovy")?),
    };
    call.end()?;
    view(state, place, Projection::Cylindrical { angle, fovy })
}

fn lens(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let mut lens = Lens::new(call.number("radius")?);
    if call.peek().is_some_and(|d| !d.is_map()) {
        lens.focus = match call.rest() > 2 || call.peek().is_some_and(|d| !d.is_float() && !d.is_int()) {
            true => Focus::Point(call.vec3("focus")?),
            false => Focus::Distance(call.number("focus")?),
        };
    }
    if let Some(options) = options(call, &["blades", "rotation"])? {
        if let Some(blades) = options.get("blades") {
            let blades = call.number_from("blades", blades)?;
            if !(blades >= 0.0 && blades <= f64::from(Lens::MAX_BLADES) && blades.trunc() == blades) {
                return Err(call.error(format!(
                    "blades must be a whole number from 3 to {}, or 0, not {blades}",
                    Lens::MAX_BLADES
                )));
            }
            lens.blades = blades as u32;
        }
        if let Some(rotation) = options.get("rotation") {
            lens.rotation = call.number_from("rotation", rotation)?;
        }
    }
    call.end()?;
    state.builder.lens((lens.radius != 0.0).then_some(lens))?;
    DONE
}

fn camera_to(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (eye, at) = (call.vec3("from")?, call.vec3("at")?);
    let up = match call.rest() {
        0 => state.builder.camera_now().up,
        _ => call.vec3("up")?,
    };
    call.end()?;
    state.builder.camera_motion(Some(Motion { eye, at, up }))?;
    DONE
}

fn shutter(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (open, close) = (call.number("open")?, call.number("close")?);
    call.end()?;
    state.builder.shutter(Shutter { open, close })?;
    DONE
}

fn stereo(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let mut stereo = Stereo {
        separation: call.number("separation")?,
        layout: StereoLayout::default(),
        convergence: None,
    };
    if let Some(options) = options(call, &["layout", "convergence"])? {
        if let Some(layout) = options.get("layout") {
            let name = layout.clone().into_immutable_string();
            let name = name.map_err(|_| call.wrong_kind("layout", "a string", layout))?;
            stereo.layout = one_of(call, "layout", &name, &StereoLayout::NAMES)?;
        }
        stereo.convergence = match options.get("convergence") {
            None => None,
            Some(d) if d.clone().into_immutable_string().is_ok_and(|s| s == "parallel") => {
                Some(f64::INFINITY)
            }
            Some(d) => Some(call.number_from("convergence", d)?),
        };
    }
    call.end()?;
    state
        .builder
        .stereo((stereo.separation != 0.0).then_some(stereo))?;
    DONE
}

fn sampler(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let name = call.string("name")?;
    call.end()?;
    let sampling = one_of(call, "name", &name, &Sampling::NAMES)?;
    state.builder.sampling(sampling);
    DONE
}

fn filter(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let name = call.string("name")?;
    let mut filter = Filter::new(one_of(call, "name", &name, &FilterKind::NAMES)?);
    if call.rest() > 0 {
        filter.radius = call.number("radius")?;
    }
    call.end()?;
    state.builder.filter(filter)?;
    DONE
}

fn adaptive(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let mut adaptive = Adaptive { error: 0.01, min: 8 };
    let mut max = None;
    if let Some(options) = options(call, &["error", "min", "max"])? {
        let count = |key: &str| options.get(key).map(|d| call.count_from(key, d, 2)).transpose();
        adaptive.min = count("min")?.unwrap_or(adaptive.min);
        max = count("max")?;
        if let Some(error) = options.get("error") {
            adaptive.error = call.number_from("error", error)?;
        }
    } else {
        adaptive.error = call.number("error")?;
    }
    call.end()?;
    if let Some(max) = max {
        let before = state.builder.settings().samples;
        state.builder.samples(max)?;
        if state.samples.is_some() {
            state.builder.samples(before)?;
        }
    }
    state.builder.adaptive(Some(adaptive))?;
    DONE
}

fn crop(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    const KEYS: [&str; 4] = ["left", "top", "right", "bottom"];
    let crop = if let Some(part) = options(call, &KEYS)? {
        let mut edges = [0.0, 0.0, 1.0, 1.0];
        for (edge, key) in edges.iter_mut().zip(KEYS) {
            if let Some(d) = part.get(key) {
                *edge = call.number_from(key, d)?;
            }
        }
        let [left, top, right, bottom] = edges;
        Crop::Fractions {
            left,
            top,
            right,
            bottom,
        }
    } else {
        let mut region = Region {
            x: call.count("x", 0)?,
            y: call.count("y", 0)?,
            width: call.count("width", 1)?,
            height: call.count("height", 1)?,
        };
        let side = state.limits.image_side;
        if region.width.max(region.height) > side {
            let what = format!("a part of {} x {} is too large", region.width, region.height);
            let error = SceneError::limit(&what, "image_side", side);
            return Err(error
                .hint("a part that reaches beyond the picture ends where that ends; crop(0, 0, 64, 48) is its upper left corner")
                .into());
        }
        let (width, height) = (state.builder.settings().width, state.builder.settings().height);
        if state.size.is_some() {
            // Who asks for another size than the script's gets what there is.
            region = Crop::Pixels(region).region(&Region {
                x: 0,
                y: 0,
                width,
                height,
            });
        } else if region.x >= width || region.y >= height {
            return Err(call
                .error(format!(
                    "the part begins at ({}, {}), outside of the picture of {width} x {height}",
                    region.x, region.y
                ))
                .hint("call size(width, height) before crop(...)"));
        }
        Crop::Pixels(region)
    };
    call.end()?;
    let before = state.builder.settings().crop;
    state.builder.crop(Some(crop))?;
    if state.region.is_some() {
        state.builder.crop(before)?;
    }
    DONE
}

/// A map of options, where one comes next.
pub(super) fn options(call: &mut Call<'_, '_>, known: &[&str]) -> Outcome<Option<Map>> {
    let Some(map) = call
        .peek()
        .and_then(|d| d.read_lock::<Map>().map(|map| map.clone()))
    else {
        return Ok(None);
    };
    call.any()?;
    call.known_keys(&map, known)?;
    Ok(Some(map))
}

/// What the name of a choice stands for.
pub(super) fn one_of<T: Copy>(
    call: &Call<'_, '_>,
    what: &str,
    name: &str,
    choices: &[(&str, T)],
) -> Outcome<T> {
    if let Some((_, chosen)) = choices.iter().find(|(choice, _)| *choice == name) {
        return Ok(*chosen);
    }
    let names: Vec<String> = choices.iter().map(|(name, _)| format!("{name:?}")).collect();
    let error = call.error(format!(
        "{what} must be {}, not {}",
        names.join(" or "),
        quoted(name)
    ));
    let near = nearest_names(name, choices.iter().map(|(name, _)| *name));
    Err(match near.first() {
        Some(near) => error.hint(format!("did you mean \"{near}\"?")),
        None => error,
    })
}
