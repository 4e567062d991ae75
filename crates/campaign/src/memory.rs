//! What a machine has left of memory: for this process, and as far as the system tells.

#[cfg(target_os = "linux")]
mod linux;

/// Bytes of memory that this process can still take: the least of what the machine has available, of what the control groups of the
/// process leave it, as of a container or a job of a scheduler, and of the limit of its address space (`ulimit -v`). None if
/// the system does not tell.
#[must_use]
pub fn memory_left() -> Option<u64> {
    #[cfg(target_os = "linux")]
    return linux::left();
    #[cfg(not(target_os = "linux"))]
    None
}
