use super::*;
use crate::math::{self, Ray};

#[test]
fn the_middle_of_the_picture_looks_at_the_target() {
    let camera = Camera::new(
        DVec3::new(1.0, 2.0, 3.0),
        DVec3::new(-1.0, 0.5, 0.0),
        DVec3::Y,
        50.0,
    )
    .unwrap();
    let ray = camera.frame(64, 48).ray(32.0, 24.0).unwrap();
    let wanted = (camera.at - camera.eye).normalize();
    assert!((ray.dir - wanted).length() < 1e-15);
}

#[test]
fn fovy_spans_the_height() {
    let frame = Camera::new(DVec3::Z, DVec3::ZERO, DVec3::Y, 90.0)
        .unwrap()
        .frame(200, 100);
    let top = frame.ray(100.0, 0.0).unwrap().dir;
    assert!((top.y + top.z).abs() < 1e-15, "45 degrees up: {top}");
    let right = frame.ray(200.0, 50.0).unwrap().dir;
    assert!((right.x + 2.0 * right.z).abs() < 1e-15, "twice as wide: {right}");
}

#[test]
fn what_a_ray_goes_through_is_seen_where_it_came_from() {
    let camera = Camera::new(DVec3::new(1.0, 2.0, 6.0), DVec3::X, DVec3::Y, 70.0).unwrap();
    let frame = camera.frame(64, 48);
    let points = [[3.0, 7.0], [60.0, 44.5]];
    let [a, b] = [(points[0], 2.0), (points[1], 9.0)].map(|([x, y], t)| frame.ray(x, y).unwrap().at(t));
    let near = |seen: [[f64; 2]; 2], wanted: [[f64; 2]; 2]| {
        let pairs = seen.as_flattened().iter().zip(wanted.as_flattened());
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-9, "{seen:?} {wanted:?}"));
    };
    near(frame.project(a, b).unwrap(), points);
    let behind = camera.eye * 2.0 - a;
    assert_eq!(frame.project(behind, behind), None);
    near([frame.project(behind, b).unwrap()[1]; 2], [points[1]; 2]);
}

#[test]
fn impossible_cameras_are_refused() {
    let new = |eye, up, fovy| Camera::new(eye, DVec3::ZERO, up, fovy);
    assert!(new(DVec3::ZERO, DVec3::Y, 45.0).is_err());
    assert!(new(DVec3::Y, DVec3::Y, 45.0).is_err());
    assert!(new(DVec3::Z, DVec3::ZERO, 45.0).is_err());
    for fovy in [0.0, 180.0, -1.0, f64::NAN] {
        assert!(new(DVec3::Z, DVec3::Y, fovy).is_err(), "{fovy}");
    }
}

fn camera(projection: Projection) -> Camera {
    let (eye, at) = (DVec3::new(1.0, 2.0, 6.0), DVec3::new(0.5, 0.0, -1.0));
    Camera::with_projection(eye, at, DVec3::new(0.1, 1.0, 0.0), projection).unwrap()
}

const PROJECTIONS: [Projection; 8] = [
    Projection::Perspective { fovy: 70.0 },
    Projection::Orthographic { height: 3.0 },
    Projection::Fisheye {
        angle: 180.0,
        full_frame: false,
    },
    Projection::Fisheye {
        angle: 360.0,
        full_frame: true,
    },
    Projection::Panorama {
        angle: 360.0,
        fovy: 180.0,
    },
    Projection::Panorama {
        angle: 90.0,
        fovy: 45.0,
    },
    Projection::Cylindrical {
        angle: 200.0,
        fovy: Some(60.0),
    },
    Projection::Cylindrical {
        angle: 360.0,
        fovy: None,
    },
];

