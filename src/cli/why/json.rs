//! The answer for programs.

use serde_json::{Value, json};

use super::{
    Answer,
    text::{kind, placing},
    textures,
};
use crate::{
    cli::subject::name_of,
    diag::SourceLoc,
    math::DVec3,
    render::{
        explain::{
            BranchOutcome, ExplainedBranch, ExplainedHit, ExplainedRay, LightSample, LightTerm, Obstacle,
        },
        quantize,
    },
    scene::Object,
    script::CallSite,
};

/// The answer as JSON. Numbers have all their digits, so that the terms add up to the value to the bit; an infinite
/// distance is `null`.
pub(super) fn of(answer: &Answer<'_>) -> Value {
    let s = &answer.scene.settings;
    let json = Json(answer);
    let shown: Vec<Value> = answer
        .shown
        .iter()
        .map(|shown| {
            json!({
                "objects": json.objects(&shown.objects),
                "samples": shown.samples,
                "added": vector(shown.added),
            })
        })
        .collect();
    let made_by: Vec<Value> = answer
        .made_by
        .iter()
        .map(|(object, calls)| {
            let calls: Vec<Value> = calls.iter().map(call).collect();
            json!({
                "object": json.object(object),
                "calls": calls,
            })
        })
        .collect();
    let rays: Vec<Value> = answer.sample.rays.iter().map(|ray| json.ray(ray)).collect();
    json!({
        "scene": answer.subject.name,
        "x": answer.pixel.0,
        "y": answer.pixel.1,
        "size": [s.width, s.height],
        "linear": vector(answer.value),
        "rgb8": answer.value.to_array().map(|v| quantize(v, s.encoding)),
        "samples": s.samples,
        "background": vector(s.background),
        "shown": shown,
        "made_by": made_by,
        "world_from_object": placing(answer).to_cols_array(),
        "sample": answer.number,
        "sample_value": vector(answer.sample.value),
        "sample_share": vector(answer.share),
        "time": answer.sample.time,
        "rays": rays,
    })
}

struct Json<'a>(&'a Answer<'a>);

impl Json<'_> {
    fn ray(&self, ray: &ExplainedRay<'_>) -> Value {
        let mut value = json!({
            "kind": kind(ray.kind),
            "parent": ray.parent,
            "depth": ray.depth,
            "origin": vector(ray.origin),
            "direction": vector(ray.direction),
            "weight": vector(ray.weight),
            "added": vector(ray.added),
            "hit": ray.hit.as_ref().map(|hit| self.hit(hit)),
        });
        if let Some(map) = value.as_object_mut() {
            if let Some(air) = ray.air {
                let (passed, scattered) = (vector(air.passed), vector(air.scattered));
                map.insert(
                    "air".to_owned(),
                    json!({ "passed": passed, "scattered": scattered }),
                );
            }
            if ray.hit.is_none() && self.0.scene.settings.surroundings.environment.is_some() {
                map.insert("environment".to_owned(), json!(vector(ray.beyond)));
            }
        }
        value
    }

    fn hit(&self, hit: &ExplainedHit<'_>) -> Value {
        let material = hit.material.and_then(|id| self.0.scene.materials.get(id.index()));
        let lights: Vec<Value> = hit.lights.iter().map(|light| self.light(light)).collect();
        let branches: Vec<Value> = hit.branches.iter().map(branch).collect();
        let textures = textures::json(self.0.scene, hit);
        json!({
            "t": hit.t,
            "position": vector(hit.position),
            "normal": vector(hit.normal),
            "geometric_normal": vector(hit.geometric_normal),
            "side": if hit.from_front { "front" } else { "back" },
            "number": hit.number,
            "objects": self.objects(&hit.objects),
            "material": hit.material.map(|id| id.0),
            "material_text": material.map(|material| material.text()),
            "textures": textures,
            "ambient": vector(hit.ambient),
            "emission": vector(hit.emission),
            "direct": vector(hit.direct),
            "lights": lights,
            "branches": branches,
        })
    }

    fn light(&self, term: &LightTerm<'_>) -> Value {
        let light = self.0.scene.root().lights.get(term.light);
        let kind = light.map_or("environment", |light| light.kind.word());
        let samples: Vec<Value> = term.samples.iter().map(|sample| self.sample(sample)).collect();
        json!({
            "light": term.light,
            "kind": kind,
            "made_at": light.map(|light| self.place(light.loc)),
            "added": vector(term.added()),
            "points": samples,
        })
    }

    fn sample(&self, sample: &LightSample<'_>) -> Value {
        let obstacles: Vec<Value> = sample.obstacles.iter().map(|o| self.obstacle(o)).collect();
        json!({
            "direction": vector(sample.direction),
            "distance": Some(sample.distance).filter(|d| d.is_finite()),
            "arriving": vector(sample.arriving),
            "visible": vector(sample.visible),
            "diffuse": vector(sample.diffuse),
            "specular": vector(sample.specular),
            "added": vector(sample.added),
            "obstacles": obstacles,
        })
    }

    fn obstacle(&self, obstacle: &Obstacle<'_>) -> Value {
        json!({
            "objects": self.objects(&obstacle.objects),
            "share": vector(obstacle.share),
        })
    }

    fn objects(&self, objects: &[&Object]) -> Vec<Value> {
        objects.iter().map(|object| self.object(object)).collect()
    }

    fn object(&self, object: &Object) -> Value {
        json!({
            "name": name_of(self.0.scene, object),
            "made_at": self.place(object.loc),
        })
    }

    fn place(&self, loc: SourceLoc) -> Value {
        let file = self.0.scene.files.get(usize::from(loc.file));
        json!({ "file": file, "line": loc.line, "column": loc.column })
    }
}

fn branch(branch: &ExplainedBranch) -> Value {
    let (outcome, ray) = match branch.outcome {
        BranchOutcome::Followed(ray) => ("followed", Some(ray)),
        BranchOutcome::TooWeak => ("too weak", None),
        BranchOutcome::TooDeep => ("too deep", None),
        BranchOutcome::TotalReflection => ("total reflection", None),
    };
    json!({
        "kind": kind(branch.kind),
        "share": vector(branch.share),
        "weight": vector(branch.weight),
        "outcome": outcome,
        "ray": ray,
    })
}

fn call(call: &CallSite) -> Value {
    json!({
        "file": call.file,
        "line": call.line,
        "column": call.column,
        "function": call.function,
        "imports": call.imports,
    })
}

fn vector(v: DVec3) -> [f64; 3] {
    v.to_array()
}
