//! Blocks: found, weighed, and unfolded where INSERTs show them.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use glam::{DAffine2, DVec2};

use super::clip::{Clip, clips};
use super::curves::similarity;
use super::entity::{Body, Insert, Item};
use super::fields::Fields;
use super::reader::Reader;
use super::sheet::{How, Sheet, encloses, is_regular, pieces};
use super::showing::{Bound, Showing};
use crate::curve::control_points;
use crate::drawing::{Editable, Entity, Shape, Text};
use crate::roles::{Role, role_by_name};
use enfilade_report::{Error, Severity};

/// Flags (70) of a block that is nobody's own to change: anonymous, or of an external file.
const FOREIGN_FLAGS: i64 = 1 | 4 | 8 | 16;

/// A block definition.
pub(super) struct Block {
    /// Name as written, decoded.
    pub name: String,
    /// Records of its entities; that of its own stands before them.
    pub records: Range<usize>,
    /// Base point.
    pub base: DVec2,
    /// Path of the external file, for an xref.
    xref: Option<String>,
    /// Whether it is a block of the user's own: none of an external file, and none that programs make and name.
    pub is_plain: bool,
    /// INSERTs of the whole file that name it, whether they are drawn or not.
    pub inserts: usize,
    /// The last of them.
    pub insert: usize,
    /// Its items, once somebody needs them.
    items: Vec<Item>,
    /// What showing it once costs.
    weight: Weight,
    /// Box round what it draws, its own coordinates; known with the weight.
    extent: Option<[DVec2; 2]>,
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
    pub list: Vec<Block>,
    by_name: HashMap<String, usize>,
    /// Of clipped INSERTs by their records the clip, in coordinates of their blocks, or why it cannot be read.
    clips: HashMap<usize, Result<Clip, &'static str>>,
    /// Blocks by the records of the INSERTs that name them.
    named: HashMap<usize, usize>,
    shown_pieces: u64,
    /// What model space shows in all.
    sheet: Sheet,
    /// Blocks of which it was said that several INSERTs show them.
    told: Vec<usize>,
    /// INSERTs within blocks of which it was said that they show a file that is left out.
    lacking: HashSet<usize>,
}

impl Blocks {
    /// Finds the block definitions; nothing inside them is read yet.
    pub fn find(reader: &Reader<'_, '_>) -> Result<Self, Error> {
        let mut blocks = Self {
            list: Vec::new(),
            by_name: HashMap::new(),
            clips: HashMap::new(),
            named: HashMap::new(),
            shown_pieces: 0,
            sheet: Sheet::default(),
            told: Vec::new(),
            lacking: HashSet::new(),
        };
        let tokens = reader.tokens;
        let Some(section) = tokens.section(b"BLOCKS") else { return Ok(blocks) };
        for record in section.clone().filter(|&r| tokens.name(r) == b"BLOCK") {
            let fields = Fields::of(tokens, record);
            let Some(name) = fields.value(2) else { continue };
            let end = (record + 1..section.end).find(|&r| matches!(tokens.name(r), b"ENDBLK" | b"BLOCK"));
            let flags = reader.int(&fields, 70, 0)?;
            let is_xref = flags & 4 != 0;
            let name = reader.page.decode(name);
            let path = fields.value(1).filter(|path| is_xref && !path.is_empty());
            let first = *blocks.by_name.entry(name.to_uppercase()).or_insert(blocks.list.len());
            let is_plain = flags & FOREIGN_FLAGS == 0 && !name.starts_with('*') && first == blocks.list.len();
            if let Some(block) = blocks.list.get_mut(first) {
                block.is_plain = false;
            }
            blocks.list.push(Block {
                name,
                records: record + 1..end.unwrap_or(section.end),
                base: reader.point(&fields, 10)?.truncate(),
                xref: path.map(|path| reader.page.decode(path)),
                is_plain,
                inserts: 0,
                insert: 0,
                items: Vec::new(),
                weight: Weight::Unknown,
                extent: None,
            });
        }
        blocks.count_inserts(reader, section);
        Ok(blocks)
    }

