//! The header is as the sources are, and a C program that uses it does what the library does, without a leak.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    env,
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use rtscript::{Limits, NoHost, RenderOptions, RunOptions, Script, parameters::Parameters, render};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder of this test's own program, where the libraries are that were built along with it.
fn deps() -> PathBuf {
    env::current_exe().unwrap().parent().unwrap().to_owned()
}

/// Runs a program that must end well.
fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let texts = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}{}",
        output.status,
        texts[0],
        texts[1]
    );
    output
}

fn exists(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

fn compiler() -> String {
    env::var("CC").unwrap_or_else(|_| "cc".to_owned())
}

/// `examples/render.c` as a program, linked with `library`.
fn build(name: &str, library: &[String]) -> PathBuf {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    run(Command::new(compiler())
        .args([
            "-std=c11",
            "-O1",
            "-g",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
        ])
        .arg("-I")
        .arg(root().join("include"))
        .arg(root().join("examples/render.c"))
        .arg("-o")
        .arg(&program)
        .args(library));
    program
}

/// With the shared library, found where it was built.
fn build_shared() -> PathBuf {
    let deps = deps();
    let deps = deps.display();
    build(
        "render-shared",
        &[
            format!("-L{deps}"),
            format!("-Wl,-rpath,{deps}"),
            "-lrtscript_c".to_owned(),
        ],
    )
}

/// With the static library and what it needs of the system.
fn build_static() -> PathBuf {
    let library = deps().join("librtscript_c.a").display().to_string();
    let system = ["-lpthread", "-lm", "-ldl"].map(str::to_owned);
    build("render-static", &[&[library][..], &system[..]].concat())
}

/// A program to be run by itself: cargo's path of libraries would lead it to the one of an earlier build.
fn alone(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command
        .env_remove("LD_LIBRARY_PATH")
        .env_remove("DYLD_FALLBACK_LIBRARY_PATH");
    command
}

/// What the program prints first, from the library itself.
fn expected() -> String {
    let source = fs::read_to_string(root().join("examples/render.c")).unwrap();
    let scene = source
        .split("*const SCENE =\n")
        .nth(1)
        .unwrap()
        .split(";\n\n")
        .next()
        .unwrap();
    let scene: String = scene
        .lines()
        .map(|line| {
            line.trim()
                .strip_prefix('"')
                .unwrap()
                .strip_suffix("\\n\"")
                .unwrap()
                .replace("\\\"", "\"")
        })
        .map(|line| line + "\n")
        .collect();
    let script = Script::compile("scene.rhai", &scene, &Limits::default()).unwrap();
    let parameters: Parameters = "size=64x48 samples=2 seed=7 radius=1.25".parse().unwrap();
    let run = script.run(&NoHost, &RunOptions::from(&parameters)).unwrap().value;
    let image = render(&run.scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image;
    format!(
        "version {}\nhash {}\nerror scene.rhai:3:3: error: ",
        env!("CARGO_PKG_VERSION"),
        image.hash()
    )
}

fn assert_expected(output: &Output) {
    let printed = String::from_utf8_lossy(&output.stdout);
    let expected = expected();
    assert!(printed.starts_with(&expected), "{printed}\nis not\n{expected}");
}

#[test]
fn the_header_is_as_the_sources_are() {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).unwrap();
    // By file, not by crate: the latter would ask cargo for all dependencies.
    let builder = cbindgen::Builder::new()
        .with_config(config)
        .with_src(root().join("src/lib.rs"));
    let mut made = Vec::new();
    builder.generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    let path = root().join("include/rtscript.h");
    if env::var_os("RTSCRIPT_ACCEPT").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, &made).unwrap();
    }
    assert!(
        fs::read_to_string(&path).unwrap_or_default() == made,
        "include/rtscript.h is stale: RTSCRIPT_ACCEPT=1 cargo test --manifest-path bindings/c/Cargo.toml makes it anew"
    );
}

#[test]
fn every_function_is_in_the_header_and_in_the_program() {
    let read = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    let (header, program) = (read("include/rtscript.h"), read("examples/render.c"));
    let mut count = 0;
    for file in fs::read_dir(root().join("src")).unwrap() {
        let source = fs::read_to_string(file.unwrap().path()).unwrap();
        for after in source.split("extern \"C\" fn rts_").skip(1) {
            let name = format!("rts_{}(", after.split('(').next().unwrap());
            assert!(header.contains(&name), "{name} is not in the header");
            assert!(
                program.contains(&name),
                "{name} is not tried by examples/render.c"
            );
            count += 1;
        }
    }
    assert!(count > 30, "only {count} functions were found");
}

#[test]
fn a_c_program_renders_what_the_library_does() {
    let program = build_shared();
    let picture = program.with_extension("png");
    assert_expected(&run(alone(&program).arg(&picture)));
    assert!(fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn a_c_program_leaks_nothing() {
    let program = build_static();
    if !exists("valgrind") {
        assert_expected(&run(&mut alone(program)));
        return;
    }
    let output = run(alone("valgrind")
        .args([
            "--quiet",
            "--error-exitcode=9",
            "--leak-check=full",
            "--errors-for-leak-kinds=definite",
        ])
        .args(["--show-leak-kinds=definite", "--num-callers=30"])
        .arg(program));
    assert_expected(&output);
}

#[test]
fn the_header_is_a_header_for_cpp_too() {
    if !exists("c++") {
        return;
    }
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("header.cpp");
    let text = "#include \"rtscript.h\"\nint main() { return rts_version() == nullptr; }\n";
    fs::write(&program, text).unwrap();
    run(Command::new("c++")
        .args([
            "-std=c++11",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
            "-fsyntax-only",
            "-I",
        ])
        .arg(root().join("include"))
        .arg(&program));
}
