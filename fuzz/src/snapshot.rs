//! Snapshots as `rtscript test` keeps them.

use rtscript::testing::Snapshot;

pub fn run(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    match Snapshot::parse(&text) {
        Err((line, why)) => {
            let lines = text.lines().count().max(1);
            assert!(
                (1..=lines).contains(&(line as usize)),
                "line {line} of {lines}: {why}"
            );
            assert!(why.len() <= 4 << 10, "{} bytes", why.len());
        }
        Ok(snapshot) => {
            // NaN is not equal to itself: the texts are compared.
            let written = snapshot.to_string();
            let again = Snapshot::parse(&written).unwrap_or_else(|e| panic!("{e:?}\n{written}"));
            assert_eq!(again.to_string(), written);
        }
    }
}
