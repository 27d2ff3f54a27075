//! A round made up to be shown: five options of a building, three rounds, hostile names.

use enfilade_overlay::page::{ArchivePoint, ReportInput, View};
use enfilade_overlay::palette::{Palette, Scale};
use enfilade_overlay::picture::{PlanPicture, Stroke, StrokeKind};
use enfilade_overlay::result::*;
use enfilade_overlay::words::{confirmed, words};
use enfilade_overlay::{Cell, HeatMap, Series, check_png, convergence_png, diversity_png, heat_map_png};
use enfilade_report::{Place, Problem, Severity};

use super::plans;

/// A layer name that would run as script if it were not escaped.
pub const HOSTILE: &str = "<img src=x onerror=alert(1)>";
const OPTIONS: usize = 5;

pub struct Sample {
    pub result: RoundResult,
    present: Vec<Vec<u8>>,
    candidates: Vec<Vec<Vec<u8>>>,
    diversity: Vec<u8>,
    convergence: Vec<u8>,
    understood: Vec<u8>,
    archive: Vec<ArchivePoint>,
}

const MEASURES: [(&str, &str, &str); 3] = [
    ("degree", "Connectivity", "cells seen"),
    ("depth", "Visual Mean Depth", "steps"),
    ("entropy", "Visual Entropy", "bits"),
];

fn plan(column: &str) -> (PlanPicture, Vec<Cell>, f64) {
    if let Some((picture, cells)) = plans::building(column) {
        return (picture, cells, 1.3333);
    }
    let (cells, spacing) = plans::cells(20.0, 14.0, 600.0);
    (plans::hall(20.0, 14.0), cells, spacing)
}

/// Pictures are drawn small unless somebody looks at them.
fn side_px() -> u32 {
    if std::env::var_os("ENFILADE_LOOK").is_some() { 1600 } else { 320 }
}

/// Which strokes an option moves, and by how much, metres.
fn shift(option: usize, stroke: usize) -> Option<[f64; 2]> {
    let turn = (stroke * 7 + option * 5) % 23;
    (turn == 3).then_some([0.8 - 0.3 * option as f64, 1.1 - 0.4 * option as f64])
}

fn moved(stroke: &Stroke, by: [f64; 2]) -> Stroke {
    let points = stroke.points.iter().map(|p| [p[0] + by[0], p[1] + by[1]]).collect();
    Stroke { points, kind: StrokeKind::Moved, ..stroke.clone() }
}

fn option_picture(present: &PlanPicture, option: usize) -> (PlanPicture, Vec<Stroke>) {
    let mut picture = present.clone();
    let mut shown = Vec::new();
    for (i, s) in present.strokes.iter().enumerate() {
        if let Some(by) = shift(option, i) {
            picture.strokes[i].kind = StrokeKind::Before;
            shown.push(moved(s, by));
        }
    }
    picture.strokes.extend(shown.iter().cloned());
    (picture, shown)
}

fn heat(
    picture: &PlanPicture,
    cells: &[Cell],
    spacing_m: f64,
    m: usize,
    layout: &str,
    scale: Scale,
) -> Vec<u8> {
    let (key, _, unit) = MEASURES[m];
    let title = enfilade_overlay::measure::plain_name(key);
    let subtitle = format!("hôtel-particulier.dxf · {layout}");
    let map = HeatMap {
        picture,
        cells,
        spacing_m,
        scale,
        title: &title,
        subtitle: &subtitle,
        unit,
        no_value: "not measured",
        palette: Palette::Viridis,
    };
    heat_map_png(&map, side_px()).unwrap()
}

impl Sample {
    pub fn new() -> Self {
        let mut present = Vec::new();
        let mut candidates = vec![Vec::new(); OPTIONS];
        let mut members = vec![Vec::new(); OPTIONS];
        for (m, (_, column, _)) in MEASURES.iter().enumerate() {
            let (picture, cells, spacing_m) = plan(column);
            let scale = Scale::of(cells.iter().filter_map(|c| c.value));
            present.push(heat(&picture, &cells, spacing_m, m, "present layout", scale));
            for o in 0..OPTIONS {
                let (changed, shown) = option_picture(&picture, o);
                let nudge = |c: &Cell| {
                    let wave = (c.centre[0] / 6.0 + o as f64).sin() * (c.centre[1] / 5.0).cos();
                    Cell { value: c.value.map(|v| v * (1.0 + 0.12 * wave)), ..*c }
                };
                let cells: Vec<Cell> = cells.iter().map(nudge).collect();
                candidates[o].push(heat(&changed, &cells, spacing_m, m, &format!("option {}", o + 1), scale));
                members[o] = shown;
            }
        }
        let (picture, ..) = plan("Connectivity");
        let labels: Vec<String> = (1..=OPTIONS).map(|i| format!("Option {i}")).collect();
        let rise =
            |top: f64| (0..100u64).map(|i| (i * 20, top * (1.0 - (-(i as f64) / 20.0).exp()))).collect();
        let series = [
            Series { name: "best score".to_owned(), points: rise(0.61) },
            Series { name: "lowest of the options".to_owned(), points: rise(0.46) },
        ];
        Self {
            result: result(),
            present,
            candidates,
            diversity: diversity_png(&picture, &members, &labels, side_px()).unwrap(),
            convergence: convergence_png(&series, side_px()).unwrap(),
            understood: check_png(&picture, "hôtel-particulier.dxf", "metres", side_px()).unwrap(),
            archive: archive(),
        }
    }

