//! Every seed once, without instrumentation; and the dictionary of scripts has every function of the language.

use std::{fmt::Write as _, fs, path::Path};

use rtscript::script::{CONSTANTS, PROPERTIES, entries};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

#[test]
fn every_seed_passes() {
    for (name, run) in rtscript_fuzz::TARGETS {
        let folder = Path::new(ROOT).join("seeds").join(name);
        let mut seeds: Vec<_> = fs::read_dir(&folder)
            .expect("a folder of seeds")
            .map(|entry| entry.expect("an entry").path())
            .collect();
        seeds.sort();
        assert!(!seeds.is_empty(), "{name} has no seeds");
        for seed in seeds {
            println!("{name} {}", seed.display());
            run(&fs::read(&seed).expect("a seed"));
        }
    }
}

#[test]
fn the_dictionary_has_every_word_of_the_language() {
    let mut words: Vec<String> = [
        "group {",
        "define \"a\" {",
        "for i in 0..3 {",
        "fn f(x) {",
        "import \"lib\" as l;",
        "try {",
        "} catch (e) {",
        "|x| x",
        "#{",
        "${",
    ]
    .map(str::to_owned)
    .to_vec();
    for entry in entries() {
        for name in [entry.name].iter().chain(entry.also) {
            words.push(format!("{name}("));
        }
    }
    words.extend(CONSTANTS.iter().map(|constant| constant.name.to_owned()));
    words.extend(PROPERTIES.iter().map(|property| format!(".{}", property.name)));
    words.dedup();
    let mut wanted =
        "# Written by the tests of fuzz/: RTSCRIPT_ACCEPT=1 cargo test --no-default-features\n".to_owned();
    for word in words {
        // libFuzzer's dictionaries escape as C does, and take no line breaks.
        let _ = writeln!(wanted, "\"{}\"", word.replace('\\', "\\\\").replace('"', "\\\""));
    }
    let file = Path::new(ROOT).join("dictionaries/script.dict");
    if std::env::var_os("RTSCRIPT_ACCEPT").is_some() {
        fs::write(&file, &wanted).expect("the dictionary is written");
    }
    let kept = fs::read_to_string(&file).unwrap_or_default();
    assert!(
        kept == wanted,
        "{} is stale: run with RTSCRIPT_ACCEPT=1",
        file.display()
    );
}
