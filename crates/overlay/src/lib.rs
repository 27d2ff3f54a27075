//! What is shown: heat maps, diagrams, the report page, result.json, and what is added to a drawing.
//!
//! Pure functions, data in and bytes out. The types are plain: this module knows neither moves, nor
//! file formats, nor the optimiser; the pipeline translates. Plan coordinates are metres of the plan
//! frame, y up (drawn north up).
//!
//! ```
//! use enfilade_overlay::Palette;
//!
//! // A fifth of the scale, and all of it.
//! let colours = [0.2, 1.0].map(|fraction| Palette::Viridis.at(fraction));
//! assert_eq!(colours[1], [0xfd, 0xe7, 0x25]);
//! assert_ne!(colours[0], colours[1]);
//! ```

pub mod additions;
pub mod brief;
pub mod brief_item;
pub mod brief_layers;
pub mod built;
mod canvas;
pub mod chart;
pub mod check;
mod clip;
pub mod diversity;
pub mod element;
mod font;
mod frame;
pub mod front;
pub mod gain;
pub mod glossary;
pub mod graph;
pub mod heat_map;
mod html;
pub mod measure;
pub mod options;
pub mod page;
pub mod palette;
pub mod picture;
pub mod reading;
pub mod result;
pub mod words;
pub mod works;

pub use additions::{arrow_additions, heat_additions, heat_legend, moved_additions};
pub use chart::{Panel, Series, convergence_png, resolution_png};
pub use check::check_png;
pub use diversity::diversity_png;
pub use heat_map::{HeatMap, heat_map_png};
pub use page::{ArchivePoint, ReportInput, RoundCard, View, overview_html, report_html};
pub use palette::{Palette, Scale};
pub use picture::{Cell, FloorShape, PlanPicture, RegionKind, RegionOutline, Stroke, StrokeKind};
