//! Colours and layers of faces: styled items and assignments of layers (ISO 10303-46).

use std::collections::BTreeMap;

use super::exchange::Exchange;
use super::fields::Entity;

/// How deep a colour lies below its styled item.
const DEEPEST: usize = 8;
/// The most instances of a style that are looked at.
const MOST: usize = 200;

/// By instance: the names of the groups that its faces are in, the colour first.
#[derive(Debug, Default)]
pub(super) struct Styles {
    colours: BTreeMap<u64, String>,
    layers: BTreeMap<u64, Vec<String>>,
}

impl Styles {
    /// Reads the styles of a file; what cannot be read is no style.
    pub fn read(file: &Exchange<'_>) -> Styles {
        let mut styles = Styles::default();
        for id in file.of_keywords(&["STYLED_ITEM", "OVER_RIDING_STYLED_ITEM"]) {
            let Ok(entity) = file.entity(id) else { continue };
            let (Ok(of), Ok(item)) = (entity.first().instances(1), entity.first().instance(2)) else { continue };
            if let Some(colour) = of.into_iter().find_map(|style| colour(file, style)) {
                styles.colours.insert(item, colour);
            }
        }
        for id in file.of_keywords(&["PRESENTATION_LAYER_ASSIGNMENT"]) {
            let Ok(entity) = file.entity(id) else { continue };
            let (name, Ok(items)) = (entity.first().text(0), entity.first().instances(2)) else { continue };
            if !name.is_empty() {
                items.into_iter().for_each(|item| styles.layers.entry(item).or_default().push(format!("layer {name}")));
            }
        }
        styles
    }

    /// The groups of a face that belongs to these instances, the outermost first: the innermost colour, all layers.
    pub fn groups(&self, owners: &[u64]) -> Vec<String> {
        let colour = owners.iter().rev().find_map(|owner| self.colours.get(owner));
        let mut groups: Vec<String> = colour.map(|colour| format!("colour {colour}")).into_iter().collect();
        groups.extend(owners.iter().filter_map(|owner| self.layers.get(owner)).flatten().cloned());
        groups
    }
}

/// The colour of surfaces in a style: the first below it that is no colour of curves.
fn colour(file: &Exchange<'_>, style: u64) -> Option<String> {
    let mut level = vec![style];
    let mut looked = 0;
    for _ in 0..DEEPEST {
        let mut next = Vec::new();
        for id in level {
            looked += 1;
            let Ok(entity) = file.entity(id) else { continue };
            if let Some(found) = own_colour(&entity) {
                return Some(found);
            }
            if looked < MOST && !entity.is("CURVE_STYLE") && !entity.is("POINT_STYLE") {
                next.extend(entity.first().all_instances());
            }
        }
        level = next;
    }
    None
}

fn own_colour(entity: &Entity<'_, '_>) -> Option<String> {
    if let Some(fields) = entity.record("COLOUR_RGB") {
        let part = |i: usize| fields.number(i).ok().map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
        let [red, green, blue] = [part(1)?, part(2)?, part(3)?];
        return Some(format!("#{red:02x}{green:02x}{blue:02x}"));
    }
    let named = entity.record("DRAUGHTING_PRE_DEFINED_COLOUR").or_else(|| entity.record("PRE_DEFINED_COLOUR"))?;
    Some(named.text(0)).filter(|name| !name.is_empty())
}
