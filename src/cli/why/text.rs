//! The answer for people.

use std::fmt::Write as _;

use super::{Answer, first_hit, path_name, textures};
use crate::{
    cli::subject::{name_of, place, site},
    color::Color,
    math::{DAffine3, DVec3},
    render::{
        RayKind,
        explain::{BranchOutcome, ExplainedBranch, ExplainedHit, ExplainedRay, LightTerm, Obstacle},
        quantize,
    },
    scene::{Encoding, Object, Settings},
};

/// What a sample counts for: an equal share of all, or of the channels that its eye shows.
fn share(share: Color) -> String {
    let largest = share.max_element();
    let channels = ["red", "green", "blue"].into_iter().zip(share.to_array());
    let taken: Vec<(&str, f64)> = channels.filter(|(_, share)| *share != 0.0).collect();
    if taken.is_empty() || taken.iter().any(|(_, share)| *share != largest) {
        return format!("{} of each channel", color(share));
    }
    let equal = (1.0 / largest).round();
    let part = match equal {
        1.0 => "all".to_owned(),
        _ if 1.0 / equal == largest => format!("1/{equal}"),
        _ => number(largest),
    };
    let names: Vec<&str> = taken.iter().map(|(name, _)| *name).collect();
    match names[..] {
        [_, _, _] => part,
        _ => format!("{part} of {}", names.join(" and ")),
    }
}

/// Rays that are told of; of more, how many there are and what they add.
const MOST_RAYS: usize = 64;

/// The answer as text of several lines.
pub(super) fn of(answer: &Answer<'_>) -> String {
    let mut text = Text {
        answer,
        out: String::new(),
    };
    text.value();
    text.shown();
    text.made_by();
    text.look();
    text.rays();
    text.out
}

struct Text<'a> {
    answer: &'a Answer<'a>,
    out: String,
}

