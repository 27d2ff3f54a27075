//! Joints: where axes meet, extended or trimmed to each other, they share a node.

use glam::DVec2;

use super::assembly::Axes;
use super::axis::Axis;
use super::carrier::Carrier;
use super::columns::Column;
use super::near::Buckets;
use super::runs::Groups;
use super::spans;
use super::{AxisGraph, Drawn, Edge, Node, NodeKind};
use crate::sizes::{CROSSING_MIN_RAD, ERROR_GAP_M, ZERO_M};

/// Furthest an axis is extended, however acute the corner.
const REACH_MAX_M: f64 = 2.5;
/// Contacts nearer than this share of the wall's thickness are one node.
const MERGE_SHARE: f64 = 0.1;
/// How far two ends may lie apart across, in shares of their half thicknesses, and still be one wall.
const STEP_SHARE: f64 = 0.9;

/// Where two axes meet.
#[derive(Clone, Copy, Debug)]
struct Contact {
    at: DVec2,
    axes: [u32; 2],
    s: [f64; 2],
    /// Per axis the end (0, 1) that goes to the contact, or `None` where the axis passes.
    ends: [Option<usize>; 2],
}

/// An end of an axis that meets nothing.
#[derive(Clone, Copy, Debug)]
pub struct FreeEnd {
    pub axis: u32,
    /// 0: at the span's start, 1: at its end.
    pub end: usize,
    pub node: u32,
}

/// The graph with what openings need.
#[derive(Debug)]
pub struct Joined {
    pub free: Vec<FreeEnd>,
    /// Per axis its nodes in order of s.
    pub stations: Vec<Vec<(f64, u32)>>,
    /// Per axis the edges between its stations.
    pub edges: Vec<Vec<u32>>,
    /// Node index and outline of each column.
    pub columns: Vec<(u32, Column)>,
}

/// Joins axes to nodes and edges.
pub fn join(drawn: &Drawn, all: &Axes, columns: Vec<Column>, out: &mut AxisGraph) -> Joined {
    let axes = &all.axes;
    let mut contacts = contacts(axes);
    contacts.extend(end_contacts(axes, &contacts));
    let mut groups = group(axes, &contacts);
    let mut node_of: Vec<Option<u32>> = vec![None; contacts.len()];
    let mut sums: Vec<(DVec2, f64)> = Vec::new();
    for c in 0..contacts.len() {
        let root = groups.root(c);
        let node = *node_of[root].get_or_insert_with(|| {
            sums.push((DVec2::ZERO, 0.0));
            sums.len() as u32 - 1
        });
        node_of[c] = Some(node);
        sums[node as usize].0 += contacts[c].at;
        sums[node as usize].1 += 1.0;
    }
    for (sum, n) in sums {
        out.nodes.push(Node { at: sum / n, kind: NodeKind::End, faces: Vec::new() });
    }
    let mut joined =
        Joined { free: Vec::new(), stations: Vec::new(), edges: Vec::new(), columns: Vec::new() };
    let mut by_axis: Vec<Vec<(f64, u32, Option<usize>)>> = vec![Vec::new(); axes.len()];
    for (c, contact) in contacts.iter().enumerate() {
        for k in 0..2 {
            if let Some(node) = node_of[c] {
                by_axis[contact.axes[k] as usize].push((contact.s[k], node, contact.ends[k]));
            }
        }
    }
    for (a, met) in by_axis.into_iter().enumerate() {
        add_axis(drawn, a, &axes[a], met, out, &mut joined);
    }
    for column in columns {
        let kind = NodeKind::Column(column.ring.clone());
        out.nodes.push(Node { at: column.centre, kind, faces: column.faces.clone() });
        joined.columns.push((out.nodes.len() as u32 - 1, column));
    }
    name_nodes(out);
    add_caps(drawn, all, out);
    joined
}

/// Stations and edges of one axis.
fn add_axis(
    drawn: &Drawn,
    a: usize,
    axis: &Axis,
    met: Vec<(f64, u32, Option<usize>)>,
    out: &mut AxisGraph,
    joined: &mut Joined,
) {
    let mut stations: Vec<(f64, u32)> = Vec::new();
    for end in 0..2 {
        if !met.iter().any(|m| m.2 == Some(end)) {
            let node = out.nodes.len() as u32;
            out.nodes.push(Node {
                at: axis.carrier.at(axis.span[end]),
                kind: NodeKind::End,
                faces: Vec::new(),
            });
            joined.free.push(FreeEnd { axis: a as u32, end, node });
            stations.push((axis.span[end], node));
        }
    }
    stations.extend(met.iter().map(|m| (m.0, m.1)));
    stations.sort_by(|p, q| spans::tidy(p.0).total_cmp(&spans::tidy(q.0)));
    stations.dedup_by_key(|s| s.1);
    let mut edges = Vec::new();
    for w in stations.windows(2) {
        let edge = edge_of(drawn, axis, w[0], w[1]);
        edges.push(out.edges.len() as u32);
        out.edges.push(edge);
    }
    joined.stations.push(stations);
    joined.edges.push(edges);
}

