//! DXF: bytes to a drawing, and edits to bytes.
