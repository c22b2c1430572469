//! Points in columns: which of them lie in a box?

/// A corner in the polygon's plane.
pub(super) type Point = robust::Coord<f64>;

/// Points sorted into columns of equally many, each sorted upwards. Unlike in a grid of equal
/// cells, points that crowd together spread over as many columns as any others.
pub(super) struct Columns {
    columns: Vec<Column>,
    len: usize,
}

struct Column {
    low: f64,
    high: f64,
    /// Indices of points, by y.
    upwards: Vec<u32>,
}

impl Columns {
    /// The columns of the points `members`.
    pub(super) fn new(points: &[Point], mut members: Vec<u32>) -> Self {
        let at = |&member: &u32| points[member as usize];
        members.sort_unstable_by(|a, b| at(a).x.total_cmp(&at(b).x));
        let height = members.len().isqrt().max(1);
        let column = |chunk: &[u32]| {
            let mut upwards = chunk.to_vec();
            upwards.sort_unstable_by(|a, b| at(a).y.total_cmp(&at(b).y));
            Column { low: at(&chunk[0]).x, high: at(&chunk[chunk.len() - 1]).x, upwards }
        };
        Self { columns: members.chunks(height).map(column).collect(), len: members.len() }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The points in the box from `low` to `high`, and a few more.
    pub(super) fn within(
        &self,
        points: &[Point],
        low: Point,
        high: Point,
    ) -> impl Iterator<Item = u32> {
        let first = self.columns.partition_point(|column| column.high < low.x);
        self.columns[first..].iter().take_while(move |column| column.low <= high.x).flat_map(
            move |column| {
                let y = |&member: &u32| points[member as usize].y;
                let bottom = column.upwards.partition_point(|member| y(member) < low.y);
                let upwards = column.upwards[bottom..].iter();
                upwards.take_while(move |&member| y(member) <= high.y).copied()
            },
        )
    }
}
