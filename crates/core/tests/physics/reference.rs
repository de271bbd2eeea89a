//! Reading the independent solutions.

use std::path::PathBuf;

use granulens_core::material::{Material, find};

/// A column-named table; `#` lines are comments.
pub struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    pub fn read(name: &str) -> Self {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(name);
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let columns = split(lines.next().expect("a header"));
        let rows: Vec<_> = lines.map(split).collect();
        assert!(!rows.is_empty(), "{name} holds no rows");
        Self { columns, rows }
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn text(&self, row: usize, column: &str) -> &str {
        let at = self.columns.iter().position(|c| c == column).unwrap_or_else(|| panic!("no column {column}"));
        &self.rows[row][at]
    }

    pub fn number(&self, row: usize, column: &str) -> f64 {
        self.text(row, column).parse().unwrap_or_else(|_| panic!("{column} of row {row} is no number"))
    }
}

pub fn material(name: &str) -> Material {
    find(name, &[]).unwrap()
}

/// Relative difference, against the greater of the two magnitudes and `floor`.
pub fn difference(a: f64, b: f64, floor: f64) -> f64 {
    (a - b).abs() / a.abs().max(b.abs()).max(floor)
}
