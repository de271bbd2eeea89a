//! Places for labels in a crowded plot: beside their markers, and none on another.

/// A rectangle on paper (px).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    low: [f64; 2],
    high: [f64; 2],
}

impl Area {
    /// By its upper left corner and its size.
    pub fn new(corner: [f64; 2], size: [f64; 2]) -> Self {
        Self { low: corner, high: [corner[0] + size[0], corner[1] + size[1]] }
    }

    fn overlap(&self, other: &Self) -> f64 {
        let along = |k: usize| (self.high[k].min(other.high[k]) - self.low[k].max(other.low[k])).max(0.0);
        along(0) * along(1)
    }

    fn within(&self, other: &Self) -> bool {
        (0..2).all(|k| self.low[k] >= other.low[k] && self.high[k] <= other.high[k])
    }
}

/// Where a label goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    /// The left end of its baseline.
    pub start: [f64; 2],
    /// Where a line from its marker ends, where it stands too far away to be taken for the marker's own.
    pub leader: Option<[f64; 2]>,
}

/// What is taken already.
#[derive(Clone, Debug)]
pub struct Places {
    within: Area,
    taken: Vec<Area>,
}

impl Places {
    /// A plot with nothing in it.
    pub fn new(within: Area) -> Self {
        Self { within, taken: Vec::new() }
    }

    /// Takes a square about a point, so that no label covers it.
    pub fn keep_clear(&mut self, [x, y]: [f64; 2], radius: f64) {
        self.taken.push(Area::new([x - radius, y - radius], [2.0 * radius, 2.0 * radius]));
    }

    /// Width of a bold text in a common sans-serif, a little too wide rather than too narrow.
    fn size(text: &str, size: f64) -> [f64; 2] {
        [text.chars().count() as f64 * size * 0.6, size * 1.1]
    }

    fn covered(&self, area: &Area) -> f64 {
        let outside = if area.within(&self.within) { 0.0 } else { 1e6 };
        outside + self.taken.iter().map(|taken| taken.overlap(area)).sum::<f64>()
    }

    /// A place for a text by the marker at a point: the nearest that covers nothing; none where there is none.
    pub fn near(&mut self, [x, y]: [f64; 2], text: &str, size: f64) -> Option<Label> {
        let [width, height] = Self::size(text, size);
        // Around the marker, then further out; the side is tried before above and below.
        let rings = [11.0, 19.0, 28.0, 40.0, 54.0, 70.0];
        let tries = rings.into_iter().flat_map(|gap| {
            [(1.0, 0.0), (-1.0, 0.0), (1.0, -0.8), (-1.0, -0.8), (1.0, 0.8), (-1.0, 0.8), (0.0, -1.0), (0.0, 1.0)].map(
                |(across, down)| {
                    let left = x + across * gap + (across - 1.0) / 2.0 * width;
                    let top = y + down * (gap + height / 2.0) - height / 2.0;
                    (gap, Area::new([left, top], [width, height]))
                },
            )
        });
        let (gap, area) = tries.into_iter().find(|(_, area)| self.covered(area) == 0.0)?;
        self.taken.push(area);
        let nearest = [x.clamp(area.low[0], area.high[0]), y.clamp(area.low[1] + 2.0, area.high[1] - 2.0)];
        Some(Label { start: [area.low[0], area.high[1] - 0.25 * height], leader: (gap > 12.0).then_some(nearest) })
    }

    /// The left end of the baseline of a text centred on a point; none where it would cover anything.
    pub fn centred(&mut self, [x, y]: [f64; 2], text: &str, size: f64) -> Option<[f64; 2]> {
        let [width, height] = Self::size(text, size);
        let area = Area::new([x - width / 2.0, y - height / 2.0], [width, height]);
        (self.covered(&area) == 0.0).then(|| {
            self.taken.push(area);
            [area.low[0], area.high[1] - 0.25 * height]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_off_markers_and_each_other() {
        let mut places = Places::new(Area::new([0.0, 0.0], [400.0, 300.0]));
        let markers: Vec<[f64; 2]> =
            (0..9).map(|k| [180.0 + 9.0 * f64::from(k), 150.0 + f64::from(k % 3) * 8.0]).collect();
        for &marker in &markers {
            places.keep_clear(marker, 5.0);
        }
        for &marker in &markers {
            places.near(marker, "440c+brass", 11.0).unwrap();
        }
        let labels = &places.taken[markers.len()..];
        for (k, label) in labels.iter().enumerate() {
            assert!(label.within(&places.within));
            let others = places.taken.iter().enumerate().filter(|(other, _)| *other != k + markers.len());
            assert!(others.map(|(_, other)| other.overlap(label)).sum::<f64>() < 1e-9, "{k}");
        }
        // A crowd has names where there is room, and none on another.
        for _ in 0..200 {
            places.near(markers[0], "440c+brass", 11.0);
        }
        let all = &places.taken;
        let clear = |k: usize| (0..k).all(|other| all[k].overlap(&all[other]) < 1e-9);
        assert!((markers.len()..all.len()).all(clear));
        assert_eq!(places.near(markers[0], "440c+brass", 11.0), None);
        assert_eq!(places.centred(markers[0], "500", 10.0), None);
        assert!(places.centred([30.0, 30.0], "500", 10.0).is_some());
    }
}
