//! What goes wrong while files are written: disks that are full or read-only, processes that are killed, two writers.
//! A file holds all of what is written or what it held before, and nothing else stays.

use super::{
    system::{kill, shell, wait_for},
    *,
};

use std::{
    collections::BTreeMap,
    io::Read,
    process::Child,
    thread::sleep,
    time::{Duration, Instant},
};

/// A ball of a size that its caller decides, in a picture of a few disk blocks.
const GRAIN: &str = "\
let radius = param(\"radius\", 1.0);
size(48, 40);
light([0, 3, 5], [1, 1, 1]);
for i in 0..60 {
    diffuse([random(), random(), random()]);
    sphere(random() * 4 - 2, random() * 4 - 2, random(), radius * random());
}
";

const COURSE: &str = "size 8 8\ncamera 0 0 5 0 0 0 0 1 0 45\nambient 1 0 0\nsphere 0 0 0 1\n";

/// Every command that writes files, in a folder made by [`workshop`].
const WRITERS: [&[&str]; 20] = [
    &["scene.rhai"],
    &["scene.rhai", "-o", "out.png"],
    &["scene.rhai", "-o", "out.jpg"],
    &["scene.rhai", "-o", "out.ppm"],
    &["scene.rhai", "--no-recipe"],
    &["scene.rhai", "--show", "depth"],
    &["named.rhai"],
    &["scene.rhai", "other.rhai"],
    &["sweep", "scene.rhai", "-D", "radius=0.5,1"],
    &["sweep", "scene.rhai", "-D", "radius=0.5,1", "--grid"],
    &["rerun", "made.png"],
    &["why", "scene.rhai", "24,20", "--image", "out.png"],
    &["blame", "scene.rhai", "--image", "out.png"],
    &["diff", "scene.rhai", "other.rhai", "-o", "out.png"],
    &["expand", "scene.rhai", "-o", "out.rhai"],
    &["convert", "course.test", "-o", "out.rhai"],
    &["new", "fresh"],
    &["test", "scene.rhai", "--accept"],
    &["test", "known.rhai", "--diffs", "diffs"],
    &[
        "test",
        "known.rhai",
        "--html",
        "out.html",
        "--junit",
        "out.xml",
        "--json",
        "out.json",
    ],
];

/// A folder with scenes, a picture that carries its recipe, and a snapshot that its scene does not have any more.
fn workshop() -> Folder {
    let folder = Folder::with(GRAIN);
    folder.write("other.rhai", GRAIN.replace("0..60", "0..59"));
    folder.write("known.rhai", GRAIN.replace("0..60", "0..58"));
    folder.write(
        "named.rhai",
        format!("{GRAIN}render(\"a.png\");\nrender(\"b.ppm\");\n"),
    );
    folder.write("course.test", COURSE);
    folder.ok(&["-q", "scene.rhai", "-o", "made.png"]);
    folder.ok(&["test", "-q", "--accept", "known.rhai"]);
    folder.write("known.rhai", GRAIN);
    folder
}

impl Folder {
    fn contents(&self) -> BTreeMap<String, Vec<u8>> {
        let read = |name: String| (name.clone(), fs::read(self.path(&name)).unwrap());
        self.files().into_iter().map(read).collect()
    }

    /// Makes the folder hold these files and no others.
    fn restore(&self, contents: &BTreeMap<String, Vec<u8>>) {
        for name in self.files() {
            fs::remove_file(self.path(&name)).unwrap();
        }
        contents.iter().for_each(|(name, bytes)| self.write(name, bytes));
    }
}

/// Says that a test could not test anything.
fn skipped(why: &str) {
    let _ = writeln!(std::io::stderr(), "skipped: {why}");
}

/// Reports tell how long a test took.
fn tells_time(name: &str) -> bool {
    [".html", ".xml", ".json"]
        .iter()
        .any(|ending| name.ends_with(ending))
}

