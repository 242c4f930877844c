//! The course's scene format: every command. The ways to get one wrong are in `tests/bad`.

use rtscript::{
    Builder, DVec3, Limits, Scene, Term,
    diag::ErrorKind,
    import::load_course,
    scene::{Attenuation, Encoding, Geometry, LightKind},
    shape::Shape,
};

fn load(source: &str) -> (Scene, Vec<String>) {
    let mut builder = Builder::new();
    load_course("a.test", source, &mut builder).unwrap_or_else(|e| panic!("{e}"));
    let report = builder.finish();
    let warnings = report.warnings.iter().map(ToString::to_string).collect();
    (report.value, warnings)
}

/// The whole text of the error that `source` gives.
fn error(source: &str) -> String {
    let error = load_course("a.test", source, &mut Builder::new()).expect_err(source);
    let line = source.split('\n').nth(error.line as usize - 1).unwrap_or("");
    assert_eq!(
        error.source_line.as_deref(),
        Some(line.trim_end_matches('\r')),
        "the excerpt of {source:?}"
    );
    error.to_string()
}

#[test]
fn every_command_reaches_the_scene() {
    let (scene, warnings) = load(
        "# comment\r\n\
         size 20 10\r\n\
         maxdepth 3 \n\
         output a.png\n\
         \n\
         camera 1 2 3  4 5 6  0 +1 0  30\n\
         maxverts 3\nmaxvertnorms 3\n\
         vertex -1 -1 0\nvertex +1 -1 0\nvertex 0 .5 0\n\
         vertexnormal 0 0 0 0 0 1\nvertexnormal 1 0 0 0 1 1\nvertexnormal 0 1 0 1 0 1\n\
         ambient .1 .2 .3\ndiffuse .4 .5 .6\nspecular .7 .8 .9\nemission 0 0 1\nshininess 20\n\
         directional 0 0 2 1 1 1\n\
         attenuation 0 1 2\n\
         pushTransform\n\
         translate 0 0 5\n\
         point 1 0 0 .5 .5 .5\n\
         tri 0 1 2 # the first\n\
         popTransform\n\
         trinormal 2 1 0\n\
         rotate 0 0 1 90\n\
         scale 2 1 1\n\
         sphere 1 2 3 4\n",
    );
    assert_eq!(warnings, [""; 0]);
    let settings = &scene.settings;
    assert_eq!((settings.width, settings.height, settings.max_depth), (20, 10, 3));
    assert_eq!(settings.encoding, Encoding::Raw);
    assert_eq!(scene.camera.eye, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.camera.at, DVec3::new(4.0, 5.0, 6.0));
    assert_eq!((scene.camera.up, scene.camera.fovy()), (DVec3::Y, Some(30.0)));

    let [flat, smooth, sphere] = &scene.root().objects[..] else {
        panic!("{:?}", scene.root().objects)
    };
    assert_eq!(flat.loc.line, 25);
    assert_eq!(
        scene.world_from_object(flat).translation,
        DVec3::new(0.0, 0.0, 5.0)
    );
    assert_eq!(scene.triangles[0].positions[2], DVec3::new(0.0, 0.5, 0.0));
    assert_eq!(scene.triangles[0].normals, None);
    assert_eq!(smooth.loc.line, 27);
    assert_eq!(scene.triangles[1].positions, [DVec3::Y, DVec3::X, DVec3::ZERO]);
    let normals = [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]].map(DVec3::from_array);
    assert_eq!(scene.triangles[1].normals, Some(normals));
    let Geometry::Shape(Shape::Sphere(_)) = &sphere.geometry else {
        panic!("{sphere:?}")
    };
    let matrix = scene.world_from_object(sphere).matrix3;
    assert_eq!(matrix.x_axis, DVec3::new(0.0, 2.0, 0.0));
    assert_eq!(matrix.y_axis, DVec3::new(-1.0, 0.0, 0.0));

    let material = &scene.materials[flat.material.index()];
    let term = |r, g, b| Term::color(DVec3::new(r, g, b));
    assert_eq!(material.ambient, term(0.1, 0.2, 0.3));
    assert_eq!(material.diffuse, term(0.4, 0.5, 0.6));
    assert_eq!(material.specular, term(0.7, 0.8, 0.9));
    assert_eq!(material.mirror(), material.specular);
    assert_eq!(material.emission, term(0.0, 0.0, 1.0));
    assert_eq!(material.shininess, 20.0);

    let [sun, lamp] = &scene.root().lights[..] else {
        panic!("{:?}", scene.root().lights)
    };
    assert_eq!(sun.kind, LightKind::Directional { direction: DVec3::Z });
    let attenuation = Attenuation {
        constant: 0.0,
        linear: 1.0,
        quadratic: 2.0,
    };
    let position = DVec3::new(1.0, 0.0, 5.0);
    assert_eq!(
        lamp.kind,
        LightKind::Point {
            position,
            attenuation
        }
    );
    assert_eq!(lamp.color, DVec3::splat(0.5));
}

