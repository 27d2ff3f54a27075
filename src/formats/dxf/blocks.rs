//! Blocks: found, weighed, and unfolded where INSERTs show them.

use std::collections::HashMap;
use std::ops::Range;

use glam::{DAffine2, DVec2};

use super::curves::mapped;
use super::entity::{Body, Insert, Item};
use super::fields::Fields;
use super::reader::Reader;
use crate::plan::drawing::{Editable, Entity, Shape, Text};
use crate::report::Error;

/// A block definition.
pub(super) struct Block {
    /// Name as written, decoded.
    name: String,
    /// Records of its entities.
    records: Range<usize>,
    /// Base point.
    base: DVec2,
    /// Path of the external file, for an xref.
    xref: Option<String>,
    /// Its items, once somebody needs them.
    items: Vec<Item>,
    /// What showing it once costs.
    weight: Weight,
}

/// What showing a block once costs, or why it cannot be shown.
#[derive(Clone, Debug, PartialEq)]
enum Weight {
    /// Not looked at yet.
    Unknown,
    /// Drawn pieces and nesting levels below.
    Known { pieces: u64, depth: usize },
    /// It includes itself, along this path.
    Cycle(String),
}

/// All blocks of a file.
pub(super) struct Blocks {
    list: Vec<Block>,
    by_name: HashMap<String, usize>,
    shown_pieces: u64,
}

/// Pieces of a shape, as the expansion budget counts them.
fn pieces(shape: &Shape) -> u64 {
    match shape {
        Shape::Polyline { vertices, .. } => vertices.len() as u64,
        _ => 1,
    }
}

impl Blocks {
    /// Finds the block definitions; nothing inside them is read yet.
    pub fn find(reader: &Reader<'_, '_>) -> Result<Self, Error> {
        let mut blocks = Self { list: Vec::new(), by_name: HashMap::new(), shown_pieces: 0 };
        let tokens = reader.tokens;
        let Some(section) = tokens.section(b"BLOCKS") else { return Ok(blocks) };
        for record in section.clone().filter(|&r| tokens.name(r) == b"BLOCK") {
            let fields = Fields::of(tokens, record);
            let Some(name) = fields.value(2) else { continue };
            let end = (record + 1..section.end).find(|&r| matches!(tokens.name(r), b"ENDBLK" | b"BLOCK"));
            let is_xref = reader.int(&fields, 70, 0)? & 4 != 0;
            let name = reader.page.decode(name);
            let path = fields.value(1).filter(|path| is_xref && !path.is_empty());
            blocks.by_name.entry(name.to_uppercase()).or_insert(blocks.list.len());
            blocks.list.push(Block {
                name,
                records: record + 1..end.unwrap_or(section.end),
                base: reader.point(&fields, 10)?.truncate(),
                xref: path.map(|path| reader.page.decode(path)),
                items: Vec::new(),
                weight: Weight::Unknown,
            });
        }
        Ok(blocks)
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.by_name.get(&name.to_uppercase()).copied()
    }

    /// Reads and weighs a block and all it shows, without recursion: chains may be thousands deep.
    fn weigh(&mut self, reader: &mut Reader<'_, '_>, root: usize) -> Result<(), Error> {
        let mut path: Vec<(usize, usize)> = Vec::new();
        if self.list[root].weight == Weight::Unknown {
            self.load(reader, root)?;
            path.push((root, 0));
        }
        while let Some(&mut (block, ref mut next)) = path.last_mut() {
            let item = *next;
            *next += 1;
            if item == self.list[block].items.len() {
                self.list[block].weight = self.sum(block);
                path.pop();
                continue;
            }
            let Body::Insert(insert) = &self.list[block].items[item].body else { continue };
            let Some(child) = self.index(&insert.block) else { continue };
            if self.list[child].weight != Weight::Unknown {
                continue;
            }
            if let Some(at) = path.iter().position(|&(b, _)| b == child) {
                let words = self.cycle_words(path[at..].iter().map(|&(b, _)| b).chain([child]));
                for &(b, _) in &path {
                    self.list[b].weight = Weight::Cycle(words.clone());
                }
                path.clear();
            } else {
                self.load(reader, child)?;
                path.push((child, 0));
            }
        }
        Ok(())
    }

