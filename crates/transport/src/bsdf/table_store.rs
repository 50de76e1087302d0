//! Tables that are made when a scene is prepared, kept for the process and, if a program asks for it, in files for later runs.
//!
//! A table follows from its [`Key`] and from the sources alone. So a program names the folder after the hash of its sources:
//! another program looks elsewhere. A file holds every bit of a table, and its hash. A file that cannot be read is as one that is not there.

use std::collections::HashMap;
use std::fs;
use std::hash::Hash;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};
use std::time::{Duration, SystemTime};

use etalon_scene::{FacetDistribution, FacetMasking};
use sha2::{Digest, Sha256};

use super::microfacet::Distribution;

/// Most files of one version of the program: a sequence of ever new roughnesses does not fill the disk. They take 50 MB where facets have one width,
/// and 0.7 GB at most.
const MOST_FILES: usize = 4096;
/// Folders of other versions are removed when nothing was added to them for this long.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(30 * 24 * 3600);
/// More bytes than any table has: facets of two widths and most indices have 143 kB.
const MOST_BYTES: u64 = 1 << 20;
const MAGIC: &[u8] = b"etalon table 1\n";
/// The one of this process.
static STORE: OnceLock<Store> = OnceLock::new();

/// A folder of tables, and how many are there.
#[derive(Debug)]
struct Store {
    folder: PathBuf,
    files: AtomicUsize,
}

/// What a table of facets is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Tabulated {
    /// What facets that reflect everything lose.
    Mirrors,
    /// What facets of a coat let in.
    Coat,
    /// The same, of a coat that loses what facets hide.
    LossyCoat,
    /// What such a coat reflects from below.
    UnderCoat,
    /// What facets between two media lose of light from before them.
    Outside,
    /// What they lose of light from behind them.
    Inside,
}

/// Facets and a range of relative indices: all that a table is a function of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key {
    of: Tabulated,
    facets: (FacetDistribution, FacetMasking),
    alpha: [u64; 2],
    eta: [u64; 2],
}

/// A table as numbers.
pub(crate) trait Table: Sized {
    /// The sort, in names of files.
    const SORT: &'static str;

    /// All that it holds.
    fn to_numbers(&self) -> Vec<f64>;

    /// The table of facets of `distribution` that holds these; `None` if their count fits none.
    fn from_numbers(numbers: &[f64], distribution: &Distribution) -> Option<Self>;
}

/// Tables of one sort, each made once: images of roughness ask for many, the materials of a scene for the same ones, and so does the same
/// scene when it is prepared anew.
pub(crate) struct SharedTables<T>(LazyLock<Mutex<HashMap<Key, Arc<T>>>>);

impl<T: Table> SharedTables<T> {
    pub(crate) const fn new() -> Self {
        Self(LazyLock::new(Mutex::default))
    }

    pub(crate) fn get(
        &self,
        of: Tabulated,
        distribution: &Distribution,
        eta: [f64; 2],
        make: impl FnOnce() -> T,
    ) -> Arc<T> {
        let (alpha, eta) = (distribution.alpha().map(f64::to_bits), eta.map(f64::to_bits));
        let key = Key { of, facets: distribution.kind(), alpha, eta };
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(table) = known().get(&key) {
            return Arc::clone(table);
        }
        // Not under the lock: making it hands work to threads that may ask for another.
        let table = Arc::new(match STORE.get() {
            Some(store) => store.get(&key, distribution, make),
            None => make(),
        });
        Arc::clone(known().entry(key).or_insert(table))
    }
}

/// Keeps tables in files of `folder`, which is made when the first is written, for programs of these sources: their hash, in hex. Folders beside it that other
/// programs have left are removed after 30 days. Only the first call counts.
///
/// A table that cannot be written is made again by the next run.
///
/// # Errors
/// If the folder is there and cannot be read.
pub fn keep_tables(folder: &Path, sources: &str) -> io::Result<()> {
    let store = Store::new(folder, sources)?;
    // A second folder for one process would be of use to none.
    let _first = STORE.set(store);
    Ok(())
}

