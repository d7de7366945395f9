//! Joins the bindings and the page's script into one module, since a page that is opened as a file can import no other.
//!
//! The bindings become the value of a function, `{ default: …, NAME: … }`, as `import *` would give it. Only whole
//! lines are read: wasm-bindgen writes every `export` at the beginning of one. What is not known is refused, so that
//! another version of it makes an error here and not a page that does not start.

/// The file of the bindings, as page.js imports it.
pub const BINDINGS: &str = "./quadfront.js";

/// The module that is both: page.js, with the bindings in place of their import.
pub fn joined(bindings: &str, page: &str) -> Result<String, String> {
    let mut text = String::new();
    let mut imported = false;
    for line in page.lines() {
        if line.starts_with("export ") || line.starts_with("export{") {
            return Err(format!("page.js exports something, and nobody can import it: {line}"));
        }
        if !line.starts_with("import ") && !line.starts_with("import{") {
            text += line;
        } else if imported {
            return Err(format!("page.js imports more than its one module: {line}"));
        } else {
            let (default, all) = imported_names(line).ok_or_else(|| {
                format!(
                    "page.js must import by the line `import init, * as program from \"{BINDINGS}\";`, and not: {line}"
                )
            })?;
            text += &format!("const {all} = {};\nconst {default} = {all}.default;", value(bindings)?);
            imported = true;
        }
        text.push('\n');
    }
    if imported { Ok(text) } else { Err(format!("page.js does not import {BINDINGS}")) }
}

/// DEFAULT and ALL of `import DEFAULT, * as ALL from "./quadfront.js"`.
fn imported_names(line: &str) -> Option<(&str, &str)> {
    let names = line.trim_end().trim_end_matches(';').strip_prefix("import ")?.trim_end();
    let (names, file) = names.rsplit_once(" from ")?;
    if file.trim() != format!("\"{BINDINGS}\"") && file.trim() != format!("'{BINDINGS}'") {
        return None;
    }
    let (default, all) = names.split_once(',')?;
    let (default, all) = (default.trim(), all.trim().strip_prefix('*')?.trim_start().strip_prefix("as ")?.trim());
    (is_name(default) && is_name(all)).then_some((default, all))
}

/// The bindings as an expression: a function that is called at once and returns what they export.
fn value(bindings: &str) -> Result<String, String> {
    let mut text = String::from("(() => {\n");
    // What is exported, and the name inside.
    let mut exports: Vec<(&str, &str)> = Vec::new();
    for line in bindings.lines() {
        if line.starts_with("import ") || line.starts_with("import{") {
            return Err(format!("the bindings import a file of their own, which one page cannot hold: {line}"));
        }
        if let Some(exported) = line.strip_prefix("export") {
            let unknown = || format!("the bindings export in a way that is not known: {line}");
            let exported = exported.trim_start();
            if let Some(list) = exported.strip_prefix('{') {
                let (list, rest) = list.split_once('}').ok_or_else(unknown)?;
                if !matches!(rest.trim(), "" | ";") {
                    return Err(unknown());
                }
                for entry in list.split(',').map(str::trim).filter(|entry| !entry.is_empty()) {
                    let (inside, outside) = entry.split_once(" as ").unwrap_or((entry, entry));
                    let outside = outside.trim().trim_matches(['\'', '"']);
                    if !is_name(inside.trim()) || outside.contains(['\'', '"', '\\']) {
                        return Err(unknown());
                    }
                    exports.push((outside, inside.trim()));
                }
                continue;
            }
            let name = declared_name(exported).ok_or_else(unknown)?;
            exports.push((name, name));
            text += exported;
        } else {
            text += line;
        }
        text.push('\n');
    }
    if !exports.iter().any(|&(outside, _)| outside == "default") {
        return Err("the bindings export no default, which starts them".into());
    }
    let list: Vec<String> = exports.iter().map(|(outside, inside)| format!("\"{outside}\": {inside}")).collect();
    text += &format!("return {{ {} }};\n}})()", list.join(", "));
    Ok(text)
}

