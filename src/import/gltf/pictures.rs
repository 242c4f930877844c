//! The textures of a file: pictures beside it or inside of it, as a whole or a channel of them.

use std::{collections::BTreeMap, sync::Arc};

use super::{
    super::assets::Assets,
    accessor::buffer_view,
    bytes::{self, Buffers},
    item::{Item, Kind},
};
use crate::{
    color,
    diag::Diagnostic,
    scene::{Builder, ImageTexture, Laying, MappedImage, Texels, Texture, TextureFilter, Wrap},
};

const TEXTURE: Kind = Kind {
    one: "texture",
    list: "textures",
};
const IMAGE: Kind = Kind {
    one: "image",
    list: "images",
};
const SAMPLER: Kind = Kind {
    one: "sampler",
    list: "samplers",
};

/// What of a picture is asked for. All but the picture itself is a number for each texel, the same in its three channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Channel {
    Picture,
    Red,
    Green,
    Blue,
    /// How solid it is.
    Alpha,
    /// 1 where it is solid and 0 elsewhere, this byte being where solid begins.
    Mask(u8),
}

/// A texture, and what its texels have in common.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) texture: Arc<Texture>,
    /// The byte that all texels are, of a channel.
    pub(super) same: Option<u8>,
}

/// The textures of a file, each made once.
pub(super) struct Pictures<'a, 's> {
    name: &'a str,
    buffers: &'s Buffers<'a>,
    /// By picture.
    whole: BTreeMap<usize, Arc<Texture>>,
    /// By picture, channel and sampler.
    made: BTreeMap<(usize, Channel, Option<usize>), Found>,
    has_warned: bool,
}

impl<'a, 's> Pictures<'a, 's> {
    pub(super) fn new(name: &'a str, buffers: &'s Buffers<'a>) -> Self {
        Self {
            name,
            buffers,
            whole: BTreeMap::new(),
            made: BTreeMap::new(),
            has_warned: false,
        }
    }

    /// The texture that an entry as `baseColorTexture` leads to.
    ///
    /// # Errors
    /// Where a number leads nowhere, or a picture cannot be read.
    pub(super) fn find(
        &mut self,
        root: &Item<'_, 'a>,
        entry: &Item<'_, 'a>,
        channel: Channel,
        assets: &mut Assets<'_>,
        builder: &mut Builder,
    ) -> Result<Found, Diagnostic> {
        let number = entry.needed("index")?;
        let i = number.index(TEXTURE, root.count(TEXTURE.list)?)?;
        let textures = root.needed(TEXTURE.list)?;
        let texture = textures
            .entry(i)?
            .ok_or_else(|| number.error("there is no such texture"))?;
        let Some(source) = texture.get("source")? else {
            return Err(texture.error("it has no 'source', a picture in PNG or JPEG"));
        };
        let image = source.index(IMAGE, root.count(IMAGE.list)?)?;
        let sampler = match texture.get("sampler")? {
            None => None,
            Some(number) => Some(number.index(SAMPLER, root.count(SAMPLER.list)?)?),
        };
        if let Some(found) = self.made.get(&(image, channel, sampler)) {
            return Ok(found.clone());
        }
        let images = root.needed(IMAGE.list)?;
        let item = images
            .entry(image)?
            .ok_or_else(|| source.error("there is no such image"))?;
        let (picture, same) = match channel {
            Channel::Picture => (self.picture(root, &item, image, assets)?, None),
            Channel::Alpha | Channel::Mask(_) => {
                let alpha = self.alpha(root, &item, assets)?;
                grays(&alpha.0, alpha.1, &alpha.2, |[a, ..]| match channel {
                    Channel::Mask(least) => {
                        if a < least {
                            0
                        } else {
                            255
                        }
                    }
                    _ => a,
                })
            }
            _ => {
                let whole = self.picture(root, &item, image, assets)?;
                match &*whole {
                    Texture::Image(ImageTexture {
                        name,
                        width,
                        height: _,
                        texels: Texels::Srgb8(texels),
                    }) => grays(name, *width, texels, |[r, g, b]| match channel {
                        Channel::Green => g,
                        Channel::Blue => b,
                        _ => r,
                    }),
                    _ => return Err(item.error("expected a PNG or JPEG picture")),
                }
            }
        };
        let laying = match sampler {
            None => Laying::default(),
            Some(i) => {
                let samplers = root.needed(SAMPLER.list)?;
                match samplers.entry(i)? {
                    Some(sampler) => self.laying(&sampler, builder)?,
                    None => Laying::default(),
                }
            }
        };
        let texture = if laying == Laying::default() {
            picture
        } else {
            let of = Arc::clone(&picture);
            let laid = MappedImage::with_copies(picture, laying, |image| assets.pyramid(&of, image));
            Arc::new(Texture::Mapped(Box::new(
                laid.map_err(|error| item.error(error))?,
            )))
        };
        let found = Found { texture, same };
        self.made.insert((image, channel, sampler), found.clone());
        Ok(found)
    }

