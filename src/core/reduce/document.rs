//! The text of a case as an ordered tree that can be changed and written again. Numbers keep their digits, and formulas
//! their order; comments are lost.

use std::collections::BTreeSet;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::core::case::table::Source;
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::Shortest;

/// Longest line that is not broken.
const WIDTH: usize = 118;

/// A value of a case.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    /// A text.
    Text(String),
    /// A number or a flag, as written.
    Bare(String),
    /// A list.
    List(Vec<Node>),
    /// A table.
    Table(Keys),
}

/// The keys of a table with their values, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Keys(pub Vec<(String, Node)>);

impl Keys {
    /// Parses the text of a case, which has been read before.
    ///
    /// # Errors
    /// Text that is not TOML.
    pub fn parse(text: &str, file: &str) -> Result<Keys, Fault> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Source::new(file, text);
        let document = source.parse().map_err(|fault| fault.of_kind(FaultKind::Syntax))?;
        Ok(keys(document.get_ref(), text))
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.0.iter().find(|(own, _)| own == key).map(|(_, value)| value)
    }

    /// The value of a key, to change it.
    pub fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.0.iter_mut().find(|(own, _)| own == key).map(|(_, value)| value)
    }

    /// Whether it has a key.
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// The text under a key; empty without one.
    pub fn word(&self, key: &str) -> &str {
        match self.get(key) {
            Some(Node::Text(text)) => text,
            _ => "",
        }
    }

    /// The list under a key; empty without one.
    pub fn list(&self, key: &str) -> &[Node] {
        match self.get(key) {
            Some(Node::List(list)) => list,
            _ => &[],
        }
    }

    /// The texts of the list under a key.
    pub fn names(&self, key: &str) -> Vec<String> {
        self.list(key).iter().filter_map(Node::text).map(str::to_owned).collect()
    }

    /// The tables of `[[key]]`.
    pub fn tables(&self, key: &str) -> impl Iterator<Item = &Keys> {
        self.list(key).iter().filter_map(Node::table)
    }

    /// The tables of `[[key]]`, to change them.
    pub fn tables_mut(&mut self, key: &str) -> impl Iterator<Item = &mut Keys> {
        let list = match self.get_mut(key) {
            Some(Node::List(list)) => list.as_mut_slice(),
            _ => &mut [],
        };
        list.iter_mut().filter_map(Node::table_mut)
    }

    /// Sets a key, in its place or at the end.
    pub fn set(&mut self, key: &str, value: Node) {
        match self.get_mut(key) {
            Some(old) => *old = value,
            None => self.0.push((key.to_owned(), value)),
        }
    }

    /// Removes a key.
    pub fn remove(&mut self, key: &str) {
        self.0.retain(|(own, _)| own != key);
    }

    /// Keeps what `keep` says of the list under a key, by index; an empty list goes with its key.
    pub fn filter(&mut self, key: &str, keep: impl Fn(usize, &Node) -> bool) {
        let Some(Node::List(list)) = self.get_mut(key) else { return };
        let mut index = 0..;
        list.retain(|node| index.next().is_some_and(|i| keep(i, node)));
        if list.is_empty() {
            self.remove(key);
        }
    }

    /// Keeps those names of the list under a key that are known.
    pub fn only_names(&mut self, key: &str, known: &BTreeSet<String>) {
        self.filter(key, |_, node| node.text().is_some_and(|name| known.contains(name)));
    }

    /// The text of the case.
    pub fn written(&self) -> String {
        let mut text = String::new();
        let is_section = |node: &Node| match node {
            Node::Table(_) => true,
            Node::List(list) => matches!(list.first(), Some(Node::Table(_))),
            _ => false,
        };
        for (key, node) in self.0.iter().filter(|(_, node)| !is_section(node)) {
            line(&mut text, key, node);
        }
        for (key, node) in self.0.iter().filter(|(_, node)| is_section(node)) {
            let (head, tables): (_, Vec<&Node>) = match node {
                Node::List(list) => (format!("\n[[{}]]\n", quoted_key(key)), list.iter().collect()),
                table => (format!("\n[{}]\n", quoted_key(key)), vec![table]),
            };
            for table in tables.into_iter().filter_map(Node::table) {
                text.push_str(&head);
                table.0.iter().for_each(|(key, node)| line(&mut text, key, node));
            }
        }
        text
    }
}

impl Node {
    /// A number.
    pub fn number(number: f64) -> Node {
        Node::Bare(Shortest(number + 0.0).to_string())
    }

    /// A list of numbers, such as a point.
    pub fn point(numbers: &[f64]) -> Node {
        Node::List(numbers.iter().map(|&x| Node::number(x)).collect())
    }

