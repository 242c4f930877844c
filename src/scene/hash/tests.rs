use super::*;
use crate::scene::Builder;

fn hash_of(build: impl Fn(&mut Builder)) -> String {
    let mut b = Builder::new();
    build(&mut b);
    b.finish().value.hash()
}

#[test]
fn what_reaches_a_pixel_reaches_the_hash() {
    let sphere = |b: &mut Builder, x: f64| b.sphere(DVec3::new(x, 0.0, 0.0), 1.0).unwrap();
    let plain = hash_of(|b| sphere(b, 0.0));
    assert_eq!(plain.len(), 32);
    assert_eq!(plain, hash_of(|b| sphere(b, 0.0)));
    let others = [
        hash_of(|_| {}),
        hash_of(|b| sphere(b, f64::MIN_POSITIVE)),
        hash_of(|b| {
            b.size(640, 481).unwrap();
            sphere(b, 0.0);
        }),
        hash_of(|b| {
            b.material_mut().ior = 1.25;
            sphere(b, 0.0);
        }),
        hash_of(|b| {
            b.directional(DVec3::Y, DVec3::ONE).unwrap();
            sphere(b, 0.0);
        }),
        hash_of(|b| {
            b.translate(DVec3::X).unwrap();
            sphere(b, 0.0);
        }),
    ];
    let distinct: std::collections::BTreeSet<_> = others.iter().chain([&plain]).collect();
    assert_eq!(distinct.len(), 7);
}

#[test]
fn where_a_call_stands_does_not() {
    let at = |line| {
        hash_of(|b| {
            let file = b.file("a.rhai");
            b.set_loc(crate::diag::SourceLoc {
                line,
                column: 1,
                file,
            });
            b.sphere(DVec3::ZERO, 1.0).unwrap();
        })
    };
    assert_eq!(at(1), at(2));
}