fn edge_of(drawn: &Drawn, axis: &Axis, from: (f64, u32), to: (f64, u32)) -> Edge {
    let bulge = match axis.carrier {
        Carrier::Line { .. } => 0.0,
        Carrier::Circle { radius, .. } => ((to.0 - from.0) / radius / 4.0).tan(),
    };
    // The positive side of a line is its left, that of a circle walked anticlockwise its right.
    let [left, right] = if axis.carrier.is_line() { [0, 1] } else { [1, 0] };
    let span = [from.0, to.0];
    let refs = |faces: &[u32]| drawn.refs(&drawn.along(faces, &axis.carrier, span));
    Edge {
        nodes: [from.1, to.1],
        thickness_m: axis.thickness,
        bulge,
        role: axis.role,
        left: refs(&axis.sides[left]),
        right: refs(&axis.sides[right]),
        inner: refs(&axis.inner),
    }
}

fn contacts(axes: &[Axis]) -> Vec<Contact> {
    let mut buckets = Buckets::new(2.0);
    let long: Vec<Vec<DVec2>> = axes.iter().map(|a| a.carrier.points([a.span[0], a.span[1]])).collect();
    for (i, points) in long.iter().enumerate() {
        buckets.add(i as u32, points);
    }
    let mut out = Vec::new();
    for i in 0..axes.len() {
        for j in buckets.along(&long[i], REACH_MAX_M) {
            if j as usize > i && axes[i].row != axes[j as usize].row {
                let (a, b) = (&axes[i], &axes[j as usize]);
                let met = a.carrier.crossings(&b.carrier).into_iter();
                out.extend(met.filter_map(|p| contact_at(a, b, p, [i as u32, j])));
            }
        }
    }
    out
}

fn contact_at(a: &Axis, b: &Axis, at: DVec2, ids: [u32; 2]) -> Option<Contact> {
    let s = [a.carrier.s_of(at), b.carrier.s_of(at)];
    let pair = [a, b];
    let end = |k: usize| usize::from(2.0 * s[k] > pair[k].span[0] + pair[k].span[1]);
    let outward = |k: usize| pair[k].carrier.tangent(s[k]) * if end(k) == 1 { 1.0 } else { -1.0 };
    let (u, v) = (outward(0), outward(1));
    let (sin, cos) = (u.perp_dot(v).abs(), u.dot(v));
    if sin < CROSSING_MIN_RAD.sin() {
        return None;
    }
    let beyond = |k: usize| if end(k) == 1 { s[k] - pair[k].span[1] } else { pair[k].span[0] - s[k] };
    let half = |k: usize| pair[k].thickness / 2.0;
    let slack = ERROR_GAP_M / sin;
    let corner = |k: usize| ((half(1 - k) + half(k) * cos) / sin).abs() + slack;
    let tee = |k: usize| ((half(1 - k) + half(k) * cos.abs()) / sin) + slack;
    let reach = |k: usize| {
        if beyond(1 - k) > -tee(1 - k) {
            corner(k).max(tee(k).min(2.0 * half(1 - k) + slack))
        } else {
            tee(k)
        }
    };
    if (0..2).any(|k| beyond(k) > reach(k).min(REACH_MAX_M)) {
        return None;
    }
    let goes = |k: usize| (beyond(k) > -tee(k)).then(|| end(k));
    Some(Contact { at, axes: ids, s, ends: [goes(0), goes(1)] })
}

