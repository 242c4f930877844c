//! Lights with a shape of their own: cones, surfaces, pictures.

use rhai::{Array, Map};

use std::sync::Arc;

use super::{assets::mesh_data, color, int, map, number, vec3};
use crate::{
    scene::{Falloff, GroupId, LightMesh, Links, Projector, Spot, SurfaceLight},
    script::{
        call::{Call, TermValue, quoted, texture_of},
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
};

/// Options of lights that are surfaces.
pub(super) const SURFACE_OPTIONS: [&str; 1] = ["falloff"];
const FALLOFF: &str = "falloff: \"attenuation\", each point shines alike in all directions and fades as attenuation() says; \"physical\", by the cosine at the light over the squared distance, from its front only. \"attenuation\" unless given";
const GRID: &str = "n x n jittered points, 1 to 256";

const LINKING_OPTIONS: [&str; 2] = ["except", "only"];
const SPOT_OPTIONS: [&str; 2] = ["penumbra", "tightness"];

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Lights, "spot", spot)
        .takes(&[&[
            vec3("position", "object units", "where it is"),
            vec3("target", "object units", "the point that it shines at"),
            color("color", "its light, on the axis"),
            number("angle", "degrees", "from the axis to the edge of the cone, above 0 and at most 180"),
            map("options", "penumbra: degrees of the soft edge, within the cone, 0 unless given; tightness: the power of the cosine that gathers light in the middle, 0 unless given")
                .keys(&SPOT_OPTIONS)
                .or("#{}"),
        ]])
        .doc("A light that shines into a cone. Its edge goes from full light at angle - penumbra to none at angle as 3x^2 - 2x^3 of the cosine; the rest is that of light(position, color), attenuation() too.")
        .usage("spot([2, 5, 2], [0, 0, 0], [1, 1, 1], 25, #{ penumbra: 8 })")
        .example("camera([0, 3, 7], [0, 0.8, 0], [0, 1, 0], 36);\nambient(0.03, 0.03, 0.04);\ndiffuse(0.8, 0.8, 0.75);\nplane();\nspot([-3, 5, 2], [-0.9, 0, 0], [1, 0.25, 0.2], 16, #{ penumbra: 8 });\nspot([3, 5, 2], [0.9, 0, 0], [0.2, 0.45, 1], 16, #{ penumbra: 8 });\nspot([0, 6, 3], [0, 0, 0], [0.3, 0.9, 0.3], 12);\ndiffuse(0.9, 0.9, 0.9);\nsphere(0, 0.7, 0, 0.7);")
        .also(&["spotLight", "spotlight", "cone light", "penumbra", "flashlight", "cylinder light"]),
    Entry::scene(Group::Lights, "sphereLight", sphere_light)
        .takes(&[&[
            vec3("center", "object units", "its center"),
            number("radius", "object units", "greater than 0"),
            color("color", "its light in all: that of a point light in its center"),
            int("n", "points per edge", GRID),
            map("options", FALLOFF).keys(&SURFACE_OPTIONS).or("#{}"),
        ]])
        .doc("A shining ball that casts soft shadows. Shadow rays go to the part of it that a point sees, evenly by direction. It is not seen itself. Under a matrix that stretches it, it is an ellipsoid.")
        .usage("sphereLight([0, 4, 0], 0.5, [1, 1, 1], 4)")
        .example("camera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nambient(0.05, 0.05, 0.06);\ndiffuse(0.8, 0.8, 0.75);\nplane();\nsphereLight([-2, 3, 2], 0.6, [9, 8.4, 7.5], 5, #{ falloff: \"physical\" });\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, 0.7, 0, 0.7);\ndiffuse(0.2, 0.4, 0.8);\ngroup { translate(1.5, 0.9, 0); box(0.4, 1.8, 0.4); }")
        .also(&["ballLight", "bulb", "softLight", "pointLightRadius", "bulb light"]),
    Entry::scene(Group::Lights, "diskLight", disk_light)
        .takes(&[&[
            vec3("center", "object units", "its center"),
            vec3("normal", "none", "where its front shines to, of any length but 0"),
            number("radius", "object units", "greater than 0"),
            color("color", "its light in all"),
            int("n", "points per edge", GRID),
            map("options", FALLOFF).keys(&SURFACE_OPTIONS).or("#{}"),
        ]])
        .doc("A shining disk that casts soft shadows. It is not seen itself. Under a matrix that stretches it, it is an ellipse.")
        .usage("diskLight([0, 4, 0], [0, -1, 0], 1, [1, 1, 1], 4)")
        .example("camera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nambient(0.05, 0.05, 0.06);\ndiffuse(0.8, 0.8, 0.75);\nplane();\ndiskLight([1.5, 2.2, 0.5], [-1, -1.4, -0.2], 0.7, [5, 4.5, 4], 5, #{ falloff: \"physical\" });\ndiffuse(0.8, 0.25, 0.15);\nfor x in -1..2 { group { translate(x * 1.1, 0.6, 0); cylinder(0.25, 1.2); } }")
        .also(&["discLight", "circularLight", "spot area"]),
    Entry::scene(Group::Lights, "meshLight", mesh_light)
        .takes(&[&[
            map("data", "positions, and indices if it has them, as for mesh(data)").keys(&["indices", "positions"]),
            color("color", "its light in all"),
            int("n", "points per edge", GRID),
            map("options", FALLOFF).keys(&SURFACE_OPTIONS).or("#{}"),
        ]])
        .doc("Triangles that shine and cast soft shadows, each part as bright as its area is large: n x n points on all of them together. The mesh is not seen itself; mesh(data) in a material with emission shows it, in mirrors beside the highlight.")
        .usage("meshLight(#{ positions: [[0, 3, 0], [1, 3, 0], [0, 3, 1]] }, [1, 1, 1], 4)")
        .example("camera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nambient(0.05, 0.05, 0.06);\ndiffuse(0.8, 0.8, 0.75);\nplane();\nlet star = #{ positions: [[0, 3, 0], [0.3, 2.6, 0.4], [-0.3, 2.6, 0.4], [1.2, 3, 0.8], [-1.2, 3, 0.8], [0, 3, -1]], indices: [0, 1, 2, 0, 3, 1, 0, 2, 4, 0, 5, 3, 0, 4, 5] };\nmeshLight(star, [0.9, 0.8, 0.6], 5);\ngroup { ambient(1, 0.9, 0.7); mesh(star); }\ndiffuse(0.2, 0.5, 0.4);\nsphere(0, 0.6, 0, 0.6);")
        .also(&["emissiveMesh", "geometryLight", "triangleLight"]),
    Entry::scene(Group::Lights, "projector", projector)
        .takes(&[&[
            vec3("position", "object units", "where it is"),
            vec3("target", "object units", "where the middle of the picture falls"),
            vec3("up", "none", "a direction that points up in the picture"),
            number("fovy", "degrees", "from the top to the bottom of the picture, between 0 and 180"),
            Param::new("image", Kind::Image, "none", "the picture, or a texture over [0, 1] x [0, 1]"),
            color("color", "what the picture is multiplied by"),
        ]])
        .doc("A slide projector: light from one point through a picture, none beside it. attenuation() counts, as for light(position, color).")
        .usage("projector([0, 2, 5], [0, 1, 0], [0, 1, 0], 30, image(\"wood.png\"), [1, 1, 1])")
        .example("camera([1, 2.2, 6], [0, 0.9, 0], [0, 1, 0], 36);\nambient(0.04, 0.04, 0.05);\ndiffuse(0.85, 0.85, 0.8);\nplane();\ngroup { translate(0, 1.5, -1.5); box(5, 3, 0.1); }\nlet slide = image(#{ width: 3, height: 2, pixels: [[1, 0.1, 0.1], [1, 0.8, 0.1], [0.2, 0.9, 0.2], [0.1, 0.5, 1], [0.5, 0.2, 0.9], [1, 1, 1]] });\nprojector([0, 2, 5], [0, 1.2, -1.4], [0, 1, 0], 24, slide, [1, 1, 1]);\nsphere(0.5, 0.6, 0.6, 0.5);")
        .also(&["slide", "gobo", "cookie", "projectedTexture", "image light"]),
    Entry::scene(Group::Lights, "lightLinking", light_linking)
        .takes(&[&[map("groups", "only: names of the groups whose shapes the lights reach, all shapes unless given; except: names of groups that they do not reach")
            .keys(&LINKING_OPTIONS)]])
        .doc("Which shapes the lights reach that are made from now on, by the names that define gave to groups; a shape in a group in a group is in both. #{ } is for all shapes again. Whatever is in between casts its shadow all the same, and the environment reaches everything.")
        .usage("lightLinking(#{ })")
        .example("camera([0, 2.5, 6], [0, 0.7, 0], [0, 1, 0], 36);\nbackground(\"#20252e\");\nambient(0.05, 0.05, 0.06);\ndiffuse(0.8, 0.8, 0.75);\nplane();\ndefine \"left\" { sphere(-1, 0.8, 0, 0.8); }\ndefine \"right\" { sphere(1, 0.8, 0, 0.8); }\ninstance(\"left\"); instance(\"right\");\nlight([0, 5, 3], [0.35, 0.35, 0.35]);\nlightLinking(#{ only: [\"left\"] });\nlight([-4, 3, 4], [1, 0.3, 0.2]);\nlightLinking(#{ only: [\"right\"] });\nlight([4, 3, 4], [0.2, 0.5, 1]);")
        .also(&["lightGroup", "light_group", "lightMask", "light linking", "excludeLight", "layers", "lightLayers"]),
];

