//! The smallest DXF that CAD programs accept without repair: R12 without handles, R2010 with them.

use std::fmt::Write;

/// A point in drawing units.
pub type Point = (f64, f64);

/// What the file is written as.
#[derive(Clone, Copy, PartialEq)]
pub enum Version {
    /// AC1009: no handles, no subclass markers, polylines with VERTEX records, CRLF line ends.
    R12,
    /// AC1024: handles, LWPOLYLINE and MTEXT, layouts, LF line ends.
    R2010,
}

/// Fixed handles of the plot style dictionary and its one entry, which every layer names.
const PLOT_STYLES: &str = "E";
const PLOT_STYLE_NORMAL: &str = "F";

/// A drawing being made.
pub struct Sheet {
    version: Version,
    /// Value of `$INSUNITS`; `None` writes no such variable.
    insunits: Option<u32>,
    /// Name and colour index, in the order of first use.
    layers: Vec<(&'static str, i32)>,
    entities: Vec<(&'static str, Item)>,
}

enum Item {
    Line(Point, Point),
    Poly { points: Vec<Point>, is_closed: bool },
    Circle(Point, f64),
    Text { at: Point, height: f64, text: String },
    MText { at: Point, height: f64, width: f64, text: String },
}

/// Numbers the file's own records must refer to.
struct Handles {
    next: u32,
}

impl Handles {
    fn take(&mut self) -> String {
        self.next += 1;
        format!("{:X}", self.next - 1)
    }
}

/// Group codes and values as text lines.
struct Out {
    text: String,
    newline: &'static str,
}

impl Out {
    fn put(&mut self, code: u32, value: impl std::fmt::Display) {
        let _ = write!(self.text, "{code:>3}{0}{value}{0}", self.newline);
    }

    fn number(&mut self, code: u32, value: f64) {
        // Six decimals are finer than any drawing unit here; adding 0 turns -0 into 0.
        self.put(code, format!("{:?}", (value * 1e6).round() / 1e6 + 0.0));
    }

    fn point(&mut self, code: u32, (x, y): Point) {
        self.number(code, x);
        self.number(code + 10, y);
    }

    fn point_3d(&mut self, code: u32, at: Point) {
        self.point(code, at);
        self.number(code + 20, 0.0);
    }
}

impl Sheet {
    pub fn new(version: Version, insunits: Option<u32>) -> Self {
        Self { version, insunits, layers: vec![], entities: vec![] }
    }

    /// Defines a layer with its colour index.
    pub fn layer(&mut self, name: &'static str, colour: i32) {
        self.layers.push((name, colour));
    }

    pub fn line(&mut self, layer: &'static str, a: Point, b: Point) {
        self.entities.push((layer, Item::Line(a, b)));
    }

    /// Straight pieces from point to point, each a LINE of its own.
    pub fn lines(&mut self, layer: &'static str, points: &[Point]) {
        for pair in points.windows(2) {
            self.line(layer, pair[0], pair[1]);
        }
    }

    pub fn ring(&mut self, layer: &'static str, points: &[Point]) {
        self.entities.push((layer, Item::Poly { points: points.to_vec(), is_closed: true }));
    }

    pub fn path(&mut self, layer: &'static str, points: &[Point]) {
        self.entities.push((layer, Item::Poly { points: points.to_vec(), is_closed: false }));
    }

    pub fn rectangle(&mut self, layer: &'static str, (x0, y0): Point, (x1, y1): Point) {
        self.ring(layer, &[(x0, y0), (x1, y0), (x1, y1), (x0, y1)]);
    }

    pub fn circle(&mut self, layer: &'static str, centre: Point, radius: f64) {
        self.entities.push((layer, Item::Circle(centre, radius)));
    }

    pub fn text(&mut self, layer: &'static str, at: Point, height: f64, text: &str) {
        self.entities.push((layer, Item::Text { at, height, text: text.into() }));
    }

    /// Running text that wraps at a width; `at` is its upper left corner.
    pub fn mtext(&mut self, layer: &'static str, at: Point, height: f64, width: f64, text: &str) {
        self.entities.push((layer, Item::MText { at, height, width, text: text.into() }));
    }

    /// The file.
    pub fn write(&self) -> String {
        let newline = if self.version == Version::R12 { "\r\n" } else { "\n" };
        let mut out = Out { text: String::new(), newline };
        match self.version {
            Version::R12 => self.write_r12(&mut out),
            Version::R2010 => self.write_r2010(&mut out),
        }
        out.put(0, "EOF");
        out.text
    }

    /// Lower left and upper right corner of all that is drawn.
    fn extent(&self) -> (Point, Point) {
        let mut corners = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        let mut grow = |(x, y): Point, by: f64| {
            corners.0 = (corners.0.0.min(x - by), corners.0.1.min(y - by));
            corners.1 = (corners.1.0.max(x + by), corners.1.1.max(y + by));
        };
        for (_, item) in &self.entities {
            match item {
                Item::Line(a, b) => [a, b].into_iter().for_each(|p| grow(*p, 0.0)),
                Item::Poly { points, .. } => points.iter().for_each(|p| grow(*p, 0.0)),
                Item::Circle(centre, radius) => grow(*centre, *radius),
                Item::Text { at, .. } | Item::MText { at, .. } => grow(*at, 0.0),
            }
        }
        corners
    }

    fn write_header(&self, out: &mut Out, version: &str, handseed: Option<&str>) {
        let (low, high) = self.extent();
        out.put(0, "SECTION");
        out.put(2, "HEADER");
        out.put(9, "$ACADVER");
        out.put(1, version);
        if let Some(handseed) = handseed {
            out.put(9, "$HANDSEED");
            out.put(5, handseed);
        }
        if let Some(insunits) = self.insunits {
            out.put(9, "$INSUNITS");
            out.put(70, insunits);
        }
        out.put(9, "$EXTMIN");
        out.point_3d(10, low);
        out.put(9, "$EXTMAX");
        out.point_3d(10, high);
        out.put(0, "ENDSEC");
    }

    fn write_r12(&self, out: &mut Out) {
        self.write_header(out, "AC1009", None);
        out.put(0, "SECTION");
        out.put(2, "TABLES");
        table_head(out, "LTYPE", 1, None);
        out.put(0, "LTYPE");
        line_type(out, "CONTINUOUS", "Solid line");
        out.put(0, "ENDTAB");
        table_head(out, "LAYER", self.all_layers().count(), None);
        for (name, colour) in self.all_layers() {
            out.put(0, "LAYER");
            out.put(2, name);
            out.put(70, 0);
            out.put(62, colour);
            out.put(6, "CONTINUOUS");
        }
        out.put(0, "ENDTAB");
        table_head(out, "STYLE", 1, None);
        out.put(0, "STYLE");
        text_style(out, "STANDARD");
        out.put(0, "ENDTAB");
        out.put(0, "ENDSEC");
        out.put(0, "SECTION");
        out.put(2, "BLOCKS");
        out.put(0, "ENDSEC");
        out.put(0, "SECTION");
        out.put(2, "ENTITIES");
        for (layer, item) in &self.entities {
            write_r12_entity(out, layer, item);
        }
        out.put(0, "ENDSEC");
    }

    fn all_layers(&self) -> impl Iterator<Item = (&'static str, i32)> {
        std::iter::once(("0", 7)).chain(self.layers.iter().copied())
    }

    fn write_r2010(&self, out: &mut Out) {
        // The body first: only then is the next free handle known, which the header must state.
        let mut body = Out { text: String::new(), newline: out.newline };
        let mut handles = Handles { next: 0x10 };
        let blocks = [("*Model_Space", handles.take()), ("*Paper_Space", handles.take())];
        let layouts = [handles.take(), handles.take()];
        self.write_tables(&mut body, &mut handles, &blocks, &layouts);
        write_blocks(&mut body, &mut handles, &blocks);
        body.put(0, "SECTION");
        body.put(2, "ENTITIES");
        for (layer, item) in &self.entities {
            write_r2010_entity(&mut body, &handles.take(), &blocks[0].1, layer, item);
        }
        body.put(0, "ENDSEC");
        write_objects(&mut body, &mut handles, &blocks, &layouts, self.extent());
        self.write_header(out, "AC1024", Some(&handles.take()));
        out.put(0, "SECTION");
        out.put(2, "CLASSES");
        out.put(0, "ENDSEC");
        out.text.push_str(&body.text);
    }

    fn write_tables(
        &self,
        out: &mut Out,
        handles: &mut Handles,
        blocks: &[(&str, String); 2],
        layouts: &[String; 2],
    ) {
        out.put(0, "SECTION");
        out.put(2, "TABLES");
        self.write_viewport(out, handles);
        let types = [("ByBlock", ""), ("ByLayer", ""), ("Continuous", "Solid line")];
        table(out, handles, "LTYPE", "AcDbLinetypeTableRecord", &types, |out, (name, words)| {
            line_type(out, name, words);
        });
        let layers: Vec<_> = self.all_layers().collect();
        table(out, handles, "LAYER", "AcDbLayerTableRecord", &layers, |out, &(name, colour)| {
            out.put(2, name);
            out.put(70, 0);
            out.put(62, colour);
            out.put(6, "Continuous");
            out.put(370, -3);
            out.put(390, PLOT_STYLE_NORMAL);
        });
        table(out, handles, "STYLE", "AcDbTextStyleTableRecord", &["Standard"], |out, name| {
            text_style(out, name);
        });
        table(out, handles, "VIEW", "", &[] as &[&str], |_, _| ());
        table(out, handles, "UCS", "", &[] as &[&str], |_, _| ());
        table(out, handles, "APPID", "AcDbRegAppTableRecord", &["ACAD"], |out, name| {
            out.put(2, name);
            out.put(70, 0);
        });
        write_dimension_styles(out, handles);
        let table_handle = handles.take();
        table_head(out, "BLOCK_RECORD", 2, Some(&table_handle));
        for ((name, handle), layout) in blocks.iter().zip(layouts) {
            record_head(out, "BLOCK_RECORD", 5, handle, &table_handle, "AcDbBlockTableRecord");
            out.put(2, name);
            out.put(340, layout);
            out.put(70, 0);
            out.put(280, 1);
            out.put(281, 0);
        }
        out.put(0, "ENDTAB");
        out.put(0, "ENDSEC");
    }

    fn write_viewport(&self, out: &mut Out, handles: &mut Handles) {
        let ((x0, y0), (x1, y1)) = self.extent();
        table(out, handles, "VPORT", "AcDbViewportTableRecord", &["*Active"], |out, name| {
            out.put(2, name);
            out.put(70, 0);
            out.point(10, (0.0, 0.0));
            out.point(11, (1.0, 1.0));
            out.point(12, (0.5 * (x0 + x1), 0.5 * (y0 + y1)));
            out.point_3d(16, (0.0, 0.0));
            out.point_3d(17, (0.0, 0.0));
            out.number(40, 1.1 * (y1 - y0).max((x1 - x0) / 1.6));
            out.number(41, 1.6);
        });
    }
}

fn table_head(out: &mut Out, kind: &str, count: usize, handle: Option<&str>) {
    out.put(0, "TABLE");
    out.put(2, kind);
    if let Some(handle) = handle {
        out.put(5, handle);
        out.put(330, "0");
        out.put(100, "AcDbSymbolTable");
    }
    out.put(70, count);
}

fn record_head(out: &mut Out, kind: &str, handle_code: u32, handle: &str, owner: &str, class: &str) {
    out.put(0, kind);
    out.put(handle_code, handle);
    out.put(330, owner);
    out.put(100, "AcDbSymbolTableRecord");
    out.put(100, class);
}

/// A table of records that need nothing but a handle each.
fn table<T>(
    out: &mut Out,
    handles: &mut Handles,
    kind: &str,
    class: &str,
    records: &[T],
    write: impl Fn(&mut Out, &T),
) {
    let table_handle = handles.take();
    table_head(out, kind, records.len(), Some(&table_handle));
    for record in records {
        record_head(out, kind, 5, &handles.take(), &table_handle, class);
        write(out, record);
    }
    out.put(0, "ENDTAB");
}

fn line_type(out: &mut Out, name: &str, words: &str) {
    out.put(2, name);
    out.put(70, 0);
    out.put(3, words);
    out.put(72, 65);
    out.put(73, 0);
    out.number(40, 0.0);
}

fn text_style(out: &mut Out, name: &str) {
    out.put(2, name);
    out.put(70, 0);
    out.number(40, 0.0);
    out.number(41, 1.0);
    out.number(50, 0.0);
    out.put(71, 0);
    out.number(42, 1.0);
    out.put(3, "txt");
    out.put(4, "");
}

/// The one table with a subclass of its own and handles under code 105.
fn write_dimension_styles(out: &mut Out, handles: &mut Handles) {
    let table_handle = handles.take();
    table_head(out, "DIMSTYLE", 1, Some(&table_handle));
    out.put(100, "AcDbDimStyleTable");
    out.put(71, 0);
    record_head(out, "DIMSTYLE", 105, &handles.take(), &table_handle, "AcDbDimStyleTableRecord");
    out.put(2, "Standard");
    out.put(70, 0);
    out.put(0, "ENDTAB");
}

fn write_blocks(out: &mut Out, handles: &mut Handles, blocks: &[(&str, String); 2]) {
    out.put(0, "SECTION");
    out.put(2, "BLOCKS");
    for (k, (name, owner)) in blocks.iter().enumerate() {
        let mut head = |out: &mut Out, kind: &str, class: &str| {
            entity_head(out, kind, &handles.take(), owner, k == 1, "0");
            out.put(100, class);
        };
        head(out, "BLOCK", "AcDbBlockBegin");
        out.put(2, name);
        out.put(70, 0);
        out.point_3d(10, (0.0, 0.0));
        out.put(3, name);
        out.put(1, "");
        head(out, "ENDBLK", "AcDbBlockEnd");
    }
    out.put(0, "ENDSEC");
}

fn entity_head(out: &mut Out, kind: &str, handle: &str, owner: &str, is_paper: bool, layer: &str) {
    out.put(0, kind);
    out.put(5, handle);
    out.put(330, owner);
    out.put(100, "AcDbEntity");
    if is_paper {
        out.put(67, 1);
    }
    out.put(8, layer);
}

fn write_r2010_entity(out: &mut Out, handle: &str, owner: &str, layer: &str, item: &Item) {
    let mut head = |kind, class| {
        entity_head(out, kind, handle, owner, false, layer);
        out.put(100, class);
    };
    match item {
        Item::Line(a, b) => {
            head("LINE", "AcDbLine");
            out.point_3d(10, *a);
            out.point_3d(11, *b);
        }
        Item::Poly { points, is_closed } => {
            head("LWPOLYLINE", "AcDbPolyline");
            out.put(90, points.len());
            out.put(70, u8::from(*is_closed));
            points.iter().for_each(|&p| out.point(10, p));
        }
        Item::Circle(centre, radius) => {
            head("CIRCLE", "AcDbCircle");
            out.point_3d(10, *centre);
            out.number(40, *radius);
        }
        Item::Text { at, height, text } => {
            head("TEXT", "AcDbText");
            out.point_3d(10, *at);
            out.number(40, *height);
            out.put(1, text);
            out.put(100, "AcDbText");
        }
        Item::MText { at, height, width, text } => {
            head("MTEXT", "AcDbMText");
            out.point_3d(10, *at);
            out.number(40, *height);
            out.number(41, *width);
            out.put(71, 1);
            out.put(72, 1);
            // At most 250 characters a line; all pieces but the last have code 3.
            let mut rest = text.as_str();
            while rest.len() > 250 {
                let (piece, tail) = rest.split_at(250);
                out.put(3, piece);
                rest = tail;
            }
            out.put(1, rest);
        }
    }
}

fn write_r12_entity(out: &mut Out, layer: &str, item: &Item) {
    let mut head = |kind| {
        out.put(0, kind);
        out.put(8, layer);
    };
    match item {
        Item::Line(a, b) => {
            head("LINE");
            out.point_3d(10, *a);
            out.point_3d(11, *b);
        }
        Item::Poly { points, is_closed } => {
            head("POLYLINE");
            out.put(66, 1);
            out.point_3d(10, (0.0, 0.0));
            out.put(70, u8::from(*is_closed));
            for &p in points {
                out.put(0, "VERTEX");
                out.put(8, layer);
                out.point_3d(10, p);
            }
            out.put(0, "SEQEND");
            out.put(8, layer);
        }
        Item::Circle(centre, radius) => {
            head("CIRCLE");
            out.point_3d(10, *centre);
            out.number(40, *radius);
        }
        Item::Text { at, height, text } | Item::MText { at, height, text, .. } => {
            head("TEXT");
            out.point_3d(10, *at);
            out.number(40, *height);
            out.put(1, text);
        }
    }
}

/// The named-object dictionary with both layouts.
fn write_objects(
    out: &mut Out,
    handles: &mut Handles,
    blocks: &[(&str, String); 2],
    layouts: &[String; 2],
    extent: (Point, Point),
) {
    let [root, groups, layout_list] = [handles.take(), handles.take(), handles.take()];
    out.put(0, "SECTION");
    out.put(2, "OBJECTS");
    let names = ["Model", "Layout1"];
    let entries =
        [("ACAD_GROUP", &*groups), ("ACAD_LAYOUT", &layout_list), ("ACAD_PLOTSTYLENAME", PLOT_STYLES)];
    dictionary(out, &root, "0", &entries);
    dictionary(out, &groups, &root, &[]);
    dictionary(out, &layout_list, &root, &[(names[1], &layouts[1]), (names[0], &layouts[0])]);
    write_plot_styles(out, &root);
    for k in 0..2 {
        out.put(0, "LAYOUT");
        out.put(5, &layouts[k]);
        out.put(330, &layout_list);
        out.put(100, "AcDbPlotSettings");
        out.put(1, "");
        out.put(70, if k == 0 { 1024 } else { 0 });
        out.put(100, "AcDbLayout");
        out.put(1, names[k]);
        out.put(70, 1);
        out.put(71, k);
        out.point_3d(14, extent.0);
        out.point_3d(15, extent.1);
        out.put(330, &blocks[k].1);
    }
    out.put(0, "ENDSEC");
}

fn write_plot_styles(out: &mut Out, root: &str) {
    out.put(0, "ACDBDICTIONARYWDFLT");
    out.put(5, PLOT_STYLES);
    out.put(330, root);
    out.put(100, "AcDbDictionary");
    out.put(281, 1);
    out.put(3, "Normal");
    out.put(350, PLOT_STYLE_NORMAL);
    out.put(100, "AcDbDictionaryWithDefault");
    out.put(340, PLOT_STYLE_NORMAL);
    out.put(0, "ACDBPLACEHOLDER");
    out.put(5, PLOT_STYLE_NORMAL);
    out.put(330, PLOT_STYLES);
}

fn dictionary(out: &mut Out, handle: &str, owner: &str, entries: &[(&str, &str)]) {
    out.put(0, "DICTIONARY");
    out.put(5, handle);
    out.put(330, owner);
    out.put(100, "AcDbDictionary");
    out.put(281, 1);
    for (name, target) in entries {
        out.put(3, name);
        out.put(350, target);
    }
}
