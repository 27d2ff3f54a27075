//! Building works on a floor plan: an opening, a door, a wider door, a wall's end taken back, a partition removed, glass, a
//! door walled up. Every legal place on a grid of 0.1 m is measured, and what a rule forbids says which.
//!
//! A layout is what is drawn, less what is demolished, plus what is built:
//!
//! ```
//! use enfilade_engine::geometry::Segment;
//! use enfilade_works::Change;
//!
//! // A wall of 10 m, with a hole of 2 m, whose jambs are built.
//! let wall = Segment { a: [0, 0], b: [10_000_000, 0] };
//! let hole = [[4_000_000, -50_000], [6_000_000, -50_000], [6_000_000, 50_000], [4_000_000, 50_000]];
//! let change = Change { demolished: vec![hole], built: vec![] };
//! let left: Vec<_> = change.apply(&[wall]).iter().map(|s| (s.a[0], s.b[0])).collect();
//! assert_eq!(left, [(0, 4_000_000), (6_000_000, 10_000_000)]);
//! ```

mod blocked;
pub mod change;
pub mod counts;
pub mod list;
pub mod marks;
pub mod rooms;
pub mod rule;
pub mod walls;

pub use change::Change;
pub use enfilade_brief::WorkKind;
pub use list::{PARTITION_M, Site, Work, Works, works};
pub use rooms::{Room, RoomId};
pub use rule::Rule;
