//! What scripts mean: values, blocks, settings, pictures.

use crate::host::{Notes, printed, run, run_on, try_run};
use rtscript::{
    DVec3,
    scene::{Encoding, Geometry, LightKind, Texture},
    shape::Shape,
};

/// Center and radius of every sphere, in the space of its group, and of those in the world.
fn spheres(run: &rtscript::script::Run) -> Vec<(DVec3, f64)> {
    let scene = &run.scene;
    let objects = scene.root().objects.iter();
    objects
        .filter_map(|o| match &o.geometry {
            Geometry::Shape(Shape::Sphere(s)) => Some((
                scene.world_from_object(o).transform_point3(s.center()),
                s.radius(),
            )),
            _ => None,
        })
        .collect()
}

#[test]
fn vectors_are_arrays_vec3_or_numbers_of_either_kind() {
    let wanted = spheres(&run("sphere(1, 2, 3, 1);"));
    for source in [
        "sphere(1.0, 2, 3, 1.0);",
        "sphere([1, 2.0, 3], 1);",
        "sphere(vec3(1, 2, 3), 1.0);",
        "sphere(vec3([1, 2, 3]), 1);",
        "let c = [1, 2, 3]; sphere(c, 1);",
        "const C = vec3(1, 2, 3); sphere(C, 1);",
        "translate(1, 0, 0); translate([0, 2, 0]); translate(vec3(0, 0, 3)); sphere(0, 0, 0, 1);",
        "let c = [1, 2, 3]; let f = || sphere(c, 1); f.call();",
        "fn place(c) { sphere(c, 1); } place([1, 2, 3]);",
    ] {
        assert_eq!(spheres(&run(source)), wanted, "{source}");
    }
}

#[test]
fn colors_are_vectors_numbers_or_codes() {
    for source in [
        "background(1, 0, 0);",
        "background([1, 0, 0]);",
        "background(vec3(1, 0, 0));",
        "background(\"#ff0000\");",
        "background(\"#F00\");",
    ] {
        assert_eq!(run(source).scene.settings.background, DVec3::X, "{source}");
    }
    let gray = run("background(\"#808080\");").scene.settings.background;
    assert!((gray.x - 0.215_860_5).abs() < 1e-6, "codes are sRGB: {gray}");
}

#[test]
fn spelled_out_arguments_reach_their_places() {
    let scene = run("camera(1, 2, 3, 4, 5, 6, 0, 1, 0, 30); light(1, 2, 3, 0.1, 0.2, 0.3);").scene;
    assert_eq!(scene.camera.eye, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.camera.at, DVec3::new(4.0, 5.0, 6.0));
    assert_eq!(scene.camera.fovy(), Some(30.0));
    let light = &scene.root().lights[0];
    assert_eq!(light.color, DVec3::new(0.1, 0.2, 0.3));
    let numbers = "tri(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.0, 1, 0, 0, 2.0);";
    let triangle = run(numbers).scene.triangles[0].clone();
    assert_eq!(triangle.normals, Some([DVec3::Z, DVec3::Z, DVec3::Z * 2.0]));
    let mixed = "tri([0, 0, 0], 1, 0, 0, vec3(0, 1, 0), 0, 0, 1, [0, 0.0, 1], 0, 0, 2);";
    assert_eq!(run(mixed).scene.triangles[0], triangle);
}

#[test]
fn settings_reach_the_scene() {
    let s = run("size(64, 48); samples(4); maxDepth(2); encoding(\"raw\"); seed(-1); size(32, 24.0);")
        .scene
        .settings;
    assert_eq!((s.width, s.height, s.samples, s.max_depth), (32, 24, 4, 2));
    assert_eq!((s.encoding, s.seed), (Encoding::Raw, u64::MAX));
    let s = run("").scene.settings;
    assert_eq!(
        (s.width, s.height, s.samples, s.max_depth, s.seed),
        (640, 480, 1, 5, 0)
    );
}

