//! What we add to a building: annotations on layers of ours, and property sets that say what moved.

use std::collections::BTreeMap;

use glam::DVec2;
use sha2::{Digest, Sha256};

use super::ReadOptions;
use super::building::Building;
use super::geo::is_upright;
use super::length::Figures;
use super::number::real;
use super::rooms::Room;
use super::step::Arg;
use crate::drawing::{Addition, Edit, Mark, RigidMotion};
use crate::step_text::encode;
use enfilade_report::{Error, Report, counted};

/// Additions lie this far above the floor, so that the floor does not hide them.
const LIFT_M: f64 = 0.02;

/// Bits of a colour that are told apart where every colour needs a style of its own.
const COLOUR_MASK: u8 = 0xF0;

/// The instances of our additions, numbered from `next`.
pub(super) fn text(
    building: &Building<'_, '_>,
    options: &ReadOptions,
    next: u64,
    (edits, rooms, figures): (&[Edit], &[Room], &Figures),
    own: &[Addition],
) -> Result<Vec<u8>, Error> {
    let storey = building.storey(options.storey.as_deref(), options.sight, &mut Report::default())?;
    let lift = LIFT_M / building.geo.metres;
    let mut writer = Writer::new(building, next, storey.map_or(0.0, |s| s.floor) + lift);
    let mut by_layer: BTreeMap<&str, Vec<&Addition>> = BTreeMap::new();
    for addition in own {
        by_layer.entry(&addition.layer).or_default().push(addition);
    }
    for (layer, list) in by_layer {
        writer.annotation(layer, &list);
    }
    let host = storey.map(|s| s.id).or_else(|| building.step.all("IFCBUILDING").next().map(|i| i.id));
    writer.tie(host);
    if let Some(host) = host {
        writer.note(host, own);
    }
    let mut told: BTreeMap<u64, Vec<(&str, String)>> = BTreeMap::new();
    for edit in edits {
        let id = edit.record() as u64;
        told.entry(id).or_default().extend(match edit {
            Edit::Insert { motion, .. } => writer.moved(id, motion),
            Edit::Ends { by, .. } => lengthened(*by),
            Edit::Shape { .. } | Edit::Points { .. } | Edit::Work { .. } => Vec::new(),
        });
    }
    for (id, names) in figures {
        told.entry(*id).or_default().push(("Stale", format!("IFCTEXT({})", encode(&names.join(", ")))));
    }
    for (id, values) in told.into_iter().filter(|t| !t.1.is_empty()) {
        writer.properties(id, &values);
    }
    for room in rooms {
        writer.properties(room.id, &of_room(room));
    }
    Ok(writer.out)
}

/// Whether the outline of a room follows its walls, and which of its figures do not.
fn of_room(room: &Room) -> Vec<(&'static str, String)> {
    let text = |words: &str| format!("IFCTEXT({})", encode(words));
    let mut out = vec![(
        "Outline",
        match &room.outlines {
            Ok(_) => text("follows its walls"),
            Err(why) => text(&format!("as drawn: {why}")),
        },
    )];
    let mut stale = room.quantities.clone();
    if room.boundaries > 0 {
        stale.push(counted(room.boundaries as u64, "boundary surface"));
    }
    if !stale.is_empty() {
        out.push(("Stale", text(&stale.join(", "))));
    }
    out
}

/// An owner history to share, `$` where the file has none.
fn history(b: &Building<'_, '_>) -> String {
    b.step.all("IFCOWNERHISTORY").next().map_or("$".into(), |i| format!("#{}", i.id))
}

/// The context of the first body.
fn context(b: &Building<'_, '_>) -> Option<u64> {
    let of = |i: &super::step::Instance| {
        let args = b.step.args_of(i);
        let is_body = args.get(1).and_then(|a| b.step.text(a)).is_some_and(|t| t == "Body");
        args.first().and_then(Arg::id).filter(|_| is_body)
    };
    b.step.all("IFCSHAPEREPRESENTATION").find_map(of)
}

