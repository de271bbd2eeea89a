//! Loops of a network whose triangles are filled, and how long each lasts.
//!
//! Persistence in dimension 1 of the clique complex up to triangles, over Z₂, by reducing the coboundary matrix: contacts from
//! the last to enter to the first, each as the set of triangles on it. De Silva, Morozov and Vejdemo-Johansson (2011),
//! *Dualities in persistent (co)homology*, show that the bars are those of homology, and Chen and Kerber (2011), *Persistent
//! homology computation with a twist*, why contacts that join components need no column.
//!
//! In the plane a contact borders two triangles at most, and a column never has more than two entries: adding columns is then
//! following links, as in a union-find over triangles and the outside. Columns with more entries, of networks that cannot be drawn in
//! the plane, are kept as lists. Both are one loop, so periodic sides and networks in space need no other code.

use super::filtration::{Bar, Edge, sort};

/// The column's only other entry is none: its pivot merges with the outside.
const OUTSIDE: u32 = u32::MAX;
/// The triangle is no pivot yet.
const FREE: u32 = u32::MAX - 1;
/// The column is a list.
const LISTED: u32 = u32::MAX - 2;

/// Bars of the loops of `count` grains, whose contacts are in order of entrance; `joins` says which of them join components.
pub(super) fn bars(count: usize, edges: &[Edge], joins: &[bool]) -> Vec<Bar> {
    let triangles = triangles(count, edges);
    let on = Rows::new(edges.len(), triangles.iter().enumerate().flat_map(|(t, of)| of.map(|e| (e, t as u32))));
    let mut columns = Columns { next: vec![FREE; triangles.len()], lists: Vec::new(), list_of: Vec::new() };
    let mut bars = Vec::new();
    let mut column = Vec::new();
    for e in (0..edges.len()).rev().filter(|&e| !joins[e]) {
        column.clear();
        on.row(e).iter().for_each(|&t| columns.add(&mut column, t));
        let birth = edges[e].value;
        match columns.reduce(&mut column) {
            None => bars.push(Bar { birth, death: None }),
            Some(pivot) => {
                // A triangle enters with the last of its contacts.
                let death = edges[triangles[pivot as usize][2] as usize].value;
                if birth > death {
                    bars.push(Bar { birth, death: Some(death) });
                }
            }
        }
    }
    sort(&mut bars);
    bars
}

/// Every three contacts of three grains that touch each other, in order of entrance; the last contact of each stands last.
fn triangles(count: usize, edges: &[Edge]) -> Vec<[u32; 3]> {
    let ends = |e: usize| edges[e].ends;
    let both = (0..edges.len()).flat_map(|e| {
        let [a, b] = ends(e);
        [(a, (b, e as u32)), (b, (a, e as u32))]
    });
    let mut around = Rows::new(count, both);
    around.sort();
    let mut triangles = Vec::new();
    for e in 0..edges.len() {
        let last = e as u32;
        let [a, b] = ends(e).map(|i| around.row(i as usize));
        let (few, many) = if a.len() <= b.len() { (a, b) } else { (b, a) };
        for &(third, one) in few {
            if one < last
                && let Ok(place) = many.binary_search_by_key(&third, |&(grain, _)| grain)
                && many[place].1 < last
            {
                triangles.push([one, many[place].1, last]);
            }
        }
    }
    triangles
}

/// Reduced columns of the coboundary matrix, each kept at its pivot: its first entry.
struct Columns {
    /// Of each triangle that is a pivot the column's other entry; or a word.
    next: Vec<u32>,
    /// Entries behind the pivot, of columns with more than two.
    lists: Vec<Vec<u32>>,
    /// Pivots of the lists, in the order of the lists; found by a search, as there are few in the plane.
    list_of: Vec<(u32, usize)>,
}

impl Columns {
    /// Adds a triangle to a column in order, in place of which the links of columns of two entries lead to another, or to none.
    fn add(&mut self, column: &mut Vec<u32>, triangle: u32) {
        let triangle = self.follow(triangle);
        if triangle == OUTSIDE {
            return;
        }
        match column.binary_search(&triangle) {
            Ok(place) => drop(column.remove(place)),
            Err(place) => column.insert(place, triangle),
        }
    }

    /// Where the links from a triangle end; the way is shortened.
    fn follow(&mut self, triangle: u32) -> u32 {
        let mut end = triangle;
        while end < LISTED && self.next[end as usize] != FREE && self.next[end as usize] != LISTED {
            end = self.next[end as usize];
        }
        let mut on = triangle;
        while on != end {
            on = std::mem::replace(&mut self.next[on as usize], end);
        }
        end
    }

    /// Adds columns until the first entry is no other column's pivot, and keeps what is left; its pivot, if anything is left.
    fn reduce(&mut self, column: &mut Vec<u32>) -> Option<u32> {
        loop {
            let pivot = *column.first()?;
            if self.next[pivot as usize] == FREE {
                self.next[pivot as usize] = match column[1..] {
                    [] => OUTSIDE,
                    [other] => other,
                    ref more => {
                        let place = self.list_of.partition_point(|entry| entry.0 < pivot);
                        self.list_of.insert(place, (pivot, self.lists.len()));
                        self.lists.push(more.to_vec());
                        LISTED
                    }
                };
                return Some(pivot);
            }
            // Its links end at itself, so that its column is a list.
            column.remove(0);
            let place = self.list_of.partition_point(|entry| entry.0 < pivot);
            let list = std::mem::take(&mut self.lists[self.list_of[place].1]);
            list.iter().for_each(|&t| self.add(column, t));
            self.lists[self.list_of[place].1] = list;
        }
    }
}

/// Lists of different lengths one behind the other.
struct Rows<T> {
    begin: Vec<u32>,
    entries: Vec<T>,
}

impl<T: Copy + Default + Ord> Rows<T> {
    /// From pairs of row and entry, which keep their order within a row.
    fn new(rows: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut begin = vec![0_u32; rows + 1];
        pairs.clone().for_each(|(row, _)| begin[row as usize + 1] += 1);
        for row in 0..rows {
            begin[row + 1] += begin[row];
        }
        let mut at = begin.clone();
        let mut entries = vec![T::default(); begin[rows] as usize];
        for (row, entry) in pairs {
            let place = &mut at[row as usize];
            entries[*place as usize] = entry;
            *place += 1;
        }
        Self { begin, entries }
    }

    fn row(&self, row: usize) -> &[T] {
        &self.entries[self.begin[row] as usize..self.begin[row + 1] as usize]
    }

    fn sort(&mut self) {
        for row in 0..self.begin.len() - 1 {
            self.entries[self.begin[row] as usize..self.begin[row + 1] as usize].sort_unstable();
        }
    }
}
