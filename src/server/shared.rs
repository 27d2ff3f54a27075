//! What the parts of the page share.

use std::sync::{Arc, mpsc};

use super::Access;
use super::{Accept, Board};
use crate::daemon::Order;

/// What the threads of daemon and page share.
pub(super) struct Shared {
    pub(super) board: Board,
    pub(super) access: Arc<Access>,
    pub(super) orders: mpsc::Sender<Order>,
    pub(super) accept: Box<Accept>,
}