#[test]
fn where_a_file_may_not_grow_there_is_the_old_one_or_the_new_one() {
    let folder = workshop();
    let before = folder.contents();
    for args in WRITERS {
        let whole = folder.run(args);
        assert!([0, 1].contains(&whole.code), "{args:?}: {}", whole.stderr);
        let after = folder.contents();
        let made: Vec<&String> = after.keys().filter(|name| !before.contains_key(*name)).collect();
        assert!(!made.is_empty(), "{args:?} writes no file");
        let mut old = before.clone();
        // Neither of these writes over a file that is none of its own.
        if !["new", "test"].contains(&args[0]) || args.contains(&"--html") {
            made.iter()
                .for_each(|name| _ = old.insert((*name).clone(), b"old".to_vec()));
        }
        // In blocks of 512 bytes, from none until all fits.
        for blocks in 0.. {
            folder.restore(&old);
            let command = format!("ulimit -f {blocks}; exec \"$0\" '{}'", args.join("' '"));
            let ran = shell(&folder, &command);
            for (name, bytes) in folder.contents() {
                let is_new = after.get(&name) == Some(&bytes)
                    || tells_time(&name) && bytes.len().abs_diff(after[&name].len()) < 100;
                let is_whole = old.get(&name) == Some(&bytes) || is_new;
                assert!(
                    is_whole,
                    "{args:?}, {blocks} blocks: '{name}' has {} bytes",
                    bytes.len()
                );
            }
            if ran.code == whole.code {
                break;
            }
            assert_eq!(ran.code, 4, "{args:?}, {blocks} blocks: {}", ran.stderr);
            assert!(ran.stderr.contains("cannot write"), "{args:?}: {}", ran.stderr);
            assert!(!ran.stderr.contains("panicked"), "{args:?}: {}", ran.stderr);
            assert!(blocks < 1000, "{args:?}: {}", ran.stderr);
        }
        folder.restore(&before);
    }
}

