//! What the outlines of a table 'CFF ' cost (Adobe, "The Compact Font Format Specification", 2003, and "The Type 2 Charstring
//! Format", 2000): subroutines call subroutines, so that a few bytes may stand for any amount of work, which has to be known
//! before it is done. Nothing is drawn here. What is read otherwise than usual is refused.

/// A list of byte strings.
#[derive(Clone, Copy, Debug, Default)]
struct Index<'a> {
    count: usize,
    /// Bytes of an offset.
    size: usize,
    offsets: &'a [u8],
    data: &'a [u8],
}

impl<'a> Index<'a> {
    /// The one at the beginning of `bytes`, and what comes behind it.
    fn read(bytes: &'a [u8]) -> Option<(Self, &'a [u8])> {
        let (count, rest) = bytes.split_first_chunk()?;
        let count = usize::from(u16::from_be_bytes(*count));
        if count == 0 {
            return Some((Self::default(), rest));
        }
        let (size, rest) = rest.split_first()?;
        let size = usize::from(*size);
        if !(1..=4).contains(&size) {
            return None;
        }
        let (offsets, data) = rest.split_at_checked((count + 1) * size)?;
        let whole = Self {
            count,
            size,
            offsets,
            data,
        };
        let (data, rest) = data.split_at_checked(whole.offset(count)?)?;
        Some((Self { data, ..whole }, rest))
    }

    fn offset(&self, i: usize) -> Option<usize> {
        let bytes = self.offsets.get(i * self.size..(i + 1) * self.size)?;
        let offset = bytes.iter().fold(0, |sum, byte| sum << 8 | usize::from(*byte));
        offset.checked_sub(1)
    }

    fn get(&self, i: usize) -> Option<&'a [u8]> {
        if i >= self.count {
            return None;
        }
        self.data.get(self.offset(i)?..self.offset(i + 1)?)
    }

    /// What is added to the number of a subroutine.
    const fn bias(&self) -> i32 {
        match self.count {
            0..1240 => 107,
            1240..33900 => 1131,
            _ => 32768,
        }
    }
}

/// Operators of dictionaries.
const CHARSTRINGS: u16 = 17;
const PRIVATE: u16 = 18;
const SUBROUTINES: u16 = 19;
const REGISTRY: u16 = 1230;
const FONTS: u16 = 1236;
const SELECT: u16 = 1237;

/// Operands of an operator; those that are no whole numbers are `None`.
type Operands = Vec<Option<i32>>;

/// The operands of the `wanted` operator of a dictionary, if it is there. Where it is there twice, readers may differ.
fn operands(dictionary: &[u8], wanted: u16) -> Option<Option<Operands>> {
    let mut found = None;
    let mut numbers = Vec::new();
    let mut rest = dictionary;
    while let Some((byte, after)) = rest.split_first() {
        rest = after;
        let byte = *byte;
        match byte {
            0..=27 | 31 | 255 => {
                let mut operator = u16::from(byte);
                if byte == 12 {
                    let (second, after) = rest.split_first()?;
                    (operator, rest) = (1200 + u16::from(*second), after);
                }
                let given = std::mem::take(&mut numbers);
                if operator == wanted && found.replace(given).is_some() {
                    return None;
                }
            }
            30 => {
                let last = rest.iter().position(|b| b & 0x0f == 0x0f || b >> 4 == 0x0f)?;
                rest = rest.get(last + 1..)?;
                numbers.push(None);
            }
            29 => {
                let (number, after) = rest.split_first_chunk()?;
                rest = after;
                numbers.push(Some(i32::from_be_bytes(*number)));
            }
            _ => {
                let (number, after) = short_number(byte, rest)?;
                rest = after;
                numbers.push(Some(number));
            }
        }
    }
    Some(found)
}

/// A number of one to three bytes, of which the first is `byte`.
fn short_number(byte: u8, rest: &[u8]) -> Option<(i32, &[u8])> {
    let first = i32::from(byte);
    match byte {
        28 => {
            let (number, rest) = rest.split_first_chunk()?;
            Some((i32::from(i16::from_be_bytes(*number)), rest))
        }
        32..=246 => Some((first - 139, rest)),
        247..=250 => {
            let (second, rest) = rest.split_first()?;
            Some(((first - 247) * 256 + i32::from(*second) + 108, rest))
        }
        251..=254 => {
            let (second, rest) = rest.split_first()?;
            Some((-(first - 251) * 256 - i32::from(*second) - 108, rest))
        }
        _ => None,
    }
}

/// The one operand of an operator that leads to a place in the table; `Some(None)` where there is no such operator.
fn place(dictionary: &[u8], operator: u16) -> Option<Option<usize>> {
    match operands(dictionary, operator)?.as_deref() {
        None => Some(None),
        Some([Some(place)]) => Some(Some(usize::try_from(*place).ok()?)),
        Some(_) => None,
    }
}

