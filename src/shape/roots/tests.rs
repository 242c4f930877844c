use super::{super::suite::Rng, *};

/// The polynomial with these zeros, by products of u - z.
fn with_zeros(zeros: [f64; 4]) -> Bernstein<5> {
    let line = |z: f64| Bernstein([-z, 1.0 - z]);
    let [a, b, c, d] = zeros.map(line);
    let ab: Bernstein<3> = product(&a, &b);
    let cd: Bernstein<3> = product(&c, &d);
    product(&ab, &cd)
}

fn found<const N: usize>(f: &Bernstein<N>) -> Vec<(f64, bool)> {
    let mut all = Vec::new();
    f.sign_changes(&mut |u, falls| all.push((u, falls)));
    all
}

#[test]
fn polynomials_are_solved_for_all_their_zeros() {
    let mut rng = Rng::new(31);
    let mut met = 0;
    for _ in 0..20_000 {
        let mut zeros = [0.0; 4].map(|_| rng.within(-0.5, 1.5));
        zeros.sort_by(f64::total_cmp);
        let apart = zeros.windows(2).map(|w| w[1] - w[0]).fold(1.0, f64::min);
        if apart < 1e-3 || zeros.iter().any(|z| z.abs() < 1e-6 || (z - 1.0).abs() < 1e-6) {
            continue;
        }
        let inside: Vec<f64> = zeros.into_iter().filter(|z| (0.0..1.0).contains(z)).collect();
        let all = found(&with_zeros(zeros));
        assert_eq!(all.len(), inside.len(), "{all:?}, not {inside:?}");
        for ((u, falls), z) in all.iter().zip(&inside) {
            assert!((u - z).abs() < 1e-9, "{u}, not {z}");
            let before = zeros.iter().filter(|other| *other < z).count();
            assert_eq!(*falls, before % 2 == 0);
            met += 1;
        }
    }
    assert!(met > 20_000, "{met}");
}

#[test]
fn the_ends_decide_whether_the_number_is_odd() {
    let mut rng = Rng::new(32);
    for _ in 0..20_000 {
        // Small whole numbers meet zero, and double zeros, often.
        let f = Bernstein([0.0; 7].map(|_| f64::from(rng.below(5) as i32 - 2)));
        let all = found(&f);
        assert_eq!(all.len() % 2 == 1, (f.0[0] < 0.0) != (f.0[6] < 0.0), "{f:?}");
        assert!(
            all.is_sorted_by(|a, b| a.0 <= b.0 && a.1 != b.1),
            "{f:?}: {all:?}"
        );
    }
}

#[test]
fn places_where_it_touches_zero_are_near_zeros() {
    let f = with_zeros([0.3, 0.3, 0.7, 0.7]);
    let mut near = Vec::new();
    f.zeros(&mut |u| near.push(u));
    assert!(
        near.iter()
            .all(|u| (u - 0.3).abs() < 1e-6 || (u - 0.7).abs() < 1e-6)
    );
    assert!(near.iter().any(|u| *u < 0.5) && near.iter().any(|u| *u > 0.5));
    // One of them where the interval is halved.
    let f = with_zeros([-1.0, 0.5, 0.5, 2.0]);
    near.clear();
    f.zeros(&mut |u| near.push(u));
    assert!(near.iter().any(|u| (u - 0.5).abs() < CLUSTER), "{near:?}");
    // One of a high order, and nothing but zeros.
    let f: Bernstein<11> = {
        let half = Bernstein([-0.5, 0.5]);
        let two: Bernstein<3> = product(&half, &half);
        let (four, three): (Bernstein<5>, Bernstein<4>) = (product(&two, &two), product(&two, &half));
        let seven: Bernstein<8> = product(&four, &three);
        product(&seven, &three)
    };
    near.clear();
    f.zeros(&mut |u| near.push(u));
    assert!(near.len() <= 2 * PLACES as usize && near.iter().any(|u| (u - 0.5).abs() < 0.1));
    Bernstein([0.0; 5]).zeros(&mut |_| panic!("everywhere"));
}

#[test]
fn products_and_derivatives_are_those_of_the_values() {
    let mut rng = Rng::new(33);
    for _ in 0..1000 {
        let a = Bernstein([0.0; 4].map(|_| rng.within(-1.0, 1.0)));
        let b = Bernstein([0.0; 7].map(|_| rng.within(-1.0, 1.0)));
        let ab: Bernstein<10> = product(&a, &b);
        let slope: Bernstein<3> = derivative(&a);
        let u = rng.unit();
        assert!((ab.at(u).0 - a.at(u).0 * b.at(u).0).abs() < 1e-14);
        assert!((slope.at(u).0 - a.at(u).1).abs() < 1e-13);
    }
}

/// sin(n x) with honest bounds.
struct Wave(f64);

impl Bounded for Wave {
    fn at(&self, x: f64) -> (f64, f64) {
        use crate::math::{cos, sin};
        (sin(self.0 * x), self.0 * cos(self.0 * x))
    }

    fn within(&self, lo: f64, hi: f64) -> (Range, Range) {
        let (y, slope) = self.at(0.5 * (lo + hi));
        let half = 0.5 * (hi - lo) * self.0;
        let bend = half * self.0;
        ((y - half, y + half), (slope - bend, slope + bend))
    }
}

#[test]
fn bounded_functions_are_solved_for_all_their_zeros() {
    let pi = crate::math::PI;
    for n in 1..40 {
        let f = Wave(f64::from(n) * pi);
        let mut all = Vec::new();
        sign_changes(&f, 1e-3, 1.0 - 1e-3, &mut |x, falls| all.push((x, falls)));
        assert_eq!(all.len(), n as usize - 1);
        for (i, (x, falls)) in all.iter().enumerate() {
            assert!((x - (i + 1) as f64 / f64::from(n)).abs() < 1e-15);
            assert_eq!(*falls, i % 2 == 0);
        }
    }
}
