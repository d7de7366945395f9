//! Waiting for the results of tasks without holding up the thread pool that runs them.

use std::sync::mpsc::{Receiver, TryRecvError};

use rayon::Yield;

/// The next message of tasks in a scope; `None` once all senders are gone. A caller that is a thread of the pool itself
/// runs tasks while it waits: a pool may have no other thread (targets without threads have none), or all of its
/// threads may wait like this one.
pub(super) fn next_message<T>(receiver: &Receiver<T>) -> Option<T> {
    loop {
        match receiver.try_recv() {
            Ok(message) => return Some(message),
            Err(TryRecvError::Disconnected) => return None,
            Err(TryRecvError::Empty) if rayon::yield_now() == Some(Yield::Executed) => {}
            // Every task is done or runs on another thread.
            Err(TryRecvError::Empty) => return receiver.recv().ok(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn the_only_thread_of_a_pool_waits_for_its_own_tasks() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let sum = pool.install(|| {
            let (sender, receiver) = channel();
            rayon::in_place_scope(|scope| {
                for k in 1..=3 {
                    let sender = sender.clone();
                    scope.spawn(move |_| sender.send(k).unwrap());
                }
                drop(sender);
                std::iter::from_fn(|| next_message(&receiver)).sum::<i32>()
            })
        });
        assert_eq!(sum, 6);
    }
}
