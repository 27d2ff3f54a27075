//! Profiles and plane curves as polygons.

use std::f64::consts::TAU;

use glam::{DAffine3, DVec2, DVec3};

use super::geo::{Geo, Why};
use super::step::{Arg, Value};
use crate::region::{Region, Rule, flat};

/// How far a chord may leave its arc, metres.
const CHORD_M: f64 = 0.000_5;

/// Most chords of a full turn.
const CHORDS_MAX: f64 = 256.0;

impl Geo<'_, '_> {
    /// An IfcProfileDef in its own plane.
    pub fn profile(&self, id: u64) -> Result<Region, Why> {
        let args = self.args(id)?;
        let keyword = self.step.keyword(id);
        match &*keyword {
            "IFCARBITRARYCLOSEDPROFILEDEF" => Ok(Region::ring(self.closed(&args, 2, id)?)),
            "IFCARBITRARYPROFILEDEFWITHVOIDS" => {
                let mut out = Region::ring(self.closed(&args, 2, id)?);
                for hole in args.get(3).map(Arg::ids).unwrap_or_default() {
                    out = out.combine(&Region::ring(self.ring(hole)?), Rule::Difference);
                }
                Ok(out)
            }
            "IFCDERIVEDPROFILEDEF" | "IFCMIRROREDPROFILEDEF" => {
                let parent = self.reference(&args, 2, id)?;
                let m = match args.get(3).and_then(Arg::id) {
                    Some(operator) => self.operator(operator)?,
                    None => DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
                };
                Ok(self.profile(parent)?.map(|p| super::geo::plan_point(&m, p)))
            }
            "IFCCOMPOSITEPROFILEDEF" => {
                let mut out = Region::default();
                for part in args.get(2).map(Arg::ids).unwrap_or_default() {
                    out = out.combine(&self.profile(part)?, Rule::Union);
                }
                Ok(out)
            }
            _ => self.parameterised(id, &keyword, &args),
        }
    }

    fn closed(&self, args: &[Arg], i: usize, id: u64) -> Result<Vec<[f64; 2]>, Why> {
        self.ring(self.reference(args, i, id)?)
    }

    /// The instance that an argument must refer to.
    pub fn reference(&self, args: &[Arg], i: usize, id: u64) -> Result<u64, Why> {
        args.get(i)
            .and_then(Arg::id)
            .ok_or_else(|| format!("{} refers to nothing where it must", self.named(id)))
    }

    fn parameterised(&self, id: u64, keyword: &str, args: &[Arg]) -> Result<Region, Why> {
        let number = |i: usize| {
            let v = args.get(i).and_then(Arg::number).filter(|v| *v >= 0.0);
            v.ok_or_else(|| format!("{} has no size where one must stand", self.named(id)))
        };
        let rings = match keyword {
            "IFCRECTANGLEPROFILEDEF" | "IFCROUNDEDRECTANGLEPROFILEDEF" => {
                vec![rectangle(number(3)?, number(4)?)]
            }
            "IFCRECTANGLEHOLLOWPROFILEDEF" => {
                let (x, y, t) = (number(3)?, number(4)?, number(5)? * 2.0);
                vec![rectangle(x, y), rectangle((x - t).max(0.0), (y - t).max(0.0))]
            }
            "IFCCIRCLEPROFILEDEF" => vec![self.circle(number(3)?)],
            "IFCCIRCLEHOLLOWPROFILEDEF" => {
                let (r, t) = (number(3)?, number(4)?);
                vec![self.circle(r), self.circle((r - t).max(0.0))]
            }
            "IFCELLIPSEPROFILEDEF" => {
                let (a, b) = (number(3)?, number(4)?);
                vec![self.circle(a).into_iter().map(|p| [p[0], p[1] / a * b]).collect()]
            }
            "IFCTRAPEZIUMPROFILEDEF" => {
                let (bottom, top, y) = (number(3)?, number(4)?, number(5)?);
                let offset = args.get(6).and_then(Arg::number).unwrap_or(0.0);
                let (l, h) = (-bottom / 2.0, y / 2.0);
                vec![vec![[l, -h], [-l, -h], [l + offset + top, h], [l + offset, h]]]
            }
            "IFCISHAPEPROFILEDEF" => vec![i_shape(number(3)?, number(4)?, number(5)?, number(6)?)],
            "IFCLSHAPEPROFILEDEF" => {
                let (d, w) = (number(3)?, number(4).or_else(|_| number(3))?);
                let t = number(5)?;
                let (x, y) = (w / 2.0, d / 2.0);
                vec![vec![[-x, -y], [x, -y], [x, t - y], [t - x, t - y], [t - x, y], [-x, y]]]
            }
            "IFCTSHAPEPROFILEDEF" => {
                let (d, w, web, flange) = (number(3)?, number(4)?, number(5)? / 2.0, number(6)?);
                let (x, y) = (w / 2.0, d / 2.0);
                vec![vec![
                    [-x, y],
                    [-x, y - flange],
                    [-web, y - flange],
                    [-web, -y],
                    [web, -y],
                    [web, y - flange],
                    [x, y - flange],
                    [x, y],
                ]]
            }
            "IFCUSHAPEPROFILEDEF" => {
                let (d, w, web, flange) = (number(3)?, number(4)?, number(5)?, number(6)?);
                let (x, y) = (w / 2.0, d / 2.0);
                vec![vec![
                    [-x, -y],
                    [x, -y],
                    [x, flange - y],
                    [web - x, flange - y],
                    [web - x, y - flange],
                    [x, y - flange],
                    [x, y],
                    [-x, y],
                ]]
            }
            _ => return Err(format!("{} is a profile that is not read", self.named(id))),
        };
        let at = match args.get(2).and_then(Arg::id) {
            Some(position) => self.axis_placement(position)?,
            None => DAffine3::IDENTITY,
        };
        Ok(Region::with_holes(rings.iter().map(|r| flat(r, &at)).filter(|r| r.len() > 2).collect()))
    }

