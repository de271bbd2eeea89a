//! The frame: a tray whose walls stand for the mirror lines, as a closed solid.
//!
//! Side walls and an end wall touch the outermost spheres, as those of the sliding rig (Burgoyne 2016, section 2.2.3); the struck side is
//! open. Walls begin at the centres of row 1, so that what strikes meets spheres half a diameter before it could meet the frame, and
//! are as high as the spheres, so that a plate laid on them keeps the sheet flat.

use super::piece::Piece;

/// Lengths of the frame (mm).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Between the side walls.
    pub width: f64,
    /// From the centres of row 1 to the end wall.
    pub depth: f64,
    /// Of the walls above the floor.
    pub height: f64,
    /// Thickness of the walls.
    pub wall: f64,
    /// Thickness of the floor.
    pub floor: f64,
}

/// A closed surface of triangles, corners counter-clockwise seen from outside (mm).
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// The triangles.
    pub triangles: Vec<[[f64; 3]; 3]>,
}

impl Frame {
    /// Around a piece, with so much room between it and each of the three walls (mm).
    pub fn new(piece: &Piece, clearance: f64, wall: f64, floor: f64) -> Self {
        let [left, _, right, bottom] = piece.extent();
        Self { width: right - left + 2.0 * clearance, depth: bottom + clearance, height: piece.diameter, wall, floor }
    }

    /// Floor and three walls (mm³).
    pub fn volume(&self) -> f64 {
        let (outer, inner) = ((self.width + 2.0 * self.wall) * (self.depth + self.wall), self.width * self.depth);
        outer * self.floor + (outer - inner) * self.height
    }

    /// The surface: x across from the crystal's axis, y along the wave from row 1, z up from the floor on which the spheres lie.
    pub fn solid(&self) -> Solid {
        let half = 0.5 * self.width;
        let planes = [
            vec![-half - self.wall, -half, half, half + self.wall],
            vec![0.0, self.depth, self.depth + self.wall],
            vec![-self.floor, 0.0, self.height],
        ];
        // Everything but the room over the floor, between the walls.
        Solid::of_cells(&planes, |[x, y, z]| z == 0 || x != 1 || y == 1)
    }
}

impl Solid {
    /// The surface of some cells of a grid of planes. Faces are whole faces of cells, so that every edge is shared by two triangles from
    /// corner to corner.
    fn of_cells(planes: &[Vec<f64>; 3], filled: impl Fn([usize; 3]) -> bool) -> Self {
        let cells = [0, 1, 2].map(|axis| planes[axis].len() - 1);
        let is_filled = |cell: [i64; 3]| {
            let inside = (0..3).all(|axis| (0..cells[axis] as i64).contains(&cell[axis]));
            inside && filled(cell.map(|k| k as usize))
        };
        let mut triangles = Vec::new();
        for x in 0..cells[0] as i64 {
            for y in 0..cells[1] as i64 {
                for z in 0..cells[2] as i64 {
                    let cell = [x, y, z];
                    for axis in (0..3).filter(|_| is_filled(cell)) {
                        for side in [0, 1] {
                            let mut beside = cell;
                            beside[axis] += 2 * side - 1;
                            if is_filled(beside) {
                                continue;
                            }
                            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                            let corner = |du: i64, dv: i64| -> [f64; 3] {
                                let mut at = cell;
                                at[axis] += side;
                                at[u] += du;
                                at[v] += dv;
                                std::array::from_fn(|k| planes[k][at[k] as usize])
                            };
                            let mut face = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                            if side == 0 {
                                face.reverse();
                            }
                            triangles.push([face[0], face[1], face[2]]);
                            triangles.push([face[0], face[2], face[3]]);
                        }
                    }
                }
            }
        }
        Self { triangles }
    }

    /// What it encloses (mm³), by the divergence theorem.
    pub fn volume(&self) -> f64 {
        let of = |[a, b, c]: &[[f64; 3]; 3]| {
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
        };
        self.triangles.iter().map(of).sum()
    }

    /// As binary STL, in millimetres, as programs for printing and milling take its numbers.
    pub fn stl(&self, title: &str) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        // The head must not begin with "solid", by which text is known.
        let head = format!("granulens frame, mm: {title}");
        let head = &head.as_bytes()[..head.len().min(80)];
        bytes[..head.len()].copy_from_slice(head);
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for triangle in &self.triangles {
            let [a, b, c] = triangle;
            let [p, q] = [b, c].map(|to| -> [f64; 3] { std::array::from_fn(|k| to[k] - a[k]) });
            let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            for x in normal.map(|x| x / length).iter().chain(triangle.iter().flatten()) {
                bytes.extend((*x as f32).to_le_bytes());
            }
            bytes.extend([0, 0]);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Every directed edge occurs once and its opposite once: the surface is closed and all of it looks outwards. What it encloses is
    /// what floor and walls hold, counted otherwise.
    #[test]
    fn the_frame_is_closed_and_holds_what_it_should() {
        let frame = Frame { width: 215.9, depth: 272.6, height: 6.35, wall: 10.0, floor: 4.0 };
        let solid = frame.solid();
        let mut edges: BTreeMap<[[u64; 3]; 2], i32> = BTreeMap::new();
        for triangle in &solid.triangles {
            let corners = triangle.map(|corner| corner.map(f64::to_bits));
            for k in 0..3 {
                *edges.entry([corners[k], corners[(k + 1) % 3]]).or_default() += 1;
            }
        }
        assert!(edges.iter().all(|([a, b], count)| *count == 1 && edges.get(&[*b, *a]) == Some(&1)));
        assert!((solid.volume() / frame.volume() - 1.0).abs() < 1e-12, "{} {}", solid.volume(), frame.volume());
        assert_eq!(solid.stl("test").len(), 84 + 50 * solid.triangles.len());
    }
}