impl Text<'_> {
    fn line(&mut self, indent: usize, line: impl AsRef<str>) {
        let line = line.as_ref();
        // Writing into a String does not fail.
        let _ = writeln!(self.out, "{:indent$}{line}", "");
    }

    fn value(&mut self) {
        let a = self.answer;
        let (s, (x, y)) = (&a.scene.settings, a.pixel);
        let encoding = match s.encoding {
            Encoding::Srgb => "sRGB",
            Encoding::Raw => "raw",
        };
        let [r, g, b] = a.value.to_array().map(|v| quantize(v, s.encoding));
        self.line(
            0,
            format!("pixel {x},{y} of {}, {} x {}", a.subject.name, s.width, s.height),
        );
        let v = a.value;
        self.line(2, format!("linear  {} {} {}", v.x, v.y, v.z));
        self.line(
            2,
            format!("8 bits  {r} {g} {b}, #{r:02x}{g:02x}{b:02x}, {encoding}"),
        );
        if a.pictures > 0 {
            self.line(
                2,
                "the script renders by itself: this is the scene as it stands at its end",
            );
        }
    }

    fn shown(&mut self) {
        let a = self.answer;
        let count = a.count;
        if count == 1 {
            return;
        }
        self.line(0, format!("{count} samples show"));
        for shown in &a.shown {
            let mut what = shown.name(a.scene);
            if let Some(object) = shown.objects.last() {
                let _ = write!(what, " ({})", place(a.scene, object.loc));
            }
            let line = format!("{:>5}  {what}, adding {}", shown.samples, color(shown.added));
            self.line(0, line);
        }
    }

    fn made_by(&mut self) {
        let a = self.answer;
        let of = match a.count {
            1 => "it".to_owned(),
            _ => format!("sample {}", a.number),
        };
        if a.made_by.is_empty() {
            let background = color(a.scene.settings.background);
            self.line(0, format!("{of} shows the background, {background}"));
            return;
        }
        // What was hit first, then what holds it.
        for (i, (object, calls)) in a.made_by.iter().rev().enumerate() {
            let name = name_of(a.scene, object);
            let head = if i == 0 {
                format!("{of} shows {name}")
            } else {
                format!("placed by {name}")
            };
            self.line(0, head);
            if calls.is_empty() {
                let file = a.scene.files.get(usize::from(object.loc.file));
                let file = file.map_or("", String::as_str);
                self.source("made at", file, object.loc.line, u32::from(object.loc.column));
            }
            for (depth, call) in calls.iter().enumerate() {
                let verb = match (depth, call.imports) {
                    (_, true) => "imported at",
                    (0, _) => "made at",
                    _ => "called at",
                };
                self.source(verb, &call.file, call.line, call.column);
                if let Some(function) = &call.function {
                    self.line(4, format!("in {function}"));
                }
            }
        }
    }

    fn source(&mut self, verb: &str, file: &str, line: u32, column: u32) {
        let source = self.answer.subject.line(file, line);
        self.line(2, format!("{verb} {}", site(file, line, column)));
        if !source.is_empty() {
            self.line(6, source);
        }
    }

    /// Transform and material of what the sample shows.
    fn look(&mut self) {
        let a = self.answer;
        let Some(hit) = first_hit(&a.sample) else { return };
        let m = placing(a);
        self.line(0, "transform, rows of world from object");
        for i in 0..3 {
            let row = m.matrix3.row(i);
            let all = [row.x, row.y, row.z, m.translation[i]].map(|x| format!("{:>10}", number(x)));
            self.line(2, all.join(" "));
        }
        let Some(id) = hit.material else { return };
        if let Some(material) = a.scene.materials.get(id.index()) {
            self.line(0, format!("material {}", id.0));
            self.line(2, material.text());
            for texture in textures::calls(a.scene, material) {
                self.line(2, texture);
            }
        }
    }

    fn rays(&mut self) {
        let a = self.answer;
        let rays = &a.sample.rays;
        self.line(
            0,
            match a.count {
                1 => "rays; what they add is the pixel".to_owned(),
                _ => {
                    let time = a.sample.time.map(|time| format!(" at time {}", number(time)));
                    format!(
                        "rays of sample {}{}; what they add is {}, of which the pixel takes {}",
                        a.number,
                        time.unwrap_or_default(),
                        color(a.sample.value),
                        share(a.share)
                    )
                }
            },
        );
        for ray in rays.iter().take(MOST_RAYS) {
            self.ray(ray);
        }
        if let Some(rest) = rays.get(MOST_RAYS..).filter(|rest| !rest.is_empty()) {
            let added = rest.iter().fold(Color::ZERO, |sum, ray| sum + ray.added);
            let line = format!(
                "and {} rays more, adding {}; --json has them all",
                rest.len(),
                color(added)
            );
            self.line(2, line);
        }
    }

    fn ray(&mut self, ray: &ExplainedRay<'_>) {
        let a = self.answer;
        let indent = 2 + 2 * ray.depth as usize;
        let kind = kind(ray.kind);
        let (from, dir) = (vector(ray.origin), vector(ray.direction));
        self.line(
            indent,
            format!("{kind} ray from {from} along {dir}, weight {}", color(ray.weight)),
        );
        let indent = indent + 2;
        if let Some(air) = ray.air {
            let (passed, scattered) = (color(air.passed), color(air.scattered));
            self.line(
                indent,
                format!("air       lets {passed} pass and adds {scattered}"),
            );
        }
        let Some(hit) = &ray.hit else {
            let what = match a.scene.settings.surroundings.environment {
                None => "background",
                Some(_) => "environment",
            };
            let (seen, added) = (color(ray.beyond), color(ray.added));
            self.line(indent, format!("leaves for the {what} {seen}, adding {added}"));
            return;
        };
        let side = if hit.from_front { "front" } else { "back" };
        let what = path_name(a.scene, &hit.objects);
        self.line(
            indent,
            format!("meets the {side} of {what} ({})", self.made(&hit.objects)),
        );
        let (at, normal) = (vector(hit.position), vector(hit.normal));
        self.line(
            indent,
            format!("at {at}, distance {}, normal {normal}", number(hit.t)),
        );
        self.hit(indent, ray, hit);
    }

    fn hit(&mut self, indent: usize, ray: &ExplainedRay<'_>, hit: &ExplainedHit<'_>) {
        for texture in textures::values(hit) {
            self.line(indent, texture);
        }
        for (name, term) in [("ambient", hit.ambient), ("emission", hit.emission)] {
            if term != Color::ZERO {
                self.line(indent, format!("{name:8}  {}", color(term)));
            }
        }
        if hit.lights.is_empty() && !self.answer.scene.root().lights.is_empty() {
            self.line(indent, "lights    nothing: neither diffuse nor specular");
        }
        for light in &hit.lights {
            self.light(indent, light);
        }
        for branch in &hit.branches {
            self.branch(indent, branch);
        }
        let local = hit.local();
        self.line(
            indent,
            format!("sends     {}, adding {}", color(local), color(ray.added)),
        );
    }

    fn light(&mut self, indent: usize, term: &LightTerm<'_>) {
        let a = self.answer;
        let (head, points) = match a.scene.root().lights.get(term.light) {
            Some(light) => {
                let name = format!("light {}", term.light);
                let kind = light.kind.word();
                let made = place(a.scene, light.loc);
                (
                    format!("{name:8}  {}  {kind} light ({made})", color(term.added())),
                    light.kind.points(),
                )
            }
            None => {
                let environment = a.scene.settings.surroundings.environment;
                let n = environment.map_or(0, |environment| environment.n());
                (format!("light     {}  environment", color(term.added())), n * n)
            }
        };
        let seen = term.samples.len();
        if seen == 0 {
            self.line(indent, format!("{head}: behind the surface"));
            return;
        }
        let sum = |part: fn(&crate::render::explain::LightSample<'_>) -> Color| {
            term.samples.iter().fold(Color::ZERO, |sum, s| sum + part(s))
        };
        let parts = format!(
            "diffuse {} + specular {}",
            color(sum(|s| s.diffuse)),
            color(sum(|s| s.specular))
        );
        let (mut clear, mut dark) = (0, 0);
        for sample in &term.samples {
            clear += usize::from(sample.visible == Color::ONE);
            dark += usize::from(sample.visible == Color::ZERO);
        }
        let tinted = seen - clear - dark;
        if points == 1 {
            let how = match (clear, dark) {
                (1, _) => "visible",
                (_, 1) => "blocked",
                _ => "tinted",
            };
            self.line(indent, format!("{head}: {how}"));
        } else {
            let behind = (points as usize).saturating_sub(seen);
            let counts = [
                (clear, "visible"),
                (tinted, "tinted"),
                (dark, "blocked"),
                (behind, "behind the surface"),
            ];
            let counts: Vec<String> = counts
                .iter()
                .filter(|(n, _)| *n > 0)
                .map(|(n, what)| format!("{n} {what}"))
                .collect();
            self.line(
                indent,
                format!("{head}: of {points} points {}", counts.join(", ")),
            );
        }
        if dark < seen {
            self.line(indent + 10, parts);
        }
        for (obstacle, points) in grouped(term) {
            let what = path_name(a.scene, &obstacle.objects);
            let verb = if obstacle.share == Color::ZERO {
                "blocked by".to_owned()
            } else {
                format!("tinted {} by", color(obstacle.share))
            };
            let times = if points > 1 {
                format!(", {points} times")
            } else {
                String::new()
            };
            let line = format!("{verb} {what} ({}){times}", self.made(&obstacle.objects));
            self.line(indent + 10, line);
        }
    }

    fn branch(&mut self, indent: usize, branch: &ExplainedBranch) {
        let (kind, share) = (kind(branch.kind), color(branch.share));
        let outcome = match branch.outcome {
            BranchOutcome::Followed(_) => return self.line(indent, format!("{kind} {share}, see below")),
            BranchOutcome::TooWeak => {
                let least = match self.answer.scene.settings.min_weight {
                    Settings::MIN_WEIGHT => "2^-20".to_owned(),
                    other => format!("minWeight, {}", number(other)),
                };
                format!("not followed: weight {} is below {least}", color(branch.weight))
            }
            BranchOutcome::TooDeep => {
                let depth = self.answer.scene.settings.max_depth;
                format!("not followed: maxDepth is {depth}")
            }
            BranchOutcome::TotalReflection => "total internal reflection, goes to the mirror".to_owned(),
        };
        self.line(indent, format!("{kind} {share}, {outcome}"));
    }

    /// Where what was hit was made.
    fn made(&self, objects: &[&Object]) -> String {
        objects
            .last()
            .map_or(String::new(), |object| place(self.answer.scene, object.loc))
    }
}