    pub fn input(&self) -> ReportInput<'_> {
        let views = |pngs: &'_ [Vec<u8>]| -> Vec<View<'_>> {
            // The lifetimes of the pictures are those of the sample.
            MEASURES.iter().zip(pngs).map(|((key, ..), png)| View { measure: key, png: leak(png) }).collect()
        };
        ReportInput {
            result: &self.result,
            round: 3,
            present: views(&self.present),
            candidates: self.candidates.iter().map(|c| views(c)).collect(),
            best: Vec::new(),
            diversity: Some(&self.diversity),
            convergence: Some(&self.convergence),
            understood: Some(&self.understood),
            works: None,
            brief_picture: None,
            works_picture: None,
            archive_axes: ["degree", "depth", "entropy", "score", "clearance_m2"].map(str::to_owned).to_vec(),
            archive: self.archive.clone(),
            command: "enfilade run hôtel-particulier-r03.dxf --unit m --spacing 1.3333 --evaluations 2000 --members 5 --seed 1",
            program: "Enfilade 0.1.0",
        }
    }
}

fn leak(png: &[u8]) -> &'static [u8] {
    Box::leak(png.to_vec().into_boxed_slice())
}

fn archive() -> Vec<ArchivePoint> {
    let wave = |i: usize, k: f64| ((i as f64 * k).sin() * 43758.5453).fract();
    let point = |i: usize| {
        let (a, b, c) = (wave(i, 12.9898), wave(i, 78.233), wave(i, 37.719));
        let score = 0.3 * a - 0.2 * b + 0.2;
        let values =
            vec![64.0 + 9.0 * a + 2.0 * c, 3.9 - 0.5 * a + 0.3 * b, 2.4 + 0.2 * c, score, 1.5 + b.abs()];
        ArchivePoint { values, candidate: None, is_front: false }
    };
    let chosen = |o: usize| ArchivePoint {
        values: vec![
            74.0 - o as f64,
            3.3 + 0.05 * o as f64,
            2.62 - 0.03 * o as f64,
            0.61 - 0.03 * o as f64,
            1.2,
        ],
        candidate: Some(o),
        is_front: true,
    };
    (1..900).map(point).chain((0..OPTIONS).map(chosen)).collect()
}

fn moves() -> Vec<MoveEntry> {
    let entry = |name: &str, kind, lower, upper, unit: &str| MoveEntry {
        name: name.to_owned(),
        kind,
        lower,
        upper,
        unit: unit.to_owned(),
        direction_deg: None,
        elements: vec![ElementRef::Dxf { handle: Some("2F3".to_owned()), record: 118 }],
        geometry: "0123456789ab".to_owned(),
    };
    vec![
        entry("door-salon", MoveKind::X, -2.0, 2.0, "m"),
        entry("door-cour", MoveKind::Y, -1.5, 1.5, "m"),
        entry("cabinet", MoveKind::Rotate, -15.0, 15.0, "deg"),
        entry("cabinet", MoveKind::X, -1000.0, 1000.0, "mm"),
        MoveEntry { direction_deg: Some(45.0), ..entry("escalier", MoveKind::Along, -1.0, 1.0, "m") },
        entry("cour", MoveKind::Scale, 0.9, 1.15, ""),
        entry(HOSTILE, MoveKind::Y, -0.5, 0.5, "m"),
    ]
}

