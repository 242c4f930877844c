use super::*;
use crate::{color::Color, script::entry};

/// The text without its `^`, and where that stood.
fn marked(text: &str) -> (Analysis, usize) {
    let at = text.find('^').expect("a mark");
    (Analysis::of(text.replacen('^', "", 1)), at)
}

/// The declaration that the name at the mark stands for, as it is written.
fn target(text: &str) -> Option<String> {
    let (analysis, at) = marked(text);
    let symbol = &analysis.symbols()[analysis.resolve(analysis.token_at(at)?)?];
    let line = analysis.text()[..symbol.name.start].matches('\n').count() + 1;
    Some(format!("{}:{line}", &analysis.text()[symbol.name.clone()]))
}

fn visible(text: &str) -> Vec<String> {
    let (analysis, at) = marked(text);
    analysis
        .visible(at)
        .map(|s| analysis.text()[s.name.clone()].to_owned())
        .collect()
}

#[test]
fn names_lead_to_their_declaration() {
    for (text, wanted) in [
        ("let a = 1;\na^;", Some("a:1")),
        ("let a = 1;\nlet a = a^;", Some("a:1")),
        ("let a = 1;\n{ let a = 2;\na^ }", Some("a:2")),
        ("let a = 1;\n{ let a = 2; }\na^", Some("a:1")),
        ("let a = 1;\nfn f() { a^ }", None),
        ("const A = 1;\nfn f() { global::A^ }", Some("A:1")),
        ("fn f(a) {\n a^ }", Some("a:1")),
        (
            "let a = 1;\nlet f = |a| a + 1;\nlet g =\n|a| { a^ };",
            Some("a:4"),
        ),
        ("let x = 3;\nlet f = |a| x^ + 1;", Some("x:1")),
        ("for i in 0..3 {\n i^ }", Some("i:1")),
        ("for (x, i) in a {\n i^ }", Some("i:1")),
        ("for i in 0..3 { }\n i^", None),
        ("try { } catch (e) {\n e^.message }", Some("e:1")),
        ("fn f(a) { }\nfn f(a, b) { }\nf^(1, 2);", Some("f:2")),
        ("fn f(a) { }\n1.f^()", Some("f:1")),
        ("import \"m\" as m;\nm^::f()", Some("m:1")),
        ("define \"car\" { }\ninstance(\"ca^r\")", Some("\"car\":1")),
        ("let x = 1;\n#{ x^: 2 }", None),
        ("let x = 1;\nv.x^", None),
        ("let x = 1;\n`a ${x^}`", Some("x:1")),
        ("fn f() { }\nFn(\"f^\")", Some("f:1")),
        ("let a = sphere(1, [2;\nlet b = a^", Some("a:1")),
    ] {
        assert_eq!(target(text).as_deref(), wanted, "{text}");
    }
}

#[test]
fn what_is_known_depends_on_the_place() {
    assert_eq!(
        visible("let a = 1; fn f(p) { let q = 2; ^ } let z = 3;"),
        ["f", "p", "q"]
    );
    assert_eq!(visible("let a = 1; fn f(p) { } ^ let z = 3;"), ["a", "f"]);
    assert_eq!(visible("let a = 1; for i in 0..3 { let b = i;^"), ["a", "i", "b"]);
    assert_eq!(visible("let f = |u, v| u + ^;"), ["u", "v"]);
}

#[test]
fn references_are_those_of_one_declaration() {
    let (analysis, at) = marked("let a^ = 1; { let a = 2; a; } a + `${a}`; v.a; #{ a: a };");
    let symbol = analysis.resolve(analysis.token_at(at).unwrap()).unwrap();
    let found: Vec<usize> = analysis.references(symbol).iter().map(|r| r.start).collect();
    assert_eq!(found, [4, 29, 36, 52]);
}

#[test]
fn functions_carry_their_comments_and_parameters() {
    let analysis =
        Analysis::of("// no\n/// A tower.\n/// `h`: height\nprivate fn tower(h, w) { h }\nfn other() { }");
    let [tower, h, _, other] = analysis.symbols() else {
        panic!("{:?}", analysis.symbols());
    };
    assert_eq!(tower.doc, "A tower.\n`h`: height");
    assert_eq!(tower.params, ["h", "w"]);
    assert!(tower.private && !other.private && other.doc.is_empty());
    assert_eq!(h.function, Some(0));
}

#[test]
fn calls_are_found_in_unfinished_text() {
    let call = |text: &str| {
        let (analysis, at) = marked(text);
        analysis
            .call_at(at)
            .map(|c| format!("{}/{}", analysis.word(c.name), c.active(at)))
    };
    for (text, wanted) in [
        ("sphere(^", Some("sphere/0")),
        ("sphere(1, ^", Some("sphere/1")),
        ("sphere([1, 2, ^3], 4)", Some("sphere/0")),
        ("sphere(f(1, 2), ^)", Some("sphere/1")),
        ("sphere(f(1, ^2), 3)", Some("f/1")),
        ("sphere(1, 2)^", None),
        ("sphere(1, 2;\n^", None),
        ("sphere(1,\nlet x = 2; box(^", Some("box/0")),
        ("fn f(^", None),
        ("map(|x| { ^ })", None),
        ("if (^", None),
        ("m::tower(1, ^", Some("tower/1")),
    ] {
        assert_eq!(call(text).as_deref(), wanted, "{text}");
    }
}

