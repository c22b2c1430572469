//! Disjoint sets: what is connected? (Galler and Fischer, Communications of the ACM 7(5), 1964), by
//! the lowest number.

/// Sets of the numbers below a count.
#[derive(Debug)]
#[doc(hidden)]
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// Sets of one number each.
    pub fn new(count: usize) -> Self {
        Self((0..u32::try_from(count).unwrap_or(u32::MAX)).collect())
    }

    /// The lowest number in the set of another.
    pub fn first(&mut self, number: u32) -> u32 {
        let mut number = number;
        while self.0[number as usize] != number {
            // Every other step is spared next time.
            let above = self.0[number as usize];
            self.0[number as usize] = self.0[above as usize];
            number = above;
        }
        number
    }

    /// Makes one set of those of two numbers.
    pub fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