/// The charstrings of a font and the subroutines that they may call.
#[derive(Clone, Debug)]
pub(super) struct Charstrings<'a> {
    glyphs: Index<'a>,
    global: Index<'a>,
    local: Local<'a>,
}

/// The subroutines of a part of the glyphs.
#[derive(Clone, Debug)]
enum Local<'a> {
    All(Index<'a>),
    /// Each glyph has a font, by a table as `FDSelect`.
    ByFont(Vec<Index<'a>>, &'a [u8]),
}

impl<'a> Charstrings<'a> {
    /// Those of a table.
    pub(super) fn read(table: &'a [u8]) -> Option<Self> {
        let header = usize::from(*table.get(2)?).max(4);
        let (_, rest) = Index::read(table.get(header..)?)?;
        let (tops, rest) = Index::read(rest)?;
        let (_, rest) = Index::read(rest)?;
        let (global, _) = Index::read(rest)?;
        let top = tops.get(0)?;
        let (glyphs, _) = Index::read(table.get(place(top, CHARSTRINGS)??..)?)?;
        let local = if operands(top, REGISTRY)?.is_some() {
            let (fonts, _) = Index::read(table.get(place(top, FONTS)??..)?)?;
            let all = (0..fonts.count).map(|i| subroutines(table, fonts.get(i)?));
            Local::ByFont(all.collect::<Option<_>>()?, table.get(place(top, SELECT)??..)?)
        } else {
            Local::All(subroutines(table, top)?)
        };
        Some(Self {
            glyphs,
            global,
            local,
        })
    }

    /// Steps that a glyph takes to be drawn, if they are fewer than `most` and understood.
    pub(super) fn cost(&self, glyph: u16, most: u64) -> Option<u64> {
        let glyph = usize::from(glyph);
        let local = match &self.local {
            Local::All(local) => *local,
            Local::ByFont(fonts, select) => *fonts.get(font_of(select, glyph)?)?,
        };
        let mut walk = Walk {
            global: self.global,
            local,
            left: most,
            stack: Vec::new(),
            stems: 0,
            has_ended: false,
        };
        walk.run(self.glyphs.get(glyph)?, 0)?;
        Some(most - walk.left)
    }
}

/// The subroutines that the private dictionary of a dictionary names.
fn subroutines<'a>(table: &'a [u8], dictionary: &[u8]) -> Option<Index<'a>> {
    let (length, start) = match operands(dictionary, PRIVATE)?.as_deref() {
        None => return Some(Index::default()),
        Some([Some(length), Some(start)]) => (usize::try_from(*length).ok()?, usize::try_from(*start).ok()?),
        Some(_) => return None,
    };
    let private = table.get(start..start.checked_add(length)?)?;
    match place(private, SUBROUTINES)? {
        None => Some(Index::default()),
        Some(offset) => Some(Index::read(table.get(start.checked_add(offset)?..)?)?.0),
    }
}

/// The font of a glyph.
fn font_of(select: &[u8], glyph: usize) -> Option<usize> {
    let (format, rest) = select.split_first()?;
    if *format == 0 {
        return Some(usize::from(*rest.get(glyph)?));
    }
    let (count, ranges) = rest.split_first_chunk()?;
    let count = usize::from(u16::from_be_bytes(*count));
    if *format != 3 {
        return None;
    }
    let first = |i: usize| {
        Some(usize::from(u16::from_be_bytes(
            *ranges.get(3 * i..)?.first_chunk()?,
        )))
    };
    for i in 0..count {
        if (first(i)?..first(i + 1)?).contains(&glyph) {
            return Some(usize::from(*ranges.get(3 * i + 2)?));
        }
    }
    None
}

/// Calls within one another, and numbers that wait for an operator.
const DEEPEST: u32 = 10;
const MOST_NUMBERS: usize = 48;

/// A charstring that is followed without drawing.
struct Walk<'a> {
    global: Index<'a>,
    local: Index<'a>,
    /// Steps.
    left: u64,
    stack: Vec<f32>,
    stems: usize,
    has_ended: bool,
}

