//! A file's bytes to a [`Drawing`].

use super::ReadOptions;
use super::blocks::Blocks;
use super::complete::{Completeness, foreign, is_complete};
use super::entity::Body;
use super::header::Header;
use super::heights::{Heights, is_raised, is_thick};
use super::reader::Reader;
use super::storeys::Storeys;
use super::tokens::{Fault, Form, Tokens, tokenize};
use super::uncut::Uncut;
use crate::drawing::{Drawing, Entity, Format, IdleMarks, Text};
use crate::own_layers::is_own;
use crate::storeys::StoreyInfo;
use enfilade_report::{Error, Place, Report, Severity};

/// Reads a drawing; of storeys that are drawn over one another, each at its own height, one.
///
/// `file` is the name to show in places. Entities come out in file order, blocks unfolded, in drawing
/// units. What is odd but harmless goes to `report`; entities that cannot be trusted are left out there
/// by name and stay in the file.
///
/// # Errors
/// [`Error::Input`] where the bytes are no whole DXF: empty, cut off, another format, UTF-16, a group
/// code or number that cannot be read, a limit of [`Limits`](super::Limits) passed. [`Error::Usage`] for a storey that is
/// not there, where there are several.
pub fn read(file: &str, bytes: &[u8], options: &ReadOptions, report: &mut Report) -> Result<Drawing, Error> {
    let (mut drawing, storeys, uncut) = with_storeys(file, bytes, options, report)?;
    let chosen = storeys.as_ref().and_then(|s| s.chosen(options.storey.as_deref()));
    if let Some(storeys) = storeys {
        storeys.keep_one(&mut drawing, options.storey.as_deref(), report)?;
    }
    uncut.report(file, chosen.unwrap_or(0), report);
    Ok(drawing)
}

/// The storeys that are drawn over one another, each at its own height, from the lowest; none where all is one storey or the
/// bytes cannot be read.
pub fn storeys(file: &str, bytes: &[u8], options: &ReadOptions) -> Vec<StoreyInfo> {
    let found = tokenize(bytes, &options.limits).ok().and_then(|t| raised(file, bytes, &t, options));
    found.map_or_else(Vec::new, |storeys| storeys.list)
}

/// Height of the floor that is read of a drawing with storeys, drawing units; 0 of any other. `tokens`: its pairs.
pub(super) fn floor_of(file: &str, bytes: &[u8], tokens: &Tokens<'_>, options: &ReadOptions) -> f64 {
    raised(file, bytes, tokens, options).and_then(|s| s.floor(options.storey.as_deref())).unwrap_or(0.0)
}

/// The storeys of a drawing; all of it is read only where its pairs state a height.
fn raised(file: &str, bytes: &[u8], tokens: &Tokens<'_>, options: &ReadOptions) -> Option<Storeys> {
    is_raised(tokens).then(|| with_storeys(file, bytes, options, &mut Report::default()).ok())??.1
}

