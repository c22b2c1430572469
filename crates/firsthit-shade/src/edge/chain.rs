//! Edges joined into chains, so that dashes continue from one edge to the next.
//!
//! 1. Sort the ends of edges by their places.
//! 2. From each place where other than two edges meet, follow each edge to the next such place.
//! 3. The rest are closed loops.

/// An edge in a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Link {
    /// The index of the edge.
    pub(super) edge: usize,
    /// Whether the chain follows it from the second end to the first.
    pub(super) is_reversed: bool,
    /// Whether a chain begins with it.
    pub(super) is_first: bool,
}

/// All edges, given by the places of their ends, as chains one after the other.
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
    /// The places of the edges' ends, each with its edge, in order.
    ends: Vec<(u32, usize)>,
    is_taken: Vec<bool>,
    links: Vec<Link>,
}

impl Chains<'_> {
    /// The edges that end in a place.
    fn at(&self, place: u32) -> &[(u32, usize)] {
        let first = self.ends.partition_point(|(other, _)| *other < place);
        let rest = &self.ends[first..];
        // Not edge by edge: that would be quadratic where many edges meet in one place, as in a
        // fan.
        &rest[..rest.partition_point(|(other, _)| *other == place)]
    }

    /// Takes an edge and those after it, up to a place where other than two meet, or until all are
    /// taken.
    fn walk(&mut self, mut edge: usize, mut is_reversed: bool) {
        let mut is_first = true;
        while !self.is_taken[edge] {
            self.is_taken[edge] = true;
            self.links.push(Link { edge, is_reversed, is_first });
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
        let shown: Vec<_> =
            links.iter().map(|link| (link.edge, link.is_reversed, link.is_first)).collect();
        let arm = [(0, true, true), (1, true, false)];
        let others = [(2, false, true), (3, false, true)];
        let around = [(4, false, true), (5, false, false), (6, true, false)];
        assert_eq!(shown, [&arm[..], &others, &around].concat());
    }

    /// Edge by edge it would take minutes.
    #[test]
    fn a_fan_of_edges_takes_no_quadratic_time() {
        let count = 200_000;
        let fan: Vec<[u32; 2]> = (1..=count).map(|end| [0, end]).collect();
        let start = std::time::Instant::now();
        let links = chains(&fan);
        assert!(start.elapsed().as_secs() < 20);
        assert_eq!(links.len(), fan.len());
        assert!(links.iter().all(|link| link.is_first));
    }
}