/// The name that a declaration gives: a function, a class or a constant.
fn declared_name(declaration: &str) -> Option<&str> {
    let kinds = ["async function* ", "async function ", "function* ", "function ", "class ", "const ", "let ", "var "];
    let rest = kinds.iter().find_map(|kind| declaration.strip_prefix(kind))?.trim_start();
    let end = rest.find(|c: char| !is_part_of_a_name(c)).unwrap_or(rest.len());
    let (name, next) = rest.split_at(end);
    // `const { a, b } = …` and `const a = 1, b = 2` have more names: the first is refused here, the second is nothing
    // that wasm-bindgen writes.
    (is_name(name) && next.trim_start().starts_with(['(', '{', '=', 'e'])).then_some(name)
}

fn is_part_of_a_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$'
}

fn is_name(name: &str) -> bool {
    name.chars().all(is_part_of_a_name) && name.chars().next().is_some_and(|c| !c.is_numeric())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const BOUND: &str = "/* @ts-self-types */\n/**\n * export function in a comment\n */\nexport class Counter {\n\
        more() { return 1; }\n}\n/** @enum {0 | 1} */\nexport const Kind = Object.freeze({ A: 0, \"0\": \"A\" });\n\
        export function say(x) {\n    return x;\n}\nexport async function wait() {}\nfunction inner() {}\n\
        export { inner as outer }\nexport { inner as 'odd name' }\nlet wasm;\n\
        async function __wbg_init(module_or_path) {}\nfunction initSync() {}\n\
        export { initSync, __wbg_init as default };\n";
    const PAGE: &str = "// Starts it.\nimport init, * as program from \"./quadfront.js\";\nawait init();\n";

    #[test]
    fn every_form_of_export_becomes_an_entry_of_one_value() {
        let text = joined(BOUND, PAGE).unwrap();
        assert!(text.starts_with("// Starts it.\nconst program = (() => {\n"), "{text}");
        assert!(!text.lines().any(|line| line.starts_with("export") || line.starts_with("import")), "{text}");
        assert!(
            text.contains(
                "return { \"Counter\": Counter, \"Kind\": Kind, \"say\": say, \"wait\": wait, \"outer\": inner, \
                 \"odd name\": inner, \"initSync\": initSync, \"default\": __wbg_init };\n})();\n\
                 const init = program.default;\nawait init();\n"
            ),
            "{text}"
        );
        assert!(text.contains("\nclass Counter {\n") && text.contains("\nasync function wait() {}\n"), "{text}");
        assert!(text.contains("\n * export function in a comment\n"), "{text}");
    }

    #[test]
    fn the_import_may_be_written_in_several_ways() {
        for line in [
            "import init, * as program from './quadfront.js'",
            "import  init ,  *  as  program  from \"./quadfront.js\" ;",
            "import start, * as $all from \"./quadfront.js\";",
        ] {
            assert!(imported_names(line).is_some(), "{line}");
        }
        assert_eq!(imported_names("import a, * as b from './quadfront.js'"), Some(("a", "b")));
    }

    #[test]
    fn what_cannot_be_joined_is_refused_with_its_line() {
        for (bindings, page, said) in [
            (BOUND, "let a = 1;", "does not import"),
            (BOUND, "import init from \"./quadfront.js\";", "must import by the line"),
            (BOUND, "import init, * as program from \"./other.js\";", "must import by the line"),
            (BOUND, "import a, * as b from \"./quadfront.js\";\nimport c from \"./c.js\";", "more than its one module"),
            (BOUND, "import a, * as b from \"./quadfront.js\";\nexport const x = 1;", "exports something"),
            ("import { a } from './snippets/a.js';", PAGE, "import a file of their own"),
            ("export default function a() {}", PAGE, "not known: export default function"),
            ("export * from 'a';", PAGE, "not known: export * from"),
            ("export { a,", PAGE, "not known: export { a,"),
            ("export { a } from 'b';", PAGE, "not known: export { a } from"),
            ("export const { a, b } = c;", PAGE, "not known: export const {"),
            ("export function a() {}", PAGE, "no default"),
        ] {
            let fault = joined(bindings, page).unwrap_err();
            assert!(fault.contains(said), "{fault}");
        }
    }
}
