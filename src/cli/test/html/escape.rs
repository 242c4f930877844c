//! Text and bytes in a form that HTML holds.

/// Text for the inside of an element or of an attribute in quotes. What cannot be seen or would turn the direction
/// of writing around becomes a visible sign; line ends and tabs stay.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(c),
            // Unicode has a picture for each control character of ASCII, in their order.
            '\0'..='\x1f' => escaped.extend(char::from_u32(0x2400 + u32::from(c))),
            '\x7f' => escaped.push('\u{2421}'),
            '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
                escaped.push(char::REPLACEMENT_CHARACTER);
            }
            c if c.is_control() => escaped.push(char::REPLACEMENT_CHARACTER),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_leaves_its_place() {
        assert_eq!(
            escape("</script><a href=\"x\" b='y'>&amp;"),
            "&lt;/script&gt;&lt;a href=&quot;x&quot; b=&#39;y&#39;&gt;&amp;amp;"
        );
        assert_eq!(escape("a\tb\nc é 日本"), "a\tb\nc é 日本");
        assert_eq!(escape("\0\r\u{1b}[31m\x7f"), "␀␍␛[31m␡");
        assert_eq!(escape("\u{85}\u{202e}\u{2069}"), "\u{fffd}".repeat(3));
    }
}
