//! Lists of numbers in a file's buffers, looked up one by one, so that nothing is made of what no triangle uses.

use super::{
    super::{assets::Assets, text::counted},
    bytes::Buffers,
    item::{Item, Kind},
};
use crate::{diag::Diagnostic, scene::SceneError};

pub(super) const ACCESSOR: Kind = Kind {
    one: "accessor",
    list: "accessors",
};
const VIEW: Kind = Kind {
    one: "buffer view",
    list: "bufferViews",
};

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(item: &Item<'_, '_>) -> Result<Self, Diagnostic> {
        Ok(match item.whole()? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            n => return Err(item.error(format!("expected 5120 to 5123, 5125 or 5126, found {n}"))),
        })
    }

    const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Whether it is a number of something.
    const fn is_index(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    /// The number in the bytes from `at` on.
    fn number(self, bytes: &[u8], at: usize) -> Option<f64> {
        let bytes = bytes.get(at..)?;
        Some(match self {
            Self::I8 => f64::from(i8::from_le_bytes(*bytes.first_chunk()?)),
            Self::U8 => f64::from(*bytes.first()?),
            Self::I16 => f64::from(i16::from_le_bytes(*bytes.first_chunk()?)),
            Self::U16 => f64::from(u16::from_le_bytes(*bytes.first_chunk()?)),
            Self::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            Self::F32 => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
        })
    }

    /// What a normalized number stands for: 0 to 1, or -1 to 1.
    fn normalized(self, x: f64) -> f64 {
        match self {
            Self::I8 => (x / 127.0).max(-1.0),
            Self::U8 => x / 255.0,
            Self::I16 => (x / 32767.0).max(-1.0),
            Self::U16 => x / 65535.0,
            Self::U32 | Self::F32 => x,
        }
    }
}

/// Elements of a few numbers each.
#[derive(Clone, Debug)]
struct Elements<'b> {
    bytes: &'b [u8],
    stride: usize,
    component: Component,
}

impl Elements<'_> {
    /// Number `part` of element `i`.
    fn number(&self, i: usize, part: usize) -> Option<f64> {
        let at = i
            .checked_mul(self.stride)?
            .checked_add(part * self.component.size())?;
        self.component.number(self.bytes, at)
    }
}

/// Elements that count in place of others.
#[derive(Clone, Debug)]
struct Sparse<'b> {
    count: usize,
    /// Which, in ascending order.
    indices: Elements<'b>,
    values: Elements<'b>,
}

/// A list of elements.
#[derive(Clone, Debug)]
pub(super) struct Accessor<'b> {
    pub(super) count: usize,
    component: Component,
    normalized: bool,
    /// `None` where all are zeros, but for sparse ones.
    elements: Option<Elements<'b>>,
    sparse: Option<Sparse<'b>>,
}

/// Whose numbers an accessor's are.
pub(super) struct Shape {
    /// What `type` has to say: `VEC3`.
    pub(super) kinds: &'static [(&'static str, usize)],
    /// Whether they are numbers of vertices.
    pub(super) is_index: bool,
}

/// Reads the accessor that `number` names.
///
/// # Errors
/// Where there is no such accessor, it is of another type, or does not lie within its buffer.
pub(super) fn accessor<'b, 'a>(
    number: &Item<'_, 'a>,
    root: &Item<'_, 'a>,
    shape: &Shape,
    buffers: &'b Buffers<'a>,
    assets: &mut Assets<'_>,
) -> Result<Accessor<'b>, Diagnostic> {
    let i = number.index(ACCESSOR, root.count(ACCESSOR.list)?)?;
    let all = root.needed(ACCESSOR.list)?;
    let Some(item) = all.entry(i)? else {
        return Err(number.error("there is no such accessor"));
    };
    let kind = item.needed("type")?;
    let parts = shape.kinds.iter().find(|(name, _)| kind.string() == Ok(name));
    let Some((_, parts)) = parts.copied() else {
        let wanted: Vec<&str> = shape.kinds.iter().map(|(name, _)| *name).collect();
        return Err(kind.error(format!(
            "expected {} for {number}, found '{}'",
            wanted.join(" or "),
            kind.string()?
        )));
    };
    let component = item.needed("componentType")?;
    let stored = Component::of(&component)?;
    if shape.is_index && !stored.is_index() {
        return Err(component.error(format!(
            "expected 5121, 5123 or 5125 for {number}, which are numbers of vertices"
        )));
    }
    let normalized = item.get("normalized")?.map_or(Ok(false), |item| item.boolean())?;
    let count = item.needed("count")?;
    let n = count.whole()?;
    let elements = match item.get("bufferView")? {
        None => None,
        Some(view) => Some(elements(&view, &item, root, (n, parts, stored), buffers, assets)?),
    };
    // Elements that stand nowhere cost a file nothing.
    let most = assets.limits().primitives.saturating_mul(3);
    if elements.is_none() && n > most {
        let error = SceneError::limit("too many elements", "primitives", assets.limits().primitives);
        return Err(count.place(error.into()));
    }
    let sparse = match item.get("sparse")? {
        None => None,
        Some(item) => Some(sparse(&item, root, (n, parts, stored), buffers, assets)?),
    };
    Ok(Accessor {
        count: n,
        component: stored,
        normalized,
        elements,
        sparse,
    })
}

