//! Every limit of both presets ends a script that passes it, with an error of its own that names it.

use std::{io::Cursor, time::Duration};

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use rtscript::{Host, Limits, RenderOptions, diag::ErrorKind, host::HostError, render};

use crate::{Quiet, first_line, run, settle};

/// How one limit is passed.
struct Case {
    limit: &'static str,
    /// Brings a limit down that takes a test too long to reach, and others out of the way.
    set: fn(&mut Limits),
    script: fn(&Limits) -> String,
}

/// Any number of files of each kind.
struct Files;

impl Host for Files {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        let bytes = match path.rsplit_once('.').map_or("", |(_, ending)| ending) {
            "rhai" => b"fn f() { }".to_vec(),
            "obj" => b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(),
            _ => {
                let (width, height) = path.trim_end_matches(".png").split_once('x').unwrap();
                let (width, height) = (width.parse().unwrap(), height.parse().unwrap());
                let mut png = Cursor::new(Vec::new());
                PngEncoder::new(&mut png)
                    .write_image(
                        &vec![0; width as usize * height as usize * 3],
                        width,
                        height,
                        ExtendedColorType::Rgb8,
                    )
                    .unwrap();
                png.into_inner()
            }
        };
        if bytes.len() as u64 > max_bytes {
            return Err(HostError::new(ErrorKind::Limit, "too large"));
        }
        Ok(bytes)
    }
}

const fn as_it_is(_: &mut Limits) {}

fn repeated(n: usize, line: impl Fn(usize) -> String) -> String {
    (0..n).map(line).collect()
}

const CASES: &[Case] = &[
    Case {
        limit: "source_bytes",
        set: as_it_is,
        script: |l| " ".repeat(l.source_bytes + 1),
    },
    Case {
        limit: "operations",
        set: |l| l.operations /= 100,
        script: |_| "loop { }".to_owned(),
    },
    Case {
        limit: "compile_time",
        set: |l| {
            l.compile_time /= 50;
            l.variables = usize::MAX;
            l.source_bytes = usize::MAX;
        },
        script: |_| repeated(100_000, |i| format!("let a{i}=1;")),
    },
    Case {
        limit: "script_time",
        set: |l| {
            l.script_time = Duration::from_millis(30);
            l.operations = u64::MAX;
        },
        script: |_| "loop { }".to_owned(),
    },
    Case {
        limit: "script_memory",
        set: as_it_is,
        script: |l| {
            format!(
                "let s = \"s\"; s.pad({}, 's'); let m = #{{}}; let i = 0; loop {{ m[`${{i}}`] = s + i; i += 1; }}",
                l.string_bytes / 2
            )
        },
    },
    Case {
        limit: "render_time",
        set: |l| l.render_time = Some(Duration::from_millis(20)),
        script: |l| {
            let n = l.image_side.min(1400);
            format!("size({n}, {n}); samples({}); box(); render();", l.samples)
        },
    },
    Case {
        limit: "rays",
        set: |l| l.rays = Some(4_000),
        script: |_| "size(50, 50); box(); render(); render();".to_owned(),
    },
    Case {
        limit: "pictures",
        set: |l| l.pictures = l.pictures.min(50),
        script: |_| "size(1, 1); loop { render(); }".to_owned(),
    },
    Case {
        limit: "closures",
        set: |l| l.closures = false,
        script: |_| "let a = [1, 2];\nprint(a.map(|x| x + 1));".to_owned(),
    },
    Case {
        limit: "call_levels",
        set: as_it_is,
        script: |_| "fn f() { f() }\nf();".to_owned(),
    },
    Case {
        limit: "expression_depth",
        set: as_it_is,
        script: |_| format!("let a = {}1{};", "(".repeat(100), ")".repeat(100)),
    },
    Case {
        limit: "string_bytes",
        set: as_it_is,
        script: |_| "let s = \"s\"; loop { s += s; }".to_owned(),
    },
    Case {
        limit: "array_len",
        set: as_it_is,
        script: |_| "let a = [1]; loop { a += a; }".to_owned(),
    },
    Case {
        limit: "map_len",
        set: as_it_is,
        script: |l| {
            format!(
                "let m = #{{}}; for i in 0..{} {{ m[`${{i}}`] = i; }} let n = m + #{{}};",
                l.map_len + 1
            )
        },
    },
    Case {
        limit: "variables",
        set: as_it_is,
        script: |l| repeated(l.variables + 1, |i| format!("let a{i} = 1;\n")),
    },
    Case {
        limit: "functions",
        set: as_it_is,
        script: |l| repeated(l.functions + 1, |i| format!("fn f{i}() {{ }}\n")),
    },
    Case {
        limit: "modules",
        set: as_it_is,
        script: |l| repeated(l.modules + 1, |i| format!("import \"m{i}\" as m{i};\n")),
    },
    Case {
        limit: "transform_depth",
        set: as_it_is,
        script: |_| "loop { pushTransform(); }".to_owned(),
    },
    Case {
        limit: "primitives",
        set: |l| l.primitives /= 100,
        script: |_| "loop { sphere(0, 0, 0, 1); }".to_owned(),
    },
    Case {
        limit: "lights",
        set: as_it_is,
        script: |_| "loop { light([0, 0, 0], [1, 1, 1]); }".to_owned(),
    },
    Case {
        limit: "files",
        set: as_it_is,
        script: |l| repeated(l.files + 1, |i| format!("mesh(\"{i}.obj\");\n")),
    },
    Case {
        limit: "file_bytes",
        set: |l| l.file_bytes = 10,
        script: |_| "mesh(\"a.obj\");".to_owned(),
    },
    Case {
        limit: "total_file_bytes",
        set: |l| l.total_file_bytes = 100,
        script: |_| repeated(4, |i| format!("mesh(\"{i}.obj\");\n")),
    },
    Case {
        limit: "texture_side",
        set: as_it_is,
        script: |l| format!("diffuse(image(\"{}x1.png\"));", l.texture_side + 1),
    },
    Case {
        limit: "decode_bytes",
        set: |l| l.decode_bytes = 1000,
        script: |_| "diffuse(image(\"40x40.png\"));".to_owned(),
    },
    Case {
        limit: "total_decode_bytes",
        set: |l| l.total_decode_bytes = 20_000,
        script: |_| {
            repeated(5, |i| {
                format!("image(\"40x4{i}.png\", #{{ filter: \"mip\" }});\n")
            })
        },
    },
    Case {
        limit: "image_side",
        set: as_it_is,
        script: |l| format!("size({}, 1);", l.image_side + 1),
    },
    Case {
        limit: "pixels",
        set: as_it_is,
        script: |l| format!("size({0}, {0});", l.image_side),
    },
    Case {
        limit: "samples",
        set: as_it_is,
        script: |l| format!("samples({});", l.samples + 1),
    },
    Case {
        limit: "depth",
        set: as_it_is,
        script: |l| format!("maxDepth({});", l.depth + 1),
    },
    Case {
        limit: "print_bytes",
        set: |l| l.print_bytes /= 16,
        script: |_| "let s = \"s\"; s.pad(1000, 's'); loop { print(s); }".to_owned(),
    },
];