/// Writes instances as the file writes them.
pub(super) struct Writer<'b, 's, 'a> {
    pub(super) b: &'b Building<'s, 'a>,
    next: u64,
    out: Vec<u8>,
    /// Height of what is written, file units.
    pub(super) z: f64,
    /// The owner history to share.
    pub(super) history: String,
    /// The context of bodies.
    pub(super) context: Option<u64>,
    made: Vec<u64>,
    /// Relation of a type → what is new of that type.
    pub(super) of_types: BTreeMap<u64, Vec<u64>>,
}

impl<'b, 's, 'a> Writer<'b, 's, 'a> {
    /// A writer whose first instance has the number `next`.
    pub(super) fn new(b: &'b Building<'s, 'a>, next: u64, z: f64) -> Self {
        let (history, context) = (history(b), context(b));
        Self { b, next, out: Vec::new(), z, history, context, made: Vec::new(), of_types: BTreeMap::new() }
    }

    /// What was written, and the next free number.
    pub(super) fn into_parts(self) -> (Vec<u8>, u64) {
        (self.out, self.next)
    }
}

impl Writer<'_, '_, '_> {
    /// Adds an instance; its number.
    pub(super) fn add(&mut self, text: &str) -> u64 {
        let id = self.next;
        self.next += 1;
        self.out.extend_from_slice(format!("#{id}={text};").as_bytes());
        self.out.extend_from_slice(super::line_end(self.b.step.bytes));
        id
    }

    /// A `GlobalId` that depends on nothing but the file and what it stands for.
    pub(super) fn global_id(&self, what: &str) -> String {
        let mut hash = Sha256::new();
        hash.update(what.as_bytes());
        hash.update(self.next.to_le_bytes());
        hash.update(self.b.step.bytes.len().to_le_bytes());
        let digest = hash.finalize();
        let bits = digest.iter().take(16).fold(0u128, |sum, b| sum << 8 | u128::from(*b));
        let letters = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$";
        let letter = |i: u32| char::from(letters[(bits >> (6 * i)) as usize & 63]);
        (0..22)
            .rev()
            .map(|i| if i == 21 { char::from(letters[(bits >> 126) as usize & 3]) } else { letter(i) })
            .collect()
    }

    fn point(&mut self, p: DVec2) -> u64 {
        let z = self.z;
        self.add(&format!("IFCCARTESIANPOINT(({},{},{}))", real(p.x), real(p.y), real(z)))
    }

    pub(super) fn is_old(&self) -> bool {
        self.b.step.schema.starts_with("IFC2")
    }

    fn annotation(&mut self, layer: &str, list: &[&Addition]) {
        let Some(context) = self.context else { return };
        let fills: Vec<([DVec2; 4], [u8; 3])> = list
            .iter()
            .filter_map(|a| if let Mark::Fill { corners } = &a.mark { Some((*corners, a.rgb)) } else { None })
            .collect();
        let mut representations = Vec::new();
        if !fills.is_empty() {
            let (kind, items) = if self.is_old() {
                ("SurfaceModel", self.old_faces(&fills))
            } else {
                ("Tessellation", vec![self.faces(&fills)])
            };
            representations.push(self.representation(context, "Body", kind, &items));
        }
        let curves = self.curves(list);
        if !curves.is_empty() {
            let set = self.add(&format!("IFCGEOMETRICCURVESET({})", refs(&curves)));
            representations.push(self.representation(context, "Annotation", "GeometricCurveSet", &[set]));
        }
        let texts = self.texts(list);
        if !texts.is_empty() {
            representations.push(self.representation(context, "Annotation", "Annotation2D", &texts));
        }
        if representations.is_empty() {
            return;
        }
        self.add(&format!(
            "IFCPRESENTATIONLAYERASSIGNMENT({},$,{},$)",
            encode(layer),
            refs(&representations)
        ));
        let shape = self.add(&format!("IFCPRODUCTDEFINITIONSHAPE($,$,{})", refs(&representations)));
        let origin = self.add("IFCCARTESIANPOINT((0.,0.,0.))");
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{origin},$,$)"));
        let placement = self.add(&format!("IFCLOCALPLACEMENT($,#{axes})"));
        let (gid, history) = (self.global_id(layer), self.history.clone());
        let last = if self.b.step.schema.starts_with("IFC4X") { ",$" } else { "" };
        let made = self.add(&format!(
            "IFCANNOTATION('{gid}',{history},{},$,'ENFILADE',#{placement},#{shape}{last})",
            encode(layer)
        ));
        self.made.push(made);
    }

    fn representation(&mut self, context: u64, name: &str, kind: &str, items: &[u64]) -> u64 {
        self.add(&format!("IFCSHAPEREPRESENTATION(#{context},'{name}','{kind}',{})", refs(items)))
    }

    /// One face set with a colour for every triangle.
    fn faces(&mut self, fills: &[([DVec2; 4], [u8; 3])]) -> u64 {
        let z = real(self.z);
        let (mut points, mut corners, mut indices) = (Vec::new(), Vec::new(), Vec::new());
        let mut colours: Vec<[u8; 3]> = Vec::new();
        for (i, (quad, rgb)) in fills.iter().enumerate() {
            points.extend(quad.iter().map(|p| format!("({},{},{z})", real(p.x), real(p.y))));
            let n = 4 * i + 1;
            corners.push(format!("({n},{},{}),({n},{},{})", n + 1, n + 2, n + 2, n + 3));
            let colour = colours.iter().position(|c| c == rgb).unwrap_or(colours.len());
            if colour == colours.len() {
                colours.push(*rgb);
            }
            indices.push(format!("{0},{0}", colour + 1));
        }
        let extra = if self.b.step.schema.starts_with("IFC4X") { ",$" } else { "" };
        let list = self.add(&format!("IFCCARTESIANPOINTLIST3D(({}){extra})", points.join(",")));
        let set = self.add(&format!("IFCTRIANGULATEDFACESET(#{list},$,.F.,({}),$)", corners.join(",")));
        let shown: Vec<String> = colours.iter().map(|c| format!("({})", ratios(*c))).collect();
        let map = self.add(&format!("IFCCOLOURRGBLIST(({}))", shown.join(",")));
        self.add(&format!("IFCINDEXEDCOLOURMAP(#{set},$,#{map},({}))", indices.join(",")));
        set
    }

    /// One surface a colour, for the schema without coloured face sets.
    fn old_faces(&mut self, fills: &[([DVec2; 4], [u8; 3])]) -> Vec<u64> {
        let mut by_colour: BTreeMap<[u8; 3], Vec<[DVec2; 4]>> = BTreeMap::new();
        for (quad, rgb) in fills {
            by_colour.entry(rgb.map(|c| c & COLOUR_MASK | 0x08)).or_default().push(*quad);
        }
        let mut out = Vec::new();
        for (rgb, quads) in by_colour {
            let mut faces = Vec::new();
            for quad in quads {
                let points = quad.map(|p| self.point(p));
                let ring = self.add(&format!("IFCPOLYLOOP({})", refs(&points)));
                let bound = self.add(&format!("IFCFACEOUTERBOUND(#{ring},.T.)"));
                faces.push(self.add(&format!("IFCFACE((#{bound}))")));
            }
            let set = self.add(&format!("IFCCONNECTEDFACESET({})", refs(&faces)));
            let item = self.add(&format!("IFCFACEBASEDSURFACEMODEL((#{set}))"));
            self.style(item, rgb);
            out.push(item);
        }
        out
    }

    fn style(&mut self, item: u64, rgb: [u8; 3]) {
        let colour = self.add(&format!("IFCCOLOURRGB($,{})", ratios(rgb)));
        let old = self.is_old();
        let shading = self.add(&format!("IFCSURFACESTYLESHADING(#{colour}{})", if old { "" } else { ",$" }));
        let style = self.add(&format!("IFCSURFACESTYLE($,.BOTH.,(#{shading}))"));
        let style =
            if old { self.add(&format!("IFCPRESENTATIONSTYLEASSIGNMENT((#{style}))")) } else { style };
        self.add(&format!("IFCSTYLEDITEM(#{item},(#{style}),$)"));
    }

    fn curves(&mut self, list: &[&Addition]) -> Vec<u64> {
        let mut out = Vec::new();
        for addition in list {
            let Mark::Path { points, closed } = &addition.mark else { continue };
            let mut ids: Vec<u64> = points.iter().map(|p| self.point(*p)).collect();
            if *closed && let Some(first) = ids.first() {
                ids.push(*first);
            }
            out.push(self.add(&format!("IFCPOLYLINE({})", refs(&ids))));
        }
        out
    }

    fn texts(&mut self, list: &[&Addition]) -> Vec<u64> {
        let mut out = Vec::new();
        for addition in list {
            let Mark::Text { at, text, .. } = &addition.mark else { continue };
            let point = self.point(*at);
            let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{point},$,$)"));
            out.push(self.add(&format!("IFCTEXTLITERAL({},#{axes},.RIGHT.)", encode(text))));
        }
        out
    }

    /// Puts the annotations into their storey and into a group of ours.
    fn tie(&mut self, host: Option<u64>) {
        if self.made.is_empty() {
            return;
        }
        let (made, history) = (refs(&self.made), self.history.clone());
        if let Some(host) = host {
            let gid = self.global_id("contained");
            self.add(&format!(
                "IFCRELCONTAINEDINSPATIALSTRUCTURE('{gid}',{history},'Enfilade',$,{made},#{host})"
            ));
        }
        let gid = self.global_id("group");
        let group = self.add(&format!("IFCGROUP('{gid}',{history},'Enfilade',$,'ENFILADE')"));
        let gid = self.global_id("grouped");
        self.add(&format!("IFCRELASSIGNSTOGROUP('{gid}',{history},$,$,{made},$,#{group})"));
    }

    fn properties(&mut self, host: u64, values: &[(&str, String)]) {
        let ids: Vec<u64> = values
            .iter()
            .map(|(name, value)| self.add(&format!("IFCPROPERTYSINGLEVALUE('{name}',$,{value},$)")))
            .collect();
        let history = self.history.clone();
        let gid = self.global_id("set");
        let set =
            self.add(&format!("IFCPROPERTYSET('{gid}',{history},'Pset_Enfilade_Result',$,{})", refs(&ids)));
        let gid = self.global_id("defines");
        self.add(&format!("IFCRELDEFINESBYPROPERTIES('{gid}',{history},$,$,(#{host}),#{set})"));
    }

    fn note(&mut self, host: u64, own: &[Addition]) {
        let lines: Vec<&str> = own
            .iter()
            .filter_map(|a| if let Mark::Text { text, .. } = &a.mark { Some(text.as_str()) } else { None })
            .collect();
        if !lines.is_empty() {
            let text = format!("IFCTEXT({})", encode(&lines.join("\n")));
            self.properties(host, &[("Note", text)]);
        }
    }

    /// How far an element moved.
    fn moved(&self, id: u64, motion: &RigidMotion) -> Vec<(&'static str, String)> {
        let placement = self.b.step.args(id).get(5).and_then(Arg::id);
        let world = placement.and_then(|p| self.b.geo.placement(p).ok()).filter(is_upright);
        let at = world.map_or(DVec2::ZERO, |m| m.translation.truncate());
        let shift = DVec2::from_angle(motion.turn_rad).rotate(at) + motion.shift - at;
        let turn = format!("IFCREAL({})", real(motion.turn_rad.to_degrees()));
        vec![("ShiftX", length(shift.x)), ("ShiftY", length(shift.y)), ("TurnDegrees", turn)]
    }
}

fn length(v: f64) -> String {
    format!("IFCLENGTHMEASURE({})", real(v))
}

/// How far the ends of a wall went along it, from its first towards its second.
fn lengthened(by: [f64; 2]) -> Vec<(&'static str, String)> {
    vec![("FirstEndShift", length(by[0])), ("SecondEndShift", length(by[1]))]
}

pub(super) fn refs(ids: &[u64]) -> String {
    let list: Vec<String> = ids.iter().map(|id| format!("#{id}")).collect();
    format!("({})", list.join(","))
}

fn ratios(rgb: [u8; 3]) -> String {
    rgb.map(|c| real((f64::from(c) / 255.0 * 1e4).round() / 1e4)).join(",")
}
