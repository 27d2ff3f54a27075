//! What stands for the page in a program that was built without it.

use std::sync::mpsc;

use super::{Accept, Door, Login};
use crate::daemon::{Notice, Order};
use enfilade_report::{Error, Place};

/// No page: none can be opened.
pub enum Page {}

impl Page {
    /// Refuses.
    ///
    /// # Errors
    /// [`Error::Usage`].
    pub fn open(_: u16, _: Option<Login>, _: mpsc::Sender<Order>, _: Box<Accept>) -> Result<Self, Error> {
        let text = "--page: this program was built without the page; build it without --no-default-features";
        Err(Error::usage("page", Place::default(), text))
    }

    /// Never called.
    pub fn take(&self, _: &Notice) {
        match *self {}
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn link(&self) -> Result<String, Error> {
        match *self {}
    }

    /// Never called.
    pub fn login(&self) -> &Login {
        match *self {}
    }

    /// Never called.
    pub fn door(&self) -> Door {
        match *self {}
    }
}
