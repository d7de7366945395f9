//! A sweep as tables: CSV for spreadsheets, and text for people.

use super::{Cell, Sweep, TIME};
use crate::core::kernel::Shortest;
use crate::core::record::report::figures::FIGURES;

impl Sweep {
    /// A line of keys and figures, then a line for each cell; what a cell does not have is empty. The time of each cell
    /// is a column only on request: all others are the same for every run.
    pub fn csv(&self, with_time: bool) -> String {
        let figures: Vec<_> = FIGURES.iter().enumerate().filter(|f| with_time || f.1.name != TIME).collect();
        let keys = self.axes.iter().map(|axis| axis.key);
        let head: Vec<_> = keys.chain(figures.iter().map(|f| f.1.name)).chain(["refused"]).collect();
        let mut text = head.join(",") + "\n";
        for (k, cell) in self.cells.iter().enumerate() {
            let mut line: Vec<_> = self.values(k).into_iter().map(|(_, value)| quoted(value)).collect();
            let number = |x: Option<f64>| x.map_or_else(String::new, |x| Shortest(x).to_string());
            let value = |i: usize| match cell {
                Some(Cell::Figures(values)) => number(values.get(i).copied().flatten()),
                _ => String::new(),
            };
            line.extend(figures.iter().map(|f| value(f.0)));
            line.push(match cell {
                Some(Cell::Refused(why)) => quoted(why),
                _ => String::new(),
            });
            text += &(line.join(",") + "\n");
        }
        text
    }
}

/// A field of a table with commas: in quotes where it needs them (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::record::sweep::Axis;
    use crate::core::run::Run;

    #[test]
    fn a_table_has_a_line_for_each_cell_and_no_time_unless_asked_for() {
        let run = Run::of(built_in::named("example1").unwrap().unwrap());
        let mut sweep = Sweep::new(&run, vec![Axis::parse("c=1.5,2,3").unwrap()]).unwrap();
        let figures = (0..FIGURES.len()).map(|k| (k != 1).then_some(k as f64 + 0.5)).collect();
        sweep.fill(0, Cell::Figures(figures));
        sweep.fill(1, Cell::Refused("no, \"not\" so".to_owned()));
        let lines = |with_time| sweep.csv(with_time).lines().map(str::to_owned).collect::<Vec<_>>();
        let (plain, timed) = (lines(false), lines(true));
        let commas = ",".repeat(FIGURES.len());
        assert!(plain[0].starts_with("c,quads,nodes,") && plain[0].ends_with(",refused"), "{}", plain[0]);
        assert!(plain[1].starts_with("1.5,0.5,,2.5,"), "{}", plain[1]);
        assert_eq!(plain[2], format!("2{commas}\"no, \"\"not\"\" so\""));
        assert_eq!(plain[3], format!("3{commas}"));
        assert!(!plain[0].contains("seconds") && timed[0].ends_with(",seconds,refused"));
    }
}