    /// A list of names.
    pub fn names<'n>(names: impl IntoIterator<Item = &'n String>) -> Node {
        Node::List(names.into_iter().map(|name| Node::Text(name.clone())).collect())
    }

    /// The text that it is.
    pub fn text(&self) -> Option<&str> {
        match self {
            Node::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The number that it is.
    pub fn value(&self) -> Option<f64> {
        match self {
            Node::Bare(text) => text.replace('_', "").parse().ok().filter(|x: &f64| x.is_finite()),
            _ => None,
        }
    }

    /// The list that it is; empty for anything else.
    pub fn items(&self) -> &[Node] {
        match self {
            Node::List(list) => list,
            _ => &[],
        }
    }

    /// The table that it is.
    pub fn table(&self) -> Option<&Keys> {
        match self {
            Node::Table(keys) => Some(keys),
            _ => None,
        }
    }

    fn table_mut(&mut self) -> Option<&mut Keys> {
        match self {
            Node::Table(keys) => Some(keys),
            _ => None,
        }
    }

    fn inline(&self) -> String {
        let joined = |parts: Vec<String>| parts.join(", ");
        match self {
            Node::Text(text) => toml::Value::String(text.replace(['\n', '\r'], " ")).to_string(),
            Node::Bare(text) => text.clone(),
            Node::List(list) => format!("[{}]", joined(list.iter().map(Node::inline).collect())),
            Node::Table(keys) => {
                let pair = |(key, node): &(String, Node)| format!("{} = {}", quoted_key(key), node.inline());
                format!("{{ {} }}", joined(keys.0.iter().map(pair).collect()))
            }
        }
    }
}

/// Writes one key; a list that is too long for a line is broken between its entries.
fn line(text: &mut String, key: &str, node: &Node) {
    let plain = format!("{} = {}", quoted_key(key), node.inline());
    match node {
        Node::List(list) if plain.len() > WIDTH => {
            text.push_str(&format!("{} = [\n", quoted_key(key)));
            let mut row = String::new();
            for entry in list.iter().map(Node::inline) {
                if !row.is_empty() && row.len() + entry.len() + 6 > WIDTH {
                    text.push_str(&format!("    {row}\n"));
                    row.clear();
                }
                row.push_str(&format!("{}{entry},", if row.is_empty() { "" } else { " " }));
            }
            text.push_str(&format!("    {row}\n]\n"));
        }
        _ => text.push_str(&format!("{plain}\n")),
    }
}

fn quoted_key(key: &str) -> String {
    let is_bare = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if is_bare { key.to_owned() } else { toml::Value::String(key.to_owned()).to_string() }
}

fn keys(table: &DeTable<'_>, text: &str) -> Keys {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    Keys(entries.into_iter().map(|(key, value)| (key.get_ref().to_string(), node(value, text))).collect())
}

fn node(value: &Spanned<DeValue<'_>>, text: &str) -> Node {
    match value.get_ref() {
        DeValue::String(own) => Node::Text(own.to_string()),
        DeValue::Array(array) => Node::List(array.iter().map(|entry| node(entry, text)).collect()),
        DeValue::Table(table) => Node::Table(keys(table, text)),
        _ => Node::Bare(text.get(value.span()).unwrap_or_default().to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::core::case::{Case, built_in};

    #[test]
    fn every_built_in_case_is_the_same_case_when_it_is_written_again() {
        // Places and the text itself differ.
        let plain = |text: &str| {
            let case = Case::parse(text, "a", "a.toml", Path::new("")).unwrap();
            let lines = without_lines(&format!("{:?} {:?}", case.domain, case.fields));
            (case.title, case.parameters, case.gradation, case.symmetry, case.split_odd, lines)
        };
        for (name, text) in built_in::all() {
            let written = Keys::parse(text, "a.toml").unwrap().written();
            assert_eq!(plain(&written), plain(text), "{name}");
            assert_eq!(Keys::parse(&written, "a.toml").unwrap().written(), written, "{name}");
        }
    }

    /// A debug text without the numbers of lines.
    fn without_lines(text: &str) -> String {
        let mut parts = text.split("a.toml, line ");
        let mut plain = parts.next().unwrap_or_default().to_owned();
        parts.for_each(|part| plain.push_str(part.trim_start_matches(|c: char| c.is_ascii_digit())));
        plain
    }

    #[test]
    fn long_lists_are_broken_and_keys_that_need_it_are_quoted() {
        let points: Vec<Node> = (0..40).map(|i| Node::point(&[f64::from(i) * 0.1, 1e-9])).collect();
        let keys =
            Keys(vec![("a b".to_owned(), Node::Text("\"x\"".to_owned())), ("points".to_owned(), Node::List(points))]);
        let written = keys.written();
        assert!(written.lines().all(|line| line.len() <= 120) && written.lines().count() > 5, "{written}");
        assert_eq!(Keys::parse(&written, "").unwrap(), keys);
    }
}
