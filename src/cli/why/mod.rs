//! `rtscript why`: how a pixel came to its value.

mod drawing;
mod json;
mod text;
mod textures;

use std::sync::Arc;

use super::{
    args::WhyArgs,
    report::Reporter,
    signals::Signals,
    subject::{Subject, name_of},
    without_place, write_stdout,
};
use crate::{
    color::Color,
    diag::Error,
    output,
    render::{
        RenderOptions, World,
        explain::{ExplainedHit, ExplainedSample, Mean},
        render,
    },
    scene::{Object, Scene},
    script::CallSite,
};

/// What is told of a pixel.
struct Answer<'a> {
    subject: &'a Subject,
    scene: &'a Scene,
    pixel: (u32, u32),
    /// Mean of the samples.
    value: Color,
    /// How many samples it has.
    count: u32,
    /// What the samples show.
    shown: Vec<Shown<'a>>,
    /// The sample that is told of at length, and its number.
    sample: ExplainedSample<'a>,
    number: u32,
    /// What that sample counts for in each channel of the pixel.
    share: Color,
    /// The objects that lead to what that sample shows, outermost first, with the calls that made each.
    made_by: Vec<(&'a Object, Vec<CallSite>)>,
    /// Pictures that the script rendered by itself.
    pictures: usize,
}

/// What some samples of the pixel show.
struct Shown<'a> {
    /// Outermost first; empty for the background.
    objects: Vec<&'a Object>,
    samples: u32,
    /// What they add to the pixel.
    added: Color,
}

impl Shown<'_> {
    /// `sphere in instance "car"`, or the background.
    fn name(&self, scene: &Scene) -> String {
        path_name(scene, &self.objects)
    }
}

/// What objects lead to, and what holds it: `sphere in instance "car"`.
fn path_name(scene: &Scene, objects: &[&Object]) -> String {
    let names: Vec<String> = objects.iter().rev().map(|o| name_of(scene, o)).collect();
    if names.is_empty() {
        "the background".to_owned()
    } else {
        names.join(" in ")
    }
}

/// The hit of the camera ray.
fn first_hit<'r, 'a>(sample: &'r ExplainedSample<'a>) -> Option<&'r ExplainedHit<'a>> {
    sample.rays.first()?.hit.as_deref()
}

/// Tells why a pixel has its value, and draws its rays.
///
/// # Errors
/// Where there is no such pixel; whatever keeps the scene from being made or the picture from being written.
pub(super) fn why(args: &WhyArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<(), Error> {
    if let Some(path) = &args.image {
        output::check_target(path, std::slice::from_ref(&args.file)).map_err(without_place)?;
    }
    let subject = Subject::read(&args.file, args.assets.as_deref(), &args.overrides, signals)?;
    let run = subject.load()?.value;
    let scene = &run.scene;
    let world = World::compile_for(scene, subject.host())?;
    let (x, y) = args.pixel;
    let count = world.samples_at(x, y, subject.host())?;
    let sample = world.explain_sample(x, y, args.sample, subject.host())?;
    let mut mean = Mean::default();
    let mut shown: Vec<(Shown<'_>, Mean)> = Vec::new();
    for index in 0..count {
        let other = world.explain_sample(x, y, index, subject.host())?;
        mean.add(other.value, other.weight);
        let objects = first_hit(&other).map_or(Vec::new(), |hit| hit.objects.clone());
        let is_same = |(s, _): &&mut (Shown<'_>, Mean)| {
            let pairs = s.objects.iter().zip(&objects);
            s.objects.len() == objects.len() && pairs.into_iter().all(|(a, b)| std::ptr::eq(*a, *b))
        };
        let at = shown.iter_mut().find(is_same);
        if let Some((same, part)) = at {
            same.samples += 1;
            part.add(other.value, other.weight);
        } else {
            let mut part = Mean::default();
            part.add(other.value, other.weight);
            let one = Shown {
                objects,
                samples: 1,
                added: Color::ZERO,
            };
            shown.push((one, part));
        }
    }
    let mut shown: Vec<Shown<'_>> = shown
        .into_iter()
        .map(|(shown, part)| Shown {
            added: mean.of(&part),
            ..shown
        })
        .collect();
    shown.sort_by_key(|s| std::cmp::Reverse(s.samples));
    let mut white = Mean::default();
    white.add(Color::ONE, sample.weight);
    let mut made_by = Vec::new();
    for object in first_hit(&sample).map_or(&[][..], |hit| &hit.objects) {
        made_by.push((*object, subject.call_stack(scene, object)?));
    }
    let answer = Answer {
        subject: &subject,
        scene,
        pixel: args.pixel,
        value: mean.value(),
        count,
        shown,
        sample,
        number: args.sample,
        share: mean.of(&white),
        made_by,
        pictures: run.pictures.len(),
    };
    let told = if args.json {
        format!("{:#}\n", json::of(&answer))
    } else {
        text::of(&answer)
    };
    write_stdout(told.as_bytes()).map_err(without_place)?;
    if let Some(path) = &args.image {
        let image = render(scene, &RenderOptions::default(), subject.host())?
            .value
            .image;
        let drawn = drawing::draw(&image, &answer);
        output::save(path, &drawn).map_err(without_place)?;
        reporter.line(&format!("{}  {}", path.display(), drawing::LEGEND));
    }
    Ok(())
}
