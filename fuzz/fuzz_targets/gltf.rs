#![no_main]
libfuzzer_sys::fuzz_target!(|data: &[u8]| rtscript_fuzz::models::gltf(data));