#[test]
fn the_matrix_nearest_the_shape_acts_first() {
    let at = |source: &str| spheres(&run(source))[0].0;
    assert_eq!(
        at("translate(1, 0, 0); rotate(0, 0, 1, 90); sphere(1, 0, 0, 1);"),
        DVec3::new(1.0, 1.0, 0.0)
    );
    assert_eq!(
        at("rotate([0, 0, 2], 90); translate(1, 0, 0); sphere(1, 0, 0, 1);"),
        DVec3::new(0.0, 2.0, 0.0)
    );
    assert_eq!(
        at("scale(2); translate(1, 2, 3); sphere(0, 0, 0, 1);"),
        DVec3::new(2.0, 4.0, 6.0)
    );
    assert_eq!(
        at("scale(1, 2, 3); sphere(1, 1, 1, 1);"),
        DVec3::new(1.0, 2.0, 3.0)
    );
    assert_eq!(
        at("multMatrix([1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1]); sphere(0, 0, 0, 1);"),
        DVec3::new(5.0, 6.0, 7.0)
    );
    assert_eq!(
        at("translate(9, 9, 9); loadIdentity(); sphere(1, 0, 0, 1);"),
        DVec3::X
    );
    assert_eq!(
        at("pushTransform(); translate(9, 9, 9); popTransform(); sphere(0, 1, 0, 1);"),
        DVec3::Y
    );
}

#[test]
fn a_group_restores_matrix_and_material_however_it_is_left() {
    for (way, source) in [
        ("its end", "group { BODY }"),
        ("break", "loop { group { BODY break; } }"),
        ("continue", "for i in 0..3 { group { BODY continue; } }"),
        ("return", "fn f() { group { BODY return 5; } } f();"),
        ("throw", "try { group { BODY throw 1; } } catch { }"),
        (
            "an error",
            "try { group { BODY sphere(0, 0, 0, -1); } } catch { }",
        ),
        (
            "an error deeper down",
            "try { group { BODY group { translate(1, 1, 1); sphere(1); } } } catch { }",
        ),
        ("inside a group", "group { group { BODY } group { BODY } }"),
    ] {
        let body = "pushTransform(); translate(1, 2, 3); diffuse(1, 0, 0); shininess(9);";
        let source = format!(
            "translate(5, 0, 0); diffuse(0, 1, 0); {} sphere(0, 0, 0, 1);",
            source.replace("BODY", body)
        );
        let run = run(&source);
        assert_eq!(spheres(&run), [(DVec3::X * 5.0, 1.0)], "{way}");
        let material = &run.scene.materials[0];
        assert_eq!(
            (material.diffuse.color, material.shininess),
            (DVec3::Y, 1.0),
            "{way}"
        );
    }
}

#[test]
fn a_group_sees_and_changes_the_variables_around_it() {
    assert_eq!(
        printed(
            "let n = 1; group { n += 1; let n = 10; n += 1; } print(n); let v = group { n * 3 }; print(v);"
        ),
        ["2", "6"]
    );
}

