//! Where the shapes of an INSERT of model space go.

use std::collections::HashSet;

use glam::DAffine2;

use super::clip::Clip;
use super::clipped::{Seen, seen, seen_of_fill};
use super::curves::mapped;
use super::entity::{Body, Item};
use super::reader::Reader;
use super::sheet::{How, own_editable};
use crate::drawing::{Editable, Entity, Origin, Shape, SourceRef, Text};

/// Where the shapes of an INSERT of model space go, and the names of the blocks on the way.
pub(super) struct Showing<'o> {
    entities: &'o mut Vec<Entity>,
    texts: &'o mut Vec<Text>,
    /// Names of the blocks on the way.
    pub path: Vec<String>,
    /// Records of the INSERTs on the way.
    pub inserts: Vec<usize>,
    /// Clips of the INSERTs on the way.
    pub clips: Vec<Bound>,
    /// How many entities stood there before.
    first: usize,
    /// Records of which something is cut.
    cut: HashSet<usize>,
}

/// The clip of an INSERT on the way, in coordinates of model space.
pub(super) struct Bound {
    /// The clip.
    pub clip: Clip,
    /// How many of the INSERT's entities are left out, and how many it has.
    pub counts: [usize; 2],
}

impl<'o> Showing<'o> {
    /// Starts with nothing on the way.
    pub fn new(entities: &'o mut Vec<Entity>, texts: &'o mut Vec<Text>) -> Self {
        let (first, cut) = (entities.len(), HashSet::new());
        Self { entities, texts, path: Vec::new(), inserts: Vec::new(), clips: Vec::new(), first, cut }
    }

    /// Adds what an item draws, by a map to model space.
    pub fn add(
        &mut self,
        reader: &mut Reader<'_, '_>,
        item: &Item,
        map: &DAffine2,
        layer: u32,
        how: &How<'_>,
    ) {
        let (record, own_layer) = match how {
            How::Own => (item.record, layer),
            How::With { insert, .. } => (insert.record, insert.layer),
        };
        let source = reader.source(record, own_layer);
        let layer = reader.layers.name(layer).to_owned();
        match &item.body {
            Body::Shape(drawn, editable) => {
                let shape = mapped(drawn, map, reader.five_mm);
                if reader.insane_point(&shape).is_some() {
                    let text =
                        "what it shows has coordinates that are no finite numbers within the limit; left out";
                    reader.warn("dxf-bad-coordinate", record, text);
                    return;
                }
                let editable = match how {
                    How::Own => own_editable(drawn, editable, map),
                    How::With { editable, .. } => editable.clone(),
                };
                let blocks = self.path.clone();
                let origin = self.origin(reader, item);
                let parts = self.parts(shape, seen, record);
                self.entities.extend(parts.into_iter().map(|shape| Entity {
                    source: source.clone(),
                    layer: layer.clone(),
                    shape,
                    editable: editable.clone(),
                    blocks: blocks.clone(),
                    origin: origin.clone(),
                }));
            }
            Body::Fill(shape) => {
                self.add_fill(reader, item, mapped(shape, map, reader.five_mm), (source, layer))
            }
            Body::Text(at, text) => {
                let at = map.transform_point2(*at);
                if self.count(|clip| clip.shows(at)) {
                    self.texts.push(Text { source, layer, at, text: text.clone() });
                }
            }
            Body::Insert(_) => {}
        }
    }

    fn add_fill(
        &mut self,
        reader: &mut Reader<'_, '_>,
        item: &Item,
        shape: Shape,
        (source, layer): (SourceRef, String),
    ) {
        if reader.insane_point(&shape).is_some() {
            return;
        }
        let origin = self.origin(reader, item);
        for shape in self.parts(shape, seen_of_fill, source.record) {
            let of = (source.clone(), origin.clone());
            reader.add_fill(of, layer.clone(), shape, self.path.clone());
        }
    }

    fn origin(&self, reader: &Reader<'_, '_>, item: &Item) -> Origin {
        Origin { inserts: self.inserts.clone(), ..reader.origin(item.record) }
    }

    /// The parts of a shape that all clips on the way show.
    fn parts(&mut self, shape: Shape, seen: fn(&Clip, &Shape) -> Seen, record: usize) -> Vec<Shape> {
        let mut parts = vec![shape];
        let mut is_cut = false;
        for Bound { clip, counts: [left_out, all] } in self.clips.iter_mut().rev() {
            *all += 1;
            let had_some = !parts.is_empty();
            let of = |part: Shape| match seen(clip, &part) {
                Seen::Whole => vec![part],
                Seen::Parts(cut) => {
                    is_cut = true;
                    cut
                }
            };
            parts = parts.into_iter().flat_map(of).collect();
            *left_out += usize::from(had_some && parts.is_empty());
        }
        if is_cut && !parts.is_empty() {
            self.cut.insert(record);
        }
        parts
    }

    /// Whether all clips on the way show something, counted with them.
    fn count(&mut self, shows: impl Fn(&Clip) -> bool) -> bool {
        let mut is_shown = true;
        for Bound { clip, counts: [left_out, all] } in self.clips.iter_mut().rev() {
            *all += 1;
            let is_out = is_shown && !shows(clip);
            *left_out += usize::from(is_out);
            is_shown &= !is_out;
        }
        is_shown
    }

    /// What is cut moves no more, nor what its record shows besides: the plan has not all of it.
    pub fn hold_cut(self) {
        for e in &mut self.entities[self.first..] {
            if self.cut.contains(&e.source.record) {
                e.editable = Editable::No("its block is clipped (XCLIP)".into());
            }
        }
    }
}