    /// Counts who names each block, drawn or not, on paper too.
    fn count_inserts(&mut self, reader: &Reader<'_, '_>, section: Range<usize>) {
        let tokens = reader.tokens;
        let all = tokens.section(b"ENTITIES").into_iter().flatten().chain(section);
        let inserts: Vec<usize> = all.filter(|&r| tokens.name(r) == b"INSERT").collect();
        self.clips = clips(tokens, inserts.iter().copied());
        for record in inserts {
            let name = Fields::of(tokens, record).value(2).map(|name| reader.page.decode(name));
            if let Some(block) = name.and_then(|name| self.index(&name)) {
                self.list[block].inserts += 1;
                self.list[block].insert = record;
                self.named.insert(record, block);
            }
        }
    }

    /// Index of the block of a name.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.by_name.get(&name.to_uppercase()).copied()
    }

    /// The block that the INSERT of a record names.
    pub fn of_insert(&self, record: usize) -> Option<&Block> {
        Some(&self.list[*self.named.get(&record)?])
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
                self.list[block].extent = self.box_of(block);
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
        // A file that is left out is something to report, wherever it is shown.
        if self.list[block].xref.is_some() {
            return Weight::Known { pieces: 1, depth: 0 };
        }
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
            external(reader, item.record, &insert.block, path);
            return Ok(());
        }
        self.weigh(reader, block)?;
        if !self.is_within_budget(reader, item.record, insert, block) {
            return Ok(());
        }
        let how = self.how(reader, item, insert, block, &DAffine2::IDENTITY);
        let mut showing = Showing::new(out.0, out.1);
        let record = item.record;
        let shown = Shown { insert, record, block, outer: DAffine2::IDENTITY, layer: item.layer, how };
        self.unfold(reader, &shown, &mut showing);
        showing.hold_cut();
        Ok(())
    }

    /// Looks at what model space shows in all; before anything of it is shown.
    ///
    /// # Errors
    /// Where a value of a block cannot be read.
    pub fn measure(&mut self, reader: &mut Reader<'_, '_>, items: &[Item]) -> Result<(), Error> {
        self.report_clips(reader);
        let mut sheet = Sheet::default();
        for item in items {
            match &item.body {
                Body::Shape(shape, _) => sheet.add_drawn(reader.layers.name(item.layer), shape),
                Body::Insert(insert) => {
                    let Some(block) = self.index(&insert.block) else { continue };
                    if self.list[block].xref.is_some() {
                        continue;
                    }
                    self.weigh(reader, block)?;
                    let Weight::Known { pieces, .. } = self.list[block].weight else { continue };
                    sheet.pieces = sheet.pieces.saturating_add(copies(insert).saturating_mul(pieces));
                    let corners = self.ring_of((item.record, insert), block, &DAffine2::IDENTITY);
                    corners.for_each(|p| sheet.add_corner(p));
                }
                _ => {}
            }
        }
        self.sheet = sheet;
        Ok(())
    }

    /// Box round what model space shows, once it is measured.
    pub fn extent(&self) -> Option<[DVec2; 2]> {
        self.sheet.extent
    }

    /// Box round what a block draws, once those within it have theirs; of arrays the first copy alone.
    fn box_of(&self, block: usize) -> Option<[DVec2; 2]> {
        let corners = self.list[block].items.iter().flat_map(|item| -> Vec<DVec2> {
            match &item.body {
                Body::Shape(shape, _) => control_points(shape),
                Body::Insert(insert) => self.index(&insert.block).map_or_else(Vec::new, |child| {
                    self.ring_of((item.record, insert), child, &DAffine2::IDENTITY).collect()
                }),
                _ => Vec::new(),
            }
        });
        crate::plane::box_of(corners)
    }

    /// Says whose boundaries cannot be read.
    fn report_clips(&self, reader: &mut Reader<'_, '_>) {
        let faults = self.clips.iter().filter_map(|(record, clip)| Some((*record, clip.as_ref().err()?)));
        let mut faults: Vec<(usize, &&str)> = faults.collect();
        faults.sort_unstable();
        for (record, why) in faults {
            let text = format!(
                "its clip (XCLIP), found a boundary that cannot be read: {why}; all of the block is shown"
            );
            reader.warn("dxf-clip", record, text);
        }
    }

    /// The clip of an INSERT, in coordinates of its block.
    fn clip(&self, insert: usize) -> Option<&Clip> {
        self.clips.get(&insert)?.as_ref().ok()
    }

    /// The corners of the box round what an INSERT of a record shows; the INSERT stands in a place by `outer`.
    fn ring_of(
        &self,
        (record, insert): (usize, &Insert),
        block: usize,
        outer: &DAffine2,
    ) -> impl Iterator<Item = DVec2> + use<> {
        let map = *outer * placement(insert, self.list[block].base, [0, 0]);
        let extent = self.list[block].extent;
        let extent = extent.and_then(|all| self.clip(record).map_or(Some(all), |clip| clip.limited(all)));
        let ring = extent.map(|[lo, hi]| {
            [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)].map(|p| map.transform_point2(p))
        });
        ring.into_iter().flatten()
    }

    /// Whether all corners of what a block shows by a map are so.
    fn all_corners(&self, block: usize, map: &DAffine2, is_so: &impl Fn(DVec2) -> bool) -> bool {
        self.list[block].items.iter().all(|item| match &item.body {
            Body::Shape(shape, _) => {
                control_points(shape).into_iter().all(|p| is_so(map.transform_point2(p)))
            }
            Body::Insert(insert) => match self.index(&insert.block) {
                Some(child) if matches!(self.list[child].weight, Weight::Known { pieces: 1.., .. }) => {
                    let map = *map * placement(insert, self.list[child].base, [0, 0]);
                    self.all_corners(child, &map, is_so)
                }
                _ => true,
            },
            _ => true,
        })
    }

    /// Whether a block draws straight walls and nothing else, by the names of layers; on layer 0 by that of its INSERT.
    fn draws_a_wall(&self, reader: &Reader<'_, '_>, block: usize, of_insert: u32) -> bool {
        let name = |layer: u32| reader.layers.list[layer as usize].name.as_str();
        let is_wall = |item: &Item| {
            let layer = if name(item.layer) == "0" { name(of_insert) } else { name(item.layer) };
            let is_straight = match &item.body {
                Body::Shape(Shape::Polyline { vertices, .. }, _) => vertices.iter().all(|v| v.bulge == 0.0),
                Body::Shape(shape, _) => matches!(shape, Shape::Line { .. }),
                _ => false,
            };
            is_straight && role_by_name(layer).0 == Role::Wall
        };
        let items = &self.list[block].items;
        !items.is_empty() && items.iter().all(is_wall)
    }

    /// How what an INSERT shows is written back; the INSERT stands in a place that is shown once, by `outer`.
    fn how<'i>(
        &mut self,
        reader: &mut Reader<'_, '_>,
        item: &'i Item,
        insert: &Insert,
        block: usize,
        outer: &DAffine2,
    ) -> How<'i> {
        let editable = if copies(insert) > 1 {
            Editable::No("it is shown by an INSERT with rows and columns".into())
        } else if !insert.has_values[0] {
            Editable::No("its INSERT or an attribute of it has no place to write to".into())
        } else {
            Editable::WithInsert { turnable: insert.has_values[1] && similarity(outer).is_some() }
        };
        let with = How::With { insert: item, editable };
        let own = &self.list[block];
        let Weight::Known { pieces, .. } = own.weight else { return with };
        let map = *outer * placement(insert, own.base, [0, 0]);
        let ring: Vec<DVec2> = self.ring_of((item.record, insert), block, outer).collect();
        // What a frozen layer hides is known by its INSERT.
        let is_frozen = reader.layers.list[item.layer as usize].is_frozen;
        let is_clipped = self.clips.contains_key(&item.record);
        let is_whole = copies(insert) > 1 || !own.is_plain || is_frozen || is_clipped || !is_regular(&map);
        let is_wall = own.inserts == 1 && self.draws_a_wall(reader, block, item.layer);
        if is_whole || self.sheet.is_away(&ring) || self.sheet.is_small(&ring, pieces) && !is_wall {
            return with;
        }
        if own.inserts == 1 {
            let is_marked =
                self.sheet.moves().any(|outline| self.all_corners(block, &map, &|p| encloses(outline, p)));
            return if is_marked { with } else { How::Own };
        }
        if !self.told.contains(&block) && !self.sheet.is_short(&ring) {
            let text = format!(
                "block {} is shown by {} INSERTs, expected one: what it shows moves only as a whole",
                own.name, own.inserts
            );
            self.told.push(block);
            reader.note("dxf-block-shown-again", Severity::Info, item.record, text);
        }
        with
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

    fn unfold(&mut self, reader: &mut Reader<'_, '_>, shown: &Shown<'_>, showing: &mut Showing<'_>) {
        let Shown { insert, block, .. } = *shown;
        let own = &mut self.list[block];
        if let Some(path) = &own.xref {
            if self.lacking.insert(shown.record) {
                external(reader, shown.record, &own.name, path);
            }
            return;
        }
        if matches!(own.weight, Weight::Known { pieces: 0, .. }) {
            return;
        }
        showing.path.push(own.name.clone());
        showing.inserts.push(shown.record);
        // Lent out, so that blocks within can be looked at.
        let items = std::mem::take(&mut own.items);
        let base = own.base;
        let clip = self.clip(shown.record).cloned();
        let mut counts = [0; 2];
        for row in 0..insert.count[1] {
            for column in 0..insert.count[0] {
                let map = shown.outer * placement(insert, base, [column, row]);
                showing.clips.extend(clip.as_ref().map(|c| Bound { clip: c.mapped(&map), counts }));
                for item in &items {
                    let is_by_block = reader.layers.name(item.layer) == "0";
                    let layer = if is_by_block { shown.layer } else { item.layer };
                    let Body::Insert(inner) = &item.body else {
                        showing.add(reader, item, &map, layer, &shown.how);
                        continue;
                    };
                    let Some(child) = self.index(&inner.block) else {
                        missing(reader, item.record, &inner.block);
                        continue;
                    };
                    if reader.layers.list[layer as usize].is_frozen && layer != shown.layer {
                        reader.count_frozen_insert(layer);
                        continue;
                    }
                    let how = match &shown.how {
                        How::Own => self.how(reader, item, inner, child, &map),
                        with => with.clone(),
                    };
                    let record = item.record;
                    let shown = Shown { insert: inner, record, block: child, outer: map, layer, how };
                    self.unfold(reader, &shown, showing);
                }
                if clip.is_some() {
                    counts = showing.clips.pop().map_or(counts, |bound| bound.counts);
                }
            }
        }
        if clip.is_some() {
            state_clipped(reader, shown.record, &self.list[block].name, counts);
        }
        self.list[block].items = items;
        showing.path.pop();
        showing.inserts.pop();
    }
}

