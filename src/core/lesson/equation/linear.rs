//! An equation as text in one line.

use super::{Class, Term, classes};

/// Terms as text.
pub(super) fn text(row: &[Term]) -> String {
    spaced(row, true)
}

/// Terms as text, in scripts without blanks around signs.
fn spaced(row: &[Term], is_wide: bool) -> String {
    let mut text = String::new();
    let mut before: Option<(&Term, Class)> = None;
    for (term, class) in row.iter().zip(classes(row)) {
        let Some(class) = class else {
            // Whatever its width, room is a blank.
            if matches!(term, Term::Space(room) if *room > 0) && !text.ends_with(' ') && !text.is_empty() {
                text.push(' ');
            }
            continue;
        };
        let has_blank = before.is_some_and(|before| has_blank(before, (term, class), is_wide));
        if has_blank && !text.ends_with(' ') {
            text.push(' ');
        }
        text += &said(term);
        before = Some((term, class));
    }
    text
}

/// Whether a blank stands between two terms.
fn has_blank((left, before): (&Term, Class), (right, after): (&Term, Class), is_wide: bool) -> bool {
    use Class::{Binary, Closing, Opening, Operator, Punctuation, Relation};
    // Two things that are more than a sign each would run into one another.
    let is_long = |term: &Term| !matches!(term, Term::Sign(_) | Term::Digits(_) | Term::Group(_));
    let opens = |term: &Term, class| class == Opening || matches!(term, Term::Fenced { fences: [Some(_), _], .. });
    match (before, after) {
        (_, Closing | Punctuation) | (Opening, _) => false,
        (Punctuation, _) | (Binary | Relation, _) | (_, Binary | Relation) => is_wide,
        (Operator, _) if matches!(left, Term::Function { .. }) && opens(right, after) => false,
        (Operator, _) | (_, Operator) => true,
        (_, Opening) => matches!(left, Term::Fraction { .. }),
        _ => is_long(left) || is_long(right),
    }
}

fn said(term: &Term) -> String {
    match term {
        Term::Sign(sign) => sign.glyph.to_string(),
        Term::Digits(text) | Term::Text(text) => text.clone(),
        Term::Function { name, .. } => (*name).to_owned(),
        Term::Value(quantity) => format!("{{{{{}}}}}", quantity.name()),
        Term::Group(row) => text(row),
        Term::Fraction { above, below } => format!("{}/{}", factor(above), factor(below)),
        Term::Root { degree, inside } if degree.is_empty() => format!("sqrt({})", text(inside)),
        Term::Root { degree, inside } => format!("root_{}({})", script(degree), text(inside)),
        Term::Scripts { base, low, high } => {
            let mut said = said(base);
            if !low.is_empty() {
                said += &format!("_{}", script(low));
            }
            let is_raised = |term: &&Term| matches!(term, Term::Sign(sign) if sign.is_raised());
            let (raised, high) = high.split_at(high.iter().take_while(is_raised).count());
            said += &text(raised);
            if !high.is_empty() {
                said += &format!("^{}", script(high));
            }
            said
        }
        Term::Fenced { fences: [left, right], inside } => {
            let fence = |fence: &Option<char>| fence.map_or(String::new(), String::from);
            format!("{}{}{}", fence(left), text(inside), fence(right))
        }
        Term::Space(_) => String::new(),
    }
}

/// What stands above or below a bar that is written as a stroke: in brackets unless it is one thing.
fn factor(row: &[Term]) -> String {
    // A function and its bracket are one thing.
    let is_call = match row {
        [first, .., last] => {
            let opens = |term: &Term| matches!(term.class(), Some(Class::Opening));
            let inner = &row[1..row.len() - 1];
            matches!(first, Term::Function { .. })
                && row.get(1).is_some_and(opens)
                && last.class() == Some(Class::Closing)
                && inner.iter().filter(|term| opens(term)).count() == 1
        }
        _ => false,
    };
    match row {
        [Term::Fraction { .. } | Term::Fenced { fences: [None, _] | [_, None], .. }] => format!("({})", text(row)),
        [Term::Group(inside)] => factor(inside),
        [_] => text(row),
        _ if is_call => text(row),
        _ => format!("({})", text(row)),
    }
}

/// A subscript or superscript: in brackets unless it is one sign or number.
fn script(row: &[Term]) -> String {
    match row {
        [Term::Sign(_) | Term::Digits(_) | Term::Text(_) | Term::Value(_)] => spaced(row, false),
        _ if row.iter().all(|term| matches!(term, Term::Sign(sign) if sign.glyph.is_alphabetic())) => {
            spaced(row, false)
        }
        _ => format!("({})", spaced(row, false)),
    }
}