    fn circle(&self, r: f64) -> Vec<[f64; 2]> {
        if r <= 0.0 {
            return Vec::new();
        }
        let n = self.chords(r, TAU);
        (0..n).map(|i| (DVec2::from_angle(TAU * i as f64 / n as f64) * r).to_array()).collect()
    }

    /// Chords of an arc: as few as keep the sagitta small.
    fn chords(&self, r: f64, turn: f64) -> usize {
        let half = (1.0 - CHORD_M / (r * self.metres).max(CHORD_M)).acos().max(TAU / CHORDS_MAX / 2.0);
        (turn.abs() / (2.0 * half)).ceil().max(2.0) as usize
    }

    /// A closed curve as a ring, its last point not repeated.
    pub fn ring(&self, id: u64) -> Result<Vec<[f64; 2]>, Why> {
        let mut points = self.curve(id, 0)?;
        if points.len() > 1 && near(points[0], points[points.len() - 1], self.metres) {
            points.pop();
        }
        Ok(points)
    }

    /// A plane curve as points.
    pub fn curve(&self, id: u64, depth: usize) -> Result<Vec<[f64; 2]>, Why> {
        if depth > super::limits::BODY_DEPTH_MAX {
            return Err(format!("{} holds itself", self.named(id)));
        }
        let args = self.args(id)?;
        match &*self.step.keyword(id) {
            "IFCPOLYLINE" => self.first_ids(id)?.into_iter().map(|p| self.point2(p)).collect(),
            "IFCCOMPOSITECURVE" | "IFC2DCOMPOSITECURVE" | "IFCCOMPOSITECURVEONSURFACE" => {
                self.composite(&args, depth)
            }
            "IFCINDEXEDPOLYCURVE" => self.indexed(id, &args),
            "IFCCIRCLE" | "IFCELLIPSE" => {
                let (m, a, b) = self.conic(id, &args)?;
                Ok(flat(&arc(a, b, 0.0, TAU, self.chords(a.max(b), TAU)), &m))
            }
            "IFCTRIMMEDCURVE" => self.trimmed(id, &args),
            _ => Err(format!("{} is a curve that is not read", self.named(id))),
        }
    }

