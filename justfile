# `just check` before every commit; `just --list` for the rest.

# What .ci/run runs, without installing anything.
check:
    cargo fmt --all --check
    cargo clippy --release --workspace --all-targets --locked -- -D warnings
    env RUSTDOCFLAGS="-D warnings" cargo doc --release --workspace --no-deps --locked
    just test-all

# All tests: product, laboratory, Python, page, fuzz targets. `cargo test --release` runs those of the product.
test-all:
    cargo test --release --workspace --locked

# The suite with all cases of its long tests: more controllers, machines, moments and programs.
sweep:
    FEEDWRIGHT_SWEEP=1 cargo test --release --workspace --locked -- --include-ignored

# What is too long for every change, once a week: the long tests, half an hour of LinuxCNC with random programs and faults, and the
# packages as they are released.
weekly: sweep
    env SOAK_MINUTES=30 linuxcnc/check
    web/check
    packaging/check dist

# Builds wheel, Debian packages and archive, installs each into an empty place and cuts the star with it.
packages profile="dist":
    packaging/check {{ profile }}

# Cut a part and write its report.
run part="parts/star.ngc" *options:
    cargo run --release -- run {{ part }} {{ options }}

# The experiments of the paper: figures, page and paper.json.
paper out="target/paper":
    cargo run --release -p feedwright-lab -- paper --out {{ out }}

# Times of ticks and of the reference.
bench:
    cargo bench --workspace

# Time-optimal planner against the bound, program by program: ratios, violations, blocks/s. Foreign programs where they are.
bench-plan *programs:
    cargo run --release -p feedwright-lab --example bench_plan -- {{ programs }}
    cargo run --release -p feedwright-lab --features copp --example fixed_path_peer

# Plans of any programs by finite differences of their positions, beside the bound: limits, deviation, time and speed.
# `just check-plan --bound --seed 1 --count 50`, `just check-plan --tolerance 1 part.ngc`.
check-plan *options:
    cargo run --release -p feedwright-lab --example check_plan -- {{ options }}

# A corner as the time-optimal planner has it: the figure of examples/04_planner.
corner-figure out="examples/04_planner/corner.svg":
    cargo run --release -p feedwright-lab --example corner_figure -- {{ out }}

# Least times in which the tool stays within 10 um, open loop on a linear servo and with the default controller on tnv40: some ten minutes.
least-time *contours:
    cargo run --release -p feedwright-lab --example least_time -- {{ contours }}

# Every controller on every contour, on machines without noise: the tables of examples/02_contours.
compare out="target/compare":
    cargo run --release -p feedwright-lab -- compare --only tnv40,heavy,sticky,rough,soft,coarse --knowledge own,unseen --at-tolerance --json {{ out }}.json

# Controllers that docs/results.md shows.
shown := "contour-compensation,cross-coupled,cross-coupled-feedrate,corner-contour,constrained-feedrate,fuzzy-h-infinity,disturbance-observer,kalman-disturbance,feedforward-as-delivered,feedforward,feedforward-cross-coupled,lqg-identified,lqg-preview"

# The table of docs/results.md: held-out work on machines with noise.
held-out-table out="target/held_out":
    cargo run --release -p feedwright-lab -- compare --work held-out --only workshop,stiff,router,{{ shown }} --knowledge own,identified,20%off,log --json {{ out }}.json

