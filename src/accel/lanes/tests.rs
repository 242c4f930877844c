//! Every operation against plain arithmetic, with numbers for which nothing is rounded; small enough for Miri, which sees
//! each intrinsic here.

use super::{Lanes, Portable, Simd, Task, prefetch};
use crate::{accel::four::F4, math::DVec3};

const A: [f32; 8] = [1.0, -2.0, 0.5, 0.0, -0.0, f32::INFINITY, f32::NAN, 1e30];
const B: [f32; 8] = [2.0, -3.0, 0.25, 0.0, 1.0, 4.0, 1.0, -1e30];
const C: [f32; 8] = [0.5, 6.0, -1.0, 2.0, 0.0, 1.0, 0.0, 8.0];

/// What comes of all operations: bits, for NaN and -0.
struct All;

impl Task for All {
    type Output = (Vec<[u32; 8]>, [u32; 2], [[f32; 4]; 2]);

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Self::Output {
        let [a, b, c] = [lanes.load(&A), lanes.load(&B), lanes.load(&C)];
        let small = [lanes.load(&C), lanes.splat(2.0), lanes.splat(-0.5)];
        let eight = [
            lanes.mul_add(small[0], small[1], small[2]),
            lanes.min(a, b),
            lanes.max(a, b),
            lanes.max(lanes.min(b, c), lanes.splat(0.25)),
            lanes.join({
                let [low, high] = lanes.halves(a);
                [high, low]
            }),
        ];
        let four = |x: [f32; 8]| F4::from_array([x[0], x[1], x[2], x[3]]);
        (
            eight.map(|x| lanes.store(x).map(f32::to_bits)).to_vec(),
            [lanes.at_most(a, b), lanes.at_most(b, c)],
            [
                lanes.mul_add4(four(A), four(B), four(C)).to_array(),
                lanes.mul_sub4(four(A), four(B), four(C)).to_array(),
            ],
        )
    }
}

#[test]
fn eight_lanes_are_those_of_plain_arithmetic() {
    let plain = All.run(Portable);
    assert_eq!(plain.1, [0b0001_1001, 0b1000_1010]);
    assert_eq!(plain.2[1], [1.5, 0.0, 1.125, -2.0]);
    let [a, b, c, d, e, f, g, h] = A.map(f32::to_bits);
    assert_eq!(plain.0[4], [e, f, g, h, a, b, c, d]);
    for simd in Simd::all() {
        assert_eq!(simd.run(All), plain, "{simd:?}");
    }
    assert_eq!(super::run(All), plain);
    prefetch(&plain);
    prefetch(std::ptr::null::<u8>());
}

#[test]
fn four_lanes_are_those_of_plain_arithmetic() {
    let (a, b) = ([1.0f32, -2.5, 0.5, -0.0], [2.0f32, -2.5, 4.0, 1.0]);
    let (x, y) = (F4::from_array(a), F4::from_array(b));
    let each = |f: fn(f32, f32) -> f32| [0, 1, 2, 3].map(|i| f(a[i], b[i]));
    for (found, wanted) in [
        (x.add(y), each(|a, b| a + b)),
        (x.sub(y), each(|a, b| a - b)),
        (x.mul(y), each(|a, b| a * b)),
        (x.div(y), each(|a, b| a / b)),
        (x.min(y), each(f32::min)),
        (x.max(y), each(f32::max)),
        (x.abs(), a.map(f32::abs)),
        (x.rotate(), [a[1], a[2], a[0], a[3]]),
        (x.flip(y.sign()), [1.0, 2.5, 0.5, -0.0]),
        (F4::splat(0.5), [0.5; 4]),
        (
            F4::rounded(&DVec3::new(0.1, -7.0, 1e300)),
            [0.1, -7.0, f32::INFINITY, 0.0],
        ),
    ] {
        assert_eq!(found.to_array(), wanted);
    }
    assert_eq!(x.first(), 1.0);
    assert_eq!(F4::from_array([1.9, -1.9, 0.0, 7.0]).truncate(), [1, -1, 0, 7]);
    assert_eq!(
        F4::from_whole([1, -1, 0, 1 << 28]).to_array(),
        [1.0, -1.0, 0.0, 268_435_456.0]
    );
    let rows = [[1.0, 2.0, 3.0, 0.0], [4.0, 5.0, 6.0, 0.0], [7.0, 8.0, 9.0, 0.0]].map(F4::from_array);
    let columns = F4::transpose(rows).map(|v| {
        let [a, b, c, _] = v.to_array();
        [a, b, c]
    });
    assert_eq!(columns, [[1.0, 4.0, 7.0], [2.0, 5.0, 8.0], [3.0, 6.0, 9.0]]);
    let below = x.below(y);
    assert_eq!(below.bits(), 0b1101);
    assert_eq!(x.not_less(y).bits(), 0b0010);
    assert_eq!(below.or(x.not_less(y)).bits(), 0b1111);
    assert_eq!(below.and(x.not_less(y)).bits(), 0);
    assert_eq!(F4::splat(f32::NAN).not_less(y).bits(), 0b1111);
}