    fn composite(&self, args: &[Arg], depth: usize) -> Result<Vec<[f64; 2]>, Why> {
        let mut out: Vec<[f64; 2]> = Vec::new();
        for segment in args.first().map(Arg::ids).unwrap_or_default() {
            let parts = self.args(segment)?;
            let curve = self.reference(&parts, 2, segment)?;
            let mut points = self.curve(curve, depth + 1)?;
            if parts.get(1).is_some_and(|s| s.is("F")) {
                points.reverse();
            }
            let joins = out.last().zip(points.first()).is_some_and(|(a, b)| near(*a, *b, self.metres));
            out.extend(points.into_iter().skip(usize::from(joins)));
        }
        Ok(out)
    }

    fn indexed(&self, id: u64, args: &[Arg]) -> Result<Vec<[f64; 2]>, Why> {
        let points = self.point_list(self.reference(args, 0, id)?)?;
        let at = |i: f64| {
            let p = (i as usize).checked_sub(1).and_then(|i| points.get(i)).map(|p| [p.x, p.y]);
            p.ok_or_else(|| format!("{} names a point that is not in its list", self.named(id)))
        };
        let segments = args.get(1).map(Arg::list).unwrap_or_default();
        if segments.is_empty() {
            return Ok(points.iter().map(|p| [p.x, p.y]).collect());
        }
        let mut out: Vec<[f64; 2]> = Vec::new();
        for segment in segments {
            let Value::Typed(kind, inner) = &segment.value else { continue };
            let indices = inner.first().and_then(Arg::numbers).unwrap_or_default();
            let corners = indices.iter().map(|i| at(*i)).collect::<Result<Vec<_>, _>>()?;
            let piece = match (kind.as_str(), corners.as_slice()) {
                ("IFCARCINDEX", [a, b, c]) => self.arc_through(*a, *b, *c),
                _ => corners,
            };
            let joins = out.last().zip(piece.first()).is_some_and(|(a, b)| a == b);
            out.extend(piece.into_iter().skip(usize::from(joins)));
        }
        Ok(out)
    }

    /// An IfcCartesianPointList2D or 3D.
    pub fn point_list(&self, id: u64) -> Result<Vec<DVec3>, Why> {
        let args = self.args(id)?;
        let of = |p: &Arg| match p.numbers()?.as_slice() {
            [x, y] => Some(DVec3::new(*x, *y, 0.0)),
            [x, y, z] => Some(DVec3::new(*x, *y, *z)),
            _ => None,
        };
        let list: Option<Vec<DVec3>> =
            args.first().map(Arg::list).unwrap_or_default().iter().map(of).collect();
        list.filter(|l| l.iter().all(|p| p.is_finite()))
            .ok_or_else(|| format!("{} has no coordinates", self.named(id)))
    }