/// A block as one INSERT shows it.
struct Shown<'i> {
    insert: &'i Insert,
    /// The INSERT's record.
    record: usize,
    block: usize,
    /// Coordinates of the INSERT's owner to those of model space.
    outer: DAffine2,
    /// Layer of what lies on layer 0.
    layer: u32,
    how: How<'i>,
}

/// Says that a block is a file that is not opened.
fn external(reader: &mut Reader<'_, '_>, insert: usize, block: &str, path: &str) {
    let text = format!(
        "block {block} is the external file {path}; never opened, left out of the plan; bind the xref {block} in your CAD program \
         (XREF, Bind) and save again"
    );
    reader.unbound += 1;
    reader.warn("dxf-external-reference", insert, text);
}

fn missing(reader: &mut Reader<'_, '_>, record: usize, block: &str) {
    let text = format!("block {block}, found no such block; the INSERT shows nothing, kept in the file");
    reader.warn("dxf-missing-block", record, text);
}

/// Says that an INSERT is clipped, with how many entities are left out and how many there are.
fn state_clipped(reader: &mut Reader<'_, '_>, insert: usize, block: &str, [left_out, all]: [usize; 2]) {
    let text = format!(
        "block {block} is clipped (XCLIP): {left_out} of its {all} entities lie outside the boundary; left out of the plan, kept \
         in the file"
    );
    reader.note("dxf-clipped", Severity::Info, insert, text);
}

/// How often an INSERT shows its block.
pub(super) fn copies(insert: &Insert) -> u64 {
    insert.count[0].saturating_mul(insert.count[1])
}

/// Block coordinates to those of the INSERT's owner, for one cell of its array.
pub(super) fn placement(insert: &Insert, base: DVec2, cell: [u64; 2]) -> DAffine2 {
    let mirror = if insert.is_mirrored { DVec2::new(-1.0, 1.0) } else { DVec2::ONE };
    let shift = insert.spacing * DVec2::new(cell[0] as f64, cell[1] as f64);
    DAffine2::from_scale(mirror)
        * DAffine2::from_translation(insert.at)
        * DAffine2::from_angle(insert.rotation_rad)
        * DAffine2::from_translation(shift)
        * DAffine2::from_scale(insert.scale)
        * DAffine2::from_translation(-base)
}
