//! An option made real.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::measure::worth::Worth;
use crate::works::option::BuildingOption;
use enfilade_cad::drawing::Edit;
use enfilade_moves::Layout;
use enfilade_overlay::brief_item::BriefItem;
use enfilade_overlay::result::{Explanation, Gains};
use enfilade_report::Report;

/// A member made real: its layout, its bytes without our layers, and what these are worth.
pub(crate) struct Made {
    pub(crate) layout: Layout,
    pub(crate) member: enfilade_search::Member,
    pub(crate) worth: Worth,
    pub(crate) edits: Vec<Edit>,
    /// Those of filled areas that go along.
    pub(crate) following: Vec<enfilade_cad::dxf::Following>,
    /// What the edits change in the file.
    pub(crate) changed: enfilade_cad::Changes,
    /// Ids of the host program, by record.
    pub(crate) host_ids: BTreeMap<u64, String>,
    pub(crate) report: Report,
    pub(crate) name: String,
    /// Whether it stays because somebody pinned it.
    pub(crate) is_pinned: bool,
    /// Which moves bring the gain.
    pub(crate) explanation: Explanation,
    /// Confirmed gains; empty where nothing was confirmed.
    pub(crate) gains: Gains,
    /// What it has of the brief of rooms; empty where there is none.
    pub(crate) brief: Vec<BriefItem>,
    /// What it builds beside what it moves.
    pub(crate) built: Option<Arc<BuildingOption>>,
}

impl Made {
    /// Whether it moves anything: works alone do not.
    pub(crate) fn moves_any(&self) -> bool {
        self.built.as_ref().is_none_or(|b| b.moved.is_any())
    }

    /// All changes of the file: of what moves, and of works.
    pub(crate) fn all_edits(&self) -> Vec<Edit> {
        self.edits.iter().chain(self.built.iter().flat_map(|b| &b.edits)).cloned().collect()
    }

    /// What people call it.
    pub(crate) fn title(&self) -> String {
        self.name.strip_prefix("candidate-").map_or("best layout".to_owned(), |n| format!("option {n}"))
    }
}