/// Reads all of a drawing, which storeys it has, and what of its walls is not cut.
fn with_storeys(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    report: &mut Report,
) -> Result<(Drawing, Option<Storeys>, Uncut), Error> {
    let tokens = checked_tokens(file, bytes, options, report)?;
    let header = Header::read(&tokens);
    let mut reader = Reader::new(file, &tokens, &header, options, report);
    reader.read_layers();
    let Some(section) = tokens.section(b"ENTITIES") else {
        let text = "its sections, found no ENTITIES, expected one with the drawn entities; not read";
        return Err(Error::input("dxf-no-entities", Place::file(file), text));
    };
    let items = reader.items(section.clone())?;
    let mut blocks = Blocks::find(&reader)?;
    blocks.measure(&mut reader, &items)?;
    reader.freeze_by_viewports(blocks.extent());
    let (mut entities, mut texts) =
        (Vec::with_capacity(items.len().min(options.limits.max_entities)), Vec::new());
    let mut tags: Vec<Text> = Vec::new();
    for item in items {
        refuse_many(file, entities.len() + reader.fills.len(), options)?;
        if let Body::Insert(_) = item.body {
            let shown = reader.tags(item.record, item.layer).into_iter();
            let (marks, others): (Vec<Text>, Vec<Text>) = shown.partition(|t| is_own(&t.layer));
            texts.extend(marks);
            tags.extend(others);
            blocks.show(&mut reader, &item, (&mut entities, &mut texts))?;
            continue;
        }
        let source = reader.source(item.record, item.layer);
        let layer = source.layer.clone();
        match item.body {
            Body::Shape(shape, editable) => {
                let origin = reader.origin(item.record);
                entities.push(Entity { source, layer, shape, editable, blocks: Vec::new(), origin });
            }
            Body::Text(at, text) => texts.push(Text { source, layer, at, text }),
            Body::Fill(shape) => {
                let origin = reader.origin(item.record);
                reader.add_fill((source, origin), layer, shape, Vec::new());
            }
            Body::Insert(_) => {}
        }
    }
    refuse_many(file, entities.len() + reader.fills.len(), options)?;
    reader.note_hidden(&entities);
    let undrawn = reader.take_undrawn();
    let mut written = reader.written(section, &blocks)?;
    written.is_metric = header.measurement.map(|m| m != 0);
    reader.report_left_out();
    reader.finish_notes();
    reader.records.sort_unstable_by_key(|r| r.record);
    let mut drawing = Drawing {
        file: file.to_owned(),
        format: Format::Dxf,
        version: header.version_words(),
        declared_unit: header.unit(),
        declared_unit_words: header.unit_words(),
        unit_by_heights: None,
        layers: reader.layers.list,
        entities,
        fills: reader.fills,
        texts,
        marked: Vec::new(),
        idle_marks: IdleMarks::None,
        hosts: Default::default(),
        slots: Vec::new(),
        bearing: Default::default(),
        things: Vec::new(),
        tags,
        called: Vec::new(),
        widths: reader.widths,
        singles: Default::default(),
        north_deg: 0.0,
        wishes: Vec::new(),
        built: Default::default(),
        undrawn,
        unbound: reader.unbound,
        records: reader.records,
        written,
    };
    let (is_raised, is_thick) = (is_raised(&tokens), is_thick(&tokens));
    if !is_raised && !is_thick {
        return Ok((drawing, None, Uncut::default()));
    }
    let unit = options.unit_of_heights.or(options.unit).or(header.unit());
    let mut heights = Heights::new(&tokens, &blocks);
    let mut storeys = if is_raised { Storeys::of(&drawing, &mut heights, unit) } else { None };
    let cut = (unit, options.sight.above_m());
    let uncut = Uncut::take(&mut drawing, storeys.as_mut(), &mut heights, cut);
    Ok((drawing, storeys, uncut))
}

/// The pairs of a file that is whole, or the reason it is not taken.
fn checked_tokens<'a>(
    file: &str,
    bytes: &'a [u8],
    options: &ReadOptions,
    report: &mut Report,
) -> Result<Tokens<'a>, Error> {
    if let Some((code, text)) = foreign(bytes) {
        return Err(Error::input(code, Place::file(file), text));
    }
    match is_complete(bytes) {
        Completeness::Whole => {}
        Completeness::Empty => {
            let found = match bytes.len() {
                0 => "0 bytes".to_owned(),
                n => format!("{n} bytes, all of them blanks"),
            };
            let text = format!("the file is empty, found {found}, expected a DXF drawing; nothing was read");
            return Err(Error::input("dxf-empty", Place::file(file), text));
        }
        Completeness::Incomplete(reason) if !options.accept_missing_eof => {
            return Err(Error::input("dxf-incomplete", end_of(file, bytes), incomplete_words(&reason)));
        }
        Completeness::Incomplete(_) => {}
    }
    let tokens =
        tokenize(bytes, &options.limits).map_err(|fault| fault_error(file, bytes, fault, options))?;
    if !tokens.has_eof {
        if !options.accept_missing_eof {
            let reason = "no 0/EOF where a group code stands";
            return Err(Error::input("dxf-incomplete", end_of(file, bytes), incomplete_words(reason)));
        }
        let place = tokens.place(file, tokens.pairs.len());
        let text =
            "its end, found no 0/EOF, expected one; read nevertheless because accept_missing_eof is set";
        report.warn("dxf-missing-eof", place, text);
    }
    let tail = &bytes[tokens.end..];
    if tokens.has_eof && tail.iter().any(|b| !b.is_ascii_whitespace() && *b != 0x1a) {
        let place = tokens.place(file, tokens.pairs.len());
        let text = format!(
            "after 0/EOF, found {} more bytes, expected none; not read, kept in every output",
            tail.len()
        );
        report.warn("dxf-bytes-after-eof", place, text);
    }
    Ok(tokens)
}

fn incomplete_words(reason: &str) -> String {
    format!(
        "the drawing is incomplete: {reason}, expected 0/EOF at the end; not read. Save or export it again; if \
         its program never writes EOF, say --accept-missing-eof or set accept-missing-eof = true"
    )
}

/// The last line of a file that holds anything; of a binary one its end.
fn end_of(file: &str, bytes: &[u8]) -> Place {
    if super::tokens::form_of(bytes) != Form::Ascii || super::tokens::BINARY_SENTINEL.starts_with(bytes) {
        return Place::file(file).entity(format!("byte {}", bytes.len()));
    }
    Place::line(file, super::tokens::lines_of(bytes.trim_ascii_end()))
}

