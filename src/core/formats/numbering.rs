//! The numbers of nodes and elements in a file, which may be sparse and in any order.

/// Maps a file's numbers to indices.
#[derive(Clone, Debug)]
pub enum Numbering {
    /// Item `i` has the number `first + i`: the usual case.
    Run {
        /// Number of the first item.
        first: u64,
        /// Number of items.
        count: u32,
    },
    /// Pairs of number and index, sorted by number.
    Sparse(Vec<(u64, u32)>),
}

impl Numbering {
    /// The numbering in which item `i` has the number `numbers[i]`.
    ///
    /// # Errors
    /// The smallest number that is used twice.
    pub fn new(numbers: &[u64]) -> Result<Self, u64> {
        let first = numbers.first().copied().unwrap_or(0);
        if numbers.iter().zip(0..).all(|(&number, i)| number.checked_sub(first) == Some(i)) {
            return Ok(Numbering::Run { first, count: numbers.len() as u32 });
        }
        let mut pairs: Vec<(u64, u32)> = numbers.iter().copied().zip(0..).collect();
        if !pairs.is_sorted() {
            pairs.sort_unstable();
        }
        match pairs.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(repeated) => Err(repeated[0].0),
            None => Ok(Numbering::Sparse(pairs)),
        }
    }

    /// The index of the item with a number.
    #[inline]
    pub fn index(&self, number: u64) -> Option<u32> {
        match self {
            Numbering::Run { first, count } => {
                let index = number.checked_sub(*first)?;
                (index < u64::from(*count)).then_some(index as u32)
            }
            Numbering::Sparse(pairs) => {
                pairs.binary_search_by_key(&number, |pair| pair.0).ok().map(|place| pairs[place].1)
            }
        }
    }
}

/// Sorts `items` (and `tags`, unless empty) by their numbers.
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
    fn items_are_sorted_by_their_numbers() {
        let (mut numbers, mut items, mut tags) = ([3, 1, 2], ['c', 'a', 'b'], [30, 10, 20]);
        sort_by_number(&mut numbers, &mut items, &mut tags);
        assert_eq!((numbers, items, tags), ([1, 2, 3], ['a', 'b', 'c'], [10, 20, 30]));
    }
}