fn result() -> RoundResult {
    let initial = Layout {
        mean: Numbers::of([("degree", 63.4), ("depth", 3.94), ("entropy", 2.41)]),
        penalty: Numbers::of([("clearance_m2", 1.519), ("wall_length_m", 0.0), ("disconnection", 0.0)]),
    };
    let candidate = |o: usize| {
        let f = o as f64;
        let mean = Numbers::of([
            ("degree", 74.8 - 1.3 * f),
            ("depth", 3.31 + 0.07 * f),
            ("entropy", 2.39 + 0.06 * f),
        ]);
        let parameters: Vec<f64> = moves()
            .iter()
            .enumerate()
            .map(|(i, m)| match (i + o) % 4 {
                0 => m.kind.identity(),
                k => m.lower + (m.upper - m.lower) * (0.17 + 0.21 * k as f64),
            })
            .collect();
        let explanation = Explanation {
            breaks: vec![],
            parts: vec![
                Part { name: "door-3".to_owned(), groups: 1, lost: 0.54 - 0.02 * f },
                Part { name: "kiosk".to_owned(), groups: 2, lost: 0.31 },
            ],
            from_present: 1.12 - 0.1 * f,
            nearest: Some(if o == 0 { 2 } else { 1 }),
            from_nearest: Some(0.87),
            kept: Numbers::of([("degree", 0.97 - 0.04 * f), ("depth", 0.81 + 0.03 * f)]),
        };
        let gain = |share: f64, sense| Gain { share, low: share - 0.03, high: share + 0.03, sense };
        let gain = Gains::from([
            ("degree".to_owned(), gain(0.18 - 0.02 * f, Sense::Max)),
            ("depth".to_owned(), gain(0.16 - 0.02 * f, Sense::Min)),
            ("entropy".to_owned(), gain(-0.01 + 0.02 * f, Sense::Max)),
        ]);
        Candidate {
            file: format!("candidate-{}.dxf", o + 1),
            words: words(&moves(), &parameters, &confirmed(&initial.mean, &gain), &explanation),
            gain,
            explanation,
            parameters,
            mean,
            penalty: Numbers::of([
                ("clearance_m2", 1.21 + 0.2 * f),
                ("wall_length_m", 0.4 * f),
                ("disconnection", 0.0),
            ]),
            score: Some(0.61 - 0.03 * f),
            pinned: false,
            within_threshold: o != 4,
            changes: vec![Change {
                element: ElementRef::Dxf { handle: None, record: 7 },
                host_id: None,
                from: vec![[1.0, 2.0], [1.0, 6.25]],
                to: vec![[2.2, 2.0], [2.2, 6.25]],
                follows: false,
            }],
            works: Vec::new(),
            brief: vec![],
        }
    };
    let earlier = |round: u64, candidate, k: f64| LineageEntry {
        drawing: if round == 1 {
            "hôtel-particulier.dxf".to_owned()
        } else {
            format!("hôtel-particulier-r0{round}.dxf")
        },
        round,
        so_far: false,
        other_ruler: false,
        candidate,
        point: None,
        mean: Numbers::of([
            ("degree", 51.2 * k),
            ("depth", 4.6 / k),
            ("entropy", 2.22 * (1.0 + (k - 1.0) / 3.0)),
        ]),
        score: None,
    };
    let objective = |name: &str, sense, initial, best, limit| Objective {
        name: name.to_owned(),
        sense,
        threshold: 0.7,
        initial,
        best: Some(best),
        reachable: Some(best),
        limit: Some(limit),
        free: None,
    };
    RoundResult {
        questions: Vec::new(),
        brief: Vec::new(),
        front: Vec::new(),
        schema: RESULT_SCHEMA.to_owned(),
        version: "0.1.0".to_owned(),
        input: Input {
            path: "Büro/hôtel-particulier-r03.dxf".to_owned(),
            sha256: "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".to_owned(),
            content: String::new(),
            format: "dxf".to_owned(),
            unit: "m".to_owned(),
            unit_reason: "$INSUNITS 6".to_owned(),
            north_deg: 0.0,
        },
        settings: serde_json::from_str(
            r#"{"seed": 1, "mode": "diverse", "members": 5, "budget": {"evaluations": 2000, "seconds": null},
                "spacing_m": 1.3333, "objective": "degree max 0.7, depth min 0.7, entropy max 0.7",
                "penalty": "clearance 1, wall-length 1", "wall_layers": ["WALLS", "A-WALL*"]}"#,
        )
        .unwrap(),
        counts: Counts { vertices: 900, query: 900, covered: 8, reference: 900, edges: 27_839, walls: 94 },
        spacing_m: 1.3333,
        lattice_centre: [0.0, 0.0],
        moves: moves(),
        objectives: vec![
            objective("degree", Sense::Max, 63.4, 75.2, 71.66),
            objective("depth", Sense::Min, 3.94, 3.2, 3.422),
            objective("entropy", Sense::Max, 2.41, 2.66, 2.585),
        ],
        candidates: (0..OPTIONS).map(candidate).collect(),
        best: None,
        diversity: Diversity { min_distance: Some(1.576), mean_distance: Some(1.669), likeness: None },
        evaluations: 2000,
        seconds: 4.27,
        stopped_by: "evaluations".to_owned(),
        lineage: vec![earlier(1, None, 1.0), earlier(2, Some(4), 1.13)],
        problems: [
            (
                "unit-assumed",
                Severity::Info,
                "The drawing states metres ($INSUNITS 6); taken as stated.".to_owned(),
            ),
            (
                "curve-left-out",
                Severity::Warning,
                format!("SPLINE on layer {HOSTILE}, expected LINE, ARC or POLYLINE; left out of the walls."),
            ),
        ]
        .map(|(code, severity, text)| {
            let place =
                Place::line("hôtel-particulier-r03.dxf", 1842).entity(format!("SPLINE 2F3 layer {HOSTILE}"));
            ProblemEntry::from(&Problem { code, severity, place, text })
        })
        .to_vec(),
        initial,
    }
}
