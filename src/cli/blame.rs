//! `rtscript blame`: which lines of a script a picture's time goes to.

use std::{cmp::Reverse, collections::BTreeMap, sync::Arc};

use serde_json::json;

use super::{
    args::BlameArgs, report::Reporter, signals::Signals, subject::Subject, without_place, write_stdout,
};
use crate::{
    diag::Error,
    output,
    render::{
        World,
        show::{PixelCost, costs, heat_map},
    },
    scene::Scene,
};

/// What the pixels cost that show what one line made.
#[derive(Clone, Debug, Default)]
struct Line {
    file: String,
    /// From 1; 0 for the background.
    line: u32,
    text: String,
    pixels: u64,
    rays: u64,
    shadow_rays: u64,
    boxes: u64,
}

impl Line {
    fn work(&self) -> u64 {
        self.rays + self.shadow_rays + self.boxes
    }
}

/// Prints what the pixels of each line cost, dearest first, and writes the heat map.
///
/// # Errors
/// Whatever keeps the scene from being traced or the heat map from being written.
pub(super) fn blame(args: &BlameArgs, signals: &Arc<Signals>, reporter: Reporter) -> Result<(), Error> {
    if let Some(path) = &args.image {
        output::check_target(path, std::slice::from_ref(&args.file)).map_err(without_place)?;
    }
    let subject = Subject::read(&args.file, args.assets.as_deref(), &args.overrides, signals)?;
    let run = subject.load()?;
    let scene = &run.value.scene;
    let costs = costs(scene, subject.host())?;
    let lines = lines(&subject, scene, &costs)?;
    let told = if args.json {
        let list: Vec<_> = lines.iter().map(as_json).collect();
        format!("{:#}\n", json!(list))
    } else {
        table(&lines)
    };
    write_stdout(told.as_bytes()).map_err(without_place)?;
    if let Some(path) = &args.image {
        output::save(path, &heat_map(scene, &costs)).map_err(without_place)?;
        reporter.line(&path.display().to_string());
    }
    Ok(())
}

/// The lines that made what pixels show, dearest first.
fn lines(subject: &Subject, scene: &Scene, costs: &[PixelCost]) -> Result<Vec<Line>, Error> {
    let world = World::compile_for(scene, subject.host())?;
    let mut found: BTreeMap<Option<(u16, u32)>, Line> = BTreeMap::new();
    for cost in costs {
        let object = cost.shows.and_then(|number| world.objects_of(number).pop());
        let place = object.map(|object| (object.loc.file, object.loc.line));
        let line = found.entry(place).or_default();
        line.pixels += 1;
        line.rays += cost.rays;
        line.shadow_rays += cost.shadow_rays;
        line.boxes += cost.boxes;
    }
    let mut lines: Vec<Line> = found
        .into_iter()
        .map(|(place, line)| {
            let Some((file, number)) = place else {
                let text = "the background".to_owned();
                return Line { text, ..line };
            };
            let file = scene.files.get(usize::from(file)).cloned().unwrap_or_default();
            Line {
                text: subject.line(&file, number),
                file,
                line: number,
                ..line
            }
        })
        .collect();
    lines.sort_by_key(|line| (Reverse(line.work()), line.file.clone(), line.line));
    Ok(lines)
}

/// A line for each, then what all of them cost.
fn table(lines: &[Line]) -> String {
    let total: u64 = lines.iter().map(Line::work).sum();
    let sum = |of: fn(&Line) -> u64| lines.iter().map(of).sum::<u64>();
    let head = ["share", "pixels", "rays", "to lights", "boxes"].map(str::to_owned);
    let numbers = |pixels: u64, rays: u64, shadow: u64, boxes: u64| {
        let share = 100.0 * (rays + shadow + boxes) as f64 / total.max(1) as f64;
        [
            format!("{share:.1} %"),
            pixels.to_string(),
            rays.to_string(),
            shadow.to_string(),
            boxes.to_string(),
        ]
    };
    let mut rows = vec![(head, "line".to_owned())];
    for line in lines {
        let place = match line.line {
            0 => line.text.clone(),
            n => format!("{}:{n}  {}", line.file, line.text),
        };
        rows.push((
            numbers(line.pixels, line.rays, line.shadow_rays, line.boxes),
            place,
        ));
    }
    let all = numbers(
        sum(|l| l.pixels),
        sum(|l| l.rays),
        sum(|l| l.shadow_rays),
        sum(|l| l.boxes),
    );
    rows.push((all, "all".to_owned()));
    let widths: Vec<usize> = (0..5)
        .map(|i| {
            rows.iter()
                .filter_map(|(cells, _)| cells.get(i))
                .map(String::len)
                .max()
                .unwrap_or(0)
        })
        .collect();
    let mut text = String::new();
    for (cells, place) in &rows {
        for (cell, width) in cells.iter().zip(&widths) {
            text += &format!("{cell:>width$}  ");
        }
        text += place;
        text.push('\n');
    }
    text
}

fn as_json(line: &Line) -> serde_json::Value {
    json!({
        "file": Some(&line.file).filter(|_| line.line > 0),
        "line": Some(line.line).filter(|n| *n > 0),
        "text": line.text,
        "pixels": line.pixels,
        "rays": line.rays,
        "shadow_rays": line.shadow_rays,
        "boxes": line.boxes,
    })
}