/// Ends that meet end to end with little or no turn: a tangent arc, a slight bend, a step in thickness.
fn end_contacts(axes: &[Axis], crossings: &[Contact]) -> Vec<Contact> {
    let mut is_met = vec![[false; 2]; axes.len()];
    for c in crossings {
        for k in 0..2 {
            if let Some(e) = c.ends[k] {
                is_met[c.axes[k] as usize][e] = true;
            }
        }
    }
    let mut buckets = Buckets::new(2.0);
    for (i, a) in axes.iter().enumerate() {
        buckets.add(i as u32, &[a.carrier.at(a.span[0])]);
        buckets.add(i as u32, &[a.carrier.at(a.span[1])]);
    }
    let mut out = Vec::new();
    for (i, a) in axes.iter().enumerate() {
        for (e, s) in a.span.iter().enumerate() {
            let end = a.carrier.at(*s);
            for j in buckets.near(end - 0.5, end + 0.5) {
                let b = &axes[j as usize];
                if j as usize <= i || (is_met[i][e] && a.carrier.is_line() && b.carrier.is_line()) {
                    continue;
                }
                out.extend((0..2).filter_map(|f| end_contact(a, e, b, f, [i as u32, j])));
            }
        }
    }
    out
}

fn end_contact(a: &Axis, e: usize, b: &Axis, f: usize, ids: [u32; 2]) -> Option<Contact> {
    let (p, q) = (a.carrier.at(a.span[e]), b.carrier.at(b.span[f]));
    let sign = |k: usize| if k == 1 { 1.0 } else { -1.0 };
    let (u, v) = (a.carrier.tangent(a.span[e]) * sign(e), b.carrier.tangent(b.span[f]) * sign(f));
    if u.dot(v) > -CROSSING_MIN_RAD.cos() + 0.03 {
        return None;
    }
    let along = (q - p).dot(u).abs();
    let across = (q - p).perp_dot(u).abs();
    let step = STEP_SHARE * (a.thickness + b.thickness) / 2.0;
    if along > ERROR_GAP_M || across > step.max(ERROR_GAP_M / 2.0) {
        return None;
    }
    let near = a
        .carrier
        .crossings(&b.carrier)
        .into_iter()
        .find(|x| x.distance(p) < ERROR_GAP_M && x.distance(q) < ERROR_GAP_M);
    let is_bend = a.carrier.is_line() && b.carrier.is_line();
    let at = near.filter(|_| is_bend).unwrap_or_else(|| p.midpoint(q));
    Some(Contact { at, axes: ids, s: [a.span[e], b.span[f]], ends: [Some(e), Some(f)] })
}

/// Contacts that are one node.
fn group(axes: &[Axis], contacts: &[Contact]) -> Groups {
    let mut groups = Groups::new(contacts.len());
    let mut by_axis: Vec<Vec<(f64, usize)>> = vec![Vec::new(); axes.len()];
    for (c, contact) in contacts.iter().enumerate() {
        for k in 0..2 {
            by_axis[contact.axes[k] as usize].push((contact.s[k], c));
        }
    }
    for (a, mut met) in by_axis.into_iter().enumerate() {
        let near = ERROR_GAP_M.max(MERGE_SHARE * axes[a].thickness);
        met.sort_by(|p, q| spans::tidy(p.0).total_cmp(&spans::tidy(q.0)).then(p.1.cmp(&q.1)));
        for w in met.windows(2) {
            if spans::length([w[0].0, w[1].0]) < near {
                groups.join(w[0].1, w[1].1);
            }
        }
    }
    groups
}

fn name_nodes(out: &mut AxisGraph) {
    let mut degree = vec![0; out.nodes.len()];
    for e in &out.edges {
        e.nodes.iter().for_each(|n| degree[*n as usize] += 1);
    }
    for (node, degree) in out.nodes.iter_mut().zip(degree) {
        if !matches!(node.kind, NodeKind::Column(_)) {
            node.kind = match degree {
                0 | 1 => NodeKind::End,
                2 => NodeKind::Corner,
                3 => NodeKind::Tee,
                4 => NodeKind::Cross,
                _ => NodeKind::Star,
            };
        }
    }
}

/// Caps belong to the end they close.
fn add_caps(drawn: &Drawn, all: &Axes, out: &mut AxisGraph) {
    let mut buckets = Buckets::new(1.0);
    for (i, n) in out.nodes.iter().enumerate() {
        buckets.add(i as u32, &[n.at]);
    }
    for cap in all.spares.iter().filter(|s| s.is_cap) {
        let middle = cap.carrier.at((cap.span[0] + cap.span[1]) / 2.0);
        let reach = spans::length(cap.span).max(ZERO_M) + ERROR_GAP_M;
        let near = buckets.near(middle - reach, middle + reach).into_iter();
        let distance = |n: &u32| spans::tidy(out.nodes[*n as usize].at.distance(middle));
        let nearest = near.filter(|n| distance(n) < reach).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(n) = nearest {
            out.nodes[n as usize].faces.extend(drawn.refs(&cap.faces));
        }
    }
}