    fn load(&mut self, reader: &mut Reader<'_, '_>, block: usize) -> Result<(), Error> {
        self.list[block].items = reader.items(self.list[block].records.clone())?;
        Ok(())
    }

    /// `A > B > A`, the middle of a long path left out.
    fn cycle_words(&self, blocks: impl Iterator<Item = usize>) -> String {
        let names: Vec<&str> = blocks.map(|b| self.list[b].name.as_str()).collect();
        match names.as_slice() {
            [head @ .., a, b] if head.len() > 6 => format!("{} > … > {a} > {b}", head[..4].join(" > ")),
            _ => names.join(" > "),
        }
    }

    fn sum(&self, block: usize) -> Weight {
        let (mut total, mut deepest) = (0u64, 0);
        for item in &self.list[block].items {
            match &item.body {
                Body::Shape(shape, _) | Body::Fill(shape) => total = total.saturating_add(pieces(shape)),
                Body::Text(..) => total = total.saturating_add(1),
                Body::Insert(insert) => match self.index(&insert.block).map(|b| &self.list[b].weight) {
                    Some(Weight::Known { pieces, depth }) => {
                        total = total.saturating_add(copies(insert).saturating_mul(*pieces));
                        deepest = deepest.max(depth + 1);
                    }
                    Some(Weight::Cycle(path)) => return Weight::Cycle(path.clone()),
                    Some(Weight::Unknown) | None => {}
                },
            }
        }
        Weight::Known { pieces: total, depth: deepest }
    }

    /// Adds what an INSERT of model space shows.
    pub fn show(
        &mut self,
        reader: &mut Reader<'_, '_>,
        item: &Item,
        out: (&mut Vec<Entity>, &mut Vec<Text>),
    ) -> Result<(), Error> {
        let Body::Insert(insert) = &item.body else { return Ok(()) };
        let Some(block) = self.index(&insert.block) else {
            missing(reader, item.record, &insert.block);
            return Ok(());
        };
        if let Some(path) = &self.list[block].xref {
            let text = format!(
                "block {} is the external file {path}; never opened, left out of the plan",
                insert.block
            );
            reader.warn("dxf-external-reference", item.record, text);
            return Ok(());
        }
        self.weigh(reader, block)?;
        if !self.is_within_budget(reader, item.record, insert, block) {
            return Ok(());
        }
        let editable = if copies(insert) > 1 {
            Editable::No("it is shown by an INSERT with rows and columns".into())
        } else if !insert.has_values[0] {
            Editable::No("its INSERT or an attribute of it has no place to write to".into())
        } else {
            Editable::WithInsert { turnable: insert.has_values[1] }
        };
        let mut showing = Showing { top: item, editable, entities: out.0, texts: out.1, path: Vec::new() };
        self.unfold(reader, insert, block, &DAffine2::IDENTITY, item.layer, &mut showing);
        Ok(())
    }

    fn is_within_budget(
        &mut self,
        reader: &mut Reader<'_, '_>,
        record: usize,
        insert: &Insert,
        block: usize,
    ) -> bool {
        let limits = reader.limits;
        let (code, text) = match &self.list[block].weight {
            Weight::Cycle(path) => {
                ("dxf-block-cycle", format!("a block includes itself: {path}; the INSERT is left out"))
            }
            Weight::Known { depth, .. } if *depth >= limits.max_block_depth => (
                "dxf-block-depth",
                format!(
                    "block {} nests {} levels deep, expected at most {}; the INSERT is left out",
                    insert.block,
                    depth + 1,
                    limits.max_block_depth
                ),
            ),
            Weight::Known { pieces, .. } => {
                let shown = copies(insert).saturating_mul(*pieces);
                if self.shown_pieces.saturating_add(shown) <= limits.max_expanded_segments {
                    self.shown_pieces += shown;
                    return true;
                }
                let [columns, rows] = insert.count;
                (
                    "dxf-expansion-budget",
                    format!(
                        "block {} shown {columns} x {rows} times would draw {shown} pieces, expected at most {} in \
                         all; the INSERT is left out of the plan, kept in the file",
                        insert.block, limits.max_expanded_segments
                    ),
                )
            }
            Weight::Unknown => return false,
        };
        reader.warn(code, record, text);
        false
    }

