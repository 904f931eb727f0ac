use feedwright::identify::Excitation;
use feedwright::identify::axis_statistics::axis_statistics;
use feedwright::machine::Machine;
use feedwright_control::axis::statistics::AxisStatistics;

#[test]
#[ignore]
fn table() {
    let names = std::env::var("NAMES").unwrap_or("tnv40,workshop,stiff,router".into());
    let seed: u64 = std::env::var("SEED").map_or(1, |s| s.parse().unwrap());
    for name in names.split(',') {
        let mut machine = Machine::load(name.as_ref()).unwrap();
        machine.noise.seed = seed;
        let t = std::time::Instant::now();
        let recording = Excitation::statistics(&machine).record_in_one::<2>(&machine, seed);
        let rec = t.elapsed();
        let t = std::time::Instant::now();
        let found = axis_statistics(&recording, &machine.known());
        println!("== {name}: {} samples, recorded {rec:?}, estimated {:?}", recording.stretches[0].len(), t.elapsed());
        let truth = machine.statistics::<2>();
        for i in 0..2 {
            let um = 1e3 / machine.axis(i).rad_per_mm();
            for (what, s) in [("true", truth[i]), ("est ", found[i])] {
                let AxisStatistics { encoder_noise_rad, encoder_step_rad, interpolation_rad, interpolation_phase_rad, signal_per_rad, torque_noise_nm, torque_noise_s, disturbance_nm, disturbance_rad_s, disturbance_wander, cogging_nm, cogging_phase_rad, cogging_per_rev } = s;
                println!("{i} {what} noise {:.4} step {:.4} um | interp {:.4} um per {:.4} um phase {:.2} | torque {:.4} Nm {:.2} ms | line {:.4} Nm {:.2} Hz wander {:.4} | cogging {:.4} Nm {} /rev phase {:.2}",
                    encoder_noise_rad*um, encoder_step_rad*um, interpolation_rad*um, if signal_per_rad>0.0 {std::f64::consts::TAU/signal_per_rad*um} else {0.0}, interpolation_phase_rad, torque_noise_nm, torque_noise_s*1e3, disturbance_nm, disturbance_rad_s/std::f64::consts::TAU, disturbance_wander, cogging_nm, cogging_per_rev, cogging_phase_rad);
            }
        }
    }
}
