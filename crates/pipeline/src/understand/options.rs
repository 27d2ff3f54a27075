//! The settings as options of reading a drawing.

use glam::DVec2;

use enfilade_config::{Level, SelectorText, Settings};
use enfilade_plan::PlanOptions;
use enfilade_plan::reading::corrections::Corrections;

/// How the settings want a drawing read; the unit is looked up by the caller.
pub(crate) fn plan_options(settings: &Settings) -> PlanOptions {
    PlanOptions {
        unit: None,
        wall_layers: settings.wall_layers.clone(),
        query_layer: settings.query_layer.clone(),
        reference_layer: settings.reference_layer.clone(),
        view: settings.view.clone(),
        is_knee_level: settings.level == Level::Knee,
        picked: None,
        senses: None,
        corrections: corrections(settings),
    }
}

/// What the settings correct; a selector that cannot be read was refused with the settings.
fn corrections(settings: &Settings) -> Corrections {
    let r = &settings.reading;
    let list = |list: &[SelectorText]| list.iter().filter_map(|s| s.as_str().parse().ok()).collect();
    let points = |list: &[[f64; 2]]| list.iter().copied().map(DVec2::from).collect();
    Corrections {
        wall: list(&r.wall),
        not_wall: list(&r.not_wall),
        door: list(&r.door),
        window: list(&r.window),
        inside: points(&r.inside),
        outside: points(&r.outside),
        as_drawn: r.as_drawn == Some(true),
    }
}
