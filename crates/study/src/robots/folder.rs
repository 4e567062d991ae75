//! The draws of a robot as robots: a file for each.

use gyradius_campaign::{Progress, go_on, threads};
use gyradius_formats::{WriteError, is_same_file, is_same_robot, must_write, write_file_as};
use rayon::prelude::*;
use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
};

use super::{RobotDraw, RobotDrawError};

/// What a folder of robots has come to hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotFolder {
    /// The first file.
    pub first: Option<PathBuf>,
    /// The last file.
    pub last: Option<PathBuf>,
    /// Files that were written.
    pub written: u64,
    /// Files that were there already, the same to the byte.
    pub unchanged: u64,
    /// Paths of other files in the robot, meshes say, that lead to a file from its own folder and to none from this one.
    pub lost_paths: Vec<String>,
}

impl RobotDraw<'_> {
    /// The name of the file of a draw: `arm-0007.urdf` of `arm.urdf`.
    #[must_use]
    pub fn file_name(&self, draw: u64) -> String {
        let path = self.robot.path();
        let text =
            |part: Option<&std::ffi::OsStr>| part.map(|part| part.to_string_lossy().into_owned());
        let stem = text(path.file_stem()).unwrap_or_else(|| "robot".to_owned());
        let extension = text(path.extension()).map_or_else(String::new, |e| format!(".{e}"));
        format!("{stem}-{draw:04}{extension}")
    }

    /// Writes a file for each draw into a folder, which is made if it is not there. A file that is there already and is
    /// the same is left alone; another one is replaced with `force` only, and only if it is this robot with other
    /// mass properties; the one that was read never is. This is asked of all files before the first is written. The same bytes on any number of threads.
    ///
    /// # Errors
    /// A robot cannot be made, another file is there, the system refuses, or it was told to stop: files that were
    /// written stay.
    pub fn write_folder(
        &self,
        folder: &Path,
        force: bool,
        progress: Progress<'_>,
    ) -> Result<RobotFolder, RobotDrawError> {
        let draws = self.options.first..self.options.first + self.options.draws;
        // What cannot be made leaves no folder behind.
        draws.clone().next().map(|draw| self.robot(draw)).transpose()?;
        let name = || folder.display().to_string();
        let fail = |error: io::Error| match error.kind() {
            io::ErrorKind::AlreadyExists => RobotDrawError::NoFolder { path: name() },
            _ => RobotDrawError::Folder { path: name(), error },
        };
        fs::create_dir_all(folder).map_err(fail)?;
        let path = |draw| folder.join(self.file_name(draw));
        let (done, written) = (AtomicU64::new(0), AtomicU64::new(0));
        // What only some may read stays so in its copies.
        let permissions = fs::metadata(self.robot.path()).ok().map(|there| there.permissions());
        threads(self.options.threads)?.install(|| {
            draws.clone().into_par_iter().try_for_each(|draw| {
                let path = path(draw);
                if fs::symlink_metadata(&path).is_err() {
                    return Ok(());
                }
                if is_same_file(&path, self.robot.path()) {
                    return Err(RobotDrawError::Input { path: path.display().to_string() });
                }
                let copy = self.robot(draw)?;
                if must_write(&path, &copy, force)? {
                    let there = fs::read(&path)
                        .map_err(|error| WriteError::Io { path: path.clone(), error })?;
                    if !is_same_robot(&there, &copy) {
                        let path = path.display().to_string();
                        return Err(RobotDrawError::Foreign { path });
                    }
                }
                Ok(())
            })?;
            draws.clone().into_par_iter().try_for_each(|draw| {
                go_on(self.options.stop.as_deref())?;
                let (path, copy) = (path(draw), self.robot(draw)?);
                let changed = write_file_as(&path, &copy, force, permissions.clone())?;
                written.fetch_add(u64::from(changed), Ordering::Relaxed);
                progress(done.fetch_add(1, Ordering::Relaxed) + 1);
                Ok::<(), RobotDrawError>(())
            })
        })?;
        let written = written.into_inner();
        Ok(RobotFolder {
            first: draws.clone().next().map(path),
            last: draws.last().map(path),
            written,
            unchanged: self.options.draws - written,
            lost_paths: self.lost_paths(folder),
        })
    }

    fn lost_paths(&self, folder: &Path) -> Vec<String> {
        let from = self.robot.path().parent().unwrap_or(Path::new(""));
        let paths = self.robot.relative_paths().iter();
        paths.filter(|p| from.join(p).exists() && !folder.join(p).exists()).cloned().collect()
    }
}
