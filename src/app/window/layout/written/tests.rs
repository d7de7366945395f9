//! What was written by another quadfront stays as it was arranged.

use proptest::prelude::*;

use super::super::Room;
use super::*;

/// The panels of a value in their order, each with the numbers of the docks that it is in, and those that are seen.
fn panes(value: &Value) -> (Vec<(String, Vec<usize>)>, Vec<String>) {
    fn walk(value: &Value, path: &mut Vec<usize>, all: &mut Vec<(String, Vec<usize>)>, seen: &mut Vec<String>) {
        if let Some(name) = value.as_str() {
            return all.push((name.to_owned(), path.clone()));
        }
        let list = ["tabs", "row", "column"].iter().find_map(|key| value[*key].as_array()).unwrap();
        for (k, child) in list.iter().enumerate() {
            path.push(k);
            walk(child, path, all, seen);
            path.pop();
        }
        let active = value["active"].as_u64().and_then(|active| list[active as usize].as_str());
        seen.extend(active.map(str::to_owned));
    }
    let (mut all, mut seen) = (Vec::new(), Vec::new());
    walk(value, &mut Vec::new(), &mut all, &mut seen);
    (all, seen)
}

/// All shares of rows and columns, in order.
fn shares(value: &Value) -> Vec<f64> {
    let own = value["shares"].as_array().into_iter().flatten().filter_map(Value::as_f64);
    let lists = ["tabs", "row", "column"].iter().filter_map(|key| value[*key].as_array());
    own.chain(lists.flatten().flat_map(shares)).collect()
}

/// The names in the order in which they come in another list.
fn only<'a>(names: impl IntoIterator<Item = &'a String>, known: &[String]) -> Vec<&'a String> {
    names.into_iter().filter(|name| known.contains(name)).collect()
}

/// Docks of three columns, one of them two groups, with all panels in an order of the user's.
fn docks(order: &[Pane], cuts: [usize; 3], active: [usize; 4]) -> Value {
    let mut cuts = cuts.to_vec();
    cuts.sort_unstable();
    let names: Vec<&str> = order.iter().map(|pane| pane.name()).collect();
    let bounds = [0, cuts[0] + 1, cuts[1] + 2, cuts[2] + 3, names.len()];
    let tabs = |k: usize| {
        let names = &names[bounds[k]..bounds[k + 1]];
        json!({ "tabs": names, "active": active[k] % names.len() })
    };
    let column = json!({ "column": [tabs(1), tabs(2)], "shares": [0.25, 0.75] });
    json!({ "row": [tabs(0), column, tabs(3)], "shares": [333.0, 700.5, 240.25] })
}

/// The same docks without the panels for which `is_gone`, as an older quadfront wrote them: no docks are empty.
fn without(value: &Value, is_gone: &dyn Fn(&str) -> bool) -> Option<Value> {
    if let Some(name) = value.as_str() {
        return (!is_gone(name)).then(|| value.clone());
    }
    let key = ["tabs", "row", "column"].into_iter().find(|key| value.get(key).is_some())?;
    let (mut list, mut shares, mut active) = (Vec::new(), Vec::new(), 0);
    for (k, child) in value[key].as_array()?.iter().enumerate() {
        if let Some(child) = without(child, is_gone) {
            active = if value["active"] == json!(k) { list.len() } else { active };
            list.push(child);
            shares.push(value["shares"][k].clone());
        }
    }
    let rest = if key == "tabs" { ("active", json!(active)) } else { ("shares", json!(shares)) };
    (!list.is_empty()).then(|| json!({ key: list, rest.0: rest.1 }))
}

