//! Records of nodes and of pieces of their meshes.

/// Records of one piece more lie this far behind their node's.
const NODE_RECORDS: usize = 1 << (usize::BITS / 2);

/// The record of a node, or of one piece of its mesh.
pub(super) fn record(node: usize, piece: Option<usize>) -> usize {
    node + piece.map_or(0, |p| (p + 1) * NODE_RECORDS)
}

/// Node and piece of a record.
pub(super) fn of_record(record: usize) -> (usize, Option<usize>) {
    (record % NODE_RECORDS, (record / NODE_RECORDS).checked_sub(1))
}