/// The map of options that may be left out.
pub(super) fn options(call: &mut Call<'_, '_>, known: &[&str]) -> Outcome<Map> {
    if call.rest() == 0 {
        return Ok(Map::new());
    }
    let given = call.any()?;
    let Some(options) = given.read_lock::<Map>() else {
        return Err(call.wrong_kind("options", "a map", given));
    };
    call.known_keys(&options, known)?;
    Ok(options.clone())
}

/// The number of an option, or what it is where it is left out.
pub(super) fn number_or(call: &Call<'_, '_>, options: &Map, key: &str, default: f64) -> Outcome<f64> {
    let given = options.get(key);
    given.map_or(Ok(default), |given| call.number_from(key, given))
}

fn spot(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (position, target) = (call.vec3("position")?, call.vec3("target")?);
    let (color, angle) = (call.color("color")?, call.number("angle")?);
    let options = options(call, &SPOT_OPTIONS)?;
    call.end()?;
    let option = |key| number_or(call, &options, key, 0.0);
    let (penumbra, tightness) = (option("penumbra")?, option("tightness")?);
    let attenuation = state.builder.current_attenuation();
    let spot = Spot::new(position, target, (angle, penumbra), tightness, attenuation)?;
    state.builder.spot(spot, color)?;
    DONE
}

