//! `--message-format json`.

use super::*;

/// Every line of standard error as JSON.
fn messages(ran: &Ran) -> Vec<serde_json::Value> {
    let lines = ran.stderr.lines();
    lines
        .map(|line| serde_json::from_str(line).expect(line))
        .collect()
}

#[test]
fn errors_and_warnings_are_objects_with_their_place() {
    let folder = Folder::with("size(4, 4);\nfn ball() { spere(0, 0, 0, 1); }\nball();\n");
    let ran = folder.run(&["scene.rhai", "--message-format", "json"]);
    assert_eq!(ran.code, 1);
    let all = messages(&ran);
    let error = all.last().unwrap();
    assert_eq!(
        (&error["severity"], &error["kind"]),
        (&"error".into(), &"script".into())
    );
    assert_eq!(
        (&error["file"], &error["line"], &error["column"]),
        (&"scene.rhai".into(), &2.into(), &13.into())
    );
    assert!(error["message"].as_str().unwrap().contains("spere"), "{error}");
    assert_eq!(error["source"], "fn ball() { spere(0, 0, 0, 1); }");
    assert!(error["hints"][0].as_str().unwrap().contains("sphere"), "{error}");
    assert!(!error["notes"].as_array().unwrap().is_empty(), "{error}");
}

#[test]
fn everything_on_standard_error_is_json() {
    let folder = Folder::with("size(4, 4); print(`said`);");
    let ran = folder.ok(&["--message-format=json", "scene.rhai", "--stats=json"]);
    let all = messages(&ran);
    assert_eq!(all[0]["severity"], "warning");
    assert_eq!(all[0]["line"], serde_json::Value::Null);
    assert_eq!(all.last().unwrap()["scene"], "scene.rhai");
    assert_eq!(ran.stdout, b"said\n");
    let ran = folder.ok(&["render", "scene.rhai", "--message-format", "json", "--stats"]);
    assert!(
        messages(&ran).iter().any(|m| m["severity"] == "info"),
        "{}",
        ran.stderr
    );
    let ran = folder.run(&["hash", "missing.rhai", "--message-format", "json"]);
    let all = messages(&ran);
    assert_eq!((ran.code, &all[0]["kind"]), (3, &"input".into()));
    assert_eq!(all[0]["file"], serde_json::Value::Null);
    folder.fails(&["scene.rhai", "--message-format", "xml"], 2, &["text, json"]);
}
