//! A plan as it is shown: strokes and region outlines in metres, and how they are drawn.

use super::canvas::{Canvas, Pen, path_of};
use super::clip;
use super::frame::Frame;
use super::palette::{GREY, INK, PAPER, Rgb};
use enfilade_cad::own_layers::DEMOLISHED_RGB;

/// What a stroke stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StrokeKind {
    /// Drawn, but not taken as anything.
    Ignored,
    /// An opening with nothing in it.
    Opening,
    /// A door.
    Door,
    /// A window.
    Window,
    /// A wall or column that may be none.
    Doubtful,
    /// A wall, column or other solid that stays.
    Fixed,
    /// One that may move.
    Movable,
    /// Where something stood before it moved.
    Before,
    /// One that has moved.
    Moved,
    /// Demolished by a decided work.
    Demolished,
    /// Built by a decided work.
    Built,
}

/// A drawn line or outline.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Corners, metres.
    pub points: Vec<[f64; 2]>,
    /// Whether the last is joined with the first.
    pub closed: bool,
    /// Whether the outline is filled: a solid.
    pub filled: bool,
    /// What it stands for.
    pub kind: StrokeKind,
}

/// What a region is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RegionKind {
    /// Where measures are taken.
    Query,
    /// What is to be seen.
    Reference,
    /// Nothing moves in it.
    Keep,
    /// What is in it moves together.
    Move,
}

/// Outline of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionOutline {
    /// Corners of the closed outline, metres.
    pub points: Vec<[f64; 2]>,
    /// What it is for.
    pub kind: RegionKind,
}

/// A part of the floor.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorShape {
    /// Corners of its outline and of its holes, metres.
    pub rings: Vec<Vec<[f64; 2]>>,
    /// A point well inside.
    pub at: [f64; 2],
    /// What stands in it, in lines.
    pub words: Vec<String>,
    /// Whether it is measured; `None` where regions say what is.
    pub is_measured: Option<bool>,
}

/// Everything of a plan that is shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanPicture {
    /// Walls and the rest.
    pub strokes: Vec<Stroke>,
    /// Regions.
    pub regions: Vec<RegionOutline>,
    /// The floor, room by room.
    pub floor: Vec<FloorShape>,
    /// Lower left and upper right corner of what is shown. Pictures that are laid over each other
    /// share their bounds.
    pub bounds: [[f64; 2]; 2],
    /// Where north is: degrees anticlockwise from up.
    pub north_deg: f64,
}

/// A cell of the lattice with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Centre, metres.
    pub centre: [f64; 2],
    /// Value of the measure; `None`: in the graph, but not measured (not in the region of query).
    pub value: Option<f64>,
}

/// The smallest box round points; `[[0, 0], [0, 0]]` if there are none.
pub fn bounds_of(points: impl IntoIterator<Item = [f64; 2]>) -> [[f64; 2]; 2] {
    let mut found: Option<[[f64; 2]; 2]> = None;
    for p in points.into_iter().filter(|p| p[0].is_finite() && p[1].is_finite()) {
        let [lo, hi] = found.get_or_insert([p, p]);
        *lo = [lo[0].min(p[0]), lo[1].min(p[1])];
        *hi = [hi[0].max(p[0]), hi[1].max(p[1])];
    }
    found.unwrap_or_default()
}

/// Width of the outline of a filled solid, in widths of a wall that is only a line: thin, so that a solid
/// has the size it was drawn with, but thick enough that a thin wall is seen in a large plan.
const SOLID_EDGE: f32 = 0.3;

/// How one kind of stroke looks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub rgb: Rgb,
    pub opacity: f32,
    /// Width in line widths of the frame.
    pub width: f32,
    /// White rim on each side, in the same unit; keeps dark lines readable on dark cells.
    pub rim: f32,
    /// Dash in line widths.
    pub dash: &'static [f32],
}

impl Look {
    pub(super) const fn solid(rgb: Rgb, width: f32, rim: f32) -> Self {
        Self { rgb, opacity: 1.0, width, rim, dash: &[] }
    }

    pub(super) const fn dashed(self, dash: &'static [f32]) -> Self {
        Self { dash, ..self }
    }
}

/// What is demolished and what is built, in the colours of a conversion plan.
pub(super) const DEMOLISHED_LOOK: Look = Look::solid(DEMOLISHED_RGB, 1.6, 0.0);
pub(super) const BUILT_LOOK: Look = Look::solid([0xc8, 0x1e, 0x1e], 1.6, 0.0);