/// World from object of what the sample shows, through all instances, at the time of the sample.
pub(super) fn placing(answer: &Answer<'_>) -> DAffine3 {
    let scene = answer.scene;
    // Where nothing is blurred, there is but one moment.
    let time = answer.sample.time.unwrap_or(scene.camera.shutter.open);
    let objects = answer.made_by.iter().map(|(object, _)| *object);
    objects.fold(DAffine3::IDENTITY, |m, object| {
        let placed = m * scene.world_from_object(object);
        let group = object.geometry.group();
        match group.and_then(|id| scene.groups.get(id.index())?.motion) {
            Some(motion) => placed * motion.at(time),
            None => placed,
        }
    })
}

/// The different things between a point and a light, with how often each is.
fn grouped<'t, 's>(term: &'t LightTerm<'s>) -> Vec<(&'t Obstacle<'s>, usize)> {
    let mut found: Vec<(&Obstacle<'_>, usize)> = Vec::new();
    for obstacle in term.samples.iter().flat_map(|sample| &sample.obstacles) {
        let is_same = |other: &Obstacle<'_>| {
            let pairs = other.objects.iter().zip(&obstacle.objects);
            other.share == obstacle.share
                && other.objects.len() == obstacle.objects.len()
                && pairs.into_iter().all(|(a, b)| std::ptr::eq(*a, *b))
        };
        match found.iter_mut().find(|(other, _)| is_same(other)) {
            Some((_, count)) => *count += 1,
            None => found.push((obstacle, 1)),
        }
    }
    found
}