#[test]
fn defines_nest_and_share() {
    let source = "
        translate(100, 0, 0);
        define \"wheel\" { sphere(0, 0, 0, 0.5); }
        define \"car\" {
            for x in [-1, 1] { group { translate(x, 0, 0); instance(\"wheel\"); } }
            light([0, 1, 0], [1, 1, 1]);
        }
        for i in 0..3 { group { translate(0, i, 0); instance(`${\"c\"}ar`); } }
    ";
    let scene = run(source).scene;
    assert_eq!(scene.groups.len(), 3);
    assert_eq!(scene.root().objects.len(), 3);
    assert_eq!(scene.root().lights.len(), 3, "an instance brings its lights");
    let LightKind::Point { position, .. } = scene.root().lights[2].kind else {
        panic!("a point light");
    };
    assert_eq!(position, DVec3::new(100.0, 3.0, 0.0));
    let wheel = &scene.groups[1];
    assert_eq!((wheel.name.as_str(), wheel.objects.len()), ("wheel", 1));
    assert_eq!(
        scene.world_from_object(&wheel.objects[0]).translation,
        DVec3::ZERO,
        "a space of its own"
    );
}

#[test]
fn a_define_left_by_an_error_is_none() {
    let source = "try { define \"a\" { sphere(0, 0, 0, 1); throw 1; } } catch { } instance(\"a\");";
    assert!(
        try_run(source)
            .unwrap_err()
            .diagnostic
            .message
            .contains("no group is defined")
    );
    let kept = run("for i in 0..1 { define \"a\" { sphere(0, 0, 0, 1); break; } } instance(\"a\");");
    assert_eq!(kept.scene.root().objects.len(), 1);
}

#[test]
fn names_of_defines_can_be_made() {
    let run = run("for i in 0..3 { define \"ball\" + i { sphere(0, 0, 0, i + 1); } } instance(\"ball2\");");
    assert_eq!(run.scene.groups.len(), 4);
}

#[test]
fn materials_come_back_as_maps() {
    let source = "
        let tex = checker(\"#fff\", \"#000\", 2);
        let saved = material(#{ diffuse: tex, specular: [0.5, 0.5, 0.5], shininess: 20, ior: 1.3, reflection: tex * 0.5 });
        sphere(0, 0, 0, 1);
        material(#{ diffuse: \"#f00\", reflection: (), transmission: vec3(1, 1, 1) });
        sphere(0, 0, 0, 1);
        material(saved);
        sphere(0, 0, 0, 1);
        print(material().keys());
    ";
    let scene = run(source).scene;
    let materials: Vec<_> = scene.root().objects.iter().map(|o| o.material).collect();
    assert_eq!(materials[0], materials[2], "put back as it was");
    let [first, second] = &scene.materials[..] else {
        panic!("two materials, not {}", scene.materials.len());
    };
    assert_eq!((first.shininess, first.ior), (20.0, 1.3));
    assert_eq!(first.reflection.unwrap().color, DVec3::splat(0.5));
    assert!(first.diffuse.texture.is_some() && first.diffuse.texture == first.reflection.unwrap().texture);
    assert_eq!((second.diffuse.texture, second.reflection), (None, None));
    assert_eq!(
        second.specular.color,
        DVec3::splat(0.5),
        "what the map leaves out stays"
    );
    assert!(matches!(*scene.textures[0], Texture::Checker { size: 2.0, .. }));
}

#[test]
fn a_material_that_is_refused_changes_nothing() {
    let source = "try { material(#{ ambient: [1, 1, 1], shininess: -1 }); } catch { } sphere(0, 0, 0, 1);";
    assert_eq!(run(source).scene.materials[0].ambient.color, DVec3::splat(0.2));
}

#[test]
fn vectors_calculate() {
    for (source, wanted) in [
        ("vec3(1, 2, 3) + vec3(1, 1, 1)", "[2.0, 3.0, 4.0]"),
        ("vec3(1, 2, 3) - [1, 1, 1]", "[0.0, 1.0, 2.0]"),
        ("[1, 1, 1] - vec3(1, 2, 3)", "[0.0, -1.0, -2.0]"),
        ("2 * vec3(1, 2, 3)", "[2.0, 4.0, 6.0]"),
        ("vec3(1, 2, 3) * 0.5", "[0.5, 1.0, 1.5]"),
        ("vec3(1, 2, 3) * vec3(2, 3, 4)", "[2.0, 6.0, 12.0]"),
        ("vec3(1, 2, 4) / 2", "[0.5, 1.0, 2.0]"),
        ("6 / vec3(1, 2, 3)", "[6.0, 3.0, 2.0]"),
        ("vec3(1, 2, 3) + 1", "[2.0, 3.0, 4.0]"),
        ("-vec3(1, 2, 3)", "[-1.0, -2.0, -3.0]"),
        ("vec3(0.1 + 0.2, 0, 0) == vec3(0.3, 0, 0)", "true"),
        ("vec3(1, 2, 3) == [1, 2, 3]", "true"),
        ("vec3(1, 2, 3) != vec3(1, 2, 4)", "true"),
        ("vec3(1, 2, 3).dot(vec3(4, 5, 6))", "32.0"),
        ("dot([1, 2, 3], 4, 5, 6)", "32.0"),
        ("vec3(1, 0, 0).cross([0, 1, 0])", "[0.0, 0.0, 1.0]"),
        ("vec3(3, 4, 0).length()", "5.0"),
        ("length(3, 4, 0)", "5.0"),
        ("vec3(0, 0, 9).normalize()", "[0.0, 0.0, 1.0]"),
        ("distance([1, 1, 1], [1, 1, 3])", "2.0"),
        ("vec3(0, 0, 0).lerp([2, 4, 6], 0.5)", "[1.0, 2.0, 3.0]"),
        ("lerp(10, 20, 0.25)", "12.5"),
        ("mix([0, 0, 0], [1, 1, 1], 1)", "[1.0, 1.0, 1.0]"),
        ("vec3(1, 2, 3).y", "2.0"),
        ("vec3(1, 2, 3)[2]", "3.0"),
        ("vec3(1, 2, 3)[-3]", "1.0"),
        ("vec3(1, 2, 3).to_array()", "[1.0, 2.0, 3.0]"),
        ("\"v = \" + vec3(1, 2, 3)", "v = [1.0, 2.0, 3.0]"),
        ("`${vec3(1, 2, 3)}`", "[1.0, 2.0, 3.0]"),
        ("type_of(vec3(1, 2, 3))", "vec3"),
    ] {
        assert_eq!(printed(&format!("print({source});")), [wanted], "{source}");
    }
    let changed = "let v = vec3(1, 2, 3); v.x = 5; v.y += 0.5; v[2] = 7; v *= 2; v += [1, 0, 0]; print(v); let m = #{ p: v }; m.p.z = 0; print(m.p);";
    assert_eq!(printed(changed), ["[11.0, 5.0, 14.0]", "[11.0, 5.0, 0.0]"]);
}

#[test]
fn random_numbers_follow_the_seed_alone() {
    let five = "for i in 0..5 { print(random()); }";
    let first = printed(five);
    assert_eq!(first, printed(five));
    assert_eq!(first, printed(&format!("seed(0); {five}")), "0 is the default");
    assert_ne!(first, printed(&format!("seed(1); {five}")));
    let restarted = printed(&format!("random(); seed(0); {five}"));
    assert_eq!(first, restarted, "seed starts the row anew");
    assert_eq!(
        first[0], "0.8833108082136426",
        "the numbers of seed 0 are fixed for ever"
    );
    let inside = "for i in 0..1000 { let x = random(-2, 3.5); if x < -2 || x >= 3.5 { throw x; } let n = randomInt(-1, 1); if n < -1 || n > 1 { throw n; } }";
    run(inside);
}

#[test]
fn points_are_pushed_one_by_one() {
    // Measured after every push, as Rhai does by itself, this would take minutes.
    let source = "
        let positions = []; let indices = [];
        for i in 0..30000 { positions.push([i, 0, 0]); positions.push(vec3(i, 1, 0)); }
        for i in 0..59998 { indices.push(i); indices.push(i + 1); indices.push(i + 2); }
        mesh(#{ positions: positions, indices: indices });
        let list = [1]; list.push([2, [3]]); list.push(#{ a: 1 }); push(list, \"x\"); list += 4;
        print(list);
    ";
    let host = Notes::default();
    let scene = run_on(&host, source).unwrap().value.scene;
    assert_eq!(scene.meshes[0].triangles.len(), 59_998);
    assert_eq!(host.printed(), ["[1, [2, [3]], #{\"a\": 1}, \"x\", 4]"]);
    let e = try_run("const A = [1]; A.push(2);").unwrap_err();
    assert_eq!(e.diagnostic.message, "a constant cannot be changed by push()");
}

#[test]
fn hue_saturation_value() {
    let close = |source: &str, wanted: [f64; 3]| {
        let c = run(&format!("background({source});")).scene.settings.background;
        assert!((c - DVec3::from_array(wanted)).length() < 1e-12, "{source}: {c}");
    };
    close("hsv(0, 1, 1)", [1.0, 0.0, 0.0]);
    close("hsv(120, 1, 1)", [0.0, 1.0, 0.0]);
    close("hsv(-120, 1, 1)", [0.0, 0.0, 1.0]);
    close("hsv(60, 1, 1)", [1.0, 1.0, 0.0]);
    close("hsv(17, 0, 1)", [1.0, 1.0, 1.0]);
    close("hsv(400, 0.5, 0)", [0.0, 0.0, 0.0]);
}
