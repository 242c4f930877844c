//! Links, limits of the shell, closed streams, signals.

use super::*;

use std::{
    os::unix::fs::symlink,
    process::Child,
    thread::sleep,
    time::{Duration, Instant},
};

/// Runs `script` by the shell, the command being `$0`.
pub(super) fn shell(folder: &Folder, script: &str) -> Ran {
    let output = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_rtscript")])
        .current_dir(&folder.0)
        .output()
        .unwrap();
    Ran {
        code: output.status.code().expect("the command ends by itself"),
        stdout: output.stdout,
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn a_link_is_replaced_and_its_target_kept() {
    let folder = Folder::with(BALL);
    folder.write("kept.png", "kept");
    symlink("kept.png", folder.path("scene.png")).unwrap();
    folder.ok(&["scene.rhai"]);
    assert_eq!(fs::read(folder.path("kept.png")).unwrap(), b"kept");
    assert_eq!(size_of(&folder.path("scene.png")), (16, 12));
}

#[test]
fn a_file_that_may_not_grow_is_not_written_at_all() {
    let folder = Folder::with(BALL);
    // 1 block of 512 bytes; the picture takes more.
    let ran = shell(
        &folder,
        "ulimit -f 1; exec \"$0\" scene.rhai -o a.ppm --size 40x40",
    );
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    assert!(ran.stderr.contains("cannot write 'a.ppm'"), "{}", ran.stderr);
    assert_eq!(folder.files(), ["scene.rhai"]);
}

#[test]
fn closed_and_full_streams_do_not_panic() {
    let folder = Folder::with(&format!("{BALL}for i in 0..20000 {{ print(\"line \" + i); }}\n"));
    let gone = shell(
        &folder,
        "{ \"$0\" scene.rhai; echo \"code $?\" >&2; } | head -n 1",
    );
    assert!(gone.stderr.contains("code 0"), "{}", gone.stderr);
    let closed = shell(&folder, "\"$0\" scene.rhai >&- 2>&-");
    assert_eq!(closed.code, 0);
    let gone = shell(
        &folder,
        "{ \"$0\" -q scene.rhai -o - 2>/dev/null; echo \"code $?\" >&2; } | head -c 1",
    );
    assert!(gone.stderr.contains("code 0"), "{}", gone.stderr);
    if Path::new("/dev/full").exists() {
        let full = shell(&folder, "exec \"$0\" -q scene.rhai -o - 2>err >/dev/full");
        assert_eq!(full.code, 4);
        let full = shell(&folder, "exec \"$0\" scene.rhai >/dev/full 2>/dev/full");
        assert_eq!(full.code, 0);
    }
}

/// Starts a script that takes minutes, waits until it runs.
fn start(folder: &Folder, command: &mut Command) -> Child {
    if !folder.path("scene.rhai").exists() {
        folder.write(
            "scene.rhai",
            "print(\"running\");\nlet i = 0;\nloop { i += 1; }\n",
        );
    }
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for(|| fs::read_to_string(format!("/proc/{}/comm", child.id())).is_ok_and(|c| c == "rtscript\n"));
    child
}

pub(super) fn wait_for(mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < Duration::from_secs(20), "waited too long");
        sleep(Duration::from_millis(5));
    }
}

fn read_line(child: &mut Child) {
    use std::io::Read;
    let mut first = [0; 8];
    child.stdout.as_mut().unwrap().read_exact(&mut first).unwrap();
    assert_eq!(&first, b"running\n");
}

pub(super) fn kill(child: &Child, signal: &str) {
    let status = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status()
        .unwrap();
    assert!(status.success());
}

#[test]
fn signals_stop_the_run_and_leave_nothing() {
    for (signal, code, name) in [
        ("-INT", 130, "SIGINT"),
        ("-TERM", 143, "SIGTERM"),
        ("-HUP", 129, "SIGHUP"),
    ] {
        let folder = Folder::new();
        let mut child = start(&folder, &mut folder.command(&["scene.rhai"]));
        read_line(&mut child);
        let asked = Instant::now();
        kill(&child, signal);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code));
        assert!(
            asked.elapsed() < Duration::from_secs(2),
            "{signal} took {:?}",
            asked.elapsed()
        );
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(stderr.contains(&format!("stopped by {name}")), "{stderr}");
        assert_eq!(folder.files(), ["scene.rhai"]);
    }
}

