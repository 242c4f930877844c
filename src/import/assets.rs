//! The files that a scene names: read through the host, counted, each decoded once.

use std::{collections::BTreeMap, fmt, sync::Arc};

use super::{kept::KeptAssets, text::quoted, texture};
use crate::{
    diag::{Code, Diagnostic, ErrorKind},
    host::Host,
    limits::Limits,
    scene::{
        AssetFiles, ImageTexture, Mesh, MeshFile, MeshId, Pyramid, Scene, SceneError, Texture, TextureId,
    },
    tessellate::Font,
};

/// Bytes of a path; systems take no more, and messages repeat it.
const LONGEST_PATH: usize = 1024;

/// What has been read so far. It belongs to one run and one [`Builder`](crate::Builder): the materials of the
/// meshes in it are that builder's.
///
/// ```
/// use rtscript::{Limits, MemoryHost, import::{AssetCache, Assets, KeptAssets}};
/// let host = MemoryHost::new().with("notes.txt", "twelve bytes");
/// let limits = Limits::default();
/// // Of this run, knowing what earlier ones decoded.
/// let mut cache = AssetCache::keeping(Some(KeptAssets::new()));
/// Assets::new(&host, &limits, &mut cache).read("notes.txt").map_err(rtscript::Error::from)?;
/// assert_eq!(cache.bytes(), 12);
/// # Ok::<(), rtscript::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct AssetCache {
    textures: BTreeMap<String, Arc<Texture>>,
    /// By path and by the ambient light that went into their materials, if they have any.
    meshes: BTreeMap<(String, Option<[u64; 3]>), Arc<Mesh>>,
    fonts: BTreeMap<String, Font>,
    files: usize,
    bytes: u64,
    /// Bytes of all textures.
    decoded: u64,
    kept: Option<KeptAssets>,
    /// Copies of pictures that were asked for.
    pyramids: Vec<(Arc<Texture>, Arc<Pyramid>)>,
}

impl AssetCache {
    /// An empty cache that makes use of what earlier runs kept, and keeps what it decodes for later ones.
    #[must_use]
    pub fn keeping(kept: Option<KeptAssets>) -> Self {
        Self {
            kept,
            ..Self::default()
        }
    }

    /// Counts the memory of a picture that was read or made; `what` names it.
    ///
    /// # Errors
    /// Past the limit `total_decode_bytes`.
    pub(crate) fn count(
        &mut self,
        what: &str,
        image: &ImageTexture,
        limits: &Limits,
    ) -> Result<(), SceneError> {
        self.count_bytes(what, image.bytes(), limits)
    }

    /// As [`AssetCache::count`], of what [`AssetCache::pyramid`] takes: nothing where it has been asked for before.
    pub(crate) fn count_copies(
        &mut self,
        texture: &Arc<Texture>,
        image: &ImageTexture,
        limits: &Limits,
    ) -> Result<(), SceneError> {
        if self.known_pyramid(texture).is_some() {
            return Ok(());
        }
        let what = format!("a copy of '{}' for what is far away", image.name);
        self.count_bytes(&what, Pyramid::bytes_of(image), limits)
    }

    fn count_bytes(&mut self, what: &str, bytes: u64, limits: &Limits) -> Result<(), SceneError> {
        self.decoded = self.decoded.saturating_add(bytes);
        if self.decoded > limits.total_decode_bytes {
            let what = format!("{what} is too much, with all pictures before it");
            let limit = limits.total_decode_bytes;
            return Err(SceneError::limit(&what, "total_decode_bytes", limit));
        }
        Ok(())
    }

    fn known_pyramid(&self, texture: &Arc<Texture>) -> Option<&Arc<Pyramid>> {
        let known = self.pyramids.iter().find(|(of, _)| Arc::ptr_eq(of, texture));
        known.map(|(_, pyramid)| pyramid)
    }

    /// The copies of a picture for what is far away, the same for the same picture.
    pub(crate) fn pyramid(&mut self, texture: &Arc<Texture>, image: &ImageTexture) -> Arc<Pyramid> {
        if let Some(pyramid) = self.known_pyramid(texture) {
            return Arc::clone(pyramid);
        }
        let pyramid = Arc::new(Pyramid::new(image));
        self.pyramids.push((Arc::clone(texture), Arc::clone(&pyramid)));
        pyramid
    }

    /// Files asked for so far; a file that was in the cache counts once.
    #[must_use]
    pub fn files(&self) -> usize {
        self.files
    }

    /// Which of its files stand behind the textures and meshes of a scene that was built from them.
    pub(crate) fn files_of(&self, scene: &Scene) -> AssetFiles {
        let textures: BTreeMap<_, _> = self
            .textures
            .iter()
            .map(|(path, texture)| (Arc::as_ptr(texture), path))
            .collect();
        let meshes: BTreeMap<_, _> = self
            .meshes
            .iter()
            .map(|((path, light), mesh)| (Arc::as_ptr(mesh), (path, light.is_some())))
            .collect();
        let of_texture =
            |(id, texture)| Some((TextureId(id), (*textures.get(&Arc::as_ptr(texture))?).clone()));
        let of_mesh = |(id, mesh)| {
            let (path, with_materials) = *meshes.get(&Arc::as_ptr(mesh))?;
            let path = path.clone();
            Some((MeshId(id), MeshFile { path, with_materials }))
        };
        AssetFiles {
            textures: (0..).zip(&scene.textures).filter_map(of_texture).collect(),
            meshes: (0..).zip(&scene.meshes).filter_map(of_mesh).collect(),
        }
    }