/// How the light of a surface fades, as its options say.
pub(super) fn falloff(call: &Call<'_, '_>, options: &Map, state: &State) -> Outcome<Falloff> {
    let Some(given) = options.get("falloff") else {
        return Ok(Falloff::Attenuation(state.builder.current_attenuation()));
    };
    let name = given.clone().into_immutable_string();
    match name
        .map_err(|_| call.wrong_kind("falloff", "a string", given))?
        .as_str()
    {
        "attenuation" => Ok(Falloff::Attenuation(state.builder.current_attenuation())),
        "physical" => Ok(Falloff::Physical),
        other => Err(call.error(format!(
            "falloff must be \"attenuation\" or \"physical\", not {}",
            quoted(other)
        ))),
    }
}

fn sphere_light(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (center, radius) = (call.vec3("center")?, call.number("radius")?);
    let (color, n) = (call.color("color")?, call.count("n", 1)?);
    let options = options(call, &SURFACE_OPTIONS)?;
    call.end()?;
    let falloff = falloff(call, &options, state)?;
    let light = SurfaceLight::sphere(center, radius, n, falloff)?;
    state.builder.surface_light(light, color)?;
    DONE
}

fn disk_light(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (center, normal, radius) = (call.vec3("center")?, call.vec3("normal")?, call.number("radius")?);
    let (color, n) = (call.color("color")?, call.count("n", 1)?);
    let options = options(call, &SURFACE_OPTIONS)?;
    call.end()?;
    let falloff = falloff(call, &options, state)?;
    let light = SurfaceLight::disk(center, normal, radius, n, falloff)?;
    state.builder.surface_light(light, color)?;
    DONE
}

fn mesh_light(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let Some(data) = given.read_lock::<Map>() else {
        return Err(call.wrong_kind("data", "a map", given));
    };
    let mesh = mesh_data(call, &data)?;
    let (color, n) = (call.color("color")?, call.count("n", 1)?);
    let options = options(call, &SURFACE_OPTIONS)?;
    call.end()?;
    let falloff = falloff(call, &options, state)?;
    let corner = |i: u32| mesh.positions.get(i as usize).copied().unwrap_or_default();
    let triangles = mesh.triangles.iter().map(|triangle| triangle.map(corner));
    let shining = Arc::new(LightMesh::new(triangles.collect())?);
    let light = SurfaceLight::mesh(shining, n, falloff)?;
    state.builder.surface_light(light, color)?;
    DONE
}

fn projector(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let places = [call.vec3("position")?, call.vec3("target")?, call.vec3("up")?];
    let fovy = call.number("fovy")?;
    let given = call.any()?;
    let Some(TermValue {
        color: tint,
        texture: Some(texture),
    }) = texture_of(given)
    else {
        return Err(call.wrong_kind("image", "an image", given));
    };
    let color = call.color("color")?;
    call.end()?;
    let image = state.builder.texture(&texture);
    let attenuation = state.builder.current_attenuation();
    let projector = Projector::new(places, fovy, image, attenuation)?;
    state.builder.projector(projector, color * tint)?;
    DONE
}

fn light_linking(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let options = options(call, &LINKING_OPTIONS)?;
    call.end()?;
    let groups = |key: &str| -> Outcome<Option<Vec<GroupId>>> {
        let Some(given) = options.get(key) else {
            return Ok(None);
        };
        let Some(names) = given.read_lock::<Array>() else {
            return Err(call.wrong_kind(key, "an array of names", given));
        };
        let mut groups = Vec::new();
        for (i, name) in names.iter().take(Links::MOST + 1).enumerate() {
            let text = name.clone().into_immutable_string();
            let text = text.map_err(|_| call.wrong_kind(&format!("{key}[{i}]"), "a string", name))?;
            groups.push(state.builder.group_called(&text)?);
        }
        Ok(Some(groups))
    };
    let links = Links::new(groups("only")?, groups("except")?.unwrap_or_default())?;
    state.builder.light_linking(links)?;
    DONE
}
