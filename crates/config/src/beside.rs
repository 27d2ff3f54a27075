//! What lies beside a scene and belongs to it.

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// Bytes of files beside a glTF.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beside {
    /// The IFC of the same name: it knows the classes of the nodes.
    pub twin: Option<Twin>,
    /// Files that its buffers name, by name.
    pub buffers: BTreeMap<String, Arc<[u8]>>,
    /// Pictures that its textures name, by name.
    pub pictures: BTreeMap<String, Arc<[u8]>>,
}

/// The IFC beside a scene, with what was understood of it: a scene is read often, its IFC once. Clones share both.
#[derive(Clone)]
pub struct Twin {
    bytes: Arc<[u8]>,
    /// Settings know no format: what was understood has its type from who asked first.
    known: Arc<OnceLock<Arc<dyn Any + Send + Sync>>>,
}

impl Twin {
    /// Its bytes, unpacked.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// What `read` makes of the bytes; asked for again, that of the first time.
    pub fn known<T: Any + Send + Sync>(&self, read: impl Fn(&[u8]) -> T) -> Arc<T> {
        let known = self.known.get_or_init(|| Arc::new(read(&self.bytes)));
        Arc::clone(known).downcast().unwrap_or_else(|_| Arc::new(read(&self.bytes)))
    }
}

impl<B: Into<Arc<[u8]>>> From<B> for Twin {
    fn from(bytes: B) -> Self {
        Self { bytes: bytes.into(), known: Arc::default() }
    }
}

impl PartialEq for Twin {
    fn eq(&self, other: &Self) -> bool {
        self.bytes == other.bytes
    }
}

impl fmt::Debug for Twin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Twin({} bytes)", self.bytes.len())
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn a_twin_is_read_once_by_all_its_clones() {
        let reads = Cell::new(0);
        let read = |bytes: &[u8]| {
            reads.set(reads.get() + 1);
            bytes.len()
        };
        let twin = Twin::from(&b"abc"[..]);
        let clone = twin.clone();
        assert_eq!([*twin.known(read), *clone.known(read), *twin.known(read)], [3; 3]);
        assert_eq!(reads.get(), 1);
        // Another content is another twin; another question is answered too.
        assert!(twin == Twin::from(&b"abc"[..]) && twin != Twin::from(&b"abd"[..]));
        assert_eq!(*twin.known(|b| b.first().copied()), Some(b'a'));
    }
}
