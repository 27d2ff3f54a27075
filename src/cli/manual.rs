//! The manual page, and what help says besides of exit codes.

use std::io::Write as _;

use clap::CommandFactory;

use super::{Cli, idle};

/// The manual page: the program, and a section for each of its commands.
///
/// # Errors
/// Only where memory does not take them.
pub fn man() -> std::io::Result<String> {
    let mut command = idle::hidden(Cli::command());
    command.build();
    let page = clap_mangen::Man::new(command.clone());
    let mut out = Vec::new();
    page.render_title(&mut out)?;
    page.render_name_section(&mut out)?;
    page.render_synopsis_section(&mut out)?;
    page.render_description_section(&mut out)?;
    page.render_options_section(&mut out)?;
    sections_of_commands(&command, &mut out)?;
    list_section("\"EXIT STATUS\"", &EXIT_STATUS, &mut out)?;
    list_section("FILES", &FILES, &mut out)?;
    page.render_version_section(&mut out)?;
    Ok(String::from_utf8_lossy(&out).into_owned())
}

/// What the manual says besides of exit codes.
const EXIT_STATUS: [(&str, &str); 8] = [
    ("0", "Done."),
    ("1", r"Done, with something left out: it says what. Of \fBdoctor\fR: something is wrong."),
    ("2", "Bad input."),
    ("3", "Bad usage or settings."),
    ("4", "The environment failed: disk, permission, device."),
    ("5", "A limit of time or memory ended it; results are not complete."),
    ("75", r"Try again later (\fBrun\-job\fR); some are not done (\fBmerge\fR, \fBjoin\fR)."),
    ("130", r"Stopped by the user; \fBrun\fR leaves its best so far."),
];
/// The same in the words of the help.
pub(super) fn exit_codes() -> String {
    let plain = |text: &str| text.replace(r"\fB", "").replace(r"\fR", "").replace(r"\-", "-");
    let row = |(code, text): &(&str, &str)| format!("  {code:<4} {}", plain(text));
    format!("Exit codes:\n{}", EXIT_STATUS.iter().map(row).collect::<Vec<_>>().join("\n"))
}

/// What it says of files.
const FILES: [(&str, &str); 4] = [
    (
        "enfilade.toml",
        r"Settings of the drawings in its folder and of its daemon; \fBinit\fR writes one, all of it comments.",
    ),
    ("NAME.enfilade.toml", "Settings of the drawing NAME beside it; they go before those of the folder."),
    (
        "NAME.enfilade/",
        r"Results of the drawing NAME: analysis/, round\-01/ and so on, so\-far/ of a search that goes on or was stopped.",
    ),
    (r"\&.enfilade/", "State of a watched folder."),
];

fn list_section(title: &str, rows: &[(&str, &str)], out: &mut Vec<u8>) -> std::io::Result<()> {
    writeln!(out, ".SH {title}")?;
    rows.iter().try_for_each(|(name, text)| writeln!(out, ".TP\n{name}\n{text}"))
}

/// Of each command that is shown what a page of its own would say; there is none, so nothing refers to one.
fn sections_of_commands(of: &clap::Command, out: &mut Vec<u8>) -> std::io::Result<()> {
    for command in of.get_subcommands().filter(|c| !c.is_hide_set() && c.get_name() != "help") {
        let (name, page) =
            (command.get_bin_name().unwrap_or_default(), clap_mangen::Man::new(command.clone()));
        let mut text = Vec::new();
        page.render_synopsis_section(&mut text)?;
        page.render_description_section(&mut text)?;
        page.render_options_section(&mut text)?;
        let text = String::from_utf8_lossy(&text).replace("\n.SH ", "\n.SS ");
        writeln!(out, ".SH \"{}\"\n{text}", name.to_uppercase())?;
        sections_of_commands(command, out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::grammar;
    use enfilade_report::{Error, LIMITS, Place};

    /// One page that refers to no other, with every command that is shown and none that is not.
    #[test]
    fn the_manual_is_one_page() {
        let page = man().unwrap();
        assert_eq!(page.lines().filter(|l| l.starts_with(".TH")).count(), 1);
        assert!(!page.contains("(1)") && !page.contains("job-child") && !page.contains("JOB-CHILD"));
        let sections: Vec<&str> = page.lines().filter_map(|l| l.strip_prefix(".SH ")).collect();
        let commands = Cli::command();
        for command in commands.get_subcommands().filter(|c| !c.is_hide_set()) {
            let name = format!("\"ENFILADE {}\"", command.get_name().to_uppercase());
            assert!(sections.contains(&name.as_str()), "{name}: {sections:?}");
        }
        assert!(sections.contains(&"\"ENFILADE SERVICE INSTALL\""), "{sections:?}");
        assert!(page.contains(".SS OPTIONS") && page.contains(r"\-\-fallback"), "options of the commands");
    }

    #[test]
    fn the_manual_has_exit_codes_and_files() {
        let page = man().unwrap();
        let section = |name: &str| {
            let rest = page.split_once(&format!(".SH {name}\n")).map(|(_, rest)| rest).unwrap();
            rest.split("\n.SH ").next().unwrap().to_owned()
        };
        let errors = [Error::input, Error::usage, Error::environment].map(|e| e("c", Place::default(), ""));
        let limit = LIMITS.map(|code| Error::input(code, Place::default(), ""));
        let own = errors.iter().chain(&limit).chain(&[Error::Stopped]).map(|e| e.exit_code().to_string());
        for code in own.chain(["0", "1", "75"].map(String::from)) {
            assert!(section("\"EXIT STATUS\"").contains(&format!(".TP\n{code}\n")), "{code}");
            let help = grammar().render_help().to_string();
            assert!(help.lines().any(|l| l.trim_start().starts_with(&format!("{code} "))), "{code}: {help}");
        }
        for file in ["enfilade.toml", "NAME.enfilade.toml", "NAME.enfilade/"] {
            assert!(section("FILES").contains(&format!(".TP\n{file}\n")), "{file}");
        }
    }
}