#[test]
fn a_signal_stops_a_render_even_within_a_pixel_and_leaves_the_old_picture() {
    let between_mirrors_of_glass = "size(1, 1);\nmaxDepth(64);\nspecular(1, 1, 1);\ntransmission(1, 1, 1);\n\
        for i in 0..50 { sphere(0, 0, 0, 2.0 - i * 0.01); }\n";
    for costly in [
        "size(4000, 3000);\nsamples(60000);\n",
        between_mirrors_of_glass,
        "for i in 0..4000 { areaLight([i, 9, 0], [1, 0, 0], [0, 0, 1], [1, 1, 1], 256); }\n",
    ] {
        let folder = Folder::with(BALL);
        folder.ok(&["scene.rhai"]);
        let before = fs::read(folder.path("scene.png")).unwrap();
        folder.write("scene.rhai", format!("{BALL}{costly}print(\"running\");\n"));
        let mut child = start(&folder, &mut folder.command(&["scene.rhai"]));
        read_line(&mut child);
        sleep(Duration::from_millis(100));
        let asked = Instant::now();
        kill(&child, "-INT");
        assert_eq!(child.wait().unwrap().code(), Some(130), "{costly}");
        assert!(
            asked.elapsed() < Duration::from_secs(2),
            "took {:?}: {costly}",
            asked.elapsed()
        );
        assert_eq!(fs::read(folder.path("scene.png")).unwrap(), before);
        assert_eq!(folder.files(), ["scene.png", "scene.rhai"]);
    }
}

#[test]
fn a_signal_stops_the_scenes_that_follow_too() {
    let folder = Folder::new();
    folder.write("next.rhai", BALL);
    let mut child = start(&folder, &mut folder.command(&["scene.rhai", "next.rhai"]));
    read_line(&mut child);
    kill(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(143));
    assert_eq!(folder.files(), ["next.rhai", "scene.rhai"]);
}

#[test]
fn a_signal_ends_the_wait_for_standard_input() {
    let folder = Folder::new();
    let mut child = start(&folder, folder.command(&["-"]).stdin(Stdio::piped()));
    let caught = || {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let mask = status
            .lines()
            .find_map(|l| l.strip_prefix("SigCgt:").map(str::trim));
        mask.is_some_and(|m| u64::from_str_radix(m, 16).is_ok_and(|m| m & 2 != 0))
    };
    wait_for(caught);
    // Kept open: `wait` closes what it finds, and the end of the input would race with the signal.
    let input = child.stdin.take();
    kill(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    drop(input);
}

#[cfg(target_os = "linux")]
#[test]
fn a_hangup_that_is_ignored_stays_ignored() {
    let folder = Folder::new();
    let mut command = Command::new("sh");
    let script = "trap '' HUP; exec \"$0\" scene.rhai";
    command
        .args(["-c", script, env!("CARGO_BIN_EXE_rtscript")])
        .current_dir(&folder.0);
    let mut child = start(&folder, &mut command);
    read_line(&mut child);
    kill(&child, "-HUP");
    sleep(Duration::from_millis(200));
    assert!(child.try_wait().unwrap().is_none(), "nohup would not have helped");
    kill(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(143));
}

#[test]
fn assets_and_pictures_do_not_leave_through_links() {
    let folder = Folder::new();
    let outside = Folder::new();
    outside.write("secret.obj", "v 0 0 0\n");
    symlink(&outside.0, folder.path("way-out")).unwrap();
    folder.write("read.rhai", "mesh(\"way-out/secret.obj\");\n");
    folder.write("write.rhai", format!("{BALL}render(\"way-out/a.png\");\n"));
    folder.fails(&["read.rhai"], 6, &["read.rhai:1"]);
    folder.fails(&["write.rhai"], 6, &["write.rhai:5"]);
    assert_eq!(outside.files(), ["secret.obj"]);
}
