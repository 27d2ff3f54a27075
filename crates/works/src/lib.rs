#![doc = include_str!("../README.md")]

pub mod change;
pub mod counts;
pub mod kind;
pub mod list;
pub mod rooms;
pub mod rule;
pub mod walls;

pub use change::Change;
pub use kind::WorkKind;
pub use list::{Site, Work, Works, works};
pub use rooms::{Room, RoomId};
pub use rule::Rule;
