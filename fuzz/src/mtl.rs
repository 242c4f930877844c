//! Materials of models.

use crate::obj::load;

const MODEL: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\nusemtl glass\nf 3/3 2/2 1/1\n";

pub fn run(data: &[u8]) {
    let host = crate::oracle::host().with("a.obj", MODEL).with("a.mtl", data);
    let text = String::from_utf8_lossy(data);
    let _ = load(&host, true, &[("a.obj", MODEL), ("a.mtl", &text)]);
}