/// Names of the fields, as they are printed.
fn names(limits: &Limits) -> Vec<String> {
    format!("{limits:#?}")
        .lines()
        .filter_map(|line| line.strip_prefix("    ")?.split_once(':'))
        .filter(|(name, _)| !name.starts_with(' '))
        .map(|(name, _)| name.to_owned())
        .collect()
}

#[test]
fn every_limit_of_both_presets_fires_with_its_own_error() {
    let cases: Vec<&str> = CASES.iter().map(|case| case.limit).collect();
    let fields = names(&Limits::default());
    for field in &fields {
        assert!(cases.contains(&field.as_str()), "no script passes {field}");
    }
    assert_eq!(fields.len(), cases.len());
    let mut text = String::new();
    for (preset, limits) in [("default", Limits::default()), ("untrusted", Limits::untrusted())] {
        for case in CASES {
            let mut limits = limits.clone();
            (case.set)(&mut limits);
            let error = run(&(case.script)(&limits), &limits, &Files);
            let error = error.expect_err(case.limit);
            assert_eq!(error.kind(), ErrorKind::Limit, "{}: {error}", case.limit);
            let mut line = first_line(&error);
            if case.limit == "compile_time" {
                // How far it came is a question of the machine.
                line = line.replacen(&error.diagnostic.column.to_string(), "_", 1);
            }
            assert!(
                line.contains(&format!("the limit '{}' is ", case.limit)),
                "{}: {line}",
                case.limit
            );
            text += &format!("{preset:9} {:16} {line}\n", case.limit);
        }
    }
    settle("limits.txt", &text);
}

/// Whether a picture takes too many rays is a question of the picture, not of who traced which tile when.
#[test]
fn the_limit_of_rays_is_the_same_for_any_order_of_tiles() {
    let script = "size(40, 30); samples(4); light([0, 5, 5], [1, 1, 1]); specular(0.5, 0.5, 0.5); ambient(0.1, 0.1, 0.1);\
                  sphere(0, 0, 0, 1); box(2, 2, 2);";
    let scene = run(script, &Limits::default(), &Quiet).unwrap().value.scene;
    let takes = render(&scene, &RenderOptions::default(), &Quiet)
        .unwrap()
        .value
        .stats
        .rays();
    assert!(takes > 4800);
    for threads in [1, 2, 7] {
        for shuffle in 0..4 {
            let mut options = RenderOptions::default();
            options.threads = threads;
            options.shuffle = Some(shuffle);
            options.rays = Some(takes);
            render(&scene, &options, &Quiet).unwrap();
            options.rays = Some(takes - 1);
            let error = render(&scene, &options, &Quiet).unwrap_err();
            assert_eq!(
                error.diagnostic.message,
                format!(
                    "the picture takes too many rays: the limit 'rays' is {}",
                    takes - 1
                )
            );
        }
    }
}
