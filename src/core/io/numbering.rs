//! The numbers that files give to nodes and elements: sparse, in any order, from anywhere.

/// From a file's numbers to indices.
#[derive(Clone, Debug, Default)]
pub struct Numbering {
    /// Number and index, by number.
    pairs: Vec<(u64, u32)>,
    /// Whether the numbers are a run without gaps: then no search is needed.
    run: bool,
}

impl Numbering {
    /// The numbering in which thing `i` is called `numbers[i]`.
    ///
    /// # Errors
    /// The first number that is used twice.
    pub fn new(numbers: &[u64]) -> Result<Self, u64> {
        let mut pairs: Vec<(u64, u32)> = (0u32..).zip(numbers).map(|(i, &number)| (number, i)).collect();
        if !pairs.is_sorted() {
            pairs.sort_unstable();
        }
        if let Some(twice) = pairs.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(twice[0].0);
        }
        let run = match (pairs.first(), pairs.last()) {
            (Some(first), Some(last)) => last.0 - first.0 == pairs.len() as u64 - 1,
            _ => false,
        };
        Ok(Numbering { pairs, run })
    }

    /// The index of the thing called `number`.
    #[inline]
    pub fn index(&self, number: u64) -> Option<u32> {
        let place = if self.run {
            usize::try_from(number.checked_sub(self.pairs[0].0)?).ok()?
        } else {
            self.pairs.binary_search_by_key(&number, |pair| pair.0).ok()?
        };
        self.pairs.get(place).map(|pair| pair.1)
    }
}

/// Puts `items` (and `tags`, unless empty) into the order of their numbers, which files may give in any order.
pub fn sort_by_number<T: Copy>(numbers: &mut [u64], items: &mut [T], tags: &mut [u32]) {
    if numbers.is_sorted() {
        return;
    }
    let mut order: Vec<u32> = (0..numbers.len() as u32).collect();
    order.sort_by_key(|&i| numbers[i as usize]);
    reorder(numbers, &order);
    reorder(items, &order);
    if !tags.is_empty() {
        reorder(tags, &order);
    }
}

fn reorder<T: Copy>(items: &mut [T], order: &[u32]) {
    let old = items.to_vec();
    for (item, &from) in items.iter_mut().zip(order) {
        *item = old[from as usize];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sparse_numbers_in_any_order_find_their_index() {
        let numbering = Numbering::new(&[70, 3, u64::MAX]).unwrap();
        assert_eq!([70, 3, u64::MAX, 4].map(|n| numbering.index(n)), [Some(0), Some(1), Some(2), None]);
        let run = Numbering::new(&[6, 5, 7]).unwrap();
        assert_eq!([4, 5, 6, 7, 8].map(|n| run.index(n)), [None, Some(1), Some(0), Some(2), None]);
        assert_eq!(Numbering::new(&[]).unwrap().index(0), None);
        assert_eq!(Numbering::new(&[2, 9, 2]).unwrap_err(), 2);
    }

    #[test]
    fn things_are_put_in_the_order_of_their_numbers() {
        let (mut numbers, mut items, mut tags) = ([3, 1, 2], ['c', 'a', 'b'], [30, 10, 20]);
        sort_by_number(&mut numbers, &mut items, &mut tags);
        assert_eq!((numbers, items, tags), ([1, 2, 3], ['a', 'b', 'c'], [10, 20, 30]));
    }
}