impl Store {
    fn new(folder: &Path, sources: &str) -> io::Result<Self> {
        let own = folder.join(sources.get(..16).unwrap_or(sources));
        let files = match fs::read_dir(&own) {
            Ok(files) => files.count(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                remove_forgotten(folder, SystemTime::now());
                0
            }
            Err(error) => return Err(error),
        };
        Ok(Self { folder: own, files: AtomicUsize::new(files) })
    }

    /// The table of a key, from its file if there is one. Otherwise it is made, and written.
    fn get<T: Table>(&self, key: &Key, distribution: &Distribution, make: impl FnOnce() -> T) -> T {
        let path = self.folder.join(key.file_name(T::SORT));
        let bytes = read(&path);
        let (is_new, kept) = (bytes.is_err(), bytes.ok().and_then(|bytes| decoded(&bytes, distribution)));
        kept.unwrap_or_else(|| {
            let table = make();
            if !is_new || self.files.fetch_add(1, Ordering::Relaxed) < MOST_FILES {
                // Without it the next run takes longer.
                let _written = write(&path, &encoded(&table));
            }
            table
        })
    }
}

/// Removes folders of tables to which nothing was added for long.
fn remove_forgotten(folder: &Path, now: SystemTime) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_ours = entry
            .file_name()
            .to_str()
            .is_some_and(|name| name.len() == 16 && name.bytes().all(|b| b.is_ascii_hexdigit()));
        let changed = entry.metadata().and_then(|about| about.modified());
        let age = changed.ok().and_then(|changed| now.duration_since(changed).ok());
        if is_ours && age.is_some_and(|age| age > FORGOTTEN_AFTER) {
            // What stays takes some space, and is no harm.
            let _removed = fs::remove_dir_all(entry.path());
        }
    }
}

