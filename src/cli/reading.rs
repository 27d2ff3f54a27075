//! Options that correct how a drawing is read.

use clap::Args;

use super::values::point;
use enfilade_config::{ReadingTable, RoomText, SelectorText};

/// Corrections. Each changes what it names and nothing else.
#[derive(Clone, Debug, Default, Args)]
#[command(
    next_help_heading = "Corrections (SEL: handle:NAME, layer:NAME or block:NAME; * and ? may stand in NAME)"
)]
pub struct ReadingArgs {
    /// These are walls; repeatable, as all of these.
    #[arg(long, value_name = "SEL")]
    pub wall: Vec<SelectorText>,
    /// These are no walls.
    #[arg(long, value_name = "SEL")]
    pub not_wall: Vec<SelectorText>,
    /// These show doors.
    #[arg(long, value_name = "SEL")]
    pub door: Vec<SelectorText>,
    /// These show windows.
    #[arg(long, value_name = "SEL")]
    pub window: Vec<SelectorText>,
    /// The floor round this point is measured, drawing units.
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pub inside: Vec<[f64; 2]>,
    /// The floor round this point is not measured, drawing units.
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pub outside: Vec<[f64; 2]>,
    /// What a room is for, by the number that check shows: 3=bath.
    #[arg(long, value_name = "N=KIND")]
    pub room: Vec<RoomText>,
    /// Every visible line stops sight, or every line of --wall-layer; nothing is interpreted.
    #[arg(long)]
    pub as_drawn: bool,
}

impl ReadingArgs {
    /// What the command line corrects.
    pub fn table(&self) -> ReadingTable {
        let given = self.clone();
        ReadingTable {
            unit: None,
            view: None,
            wall: given.wall,
            not_wall: given.not_wall,
            door: given.door,
            window: given.window,
            inside: given.inside,
            outside: given.outside,
            rooms: given.room,
            as_drawn: self.as_drawn.then_some(true),
        }
    }
}