proptest! {
    #[test]
    fn docks_from_before_a_panel_existed_stay_as_they_were_arranged(
        order in Just(Pane::ALL.to_vec()).prop_shuffle(),
        cuts in [0..Pane::ALL.len() - 3, 0..Pane::ALL.len() - 3, 0..Pane::ALL.len() - 3],
        active in any::<[u8; 4]>(),
        gone in proptest::collection::vec(any::<bool>(), Pane::ALL.len()),
        room in 0..Room::ALL.len(),
    ) {
        let columns = Room::ALL[room].columns(800.0);
        let whole = docks(&order, cuts, active.map(usize::from));
        prop_assert_eq!(write(&read(&whole, &columns).unwrap().0), whole.clone());
        let is_gone = |name: &str| Pane::ALL.iter().zip(&gone).any(|(pane, gone)| *gone && pane.name() == name);
        let Some(old) = without(&whole, &is_gone) else { return Ok(()) };
        let (tree, _) = read(&old, &columns).unwrap();
        let new = write(&tree);
        let ((before, seen), (after, seen_now)) = (panes(&old), panes(&new));
        // All panels are there, once.
        let mut names: Vec<&str> = after.iter().map(|pane| pane.0.as_str()).collect();
        names.sort_unstable();
        let mut all = Pane::ALL.map(Pane::name);
        all.sort_unstable();
        prop_assert_eq!(&names[..], &all[..]);
        // What the user has arranged stays: the order, the docks, the splitters, and what is seen.
        let known: Vec<String> = before.iter().map(|pane| pane.0.clone()).collect();
        prop_assert_eq!(only(after.iter().map(|pane| &pane.0), &known), known.iter().collect::<Vec<_>>());
        prop_assert_eq!(shares(&new), shares(&old));
        prop_assert_eq!(seen_now, seen);
        let dock_of = |list: &[(String, Vec<usize>)], name: &str| {
            list.iter().find(|pane| pane.0 == name).map(|pane| pane.1[..pane.1.len() - 1].to_vec())
        };
        for name in &known {
            prop_assert_eq!(dock_of(&after, name), dock_of(&before, name));
        }
        // A panel that was missing is in the tabs of one that it is with at first, if there is one.
        for (pane, _) in Pane::ALL.into_iter().zip(&gone).filter(|(_, gone)| **gone) {
            let groups = columns.iter().flat_map(|column| &column.groups);
            let tabs = groups.map(|group| &group.0).find(|tabs| tabs.contains(&pane)).unwrap();
            let with: Vec<&str> = tabs.iter().filter(|other| **other != pane).map(|other| other.name()).collect();
            let has_company = known.iter().any(|name| with.contains(&name.as_str()));
            let own = dock_of(&after, pane.name());
            prop_assert!(!has_company || with.iter().any(|name| dock_of(&after, name) == own), "{}", new);
        }
    }
}

#[test]
fn what_is_unknown_or_there_twice_is_left_out_and_what_are_no_docks_is_refused() {
    let columns = Room::Wide.columns(800.0);
    let names: Vec<&str> = Pane::ALL[1..].iter().map(|pane| pane.name()).collect();
    let first = Pane::ALL[0].name();
    let tabs = json!({ "tabs": [first], "active": 0 });
    let value = json!({ "row": [tabs, { "tabs": names, "active": 2 }], "shares": [344.0, 900.0] });
    assert_eq!(write(&read(&value, &columns).unwrap().0), value);
    let more = json!({
        "row": [{ "tabs": ["No such panel", first], "active": 1 }, { "tabs": ["Gone"] }, { "tabs": names, "active": 2 },
                first, { "column": [] }],
        "shares": [344.0, 50.0, 900.0, -1.0]
    });
    assert_eq!(write(&read(&more, &columns).unwrap().0), value);
    let no_shares = json!({ "row": [tabs, { "tabs": names, "active": 2 }] });
    assert_eq!(shares(&write(&read(&no_shares, &columns).unwrap().0)), [1.0, 1.0]);
    let mut deep = json!({ "tabs": [first] });
    (0..1000).for_each(|_| deep = json!({ "tabs": [deep] }));
    for bad in
        [json!(null), json!("Inspector"), json!({ "tabs": [] }), json!({ "row": ["Gone"], "shares": [1.0] }), deep]
    {
        assert!(read(&bad, &columns).is_none(), "{bad}");
    }
}