/// What is in a file, or the beginning of one that is too long to be a table.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    // What is no file may never end, or never begin.
    if !fs::metadata(path)?.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(MOST_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Writes a file whole or not at all.
fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().ok_or(io::ErrorKind::InvalidInput)?;
    fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

fn encoded<T: Table>(table: &T) -> Vec<u8> {
    let numbers: Vec<u8> = table.to_numbers().into_iter().flat_map(f64::to_le_bytes).collect();
    [MAGIC, &Sha256::digest(&numbers), &numbers].concat()
}

/// `None` of bytes that are not [`encoded`], or not of such a table.
fn decoded<T: Table>(bytes: &[u8], distribution: &Distribution) -> Option<T> {
    let (hash, numbers) = bytes.strip_prefix(MAGIC)?.split_at_checked(32)?;
    let (numbers, rest) = numbers.as_chunks::<8>();
    let intact = rest.is_empty() && Sha256::digest(numbers.as_flattened())[..] == *hash;
    let numbers: Vec<f64> = intact.then(|| numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())?;
    T::from_numbers(&numbers, distribution)
}

impl Key {
    /// Says all of the key.
    fn file_name(&self, sort: &str) -> String {
        let Self { of, facets: (distribution, masking), alpha: [x, y], eta: [first, last] } = self;
        format!("{sort}-{of:?}-{distribution:?}-{masking:?}-{x:016x}-{y:016x}-{first:016x}-{last:016x}").to_lowercase()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_scene::Microfacets;

    #[derive(Debug, PartialEq)]
    struct Two([f64; 2]);

    impl Table for Two {
        const SORT: &'static str = "two";

        fn to_numbers(&self) -> Vec<f64> {
            self.0.to_vec()
        }

        fn from_numbers(numbers: &[f64], _: &Distribution) -> Option<Self> {
            numbers.try_into().ok().map(Self)
        }
    }

    fn facets() -> Distribution {
        let (distribution, masking) = (FacetDistribution::Ggx, FacetMasking::Correlated);
        Distribution::new(&Microfacets { alpha: [0.25, 0.5], rotation_rad: 0.0, distribution, masking })
    }

    fn key() -> Key {
        Key { of: Tabulated::Coat, facets: facets().kind(), alpha: [1, 2], eta: [3, 4] }
    }

    #[test]
    fn files_hold_every_bit_and_broken_ones_hold_nothing() {
        let table = Two([0.1, -0.0]);
        let bytes = encoded(&table);
        let read = decoded::<Two>(&bytes, &facets()).expect("it is whole");
        assert_eq!(read.0.map(f64::to_bits), table.0.map(f64::to_bits));
        for end in 0..bytes.len() {
            assert_eq!(decoded::<Two>(&bytes[..end], &facets()), None, "{end} bytes");
        }
        for at in 0..bytes.len() {
            let mut other = bytes.clone();
            other[at] ^= 1;
            assert_eq!(decoded::<Two>(&other, &facets()), None, "byte {at} is wrong");
        }
        let longer = [&bytes[..], &[0; 8]].concat();
        assert_eq!(decoded::<Two>(&longer, &facets()), None);
    }

    #[test]
    fn a_table_is_made_once_and_again_if_its_file_is_broken() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = |sources: &str| Store::new(folder.path(), sources).expect("it can be read");
        let made = |store: &Store, value: f64| store.get(&key(), &facets(), || Two([value; 2])).0[0];
        let sources = "0123456789abcdef0123";
        let first = store(sources);
        assert_eq!(made(&first, 1.0), 1.0);
        // Another process, which has nothing in memory.
        assert_eq!(made(&store(sources), 2.0), 1.0);
        // Another program.
        assert_eq!(made(&store("fedcba9876543210"), 3.0), 3.0);
        let path = folder.path().join(&sources[..16]).join(key().file_name(Two::SORT));
        fs::write(&path, b"etalon table 1\nnot really").expect("it is ours");
        assert_eq!(made(&store(sources), 4.0), 4.0);
        assert_eq!(made(&store(sources), 5.0), 4.0);
        // Full: what is there is read, what is not is made each time, and what is broken is mended.
        let full = Store { files: AtomicUsize::new(MOST_FILES), ..store(sources) };
        assert_eq!(made(&full, 6.0), 4.0);
        fs::write(&path, b"").expect("it is ours");
        assert_eq!([made(&full, 7.0), made(&full, 8.0)], [7.0, 7.0]);
        fs::remove_file(&path).expect("it is ours");
        assert_eq!([made(&full, 9.0), made(&full, 10.0)], [9.0, 10.0]);
        // What has more bytes than a table is none, and is not read to its end.
        fs::File::create(&path).and_then(|file| file.set_len(1 << 32)).expect("it takes no space");
        assert_eq!([made(&full, 11.5), made(&full, 12.5)], [11.5, 11.5]);
        // Where there can be no folder, tables are made.
        let file = folder.path().join("a file");
        fs::write(&file, b"").expect("it is new");
        assert!(Store::new(&file, sources).is_err());
        let nowhere = Store { folder: file.join("x"), files: AtomicUsize::new(0) };
        assert_eq!([made(&nowhere, 11.0), made(&nowhere, 12.0)], [11.0, 12.0]);
    }

    #[test]
    fn names_of_files_tell_tables_apart() {
        let key = key();
        let others = [
            Key { of: Tabulated::LossyCoat, ..key },
            Key { facets: (FacetDistribution::Beckmann, FacetMasking::Correlated), ..key },
            Key { facets: (FacetDistribution::Ggx, FacetMasking::Separable), ..key },
            Key { alpha: [2, 1], ..key },
            Key { eta: [3, 5], ..key },
        ];
        for other in others {
            assert_ne!(key.file_name("two"), other.file_name("two"));
        }
        assert_ne!(key.file_name("one"), key.file_name("two"));
    }

    #[test]
    fn folders_of_other_versions_are_removed_when_they_are_old() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["0123456789abcdef", "pictures of mine", "0123456789abcde"] {
            fs::create_dir(folder.path().join(name)).expect("it is new");
        }
        let names = || fs::read_dir(folder.path()).expect("it is there").count();
        let now = SystemTime::now();
        remove_forgotten(folder.path(), now + FORGOTTEN_AFTER / 2);
        assert_eq!(names(), 3);
        remove_forgotten(folder.path(), now + 2 * FORGOTTEN_AFTER);
        assert_eq!(names(), 2);
        assert!(!folder.path().join("0123456789abcdef").exists());
    }
}
