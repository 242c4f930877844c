//! The command as a whole, from its start to its end.

use std::{fs, path::PathBuf, process::Command};

use divan::Bencher;

fn command(bencher: Bencher<'_, '_>, text: &str) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("speed");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("scene.rhai"), text).unwrap();
    bencher.bench_local(|| {
        let status = Command::new(env!("CARGO_BIN_EXE_rtscript"))
            .args(["scene.rhai", "--quiet", "-o", "scene.png"])
            .current_dir(&folder)
            .status()
            .unwrap();
        assert!(status.success());
    });
}

#[divan::bench(sample_count = 50)]
fn one_sphere_64_by_64(bencher: Bencher<'_, '_>) {
    command(
        bencher,
        "size(64, 64); light([3, 5, 4], [1, 1, 1]); diffuse([0.8, 0.3, 0.2]); sphere(0, 0, 0, 1);",
    );
}

#[divan::bench(sample_count = 20)]
fn ten_thousand_spheres_by_a_loop(bencher: Bencher<'_, '_>) {
    command(
        bencher,
        "size(64, 64); camera([50, 80, 120], [50, 0, 50], [0, 1, 0], 60); light([0, 90, 0], [1, 1, 1]); \
         for i in 0..10000 { sphere(i % 100, 0, i / 100, 0.4); }",
    );
}
