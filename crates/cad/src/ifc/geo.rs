//! Points, directions and placements.

use std::collections::{HashMap, HashSet};
use std::sync::{PoisonError, RwLock};

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::limits::PLACEMENT_CHAIN_MAX;
use super::step::{Arg, Step};

/// Why something cannot be read, naming the instance: `#12 IFCDIRECTION …`.
pub(super) type Why = String;

/// Axes nearer to upright than this count as upright (sine of the angle).
pub(super) const UPRIGHT: f64 = 1e-9;

/// Geometry of one file.
pub(super) struct Geo<'s, 'a> {
    /// The file.
    pub step: &'s Step<'a>,
    /// Metres in one length unit.
    pub metres: f64,
    /// Radians in one unit of plane angle.
    pub radians: f64,
    placements: RwLock<HashMap<u64, Result<DAffine3, Why>>>,
}

impl<'s, 'a> Geo<'s, 'a> {
    /// Geometry in these units.
    pub fn new(step: &'s Step<'a>, metres: f64, radians: f64) -> Self {
        Self { step, metres, radians, placements: RwLock::default() }
    }

    /// `#12 IFCDIRECTION`.
    pub fn named(&self, id: u64) -> String {
        let keyword = self.step.keyword(id);
        if keyword.is_empty() { format!("#{id}") } else { format!("#{id} {keyword}") }
    }

    /// Arguments of an instance that must exist.
    pub fn args(&self, id: u64) -> Result<Vec<Arg>, Why> {
        if self.step.get(id).is_none() {
            return Err(format!("#{id} does not exist"));
        }
        Ok(self.step.args(id))
    }

    /// The instances that the first argument of one names.
    pub fn first_ids(&self, id: u64) -> Result<Vec<u64>, Why> {
        if self.step.get(id).is_none() {
            return Err(format!("#{id} does not exist"));
        }
        Ok(self.step.first_ids(id))
    }

    /// Two or three finite numbers; the third is 0 where there are two.
    fn triple(&self, id: u64, what: &str) -> Result<DVec3, Why> {
        if let Some([Some(x), Some(y), z]) = self.step.coordinates(id) {
            return Ok(DVec3::new(x, y, z.unwrap_or(0.0)));
        }
        let args = self.args(id)?;
        let numbers = args.first().and_then(Arg::numbers).filter(|n| n.iter().all(|v| v.is_finite()));
        match numbers.ok_or_else(|| format!("{} has no coordinates", self.named(id)))?.as_slice() {
            [x, y] => Ok(DVec3::new(*x, *y, 0.0)),
            [x, y, z] => Ok(DVec3::new(*x, *y, *z)),
            _ => Err(format!("{} has not two or three {what}", self.named(id))),
        }
    }

    /// An IfcCartesianPoint; z is 0 where it has two coordinates.
    pub fn point(&self, id: u64) -> Result<DVec3, Why> {
        self.triple(id, "coordinates")
    }

    /// An IfcCartesianPoint as seen from above.
    pub fn point2(&self, id: u64) -> Result<[f64; 2], Why> {
        Ok(self.point(id)?.truncate().to_array())
    }

    /// An IfcDirection of length 1.
    pub fn direction(&self, id: u64) -> Result<DVec3, Why> {
        let v = self.triple(id, "ratios")?;
        v.try_normalize().ok_or_else(|| format!("{} has no length, expected a direction", self.named(id)))
    }

    fn optional(&self, arg: Option<&Arg>, default: DVec3) -> Result<DVec3, Why> {
        arg.and_then(Arg::id).map_or(Ok(default), |id| self.direction(id))
    }