/// The elements that lie in the buffer view with the number `view`, from the `byteOffset` of `item` on.
fn elements<'b, 'a>(
    view: &Item<'_, 'a>,
    item: &Item<'_, 'a>,
    root: &Item<'_, 'a>,
    (count, parts, component): (usize, usize, Component),
    buffers: &'b Buffers<'a>,
    assets: &mut Assets<'_>,
) -> Result<Elements<'b>, Diagnostic> {
    let (bytes, stride) = buffer_view(view, root, buffers, assets)?;
    let size = parts * component.size();
    let stride = stride.unwrap_or(size);
    let offset = item.whole_or("byteOffset", 0)?;
    let behind = match count.checked_sub(1) {
        Some(last) => last.checked_mul(stride).and_then(|n| n.checked_add(size)),
        None => Some(0),
    };
    let behind = behind.and_then(|n| n.checked_add(offset));
    match bytes
        .get(offset..)
        .filter(|_| behind.is_some_and(|n| n <= bytes.len()))
    {
        Some(bytes) => Ok(Elements {
            bytes,
            stride,
            component,
        }),
        None => Err(item.error(format!(
            "{} of {}, {stride} apart, from byte {offset} on do not fit into the {} of the buffer view",
            counted(count, "element", "elements"),
            counted(size, "byte", "bytes"),
            counted(bytes.len(), "byte", "bytes")
        ))),
    }
}

/// The bytes of the buffer view with the number `view`.
pub(super) fn buffer_view<'b, 'a>(
    view: &Item<'_, 'a>,
    root: &Item<'_, 'a>,
    buffers: &'b Buffers<'a>,
    assets: &mut Assets<'_>,
) -> Result<(&'b [u8], Option<usize>), Diagnostic> {
    let i = view.index(VIEW, root.count(VIEW.list)?)?;
    let all = root.needed(VIEW.list)?;
    match all.entry(i)? {
        Some(item) => buffers.view(root, &item, assets),
        None => Err(view.error("there is no such buffer view")),
    }
}

fn sparse<'b, 'a>(
    item: &Item<'_, 'a>,
    root: &Item<'_, 'a>,
    (total, parts, component): (usize, usize, Component),
    buffers: &'b Buffers<'a>,
    assets: &mut Assets<'_>,
) -> Result<Sparse<'b>, Diagnostic> {
    let count = item.needed("count")?.whole()?;
    let of_indices = item.needed("indices")?;
    let kind = of_indices.needed("componentType")?;
    let index = Component::of(&kind)?;
    if !index.is_index() {
        return Err(kind.error("expected 5121, 5123 or 5125"));
    }
    let view = of_indices.needed("bufferView")?;
    let indices = elements(&view, &of_indices, root, (count, 1, index), buffers, assets)?;
    let of_values = item.needed("values")?;
    let view = of_values.needed("bufferView")?;
    let values = elements(
        &view,
        &of_values,
        root,
        (count, parts, component),
        buffers,
        assets,
    )?;
    let mut before = -1.0;
    for k in 0..count {
        let i = indices.number(k, 0).unwrap_or(f64::NAN);
        if !(i > before && i < total as f64) {
            return Err(of_indices.error(format!(
                "expected numbers of elements below {total} in ascending order, found {i} after {before}"
            )));
        }
        before = i;
    }
    Ok(Sparse {
        count,
        indices,
        values,
    })
}

impl Accessor<'_> {
    /// Number `part` of element `i`.
    pub(super) fn number(&self, i: usize, part: usize) -> f64 {
        let replaced = self.sparse.as_ref().and_then(|sparse| {
            let k = sparse.place(i)?;
            sparse.values.number(k, part)
        });
        let stored = || {
            self.elements
                .as_ref()
                .and_then(|elements| elements.number(i, part))
        };
        let x = replaced.or_else(stored).unwrap_or(0.0);
        if self.normalized {
            self.component.normalized(x)
        } else {
            x
        }
    }

    /// Element `i` of `N` numbers.
    pub(super) fn element<const N: usize>(&self, i: usize) -> [f64; N] {
        std::array::from_fn(|part| self.number(i, part))
    }
}

impl Sparse<'_> {
    /// Which of the elements is number `i`.
    fn place(&self, i: usize) -> Option<usize> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.indices.number(middle, 0)? < i as f64 {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        (low < self.count && self.indices.number(low, 0)? == i as f64).then_some(low)
    }
}
