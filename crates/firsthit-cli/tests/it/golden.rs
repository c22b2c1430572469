//! The demo's picture to the bit, on every instruction set and with any number of threads.

use firsthit::InstructionSet;

use super::support::{Lab, array};

/// The picture with the default samples. After an intended change, put here what the failing test
/// prints.
const ANTIALIASED: &str = "283da2005f5aa82290645801748d31410087dafc1613916b73ac51320a5e841b";

/// The picture with one sample per pixel, which no change of antialiasing may touch.
const ONE_SAMPLE: &str = "be0133668f5a217c9d8974a9793da1563bf56468caf05af77717368086dd9530";

/// The BLAKE3 digest of the colours, which are float32 numbers. A file's digest would not do: it
/// may name the version and depends on the compressor, and a PNG rounds away differences in the
/// last bits.
fn digest(set: InstructionSet, arguments: &str) -> String {
    let lab = Lab::new();
    let arguments = format!("demo --size 320x180 --quiet --output picture.npy {arguments}");
    let mut command = lab.command(&arguments);
    let status = command.env("FIRSTHIT_ISA", set.name()).status().unwrap();
    assert!(status.success(), "{set:?} {arguments}");
    let picture = array(&lab.read("picture.npy"));
    assert_eq!((&*picture.dtype, &*picture.shape), ("<f4", &[180, 320, 3][..]));
    let bytes: Vec<u8> = picture.values.iter().flat_map(|x| x.to_le_bytes()).collect();
    blake3::hash(&bytes).to_string()
}

fn check(golden: &str, arguments: &str) {
    for set in InstructionSet::available() {
        for threads in 1..=3 {
            let found = digest(set, &format!("--threads {threads} {arguments}"));
            assert_eq!(found, golden, "{set:?}, {threads} threads: now {found}");
        }
    }
}

#[test]
fn the_demo_is_the_same_to_the_bit_everywhere() {
    check(ANTIALIASED, "");
}

#[test]
fn the_demo_with_one_sample_is_the_same_to_the_bit_everywhere() {
    check(ONE_SAMPLE, "--samples 1");
}
