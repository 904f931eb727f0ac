//! The help: commands in groups, and the options that most users need.

use std::fmt::Write;

use clap::{Arg, Command};

/// Options that the help of a command shows. A command with more hides those with
/// `hide_short_help`; `--help-all` shows all.
const MOST_OPTIONS: usize = 15;

/// The commands by what they are for. A command that is in no group is listed in the last.
const GROUPS: [(&str, &[&str]); 5] = [
    (
        "Program",
        &[
            "run", "correct", "advise", "plan", "open", "diff", "check", "canon",
        ],
    ),
    ("Many programs", &["sweep", "merge"]),
    (
        "Machine",
        &["identify", "excite", "machines", "controllers"],
    ),
    ("LinuxCNC", &["linuxcnc", "block"]),
    ("feedwright itself", &[]),
];

/// The command with its commands listed in [`GROUPS`]; another command than `feedwright` as it is.
pub(super) fn grouped(command: Command) -> Command {
    if command.get_name() != "feedwright" {
        return command;
    }
    let in_no_group = |name: &str| GROUPS.iter().all(|(_, names)| !names.contains(&name));
    let others: Vec<&str> = command
        .get_subcommands()
        .map(Command::get_name)
        .filter(|name| in_no_group(name))
        .collect();
    let about = |name: &str| {
        command
            .find_subcommand(name)
            .and_then(Command::get_about)
            .map(ToString::to_string)
    };
    let mut list = String::new();
    for (heading, names) in GROUPS {
        let names = if names.is_empty() { &others } else { names };
        let _ = writeln!(list, "{heading}:");
        for name in names {
            let _ = writeln!(list, "  {name:<12} {}", about(name).unwrap_or_default());
        }
        list.push('\n');
    }
    let _ = writeln!(
        list,
        "  {:<12} Print this message or the help of a command",
        "help"
    );
    let list = list.replacen("\n\n  help", "\n  help", 1);
    command.help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}\nOptions:\n{{options}}{{after-help}}",
        list.replace('{', "{{")
    ))
}

/// The command with all options in its help, or with those that most users need.
pub(super) fn shown_options(command: Command, all: bool) -> Command {
    if all {
        return with_all_options(command);
    }
    let hidden = |arg: Arg| {
        if arg.is_hide_short_help_set() {
            arg.hide(true)
        } else {
            arg
        }
    };
    let of_all = command.get_opts().count() + 1;
    // The options of every command reach the others from here.
    command.mut_args(hidden).mut_subcommands(|command| {
        let hides = of_all + command.get_opts().count() > MOST_OPTIONS;
        command.mut_args(|arg| {
            if hides {
                hidden(arg)
            } else {
                arg.hide_short_help(false)
            }
        })
    })
}

/// The command with all options in its help.
pub(crate) fn with_all_options(command: Command) -> Command {
    command
        .mut_args(|arg| arg.hide_short_help(false))
        .mut_subcommands(with_all_options)
}