#[test]
fn a_watched_scene_outlives_a_full_disk() {
    let folder = Folder::with(GRAIN);
    folder.write("scene.png", "old");
    let before = folder.contents();
    let mut child = Command::new("sh")
        .args([
            "-c",
            "ulimit -f 1; exec \"$0\" watch scene.rhai",
            env!("CARGO_BIN_EXE_rtscript"),
        ])
        .current_dir(&folder.0)
        .stdin(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = Vec::new();
    let mut stderr = child.stderr.take().unwrap();
    while !String::from_utf8_lossy(&said).contains("cannot write 'scene.png'") {
        let mut byte = [0];
        stderr.read_exact(&mut byte).unwrap();
        said.push(byte[0]);
    }
    kill(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(143));
    assert_eq!(folder.contents(), before);
}

#[test]
fn a_full_standard_output_is_an_error() {
    if !Path::new("/dev/full").exists() {
        return skipped("there is no /dev/full here");
    }
    let folder = workshop();
    let commands: [&[&str]; 18] = [
        &["-q", "scene.rhai", "-o", "-"],
        &["--show", "depth", "scene.rhai", "-o", "-"],
        &["expand", "scene.rhai"],
        &["convert", "course.test"],
        &["params", "scene.rhai"],
        &["hash", "scene.rhai"],
        &["why", "scene.rhai", "24,20"],
        &["blame", "scene.rhai"],
        &["diff", "scene.rhai", "other.rhai"],
        &["diff", "--json", "scene.rhai", "other.rhai"],
        &["test", "known.rhai", "--json", "-"],
        &["test", "known.rhai", "--junit", "-"],
        &["rerun", "made.png", "--print"],
        &["help", "sphere"],
        &["completions", "bash"],
        &["man"],
        &["--help"],
        &["--version"],
    ];
    for args in commands {
        let ran = shell(&folder, &format!("exec \"$0\" '{}' >/dev/full", args.join("' '")));
        assert_eq!(ran.code, 4, "{args:?}: {}", ran.stderr);
    }
}

/// Runs a shell script in a mount namespace of its own, whose mounts end with it; `None`, and a line that says so, where
/// the system does not let this process have one.
fn with_mounts(folder: &Folder, script: &str) -> Option<Ran> {
    let has_mounts = Command::new("unshare")
        .args(["-rm", "mount", "-t", "tmpfs", "none", "/tmp"])
        .stderr(Stdio::null())
        .status();
    if !has_mounts.is_ok_and(|status| status.success()) {
        skipped("no mount namespace can be made here");
        return None;
    }
    let output = Command::new("unshare")
        .args(["-rm", "sh", "-c", script, env!("CARGO_BIN_EXE_rtscript")])
        .current_dir(&folder.0)
        .output()
        .unwrap();
    Some(Ran {
        code: output.status.code().expect("the shell ends by itself"),
        stdout: output.stdout,
        stderr: String::from_utf8(output.stderr).unwrap(),
    })
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_keeps_the_old_picture() {
    let folder = Folder::with(GRAIN);
    fs::create_dir(folder.path("disk")).unwrap();
    let mut codes = Vec::new();
    // Pages of 4096 bytes: the picture takes two of them, the old one one.
    for kilobytes in [4, 8, 12, 16] {
        let script = format!(
            "mount -t tmpfs -o size={kilobytes}k none disk && echo old > disk/a.ppm || exit 99
            \"$0\" scene.rhai -o disk/a.ppm >&2; code=$?
            ls -A disk; head -c 3 disk/a.ppm; exit $code"
        );
        let Some(ran) = with_mounts(&folder, &script) else {
            return;
        };
        let left = String::from_utf8(ran.stdout).unwrap();
        match ran.code {
            0 => assert_eq!(left, "a.ppm\nP6\n"),
            4 => {
                assert_eq!(left, "a.ppm\nold");
                assert!(ran.stderr.contains("no space left on device"), "{}", ran.stderr);
            }
            code => panic!("{code}: {}", ran.stderr),
        }
        codes.push(ran.code);
    }
    assert_eq!((codes[0], codes[3]), (4, 0), "{codes:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn where_nothing_can_be_written_nothing_runs() {
    let folder = Folder::with("print(\"ran\");\n");
    fs::create_dir(folder.path("disk")).unwrap();
    // Read-only, and without room for one more name.
    for (options, prepare, why) in [
        ("size=64k", "mount -o remount,ro disk", "read-only file system"),
        ("nr_inodes=2", "true", "no space left on device"),
    ] {
        let script = format!(
            "mount -t tmpfs -o {options} none disk && echo old > disk/a.png && {prepare} || exit 99
            \"$0\" scene.rhai -o disk/a.png; code=$?
            ls -A disk; cat disk/a.png; exit $code"
        );
        let Some(ran) = with_mounts(&folder, &script) else {
            return;
        };
        assert_eq!(ran.code, 4, "{}", ran.stderr);
        assert!(ran.stderr.contains(why), "{}", ran.stderr);
        assert_eq!(String::from_utf8(ran.stdout).unwrap(), "a.png\nold\n");
    }
}

#[test]
fn two_writers_of_one_picture_both_succeed() {
    let folder = Folder::with(GRAIN);
    folder.write("other.rhai", GRAIN.replace("0..60", "0..59"));
    let picture = |scene: &str| {
        folder.ok(&["-q", scene, "-o", "alone.png"]);
        fs::read(folder.path("alone.png")).unwrap()
    };
    let pictures = [picture("scene.rhai"), picture("other.rhai")];
    fs::remove_file(folder.path("alone.png")).unwrap();
    for _ in 0..5 {
        let writers = ["scene.rhai", "other.rhai"]
            .map(|scene| folder.command(&["-q", scene, "-o", "both.png"]).spawn().unwrap());
        for mut writer in writers {
            assert_eq!(writer.wait().unwrap().code(), Some(0));
        }
        assert!(pictures.contains(&fs::read(folder.path("both.png")).unwrap()));
        assert_eq!(folder.files(), ["both.png", "other.rhai", "scene.rhai"]);
    }
}

#[test]
fn a_run_that_cannot_look_at_signals_is_ended_all_the_same() {
    // Nobody reads what it prints, so it waits for ever.
    let folder = Folder::with("loop { print(\"and so on, and so on, and so on\"); }\n");
    let blocked = |args: &[&str]| {
        let child = folder.command(args).stdout(Stdio::piped()).spawn().unwrap();
        // The first bytes are there; a pipe is full some milliseconds later.
        sleep(Duration::from_millis(300));
        child
    };
    let mut child = blocked(&["-q", "scene.rhai"]);
    kill(&child, "-INT");
    wait_for(|| has_ended(&mut child));
    assert_eq!(child.wait().unwrap().code(), Some(130));

    let mut child = blocked(&["-q", "scene.rhai"]);
    let asked = Instant::now();
    kill(&child, "-INT");
    sleep(Duration::from_millis(50));
    kill(&child, "-TERM");
    let in_time = asked.elapsed() < Duration::from_millis(250);
    wait_for(|| has_ended(&mut child));
    let code = child.wait().unwrap().code();
    // A machine so busy that the second signal came late has ended it by the first.
    assert!(code == Some(143) || !in_time && code == Some(130), "{code:?}");
    assert_eq!(folder.files(), ["scene.rhai"]);
}

fn has_ended(child: &mut Child) -> bool {
    child.try_wait().unwrap().is_some()
}

/// Numbers that look random and are the same in each run (xorshift, Marsaglia 2003).
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// What was found after runs that were cut short.
#[derive(Debug, Default)]
struct Found {
    old: usize,
    new: usize,
    /// One of its two pictures new, the other not yet.
    between: usize,
    /// Runs that left a temporary file behind: they were cut short while they wrote.
    temporary: usize,
    /// Runs that had ended before.
    late: usize,
}

/// Runs a scene that overwrites two pictures and cuts it short, `moments` times: half of them anywhere in the run, half
/// while it writes. Each picture has to be the old one or the new one, byte for byte.
fn cut_short(moments: usize, seed: u64, signal: &str) -> Found {
    let scene = "size(900, 700);\nlight([0, 0, 5], [1, 1, 1]);\ndiffuse([0, 1, 0]);\nsphere(0, 0, 0, 1);\nrender(\"a.png\");\n";
    let folder = Folder::with(scene);
    let args = ["-q", "scene.rhai", "-o", "b.ppm"];
    let names = ["a.png", "b.ppm"];
    let read = || names.map(|name| fs::read(folder.path(name)).unwrap());
    folder.write("old.rhai", scene.replace("[0, 1, 0]", "[1, 0, 0]"));
    folder.ok(&["-q", "old.rhai", "-o", "b.ppm"]);
    fs::remove_file(folder.path("old.rhai")).unwrap();
    folder.ok(&["verify", "a.png"]);
    let old = read();
    let start = Instant::now();
    folder.ok(&args);
    let whole = start.elapsed();
    folder.ok(&["verify", "a.png"]);
    let new = read();
    assert!(old[0] != new[0] && old[1] != new[1]);

    let mut found = Found::default();
    let mut random = Random(seed);
    for moment in 0..moments {
        for (name, bytes) in names.iter().zip(&old) {
            folder.write(name, bytes);
        }
        let mut child = folder.command(&args).spawn().unwrap();
        if moment % 2 == 0 {
            sleep(whole.mul_f64(1.1 * random.next()));
        } else {
            // The second temporary file with something in it, or the first; then up to the time its writing takes.
            let picture = if moment % 4 == 1 { ".a.png." } else { ".b.ppm." };
            while !has_ended(&mut child) && !is_writing(&folder, picture) {}
            sleep(Duration::from_micros((5000.0 * random.next()) as u64));
        }
        let is_late = has_ended(&mut child);
        if !is_late {
            kill(&child, signal);
        }
        let code = child.wait().unwrap().code();
        // Ended by the signal itself, before the command has taken it over; by the command; done before.
        let expected = [None, Some(if signal == "-TERM" { 143 } else { 0 }), Some(0)];
        assert!(expected.contains(&code), "{code:?}");
        let now = read();
        for ((name, now), (old, new)) in names.iter().zip(&now).zip(old.iter().zip(&new)) {
            assert!(now == old || now == new, "moment {moment}: half of '{name}'");
        }
        found.late += usize::from(is_late);
        found.old += usize::from(now == old);
        found.new += usize::from(now == new);
        found.between += usize::from(now != old && now != new);
        let others: Vec<String> = folder
            .files()
            .into_iter()
            .filter(|name| name.starts_with('.'))
            .collect();
        assert!(others.iter().all(|name| name.ends_with(".tmp")), "{others:?}");
        found.temporary += usize::from(!others.is_empty());
        others
            .iter()
            .for_each(|name| fs::remove_file(folder.path(name)).unwrap());
        assert_eq!(folder.files(), ["a.png", "b.ppm", "scene.rhai"]);
    }
    found
}

/// Whether a temporary file that begins so has something in it.
fn is_writing(folder: &Folder, start: &str) -> bool {
    let entries = fs::read_dir(&folder.0).unwrap().flatten();
    let mut ours = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(start));
    ours.any(|entry| entry.metadata().is_ok_and(|m| m.len() > 0))
}

#[test]
fn a_process_that_is_killed_leaves_no_half_picture() {
    let found = cut_short(20, 0x5eed, "-KILL");
    assert_eq!(found.old + found.new + found.between, 20, "{found:?}");
}

#[test]
fn a_process_that_is_ended_leaves_no_temporary_file_either() {
    let found = cut_short(20, 0xfee1, "-TERM");
    assert_eq!(found.temporary, 0, "{found:?}");
}

/// Takes minutes: `cargo test --test cli kills_at_200 -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn kills_at_200_moments() {
    let found = cut_short(200, 0xdead, "-KILL");
    let _ = writeln!(std::io::stdout(), "200 kills: {found:?}, half 0");
    assert!(found.old > 0 && found.new > 0 && found.temporary > 0, "{found:?}");
}
