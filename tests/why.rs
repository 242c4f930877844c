//! Why a pixel has its value: the parts add up, and the calls are those that made what it shows.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use rtscript::{
    DirHost, Limits, MemoryHost, NoHost, RunOptions, Script,
    render::World,
    script::CallSite,
    testing::{self, RenderedFile},
};

fn gallery(name: &str, samples: u32) -> RenderedFile {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scripts")
        .join(format!("{name}.rhai"));
    let mut options = RunOptions::default();
    (options.size, options.samples) = (Some((48, 36)), Some(samples));
    testing::render_file(&file, &options).unwrap()
}

#[test]
fn the_parts_of_ten_gallery_pixels_add_up_to_their_values() {
    for (name, x, y) in [
        ("city_at_dusk", 30, 20),
        ("cornell_room", 24, 30),
        ("domino_spiral", 20, 18),
        ("glass_still_life", 24, 20),
        ("hilbert_pipe", 25, 17),
        ("lighthouse", 24, 14),
        ("menger_sponge", 20, 20),
        ("newtons_cradle", 22, 24),
        ("sphereflake", 24, 18),
        ("villarceau_rings", 14, 20),
    ] {
        let rendered = gallery(name, 3);
        let world = World::compile(&rendered.scene).unwrap();
        let explained = world.explain(x, y, &NoHost).unwrap();
        let mut sum = rtscript::DVec3::ZERO;
        let mut terms = rtscript::DVec3::ZERO;
        for sample in &explained.samples {
            assert!(sample.rays[0].hit.is_some() || sample.rays.len() == 1);
            sum += sample.sum() / 3.0;
            // From the smallest parts on: what a light's points give, diffuse and specular by themselves.
            for ray in &sample.rays {
                let Some(hit) = &ray.hit else {
                    terms += ray.weight * ray.beyond / 3.0;
                    continue;
                };
                terms += ray.weight * (hit.ambient + hit.emission) / 3.0;
                for light in hit.lights.iter().flat_map(|light| &light.samples) {
                    terms += ray.weight * light.diffuse / 3.0 + ray.weight * light.specular / 3.0;
                }
            }
        }
        let pixel = rendered.image.pixel(x, y).unwrap();
        assert!(pixel.max_element() > 0.0, "{name} is black at {x},{y}");
        assert_eq!(explained.value, pixel, "{name}");
        for sum in [sum, terms] {
            let relative = (sum - pixel).abs().max_element() / pixel.max_element();
            assert!(
                relative <= 1e-12,
                "{name}: {sum} and {pixel} differ by {relative:e}"
            );
        }
    }
}

/// The calls that made the `nth` object of the root, or of the group `name`.
fn stack(text: &str, modules: &[(&str, &str)], name: &str, nth: usize) -> Vec<String> {
    let mut host = MemoryHost::new();
    for (path, text) in modules {
        host = host.with(path, text.as_bytes());
    }
    let script = Script::compile("a.rhai", text, &Limits::default()).unwrap();
    let options = RunOptions::default();
    let scene = script.run(&host, &options).unwrap().value.scene;
    let group = scene
        .names
        .get(name)
        .copied()
        .unwrap_or(rtscript::scene::ROOT_GROUP);
    let calls = script.call_stack(&host, &options, &scene, (group, nth)).unwrap();
    let shown = |c: &CallSite| {
        let function = c.function.as_deref().unwrap_or("-");
        let imports = if c.imports { " imports" } else { "" };
        format!("{}:{}:{} {function}{imports}", c.file, c.line, c.column)
    };
    calls.iter().map(shown).collect()
}

#[test]
fn the_call_stack_is_that_of_the_very_object() {
    let text = "\
fn ball(x) { sphere(x, 0, 0, 1); }
fn pair(x) {
    ball(x);
    ball(x + 1);
}
for i in 0..4 { pair(i * 2); }
[1, 2].for_each(|| ball(9));
";
    assert_eq!(
        stack(text, &[], "", 0),
        ["a.rhai:1:14 ball", "a.rhai:3:5 pair", "a.rhai:6:17 -"]
    );
    assert_eq!(
        stack(text, &[], "", 5),
        ["a.rhai:1:14 ball", "a.rhai:4:5 pair", "a.rhai:6:17 -"]
    );
    assert_eq!(
        stack(text, &[], "", 9)[..2],
        ["a.rhai:1:14 ball", "a.rhai:7:20 a closure"]
    );
    assert!(stack(text, &[], "", 10).is_empty());
}

#[test]
fn modules_and_groups_are_seen_through() {
    let text = "import \"m\" as m;\ndefine \"two\" { m::ball(); group { m::ball(); } }\ninstance(\"two\");\n";
    let module = "fn ball() { box(1, 1, 1); sphere(0, 0, 0, 1); }\nsphere(0, 0, 0, 2);\n";
    let of = |name, nth| stack(text, &[("m.rhai", module)], name, nth);
    assert_eq!(of("two", 3), ["m.rhai:1:27 ball", "a.rhai:2:38 -"]);
    assert_eq!(of("two", 1), ["m.rhai:1:27 ball", "a.rhai:2:19 -"]);
    assert_eq!(of("", 0), ["m.rhai:2:1 -", "a.rhai:1:8 - imports"]);
    assert_eq!(of("", 1), ["a.rhai:3:1 -"]);
}

#[test]
fn a_script_that_catches_everything_keeps_its_secret() {
    let text = "fn ball() { sphere(0, 0, 0, 1); }\ntry { ball(); } catch { }\n";
    assert!(stack(text, &[], "", 0).is_empty());
}

#[test]
fn a_watched_run_leaves_the_scene_as_it_is() {
    let rendered = gallery("traffic_jam", 1);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/traffic_jam.rhai");
    let text = std::fs::read_to_string(&file).unwrap();
    let host = DirHost::new(file.parent().unwrap());
    let script = Script::compile("traffic_jam.rhai", &text, &Limits::default()).unwrap();
    let options = RunOptions::default();
    let run = script.run(&host, &options).unwrap().value;
    for (id, group) in run
        .scene
        .groups
        .iter()
        .zip(0..)
        .map(|(group, id)| (id, group))
        .take(3)
    {
        let last = group.objects.len() - 1;
        let place = (rtscript::scene::GroupId(id), last);
        let calls = script.call_stack(&host, &options, &run.scene, place).unwrap();
        let loc = group.objects[last].loc;
        assert_eq!(
            (calls[0].line, calls[0].column),
            (loc.line, u32::from(loc.column))
        );
    }
    assert_eq!(
        rendered.scene.root().objects.len(),
        run.scene.root().objects.len()
    );
}