pub(super) fn kind(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Camera => "camera",
        RayKind::Reflected => "reflected",
        RayKind::Refracted => "refracted",
    }
}

pub(super) fn color(c: Color) -> String {
    vector(c)
}

fn vector(v: DVec3) -> String {
    format!("{} {} {}", number(v.x), number(v.y), number(v.z))
}

/// A number to six digits.
fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e7).contains(&x.abs()) {
        let (digits, exponent) = {
            let text = format!("{x:.5e}");
            text.split_once('e')
                .map_or((text.clone(), String::new()), |(d, e)| {
                    (d.to_owned(), format!("e{e}"))
                })
        };
        return format!("{}{exponent}", trimmed(&digits));
    }
    let before = format!("{:.0}", x.abs().trunc()).len();
    let places = if x.abs() < 1.0 {
        6
    } else {
        6usize.saturating_sub(before)
    };
    trimmed(&format!("{x:.places$}")).to_owned()
}

/// Without zeros at the end of a fraction.
fn trimmed(digits: &str) -> &str {
    if digits.contains('.') {
        digits.trim_end_matches('0').trim_end_matches('.')
    } else {
        digits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let all = [
            0.0,
            -0.0,
            1.0,
            -0.5,
            1.0 / 3.0,
            12.3456789,
            123456.789,
            2e-7,
            -1e300,
            1e-4,
        ]
        .map(number);
        assert_eq!(
            all,
            [
                "0", "0", "1", "-0.5", "0.333333", "12.3457", "123457", "2e-7", "-1e300", "0.0001"
            ]
        );
        assert_eq!([f64::INFINITY, f64::NAN].map(number), ["inf", "NaN"]);
    }
}