    fn arc_through(&self, a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Vec<[f64; 2]> {
        let [p, q, r] = [a, b, c].map(DVec2::from);
        let (u, v) = (q - p, r - p);
        let d = 2.0 * u.perp_dot(v);
        if d.abs() < 1e-12 * u.length() * v.length() {
            return vec![a, b, c];
        }
        let centre = p + DVec2::new(
            v.y * u.length_squared() - u.y * v.length_squared(),
            u.x * v.length_squared() - v.x * u.length_squared(),
        ) / d;
        let start = (p - centre).to_angle();
        let sense = d.signum();
        let turn = ((r - centre).to_angle() - start) * sense;
        let turn = turn.rem_euclid(TAU) * sense;
        let (radius, n) = (p.distance(centre), self.chords(p.distance(centre), turn));
        let mut out: Vec<[f64; 2]> = (0..=n)
            .map(|i| (centre + DVec2::from_angle(start + turn * i as f64 / n as f64) * radius).to_array())
            .collect();
        out[0] = a;
        out[n] = c;
        out
    }

    fn conic(&self, id: u64, args: &[Arg]) -> Result<(DAffine3, f64, f64), Why> {
        let m = self.axis_placement(self.reference(args, 0, id)?)?;
        let a = args.get(1).and_then(Arg::number).filter(|r| *r > 0.0);
        let a = a.ok_or_else(|| format!("{} has no radius", self.named(id)))?;
        let b =
            if self.step.keyword(id) == "IFCELLIPSE" { args.get(2).and_then(Arg::number) } else { Some(a) };
        Ok((m, a, b.filter(|b| *b > 0.0).ok_or_else(|| format!("{} has no second radius", self.named(id)))?))
    }

    fn trimmed(&self, id: u64, args: &[Arg]) -> Result<Vec<[f64; 2]>, Why> {
        let basis = self.reference(args, 0, id)?;
        let of = self.args(basis)?;
        let by_point = args.get(4).is_some_and(|m| m.is("CARTESIAN"));
        let forward = !args.get(3).is_some_and(|s| s.is("F"));
        match &*self.step.keyword(basis) {
            "IFCLINE" => {
                let start = self.point(self.reference(&of, 0, basis)?)?;
                let vector = self.args(self.reference(&of, 1, basis)?)?;
                let direction = self.direction(self.reference(&vector, 0, basis)?)?;
                let step = direction * vector.get(1).and_then(Arg::number).unwrap_or(1.0);
                let end = |i: usize| -> Result<[f64; 2], Why> {
                    let (point, parameter) = self.trim(args.get(i), id)?;
                    let at = match (point, parameter) {
                        (Some(p), None) => p,
                        (Some(p), Some(_)) if by_point => p,
                        (_, Some(t)) => start + step * t,
                        _ => return Err(format!("{} is not trimmed", self.named(id))),
                    };
                    Ok([at.x, at.y])
                };
                Ok(vec![end(1)?, end(2)?])
            }
            "IFCCIRCLE" | "IFCELLIPSE" => {
                let (m, a, b) = self.conic(basis, &of)?;
                let angle = |i: usize| -> Result<f64, Why> {
                    let (point, parameter) = self.trim(args.get(i), id)?;
                    let from_point = point.map(|p| {
                        let q = m.inverse().transform_point3(p);
                        (q.y / b).atan2(q.x / a)
                    });
                    let from_parameter = parameter.map(|t| t * self.radians);
                    let chosen =
                        if by_point { from_point.or(from_parameter) } else { from_parameter.or(from_point) };
                    chosen.ok_or_else(|| format!("{} is not trimmed", self.named(id)))
                };
                let (start, end) = (angle(1)?, angle(2)?);
                let full = |turn: f64| if turn == 0.0 { TAU } else { turn };
                let turn = if forward {
                    full((end - start).rem_euclid(TAU))
                } else {
                    -full((start - end).rem_euclid(TAU))
                };
                Ok(flat(&arc(a, b, start, turn, self.chords(a.max(b), turn)), &m))
            }
            "IFCPOLYLINE" => self.curve(basis, 1),
            _ => Err(format!("{} is a curve that is not read", self.named(basis))),
        }
    }

    /// A trim: a point and a parameter, as far as given.
    fn trim(&self, arg: Option<&Arg>, id: u64) -> Result<(Option<DVec3>, Option<f64>), Why> {
        let items = arg.map_or(&[][..], Arg::list);
        let point = items.iter().find_map(Arg::id).map(|p| self.point(p)).transpose()?;
        let parameter = items.iter().find_map(Arg::number);
        if point.is_none() && parameter.is_none() {
            return Err(format!("{} is not trimmed", self.named(id)));
        }
        Ok((point, parameter))
    }
}

fn arc(a: f64, b: f64, start: f64, turn: f64, n: usize) -> Vec<[f64; 2]> {
    let at = |i: usize| {
        let (sin, cos) = (start + turn * i as f64 / n as f64).sin_cos();
        [a * cos, b * sin]
    };
    (0..=n).map(at).collect()
}

fn near(a: [f64; 2], b: [f64; 2], metres: f64) -> bool {
    DVec2::from(a).distance(DVec2::from(b)) * metres < 1e-5
}

fn rectangle(x: f64, y: f64) -> Vec<[f64; 2]> {
    let (x, y) = (x / 2.0, y / 2.0);
    if x <= 0.0 || y <= 0.0 { Vec::new() } else { vec![[-x, -y], [x, -y], [x, y], [-x, y]] }
}

fn i_shape(width: f64, depth: f64, web: f64, flange: f64) -> Vec<[f64; 2]> {
    let (x, y, w, f) = (width / 2.0, depth / 2.0, web / 2.0, depth / 2.0 - flange);
    vec![
        [-x, -y],
        [x, -y],
        [x, -f],
        [w, -f],
        [w, f],
        [x, f],
        [x, y],
        [-x, y],
        [-x, f],
        [-w, f],
        [-w, -f],
        [-x, -f],
    ]
}
