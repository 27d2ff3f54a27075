//! HTML text that cannot carry markup from a drawing: markup is `'static`, everything else escaped.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// A page being written.
#[derive(Debug, Default)]
pub struct Html(String);

/// Attributes of an element; values are escaped.
pub type Attributes<'a> = &'a [(&'static str, &'a str)];

impl Html {
    /// Markup of ours.
    pub fn raw(&mut self, markup: &'static str) -> &mut Self {
        self.0.push_str(markup);
        self
    }

    /// Text of any origin.
    pub fn text(&mut self, text: &str) -> &mut Self {
        escape_into(text, &mut self.0);
        self
    }

    /// Words of a message: what stands between backticks is what somebody types.
    pub fn words(&mut self, text: &str) -> &mut Self {
        let is_paired = text.matches('`').count().is_multiple_of(2);
        for (i, part) in text.split(|c| c == '`' && is_paired).enumerate() {
            match i % 2 {
                0 => self.text(part),
                _ => self.raw("<code>").text(part).raw("</code>"),
            };
        }
        self
    }

    /// `<tag …>`.
    pub fn open(&mut self, tag: &'static str, attributes: Attributes<'_>) -> &mut Self {
        self.0.push('<');
        self.0.push_str(tag);
        for (name, value) in attributes {
            self.0.push(' ');
            self.0.push_str(name);
            self.0.push_str("=\"");
            escape_into(value, &mut self.0);
            self.0.push('"');
        }
        self.0.push('>');
        self
    }

    /// `</tag>`.
    pub fn close(&mut self, tag: &'static str) -> &mut Self {
        self.0.push_str("</");
        self.0.push_str(tag);
        self.0.push_str(">\n");
        self
    }

    /// `<tag …>text</tag>`.
    pub fn element(&mut self, tag: &'static str, attributes: Attributes<'_>, text: &str) -> &mut Self {
        self.open(tag, attributes).text(text).close(tag)
    }

    /// A picture inside the page.
    pub fn picture(&mut self, png: &[u8], class: &str, alt: &str) -> &mut Self {
        self.raw("<img class=\"").text(class).raw("\" alt=\"").text(alt);
        if let Some([width, height]) = png_size(png) {
            let [width, height] = [width, height].map(|v| v.to_string());
            self.raw("\" width=\"").text(&width).raw("\" height=\"").text(&height);
        }
        self.raw("\" src=\"data:image/png;base64,");
        STANDARD.encode_string(png, &mut self.0);
        self.raw("\">\n")
    }

    /// The page.
    pub fn into_string(self) -> String {
        self.0
    }
}

fn escape_into(text: &str, out: &mut String) {
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{7f}' => out.push('\u{fffd}'),
            other => out.push(other),
        }
    }
}

/// Width and height from a PNG's header.
pub fn png_size(png: &[u8]) -> Option<[u32; 2]> {
    let side = |at: usize| Some(u32::from_be_bytes(png.get(at..at + 4)?.try_into().ok()?));
    (png.get(12..16)? == b"IHDR").then_some([side(16)?, side(20)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_somebody_types_is_code() {
        let of = |text: &str| {
            let mut html = Html::default();
            html.words(text);
            html.into_string()
        };
        assert_eq!(of("`accept <a>` takes it"), "<code>accept &lt;a&gt;</code> takes it");
        assert_eq!(of("a file `named so"), "a file `named so");
    }

    #[test]
    fn nothing_from_a_drawing_becomes_markup() {
        let mut html = Html::default();
        html.element("td", &[("title", "\"><img src=x onerror='alert(1)'>")], "<script>&\u{1b}[31m</script>");
        assert_eq!(
            html.into_string(),
            "<td title=\"&quot;&gt;&lt;img src=x onerror=&#39;alert(1)&#39;&gt;\">\
             &lt;script&gt;&amp;\u{fffd}[31m&lt;/script&gt;</td>\n"
        );
    }

    #[test]
    fn the_size_of_a_picture_is_read_from_its_header() {
        let png = super::super::canvas::encode_png(3, 2, &[0; 18]).unwrap();
        assert_eq!(png_size(&png), Some([3, 2]));
        assert_eq!(png_size(b"GIF"), None);
    }
}
