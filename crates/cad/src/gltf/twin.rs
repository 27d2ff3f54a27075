//! The IFC beside a scene: whether it is of the same building, and how it is used.

use std::borrow::Cow;
use std::sync::{Arc, LazyLock};

use super::bodies::is_global_id;
use super::scene::{File, Shown};
use super::{CUT_EYE_M, CUT_KNEE_M, ReadOptions};
use crate::ifc::Inventory;
use crate::{SpaceNames, StoreyInfo, main_storey, storey_at};
use enfilade_report::{Place, Report, counted};

/// What no IFC beside a scene knows.
static NOTHING: LazyLock<Inventory> = LazyLock::new(Inventory::default);

/// Why the IFC beside a scene is not used; `None` where it is, or where there is none.
fn refusal(scene: &File<'_>, shown: &[Shown], options: &ReadOptions) -> Option<&'static str> {
    let twin = options.twin.as_deref()?;
    if twin.classes.is_empty() {
        return Some("cannot be read, or holds no element");
    }
    // What a node hangs on is shown too.
    let nodes = scene.json.list("nodes");
    let name = |s: &Shown| nodes[s.node].text("name").unwrap_or_default();
    let has = |is_it: &dyn Fn(&str) -> bool| shown.iter().any(|s| is_it(name(s)));
    let is_other = has(&is_global_id) && !has(&|n| twin.classes.contains_key(n));
    is_other.then_some("has none of the GlobalIds that its nodes are named by: it is of another building")
}

/// The options without what the IFC beside the scene knows, where that is of another building or of none.
pub(super) fn taken<'o>(
    scene: &File<'_>,
    shown: &[Shown],
    options: &'o ReadOptions,
    report: &mut Report,
) -> Cow<'o, ReadOptions> {
    let Some(why) = refusal(scene, shown, options) else { return Cow::Borrowed(options) };
    let text = format!("the .ifc of the same name beside it {why}; the scene was read without it");
    report.warn("gltf-ifc", Place::file(scene.name), text);
    Cow::Owned(ReadOptions { twin: Some(Arc::default()), ..options.clone() })
}

/// Says so where the IFC beside a scene has marks: nobody who made them sees else why they do nothing.
pub(super) fn state_marks(file: &str, options: &ReadOptions, report: &mut Report) {
    let count = options.known().marked;
    if count == 0 {
        return;
    }
    let text = format!(
        "{} in the .ifc of the same name beside it {} Pset_Enfilade, and none of these marks is read here: those of a scene are \
         extras.enfilade of its own nodes; say them there, or run the .ifc itself",
        counted(count as u64, "element"),
        if count == 1 { "bears" } else { "bear" }
    );
    report.info("gltf-ifc-marks", Place::file(file), text);
}

/// Whether the IFC beside a scene is used.
pub fn uses_twin(file: &str, bytes: &[u8], options: &ReadOptions) -> bool {
    let Ok(scene) = File::open(file, bytes, &options.buffers) else { return false };
    options.twin.is_some() && refusal(&scene, &scene.shown(), options).is_none()
}

impl ReadOptions {
    /// What the IFC beside a scene knows.
    pub(super) fn known(&self) -> &Inventory {
        self.twin.as_deref().unwrap_or(&NOTHING)
    }

    /// Height of the cut above the floor, metres.
    pub(super) fn above_m(&self) -> f64 {
        if self.is_knee { CUT_KNEE_M } else { CUT_EYE_M }
    }

    /// The storey that is read, of those that the IFC beside a scene knows.
    fn chosen_storey(&self) -> Option<usize> {
        self.chosen_of(&self.known().storeys)
    }

    /// The one of some storeys that is read.
    pub(super) fn chosen_of(&self, storeys: &[StoreyInfo]) -> Option<usize> {
        match self.storey.as_deref() {
            Some(name) => storey_at(storeys.iter().map(|s| s.name.as_str()), name),
            None => main_storey(storeys, self.above_m()),
        }
    }

    /// Says of what is shown whether the IFC beside the scene has it in another storey than the one that is read.
    pub(super) fn elsewhere<'f>(&'f self, scene: &'f File<'_>) -> impl Fn(&Shown) -> bool + 'f {
        let chosen = self.chosen_storey();
        move |shown| {
            let of = || shown.names(scene).rev().find_map(|n| self.known().storey_of.get(n));
            chosen.is_some_and(|chosen| of().is_some_and(|of| *of != chosen))
        }
    }

    /// What the IFC beside a scene knows of the one space of a name.
    pub(super) fn space_of_name(&self, name: &str) -> Option<&SpaceNames> {
        let mut found = self.known().spaces.values().filter(|s| s.names.first().is_some_and(|n| n == name));
        found.next().filter(|_| found.next().is_none())
    }
}
