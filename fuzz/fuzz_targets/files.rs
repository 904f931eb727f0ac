#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| feedwright_fuzz_targets::files(data));
