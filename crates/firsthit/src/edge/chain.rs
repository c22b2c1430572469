//! Edges put together to lines, so that dashes go on from one edge to the next.
//!
//! 1. Sort the ends of edges by their places.
//! 2. From each place where not just two edges meet, go along each edge to the next such place.
//! 3. What is left is closed.

/// An edge in a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Link {
    /// Which one.
    pub(super) edge: usize,
    /// Whether the chain goes along it from the second end to the first.
    pub(super) is_reversed: bool,
    /// Whether it is the first of a chain.
    pub(super) is_first: bool,
}

/// All edges, whose ends are given, as chains one after the other.
pub(super) fn chains(edges: &[[u32; 2]]) -> Vec<Link> {
    let mut ends: Vec<(u32, usize)> = Vec::with_capacity(2 * edges.len());
    for (k, [from, to]) in edges.iter().enumerate() {
        ends.extend([(*from, k), (*to, k)]);
    }
    ends.sort_unstable();
    let mut chains = Chains {
        edges,
        ends,
        is_taken: vec![false; edges.len()],
        links: Vec::with_capacity(edges.len()),
    };
    for (edge, &[from, to]) in edges.iter().enumerate() {
        for (is_reversed, start) in [(false, from), (true, to)] {
            if chains.at(start).len() != 2 {
                chains.walk(edge, is_reversed);
            }
        }
    }
    for edge in 0..edges.len() {
        chains.walk(edge, false);
    }
    chains.links
}

struct Chains<'a> {
    edges: &'a [[u32; 2]],
    /// Places with the edges that end there.
    ends: Vec<(u32, usize)>,
    is_taken: Vec<bool>,
    links: Vec<Link>,
}

impl Chains<'_> {
    /// The edges that end in a place.
    fn at(&self, place: u32) -> &[(u32, usize)] {
        let first = self.ends.partition_point(|(other, _)| *other < place);
        let rest = &self.ends[first..];
        let count = rest.iter().take_while(|(other, _)| *other == place).count();
        &rest[..count]
    }

    /// Takes an edge and those after it, up to where not just two meet or all are taken.
    fn walk(&mut self, mut edge: usize, mut is_reversed: bool) {
        let mut is_first = true;
        while !self.is_taken[edge] {
            self.is_taken[edge] = true;
            self.links.push(Link {
                edge,
                is_reversed,
                is_first,
            });
            is_first = false;
            let [from, to] = self.edges[edge];
            let place = if is_reversed { from } else { to };
            if let &[(_, a), (_, b)] = self.at(place) {
                edge = if a == edge { b } else { a };
                is_reversed = self.edges[edge][1] == place;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_follow_each_other_up_to_forks_and_around_loops() {
        // A fork at 3 with arms to 1, 5 and 7, and a loop.
        let edges = [[2, 3], [1, 2], [3, 5], [3, 7], [10, 11], [11, 12], [10, 12]];
        let links = chains(&edges);
        let shown: Vec<_> = links
            .iter()
            .map(|link| (link.edge, link.is_reversed, link.is_first))
            .collect();
        let arm = [(0, true, true), (1, true, false)];
        let others = [(2, false, true), (3, false, true)];
        let around = [(4, false, true), (5, false, false), (6, true, false)];
        assert_eq!(shown, [&arm[..], &others, &around].concat());
    }
}