/// The formula of a projection as textbooks have it: from the direction of a ray, to the right, up and ahead of the
/// camera, to the place in a picture of 64 x 48.
fn formula(projection: Projection, d: DVec3) -> [f64; 2] {
    let place = |x: f64, y: f64| [32.0 + x, 24.0 - y];
    let tan = |degrees: f64| math::tan(degrees.to_radians() * 0.5);
    let longitude = math::atan2(d.x, d.z).to_degrees();
    match projection {
        Projection::Perspective { fovy } => {
            let focal = 24.0 / tan(fovy);
            place(focal * d.x / d.z, focal * d.y / d.z)
        }
        Projection::Orthographic { .. } => panic!("a matter of origins"),
        Projection::Fisheye { angle, full_frame } => {
            let radius = if full_frame { 40.0 } else { 24.0 };
            let r = math::acos(d.z).to_degrees() / (angle * 0.5) * radius;
            let aside = (d.x * d.x + d.y * d.y).sqrt();
            place(r * d.x / aside, r * d.y / aside)
        }
        Projection::Panorama { angle, fovy } => place(
            longitude / angle * 64.0,
            math::asin(d.y).to_degrees() / fovy * 48.0,
        ),
        Projection::Cylindrical { angle, fovy } => {
            // Height on a cylinder of radius 1, in pixels.
            let scale = fovy.map_or(64.0 / angle.to_radians(), |fovy| 24.0 / tan(fovy));
            let slope = d.y / (d.x * d.x + d.z * d.z).sqrt();
            place(longitude / angle * 64.0, scale * slope)
        }
    }
}

#[test]
fn each_projection_follows_its_formula() {
    for projection in PROJECTIONS {
        let frame = camera(projection).frame(64, 48);
        for (x, y) in [(31.7, 23.0), (40.25, 18.5), (20.0, 30.0), (33.0, 40.0)] {
            let ray = frame.ray(x, y).unwrap();
            assert!((ray.dir.length() - 1.0).abs() < 1e-14);
            if let Projection::Orthographic { height } = projection {
                let p = frame.camera_from_world(ray.origin);
                let wanted = [(x - 32.0) * height / 48.0, (24.0 - y) * height / 48.0, 0.0];
                assert!((p - DVec3::from_array(wanted)).length() < 1e-13, "{p}");
                let ahead = frame.camera_from_world(ray.at(1.0)) - p;
                assert!((ahead - DVec3::Z).length() < 1e-13, "{ahead}");
                continue;
            }
            let d = frame.camera_from_world(ray.at(1.0));
            let [a, b] = formula(projection, d);
            assert!(
                (a - x).abs() < 1e-9 && (b - y).abs() < 1e-9,
                "{projection:?}: {x} {y} is {a} {b}"
            );
        }
    }
}

#[test]
fn a_fisheye_sees_nothing_outside_its_circle() {
    let fisheye = |full_frame| {
        let projection = Projection::Fisheye {
            angle: 180.0,
            full_frame,
        };
        camera(projection).frame(64, 48)
    };
    let sees = |frame: &CameraFrame, x, y| frame.ray(x, y).is_some();
    let circle = fisheye(false);
    assert!(sees(&circle, 32.0, 0.1) && sees(&circle, 55.9, 24.0));
    assert!(!sees(&circle, 56.1, 24.0) && !sees(&circle, 0.5, 0.5));
    let full = fisheye(true);
    assert!(sees(&full, 0.01, 0.01) && sees(&full, 63.9, 47.9));
}

#[test]
fn what_a_ray_meets_is_drawn_where_it_came_from() {
    let eyes = |convergence| Stereo {
        separation: 0.3,
        layout: StereoLayout::SideBySide,
        convergence,
    };
    for projection in PROJECTIONS {
        for stereo in [None, Some(eyes(Some(f64::INFINITY))), Some(eyes(None))] {
            let frame = camera(projection).with_stereo(stereo).unwrap().frame(128, 48);
            for (x, y) in [(30.0, 24.5), (37.5, 30.0), (90.0, 20.0), (100.0, 27.5)] {
                let Some(ray) = frame.ray(x, y) else { continue };
                let p = ray.at(7.0);
                let pieces = frame.paths(p, p + DVec3::splat(1e-9));
                let near = pieces
                    .iter()
                    .any(|[a, _]| (a[0] - x).abs() < 1e-4 && (a[1] - y).abs() < 1e-4);
                assert!(near, "{projection:?} {stereo:?} {x} {y}: {:?}", pieces.first());
            }
        }
    }
}

