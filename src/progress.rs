//! Progress for people (a bar on a terminal) and for programs (a JSON object a line).

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::ProgressArg;
use enfilade_pipeline::Progress;
use enfilade_report::complain;

/// Says how far a job is, on standard error.
pub struct Display {
    kind: ProgressArg,
    bar: Option<ProgressBar>,
}

impl Display {
    /// `asked` as on the command line; without it a bar where standard error is a terminal.
    pub fn new(asked: Option<ProgressArg>, quiet: bool) -> Self {
        let default =
            if std::io::stderr().is_terminal() && !quiet { ProgressArg::Bar } else { ProgressArg::None };
        Self { kind: asked.unwrap_or(default), bar: None }
    }

    /// Shows where the job is.
    pub fn show(&mut self, p: &Progress) {
        match self.kind {
            ProgressArg::None => {}
            ProgressArg::Json => {
                if let Ok(line) = serde_json::to_string(p) {
                    complain(line);
                }
            }
            ProgressArg::Bar => self.show_bar(p),
        }
    }

    fn show_bar(&mut self, p: &Progress) {
        let bar = self.bar.get_or_insert_with(|| {
            let bar = ProgressBar::new(0);
            let style = ProgressStyle::with_template("{msg:24} [{bar:30}] {pos}/{len} {prefix}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
            bar
        });
        bar.set_length(p.total.unwrap_or(0));
        bar.set_position(p.done);
        bar.set_message(p.stage.clone());
        let best = p.best.map_or(String::new(), |b| format!("best {b:.3} "));
        let eta = p.eta_secs.map_or(String::new(), |s| format!("{s:.0} s left"));
        bar.set_prefix(format!("{best}{eta}"));
    }

    /// Takes the bar away.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
