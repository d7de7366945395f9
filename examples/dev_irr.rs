use quadfront::core::convert::conversion::convert;
use quadfront::core::io::built_in;
use quadfront::core::progress::Nobody;
use std::collections::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut case = built_in::named(&a[1]).unwrap().unwrap();
    case.parameters.size_scale = a[2].parse().unwrap();
    let d: usize = a[3].parse().unwrap();
    let c = convert(&case, &mut Nobody).unwrap();
    let m = &c.mesh;
    let irr: BTreeMap<_, i32> =
        m.nodes().filter(|&n| !m.is_fixed(n) && m.valence(n) != 4).map(|n| (n, m.valence(n) as i32 - 4)).collect();
    let mut seen = BTreeSet::new();
    let mut kinds: BTreeMap<Vec<i32>, usize> = BTreeMap::new();
    let mut ex: BTreeMap<Vec<i32>, _> = BTreeMap::new();
    for &n in irr.keys() {
        if seen.contains(&n) {
            continue;
        }
        let mut comp = vec![];
        let mut st = vec![n];
        seen.insert(n);
        while let Some(x) = st.pop() {
            comp.push(irr[&x]);
            let mut front = vec![x];
            let mut near: BTreeSet<_> = front.iter().copied().collect();
            for _ in 0..d {
                let mut nx = vec![];
                for &y in &front {
                    if m.is_fixed(y) {
                        continue;
                    }
                    for h in m.fan(y) {
                        for z in m.corners(h.element()) {
                            if near.insert(z) {
                                nx.push(z)
                            }
                        }
                    }
                }
                front = nx;
            }
            for y in near {
                if irr.contains_key(&y) && seen.insert(y) {
                    st.push(y)
                }
            }
        }
        comp.sort();
        *kinds.entry(comp.clone()).or_default() += 1;
        ex.insert(comp, m.uv(n));
    }
    println!("{} irregular of {}", irr.len(), m.nodes().filter(|&n| !m.is_fixed(n)).count());
    let mut k: Vec<_> = kinds.into_iter().collect();
    k.sort_by_key(|x| std::cmp::Reverse(x.1));
    for (c, n) in k.iter().take(14) {
        println!("{n:4} x {c:?} e.g. {:?}", ex[c])
    }
}