#[test]
fn arguments_find_their_parameters() {
    let params = |text: &str, complete| {
        let analysis = Analysis::of(text);
        let call = analysis.call_of(0).unwrap();
        let form = entry(analysis.word(0)).unwrap().forms[0];
        assigned(&analysis, form, &call.args, complete)
    };
    assert_eq!(params("sphere(0, 0, -1, 2)", true), Some(vec![0, 0, 0, 1]));
    assert_eq!(params("sphere([0, 0, 0], 2)", true), Some(vec![0, 1]));
    assert_eq!(params("sphere(c, 2)", true), Some(vec![0, 1]));
    assert_eq!(params("sphere(x, y, z, r)", true), Some(vec![0, 0, 0, 1]));
    assert_eq!(params("sphere(0, 0", true), None);
    assert_eq!(params("sphere(0, 0", false), Some(vec![0, 0]));
    assert_eq!(params("sphere(\"a\", 2)", false), None);
    assert_eq!(params("light([1, 2, 3], 1, 1, 1)", true), Some(vec![0, 1, 1, 1]));
}

#[test]
fn colors_are_found_where_colors_are_taken() {
    let found = |text: &str| -> Vec<(String, Color, Notation)> {
        let analysis = Analysis::of(text);
        let places = colors(&analysis).into_iter();
        places
            .map(|c| (analysis.text()[c.span].to_owned(), c.color, c.notation))
            .collect()
    };
    let one = |text: &str| {
        let [(written, color, notation)] = found(text).try_into().unwrap();
        (written, color, notation)
    };
    assert_eq!(
        one("diffuse([1, 0.5, 0]);"),
        ("[1, 0.5, 0]".into(), Color::new(1.0, 0.5, 0.0), Notation::Array)
    );
    assert_eq!(
        one("diffuse(1, 0, 0);"),
        ("1, 0, 0".into(), Color::X, Notation::Numbers)
    );
    assert_eq!(
        one("background(\"#00f\")"),
        ("\"#00f\"".into(), Color::Z, Notation::Code)
    );
    assert_eq!(
        one("light([1, 2, 3], vec3(5, 5, 5))"),
        ("vec3(5, 5, 5)".into(), Color::splat(5.0), Notation::Vector)
    );
    assert_eq!(
        one("light(1, 2, 3, 0, 1, 0)"),
        ("0, 1, 0".into(), Color::Y, Notation::Numbers)
    );
    assert_eq!(
        one("material(#{ diffuse: [1, 0, 0], shininess: 3 })").0,
        "[1, 0, 0]"
    );
    assert_eq!(found("checker(\"#fff\", [0, 0, 0], 2)").len(), 2);
    for none in [
        "sphere([1, 0, 0], 1)",
        "diffuse([1, 0, x])",
        "diffuse(\"red\")",
        "fn diffuse(a) { } diffuse([1, 0, 0])",
        "print(\"#fff\")",
        "diffuse([1, 0",
    ] {
        assert_eq!(found(none), [], "{none}");
    }
}

#[test]
fn a_file_of_functions_is_a_library() {
    assert!(Analysis::of("/// Doc\nfn f() { sphere(1); }\nconst A = 1;").is_library());
    assert!(Analysis::of("private fn f() { } export const A = [1];").is_library());
    for scene in ["fn f() { } f();", "", "sphere(1);", "const A = 1; light(1);"] {
        assert!(!Analysis::of(scene).is_library(), "{scene}");
    }
}

/// Cut anywhere and with brackets put anywhere, texts are looked at in full, and the answers stay inside the text.
#[test]
fn no_text_is_too_broken() {
    let whole = "import \"a\" as m; /// d\nfn f(a, b) { let é = |x| #{ k: `v ${ a[0] } w` }; for (i, j) in 0..3 { m::g(é, \"s\"); } }\n\
                 define \"c\" { } try { diffuse([1, 0, 0]); } catch (e) { throw e; } sphere(/* x */ 1, 2.5e3, 'c');";
    let mut state = 7u64;
    let mut random = |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let junk = [
        "(", ")", "{", "}", "[", "]", "#{", "${", "`", "\"", "|", ",", ";", "::", ".", "fn", "let", "é",
        "/*", "'",
    ];
    for _ in 0..600 {
        let mut text: Vec<char> = whole.chars().collect();
        text.truncate(random(text.len() + 1));
        for _ in 0..random(6) {
            let at = random(text.len() + 1);
            text.splice(at..at, junk[random(junk.len())].chars());
        }
        let text: String = text.into_iter().collect();
        let analysis = Analysis::of(text.as_str());
        for (offset, _) in text.char_indices() {
            analysis.call_at(offset);
            analysis.map_at(offset);
            analysis.in_comment(offset);
            analysis.visible(offset).count();
            if let Some(symbol) = analysis.token_at(offset).and_then(|t| analysis.resolve(t)) {
                for range in analysis.references(symbol) {
                    assert!(text.get(range.clone()).is_some(), "{range:?} in {text}");
                }
            }
        }
        for color in colors(&analysis) {
            assert!(text.get(color.span).is_some());
        }
        for symbol in analysis.symbols() {
            assert!(text.get(symbol.whole.clone()).is_some(), "{symbol:?} in {text}");
        }
        analysis.blocks().for_each(|b| assert!(text.get(b).is_some()));
    }
}

#[test]
fn hostile_texts_take_linear_time() {
    let n = 100_000;
    for text in [
        format!("{}{}", "(".repeat(n), "]".repeat(n)),
        "let x = ".repeat(n / 8),
        "let x = 1;".repeat(n / 10),
        "for a ".repeat(n / 6),
        "=|x| ".repeat(n / 5),
        "fn f(".repeat(n / 5),
        "diffuse(".repeat(n / 8),
        "{".repeat(n),
        "`${".repeat(n / 3),
        "/*".repeat(n / 2),
    ] {
        let analysis = Analysis::of(text.as_str());
        analysis.call_at(n / 2);
        colors(&analysis);
        analysis.token_at(n / 2).and_then(|t| analysis.resolve(t));
    }
}
