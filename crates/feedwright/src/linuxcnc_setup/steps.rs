//! What to do after setup, with the exact commands, and the script that records.

use std::fmt::Write as _;

use super::joints::SetupJoints;
use super::names::SetupNames;

/// The pins that the sampler records of each axis: LinuxCNC's command, the drive's command, the
/// measured position.
pub(crate) const SAMPLED: [&str; 3] = [
    "joint.N.motor-pos-cmd",
    "feedwright.drive-N",
    "feedwright.actual-N",
];

/// The steps in their order. A line that begins with blanks is a command.
pub(crate) fn steps(names: &SetupNames, axes: usize, simulates: bool) -> Vec<String> {
    let SetupNames {
        ini,
        machine,
        record,
        model,
        original,
        ..
    } = names;
    let hardware = "Setup was tested in LinuxCNC on a simulated machine, not on your hardware: keep the emergency stop in reach";
    let mut lines = vec![
        "1. Start LinuxCNC with the copy. The component reports that its model is missing, and passes every command on unchanged. Home, jog and run a \
         program in the air: the machine has to behave as before. Then record it (2)"
            .to_owned(),
        format!("        linuxcnc {ini}"),
        "2. Make the program that shows how the axes behave, and read its first lines. Then run it (3)".to_owned(),
        format!("        feedwright excite --machine {machine} --out excite.ngc"),
        "3. Move the axes to the middle of their travel. In a second terminal, switch the delay off and start the record. Run excite.ngc in \
         LinuxCNC, with the feed override at 100 %. Press Enter in the terminal when it has ended. Then identify the machine (4)"
            .to_owned(),
        "        halcmd setp feedwright.direct 1".to_owned(),
        format!("        sh {record} excite excite.txt"),
        "        halcmd setp feedwright.direct 0".to_owned(),
        "4. Identify the axes. The page ident.html shows how well the model fits. Then make the model file (5)".to_owned(),
        "        feedwright identify excite.txt --record-delay 0 --out mine.toml --report ident.html".to_owned(),
        "5. Make the model file that the component reads. Then try the model in simulation (6)".to_owned(),
        format!("        feedwright block mine.toml --axes {axes} --out {model}"),
        "6. Cut your part in simulation with the model. The table shows the error without and with the correction. Then enable it (7)".to_owned(),
        "        feedwright run part.ngc --machine mine.toml --controller lqg-identified".to_owned(),
        "7. End LinuxCNC and start it again: it reads the model. If it names a MIN_FERROR that is too small, set that one. Cut in the air, and \
         enable the correction during the cut. It moves the drives by 0.05 mm at most. If the cut stays calm, raise this limit to what step 6 \
         says ('command beside the program by up to'), as far as the clearances allow. Then measure (8)"
            .to_owned(),
        format!("        linuxcnc {ini}"),
        "        halcmd setp feedwright.enable 1".to_owned(),
        "        halcmd setp feedwright.deviation-limit 0.5".to_owned(),
        "8. Record a cut and compare it with the program. The table shows the measured error. 'halcmd getp feedwright.cause' says why a correction \
         is missing. ENABLE and DEVIATION_LIMIT in the copy keep both settings"
            .to_owned(),
        format!("        sh {record} cut cut.txt"),
        "        feedwright run part.ngc --machine mine.toml --log cut.txt".to_owned(),
        format!("To go back, start LinuxCNC with {original}, which is unchanged. This removes the copies:"),
        format!("        feedwright linuxcnc setup {original} --undo"),
    ];
    if !simulates {
        lines.insert(0, hardware.to_owned());
    }
    lines
}

/// A shell script that records until Enter is pressed. Its first lines in the log name the columns,
/// the period and the unit.
pub(crate) fn record_script(joints: &SetupJoints, names: &SetupNames) -> String {
    // In a test of the axes the drive's command is what moves it; in a cut LinuxCNC's command is
    // what is to be cut.
    let columns = |command: &str, other: &str| {
        let of = |joint: &super::joints::SetupJoint| {
            let letter = joint.letter.to_ascii_lowercase();
            let [first, second] = if command == "drive" {
                [other, "cmd"]
            } else {
                ["cmd", other]
            };
            format!("{letter}.{first} {letter}.{second} {letter}.act")
        };
        joints.wired().map(of).collect::<Vec<_>>().join(" ")
    };
    let mut text = String::new();
    let _ = write!(
        text,
        "#!/bin/sh\n\
         # Records a log for feedwright, from LinuxCNC while it runs: until Enter is pressed.\n\
         #\n\
         #   sh {record} excite FILE    for feedwright identify: command of the drives and measured position\n\
         #   sh {record} cut FILE       for feedwright run --log: command of LinuxCNC and measured position\n\
         set -eu\n\
         case \"${{1:-}}\" in\n\
         excite) columns='n {excite}' ;;\n\
         cut) columns='n {cut}' ;;\n\
         *) echo \"usage: sh {record} excite|cut FILE\" >&2; exit 2 ;;\n\
         esac\n\
         file=${{2:?name the log as the second word}}\n\
         {{ echo '# sample_time_s = {period}'; echo '# unit = {unit}'; echo \"# $columns\"; }} > \"$file\"\n\
         halsampler -t >> \"$file\" &\n\
         sampler=$!\n\
         trap 'halcmd setp sampler.0.enable 0; kill $sampler 2>/dev/null || true' EXIT\n\
         trap 'exit 130' INT TERM\n\
         halcmd setp sampler.0.enable 1\n\
         echo \"Recording to $file. Run the program, then press Enter.\"\n\
         read -r end || true\n\
         halcmd setp sampler.0.enable 0\n\
         tries=0\n\
         while [ \"$(halcmd getp sampler.0.curr-depth)\" -gt 0 ] && [ $tries -lt 100 ]; do tries=$((tries + 1)); sleep 0.3; done\n\
         sleep 1\n\
         echo \"Recorded $(grep -vc '^#' \"$file\") samples; $(halcmd getp sampler.0.overruns) were lost.\"\n",
        record = names.record,
        excite = columns("drive", "planned"),
        cut = columns("planner", "driven"),
        period = joints.servo_s,
        unit = joints.unit_name(),
    );
    text
}
