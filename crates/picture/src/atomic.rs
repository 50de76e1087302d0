//! Files that appear under their name whole or not at all.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::PictureError;

/// Writes a file so that its name always stands for the old content or the whole new one, even when the program is
/// killed or the machine stops: the content goes to a temporary file in the same folder, is flushed to the disk, and
/// takes the name by a rename. After an error nothing is left behind.
///
/// A symbolic link is followed, not replaced. A device such as `/dev/null` cannot be renamed over and is written directly. A
/// named pipe is refused: opening it would wait until somebody reads from it.
///
/// # Errors
/// [`PictureError::Io`] (also for an error that `content` returns), [`PictureError::NoFolder`],
/// [`PictureError::IsFolder`].
pub fn write_atomically(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), PictureError> {
    let failed = |source| PictureError::io("write", path, source);
    let Target { file, folder, stream } = target(path)?;
    if stream {
        let mut out = fs::OpenOptions::new().write(true).open(&file).map_err(failed)?;
        return content(&mut out).and_then(|()| out.flush()).map_err(failed);
    }
    let mut out = BufWriter::with_capacity(1 << 16, temporary_in(&folder).map_err(failed)?);
    content(&mut out).map_err(failed)?;
    let temporary = out.into_inner().map_err(|error| failed(error.into_error()))?;
    temporary.as_file().sync_all().map_err(failed)?;
    temporary.persist(&file).map_err(|error| failed(error.error))?;
    sync_folder(&folder).map_err(failed)
}

/// Finds out whether [`write_atomically`] could write this file, and leaves nothing behind: for use before the work.
/// A file that exists and may not be written is left alone and is an error, although a rename could replace it. Temporary files
/// that a killed program has left in the folder are taken away.
///
/// # Errors
/// Those that writing would give.
pub fn check_writable(path: &Path) -> Result<(), PictureError> {
    let failed = |source| PictureError::io("write", path, source);
    let Target { file, folder, stream } = target(path)?;
    if stream || file.exists() {
        fs::OpenOptions::new().write(true).open(&file).map_err(failed)?;
    }
    if !stream {
        remove_leftovers(&folder);
        let mut probe = temporary_in(&folder).map_err(failed)?;
        // A full disk still makes files; it is their content that it has no room for.
        let content = probe.write_all(&[0; 4096]).and_then(|()| probe.as_file().sync_all());
        probe.close().and(content).map_err(failed)?;
    }
    Ok(())
}

/// Temporary files begin and end so.
const TEMPORARY: [&str; 2] = [".etalon-", ".tmp"];
/// Younger files may be about to be locked.
const SURELY_LOCKED_AFTER: Duration = Duration::from_secs(1);

/// Takes away temporary files that nobody writes any more. Whoever writes one holds a lock on it, which ends with the process;
/// where locks or removal do not work, files stay.
fn remove_leftovers(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let named = name.to_str().is_some_and(|name| name.starts_with(TEMPORARY[0]) && name.ends_with(TEMPORARY[1]));
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        if named && age().is_some_and(|age| age > SURELY_LOCKED_AFTER) {
            let abandoned = fs::File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
            if abandoned {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}

/// Where a write really goes.
struct Target {
    /// The file, with symbolic links resolved.
    file: PathBuf,
    /// The folder it is in.
    folder: PathBuf,
    /// Whether it exists and is neither file nor folder.
    stream: bool,
}

fn target(path: &Path) -> Result<Target, PictureError> {
    let mut file = path.to_owned();
    // A link whose goal does not exist yet cannot be canonicalised as a whole; 40 is where Linux gives up, too.
    for _ in 0..40 {
        match fs::read_link(&file) {
            Ok(goal) => file = file.parent().unwrap_or(Path::new("")).join(goal),
            Err(_) => break,
        }
    }
    if file.file_name().is_none() || path.as_os_str().to_string_lossy().ends_with(std::path::MAIN_SEPARATOR) {
        return Err(PictureError::IsFolder { path: path.to_owned() });
    }
    let folder = match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    match fs::metadata(&folder) {
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => return Err(PictureError::io("write", path, io::ErrorKind::NotADirectory.into())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(PictureError::NoFolder { path: path.to_owned(), folder });
        }
        Err(error) => return Err(PictureError::io("write", path, error)),
    }
    let stream = match fs::metadata(&file) {
        Ok(metadata) if metadata.is_dir() => return Err(PictureError::IsFolder { path: path.to_owned() }),
        Ok(metadata) if is_pipe(&metadata) => {
            let why = io::Error::new(io::ErrorKind::InvalidInput, "it is a named pipe, not a plain file");
            return Err(PictureError::io("write", path, why));
        }
        Ok(metadata) => !metadata.is_file(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => false,
        Err(error) => return Err(PictureError::io("write", path, error)),
    };
    Ok(Target { file, folder, stream })
}

#[cfg(unix)]
fn is_pipe(metadata: &fs::Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&metadata.file_type())
}

#[cfg(not(unix))]
fn is_pipe(_: &fs::Metadata) -> bool {
    false
}

fn temporary_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY[0]).suffix(TEMPORARY[1]);
    // Temporary files are private by default; a picture gets what the user's umask gives to any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.tempfile_in(folder)?;
    // Tells others that this file is in use; on a file system without locks they leave it alone anyway.
    let _ = file.as_file().try_lock();
    Ok(file)
}

