//! What model space writes about lengths: dimensions with their texts, and how high letters are.

use glam::DVec2;

use super::blocks::Blocks;
use super::fields::Fields;
use super::reader::Reader;
use super::text::plain_mtext;
use crate::drawing::{Dimension, Written};
use enfilade_report::Error;

impl Reader<'_, '_> {
    /// Reads the straight dimensions and the heights of letters among the records of the ENTITIES section.
    ///
    /// # Errors
    /// Where a number cannot be read.
    pub fn written(&self, section: std::ops::Range<usize>, blocks: &Blocks) -> Result<Written, Error> {
        let mut out = Written::default();
        for record in section {
            let name = self.tokens.name(record);
            if !matches!(name, b"DIMENSION" | b"TEXT" | b"MTEXT") {
                continue;
            }
            let fields = Fields::of(self.tokens, record);
            if self.int(&fields, 67, 0)? != 0 {
                continue;
            }
            if name == b"DIMENSION" {
                out.dimensions.extend(self.dimension(&fields, blocks)?);
            } else {
                let height = self.float(&fields, 40, 0.0)?;
                out.heights.extend((height.is_finite() && height > 0.0).then_some(height));
            }
        }
        Ok(out)
    }

    /// A rotated or aligned dimension; of others nothing says which length is meant.
    fn dimension(&self, fields: &Fields<'_, '_>, blocks: &Blocks) -> Result<Option<Dimension>, Error> {
        let kind = self.int(fields, 70, 0)? & 7;
        if kind > 1 {
            return Ok(None);
        }
        let span = self.point(fields, 14)?.truncate() - self.point(fields, 13)?.truncate();
        let along = match kind {
            0 => span.dot(DVec2::from_angle(self.float(fields, 50, 0.0)?.to_radians())).abs(),
            _ => span.length(),
        };
        let stated = self.float(fields, 42, 0.0)?;
        let measured = if stated > 0.0 { stated } else { along };
        let said = |value: &[u8]| plain_mtext(&self.page.decode(value)).trim().to_owned();
        let own = fields.value(1).map(said).filter(|text| !text.is_empty() && !text.contains("<>"));
        let text = own.or_else(|| Some(said(self.shown_text(fields, blocks)?)));
        let is_length = measured.is_finite() && measured > 0.0;
        Ok(text.filter(|_| is_length).map(|text| Dimension { measured, text }))
    }

    /// The text in the block that shows a dimension.
    fn shown_text(&self, fields: &Fields<'_, '_>, blocks: &Blocks) -> Option<&[u8]> {
        let block = blocks.index(&self.page.decode(fields.value(2)?))?;
        let mut records = blocks.list[block].records.clone();
        let record = records.find(|r| matches!(self.tokens.name(*r), b"TEXT" | b"MTEXT"))?;
        Fields::of(self.tokens, record).value(1)
    }
}
