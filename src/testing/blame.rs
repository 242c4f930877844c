//! Which lines of a script made the pixels that changed.

use std::{cmp::Reverse, collections::BTreeMap};

use super::RenderedFile;
use crate::{
    diag::{Error, SourceLoc},
    render::World,
    scene::Scene,
};

/// Rays through each pixel along either edge, spread evenly: what a pixel shows besides is a thin edge.
const RAYS: u32 = 3;

/// Pixels that show what one call made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineShare {
    /// The script that holds the call; empty for the background.
    pub file: String,
    /// Line of the call, from 1; 0 for the background, and where it is unknown.
    pub line: u32,
    /// Column of the call in characters, from 1; 0 where it is unknown.
    pub column: u32,
    /// That line of the script, without indentation.
    pub text: String,
    /// Pixels that show it now.
    pub now: u64,
    /// Pixels that showed it before; 0 where that is not known.
    pub before: u64,
}

/// Which calls made what the given pixels (column, row from the top) show, most pixels first: a shape, or an instance
/// that holds the shape. A pixel counts once for each call that it shows a part of. `before` is the scene as it was,
/// where that is known; a call that stood in another line is found again by its text.
///
/// # Errors
/// `Limit` where a scene is too large to be rendered.
///
/// ```
/// use rtscript::{Limits, NoHost, RunOptions, testing::{LineShare, changed_lines, changed_pixels, render_text}};
/// let of = |text| render_text("a.rhai", text, &NoHost, &Limits::default(), &RunOptions::default());
/// let before = of("size(8, 8); ambient(1, 1, 1);\nsphere(0, 0, 0, 1);\n")?;
/// let after = of("size(8, 8); ambient(1, 1, 1);\nsphere(0, 0, 0, 2);\n")?;
/// let pixels = changed_pixels(&before.image, &after.image);
/// let lines: Vec<LineShare> = changed_lines(&after, Some(&before), &pixels)?;
/// assert!(lines.iter().any(|share| share.line == 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn changed_lines(
    now: &RenderedFile,
    before: Option<&RenderedFile>,
    pixels: &[(u32, u32)],
) -> Result<Vec<LineShare>, Error> {
    let counts = shown_by(&now.scene, pixels)?;
    let mut shares: Vec<LineShare> = counts
        .iter()
        .map(|(place, count)| share(place.as_ref(), &now.sources, *count, 0))
        .collect();
    if let Some(before) = before {
        for (place, count) in shown_by(&before.scene, pixels)? {
            let old = share(place.as_ref(), &before.sources, 0, count);
            let same = |s: &&mut LineShare| s.before == 0 && (&s.file, &s.text) == (&old.file, &old.text);
            match shares.iter_mut().find(same) {
                Some(same) => same.before = count,
                None => shares.push(old),
            }
        }
    }
    shares.sort_by(|a, b| {
        let most = |s: &LineShare| Reverse(s.now.max(s.before));
        (most(a), &a.file, a.line, a.column).cmp(&(most(b), &b.file, b.line, b.column))
    });
    Ok(shares)
}

/// Counts for each call how many of the pixels show something that it made; `None` is the background.
fn shown_by(scene: &Scene, pixels: &[(u32, u32)]) -> Result<BTreeMap<Option<Place>, u64>, Error> {
    let world = World::compile(scene)?;
    let s = &scene.settings;
    let frame = scene.camera.frame(s.width, s.height);
    let region = s.region();
    let mut counts = BTreeMap::new();
    for &(x, y) in pixels
        .iter()
        .filter(|(x, y)| *x < region.width && *y < region.height)
    {
        let mut places = Vec::new();
        for i in 0..RAYS * RAYS {
            let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(RAYS);
            let (x, y) = (f64::from(region.x + x), f64::from(region.y + y));
            let ray = frame.ray(x + offset(i % RAYS), y + offset(i / RAYS));
            match ray.and_then(|ray| world.nearest_t(&ray, f64::INFINITY)) {
                Some((_, number)) => {
                    let objects = world.objects_of(number);
                    places.extend(objects.iter().map(|object| Some(Place::new(scene, object.loc))));
                }
                None => places.push(None),
            }
        }
        places.sort_unstable();
        places.dedup();
        for place in places {
            *counts.entry(place).or_default() += 1;
        }
    }
    Ok(counts)
}

