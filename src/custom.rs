//! What a program adds of its own to a scene: a shape, a texture, a reflectance, each behind a trait.

use std::{fmt, ops::Deref, sync::Arc};

/// Something of the program's own, shared by all that refer to it.
///
/// A scene is data: it is hashed, compared and written out. What stands for this in all of that is its `Debug` text, so
/// two with the same text count as the same. A derived `Debug` has every field in it, and numbers so that they read back
/// as the same bits; that is what is wanted.
///
/// ```
/// use rtscript::{DVec3, math::DVec2, scene::{CustomTexture, Texture}, shape::Custom};
/// #[derive(Debug)]
/// struct Plain(f64);
/// impl CustomTexture for Plain {
///     fn color(&self, _: DVec2, _: DVec3) -> DVec3 {
///         DVec3::splat(self.0)
///     }
/// }
/// let Texture::Custom(texture) = Texture::custom(Plain(0.5)) else { panic!("a custom one") };
/// let texture: Custom<dyn CustomTexture> = texture;
/// assert_eq!(texture.identity(), "Plain(0.5)");
/// ```
pub struct Custom<T: ?Sized>(Arc<T>);

impl<T: ?Sized + fmt::Debug> Custom<T> {
    /// The `Debug` text.
    #[must_use]
    pub fn identity(&self) -> String {
        format!("{:?}", &*self.0)
    }
}

impl<T: ?Sized> Clone for Custom<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T: ?Sized> From<Arc<T>> for Custom<T> {
    fn from(shared: Arc<T>) -> Self {
        Self(shared)
    }
}

impl<T: ?Sized> Deref for Custom<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T: ?Sized + fmt::Debug> fmt::Debug for Custom<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl<T: ?Sized + fmt::Debug> PartialEq for Custom<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.identity() == other.identity()
    }
}