#[test]
fn the_matrix_is_read_where_the_triangle_stands() {
    let (scene, _) = load(
        "translate 9 9 9\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\ntri 0 1 2\ntranslate 1 0 0\ntri 0 1 2\n",
    );
    let places: Vec<DVec3> = (scene.root().objects.iter())
        .map(|o| scene.world_from_object(o).translation)
        .collect();
    assert_eq!(places, [DVec3::splat(9.0), DVec3::new(10.0, 9.0, 9.0)]);
}

#[test]
fn defaults_are_the_courses() {
    let (scene, warnings) = load("size 8 8\ncamera 0 0 4 0 0 0 0 1 0 30\nsphere 0 0 0 1");
    assert_eq!(warnings, [""; 0]);
    assert_eq!(scene.settings.max_depth, 5);
    assert_eq!(scene.settings.background, DVec3::ZERO);
    let material = &scene.materials[0];
    assert_eq!(material.ambient, Term::color(DVec3::splat(0.2)));
    assert!(material.diffuse.is_black() && material.specular.is_black() && material.emission.is_black());
}

#[test]
fn what_is_missing_is_said() {
    let (scene, warnings) = load("sphere 0 0 0 1\n");
    assert_eq!((scene.settings.width, scene.settings.height), (640, 480));
    assert_eq!(
        warnings,
        [
            "a.test: warning: the picture has no size, so it is 640 x 480\n  help: begin the file with: size 640 480",
            "a.test: warning: there is no camera, so it stands at 0 0 5 and looks at the origin\n  \
             help: write: camera eyex eyey eyez centerx centery centerz upx upy upz fovy",
        ]
    );
    let (_, warnings) = load("size 1 1\ncamera 0 0 4 0 0 0 0 1 0 30\n");
    assert_eq!(
        warnings,
        ["warning: the scene is empty: the picture shows nothing but the background"]
    );
}

#[test]
fn the_last_size_camera_and_output_count() {
    let mut builder = Builder::new();
    let source = "output a.png\noutput b.png\nsize 1 2\nsize 3 4\n\
                  camera 0 0 4 0 0 0 0 1 0 30\ncamera 0 0 4 0 0 0 0 1 0 60\nsphere 0 0 0 1\n";
    let course = load_course("a.test", source, &mut builder).unwrap();
    assert_eq!(course.output.as_deref(), Some("b.png"));
    let scene = builder.finish().value;
    assert_eq!((scene.settings.width, scene.settings.height), (3, 4));
    assert_eq!(scene.camera.fovy(), Some(60.0));
}

#[test]
fn a_push_left_over_at_the_end_is_the_courses_habit() {
    let (_, warnings) =
        load("size 1 1\ncamera 0 0 4 0 0 0 0 1 0 30\npushTransform\nscale 2 2 2\nsphere 0 0 0 1\n");
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn a_hundred_thousand_triangles_are_read_in_one_pass() {
    let mut source = String::from("size 8 8\ncamera 0 0 4 0 0 0 0 1 0 30\nmaxverts 100000\n");
    for i in 0..100_000 {
        source += &format!("vertex {i} {}.5 0\n", i % 7);
    }
    for i in 0..99_998 {
        source += &format!("tri {i} {} {}\n", i + 1, i + 2);
    }
    let (scene, _) = load(&source);
    assert_eq!(scene.triangles.len(), 99_998);
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.root().objects[99_997].loc.line, 200_001);
}

#[test]
fn spheres_without_a_size_are_refused() {
    for radius in ["0", "-1", "-0"] {
        let text = error(&format!("sphere 0 0 0 {radius}"));
        assert!(text.starts_with("a.test:1:1: error: "), "{text}");
    }
}

#[test]
fn limits_hold_for_the_course_too() {
    let cases = [
        (
            "size 99999 1",
            "a picture of 99999 x 1 is too large: the limit 'image_side' is 2048",
        ),
        (
            "size 1e14 1e14",
            "a picture of 100000000000000 x 100000000000000 is too large: the limit 'image_side' is 2048",
        ),
        ("maxdepth 65", "65 bounces are too many: the limit 'depth' is 8"),
    ];
    for (source, wanted) in cases {
        let mut builder = Builder::with_limits(Limits::untrusted());
        let error = load_course("a.test", source, &mut builder).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Limit);
        assert_eq!(error.to_string(), format!("a.test:1:1: error: {wanted}"));
    }
    let mut builder = Builder::with_limits(Limits::untrusted());
    let error = load_course("a.test", &"pushTransform\n".repeat(300), &mut builder).unwrap_err();
    assert_eq!((error.kind, error.line), (ErrorKind::Limit, 257));
    let mut builder = Builder::with_limits(Limits::untrusted());
    let error = load_course("a.test", &"point 0 0 0 1 1 1\n".repeat(65), &mut builder).unwrap_err();
    assert_eq!((error.kind, error.line), (ErrorKind::Limit, 65));
}
