# Recipes; `just` lists them.

_list:
    @just --list

# Everything that has to pass before a change goes in.
check:
    .ci/run

# Cut a part and write its report: `just run parts/star.ngc --controller two-dimensional`.
run *ARGS:
    cargo run --release --bin feedwright -- run {{ARGS}}

# The experiments of the paper, into a directory.
paper DIR="paper":
    cargo run --release --bin feedwright -- paper --out {{DIR}}

# Measure; nothing here is asserted.
bench *ARGS:
    cargo bench --workspace {{ARGS}}

# Write parts/*.ngc anew.
parts:
    cargo run -p feedwright --example make_parts -- parts

# Format all code.
fmt:
    cargo fmt --all
