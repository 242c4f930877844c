//! `rtscript test` and `rtscript hash`.

use super::*;

/// A ball before a wall; what the tests change is one of them.
const SCENE: &str = "\
size(40, 30); camera([0, 0, 6], [0, 0, 0], [0, 1, 0], 40);
light([3, 3, 5], [1, 1, 1]);
diffuse([0.2, 0.4, 0.8]);
group { translate(0, 0, -2); box(6, 4, 0.2); }
diffuse([1, 0.5, 0.2]);
sphere(0, 0, 0, 0.8);
";

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A folder with one scene on record.
fn on_record() -> Folder {
    let folder = Folder::with(SCENE);
    folder.ok(&["test", "--accept", "scene.rhai"]);
    folder
}

impl Folder {
    /// Changes the scene's script.
    fn edit(&self, from: &str, to: &str) {
        let script = fs::read_to_string(self.path("scene.rhai")).unwrap();
        assert!(script.contains(from), "no {from:?} in the script");
        self.write("scene.rhai", script.replacen(from, to, 1));
    }

    /// Runs `test` with these arguments and expects the exit code and texts on standard output.
    #[track_caller]
    fn tests(&self, args: &[&str], code: i32, texts: &[&str]) -> String {
        let ran = self.run(&[&["test"], args].concat());
        let shown = text(&ran.stdout);
        assert_eq!(ran.code, code, "{args:?}: {shown}{}", ran.stderr);
        for text in texts {
            assert!(shown.contains(text), "{args:?}: no {text:?} in: {shown}");
        }
        shown
    }