/// A tokeniser's complaint with its place.
pub(super) fn fault_error(file: &str, bytes: &[u8], fault: Fault, options: &ReadOptions) -> Error {
    let is_ascii = super::tokens::form_of(bytes) == Form::Ascii;
    let place = |pair: usize, byte: usize, line: usize| {
        let entity = if is_ascii { String::new() } else { format!("byte {byte}") };
        Place { file: file.into(), line: is_ascii.then_some(2 * pair + line), entity }
    };
    match fault {
        // A value too few or too many shifts codes and values, which shows here at the latest.
        Fault::GroupCode { pair, byte, text } if text == "EOF" => {
            fault_error(file, bytes, Fault::OddLines { pair, byte }, options)
        }
        Fault::GroupCode { pair, byte, text } => Error::input(
            "dxf-group-code",
            place(pair, byte, 1),
            format!(
                "the group code, found `{text}`, expected a whole number from -5 to 1071; the file was not read, \
                 because nothing after this line is sure. A text of several lines or a hand edit does this: export \
                 the drawing again"
            ),
        ),
        Fault::OddLines { pair, byte } => Error::input(
            "dxf-odd-lines",
            place(pair, byte, 1),
            "the last line, found an odd number of lines, expected pairs of group code and value; not read. Save or \
             export the drawing again",
        ),
        Fault::LongLine { pair, bytes } => Error::input(
            "dxf-line-too-long",
            place(pair, 0, 2),
            format!(
                "a value, found {bytes} bytes in one line, expected at most {} (MAX_LINE_BYTES); not read",
                options.limits.max_line_bytes
            ),
        ),
        Fault::TooMany { what, most, limit } => too_many(file, what, most, limit),
        Fault::TooBig => Error::input(
            "dxf-file-too-big",
            Place::file(file),
            format!(
                "its size, found {} bytes, expected at most {} (MAX_FILE_BYTES); not read",
                bytes.len(),
                options.limits.max_file_bytes
            ),
        ),
    }
}

/// Refuses more entities than the limit before the next is added.
fn refuse_many(file: &str, count: usize, options: &ReadOptions) -> Result<(), Error> {
    let most = options.limits.max_entities;
    let what = "entities, those of blocks as often as they are shown";
    if count > most { Err(too_many(file, what, most, "MAX_ENTITIES")) } else { Ok(()) }
}

fn too_many(file: &str, what: &str, most: usize, limit: &str) -> Error {
    let text = format!(
        "its {what}, found more than {most}, expected at most {most} ({limit}); not read. Export the plan alone, \
         without hatches and symbols that are drawn line by line"
    );
    Error::input("dxf-too-many", Place::file(file), text)
}

/// Geometry that may be a wall and that this reader does not draw.
const SOLID_KINDS: [&str; 12] = [
    "3DFACE",
    "3DSOLID",
    "BODY",
    "REGION",
    "MESH",
    "SURFACE",
    "EXTRUDEDSURFACE",
    "LOFTEDSURFACE",
    "NURBSURFACE",
    "PLANESURFACE",
    "REVOLVEDSURFACE",
    "SWEPTSURFACE",
];

/// Whether a record is an object of a vertical product, which only that product can draw.
fn is_proxy(kind: &str) -> bool {
    ["ACAD_PROXY_ENTITY", "AEC_", "AECC_", "AECB_", "TCH_", "TDB"].iter().any(|name| kind.starts_with(name))
}

impl Reader<'_, '_> {
    /// Reports the kinds of records that were not drawn.
    fn report_left_out(&mut self) {
        let kinds = std::mem::take(&mut self.left_out);
        let listed = |pick: &dyn Fn(&str) -> bool| {
            let words = kinds.iter().filter(|(kind, _)| pick(kind)).map(|(kind, n)| format!("{kind} ({n})"));
            words.collect::<Vec<_>>().join(", ")
        };
        let is_solid = |kind: &str| SOLID_KINDS.contains(&kind);
        let groups: [(&'static str, Severity, String, &str); 3] = [
            (
                "dxf-proxy",
                Severity::Warning,
                listed(&is_proxy),
                "objects that only their own program can draw; left out of the plan, kept in the file. If walls \
                 are among them, export with AECTOACAD or as plain DXF",
            ),
            ("dxf-solid", Severity::Warning, listed(&is_solid), "left out of the plan, kept in the file"),
            (
                "dxf-kinds-left-out",
                Severity::Info,
                listed(&|kind| !is_proxy(kind) && !is_solid(kind)),
                "not lines of a plan; not used, kept in the file",
            ),
        ];
        for (code, severity, words, what) in groups {
            if !words.is_empty() {
                self.note_file(code, severity, format!("{words}: {what}"));
            }
        }
    }
}
