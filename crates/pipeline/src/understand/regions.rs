//! Where people are measured: regions of the settings, and what is said of the interior and of seeds.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Drawing, Format};
use enfilade_cad::names::is_outdoors;
use enfilade_cad::own_layers;
use enfilade_config::{PairName, Settings};
use enfilade_engine::Region;
use enfilade_engine::geometry::PointUm;
use enfilade_engine::interior::Interior;
use enfilade_plan::Plan;
use enfilade_plan::floor::name_in;
use enfilade_plan::kinds::kind_of_name;
use enfilade_plan::reading::corrections::Finding;
use enfilade_report::{Error, Place, Report, counted};

/// Adds the regions of the settings to those drawn.
pub(crate) fn add_regions(plan: &mut Plan, settings: &Settings) -> Result<(), Error> {
    let wrong = |text: String| {
        Error::usage("region", Place::default(), format!("[[region]] {text}; nothing was done"))
    };
    for table in &settings.regions {
        let ring: Vec<PointUm> =
            table.points.iter().map(|p| plan.frame.um_from_file(DVec2::from(*p))).collect();
        let name = table.pair.as_ref().map(|p| p.parse::<PairName>().map_err(&wrong)).transpose()?;
        let list = match (table.kind.as_str(), name) {
            ("query", None) => &mut plan.markers.query,
            ("reference", None) => &mut plan.markers.reference,
            ("query", Some(name)) => &mut plan.markers.pair(name.as_str()).query,
            ("reference", Some(name)) => &mut plan.markers.pair(name.as_str()).reference,
            ("keep", None) => &mut plan.markers.keep,
            ("keep", Some(_)) => return Err(wrong("keep: what stays belongs to no pair".into())),
            (other, _) => return Err(wrong(format!("kind {other:?}: expected query, reference or keep"))),
        };
        if ring.len() < 3 {
            return Err(wrong(format!("{}: found {} points, expected at least 3", table.kind, ring.len())));
        }
        list.push(Region::Ring(ring));
    }
    Ok(())
}

/// Names of floor outdoors that are said at most.
const CALLED_SAID: usize = 5;

/// The interior of a DXF without courts, terraces and balconies: floor in which a text says so, and that no other room shares.
pub(crate) fn without_called_outdoors(
    interior: Interior,
    drawing: &Drawing,
    plan: &Plan,
    report: &mut Report,
) -> Interior {
    if drawing.format != Format::Dxf || !plan.markers.needs_interior() {
        return interior;
    }
    let (mut names, mut outdoors, mut rooms) = (Vec::new(), Vec::new(), Vec::new());
    let is_hidden = |layer: &str| drawing.layers.iter().any(|l| l.name == layer && (l.is_off || l.is_frozen));
    let written = drawing.texts.iter().chain(&drawing.tags);
    let shown = written.filter(|t| !own_layers::is_own(&t.layer) && !is_hidden(&t.layer));
    for (text, name) in shown.filter_map(|t| Some((t, name_in(&t.text)?))) {
        let at = plan.frame.um_from_file(text.at);
        if is_one_word(&name) && is_outdoors(&name) {
            names.push(name);
            outdoors.push(at);
        } else if kind_of_name(&name).is_some() {
            rooms.push(at);
        }
    }
    let (interior, left) = interior.without_called(&outdoors, &rooms, plan.human_scale);
    let called: BTreeSet<&str> = left.iter().map(|k| names[*k].as_str()).collect();
    if !called.is_empty() {
        let more = if called.len() > CALLED_SAID { ", …" } else { "" };
        let names: Vec<&str> = called.into_iter().take(CALLED_SAID).collect();
        let text = format!(
            "{}{more}: outdoors by the name, and not measured; --inside X,Y takes it in",
            names.join(", ")
        );
        report.info("outdoors-called", Place::file(&plan.file), text);
    }
    interior
}

/// Whether a name is one word, with a number perhaps: others speak of a door to the terrace, or of the view.
fn is_one_word(name: &str) -> bool {
    name.split_whitespace().filter(|word| word.chars().any(char::is_alphabetic)).count() == 1
}

/// The interior as the user corrects it; what a correction cannot do goes to the plan's findings and the report.
pub(crate) fn corrected(
    interior: Option<Interior>,
    plan: &mut Plan,
    settings: &Settings,
    report: &mut Report,
) -> Option<Interior> {
    let (inside, outside) = (&settings.reading.inside, &settings.reading.outside);
    if inside.is_empty() && outside.is_empty() {
        return interior;
    }
    let mut findings = Vec::new();
    if !plan.markers.needs_interior() || !settings.seed_points.is_empty() {
        findings.push(Finding::Overruled);
    }
    let um = |list: &[[f64; 2]]| -> Vec<PointUm> {
        list.iter().map(|p| plan.frame.um_from_file(DVec2::from(*p))).collect()
    };
    let corrected = interior.map(|i| i.corrected(&um(inside), &um(outside)));
    let (interior, open) = match corrected {
        Some((interior, open)) => (Some(interior), open),
        None if findings.is_empty() => (None, (0..inside.len()).collect()),
        None => (None, Vec::new()),
    };
    findings.extend(open.into_iter().map(|i| Finding::Open { at: inside[i] }));
    findings.iter().for_each(|f| f.tell(&plan.file, report));
    plan.reading.findings.extend(findings);
    interior
}

/// Says what was taken as closed where no region is drawn.
pub(crate) fn state_interior(base: &Understood, settings: &Settings, report: &mut Report) {
    let Some(interior) = &base.interior else { return };
    if base.plan.markers.needs_interior() && settings.seed_points.is_empty() && !interior.is_as_drawn() {
        let wide = match interior.gap_m() {
            0.0 => "its doors and windows".to_string(),
            gap => format!("gaps up to {gap:.1} m wide"),
        };
        let open = match base.plan.outdoors.len() {
            0 => String::new(),
            n => format!(
                ", {} named after terraces, balconies, yards or gardens as outdoors",
                counted(n as u64, "outline")
            ),
        };
        let text = format!(
            "no region drawn and the outline is open: {wide} were taken as closed to find the interior{open}; \
             EF-QUERY or --seed-point says it exactly"
        );
        report.info("interior-closed", Place::file(&base.plan.file), text);
    }
}

/// Says where a seed has no effect.
pub(crate) fn state_unused_seeds(plan: &Plan, settings: &Settings, report: &mut Report) {
    if !settings.seed_points.is_empty() && !plan.markers.needs_interior() {
        let text = "--seed-point says where the region is if none is drawn, but regions are (EF-QUERY and EF-REFERENCE, \
                    [[region]] or --query): these are measured, the seed changes nothing";
        report.warn("seed-unused", Place::file(&plan.file), text);
    }
}