    /// Bytes read so far.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// A host, its limits and the cache of a run, put together for as long as files are read.
///
/// Paths are relative with `/`, as [`resolve`](crate::host::resolve) gives them.
///
/// ```
/// use rtscript::{Builder, Limits, MemoryHost, import::{AssetCache, Assets, load_mesh}};
/// let host = MemoryHost::new().with("card.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
/// let (limits, mut cache) = (Limits::default(), AssetCache::default());
/// let mut assets = Assets::new(&host, &limits, &mut cache);
/// let mut b = Builder::new();
/// let mesh = load_mesh("card.obj", &mut assets, &mut b).map_err(rtscript::Error::from)?;
/// b.mesh(&mesh)?;
/// assert_eq!((mesh.triangles.len(), cache.files()), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Assets<'a> {
    host: &'a dyn Host,
    limits: &'a Limits,
    cache: &'a mut AssetCache,
}

impl fmt::Debug for Assets<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Assets")
            .field("cache", &self.cache)
            .finish_non_exhaustive()
    }
}

impl<'a> Assets<'a> {
    /// Files of `host` within `limits`, kept in `cache`.
    #[must_use]
    pub fn new(host: &'a dyn Host, limits: &'a Limits, cache: &'a mut AssetCache) -> Self {
        Self { host, limits, cache }
    }

    /// The bytes of a file, not kept.
    ///
    /// # Errors
    /// Whatever the host answers, and past the limits `files`, `file_bytes` and `total_file_bytes`. The error has no place: the
    /// caller knows who named the file.
    pub fn read(&mut self, path: &str) -> Result<Vec<u8>, Diagnostic> {
        if path.len() > LONGEST_PATH {
            let message = format!(
                "the file name {} has more than {LONGEST_PATH} bytes",
                quoted(path)
            );
            return Err(Diagnostic::error(ErrorKind::Input, message));
        }
        self.count_file(path)?;
        // A drive letter is an absolute path for Windows only, but a path to nowhere for everyone.
        let mut parts = path.split('/');
        if parts.any(|part| matches!(part.as_bytes(), [letter, b':', ..] if letter.is_ascii_alphabetic())) {
            return Err(Diagnostic::error(
                ErrorKind::Denied,
                format!("'{path}' is an absolute path; only files below the script's folder can be read"),
            ));
        }
        let bytes = self
            .host
            .read(path, self.limits.file_bytes)
            .map_err(|error| match error.kind {
                // The host knows how many bytes are too many, and the caller which limit that is.
                ErrorKind::Limit => {
                    let what = format!("'{path}' is too large");
                    SceneError::limit(&what, "file_bytes", self.limits.file_bytes).into()
                }
                _ => error.diagnostic(),
            })?;
        self.cache.bytes = self.cache.bytes.saturating_add(bytes.len() as u64);
        if self.cache.bytes > self.limits.total_file_bytes {
            let what = format!("'{path}' is too much, with all files read before it");
            let limit = self.limits.total_file_bytes;
            return Err(SceneError::limit(&what, "total_file_bytes", limit).into());
        }
        Ok(bytes)
    }

    /// The picture at `path` as a texture. The same path gives the same `Arc`.
    ///
    /// # Errors
    /// As [`Assets::read`]; where the file is no PNG or JPEG picture, is damaged, or passes the limits
    /// `texture_side`, `decode_bytes` or, with all textures before it, `total_decode_bytes`.
    pub fn texture(&mut self, path: &str) -> Result<Arc<Texture>, Diagnostic> {
        let key = key(path);
        if let Some(texture) = self.cache.textures.get(&key) {
            return Ok(Arc::clone(texture));
        }
        let bytes = self.read(path)?;
        let known = self
            .kept()
            .and_then(|kept| kept.texture(path, &bytes, self.limits));
        let texture = match known {
            Some(texture) => texture,
            None => {
                let texture = Arc::new(Texture::Image(texture::decode(path, &bytes, self.limits)?));
                if let Some(kept) = self.kept() {
                    kept.keep_texture(path, bytes, self.limits, &texture);
                }
                texture
            }
        };
        if let Texture::Image(image) = &*texture {
            self.cache.count(&format!("'{path}'"), image, self.limits)?;
        }
        self.cache.textures.insert(key, Arc::clone(&texture));
        Ok(texture)
    }

