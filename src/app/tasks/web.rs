//! Tasks of a page, which has one thread. A task gives way to the page whenever it looks whether it is to end: it is
//! suspended there, with all that it has on its stack (JavaScript Promise Integration). A browser that cannot do that
//! runs each task to its end.
// wasm-bindgen calls that experimental by a warning.
#![allow(deprecated)]

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use wasm_bindgen::prelude::wasm_bindgen;
use web_time::Instant;

use super::{Rest, Serve};
use crate::core::progress;

/// How long a task works before it gives way. The page draws meanwhile, some 60 times a second where it can.
const TURN: Duration = Duration::from_millis(8);

#[wasm_bindgen(js_namespace = quadfront)]
extern "C" {
    /// Has [`run_task`] called after so many milliseconds.
    #[wasm_bindgen(js_name = later)]
    fn call_later(milliseconds: u32);

    /// Calls [`run_task`] at once, and returns when the task has ended or gives way. Whether that is possible here.
    #[wasm_bindgen(js_name = now)]
    fn call_now() -> bool;

    /// Returns once the page has done what it waits for.
    #[wasm_bindgen(js_name = giveWay, suspending)]
    fn give_way();
}

type Task = Box<dyn FnOnce()>;

thread_local! {
    /// Tasks to begin, each with the time before which it does not.
    static TASKS: RefCell<VecDeque<(Instant, Task)>> = const { RefCell::new(VecDeque::new()) };
    /// When the current turn of the task that runs now began; none while no task runs.
    static TURN_BEGAN: Cell<Option<Instant>> = const { Cell::new(None) };
}

fn begin_after(time: Duration, task: Task) {
    progress::on_look(look);
    TASKS.with_borrow_mut(|tasks| tasks.push_back((Instant::now() + time, task)));
    call_later(time.as_millis().try_into().unwrap_or(u32::MAX));
}

/// Runs a task whose time has come. The page calls this as often as [`call_later`] asked for.
#[wasm_bindgen(jspi, js_name = runTask)]
pub fn run_task() {
    let now = Instant::now();
    let due = TASKS.with_borrow_mut(|tasks| {
        // Clocks of browsers are coarse: what is due first is taken even a moment early.
        let first = (0..tasks.len()).min_by_key(|&k| tasks[k].0.max(now))?;
        tasks.remove(first)
    });
    if let Some((_, task)) = due {
        TURN_BEGAN.set(Some(now));
        task();
        TURN_BEGAN.set(None);
    }
}

/// Gives way, if a task runs and its turn is over.
fn look() {
    if TURN_BEGAN.get().is_some_and(|began| began.elapsed() >= TURN) {
        TURN_BEGAN.set(None);
        give_way();
        TURN_BEGAN.set(Some(Instant::now()));
    }
}

/// Does some work.
pub fn work(work: impl FnOnce() + Send + 'static) {
    begin_after(Duration::ZERO, Box::new(work));
}

/// Sends messages to a server. The server ends when all posts are gone.
pub struct Post<M> {
    sender: Sender<M>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl<M> Clone for Post<M> {
    fn clone(&self) -> Self {
        Post { sender: self.sender.clone(), wake: self.wake.clone() }
    }
}

impl<M> Post<M> {
    /// Sends a message. Nothing happens where the server has ended: it has reported why.
    pub fn send(&self, message: M) {
        let _ = self.sender.send(message);
        (self.wake)();
    }
}

impl<M> Drop for Post<M> {
    fn drop(&mut self) {
        // The server sees whether this was the last one.
        (self.wake)();
    }
}

/// A server between its turns, with its messages; none while it is being made or has a turn, and once it has ended.
struct Seat<M, S>(Mutex<Option<(S, Receiver<M>)>>);

impl<M: Send + 'static, S: Serve<M> + Send + 'static> Seat<M, S> {
    fn take(&self) -> Option<(S, Receiver<M>)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn put_back(&self, resting: (S, Receiver<M>)) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(resting);
    }

    fn turn_after(self: &Arc<Self>, time: Duration) {
        let own = self.clone();
        begin_after(time, Box::new(move || own.turn()));
    }

    /// Does what there is to do.
    fn turn(self: &Arc<Self>) {
        let Some((mut server, messages)) = self.take() else { return };
        loop {
            let rest = match messages.try_recv() {
                Ok(message) => match server.hear(message, &messages) {
                    ControlFlow::Break(()) => return,
                    ControlFlow::Continue(()) => Rest::Busy,
                },
                Err(TryRecvError::Disconnected) => return,
                Err(TryRecvError::Empty) => server.rest(),
            };
            match rest {
                Rest::Busy => look(),
                Rest::For(time) => {
                    self.put_back((server, messages));
                    return self.turn_after(time);
                }
                Rest::Asleep => return self.put_back((server, messages)),
            }
        }
    }
}

/// The end of a server.
pub struct Ended(Box<dyn Fn()>);

impl Ended {
    /// Has the server do at once all that it was asked for.
    pub fn wait(self) {
        (self.0)();
    }
}

/// Begins a server. `make` makes it, or nothing where that fails; it is given the post, for messages to itself.
pub fn serve<M, S>(make: impl FnOnce(&Post<M>) -> Option<S> + Send + 'static) -> (Post<M>, Ended)
where
    M: Send + 'static,
    S: Serve<M> + Send + 'static,
{
    let (sender, messages) = channel();
    let seat = Arc::new(Seat(Mutex::new(None)));
    let waking = seat.clone();
    let post = Post { sender, wake: Arc::new(move || waking.turn_after(Duration::ZERO)) };
    let (own, begun) = (post.clone(), seat.clone());
    work(move || {
        let server = make(&own);
        drop(own);
        if let Some(server) = server {
            begun.put_back((server, messages));
            begun.turn();
        }
    });
    (post, Ended(Box::new(move || seat.turn())))
}

/// Has a task whose time has come take a turn. Whether there was one.
fn give_turn() -> bool {
    let now = Instant::now();
    TASKS.with_borrow(|tasks| tasks.iter().any(|(time, _)| *time <= now)) && call_now()
}

/// Has the tasks whose time has come take turns, for about so long. Whether there were any.
pub fn give_turns(time: Duration) -> bool {
    let begin = Instant::now();
    let any = give_turn();
    while any && begin.elapsed() < time && give_turn() {}
    any
}

/// The next report of some work, if it comes soon. A page cannot wait for it: it gives the tasks their turns.
pub fn hear_within<T>(reports: &Receiver<T>, patience: Duration) -> Option<T> {
    let begin = Instant::now();
    loop {
        match reports.try_recv() {
            Err(TryRecvError::Empty) if begin.elapsed() < patience && give_turn() => {}
            report => return report.ok(),
        }
    }
}