    fn unfold(
        &self,
        reader: &mut Reader<'_, '_>,
        insert: &Insert,
        block: usize,
        outer: &DAffine2,
        layer: u32,
        showing: &mut Showing<'_>,
    ) {
        if self.list[block].xref.is_some()
            || matches!(self.list[block].weight, Weight::Known { pieces: 0, .. })
        {
            return;
        }
        showing.path.push(self.list[block].name.clone());
        for row in 0..insert.count[1] {
            for column in 0..insert.count[0] {
                let map = *outer * placement(insert, self.list[block].base, [column, row]);
                for item in &self.list[block].items {
                    let is_by_block = reader.layers.name(item.layer) == "0";
                    let layer = if is_by_block { layer } else { item.layer };
                    match &item.body {
                        Body::Insert(inner) => match self.index(&inner.block) {
                            Some(child) => self.unfold(reader, inner, child, &map, layer, showing),
                            None => missing(reader, item.record, &inner.block),
                        },
                        body => showing.add(reader, body, &map, layer),
                    }
                }
            }
        }
        showing.path.pop();
    }
}

fn missing(reader: &mut Reader<'_, '_>, record: usize, block: &str) {
    let text = format!("block {block}, found no such block; the INSERT shows nothing, kept in the file");
    reader.warn("dxf-missing-block", record, text);
}

/// How often an INSERT shows its block.
fn copies(insert: &Insert) -> u64 {
    insert.count[0].saturating_mul(insert.count[1])
}

/// Block coordinates to those of the INSERT's owner, for one cell of its array.
fn placement(insert: &Insert, base: DVec2, cell: [u64; 2]) -> DAffine2 {
    let mirror = if insert.is_mirrored { DVec2::new(-1.0, 1.0) } else { DVec2::ONE };
    let shift = insert.spacing * DVec2::new(cell[0] as f64, cell[1] as f64);
    DAffine2::from_scale(mirror)
        * DAffine2::from_translation(insert.at)
        * DAffine2::from_angle(insert.rotation_rad)
        * DAffine2::from_translation(shift)
        * DAffine2::from_scale(insert.scale)
        * DAffine2::from_translation(-base)
}

/// The INSERT of model space that is being unfolded, and where its shapes go.
struct Showing<'o> {
    top: &'o Item,
    editable: Editable,
    entities: &'o mut Vec<Entity>,
    texts: &'o mut Vec<Text>,
    path: Vec<String>,
}

impl Showing<'_> {
    fn add(&mut self, reader: &mut Reader<'_, '_>, body: &Body, map: &DAffine2, layer: u32) {
        let source = reader.source(self.top.record, self.top.layer);
        let layer = reader.layers.name(layer).to_owned();
        match body {
            Body::Shape(shape, _) => {
                let shape = mapped(shape, map, reader.five_mm);
                if reader.insane_point(&shape).is_some() {
                    let text =
                        "what it shows has coordinates that are no finite numbers within the limit; left out";
                    reader.warn("dxf-bad-coordinate", self.top.record, text);
                    return;
                }
                let (editable, blocks) = (self.editable.clone(), self.path.clone());
                self.entities.push(Entity { source, layer, shape, editable, blocks });
            }
            Body::Fill(shape) => {
                let shape = mapped(shape, map, reader.five_mm);
                if reader.insane_point(&shape).is_none() {
                    reader.add_fill(source, layer, shape, self.path.clone());
                }
            }
            Body::Text(at, text) => {
                let at = map.transform_point2(*at);
                self.texts.push(Text { source, layer, at, text: text.clone() });
            }
            Body::Insert(_) => {}
        }
    }
}
