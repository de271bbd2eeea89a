//! Lines of equal value on a design surface, by marching squares.

use std::collections::HashMap;

use super::{Axis, Surface};

/// Where a line crosses the grid: on the edge from node (i, j) to the next along x (0) or y (1).
type Edge = (usize, usize, u8);

/// The lines along which the value is `level` (SI), as points in the places of the surface's nodes.
///
/// Between nodes its logarithm is taken to be linear in the logarithm of a continuous variable. Cells with a corner at which there is
/// no value hold no line, and neither do the steps between dimensions.
pub fn contour(surface: &Surface, level: f64) -> Vec<Vec<[f64; 2]>> {
    let mut segments: Vec<[Edge; 2]> = Vec::new();
    let width = |nodes: &[super::Node], k: usize| nodes[k + 1].place > nodes[k].place;
    for j in 0..surface.nodes[1].len() - 1 {
        for i in 0..surface.nodes[0].len() - 1 {
            let corners = [surface.at(i, j), surface.at(i + 1, j), surface.at(i + 1, j + 1), surface.at(i, j + 1)];
            let [Some(a), Some(b), Some(c), Some(d)] = corners else { continue };
            if !(width(&surface.nodes[0], i) && width(&surface.nodes[1], j)) {
                continue;
            }
            let edges: [(Edge, [f64; 2]); 4] =
                [((i, j, 0), [a, b]), ((i + 1, j, 1), [b, c]), ((i, j + 1, 0), [d, c]), ((i, j, 1), [a, d])];
            // A value that rises or falls along each axis throughout is crossed twice or not at all.
            let crossed: Vec<Edge> =
                edges.iter().filter(|(_, [p, q])| (*p < level) != (*q < level)).map(|(edge, _)| *edge).collect();
            if let [from, to] = crossed[..] {
                segments.push([from, to]);
            }
        }
    }
    joined(&segments)
        .into_iter()
        .map(|line| line.into_iter().map(|edge| place(surface, edge, level)).collect())
        .collect()
}

fn place(surface: &Surface, (i, j, along): Edge, level: f64) -> [f64; 2] {
    let next = if along == 0 { (i + 1, j) } else { (i, j + 1) };
    let mut at = [surface.nodes[0][i].place, surface.nodes[1][j].place];
    if let (Some(here), Some(there)) = (surface.at(i, j), surface.at(next.0, next.1)) {
        let axis = usize::from(along);
        let share = (level / here).ln() / (there / here).ln();
        let (from, to) = (at[axis], surface.nodes[axis][[next.0, next.1][axis]].place);
        let linear = surface.axes[axis] == Axis::Dimension;
        at[axis] = if linear { from + share * (to - from) } else { from * (to / from).powf(share) };
    }
    at
}

/// Segments that share an edge, end to end.
fn joined(segments: &[[Edge; 2]]) -> Vec<Vec<Edge>> {
    let mut at: HashMap<Edge, Vec<usize>> = HashMap::new();
    for (k, ends) in segments.iter().enumerate() {
        for end in ends {
            at.entry(*end).or_default().push(k);
        }
    }
    let mut used = vec![false; segments.len()];
    // From `edge` on, as far as unused segments lead.
    let follow = |mut edge: Edge, used: &mut Vec<bool>| {
        let mut line = Vec::new();
        while let Some(&k) = at.get(&edge).and_then(|list| list.iter().find(|&&k| !used[k])) {
            used[k] = true;
            let [a, b] = segments[k];
            edge = if a == edge { b } else { a };
            line.push(edge);
        }
        line
    };
    let mut lines = Vec::new();
    for k in 0..segments.len() {
        if used[k] {
            continue;
        }
        used[k] = true;
        let [from, to] = segments[k];
        let mut line = follow(from, &mut used);
        line.reverse();
        line.extend([from, to]);
        line.extend(follow(to, &mut used));
        lines.push(line);
    }
    lines
}