    fn answers(&self, args: &[&str], answers: &str) -> (i32, String) {
        let mut child = self
            .command(args)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(answers.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        (output.status.code().unwrap(), text(&output.stdout))
    }
}

#[test]
fn a_new_scene_fails_until_it_is_accepted() {
    let folder = Folder::with(SCENE);
    let hash = folder.hash(&["-o", "x.png"]);
    fs::remove_file(folder.path("x.png")).unwrap();
    folder.tests(
        &["scene.rhai"],
        1,
        &["NEW       scene.rhai", &hash, "1 scene: 1 new", "--accept"],
    );
    assert_eq!(folder.files(), ["scene.rhai"]);
    folder.tests(
        &["--accept", "scene.rhai"],
        0,
        &["accepted  scene.rhai", "1 scene: 1 accepted"],
    );
    assert_eq!(folder.files(), ["scene.rhai", "scene.rtsnap", "scene.rtsnap.png"]);
    assert_eq!(size_of(&folder.path("scene.rtsnap.png")), (40, 30));
    let snapshot = fs::read_to_string(folder.path("scene.rtsnap")).unwrap();
    for line in [
        "rtscript snapshot 1",
        "parameters none",
        "size 40 x 30",
        "samples 1",
        &format!("hash {hash}"),
        "holds objects 2 lights 1 materials 2",
    ] {
        assert!(snapshot.lines().any(|l| l == line), "no {line:?} in {snapshot}");
    }
    folder.tests(&["scene.rhai"], 0, &["ok        scene.rhai", "1 scene: 1 passed"]);
    // A scene with a snapshot is found without being named.
    folder.tests(&[], 0, &["1 scene: 1 passed"]);
}

#[test]
fn a_change_is_measured_and_led_back_to_its_lines() {
    let folder = on_record();
    folder.edit("sphere(0, 0, 0, 0.8)", "// a comment\nsphere(0.5, 0, 0, 0.8)");
    let shown = folder.tests(
        &[],
        1,
        &[
            "CHANGED   scene.rhai",
            "of 1200 pixels differ",
            "FLIP 0.",
            "shows scene.rhai:7  sphere(0.5, 0, 0, 0.8);",
            "shows scene.rhai:4  group { translate(0, 0, -2); box(6, 4, 0.2); }",
            "scene - object 1 sphere { center: (0, 0, 0), radius: 0.8 } material 1 at 6:1",
            "scene + object 1 sphere { center: (0.5, 0, 0), radius: 0.8 } material 1 at 7:1",
            "1 scene: 1 changed",
        ],
    );
    assert!(!shown.contains("light 0"), "{shown}");
    // Nothing was written.
    assert_eq!(folder.files(), ["scene.rhai", "scene.rtsnap", "scene.rtsnap.png"]);
}

#[test]
fn a_light_that_moved_is_named_though_no_pixel_shows_it() {
    let folder = on_record();
    folder.edit("[3, 3, 5]", "[3, 3, 4]");
    folder.tests(
        &[],
        1,
        &[
            "scene - light 0 point 3 3 5",
            "scene + light 0 point 3 3 4",
            "at 2:1",
        ],
    );
}

#[test]
fn another_way_of_writing_the_same_picture_passes() {
    let folder = on_record();
    folder.edit("size(40, 30);", "size(40, 30); // as before\n\nlet unused = 3;");
    folder.tests(&[], 0, &["1 scene: 1 passed"]);
}

#[test]
fn what_a_script_prints_and_warns_of_is_guarded_too() {
    let folder = on_record();
    folder.edit("size(40, 30);", "size(40, 30); print(`hello`);");
    let shown = folder.tests(&[], 1, &["printed + \"hello\""]);
    assert!(!shown.contains("hash"), "{shown}");
    folder.ok(&["test", "--accept"]);
    folder.edit("print(`hello`)", "print(`bye`)");
    folder.tests(&[], 1, &["printed - \"hello\"", "printed + \"bye\""]);
}

#[test]
fn pictures_that_a_script_renders_are_all_guarded() {
    let folder = Folder::with(&format!(
        "{SCENE}render(\"a.png\");\nsphere(1, 1, 0, 0.2);\nrender();\n"
    ));
    folder.ok(&["test", "--accept", "scene.rhai"]);
    let snapshot = fs::read_to_string(folder.path("scene.rtsnap")).unwrap();
    assert!(snapshot.contains("before \"a.png\" 40 x 30 hash "), "{snapshot}");
    assert!(!folder.path("a.png").exists());
    folder.edit(
        "sphere(0, 0, 0, 0.8);\nrender(\"a.png\");",
        "render(\"a.png\");\nsphere(0, 0, 0, 0.8);",
    );
    let shown = folder.tests(&[], 1, &["before it 1 picture -> 1 picture, not the same"]);
    assert!(!shown.contains("pixels differ"), "{shown}");
}

#[test]
fn a_tolerance_lets_small_changes_pass_and_no_others() {
    let folder = on_record();
    folder.edit("[1, 0.5, 0.2]", "[1, 0.5, 0.21]");
    folder.tests(&[], 1, &["CHANGED"]);
    folder.tests(
        &["--tolerance", "0.02"],
        0,
        &["similar   scene.rhai", "1 within the tolerance"],
    );
    folder.tests(&["--tolerance", "0.00001"], 1, &["CHANGED"]);
    folder.edit("[1, 0.5, 0.21]", "[0.2, 1, 0.2]");
    folder.tests(&["--tolerance", "0.02"], 1, &["CHANGED"]);
    // Without a reference picture there is nothing to measure by.
    let folder = Folder::with(SCENE);
    folder.ok(&["test", "--accept", "--no-pictures", "scene.rhai"]);
    assert_eq!(folder.files(), ["scene.rhai", "scene.rtsnap"]);
    folder.tests(&[], 0, &["ok"]);
    folder.edit("[1, 0.5, 0.2]", "[1, 0.5, 0.21]");
    folder.tests(&["--tolerance", "1"], 1, &["there is no reference picture"]);
    folder.fails(&["test", "--tolerance", "2"], 2, &["from 0 (exact) to 1"]);
}

#[test]
fn large_scenes_are_put_on_record_small() {
    let folder = Folder::with(&SCENE.replace("size(40, 30)", "size(4000, 3000)"));
    folder.ok(&[
        "test",
        "--accept",
        "scene.rhai",
        "--size",
        "20x15",
        "--samples",
        "2",
    ]);
    let snapshot = fs::read_to_string(folder.path("scene.rtsnap")).unwrap();
    assert!(
        snapshot.contains("parameters size=20x15 samples=2\nsize 20 x 15\nsamples 2\n"),
        "{snapshot}"
    );
    folder.tests(&[], 0, &["1 passed"]);
    folder.fails(&["test", "--size", "10x10"], 2, &["--accept"]);
    folder.write("wide.rhai", "size(1000, 10); sphere(0, 0, 0, 1);");
    folder.ok(&["test", "--accept", "wide.rhai"]);
    let snapshot = fs::read_to_string(folder.path("wide.rtsnap")).unwrap();
    assert!(snapshot.contains("parameters size=320x3\n"), "{snapshot}");
}

#[test]
fn what_is_tested_without_being_named() {
    let folder = Folder::new();
    folder.fails(
        &["test"],
        3,
        &[
            "there is nothing to test here",
            "rtscript test --accept scene.rhai",
        ],
    );
    for name in [
        "tests/a.rhai",
        "tests/deep/b.test",
        "tests/lib/module.rhai",
        "tests/_draft.rhai",
        "tests/.hidden.rhai",
        "elsewhere/c.rhai",
        "target/tests/d.rhai",
    ] {
        let course = "size 8 6\ncamera 0 0 5 0 0 0 0 1 0 45\nsphere 0 0 0 1\n";
        folder.write(name, if name.ends_with("test") { course } else { BALL });
    }
    folder.ok(&["test", "--accept"]);
    let snapshots = |folder: &Folder| {
        let files = folder.files();
        files
            .into_iter()
            .filter(|name| name.ends_with(".rtsnap"))
            .collect::<Vec<_>>()
    };
    assert_eq!(snapshots(&folder), ["tests/a.rtsnap", "tests/deep/b.rtsnap"]);
    folder.ok(&["test", "--accept", "elsewhere"]);
    folder.tests(&["-q"], 0, &["3 scenes: 3 passed"]);
    let shown = folder.tests(
        &["--filter", "deep", "--filter", "where"],
        0,
        &["2 scenes: 2 passed"],
    );
    assert!(
        shown.contains("tests/deep/b.test") && shown.contains("elsewhere/c.rhai"),
        "{shown}"
    );
    folder.fails(
        &["test", "--filter", "zebra"],
        3,
        &["none of the 3 scenes has 'zebra'"],
    );
    folder.fails(&["test", "missing"], 3, &["there is no 'missing'"]);
    folder.write("empty/readme.txt", "");
    folder.fails(&["test", "empty"], 3, &["there are no scenes"]);
    folder.write("elsewhere/c.test", "size 8 6\n");
    folder.fails(
        &["test", "elsewhere"],
        3,
        &["would share the snapshot 'elsewhere/c.rtsnap'"],
    );
}

#[test]
fn scenes_that_fail_do_not_keep_the_others_from_being_tested() {
    let folder = on_record();
    folder.write("broken.rhai", "sphere(0, 0, 0, -1);");
    folder.write("cut.rhai", BALL);
    folder.write("cut.rtsnap", "rtscript snapshot 1\nsize eight\n");
    let ran = folder.run(&["test", "."]);
    let shown = text(&ran.stdout);
    assert_eq!(ran.code, 1);
    assert!(shown.contains("3 scenes: 1 passed, 2 failed"), "{shown}");
    for message in [
        "broken.rhai:1:1",
        "greater than 0",
        "cut.rtsnap:2",
        "'size eight' is no line of a snapshot",
    ] {
        assert!(ran.stderr.contains(message), "no {message:?} in {}", ran.stderr);
    }
    // What fails is not accepted.
    folder.tests(&["--accept", "."], 1, &["2 failed"]);
    assert!(!folder.path("broken.rtsnap").exists());
}

#[test]
fn modules_and_pictures_belong_to_the_scene() {
    let folder = Folder::new();
    folder.write("lib/ball.rhai", "fn ball() { sphere(0, 0, 0, 0.8); }");
    folder.write(
        "scene.rhai",
        format!("import \"lib/ball\" as b;\n{SCENE}b::ball();\n"),
    );
    folder.ok(&["test", "--accept", "scene.rhai"]);
    folder.tests(&[], 0, &["1 passed"]);
    folder.write("lib/ball.rhai", "fn ball() {\n  sphere(1, 0, 0, 0.8);\n}");
    folder.tests(
        &[],
        1,
        &[
            "shows lib/ball.rhai:2  sphere(1, 0, 0, 0.8);",
            "scene + object 2 sphere { center: (1, 0, 0)",
        ],
    );
}

#[test]
fn review_asks_for_each_and_shows_pictures() {
    let folder = on_record();
    folder.write("new.rhai", BALL);
    folder.ok(&["test", "--accept", "new.rhai"]);
    folder.edit("0.8);\n", "0.7);\n");
    folder.write("new.rhai", BALL.replace("[1, 0, 0]", "[0, 1, 0]"));
    let args = ["test", "--review", "--pictures", "blocks"];
    let (code, shown) = folder.answers(&args, "what\nn\n");
    assert_eq!(code, 1, "{shown}");
    assert_eq!(shown.matches("accept? [y]es, [n]o, [q]uit").count(), 3, "{shown}");
    assert!(
        shown.contains("1 of 2") && shown.contains("expected | difference | actual"),
        "{shown}"
    );
    assert!(shown.contains("▀"), "{shown}");
    let (code, shown) = folder.answers(&["test", "--review"], "y\nq\n");
    assert_eq!(code, 1, "{shown}");
    assert!(!shown.contains("▀"), "a pipe shows no pictures: {shown}");
    folder.tests(&["--filter", "new"], 0, &["1 passed"]);
    let (code, shown) = folder.answers(&["test", "--review"], "yes\n");
    assert_eq!(code, 0, "{shown}");
    folder.tests(&[], 0, &["2 passed"]);
    folder.fails(&["test", "--review", "--accept"], 2, &["cannot be used with"]);
}

#[test]
fn reports_for_machines_and_people() {
    let folder = on_record();
    folder.edit("sphere(0, 0, 0, 0.8)", "sphere(0.5, 0, 0, 0.8)");
    folder.write("tests/<new> & \"quoted\".rhai", BALL);
    folder.write("tests/bad.rhai", "sphere(");
    let args = [
        "--json", "r.json", "--junit", "r.xml", "--html", "r.html", "--diffs", "diffs", "--jobs", "1",
    ];
    folder.tests(&args, 1, &["3 scenes: 1 changed, 1 new, 1 failed"]);

    let read = |name: &str| fs::read_to_string(folder.path(name)).unwrap();
    let json: serde_json::Value = serde_json::from_str(&read("r.json")).unwrap();
    assert_eq!(
        (&json["changed"], &json["new"], &json["failed"], &json["passed"]),
        (&1.into(), &1.into(), &1.into(), &0.into())
    );
    let case = &json["cases"][0];
    assert_eq!(
        (&case["name"], &case["outcome"]),
        (&"scene.rhai".into(), &"changed".into())
    );
    let lines = case["lines"].as_array().unwrap();
    assert!(lines.iter().any(|line| line["line"] == 6), "{case}");
    assert!(case["difference"]["flip"].as_f64().unwrap() > 0.0, "{case}");
    assert_eq!(case["difference"]["region"].as_array().unwrap().len(), 4);
    assert_eq!(case["scripts"][0], "scene.rhai");
    assert_eq!(json["cases"][2]["line"], 1);

    let xml = read("r.xml");
    assert!(xml.contains(r#"tests="3" failures="2" errors="1""#), "{xml}");
    assert!(
        xml.contains(r#"name="&lt;new&gt; &amp; &quot;quoted&quot;.rhai""#),
        "{xml}"
    );
    assert_eq!(xml.matches("<testcase ").count(), 3);

    let html = read("r.html");
    assert!(
        html.contains("data:image/png;base64,") && !html.contains("<new>"),
        "{} bytes",
        html.len()
    );
    assert_eq!(size_of(&folder.path("diffs/scene.rhai.png")), (128, 30));

    let ran = folder.run(&["test", "--json", "-"]);
    let whole: Result<serde_json::Value, _> = serde_json::from_slice(&ran.stdout);
    assert!(whole.is_ok(), "{}", text(&ran.stdout));
    assert!(ran.stderr.contains("3 scenes"), "{}", ran.stderr);
    folder.fails(
        &["test", "--html", "no/such/folder.html"],
        4,
        &["there is no folder"],
    );
}

#[test]
fn any_number_of_jobs_gives_the_same_answer() {
    let folder = Folder::new();
    for i in 0..12 {
        folder.write(
            &format!("tests/{i:02}.rhai"),
            SCENE.replace("0.8);", &format!("0.{});", i + 10)),
        );
    }
    folder.ok(&["test", "--accept", "--jobs", "5"]);
    let names = |shown: String| -> Vec<String> {
        let lines = shown.lines().filter(|line| line.starts_with("ok"));
        lines
            .map(|line| line.split_whitespace().nth(1).unwrap().to_owned())
            .collect()
    };
    let alone = names(folder.tests(&["--jobs", "1"], 0, &["12 passed"]));
    assert_eq!(names(folder.tests(&["--jobs", "7"], 0, &["12 passed"])), alone);
    assert!(alone.is_sorted() && alone.len() == 12, "{alone:?}");
    folder.fails(&["test", "--jobs", "0"], 2, &["--jobs"]);
}

#[test]
fn hash_prints_two_hashes_and_nothing_else() {
    let folder = Folder::with(&format!("print(`said`);\n{SCENE}"));
    let ran = folder.ok(&["hash", "scene.rhai"]);
    let line = text(&ran.stdout);
    let hashes: Vec<&str> = line.trim_end().split(' ').collect();
    assert!(
        hashes.len() == 2 && hashes.iter().all(|hash| hash.len() == 32),
        "{line}"
    );
    assert!(ran.stderr.is_empty(), "{}", ran.stderr);
    assert_eq!(folder.hash(&["-o", "x.png"]), hashes[0]);
    assert_eq!(
        text(&folder.ok(&["hash", "--scene", "scene.rhai"]).stdout),
        format!("{}\n", hashes[1])
    );
    // Another way of writing the same scene has its hash; another scene with the same pixels has not.
    folder.write("same.rhai", format!("// the same\n\n{SCENE}"));
    folder.write("other.rhai", format!("{SCENE}sphere(0, 0, 99, 0.1);"));
    let both = text(
        &folder
            .ok(&["hash", "same.rhai", "other.rhai", "--threads", "1"])
            .stdout,
    );
    let rows: Vec<Vec<&str>> = both
        .lines()
        .map(|line| line.split_whitespace().collect())
        .collect();
    assert_eq!(rows[0], [hashes[0], hashes[1], "same.rhai"]);
    assert_eq!((rows[1][0], rows[1][2]), (hashes[0], "other.rhai"));
    assert_ne!(rows[1][1], hashes[1]);
    assert_ne!(
        text(&folder.ok(&["hash", "scene.rhai", "--size", "20x10"]).stdout),
        line
    );
    folder.fails(&["hash", "missing.rhai"], 3, &["cannot read 'missing.rhai'"]);
    folder.fails(&["hash"], 2, &["<FILE>"]);
}
