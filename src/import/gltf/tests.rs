use std::fmt::Write as _;

use crate::{
    Builder, Limits, MemoryHost,
    diag::Diagnostic,
    import::{AssetCache, Assets, KeptAssets, load_mesh, load_mesh_shape},
    scene::Mesh,
};

/// Four corners, three numbers each, with the numbers of the corners of two triangles behind them.
fn quad_bytes() -> Vec<u8> {
    let corners = [
        [0.0f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let mut bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0, 2, 3]);
    bytes
}

/// A file of that quad as mesh 0, with these nodes and whatever else.
fn quad(nodes: &str, more: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": {nodes}, "meshes": [{{"primitives": [
        {{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
          {{"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 6}}],
        "buffers": [{{"byteLength": 54, "uri": "a.bin"}}]{more}}}"#
    )
}

fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let json = format!(
        "{json}{}",
        " ".repeat(json.len().next_multiple_of(4) - json.len())
    );
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json.bytes());
    bytes.extend((binary.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(binary);
    bytes
}

fn host(file: impl Into<Vec<u8>>) -> MemoryHost {
    MemoryHost::new().with("a.gltf", file).with("a.bin", quad_bytes())
}

/// The mesh and what was warned of.
fn load_from(host: &MemoryHost) -> Result<(Mesh, Vec<String>), Diagnostic> {
    let (limits, mut cache, mut builder) = (Limits::untrusted(), AssetCache::default(), Builder::new());
    let mesh = load_mesh(
        "a.gltf",
        &mut Assets::new(host, &limits, &mut cache),
        &mut builder,
    )?;
    let warnings = builder.take_warnings().iter().map(ToString::to_string).collect();
    Ok((Mesh::clone(&mesh), warnings))
}

fn load(file: impl Into<Vec<u8>>) -> Mesh {
    let (mesh, warnings) = load_from(&host(file)).unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    mesh
}

fn corners(mesh: &Mesh) -> Vec<[[f64; 3]; 3]> {
    let corners = |i| mesh.corners(i).map(|p| p.to_array());
    (0..mesh.triangles.len()).map(corners).collect()
}

#[test]
fn nodes_place_meshes() {
    let at = |nodes: &str| corners(&load(quad(nodes, "")));
    let plain = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
    ];
    assert_eq!(at(r#"[{"mesh": 0}]"#), plain);
    // Scaled, turned, moved, in this order; the parent's come behind.
    let turned = r#"[{"children": [1], "translation": [10, 0, 0]},
        {"mesh": 0, "scale": [2, 3, 1], "rotation": [0, 0, 1, 1], "translation": [1, 0, 5]}]"#;
    assert_eq!(
        at(turned)[0],
        [[11.0, 0.0, 5.0], [11.0, 2.0, 5.0], [8.0, 2.0, 5.0]]
    );
    // Column by column.
    let matrix = r#"[{"mesh": 0, "matrix": [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 1, 0, 1, 0, 5, 1]}]"#;
    assert_eq!(
        at(matrix)[0],
        [[1.0, 0.0, 5.0], [1.0, 2.0, 5.0], [-2.0, 2.0, 5.0]]
    );
    // In a mirror the front stays the front.
    let mirrored = at(r#"[{"mesh": 0, "scale": [1, 1, -1]}]"#);
    assert_eq!(
        mirrored[0],
        [plain[0][0], plain[0][2], plain[0][1]].map(|[x, y, z]| [x, y, -z])
    );
    // Each node before its children, and the first child first.
    let many = r#"[{"mesh": 0, "children": [2, 1]}, {"mesh": 0, "translation": [0, 0, 1]},
        {"mesh": 0, "translation": [0, 0, 2]}]"#;
    let depths: Vec<f64> = at(many).iter().step_by(2).map(|t| t[0][2]).collect();
    assert_eq!(depths, [0.0, 2.0, 1.0]);
    // Only what the scene names.
    let scene = quad(
        r#"[{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 7]}]"#,
        r#", "scenes": [{"nodes": [1]}]"#,
    );
    assert_eq!(corners(&load(scene))[0][0], [0.0, 0.0, 7.0]);
}

#[test]
fn normals_stand_on_what_is_scaled() {
    let file = quad(
        r#"[{"mesh": 0, "scale": [2, 1, -1], "rotation": [0, 1, 0, 1]}]"#,
        "",
    );
    // The positions of the quad as normals too: (1, 1, 0), say.
    let mesh = load(file.replace(r#""POSITION": 0"#, r#""POSITION": 0, "NORMAL": 0"#));
    let normals = mesh.normals.unwrap();
    // Mirrored, so the other way round.
    let [a, c, b] = normals.indices[0];
    // The first is of length zero, and so none.
    assert_eq!(a, u32::MAX);
    let unit = |i: u32| {
        let n = normals.values[i as usize];
        (n / n.length()).to_array().map(|x| (x * 1e6).round() / 1e6)
    };
    assert_eq!(unit(b).map(|x| x + 0.0), [0.0, 0.0, -1.0]);
    let (s, t) = (0.5f64 / 1.25f64.sqrt(), 1.0 / 1.25f64.sqrt());
    assert_eq!(
        unit(c).map(|x| x + 0.0),
        [0.0, t, -s].map(|x| (x * 1e6).round() / 1e6)
    );
}

#[test]
fn however_it_is_stored_the_mesh_is_the_same() {
    let nodes = r#"[{"mesh": 0}]"#;
    let expected = load(quad(nodes, ""));
    let same = |file: Vec<u8>| {
        let mesh = load(file);
        assert_eq!(
            (&mesh.positions, &mesh.triangles),
            (&expected.positions, &expected.triangles)
        );
    };
    same(glb(
        &quad(nodes, "").replace(r#", "uri": "a.bin""#, ""),
        &quad_bytes(),
    ));
    // 64 letters for 48 bytes, and so on.
    let mut base64 = String::new();
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for [a, b, c] in quad_bytes().as_chunks::<3>().0 {
        let bits = u32::from(*a) << 16 | u32::from(*b) << 8 | u32::from(*c);
        for shift in [18, 12, 6, 0] {
            let _ = write!(base64, "{}", char::from(LETTERS[(bits >> shift & 63) as usize]));
        }
    }
    let data = format!("data:application/octet-stream;base64,{base64}");
    same(quad(nodes, "").replace("a.bin", &data).into());
    // A byte order mark, and other names of the same thing.
    same(format!("\u{feff}{}", quad(nodes, "")).into());
    same(quad(nodes, "").replace("a.bin", "./%61.bin").into());
    // The two triangles as a fan, and as a strip.
    let of_mode = |mode: u32, indices: [u8; 4]| {
        let mut bytes = quad_bytes();
        bytes[48..52].copy_from_slice(&indices);
        let file = quad(nodes, "").replace(r#""indices": 1"#, &format!(r#""indices": 1, "mode": {mode}"#));
        let file = file.replace(r#""count": 6"#, r#""count": 4"#);
        let host = MemoryHost::new().with("a.gltf", file).with("a.bin", bytes);
        corners(&load_from(&host).unwrap().0)
    };
    assert_eq!(of_mode(6, [0, 1, 2, 3]), corners(&expected));
    let [a, b, c, d] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(of_mode(5, [0, 1, 3, 2]), [[a, b, d], [b, c, d]]);
}

#[test]
fn numbers_are_normalized_and_replaced() {
    let view = |bytes: &[u8], component: u32, more: &str| {
        let mut all = quad_bytes();
        all.extend([0, 0]);
        all.extend(bytes);
        let file = quad(r#"[{"mesh": 0}]"#, "")
            .replace(r#""POSITION": 0"#, r#""POSITION": 0, "TEXCOORD_0": 2"#)
            .replace(r#""type": "SCALAR"}"#, &format!(
                r#""type": "SCALAR"}}, {{"bufferView": 2, "componentType": {component}, "count": 4, "type": "VEC2"{more}}}"#
            ))
            .replace(r#""byteLength": 6}"#, &format!(
                r#""byteLength": 6}}, {{"buffer": 0, "byteOffset": 56, "byteLength": {}}}"#, bytes.len()
            ))
            .replace(r#""byteLength": 54"#, r#""byteLength": 56"#);
        let host = MemoryHost::new().with("a.gltf", file).with("a.bin", all);
        let mesh = load_from(&host).unwrap().0;
        // With v upwards, as it is in the file.
        mesh.uvs
            .unwrap()
            .values
            .iter()
            .map(|uv| [uv.x, 1.0 - uv.y])
            .collect::<Vec<_>>()
    };
    let normalized = r#", "normalized": true"#;
    let bytes = [0, 255, 51, 102, 255, 0, 0, 0];
    assert_eq!(view(&bytes, 5121, normalized)[..2], [[0.0, 1.0], [0.2, 0.4]]);
    assert_eq!(view(&bytes, 5121, "")[1], [51.0, 102.0]);
    let signed = [127, 0x81, 0x80, 0, 0, 0, 0, 0];
    assert_eq!(view(&signed, 5120, normalized)[..2], [[1.0, -1.0], [-1.0, 0.0]]);
    let shorts: Vec<u8> = [65535u16, 0, 13107, 0, 0, 0, 0, 0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    assert_eq!(view(&shorts, 5123, normalized)[..2], [[1.0, 0.0], [0.2, 0.0]]);
    // Of four pairs of zeros numbers 1 and 2 are others, which lie among the positions.
    let sparse = r#", "sparse": {"count": 2, "indices": {"bufferView": 1, "byteOffset": 1, "componentType": 5121},
        "values": {"bufferView": 0, "byteOffset": 12}}"#;
    let replaced = view(&[0; 32], 5126, sparse);
    assert_eq!(replaced, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]);
}

#[test]
fn what_is_not_used_is_said_once() {
    let nodes = r#"[{"mesh": 0, "skin": 0, "weights": [0.5]}, {"mesh": 0, "skin": 0, "weights": [0.5]}]"#;
    let more = r#", "skins": [{"joints": [0]}], "animations": [{}],
        "extensions": {"KHR_lights_punctual": {"lights": []}}"#;
    let file = quad(nodes, more).replace(
        r#""indices": 1}"#,
        r#""indices": 1}, {"attributes": {}, "mode": 0}"#,
    );
    let (mesh, warnings) = load_from(&host(file)).unwrap();
    assert_eq!(mesh.triangles.len(), 4);
    assert_eq!(
        warnings,
        [
            "a.gltf:6:100: warning: animations: animations are not used: the meshes stand where the nodes place them",
            "a.gltf:7:47: warning: extensions.KHR_lights_punctual: the lights of the file are not used\n  \
             help: point(...) and the like make lights",
            "a.gltf:1:61: warning: nodes[0].skin: skins do not bend the mesh: it stands as it was made",
            "a.gltf:1:75: warning: nodes[0].weights: morph targets are not used: the mesh stands as it was made",
            "a.gltf:2:83: warning: meshes[0].primitives[1].mode: points and lines are left out: only triangles are drawn",
        ]
    );
}

#[test]
fn whatever_is_cut_off_or_changed_ends_with_an_answer() {
    let file = quad(
        r#"[{"mesh": 0, "scale": [1, 2, 3]}]"#,
        r#", "materials": [{"alphaMode": "BLEND"}]"#,
    )
    .replace(r#""POSITION": 0"#, r#""POSITION": 0, "NORMAL": 0"#)
    .replace(r#""indices": 1"#, r#""indices": 1, "material": 0"#);
    let bytes = glb(&file.replace(r#", "uri": "a.bin""#, ""), &quad_bytes());
    load(bytes.clone());
    for whole in [file.as_bytes(), &bytes] {
        for end in 0..whole.len() {
            assert!(load_from(&host(&whole[..end])).is_err(), "up to {end}");
        }
    }
    let mut state = 12345u64;
    let mut below = |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    for whole in [file.as_bytes(), &bytes] {
        for k in 0..2000 {
            let mut changed = whole.to_vec();
            for _ in 0..1 + below(3) {
                let at = below(changed.len());
                changed[at] = if k % 2 == 0 {
                    below(256) as u8
                } else {
                    b"0123456789[]{},"[below(15)]
                };
            }
            match load_from(&host(changed)) {
                Ok((mesh, _)) => assert!(mesh.positions.iter().all(|p| p.is_finite())),
                Err(error) => assert!(!error.message.is_empty() && error.message.len() < 4096),
            }
        }
    }
}

#[test]
fn a_short_file_cannot_ask_for_much() {
    // A million corners at one place, by a buffer of which no list is a copy.
    let nodes: Vec<String> = (0..2000).map(|_| r#"{"mesh": 0}"#.to_owned()).collect();
    let file = quad(&format!("[{}]", nodes.join(",")), "")
        .replace(r#""indices": 1"#, r#""indices": 1, "mode": 5"#)
        .replace(
            r#"{"bufferView": 1, "componentType": 5121, "count": 6"#,
            r#"{"componentType": 5121, "count": 100002"#,
        );
    let error = load_from(&host(file)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a.gltf:2:9: error: too many triangles: the limit 'primitives' is 200000"
    );
}

#[test]
fn kept_meshes_go_by_all_their_files() {
    let kept = KeptAssets::new();
    let run = |host: &MemoryHost| {
        let (limits, mut builder) = (Limits::default(), Builder::new());
        let mut cache = AssetCache::keeping(Some(kept.clone()));
        let mut assets = Assets::new(host, &limits, &mut cache);
        let mesh = load_mesh("a.gltf", &mut assets, &mut builder).unwrap();
        let shape = load_mesh_shape("a.gltf", &mut assets, &mut builder).unwrap();
        assert_eq!(mesh.positions, shape.positions);
        (mesh.bounds().max.x, cache.files())
    };
    let file = quad(r#"[{"mesh": 0}]"#, r#", "materials": [{"name": "a"}]"#)
        .replace(r#""indices": 1"#, r#""indices": 1, "material": 0"#);
    let with = |x: f32| {
        let mut bytes = quad_bytes();
        bytes[12..16].copy_from_slice(&x.to_le_bytes());
        MemoryHost::new()
            .with("a.gltf", file.clone())
            .with("a.bin", bytes)
    };
    assert_eq!(run(&with(1.0)), (1.0, 4));
    assert_eq!(kept.counts(), (2, 0));
    assert_eq!(run(&with(1.0)), (1.0, 4));
    assert_eq!(kept.counts(), (2, 2));
    assert_eq!(run(&with(3.0)), (3.0, 4));
}

/// The quad with colors: 3 floats of each corner stand in the positions, so corner i has the color of its place.
fn colored(attribute: &str, accessors: &str, materials: &str) -> String {
    quad(r#"[{"mesh": 0}]"#, materials)
        .replace(
            r#""POSITION": 0}, "#,
            &format!(r#""POSITION": 0, "COLOR_0": {attribute}}}, "material": 0, "#),
        )
        .replace(
            r#""type": "SCALAR"}]"#,
            &format!(r#""type": "SCALAR"}}{accessors}]"#),
        )
}

#[test]
fn colors_of_vertices_stand_as_they_are_given_and_tint_the_base() {
    let plain = r#", "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "metallicFactor": 0}}]"#;
    let mesh = load(colored("0", "", plain));
    let colors = mesh.colors.as_ref().unwrap();
    assert_eq!(
        colors.corners(1).unwrap().map(|c| c.to_array()),
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
    );
    // Normalized bytes: the first of the numbers of the positions are 0, 0, 0 and 0, 0, 0 and then 0, 0x80, 0x3f.
    let bytes =
        r#", {"bufferView": 0, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"}"#;
    let mesh = load(colored("2", bytes, plain));
    let colors = mesh.colors.unwrap().values;
    assert_eq!(colors[3].to_array(), [0.0, 0.0, 128.0 / 255.0]);
    // The material shows them, in its color.
    let (limits, mut cache, mut builder) = (Limits::untrusted(), AssetCache::default(), Builder::new());
    let host = host(colored("0", "", plain));
    let mesh = load_mesh(
        "a.gltf",
        &mut Assets::new(&host, &limits, &mut cache),
        &mut builder,
    )
    .unwrap();
    let scene = builder.finish().value;
    let material = &scene.materials[mesh.face_materials[0].index()];
    let texture = &scene.textures[material.diffuse.texture.unwrap().index()];
    assert_eq!(**texture, crate::scene::Texture::VertexColors);
    assert_eq!(material.diffuse.color.to_array(), [0.5, 1.0, 1.0]);
    // Without materials the mesh has them all the same.
    let shape = load_mesh_shape(
        "a.gltf",
        &mut Assets::new(&host, &limits, &mut cache),
        &mut Builder::new(),
    );
    assert!(shape.unwrap().colors.is_some());
}

#[test]
fn vertices_without_colors_are_white_beside_others() {
    let two = colored("0", "", r#", "materials": [{}]"#).replace(
        r#""primitives": ["#,
        r#""primitives": [{"attributes": {"POSITION": 0}, "indices": 1}, "#,
    );
    let colors = load(two).colors.unwrap();
    assert_eq!(colors.corners(0).unwrap(), [crate::color::Color::ONE; 3]);
    assert_eq!(colors.corners(2).unwrap()[1].to_array(), [1.0, 0.0, 0.0]);
    assert_eq!(load(quad(r#"[{"mesh": 0}]"#, "")).colors, None);
}

#[test]
fn wrong_colors_are_refused_with_their_place() {
    let message = |attribute: &str, accessors: &str| {
        let error = load_from(&host(colored(attribute, accessors, r#", "materials": [{}]"#))).unwrap_err();
        assert_eq!(error.file.as_deref(), Some("a.gltf"));
        assert!(error.line > 0, "{error}");
        error.message
    };
    for (attribute, accessors, wanted) in [
        ("9", "", "COLOR_0"),
        ("1", "", "expected VEC3 or VEC4"),
        (
            "2",
            r#", {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC4"}"#,
            "the accessor has 3 elements, and POSITION 4",
        ),
    ] {
        let message = message(attribute, accessors);
        assert!(message.contains(wanted), "{message}");
    }
    // Not a number, in the second corner.
    let host = MemoryHost::new()
        .with(
            "a.gltf",
            colored(
                "2",
                r#", {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"}"#,
                r#", "materials": [{}]"#,
            )
            .replace(
                r#""byteLength": 6}]"#,
                r#""byteLength": 6}, {"buffer": 1, "byteLength": 48}]"#,
            )
            .replace(
                r#""uri": "a.bin"}"#,
                r#""uri": "a.bin"}, {"byteLength": 48, "uri": "b.bin"}"#,
            ),
        )
        .with("a.bin", quad_bytes());
    for (bad, shown) in [
        (f32::NAN, "NaN"),
        (-0.5, "-0.5"),
        (f32::INFINITY, "inf"),
        (2e6, "2000000"),
    ] {
        let numbers = [0.0, 0.0, 0.0, 1.0, bad].into_iter().chain([0.5; 7]);
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        let error = load_from(&host.clone().with("b.bin", bytes)).unwrap_err();
        let wanted = format!("the color 1, {shown}, 0.5 of vertex 1; expected numbers from 0 to 1000000");
        assert!(error.message.contains(&wanted), "{error}");
    }
}
