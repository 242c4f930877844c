use super::{super::suite, *};
use crate::{
    Limits,
    shape::suite::{CUBE_FACES, cube_corner},
};

fn made(cage: &Cage) -> Mesh {
    cage.mesh(&Allowance::of(&Limits::default())).unwrap()
}

fn cube() -> (Vec<DVec3>, Vec<Vec<u32>>) {
    (
        (0..8).map(cube_corner).collect(),
        CUBE_FACES.map(|f| f.to_vec()).to_vec(),
    )
}

fn octahedron() -> (Vec<DVec3>, Vec<Vec<u32>>) {
    let positions = vec![
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ];
    let faces = [
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    (positions, faces.map(|f| f.to_vec()).to_vec())
}

#[test]
fn closed_cages_stay_closed_and_smooth() {
    for levels in 0..4 {
        for (positions, faces) in [cube(), octahedron()] {
            let mesh = made(&Cage::new(positions, faces, levels));
            suite::check_closed(&mesh);
            suite::check_normals(&mesh, 0.4);
        }
    }
    let (positions, faces) = cube();
    assert_eq!(made(&Cage::new(positions, faces, 3)).triangles.len(), 6 * 64 * 2);
}

#[test]
fn corners_at_the_limit_do_not_move_with_further_levels() {
    for (positions, faces) in [cube(), octahedron()] {
        let few = made(&Cage::new(positions.clone(), faces.clone(), 1));
        let many = made(&Cage::new(positions, faces, 4));
        // The corners of a level come first in the next.
        for (a, b) in few.positions.iter().zip(&many.positions) {
            assert!((*a - *b).length() < 1e-12, "{a} {b}");
        }
    }
}

#[test]
fn colors_are_divided_as_texture_coordinates_are() {
    for (positions, faces) in [cube(), octahedron()] {
        let of = |corner: &u32| DVec2::new(f64::from(*corner), f64::from(*corner * *corner));
        let uvs: Vec<Vec<DVec2>> = faces.iter().map(|face| face.iter().map(of).collect()).collect();
        let color = |uv: &DVec2| Color::new(uv.x, uv.y, 1.0);
        let mut cage = Cage {
            colors: uvs.iter().map(|face| face.iter().map(color).collect()).collect(),
            uvs,
            ..Cage::new(positions, faces, 2)
        };
        // One face has none.
        cage.colors[3].clear();
        let mesh = made(&cage);
        let (uvs, colors) = (mesh.uvs.as_ref().unwrap(), mesh.colors.as_ref().unwrap());
        let faces = mesh.triangles.len() / cage.faces.len();
        for i in 0..mesh.triangles.len() {
            let expected = uvs.corners(i).unwrap().map(|uv| color(&uv));
            let expected = (i / faces != 3).then_some(expected);
            assert_eq!(colors.corners(i), expected, "triangle {i}");
        }
        cage.colors[0][1].y = f64::NAN;
        let error = |cage: &Cage| cage.check().unwrap_err().message;
        assert!(error(&cage).starts_with("a color of face 0 must be finite numbers from 0 to 1e15, not ["));
        cage.colors[0].pop();
        assert!(error(&cage).starts_with("face 0 has "), "{}", error(&cage));
        cage.colors.pop();
        let wanted = format!(
            "there are colors for {0} faces; expected {1}",
            cage.faces.len() - 1,
            cage.faces.len()
        );
        assert_eq!(error(&cage), wanted);
    }
}

#[test]
fn a_flat_net_of_squares_is_a_spline() {
    // On a regular grid Catmull-Clark is the uniform bicubic B-spline, which keeps what is linear.
    let positions: Vec<DVec3> = (0..49)
        .map(|i| DVec3::new((i % 7) as f64, 0.3 * (i % 7) as f64, (i / 7) as f64))
        .collect();
    let faces: Vec<Vec<u32>> = (0..36)
        .map(|i| {
            let a = i / 6 * 7 + i % 6;
            vec![a, a + 7, a + 8, a + 1]
        })
        .collect();
    let mesh = made(&Cage::new(positions.clone(), faces.clone(), 2));
    for p in &mesh.positions {
        assert!((p.y - 0.3 * p.x).abs() < 1e-12, "{p}");
    }
    // One corner lifted: the spline there has 4/6 squared of it.
    let mut lifted = positions;
    lifted.iter_mut().for_each(|p| p.y = 0.0);
    lifted[24].y = 1.0;
    let mesh = made(&Cage::new(lifted, faces, 2));
    assert!(
        (mesh.positions[24].y - 4.0 / 9.0).abs() < 1e-12,
        "{}",
        mesh.positions[24]
    );
}

#[test]
fn texture_coordinates_are_linear_within_each_face() {
    let lifted = |(positions, faces): (Vec<DVec3>, Vec<Vec<u32>>), scheme| {
        // Of the first face none, of all others their own corner of a picture and some more.
        let uvs = |(i, face): (usize, &Vec<u32>)| match i {
            0 => Vec::new(),
            _ => (0..face.len())
                .map(|k| DVec2::new(i as f64 + (k % 2) as f64, k as f64 * 0.5))
                .collect(),
        };
        let cage = Cage {
            uvs: faces.iter().enumerate().map(uvs).collect(),
            scheme,
            ..Cage::new(positions, faces, 2)
        };
        (made(&cage), cage)
    };
    for (net, scheme) in [
        (cube(), Scheme::CatmullClark),
        (octahedron(), Scheme::CatmullClark),
        (octahedron(), Scheme::Loop),
    ] {
        let (mesh, cage) = lifted(net, scheme);
        let uvs = mesh.uvs.as_ref().unwrap();
        let per_face = mesh.triangles.len() / cage.faces.len();
        let corners = |i: usize, cage: &Cage| cage.uvs[i].clone();
        for (i, own) in (0..cage.faces.len()).map(|i| (i, corners(i, &cage))) {
            let all = i * per_face..(i + 1) * per_face;
            if i == 0 {
                assert!(
                    all.clone().all(|t| uvs.corners(t).is_none()),
                    "the first has none"
                );
                continue;
            }
            // The corners of the face are there as they were, and the areas add up to that of the face.
            let found: Vec<[DVec2; 3]> = all.map(|t| uvs.corners(t).unwrap()).collect();
            for uv in &own {
                assert!(
                    found.iter().flatten().any(|other| other == uv),
                    "{uv} of face {i}"
                );
            }
            let area = |p: &[DVec2]| {
                let next = p.iter().cycle().skip(1);
                p.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
            };
            let sum: f64 = found.iter().map(|t| area(t)).sum();
            assert!((sum - area(&own)).abs() < 1e-12, "face {i}: {sum}");
        }
        // The shape knows nothing of it.
        let plain = made(&Cage {
            uvs: Vec::new(),
            ..cage
        });
        assert_eq!(
            (plain.positions, plain.triangles, plain.normals),
            (mesh.positions, mesh.triangles, mesh.normals)
        );
    }
}

#[test]
fn a_square_keeps_its_picture() {
    // On a flat grid the surface and the picture are both those of the grid.
    let positions: Vec<DVec3> = (0..9)
        .map(|i| DVec3::new((i % 3) as f64, (i / 3) as f64, 0.0))
        .collect();
    let faces: Vec<Vec<u32>> = [0u32, 1, 3, 4].map(|a| vec![a, a + 1, a + 4, a + 3]).to_vec();
    let uv = |corner: &u32| {
        let p = positions[*corner as usize];
        DVec2::new(p.x, p.y)
    };
    let uvs: Vec<Vec<DVec2>> = faces.iter().map(|face| face.iter().map(uv).collect()).collect();
    let cage = Cage {
        uvs,
        to_the_limit: false,
        levels: 3,
        ..Cage::new(positions.clone(), faces, 3)
    };
    let mesh = made(&cage);
    let uvs = mesh.uvs.as_ref().unwrap();
    for t in 0..mesh.triangles.len() {
        for (p, uv) in mesh.corners(t).iter().zip(uvs.corners(t).unwrap()) {
            // Rims shrink at their corners, nothing else moves.
            let is_inside = (0.7..1.3).contains(&p.x) && (0.7..1.3).contains(&p.y);
            assert!(
                !is_inside || (DVec2::new(p.x, p.y) - uv).length() < 0.02,
                "{p} {uv}"
            );
        }
    }
}

#[test]
fn creases_stay_sharp_as_long_as_they_are() {
    let (positions, faces) = cube();
    let top = [[2, 3], [3, 7], [7, 6], [6, 2]];
    let mut cage = Cage::new(positions, faces, 4);
    let volume = |cage: &Cage| suite::volume(&made(cage));
    let mut last = volume(&cage);
    for sharpness in [0.5, 1.0, 2.0, 10.0] {
        cage.creases = top.map(|edge| (edge, sharpness)).to_vec();
        let larger = volume(&cage);
        assert!(larger > last, "{larger} for {sharpness}");
        last = larger;
    }
    assert_eq!(made(&cage).bounds().max.y, 1.0);
    suite::check_closed(&made(&cage));
    cage.creases = vec![([0, 7], 1.0)];
    let error = cage.mesh(&Allowance::of(&Limits::default())).unwrap_err();
    assert_eq!(error.message, "the crease from 0 to 7 is no edge of a face");
}

#[test]
fn what_is_no_cage_is_refused() {
    let (positions, faces) = cube();
    let message = |faces: Vec<Vec<u32>>, levels| {
        let cage = Cage::new(positions.clone(), faces, levels);
        cage.mesh(&Allowance::of(&Limits::default())).unwrap_err().message
    };
    assert_eq!(message(Vec::new(), 1), "there are no faces");
    assert_eq!(
        message(vec![vec![0, 1]], 1),
        "face 0 has 2 corners; expected 3 or more"
    );
    assert_eq!(message(vec![vec![0, 1, 1]], 1), "face 0 has the corner 1 twice");
    assert_eq!(
        message(vec![vec![0, 1, 8]], 1),
        "face 0 has the corner 8, but there are 8 positions, numbered from 0"
    );
    assert_eq!(
        message(vec![vec![0, 1, 2], vec![0, 1, 3]], 1),
        "faces 0 and 1 both run from corner 0 to corner 1"
    );
    let of_uvs = |uvs: Vec<Vec<DVec2>>| {
        let cage = Cage {
            uvs,
            ..Cage::new(positions.clone(), faces.clone(), 1)
        };
        cage.mesh(&Allowance::of(&Limits::default())).unwrap_err().message
    };
    assert_eq!(
        of_uvs(vec![Vec::new(); 5]),
        "there are texture coordinates for 5 faces; expected 6"
    );
    let mut uvs = vec![Vec::new(); 6];
    uvs[2] = vec![DVec2::ZERO; 3];
    assert_eq!(
        of_uvs(uvs.clone()),
        "face 2 has 4 corners and 3 texture coordinates; expected as many"
    );
    uvs[2] = vec![DVec2::NAN; 4];
    assert_eq!(
        of_uvs(uvs),
        "a texture coordinate of face 2 is not a finite number within 1e15"
    );
    assert_eq!(message(faces.clone(), 9), "levels must be from 0 to 8, not 9");
    let few = Limits {
        primitives: 700,
        ..Limits::default()
    };
    let error = Cage::new(positions.clone(), faces, 3)
        .mesh(&Allowance::of(&few))
        .unwrap_err();
    assert!(error.message.contains("'primitives'"));
}
