//! Changed settings of the daemon itself, taken up while it runs: no job is given up, no order forgotten.

use super::*;

/// Why a job was given up, as the user reads it.
const LEFT_ALONE: &str = "the settings leave it alone from now on";

impl Heart {
    /// Takes up what `reread` finds; what cannot be taken up is said, and what held before holds on.
    pub(super) fn renew(&mut self, reread: &mut Reread<'_>, show: &mut dyn FnMut(Notice)) {
        let Some(path) = self.roots.first().map(|r| r.path.clone()) else { return };
        let found = match reread() {
            Ok(None) => return,
            Ok(Some(settings)) => self.take_up(settings, show),
            Err(error) => Err(error),
        };
        match found {
            Ok(()) => {
                show(Notice::Renewed(settings_files(&path.join("any"))[1].clone()));
                for root in &self.roots {
                    show(Notice::Watching { root: root.path.clone(), how: root.how.clone() });
                }
                self.is_overview_stale = true;
            }
            Err(error) => {
                if let Some(mut problem) = error.problem().cloned() {
                    problem.text.push_str("; the daemon goes on as it was told before");
                    show(Notice::Problem { path, problem });
                }
            }
        }
    }

    /// All files are looked at anew by the new settings; the journal knows what is done.
    fn take_up(&mut self, settings: WatchSettings, show: &mut dyn FnMut(Notice)) -> Result<(), Error> {
        let paths: Vec<PathBuf> = self.roots.iter().map(|r| r.path.clone()).collect();
        let is_network: Vec<bool> = self.roots.iter().map(|r| r.unheard.is_some()).collect();
        let own: Vec<&Path> = paths.iter().map(PathBuf::as_path).collect();
        paths.iter().try_for_each(|root| refuse_nested(root, settings.depth, &own, &self.records))?;
        let settle = Settle::new(&paths, &is_network, &settings)?;
        let report = reporter(self.send.clone(), self.is_flooded.clone());
        let eyes = Eyes::new(&paths, &is_network, &settings, report)?;
        self.looker += 1;
        self.to_looker = start_looker(eyes, &settings, self.looker, self.send.clone());
        self.settle = settle;
        for root in &mut self.roots {
            root.how = how_watched(&settings, root.unheard.as_deref());
            root.is_offline = false;
            root.ignored.clear();
            root.ignored_count = 0;
            if let Some(state) = &mut root.state {
                state.reach(settings.depth);
                // Should it fail, the next sign of life says so.
                let _ = state.beat();
            }
        }
        self.settings = settings;
        self.keys.clear();
        self.leave_alone(show);
        Ok(())
    }

    /// Drawings that the new settings leave alone are no longer waited for, nor worked on.
    fn leave_alone(&mut self, show: &mut dyn FnMut(Notice)) {
        let known: Vec<PathBuf> = self.contents.keys().chain(self.failed.keys()).cloned().collect();
        for drawing in known {
            if !self.settle.leaves_alone(&drawing) {
                continue;
            }
            self.drop_waiting(&drawing, LEFT_ALONE, show);
            self.forget(&drawing);
            if let Some(running) = self.running_of(&drawing) {
                running.stop(LEFT_ALONE);
            }
        }
    }
}
