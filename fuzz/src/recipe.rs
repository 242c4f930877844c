//! Recipes in PNG files, as text and with their parameters.

use rtscript::{output::encode_png_with, parameters::Parameters, recipe::Recipe, testing::from_rgb8};

pub fn run(data: &[u8]) {
    if let Some(recipe) = Recipe::of_png(data) {
        again(&recipe);
    }
    let text = String::from_utf8_lossy(data);
    if let Ok(parameters) = text.parse::<Parameters>() {
        let written = parameters.to_string();
        assert_eq!(written.parse(), Ok(parameters), "{written}");
    }
    if let Some(recipe) = Recipe::parse(&text) {
        again(&recipe);
        let image = from_rgb8(1, 1, &[1, 2, 3]);
        let png = encode_png_with(&image, &recipe).expect("memory takes any picture");
        assert_eq!(Recipe::of_png(&png).as_ref(), Some(&recipe));
    }
}

fn again(recipe: &Recipe) {
    let text = recipe.to_text();
    assert_eq!(Recipe::parse(&text).as_ref(), Some(recipe), "{text}");
}