# What each imperfection costs each controller: the table of examples/03_realism. Each peer is tuned on each machine first.
imperfections out="target/imperfections":
    cargo run --release -p feedwright-lab -- compare --only tnv40,circle,eight,star,square,{{ shown }} --knowledge own,20%off \
        $(printf -- '--machine %s ' examples/03_realism/machines/*.toml) --json {{ out }}.json

# Search the values that `compare` runs with, for every controller on every built-in machine: an hour. Ends where it was interrupted.
# Behind it new seeds are due: `cargo run --release -p feedwright-lab --example draw_held_out`.
record-searches:
    cargo run --release -p feedwright-lab -- compare --record lab/src/compare/recorded.jsonl

# Every program that is here, on every machine, against open loop: `just never-worse --sample 200` for a part of it. What was
# interrupted goes on where it was. The corpus of foreign programs is not part of this repository.
never-worse *options:
    #!/usr/bin/env bash
    set -euo pipefail
    programs=(parts)
    for folder in ../shared/corpus/gcode ../shared/cases; do
        if [ -d "$folder" ]; then programs+=("$folder"); else echo "no foreign programs at $folder: they are not cut" >&2; fi
    done
    cargo build --release --quiet -p feedwright-lab
    target/release/feedwright-lab never-worse "${programs[@]}" {{ options }}

# Whether the present state gives the same to the bit as another build's binary, with its feedwright-lab beside it: after a change
# that is to change nothing.
same-outputs old:
    cargo build --release --quiet -p feedwright -p feedwright-lab
    scripts/same-outputs {{ old }} target/release/feedwright

# A stretch of a log as measured and as its law and a linear model predict it, over times of which nothing was fitted: the figure of README.md
# is that of the public bench EMPS, `just identification-figure DATA_EMPS.mat 0:12.42 12.42:25 13:18`.
identification-figure log fit score shown out="docs/identification.svg":
    cargo run --release -p feedwright-lab --example identification_figure -- {{ log }} {{ fit }} {{ score }} {{ shown }} {{ out }}

# Simulated machines cut the program of `excite` and are identified from the log: the table of docs/identification.md.
identification-sweep logs="5" machines="tnv40 heavy sticky soft coarse sliding workshop stiff router":
    cargo run --release -p feedwright-lab --example identification_sweep -- {{ logs }} {{ machines }}

# Models by logs of the built-in machines, or of those that are named, which the program is shipped with. After a change of a machine or
# of the identification: 20 minutes of processor time for all.
built-in-logs *machines:
    cargo run --release -p feedwright-lab --example built_in_logs -- {{ machines }}

# Random programs on random machines against open loop: `just held-out 20261 2000 --failures target/failures`. Seeds of a
# verdict are drawn after the settings are frozen.
held-out seed count *options:
    cargo run --release -p feedwright-lab -- held-out {{ seed }} {{ count }} {{ options }}

# By models of machines, on machines that differ from them: `just mismatch 7 --gross`. Seeds of a verdict are drawn after the settings are
# frozen.
mismatch seed *options:
    #!/usr/bin/env bash
    set -euo pipefail
    programs=(parts/star.ngc parts/circle.ngc parts/pocket.ngc parts/slot.ngc)
    if [ -d ../shared/cases/mismatch ]; then programs+=(../shared/cases/mismatch); else echo "no foreign programs: they are not cut" >&2; fi
    cargo build --release --quiet -p feedwright-lab
    target/release/feedwright-lab mismatch "${programs[@]}" --drawn 4 --seed {{ seed }} {{ options }}

# On machines of other equations, identified from their logs: `just independent --random 6 --seed 1`. Nothing is tuned on them.
independent *options:
    cargo run --release -p feedwright-lab -- independent {{ options }}

# The identifier beside FANN (Debian: libfann-dev, valgrind), on one core.
bench-fann:
    taskset --cpu-list 1 cargo bench --package feedwright-lab --bench fann

# The paper's inversion over several knots, on one core: a table of examples/02_contours.
paper-horizon:
    cargo build --release --quiet --package feedwright-lab --example paper_horizon
    taskset --cpu-list 1 target/release/examples/paper_horizon

# The limit, peers and our controllers over the level of each kind of noise: table, figures and noise.json of examples/05_noise, some ten
# to twenty minutes. `just noise-levels target/noise 2` tries it with two levels each.
noise-levels out="examples/05_noise" levels="5":
    cargo build --release --quiet -p feedwright-lab --bins --example draw
    lab/noise_levels.py {{ out }} {{ levels }}

# Percentiles of the time of a whole decision of the regulator, on one core; counts on an idle machine only.
tick ticks="100000" runs="5":
    cargo build --release --quiet -p feedwright-lab --example tick_percentiles
    taskset --cpu-list 1 target/release/examples/tick_percentiles {{ ticks }} {{ runs }}

# The manual as a site, with its links checked: needs PyPI once, for mdbook.
site folder="target/site":
    docs/build {{ folder }}

# Eight parts on three machines, before and after: a folder for any web server.
gallery folder="target/gallery":
    docs/gallery {{ folder }}

# The picture of README.md: the report of the star, in a browser (Debian: chromium, npm).
readme-picture:
    #!/usr/bin/env bash
    set -euo pipefail
    folder=$(mktemp --directory)
    trap 'rm -r "$folder"' EXIT
    cargo run --release --quiet -- run parts/star.ngc --report "$folder/star.report.html"
    web/page tools
    node web/app/readme-picture.mjs "$folder/star.report.html" docs

# What other controllers come to in the public round of the gym: a file of the package, docs/lab.md.
gym-peers python="target/python-tests/bin/python":
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --locked --profile dist -p feedwright-python --features peers --target-dir target/gym-peers
    mkdir -p target/gym-peers/module
    cp -r python/feedwright target/gym-peers/module/
    cp target/gym-peers/dist/libfeedwright_python.so target/gym-peers/module/feedwright/_feedwright.abi3.so
    PYTHONPATH=target/gym-peers/module {{ python }} python/gym_peers.py > target/gym-peers/_peers.json
    mv target/gym-peers/_peers.json python/feedwright/_peers.json

# Regenerate the tables and the figures of docs/results.md and of examples/.
tables: paper compare held-out-table imperfections
    cp target/paper/figure_*.svg target/paper/paper.json examples/01_paper_circle/
    cp target/compare.json examples/02_contours/
    cp target/held_out.json target/imperfections.json examples/03_realism/
    lab/tables.py

# Write the messages of docs/gcode-mistakes.md anew.
mistakes:
    FEEDWRIGHT_UPDATE_DOCUMENTS=1 cargo test --release -p feedwright --test suite golden_gcode_mistakes

# Write the help of all commands in docs/command-line.md anew.
help:
    FEEDWRIGHT_UPDATE_DOCUMENTS=1 cargo test --release -p feedwright --test suite golden_help

# The reader beside LinuxCNC on random programs (Debian: linuxcnc-uspace): about a quarter of an hour for 20,000. The kind "nested" is
# of control flow.
gcode-compare programs="20000" first="1" kind="":
    cargo run --release --quiet -p feedwright-plan --example gcode_compare -- {{ programs }} {{ first }} {{ kind }}

# Every fuzz target for so many minutes, one after the other (`cargo install cargo-fuzz`). What is found is in fuzz/artifacts; as a test it
# goes to fuzz/seeds. The stable compiler is told to take the flags of the unstable one. fuzz/corpus keeps what was reached: the next run
# goes on from there.
fuzz minutes="5" targets="reader expressions files block logs corrected planner tick":
    #!/usr/bin/env bash
    set -euo pipefail
    export RUSTC_BOOTSTRAP=1
    for target in {{ targets }}; do
        mkdir -p fuzz/corpus/$target
        cargo fuzz run --sanitizer none $target fuzz/corpus/$target fuzz/seeds/$target -- \
            -max_total_time=$(({{ minutes }} * 60)) -max_len=2000 -timeout=60 -rss_limit_mb=3000
    done

# Changes the code of a file in many small ways and runs the tests of its crate for each (`cargo install cargo-mutants`): what no test
# notices is listed in target/mutants.out. `just mutants feedwright-control "crates/control/src/supervisor/*.rs"`; ten seconds each. With
# `--iterate` behind it, goes on where it was interrupted. Survivors that are known are in .cargo/mutants.toml. Built increments that an
# interrupt leaves behind do not link: without increments.
mutants package files *options:
    env CARGO_INCREMENTAL=0 CARGO_PROFILE_TEST_OPT_LEVEL=1 CARGO_PROFILE_TEST_DEBUG=false CARGO_PROFILE_DEV_OPT_LEVEL=1 CARGO_PROFILE_DEV_DEBUG=false \
        cargo mutants --package {{ package }} --file "{{ files }}" --output target --baseline skip --timeout 60 {{ options }} \
        -- --lib --test suite -- --skip conformance_panics

# Every change of one byte, and every end, of valid model blocks, on two cores: hours. The suite runs a part.
damaged-models:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo test --release --quiet --locked -p feedwright-fuzz-targets --no-run
    for first in 0 650000; do
        FEEDWRIGHT_FUZZ="damaged $first 650000" cargo test --release --quiet --locked -p feedwright-fuzz-targets changed_byte &
    done
    wait -n && wait -n

# What has unsafe code, in Miri (`rustup toolchain install nightly --component miri,rust-src`): the C interface of the HAL
# component, but for one test that takes long there. Miri knows no assembler, which `libm` has unless it is told.
miri:
    cd linuxcnc && cargo +nightly miri test --locked -p feedwright-servo --features libm/force-soft-floats --test conformance_memory -- --skip two_and_three_joints

# Instructions of one piece of work in the servo thread, counted by callgrind (Debian: valgrind).
instructions:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release --quiet -p feedwright-lab --example instructions
    counted() {
        valgrind --tool=callgrind --callgrind-out-file=/dev/null target/release/examples/instructions "$1" "$2" 2>&1 |
            sed -n 's/.*Collected : //p'
    }
    for work in paper-tick servo-period regulator-period screw-period learn; do
        few=$(counted "$work" 1000)
        many=$(counted "$work" 3000)
        printf '%-14s %8d instructions\n' "$work" $(((many - few) / 2000))
    done

# How much faster than the machine `run` is, from file to report, on one core, with a trained identifier.
speed part="parts/pocket.ngc":
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release --quiet
    folder=$(mktemp --directory)
    trap 'rm -r "$folder"' EXIT
    command=(taskset --cpu-list 0 target/release/feedwright --quiet run "{{ part }}" --json "$folder/run.json" --report "$folder/run.html")
    "${command[@]}" >"$folder/table.txt" # Trains, where that has not been done.
    start=$(date +%s.%N)
    "${command[@]}"
    end=$(date +%s.%N)
    python3 - "$folder/run.json" "$start" "$end" <<'PYTHON'
    import json, sys
    machining_s = json.load(open(sys.argv[1]))["runs"][-1]["time_s"]
    wall_s = float(sys.argv[3]) - float(sys.argv[2])
    print(f"machining {machining_s:.2f} s, run {wall_s:.3f} s: {machining_s / wall_s:.0f} times faster, and it cuts twice")
    PYTHON

# What each term of the plant does to a circle: the figure of docs/machine-file.md.
plant-terms out="docs/plant_terms.svg":
    cargo run --release --quiet -p feedwright-lab --example plant_terms -- {{ out }}

# Reading a print program of so many lines, 30 bytes each (GNU time): time, processor time and resident memory, three times.
reading lines="2200000":
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release --quiet
    folder=$(mktemp --directory)
    trap 'rm -r "$folder"' EXIT
    awk -v lines="{{ lines }}" 'BEGIN {
        srand(1); x = y = 100; z = 0.2; print "G21\nG90\nM82\nG28\nG92 E0"
        for (i = 0; i < lines; i++) {
            if (i % 5000 == 0) printf "G1 Z%.2f F600\n", z += 0.2
            printf "G1 X%.2f Y%.2f E%.3f\n", x += rand() - 0.5, y += rand() - 0.5, e += 0.02
        }
    }' >"$folder/print.gcode"
    stat --format '%s bytes' "$folder/print.gcode"
    for command in check canon check canon check canon; do
        command time --format "$command: %e s, %U s of processor, %M KiB" target/release/feedwright --quiet "$command" "$folder/print.gcode" >/dev/null
    done

# Build the HAL components and install them for LinuxCNC (Debian: linuxcnc-uspace, linuxcnc-uspace-dev), and make the models of
# linuxcnc/configs/workshop-sim.
linuxcnc:
    linuxcnc/build

# Formatting, lints and tests of linuxcnc/, and cuts and faults in a real LinuxCNC without a screen: what .ci/run runs of it.
linuxcnc-check:
    linuxcnc/check

# Random programs, settings and faults in a real LinuxCNC for so many minutes; SEED draws others, RESUME is a file that keeps what was done.
linuxcnc-soak minutes="15" seed="1" resume="": linuxcnc
    cd linuxcnc && FEEDWRIGHT=$(./command) python3 tests/soak.py {{ minutes }} --seed {{ seed }} {{ if resume == "" { "" } else { "--resume " + resume } }}

# The library as a WebAssembly module, run under node beside the command, and the page in a browser.
web-check:
    web/check

# Every program and fault in a real LinuxCNC, on machines that differ: the figures of docs/linuxcnc.md. An hour and a half, most of it waiting.
linuxcnc-sweep: linuxcnc
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release --quiet
    cargo build --quiet -p feedwright-lab --example linuxcnc_planner
    export FEEDWRIGHT=$PWD/target/release/feedwright
    cd linuxcnc
    python3 tests/sweep.py
    python3 tests/paper.py --figure ../docs/linuxcnc_paper.svg
    python3 tests/identified.py
    python3 tests/setup.py
    python3 tests/corrected.py
    python3 tests/learned.py
    python3 tests/planner.py
    python3 tests/following.py --machine configs/workshop-sim/tnv40.fwmodel
    python3 tests/faults.py --machine configs/workshop-sim/machine.fwmodel:configs/workshop-sim/model.fwmodel