    /// The picture in bytes that another file holds, `name` being what messages call it. It counts as a file.
    ///
    /// # Errors
    /// As [`Assets::texture`].
    pub(super) fn texture_within(&mut self, name: &str, bytes: &[u8]) -> Result<Arc<Texture>, Diagnostic> {
        self.count_file(name)?;
        let known = self
            .kept()
            .and_then(|kept| kept.texture(name, bytes, self.limits));
        if let Some(texture) = known {
            return Ok(texture);
        }
        let texture = Arc::new(Texture::Image(texture::decode(name, bytes, self.limits)?));
        if let Some(kept) = self.kept() {
            kept.keep_texture(name, bytes.to_vec(), self.limits, &texture);
        }
        Ok(texture)
    }

    /// As [`Assets::texture_within`], how solid the texels are: the width of the picture, and three times a byte for each.
    ///
    /// # Errors
    /// As [`Assets::texture`].
    pub(super) fn alpha_within(
        &mut self,
        name: &str,
        bytes: &[u8],
    ) -> Result<(u32, Vec<[u8; 3]>), Diagnostic> {
        self.count_file(name)?;
        texture::alpha(name, bytes, self.limits)
    }

    /// The copies of a picture for what is far away.
    pub(super) fn pyramid(&mut self, texture: &Arc<Texture>, image: &ImageTexture) -> Arc<Pyramid> {
        self.cache.pyramid(texture, image)
    }

    /// Counts a file that is read.
    fn count_file(&mut self, path: &str) -> Result<(), Diagnostic> {
        if self.cache.files >= self.limits.files {
            let what = format!("'{path}' is one file too many");
            return Err(SceneError::limit(&what, "files", self.limits.files).into());
        }
        self.cache.files += 1;
        Ok(())
    }

    /// Width, height and, row by row from the top, how bright the stored numbers of the picture at `path` are, from 0 to 1:
    /// heights, say. 16 bits are kept. Not cached: a height field is made of a picture once.
    ///
    /// # Errors
    /// As [`Assets::texture`].
    ///
    /// ```
    /// use rtscript::{Image, Limits, MemoryHost, import::{AssetCache, Assets}, output, scene::Encoding};
    /// // A picture of two heights, stored as it is.
    /// let picture = Image::new(2, 1, Encoding::Raw, vec![[0.0; 3], [1.0; 3]]);
    /// let host = MemoryHost::new().with("hills.png", output::encode(&picture, output::Format::Png)?);
    /// let (limits, mut cache) = (Limits::default(), AssetCache::default());
    /// let mut assets = Assets::new(&host, &limits, &mut cache);
    /// assert_eq!(assets.levels("hills.png").map_err(rtscript::Error::from)?, (2, 1, vec![0.0, 1.0]));
    /// // A picture is no font.
    /// assert!(assets.font("hills.png").is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn levels(&mut self, path: &str) -> Result<(usize, usize, Vec<f64>), Diagnostic> {
        let bytes = self.read(path)?;
        texture::levels(path, &bytes, self.limits)
    }

    /// The font at `path`.
    ///
    /// # Errors
    /// As [`Assets::read`], and as [`Font::read`].
    pub fn font(&mut self, path: &str) -> Result<Font, Diagnostic> {
        let key = key(path);
        if let Some(font) = self.cache.fonts.get(&key) {
            return Ok(font.clone());
        }
        let bytes = self.read(path)?;
        let font = Font::read(&bytes).map_err(|error| {
            let error = error.of(format_args!("'{path}'"));
            Diagnostic {
                kind: ErrorKind::Input,
                ..Diagnostic::from(error)
            }
            .class(Code::MalformedFile)
        })?;
        self.cache.fonts.insert(key, font.clone());
        Ok(font)
    }

    /// What earlier runs kept.
    pub(super) fn kept(&self) -> Option<&KeptAssets> {
        self.cache.kept.as_ref()
    }

    /// The mesh read from `path` before under that ambient light.
    pub(super) fn known_mesh(&self, path: &str, ambient: Option<[f64; 3]>) -> Option<Arc<Mesh>> {
        self.cache
            .meshes
            .get(&(key(path), ambient.map(|color| color.map(f64::to_bits))))
            .cloned()
    }

    /// Keeps a mesh for [`Assets::known_mesh`].
    pub(super) fn keep_mesh(&mut self, path: &str, ambient: Option<[f64; 3]>, mesh: &Arc<Mesh>) {
        let key = (key(path), ambient.map(|color| color.map(f64::to_bits)));
        self.cache.meshes.insert(key, Arc::clone(mesh));
    }

    /// An error where the host wants the run to end.
    pub(super) fn check_stop(&self) -> Result<(), Diagnostic> {
        if self.host.should_stop() {
            return Err(Diagnostic::error(ErrorKind::Cancelled, "the host asked to stop"));
        }
        Ok(())
    }

    pub(super) fn limits(&self) -> &Limits {
        self.limits
    }
}

/// The same for different spellings of a path. `..` stays, since what it leads to is the host's business.
fn key(path: &str) -> String {
    let parts: Vec<&str> = path
        .split('/')
        .filter(|part| !matches!(*part, "" | "."))
        .collect();
    parts.join("/")
}