impl Walk<'_> {
    fn run(&mut self, code: &[u8], depth: u32) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        let mut rest = code;
        while let Some((byte, after)) = rest.split_first() {
            rest = after;
            self.left = self.left.checked_sub(1)?;
            match *byte {
                1 | 3 | 18 | 23 => self.hints(),
                19 | 20 => {
                    self.hints();
                    rest = rest.get(self.stems.div_ceil(8)..)?;
                }
                4..=8 | 21 | 22 | 24..=27 | 30 | 31 => self.stack.clear(),
                10 | 29 => {
                    let list = if *byte == 10 { self.local } else { self.global };
                    let number = self.stack.pop()? as i32;
                    let i = usize::try_from(number.checked_add(list.bias())?).ok()?;
                    self.run(list.get(i)?, depth + 1)?;
                    if self.has_ended {
                        return Some(());
                    }
                }
                11 => return Some(()),
                12 => {
                    let (second, after) = rest.split_first()?;
                    rest = after;
                    // Arithmetic, of which fonts have long made no use, is not drawn either.
                    if !(34..=37).contains(second) {
                        return None;
                    }
                    self.stack.clear();
                }
                14 => {
                    // Four numbers would put an accent on a letter, each of them a glyph of its own.
                    self.has_ended = true;
                    return (self.stack.len() < 4).then_some(());
                }
                255 => {
                    let (number, after) = rest.split_first_chunk()?;
                    rest = after;
                    self.push(i32::from_be_bytes(*number) as f32 / 65536.0)?;
                }
                first => {
                    let (number, after) = short_number(first, rest)?;
                    rest = after;
                    self.push(number as f32)?;
                }
            }
        }
        Some(())
    }

    fn push(&mut self, number: f32) -> Option<()> {
        (self.stack.len() < MOST_NUMBERS).then(|| self.stack.push(number))
    }

    /// Two numbers are a stem.
    fn hints(&mut self) {
        self.stems += self.stack.len() / 2;
        self.stack.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A list of at most 255 bytes.
    fn index(items: &[&[u8]]) -> Vec<u8> {
        let mut bytes = (items.len() as u16).to_be_bytes().to_vec();
        if items.is_empty() {
            return bytes;
        }
        bytes.extend([1, 1]);
        let mut end = 1u8;
        for item in items {
            end += item.len() as u8;
            bytes.push(end);
        }
        bytes.extend(items.concat());
        bytes
    }

    /// A table with these charstrings and global subroutines.
    fn table(glyphs: &[&[u8]], global: &[&[u8]]) -> Vec<u8> {
        let made = |place: i16| {
            let [a, b] = place.to_be_bytes();
            let mut bytes = vec![1, 0, 4, 1];
            bytes.extend(index(&[b"A"]));
            bytes.extend(index(&[&[28, a, b, CHARSTRINGS as u8]]));
            bytes.extend(index(&[]));
            bytes.extend(index(global));
            bytes
        };
        let place = made(0).len() as i16;
        let mut bytes = made(place);
        bytes.extend(index(glyphs));
        bytes
    }

    /// The number -107, which calls subroutine 0, and those behind it.
    const fn call(i: u8) -> [u8; 2] {
        [32 + i, 29]
    }

    #[test]
    fn what_subroutines_multiply_is_counted() {
        // Two steps to call, one to return.
        let one = table(&[&[32, 29, 14]], &[&[11]]);
        assert_eq!(Charstrings::read(&one).unwrap().cost(0, 100), Some(4));
        let ten = |i: u8| call(i).repeat(10);
        let subroutines: Vec<Vec<u8>> = (1..10).map(ten).collect();
        let all: Vec<&[u8]> = subroutines.iter().map(Vec::as_slice).chain([&[11][..]]).collect();
        let bomb = table(&[&ten(0)], &all);
        let bomb = Charstrings::read(&bomb).unwrap();
        assert_eq!(bomb.cost(0, 1 << 20), None);
        // Calls of itself.
        let endless = table(&[&[32, 29, 14]], &[&[32, 29]]);
        assert_eq!(Charstrings::read(&endless).unwrap().cost(0, 1 << 20), None);
    }

    #[test]
    fn masks_are_as_long_as_the_stems_before_them() {
        // Nine stems, so two bytes that would end the glyph and call a subroutine that there is not.
        let stems = [139u8; 18];
        let glyph = [&stems[..], &[18, 19, 14, 10, 139, 22, 14]].concat();
        let masked = table(&[&glyph], &[]);
        assert_eq!(Charstrings::read(&masked).unwrap().cost(0, 100), Some(18 + 5));
    }

    #[test]
    fn what_is_read_otherwise_is_refused() {
        for glyph in [
            &[12, 10][..],
            &[139, 139, 139, 139, 14],
            &[10],
            &[139; 49],
            &[255, 0],
        ] {
            let font = table(&[glyph], &[]);
            assert_eq!(Charstrings::read(&font).unwrap().cost(0, 100), None, "{glyph:?}");
        }
        assert_eq!(operands(&[139, 17, 139, 17], CHARSTRINGS), None);
        assert_eq!(operands(&[30, 0x1f, 17], CHARSTRINGS), Some(Some(vec![None])));
        let whole = table(&[&[14]], &[]);
        for end in 0..whole.len() {
            let _ = Charstrings::read(&whole[..end]).map(|font| font.cost(0, 100));
        }
    }
}
