//! What was understood, as a picture.

use crate::understand::rooms::Room;
use crate::understand::sensed;
use crate::understand::understood::Understood;
use crate::write::{reading, show};
use enfilade_overlay::check_png;
use enfilade_overlay::heat_map::DEFAULT_SIDE_PX;
use enfilade_report::Error;

pub(crate) fn check_picture(
    base: &Understood,
    sensed: &sensed::Sensed,
    rooms: &[Room],
) -> Result<Vec<u8>, Error> {
    let picture = show::check_picture(base, sensed, rooms);
    check_png(&picture, &base.plan.file, &reading::headline(base, sensed).words(), DEFAULT_SIDE_PX)
}