/// Makes the rename itself last through a power cut.
fn sync_folder(folder: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    match fs::File::open(folder).and_then(|folder| folder.sync_all()) {
        // A folder that can be written but not read, and file systems that cannot flush folders: the file is whole
        // under its name, and that is all that can be had there.
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::PermissionDenied | io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        result => result,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        for content in ["first and longer", "second"] {
            write_atomically(&path, |out| out.write_all(content.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), content);
        }
        assert_eq!(entries(folder.path()), ["out"]);
    }

    #[test]
    fn a_failed_write_keeps_the_old_file_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        fs::write(&path, "old").unwrap();
        let error = write_atomically(&path, |out| {
            out.write_all(&[7; 1 << 20])?;
            Err(io::Error::other("the disk caught fire"))
        })
        .unwrap_err();
        assert_eq!(error.with_causes(), format!("cannot write `{}`: the disk caught fire", path.display()));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(entries(folder.path()), ["out"]);
    }

    #[test]
    fn a_writer_that_panics_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        let caught = std::panic::catch_unwind(|| write_atomically(&path, |_| panic!("midway")));
        assert!(caught.is_err());
        assert_eq!(entries(folder.path()), [""; 0]);
    }

    #[test]
    fn checking_leaves_no_trace_and_keeps_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        check_writable(&path).unwrap();
        assert_eq!(entries(folder.path()), [""; 0]);
        fs::write(&path, "old").unwrap();
        check_writable(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(entries(folder.path()), ["out"]);
    }

    #[test]
    fn what_a_killed_program_left_is_taken_away_and_what_is_in_use_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let old = std::time::SystemTime::now() - Duration::from_secs(60);
        let [left, young, other] =
            [".etalon-aaaaaa.tmp", ".etalon-bbbbbb.tmp", ".etalon-notes"].map(|name| folder.path().join(name));
        for path in [&left, &young, &other] {
            fs::write(path, "half of a picture").unwrap();
        }
        for path in [&left, &other] {
            fs::File::options().write(true).open(path).unwrap().set_modified(old).unwrap();
        }
        let used = temporary_in(folder.path()).unwrap();
        used.as_file().set_modified(old).unwrap();
        check_writable(&folder.path().join("out")).unwrap();
        assert!(!left.exists() && young.exists() && other.exists() && used.path().exists());
    }

    #[test]
    fn a_missing_folder_a_folder_and_a_file_as_folder_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/out.exr");
        let error = check_writable(&missing).unwrap_err();
        assert!(matches!(&error, PictureError::NoFolder { folder, .. } if folder.ends_with("no")), "{error}");
        assert!(matches!(check_writable(folder.path()), Err(PictureError::IsFolder { .. })));
        assert!(matches!(check_writable(&folder.path().join("new/")), Err(PictureError::IsFolder { .. })));
        assert!(matches!(check_writable(Path::new("/")), Err(PictureError::IsFolder { .. })));
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(matches!(check_writable(&file.join("out.exr")), Err(PictureError::Io { .. })));
    }

    #[cfg(unix)]
    mod unix {
        use super::*;
        use std::os::unix::fs::{PermissionsExt, symlink};

        #[test]
        fn a_link_is_followed_even_when_its_goal_is_new() {
            let folder = tempfile::tempdir().unwrap();
            let (link, goal) = (folder.path().join("link"), folder.path().join("goal"));
            symlink("goal", &link).unwrap();
            for content in ["first", "second"] {
                check_writable(&link).unwrap();
                write_atomically(&link, |out| out.write_all(content.as_bytes())).unwrap();
                assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
                assert_eq!(fs::read_to_string(&goal).unwrap(), content);
            }
        }

        #[test]
        fn a_device_is_written_to_and_not_replaced() {
            let null = Path::new("/dev/null");
            check_writable(null).unwrap();
            write_atomically(null, |out| out.write_all(b"gone")).unwrap();
            assert!(!fs::metadata(null).unwrap().is_file());
        }

        #[test]
        fn a_named_pipe_is_refused_for_reading_and_writing_and_nothing_waits_for_its_other_end() {
            let folder = tempfile::tempdir().unwrap();
            let (pipe, link) = (folder.path().join("pipe"), folder.path().join("link"));
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
            symlink("pipe", &link).unwrap();
            for path in [&pipe, &link] {
                for error in [check_writable(path).unwrap_err(), write_atomically(path, |_| Ok(())).unwrap_err()] {
                    assert!(error.with_causes().contains("named pipe"), "{}", error.with_causes());
                }
                for error in
                    [crate::read_plain(path).unwrap_err(), crate::open_plain(Path::new("/dev/zero")).unwrap_err()]
                {
                    assert_eq!(error.to_string(), "it is a pipe or a device, not a plain file");
                }
            }
        }

        #[test]
        fn a_new_file_has_the_permissions_of_any_new_file() {
            let folder = tempfile::tempdir().unwrap();
            let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
            write_atomically(&ours, |_| Ok(())).unwrap();
            fs::write(&plain, "").unwrap();
            let mode = |path| fs::metadata(path).unwrap().permissions().mode();
            assert_eq!(mode(&ours), mode(&plain));
        }

        #[test]
        fn what_may_not_be_written_is_found_out_before() {
            let folder = tempfile::tempdir().unwrap();
            let closed = folder.path().join("closed");
            fs::create_dir(&closed).unwrap();
            fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).unwrap();
            // The superuser may write everywhere; then there is nothing to find out here.
            if fs::write(closed.join("probe"), "").is_ok() {
                return;
            }
            let error = check_writable(&closed.join("out.exr")).unwrap_err();
            assert!(error.with_causes().contains("out.exr"), "{error}");
            assert!(error.with_causes().to_lowercase().contains("permission"), "{}", error.with_causes());
        }
    }
}