#[test]
fn eyes_stand_apart_and_see_the_distance_of_convergence_alike() {
    for layout in [
        StereoLayout::SideBySide,
        StereoLayout::TopBottom,
        StereoLayout::Anaglyph,
    ] {
        for projection in PROJECTIONS {
            let stereo = Stereo {
                separation: 0.5,
                layout,
                convergence: Some(4.0),
            };
            let frame = camera(projection)
                .with_stereo(Some(stereo))
                .unwrap()
                .frame(64, 48);
            let (x, y) = (10.0, 11.0);
            let places = match layout {
                StereoLayout::SideBySide => [(x, y), (x + 32.0, y)],
                StereoLayout::TopBottom => [(x, y), (x, y + 24.0)],
                StereoLayout::Anaglyph => [(x, y), (x, y)],
            };
            let rays = [Eye::Left, Eye::Right];
            let rays = [0, 1].map(|i| frame.shot([places[i].0, places[i].1], rays[i], None));
            let [Some(left), Some(right)] = rays else {
                continue;
            };
            let apart = frame.camera_from_world(right.origin) - frame.camera_from_world(left.origin);
            assert!((apart.length() - 0.5).abs() < 1e-12, "{projection:?}");
            assert!(apart.x > 0.0 || !projection.is_flat());
            // Where the two lines meet.
            let n = left.dir.cross(right.dir);
            let t = (right.origin - left.origin).cross(right.dir).dot(n) / n.dot(n);
            let s = (right.origin - left.origin).cross(left.dir).dot(n) / n.dot(n);
            assert!((left.at(t) - right.at(s)).length() < 1e-9, "{projection:?}");
            let p = frame.camera_from_world(left.at(t));
            let distance = if projection.is_flat() { p.z } else { p.length() };
            assert!((distance - 4.0).abs() < 1e-9, "{projection:?} {layout:?}: {p}");
        }
    }
}

#[test]
fn eyes_of_a_panorama_stand_across_its_columns() {
    let panorama = Projection::Panorama {
        angle: 360.0,
        fovy: 180.0,
    };
    let stereo = Stereo {
        separation: 0.5,
        layout: StereoLayout::TopBottom,
        convergence: None,
    };
    let frame = camera(panorama).with_stereo(Some(stereo)).unwrap().frame(64, 96);
    for x in [0.0, 7.0, 16.0, 40.0, 63.0] {
        let [left, right] = [frame.ray(x, 24.0), frame.ray(x, 72.0)].map(Option::unwrap);
        assert!((left.dir - right.dir).length() < 1e-12, "parallel");
        let across = right.origin - left.origin;
        assert!(across.dot(left.dir).abs() < 1e-12);
        // To the right of who looks that way.
        let up = frame.camera_from_world(camera(panorama).eye + across.cross(left.dir));
        assert!(up.y > 0.49, "{up}");
    }
}

#[test]
fn what_is_in_focus_is_sharp_and_the_rest_a_circle_of_known_size() {
    let flat = PROJECTIONS.into_iter().filter(Projection::is_flat);
    for projection in flat {
        for (focus, f) in [(Focus::Distance(3.0), 3.0), (Focus::Target, 53.25_f64.sqrt())] {
            let lens = Lens {
                focus,
                ..Lens::new(0.25)
            };
            let plain = camera(projection);
            let (pinhole, frame) = (
                plain.frame(64, 48),
                plain.with_lens(Some(lens)).unwrap().frame(64, 48),
            );
            for (x, y) in [(32.0, 24.0), (3.0, 40.0)] {
                for d in [f, 1.0, 9.0] {
                    let at = |ray: Ray| {
                        let (a, b) = (
                            frame.camera_from_world(ray.origin),
                            frame.camera_from_world(ray.at(1.0)),
                        );
                        a + (b - a) * ((d - a.z) / (b.z - a.z))
                    };
                    let middle = at(pinhole.ray(x, y).unwrap());
                    let far = (0..64).map(|i| {
                        let aperture = [f64::from(i) / 64.0, 1.0 - 1e-12];
                        (at(frame.shot([x, y], Eye::Middle, Some(aperture)).unwrap()) - middle).length()
                    });
                    let far = far.fold(0.0, f64::max);
                    // Similar triangles between the lens and the plane in focus.
                    let wanted = lens.radius * (d - f).abs() / f;
                    assert!(
                        (far - wanted).abs() < 1e-9,
                        "{projection:?} at {d}: {far} {wanted}"
                    );
                }
            }
        }
    }
    let lens = Lens {
        focus: Focus::Point(DVec3::new(1.0, 2.0, 8.0)),
        ..Lens::new(0.1)
    };
    let behind = camera(PROJECTIONS[0]).with_lens(Some(lens)).unwrap_err();
    assert_eq!(
        behind.message,
        "the point in focus must lie before the camera, and [1, 2, 8] does not"
    );
}

