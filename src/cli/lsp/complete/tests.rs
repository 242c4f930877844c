use super::*;

fn items(text: &str) -> BTreeMap<String, Value> {
    let at = text.find('^').unwrap();
    let mut documents = Documents::default();
    documents.open("file:///x/a.rhai", 1, &text.replacen('^', "", 1));
    documents.open("file:///x/m.rhai", 1, "fn tower(h, w) { }\nprivate fn no() { }");
    let document = documents.get("file:///x/a.rhai").unwrap();
    let all = complete(&documents, document, at, true).into_iter();
    all.map(|item| (item["label"].as_str().unwrap().to_owned(), item))
        .collect()
}

fn labels(text: &str) -> Vec<String> {
    items(text).into_keys().collect()
}

fn new_text(text: &str, label: &str) -> String {
    items(text)[label]["textEdit"]["newText"]
        .as_str()
        .unwrap()
        .to_owned()
}

#[test]
fn functions_come_with_places_to_fill_in() {
    assert_eq!(new_text("sph^", "sphere"), "sphere(${1:center}, ${2:radius})");
    assert_eq!(new_text("sph^(1)", "sphere"), "sphere");
    assert_eq!(new_text("gr^", "group"), "group {\n\t$0\n\\}");
    assert_eq!(new_text("^", "define"), "define \"${1:name}\" {\n\t$0\n\\}");
    assert_eq!(new_text("mes^", "mesh"), "mesh(\"${1:file}\")");
    let range = &items("a; sph^")["sphere"]["textEdit"]["range"];
    assert_eq!(
        (&range["start"]["character"], &range["end"]["character"]),
        (&json!(3), &json!(6))
    );
    let resolved = resolve(items("^")["sphere"].clone());
    assert!(
        resolved["documentation"]["value"]
            .as_str()
            .unwrap()
            .contains("radius")
    );
}

#[test]
fn what_is_declared_is_offered_where_it_is_known() {
    let all = labels("let far = 1; fn f(near) { let mid = 2; ^ }");
    for name in ["near", "mid", "f", "PI", "let", "sphere", "abs"] {
        assert!(all.iter().any(|l| l == name), "{name}");
    }
    assert!(!all.iter().any(|l| l == "far"));
}

#[test]
fn points_colons_and_maps_have_their_own() {
    assert!(labels("v.^").contains(&"x".to_owned()));
    assert!(!labels("v.^").contains(&"sphere".to_owned()));
    assert_eq!(labels("import \"m\" as m; m::^"), ["tower"]);
    assert_eq!(labels("const A = 1; let b = 2; global::^"), ["A"]);
    let keys = labels("material(#{ diffuse: [1, 0, 0], ^ })");
    assert!(
        keys.contains(&"shininess".to_owned()) && !keys.contains(&"diffuse".to_owned()),
        "{keys:?}"
    );
    assert_eq!(labels("param(\"a\", 1, #{ mi^"), ["choices", "doc", "max", "min"]);
    assert!(labels("param(\"a\", 1, #{ min: ^").contains(&"PI".to_owned()));
    assert_eq!(labels("let m = #{ ^"), [""; 0]);
}

#[test]
fn names_are_not_invented() {
    for text in [
        "let ^",
        "fn ^",
        "// sph^",
        "12^",
        "\"^\"",
        "import \"m\" as ^",
        "let a = \"sph^",
    ] {
        assert_eq!(labels(text), [""; 0], "{text}");
    }
}

#[test]
fn strings_name_files_and_definitions() {
    assert_eq!(labels("define \"car\" { } instance(\"^\")"), ["car"]);
    let open = &items("define \"car\" { } instance(\"c^, 3")["car"]["textEdit"]["range"];
    assert_eq!(
        (&open["start"]["character"], &open["end"]["character"]),
        (&json!(27), &json!(28))
    );
    let folder = std::env::temp_dir().join(format!("rtscript-complete-{}", std::process::id()));
    fs::create_dir_all(folder.join("models")).unwrap();
    for file in [
        "parts.rhai",
        "a.rhai",
        "wood.png",
        "models/cow.obj",
        "models/cow.mtl",
    ] {
        fs::write(folder.join(file), "").unwrap();
    }
    let uri = crate::cli::lsp::uri::of_path(&folder.join("a.rhai"));
    let files = |text: &str| -> Vec<String> {
        let at = text.find('^').unwrap();
        let mut documents = Documents::default();
        documents.open(&uri, 1, &text.replacen('^', "", 1));
        let all = complete(&documents, documents.get(&uri).unwrap(), at, true);
        all.iter()
            .map(|item| item["textEdit"]["newText"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(files("import \"^\""), ["parts", "models/"]);
    assert_eq!(files("image(\"^\")"), ["wood.png", "models/"]);
    assert_eq!(files("mesh(\"models/^\")"), ["models/cow.obj"]);
    assert_eq!(files("mesh(\"../^\")"), [""; 0]);
    fs::remove_dir_all(folder).unwrap();
}