    /// An IfcAxis2Placement2D or 3D.
    pub fn axis_placement(&self, id: u64) -> Result<DAffine3, Why> {
        let args = self.args(id)?;
        let at =
            args.first().and_then(Arg::id).ok_or_else(|| format!("{} has no location", self.named(id)))?;
        let at = self.point(at)?;
        if self.step.keyword(id) == "IFCAXIS2PLACEMENT2D" {
            let x = self.optional(args.get(1), DVec3::X)?;
            let y = DVec3::new(-x.y, x.x, 0.0);
            return Ok(DAffine3::from_mat3_translation(DMat3::from_cols(x, y, DVec3::Z), at));
        }
        let z = self.optional(args.get(1), DVec3::Z)?;
        let x = self.optional(args.get(2), if z.x.abs() > 1.0 - 1e-9 { DVec3::Z } else { DVec3::X })?;
        let x = (x - z * x.dot(z))
            .try_normalize()
            .ok_or_else(|| format!("{} has its two axes along one line", self.named(id)))?;
        Ok(DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), at))
    }

    /// The world transform of an IfcObjectPlacement.
    pub fn placement(&self, id: u64) -> Result<DAffine3, Why> {
        let mut chain: Vec<u64> = Vec::new();
        let mut seen = HashSet::new();
        let mut base = Ok(DAffine3::IDENTITY);
        let mut next = Some(id);
        while let Some(at) = next {
            if let Some(known) = self.placements.read().unwrap_or_else(PoisonError::into_inner).get(&at) {
                base = known.clone();
                break;
            }
            if !seen.insert(at) {
                base = Err(cycle(&chain, at));
                break;
            }
            if chain.len() >= PLACEMENT_CHAIN_MAX {
                base = Err(format!("a chain of more than {PLACEMENT_CHAIN_MAX} placements starts at #{id}"));
                break;
            }
            chain.push(at);
            next = match self.parent(at) {
                Ok(parent) => parent,
                Err(why) => {
                    base = Err(why);
                    break;
                }
            };
        }
        for at in chain.into_iter().rev() {
            let own = base.and_then(|m| Ok(m * self.own_placement(at)?));
            self.placements.write().unwrap_or_else(PoisonError::into_inner).insert(at, own.clone());
            base = own;
        }
        base
    }

    /// The placement that an IfcLocalPlacement is relative to.
    pub fn parent(&self, id: u64) -> Result<Option<u64>, Why> {
        let args = self.args(id)?;
        if self.step.keyword(id) != "IFCLOCALPLACEMENT" {
            return Err(format!("{} is a kind of placement that is not read", self.named(id)));
        }
        Ok(args.first().and_then(Arg::id))
    }

    /// An IfcLocalPlacement relative to its parent.
    pub fn own_placement(&self, id: u64) -> Result<DAffine3, Why> {
        let args = self.args(id)?;
        match args.get(1).and_then(Arg::id) {
            Some(axes) => self.axis_placement(axes),
            None => Err(format!("{} has no relative placement", self.named(id))),
        }
    }

    /// `inner` as seen from `outer`, both IfcObjectPlacements; exact where one is relative to the other.
    pub fn relative(&self, inner: u64, outer: u64) -> Result<DAffine3, Why> {
        let whole = self.placement(inner)?;
        let base = self.placement(outer)?;
        let mut out = DAffine3::IDENTITY;
        let mut at = inner;
        for _ in 0..PLACEMENT_CHAIN_MAX {
            if at == outer {
                return Ok(out);
            }
            out = self.own_placement(at)? * out;
            match self.parent(at)? {
                Some(parent) => at = parent,
                None => break,
            }
        }
        Ok(base.inverse() * whole)
    }

    /// An IfcCartesianTransformationOperator.
    pub fn operator(&self, id: u64) -> Result<DAffine3, Why> {
        let args = self.args(id)?;
        let two = self.step.keyword(id).contains("OPERATOR2D");
        let at = args.get(2).and_then(Arg::id).ok_or_else(|| format!("{} has no origin", self.named(id)))?;
        let at = self.point(at)?;
        let scale = args.get(3).and_then(Arg::number).unwrap_or(1.0);
        let numbers = |i: usize| args.get(i).and_then(Arg::number).unwrap_or(scale);
        let z = if two { DVec3::Z } else { self.optional(args.get(4), DVec3::Z)? };
        let x = self.optional(args.first(), if z.x.abs() > 0.9 { DVec3::Y } else { DVec3::X })?;
        let x = (x - z * x.dot(z))
            .try_normalize()
            .ok_or_else(|| format!("{} has its two axes along one line", self.named(id)))?;
        let wanted = z.cross(x);
        // The second axis only says on which side y lies: a mirror image is allowed.
        let y = self.optional(args.get(1), wanted)?;
        let y = if y.dot(wanted) < 0.0 { -wanted } else { wanted };
        let (sy, sz) = if two { (numbers(4), scale) } else { (numbers(5), numbers(6)) };
        if scale == 0.0 || sy == 0.0 || sz == 0.0 {
            return Err(format!("{} scales to nothing", self.named(id)));
        }
        Ok(DAffine3::from_mat3_translation(DMat3::from_cols(x * scale, y * sy, z * sz), at))
    }
}

fn cycle(chain: &[u64], at: u64) -> Why {
    let start = chain.iter().position(|c| *c == at).unwrap_or(0);
    let ring: Vec<String> = chain[start..].iter().chain([&at]).map(|id| format!("#{id}")).collect();
    format!("placements are relative to each other in a ring: {}", ring.join(">"))
}

/// Whether a transform keeps the world's vertical.
pub(super) fn is_upright(m: &DAffine3) -> bool {
    let z = m.matrix3.z_axis.normalize_or_zero();
    z.z > 0.0 && z.truncate().length() < UPRIGHT
}

/// The plan part of an upright transform.
pub(super) fn plan_point(m: &DAffine3, p: DVec2) -> DVec2 {
    m.transform_point3(p.extend(0.0)).truncate()
}
