//! What `analyse` and `merge` write of every cell.

use std::path::PathBuf;

use clap::Args;

use super::values::point;

/// Tables of cells and of sight lines, and from where steps are counted.
#[derive(Clone, Debug, Default, Args)]
pub struct TableArgs {
    /// Step depth from this point of the drawing, drawing units; repeatable.
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pub step_from: Vec<[f64; 2]>,
    /// Every cell with all its measures as CSV or GeoJSON; - is standard output, as CSV.
    #[arg(long, value_name = "OUT.csv|OUT.geojson")]
    pub cells: Option<PathBuf>,
    /// Every pair of cells that see each other as CSV or GeoJSON; - is standard output, as CSV.
    #[arg(long, value_name = "OUT.csv|OUT.geojson")]
    pub edges: Option<PathBuf>,
}