    /// The whole picture of an entry of `images`.
    fn picture(
        &mut self,
        root: &Item<'_, 'a>,
        item: &Item<'_, 'a>,
        i: usize,
        assets: &mut Assets<'_>,
    ) -> Result<Arc<Texture>, Diagnostic> {
        if let Some(known) = self.whole.get(&i) {
            return Ok(Arc::clone(known));
        }
        let texture = match self.inside(root, item, assets)? {
            Some(bytes) => {
                let name = format!("{}#{item}", self.name);
                assets
                    .texture_within(&name, &bytes)
                    .map_err(|error| item.place(error))?
            }
            None => {
                let uri = item.needed("uri")?;
                let path = bytes::file(self.name, &uri)?;
                assets.texture(&path).map_err(|error| uri.place(error))?
            }
        };
        self.whole.insert(i, Arc::clone(&texture));
        Ok(texture)
    }

    /// How solid the texels of a picture are.
    fn alpha(
        &self,
        root: &Item<'_, 'a>,
        item: &Item<'_, 'a>,
        assets: &mut Assets<'_>,
    ) -> Result<(String, u32, Vec<[u8; 3]>), Diagnostic> {
        let name = format!("{}#{item}", self.name);
        let bytes = match self.inside(root, item, assets)? {
            Some(bytes) => bytes,
            None => bytes::file_or_data(self.name, &item.needed("uri")?, assets)?,
        };
        let alpha = assets
            .alpha_within(&name, &bytes)
            .map_err(|error| item.place(error))?;
        Ok((name, alpha.0, alpha.1))
    }

    /// The bytes of a picture that is no file of its own.
    fn inside(
        &self,
        root: &Item<'_, 'a>,
        item: &Item<'_, 'a>,
        assets: &mut Assets<'_>,
    ) -> Result<Option<Vec<u8>>, Diagnostic> {
        if let Some(view) = item.get("bufferView")? {
            let (bytes, _) = buffer_view(&view, root, self.buffers, assets)?;
            return Ok(Some(bytes.to_vec()));
        }
        bytes::data(&item.needed("uri")?)
    }

    fn laying(&mut self, sampler: &Item<'_, 'a>, builder: &mut Builder) -> Result<Laying, Diagnostic> {
        let wrap = |name: &'static str| -> Result<Wrap, Diagnostic> {
            let Some(item) = sampler.get(name)? else {
                return Ok(Wrap::Repeat);
            };
            match item.whole()? {
                10497 => Ok(Wrap::Repeat),
                33071 => Ok(Wrap::Clamp),
                33648 => Ok(Wrap::Mirror),
                n => Err(item.error(format!("expected 10497, 33071 or 33648, found {n}"))),
            }
        };
        let (across, up) = (wrap("wrapS")?, wrap("wrapT")?);
        if across != up && !self.has_warned {
            self.has_warned = true;
            sampler.warn(
                builder,
                "wrapS counts in both directions, and wrapT in none",
                None,
            );
        }
        let filter = match (
            sampler.whole_or("magFilter", 9729)?,
            sampler.whole_or("minFilter", 9729)?,
        ) {
            (9728, _) => TextureFilter::Nearest,
            (_, 9984..=9987) => TextureFilter::Mip,
            _ => TextureFilter::Bilinear,
        };
        Ok(Laying {
            filter,
            wrap: across,
            ..Laying::default()
        })
    }
}

/// A picture of one number for each texel, which is looked up as light: so its bytes are those that stand for as much light.
/// With the byte that all of them are, if they are.
fn grays(
    name: &str,
    width: u32,
    texels: &[[u8; 3]],
    of: impl Fn([u8; 3]) -> u8,
) -> (Arc<Texture>, Option<u8>) {
    let stored: [u8; 256] =
        std::array::from_fn(|i| (color::srgb_from_linear(i as f64 / 255.0) * 255.0 + 0.5) as u8);
    let first = texels.first().map(|texel| of(*texel));
    let mut same = first;
    let grays = texels.iter().map(|texel| {
        let byte = of(*texel);
        if Some(byte) != first {
            same = None;
        }
        [stored.get(usize::from(byte)).copied().unwrap_or(byte); 3]
    });
    let grays: Vec<[u8; 3]> = grays.collect();
    let height = u32::try_from(grays.len()).unwrap_or(u32::MAX) / width.max(1);
    let picture = Texture::Image(ImageTexture {
        name: name.to_owned(),
        width,
        height,
        texels: Texels::Srgb8(grays),
    });
    (Arc::new(picture), same)
}