/// Draws all strokes of the given lists, kinds in their order (later lie on top). `look` is asked
/// once a kind; `None` leaves the kind out.
pub(super) fn draw_strokes(
    canvas: &mut Canvas,
    frame: &Frame,
    strokes: &[Stroke],
    look: impl Fn(StrokeKind) -> Option<Look>,
) {
    use StrokeKind::{
        Before, Built, Demolished, Door, Doubtful, Fixed, Ignored, Movable, Moved, Opening, Window,
    };
    // What goes lies over the filled wall that it is a part of.
    let order = [Ignored, Doubtful, Opening, Window, Door, Fixed, Movable, Demolished, Before, Moved, Built];
    for kind in order {
        if let Some(look) = look(kind) {
            let of_kind = |s: &&Stroke| s.kind == kind;
            draw_alike(canvas, frame, strokes.iter().filter(of_kind), look);
        }
    }
}

/// Draws strokes in one look: solids filled, the rim of all under the lines of all.
pub(super) fn draw_alike<'a>(
    canvas: &mut Canvas,
    frame: &Frame,
    strokes: impl Iterator<Item = &'a Stroke>,
    look: Look,
) {
    let mut solids: Vec<Vec<[f32; 2]>> = Vec::new();
    let mut lines: Vec<(Vec<[f32; 2]>, bool)> = Vec::new();
    for s in strokes {
        if s.filled && look.dash.is_empty() {
            solids.push(to_px(frame, &clip::ring(&s.points, frame.visible_m())));
        } else {
            let parts = clip::lines(&s.points, s.closed, frame.visible_m());
            lines.extend(parts.into_iter().map(|(part, closed)| (to_px(frame, &part), closed)));
        }
    }
    let width_px = look.width * frame.line_px;
    let edge_px = (SOLID_EDGE * width_px).max(1.6 * frame.unit_px);
    let outlines = path_of(solids.iter().map(|s| (&s[..], true)));
    let lines = path_of(lines.iter().map(|(l, c)| (&l[..], *c)));
    if look.rim > 0.0 {
        let rim_px = 2.0 * look.rim * frame.line_px;
        for (path, core_px) in [(&outlines, edge_px), (&lines, width_px)] {
            let pen = Pen { opacity: 0.75 * look.opacity, ..Pen::solid(PAPER, core_px + rim_px) };
            path.iter().for_each(|path| canvas.stroke(path, pen));
        }
    }
    for path in solids.iter().filter_map(|s| path_of([(&s[..], true)])) {
        canvas.fill(&path, look.rgb, look.opacity);
    }
    let pen = Pen { opacity: look.opacity, ..Pen::solid(look.rgb, edge_px) };
    outlines.iter().for_each(|path| canvas.stroke(path, pen));
    let dash: Vec<f32> = look.dash.iter().map(|d| d * width_px).collect();
    lines.iter().for_each(|path| canvas.stroke(path, Pen { width_px, dash_px: &dash, ..pen }));
}

fn to_px(frame: &Frame, points: &[[f64; 2]]) -> Vec<[f32; 2]> {
    points.iter().map(|p| frame.to_px(*p)).collect()
}

/// Outlines the regions; `tint` fills them lightly too.
pub(super) fn draw_region(
    canvas: &mut Canvas,
    frame: &Frame,
    region: &RegionOutline,
    look: Look,
    tint: Option<f32>,
) {
    let px = to_px(frame, &clip::ring(&region.points, frame.visible_m()));
    let Some(path) = path_of([(&px[..], true)]) else { return };
    if let Some(opacity) = tint {
        canvas.fill(&path, look.rgb, opacity);
    }
    let width_px = look.width * frame.unit_px;
    let dash: Vec<f32> = look.dash.iter().map(|d| d * width_px).collect();
    canvas.stroke(&path, Pen { rgb: look.rgb, opacity: look.opacity, width_px, dash_px: &dash });
}

impl PlanPicture {
    /// The box round everything in it.
    pub fn extent(&self) -> [[f64; 2]; 2] {
        let strokes = self.strokes.iter().flat_map(|s| &s.points);
        bounds_of(strokes.chain(self.regions.iter().flat_map(|r| &r.points)).copied())
    }

    /// Whether any stroke is of that kind.
    pub fn has(&self, kind: StrokeKind) -> bool {
        self.strokes.iter().any(|s| s.kind == kind)
    }
}

/// Looks of a plan that stands behind something coloured.
pub(super) fn faint(kind: StrokeKind) -> Option<Look> {
    match kind {
        StrokeKind::Fixed | StrokeKind::Movable => Some(Look { opacity: 0.55, ..Look::solid(INK, 0.5, 0.0) }),
        StrokeKind::Door | StrokeKind::Window | StrokeKind::Opening => {
            Some(Look { opacity: 0.7, ..Look::solid(INK, 0.4, 0.0).dashed(&[3.0, 3.0]) })
        }
        StrokeKind::Ignored => Some(Look { opacity: 0.35, ..Look::solid(GREY, 0.35, 0.0) }),
        StrokeKind::Demolished => Some(DEMOLISHED_LOOK),
        StrokeKind::Built => Some(BUILT_LOOK),
        StrokeKind::Doubtful | StrokeKind::Before | StrokeKind::Moved => None,
    }
}
