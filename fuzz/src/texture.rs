//! Pictures as textures.

use rtscript::{
    DVec3, MemoryHost,
    import::{AssetCache, Assets},
    math::DVec2,
    scene::Texture,
};

use crate::oracle::{check, limits};

pub fn run(data: &[u8]) {
    let (limits, host) = (limits(), MemoryHost::new().with("a.png", data));
    let mut cache = AssetCache::default();
    match Assets::new(&host, &limits, &mut cache).texture("a.png") {
        Err(error) => check(&error, &[]),
        Ok(texture) => {
            let Texture::Image(image) = &*texture else {
                panic!("a picture is no {texture:?}");
            };
            assert!(
                image.width.max(image.height) <= limits.texture_side,
                "past the limit"
            );
            for i in 0..8 {
                let uv = DVec2::new(f64::from(i) / 3.0 - 1.0, f64::from(i) / 5.0);
                let color = texture.color(uv, DVec3::ZERO);
                let range = color.min_element() >= 0.0 && color.max_element() <= 1.0;
                assert!(color.is_finite() && range, "the color {color}");
            }
        }
    }
}
