//! Color swatches. What a client shows and picks is sRGB; numbers in a script are linear light, codes are sRGB.

use serde_json::{Value, json};

use super::documents::Document;
use crate::{
    color::{Color, linear_from_srgb, srgb_from_linear},
    script::analysis::{ColorPlace, Notation, colors as places},
};

/// All colors of a document.
pub(super) fn colors(document: &Document) -> Vec<Value> {
    let shown = places(document.analysis()).into_iter().map(|place| {
        let [red, green, blue] = (place.color / strength(place.color)).to_array().map(|c| {
            // Never outside the range, whatever the last digit.
            srgb_from_linear(c.max(0.0)).clamp(0.0, 1.0)
        });
        json!({
            "range": document.span(&place.span),
            "color": { "red": red, "green": green, "blue": blue, "alpha": 1 },
        })
    });
    shown.collect()
}

/// A light may be brighter than any screen: it is shown by its hue, and keeps its strength when another is picked.
fn strength(color: Color) -> f64 {
    color.max_element().max(1.0)
}

/// How a picked color is written at `start..end`, in the notation that stands there, and as a code.
pub(super) fn presentations(document: &Document, range: &Value, picked: &Value) -> Option<Vec<Value>> {
    let span = document.lines.range(&document.text, range, document.encoding)?;
    let channel = |name| {
        picked
            .get(name)
            .and_then(Value::as_f64)
            .map(|c| c.clamp(0.0, 1.0))
    };
    let srgb = [channel("red")?, channel("green")?, channel("blue")?];
    let there = places(document.analysis())
        .into_iter()
        .find(|place| place.span == span);
    let notation = there.as_ref().map_or(Notation::Code, |place| place.notation);
    let scale = there.map_or(1.0, |ColorPlace { color, .. }| strength(color));
    let numbers = srgb.map(|c| number(linear_from_srgb(c) * scale)).join(", ");
    let code = format!(
        "\"#{}\"",
        srgb.map(|c| format!("{:02x}", (c * 255.0).round() as u8))
            .concat()
    );
    let as_code = notation != Notation::Code && scale <= 1.0;
    let first = match notation {
        Notation::Code => code.clone(),
        Notation::Array => format!("[{numbers}]"),
        Notation::Vector => format!("vec3({numbers})"),
        Notation::Numbers => numbers,
    };
    let all = [first].into_iter().chain(as_code.then_some(code));
    let edits = all
        .map(|text| json!({ "label": text, "textEdit": { "range": document.span(&span), "newText": text } }));
    Some(edits.collect())
}

/// Digits enough for the eight bits of a screen, which are finest in the dark.
fn number(x: f64) -> String {
    let digits = if x < 0.05 { 4 } else { 3 };
    let text = format!("{x:.digits$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::lsp::text::Encoding;

    fn document(text: &str) -> Document {
        Document::new("file:///a.rhai", 1, text, Encoding::Utf16)
    }

    fn shown(text: &str) -> [f64; 3] {
        let all = colors(&document(text));
        let color = &all[0]["color"];
        ["red", "green", "blue"].map(|c| color[c].as_f64().unwrap())
    }

    /// What is written after another color is picked.
    fn picked(text: &str, srgb: [f64; 3]) -> Vec<String> {
        let document = document(text);
        let range = colors(&document)[0]["range"].clone();
        let picked = json!({ "red": srgb[0], "green": srgb[1], "blue": srgb[2], "alpha": 1 });
        let all = presentations(&document, &range, &picked).unwrap();
        all.iter()
            .map(|p| p["textEdit"]["newText"].as_str().unwrap().to_owned())
            .collect()
    }

    #[test]
    fn numbers_are_linear_and_codes_are_not() {
        let middle = shown("diffuse([0.5, 0.5, 0.5]);")[0];
        assert!((middle - 0.735_357).abs() < 1e-5, "{middle}");
        let code = shown("diffuse(\"#808080\");")[0];
        assert!((code - 128.0 / 255.0).abs() < 1e-9, "{code}");
        let [red, green, _] = shown("light([1, 2, 3], [10, 0, 0]);");
        assert!((red - 1.0).abs() < 1e-9 && green == 0.0, "{red} {green}");
    }

    #[test]
    fn a_color_keeps_its_notation_and_a_light_its_strength() {
        assert_eq!(
            picked("diffuse([1, 1, 1]);", [0.0, 128.0 / 255.0, 1.0]),
            ["[0, 0.216, 1]", "\"#0080ff\""]
        );
        assert_eq!(picked("diffuse(1, 1, 1);", [1.0, 0.0, 0.0])[0], "1, 0, 0");
        assert_eq!(
            picked("diffuse(vec3(1, 1, 1));", [1.0, 0.0, 0.0])[0],
            "vec3(1, 0, 0)"
        );
        assert_eq!(picked("diffuse(\"#fff\");", [1.0, 0.5, 0.0])[0], "\"#ff8000\"");
        assert_eq!(
            picked("light([1, 2, 3], [10, 0, 0]);", [0.0, 1.0, 0.0]),
            ["[0, 10, 0]"]
        );
    }

    #[test]
    fn every_byte_comes_back() {
        for byte in 0..=255u8 {
            let srgb = f64::from(byte) / 255.0;
            let text = picked("diffuse([1, 1, 1]);", [srgb; 3]).remove(0);
            let back = shown(&format!("diffuse({text});"))[0];
            assert_eq!((back * 255.0).round() as u8, byte, "{text}");
        }
    }
}
