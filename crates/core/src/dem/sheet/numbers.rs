//! Memory of a sheet.

/// Numbers from the beginning of a cache line on, so that no register straddles two.
#[derive(Debug)]
pub(in crate::dem) struct Numbers {
    room: Vec<f64>,
    start: usize,
    pub length: usize,
}

impl Numbers {
    pub fn zero(length: usize) -> Self {
        let room = vec![0.0; length + 8];
        // In a place where this cannot be told, any start will do.
        let start = Some(room.as_ptr().align_offset(64)).filter(|&start| start < 8).unwrap_or(0);
        Self { room, start, length }
    }
    pub fn get(&self) -> &[f64] {
        &self.room[self.start..self.start + self.length]
    }
    pub fn get_mut(&mut self) -> &mut [f64] {
        &mut self.room[self.start..self.start + self.length]
    }
}

impl Clone for Numbers {
    fn clone(&self) -> Self {
        let mut copy = Self::zero(self.length);
        copy.get_mut().copy_from_slice(self.get());
        copy
    }
}
