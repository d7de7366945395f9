//! Decisions as tables: the candidates of a side edge, and the front in the order of the selection.

use super::numbers::{edge, segment};
use super::side::{letter, name, passed};
use super::why::{key_name, key_text};
use crate::core::convert::Candidates;
use crate::core::kernel::number::{UNDEFINED, counted, degrees, fixed};
use crate::core::mesh::NodeId;
use crate::core::run::front_table::{FrontTable, Row};

/// A table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// What it is about.
    pub title: String,
    /// How many entries there are, in words.
    pub counts: String,
    /// The heads of the columns.
    pub head: Vec<String>,
    /// The entries, in the order in which they are read.
    pub entries: Vec<Entry>,
    /// Whether the last column has words, and not numbers.
    pub ends_in_words: bool,
}

/// A row of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its texts, by column.
    pub texts: Vec<String>,
    /// Whether it was chosen.
    pub is_chosen: bool,
    /// Its place in what the table was made of.
    pub place: usize,
}

/// The candidates for a side edge at the node `from` (4.3.4), each with the reason if it was not chosen. The chosen one
/// comes first, then all others as they are met from the base.
pub fn candidates(tried: &Candidates, from: NodeId) -> Table {
    let which = if name(tried.side) == "left" { "Left" } else { "Right" };
    let swaps = tried.edges.iter().filter(|edge| edge.swap.is_some()).count();
    let count = |n: usize, one: &str| if n == 0 { format!("no {one}") } else { counted(n as u64, one) };
    let counts = format!("{} tried, {}", count(tried.edges.len() - swaps, "edge"), count(swaps, "swap"));
    let mut places: Vec<usize> = (0..tried.edges.len()).collect();
    places.sort_by_key(|place| tried.edges[*place].passed.is_some());
    let entry = |place: usize| {
        let candidate = &tried.edges[place];
        let verdict = candidate.passed.map_or("chosen".to_owned(), |why| passed(why, candidate, tried));
        let verdict = match candidate.swap {
            None => verdict,
            Some(across) => format!("swap {}: {verdict}", edge(across)),
        };
        let ends = edge([from, candidate.node]);
        let [angle, off] = [candidate.angle, candidate.deviation].map(degrees);
        let texts = vec![ends, angle, off, fixed(candidate.length, 2), verdict];
        Entry { texts, is_chosen: candidate.passed.is_none(), place }
    };
    Table {
        title: format!("{which} side at {}", letter(tried.side)),
        counts,
        head: ["edge", "angle °", "off °", "length", "verdict"].map(str::to_owned).to_vec(),
        entries: places.into_iter().map(entry).collect(),
        ends_in_words: true,
    }
}

/// The heads of the table of the front.
pub const FRONT: [&str; 10] = ["#", "A → B", "cl", "H", "len", "key", "θA °", "θB °", "lv", "lp"];

/// A segment of the front as a row of its table, with as many decimals of H as are said.
pub fn front_row(table: &FrontTable, row: &Row, rank: usize, decimals: usize) -> [String; FRONT.len()] {
    let is_ranked = !row.is_deferred && table.is_of_face(row);
    [
        if is_ranked { rank.to_string() } else { UNDEFINED.to_owned() },
        segment([row.a, row.b]),
        row.class.to_string(),
        fixed(row.h_value, decimals),
        fixed(row.length_metric, 2),
        key_text(row, table.parameters()),
        degrees(row.theta[0]),
        degrees(row.theta[1]),
        row.level.to_string(),
        (row.front_loop + 1).to_string(),
    ]
}

/// The first segments of the front in the order of the selection (4.3.3), at most so many, and the base if it is not
/// among them.
pub fn front(table: &FrontTable, base: [NodeId; 2], most: usize) -> Table {
    let order = table.in_order();
    let decimals = crate::core::kernel::number::decimals(table.rows.iter().map(|row| row.h_value));
    let is_base = |place: usize| [table.rows[place].a, table.rows[place].b] == base;
    let ranked = order.iter().enumerate().filter(|(k, place)| *k < most || is_base(**place));
    let entries: Vec<Entry> = ranked
        .map(|(k, &place)| {
            let texts = front_row(table, &table.rows[place], k + 1, decimals).to_vec();
            Entry { texts, is_chosen: is_base(place), place }
        })
        .collect();
    let all = counted(order.len() as u64, "segment");
    let counts = if entries.len() < order.len() { format!("{} of {all}", entries.len()) } else { all };
    let [key, _] = key_name(table.parameters());
    let mut head = FRONT.map(str::to_owned).to_vec();
    head[5] = key.to_owned();
    Table { title: "The front in the order of the selection".to_owned(), counts, head, entries, ends_in_words: false }
}
