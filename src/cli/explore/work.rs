//! Computations that newer ones take the place of, and crashes that become messages.

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

use granulens::Context;

/// What is being computed, for whom.
#[derive(Default)]
pub struct Work {
    under_way: Mutex<HashMap<(String, &'static str), Context>>,
}

/// A computation under way: what it runs under.
pub struct Job<'a> {
    work: &'a Work,
    key: (String, &'static str),
    context: Context,
}

impl Work {
    /// Begins a computation of a kind for a tab of the browser; the tab's earlier one of that kind is asked to stop.
    pub fn begin(&self, tab: &str, kind: &'static str) -> Job<'_> {
        let key = (tab.to_owned(), kind);
        let context = Context::default();
        if let Some(earlier) = self.all().insert(key.clone(), context.clone()) {
            earlier.stop();
        }
        Job { work: self, key, context }
    }

    /// Asks a tab's computation of a kind to stop.
    pub fn cancel(&self, tab: &str, kind: &'static str) {
        if let Some(context) = self.all().get(&(tab.to_owned(), kind)) {
            context.stop();
        }
    }

    /// Asks all of them to stop.
    pub fn stop_all(&self) {
        self.all().values().for_each(Context::stop);
    }

    fn all(&self) -> std::sync::MutexGuard<'_, HashMap<(String, &'static str), Context>> {
        self.under_way.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Job<'_> {
    /// What it runs under.
    pub fn context(&self) -> &Context {
        &self.context
    }
}

impl Drop for Job<'_> {
    fn drop(&mut self) {
        let mut all = self.work.all();
        if all.get(&self.key).is_some_and(|context| context.same(&self.context)) {
            all.remove(&self.key);
        }
    }
}

/// What a computation gives, or in words why it crashed.
pub fn caught<T>(compute: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(compute)).map_err(|thrown| {
        let words = thrown.downcast_ref::<String>().cloned();
        words.or_else(|| thrown.downcast_ref::<&str>().map(|&words| words.to_owned())).unwrap_or_default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newer_computation_stops_the_tab_s_earlier_one_and_no_other() {
        let work = Work::default();
        let first = work.begin("a", "scene");
        let [other_kind, other_tab] = [work.begin("a", "play"), work.begin("b", "scene")];
        let second = work.begin("a", "scene");
        let stopped = |job: &Job| job.context().stopped();
        assert!(stopped(&first) && ![&other_kind, &other_tab, &second].into_iter().any(stopped));
        // The end of the first does not make the second unknown.
        drop(first);
        work.cancel("a", "scene");
        assert!(stopped(&second) && !stopped(&other_tab));
        drop(second);
        work.stop_all();
        assert!(stopped(&other_kind) && stopped(&other_tab));
        drop((other_kind, other_tab));
        assert!(work.all().is_empty());
    }

    #[test]
    fn a_crash_is_a_message() {
        assert_eq!(caught(|| 1), Ok(1));
        let [none, text] = [2, 3].map(|k| caught(|| if k == 3 { panic!("sphere {k}") } else { panic!("no sphere") }));
        assert_eq!((none, text), (Err("no sphere".to_owned()), Err("sphere 3".to_owned())));
    }
}