#[test]
fn lenses_are_sampled_evenly() {
    // Of a regular polygon: its area is the sum of its triangles.
    let area = |blades: u32| match blades {
        0 => math::PI,
        n => 0.5 * f64::from(n) * math::sin_cos_degrees(360.0 / f64::from(n)).0,
    };
    const CELLS: usize = 12;
    const EDGE: u32 = 250;
    let cell = |p: f64| (((p + 1.0) * 0.5 * CELLS as f64) as usize).min(CELLS - 1);
    for blades in [0, 3, 4, 5, 6, 9] {
        let lens = Lens {
            blades,
            rotation: 10.0,
            ..Lens::new(1.0)
        };
        let mut counts = [[0.0; CELLS]; CELLS];
        // One point in each of many strata, by a hash.
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let n = f64::from(EDGE * EDGE);
        for _ in 0..EDGE * EDGE {
            let p = lens.point(random(), random());
            assert!(p.length() <= 1.0 + 1e-12);
            counts[cell(p.y)][cell(p.x)] += 1.0;
        }
        // Expected counts by the share of each cell's own points that lie inside: an independent rasterization.
        let edges: Vec<(f64, f64)> = (0..blades)
            .map(|i| {
                let middle = 90.0 + 10.0 + 360.0 * (f64::from(i) + 0.5) / f64::from(blades);
                math::sin_cos_degrees(middle)
            })
            .collect();
        let apothem = math::sin_cos_degrees(180.0 / f64::from(blades.max(1))).1;
        let inside = |x: f64, y: f64| match blades {
            0 => x * x + y * y <= 1.0,
            _ => edges.iter().all(|(sin, cos)| x * cos + y * sin <= apothem),
        };
        let (mut chi, mut freedom) = (0.0, -1.0);
        for (row, line) in counts.iter().enumerate() {
            for (column, count) in line.iter().enumerate() {
                const FINE: usize = 32;
                let at = |i: usize, j: usize| {
                    (i as f64 + (j as f64 + 0.5) / FINE as f64) / CELLS as f64 * 2.0 - 1.0
                };
                let hits = (0..FINE * FINE)
                    .filter(|k| inside(at(column, k % FINE), at(row, k / FINE)))
                    .count();
                let share = hits as f64 / (FINE * FINE) as f64 * 4.0 / (CELLS * CELLS) as f64;
                let expected = n * share / area(blades);
                if expected > 200.0 {
                    chi += (count - expected) * (count - expected) / expected;
                    freedom += 1.0;
                }
            }
        }
        // Far beyond what chance would do: the mean of chi-square is its degrees of freedom, its deviation the root of
        // twice that. The rasterization's own error is some 0.3.
        let deviations = (chi - freedom) / f64::sqrt(2.0 * freedom);
        assert!(
            deviations.abs() < 5.0,
            "{blades} blades: {chi} for {freedom} degrees of freedom"
        );
    }
}

#[test]
fn impossible_lenses_and_projections_are_refused() {
    for projection in [
        Projection::Orthographic { height: 0.0 },
        Projection::Fisheye {
            angle: 361.0,
            full_frame: false,
        },
        Projection::Panorama {
            angle: 360.0,
            fovy: 181.0,
        },
        Projection::Cylindrical {
            angle: 90.0,
            fovy: Some(180.0),
        },
        Projection::Cylindrical {
            angle: f64::NAN,
            fovy: None,
        },
    ] {
        let made = Camera::with_projection(DVec3::Z, DVec3::ZERO, DVec3::Y, projection);
        assert!(made.is_err(), "{projection:?}");
    }
    let plain = Camera::default();
    for bad in [
        Lens::new(-1.0),
        Lens::new(f64::NAN),
        Lens {
            blades: 2,
            ..Lens::new(1.0)
        },
        Lens {
            blades: 65,
            ..Lens::new(1.0)
        },
        Lens {
            focus: Focus::Distance(0.0),
            ..Lens::new(1.0)
        },
    ] {
        assert!(plain.with_lens(Some(bad)).is_err(), "{bad:?}");
    }
    let fisheye = camera(PROJECTIONS[2]).with_lens(Some(Lens::new(0.1)));
    assert!(
        fisheye
            .unwrap_err()
            .message
            .contains("a fisheye camera has no lens")
    );
    for (separation, convergence) in [(0.0, None), (f64::NAN, None), (0.1, Some(0.0))] {
        let stereo = Stereo {
            separation,
            layout: StereoLayout::Anaglyph,
            convergence,
        };
        assert!(plain.with_stereo(Some(stereo)).is_err());
    }
}
