//! What looks wrong with a scene is told, and nothing else is.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use rtscript::{
    DirHost, Limits, RunOptions,
    render::inspect,
    source,
    testing::{find_scenes, render_file},
};

fn scenes(folder: &str) -> Vec<PathBuf> {
    find_scenes(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap()
}

#[test]
fn a_black_picture_comes_with_a_sentence() {
    let mut black = 0;
    for scene in scenes("tests/scenes") {
        let Ok(rendered) = render_file(&scene, &RunOptions::default()) else {
            continue;
        };
        if rendered.image.rgb8().iter().all(|value| *value == 0) {
            black += 1;
            let told = !rendered.warnings.is_empty();
            assert!(told, "{} is black without a sentence", scene.display());
        }
    }
    assert!(black > 0);
}

/// The classes of what `rtscript check` has to say about the gallery, whose pictures are as they are meant to be.
#[test]
fn sound_scenes_are_left_alone() {
    let mut told = Vec::new();
    for path in scenes("scripts") {
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let host = DirHost::new(path.parent().unwrap());
        let mut options = RunOptions::default();
        (options.dry, options.lint) = (true, true);
        let run = source::load(name, &text, &host, &Limits::default(), &options).unwrap();
        let mut warnings = run.warnings;
        warnings.extend(inspect(&run.value.scene, &host).unwrap());
        told.extend(warnings.iter().map(|d| format!("{name}: {}", d.code.name())));
    }
    // Modules make nothing by themselves; one gable of the lighthouse is behind the other.
    told.retain(|line| !line.ends_with(": empty-scene"));
    assert_eq!(told, ["lighthouse: unseen-shape"]);
}