/// A place in a script.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    file: String,
    line: u32,
    column: u32,
}

impl Place {
    fn new(scene: &Scene, loc: SourceLoc) -> Self {
        Self {
            file: scene
                .files
                .get(usize::from(loc.file))
                .cloned()
                .unwrap_or_default(),
            line: loc.line,
            column: u32::from(loc.column),
        }
    }
}

fn share(place: Option<&Place>, sources: &[(String, String)], now: u64, before: u64) -> LineShare {
    let Some(place) = place else {
        return LineShare {
            file: String::new(),
            line: 0,
            column: 0,
            text: "the background".to_owned(),
            now,
            before,
        };
    };
    let source = sources.iter().find(|(name, _)| *name == place.file);
    let line = source.and_then(|(_, text)| text.lines().nth((place.line as usize).checked_sub(1)?));
    LineShare {
        file: place.file.clone(),
        line: place.line,
        column: place.column,
        text: line.unwrap_or_default().trim().to_owned(),
        now,
        before,
    }
}

#[cfg(test)]
mod tests {
    use super::{super::render_text, *};
    use crate::{Limits, MemoryHost, RunOptions};

    const BEFORE: &str = r#"
size(40, 20); camera([0, 0, 10], [0, 0, 0], [0, 1, 0], 30); ambient(1, 1, 1);
import "pair" as pair;
group { translate(-3, 0, 0); box(2, 2, 2); }
pair::balls();
"#;

    fn rendered(text: &str) -> RenderedFile {
        let pair = "fn balls() {\n  define \"ball\" { sphere(0, 0, 0, 1); }\n  translate(3, 0, 0);\n  instance(\"ball\");\n}";
        let host = MemoryHost::new().with("pair.rhai", pair);
        render_text("a.rhai", text, &host, &Limits::default(), &RunOptions::default()).unwrap()
    }

    fn lines(shares: &[LineShare]) -> Vec<String> {
        let line = |s: &LineShare| format!("{}:{} {} {}->{}", s.file, s.line, s.text, s.before, s.now);
        shares.iter().map(line).collect()
    }

    #[test]
    fn a_pixel_leads_to_the_calls_that_made_what_it_shows() {
        let before = rendered(BEFORE);
        let of = |pixel| lines(&changed_lines(&before, None, &[pixel]).unwrap());
        assert_eq!(of((0, 0)), [":0 the background 0->1"]);
        assert_eq!(
            of((8, 10)),
            ["a.rhai:4 group { translate(-3, 0, 0); box(2, 2, 2); } 0->1"]
        );
        let ball = of((31, 10));
        assert_eq!(
            ball,
            [
                "pair.rhai:2 define \"ball\" { sphere(0, 0, 0, 1); } 0->1",
                "pair.rhai:4 instance(\"ball\"); 0->1"
            ]
        );
        assert!(of((40, 0)).is_empty());
    }

    #[test]
    fn calls_that_moved_down_are_the_same_calls() {
        let before = rendered(BEFORE);
        let now = rendered(
            &BEFORE
                .replace("group", "// moved\n\ngroup")
                .replace("pair::balls", "// pair::balls"),
        );
        let pixels: Vec<(u32, u32)> = (0..40).map(|x| (x, 10)).collect();
        let shares = changed_lines(&now, Some(&before), &pixels).unwrap();
        let cube = shares.iter().find(|s| s.text.starts_with("group")).unwrap();
        assert_eq!((cube.line, cube.now), (6, cube.before));
        assert!(cube.now >= 6, "{}", cube.now);
        let gone = shares.iter().find(|s| s.text.contains("sphere")).unwrap();
        assert!(gone.now == 0 && gone.before >= 6, "{gone:?}");
        assert_eq!(shares[0].text, "the background");
    }
}
