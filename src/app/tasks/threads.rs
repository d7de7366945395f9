//! Each piece of work on a thread of its own.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use super::{Rest, Serve};

/// Does some work.
pub fn work(work: impl FnOnce() + Send + 'static) {
    std::thread::spawn(work);
}

/// Sends messages to a server. The server ends when all posts are gone.
pub struct Post<M>(Sender<M>);

impl<M> Clone for Post<M> {
    fn clone(&self) -> Self {
        Post(self.0.clone())
    }
}

impl<M> Post<M> {
    /// Sends a message. Nothing happens where the server has ended: it has reported why.
    pub fn send(&self, message: M) {
        let _ = self.0.send(message);
    }
}

/// The end of a server.
pub struct Ended(JoinHandle<()>);

impl Ended {
    /// Waits until the server has done all that it was asked for, and has ended. All posts must be gone.
    pub fn wait(self) {
        // A server that has panicked has ended too.
        let _ = self.0.join();
    }
}

/// Begins a server. `make` makes it, or nothing where that fails; it is given the post, for messages to itself.
pub fn serve<M, S>(make: impl FnOnce(&Post<M>) -> Option<S> + Send + 'static) -> (Post<M>, Ended)
where
    M: Send + 'static,
    S: Serve<M>,
{
    let (sender, messages) = channel();
    let post = Post(sender);
    let own = post.clone();
    let thread = std::thread::spawn(move || {
        let server = make(&own);
        drop(own);
        if let Some(mut server) = server {
            while let Some(message) = next(&mut server, &messages) {
                if server.hear(message, &messages).is_break() {
                    break;
                }
            }
        }
    });
    (post, Ended(thread))
}

/// The next message for a server, which rests meanwhile; none once there will be no more.
fn next<M>(server: &mut impl Serve<M>, messages: &Receiver<M>) -> Option<M> {
    loop {
        match messages.try_recv() {
            Ok(message) => return Some(message),
            Err(TryRecvError::Disconnected) => return None,
            Err(TryRecvError::Empty) => {}
        }
        match server.rest() {
            Rest::Busy => {}
            Rest::Asleep => return messages.recv().ok(),
            Rest::For(time) => match messages.recv_timeout(time) {
                Ok(message) => return Some(message),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) => {}
            },
        }
    }
}

/// The next report of some work, if it comes soon.
pub fn hear_within<T>(reports: &Receiver<T>, patience: Duration) -> Option<T> {
    reports.recv_timeout(patience).ok()
}

/// Threads go on by themselves.
pub fn give_turns(_: Duration) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;
    use std::sync::mpsc::Sender;

    use super::*;

    /// Adds numbers up, and tells the sum when it rests.
    struct Adder {
        sum: i32,
        told: Sender<i32>,
    }

    impl Serve<i32> for Adder {
        fn hear(&mut self, message: i32, later: &Receiver<i32>) -> ControlFlow<()> {
            self.sum += message + later.try_iter().sum::<i32>();
            if message < 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }

        fn rest(&mut self) -> Rest {
            let _ = self.told.send(self.sum);
            Rest::Asleep
        }
    }

    #[test]
    fn a_server_hears_all_messages_and_rests_when_there_is_none() {
        let (told, sums) = channel();
        let (post, ended) = serve(move |own: &Post<i32>| {
            own.send(1);
            own.send(2);
            Some(Adder { sum: 0, told })
        });
        let patience = Duration::from_secs(20);
        assert_eq!(hear_within(&sums, patience), Some(3));
        post.send(4);
        assert_eq!(hear_within(&sums, patience), Some(7));
        drop(post);
        ended.wait();
        assert_eq!(hear_within(&sums, patience), None);
    }

    #[test]
    fn a_server_ends_by_a_message_and_what_comes_after_it_is_lost() {
        let (told, sums) = channel();
        let (post, ended) = serve(move |_| Some(Adder { sum: 0, told }));
        post.send(-1);
        ended.wait();
        post.send(5);
        assert!(sums.try_iter().all(|sum| sum == 0));
    }
}
