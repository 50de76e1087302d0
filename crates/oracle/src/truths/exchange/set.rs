//! The set of truths as a whole: its version, the names that it had before, and its digest.

/// The version of the set, which is not that of the program. The first number grows when a name or a value changed or a truth was taken away, the
/// second when truths were added, the third when only scenes or words changed. `truths.lock` keeps the names and values of this version, and a test
/// compares them.
pub const SET_VERSION: &str = "1.1.0";

/// Names of truths that an earlier version had and this one has not.
pub const REMOVED: &[&str] = &[];

/// The digest of truths, by name and value, and of the files of their scenes, by path and contents. The README of the exported folder explains it.
pub(super) fn digest<'a>(
    truths: impl Iterator<Item = (&'a str, f64)>,
    files: impl Iterator<Item = (&'a str, &'a [u8])>,
) -> String {
    let mut hash = Fnv::new();
    let mut truths: Vec<(&str, f64)> = truths.collect();
    truths.sort_by_key(|(name, _)| *name);
    for (name, value) in truths {
        hash.add(name.as_bytes());
        hash.add(b"\n");
        hash.add(&value.to_le_bytes());
    }
    let mut files: Vec<(&str, &[u8])> = files.collect();
    files.sort_by_key(|(path, _)| *path);
    for (path, contents) in files {
        hash.add(path.as_bytes());
        hash.add(b"\n");
        hash.add(contents);
    }
    format!("fnv1a64:{:016x}", hash.0)
}

/// FNV-1a of 64 bits (Fowler, Noll & Vo): it tells versions apart, and is no protection against forgery.
struct Fnv(u64);

impl Fnv {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors of the authors.
    #[test]
    fn the_hash_is_the_published_one() {
        for (text, hashed) in
            [("", 0xcbf2_9ce4_8422_2325_u64), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)]
        {
            let mut hash = Fnv::new();
            hash.add(text.as_bytes());
            assert_eq!(hash.0, hashed, "{text}");
        }
    }

    #[test]
    fn the_digest_depends_on_names_values_and_scenes_and_not_on_their_order() {
        let of = |truths: [(&str, f64); 2], files: [(&str, &str); 2]| {
            digest(truths.into_iter(), files.into_iter().map(|(path, contents)| (path, contents.as_bytes())))
        };
        let (truths, files) = ([("one", 1.0), ("two", 2.0)], [("scenes/one.json", "{}"), ("scenes/two.json", "[]")]);
        let whole = of(truths, files);
        assert_eq!(of([truths[1], truths[0]], [files[1], files[0]]), whole);
        assert_ne!(of([("on", 1.0), truths[1]], files), whole);
        assert_ne!(of([("one", 1.0_f64.next_up()), truths[1]], files), whole);
        assert_ne!(of(truths, [files[0], ("scenes/two.json", "[1]")]), whole);
    }
}
