#!/usr/bin/env bash
# Simplifies with everybody and measures what comes of it: docs/simplification.md and docs/simplification.csv.
#
#     run.sh [--rounds N] [--samples N] [--variants] [--quick] [MESH]…
#
# MESH is a file of any format that `lod` reads, plain or .gz, besides the three meshes that are made. Times are the
# least of N rounds, 3 if not said, distances from so many samples, 500 000 if not said. The page is written anew after
# every mesh. --variants tries other settings of the contestants too. --quick is a glance at whether it runs, and writes
# nothing.
set -euo pipefail
home="$(cd "$(dirname "$0")" && pwd)"

python3 -m venv "$home/.venv"
"$home/.venv/bin/python" -m pip install --quiet --requirement "$home/requirements.txt"

features=meshopt
if ! command -v c++ > /dev/null; then
    echo "run.sh: a C++ compiler is missing: no rows of meshoptimizer" >&2
    features=
fi
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$home/../target}"
cargo build --release --locked --manifest-path "$home/../Cargo.toml" --bin simplify --no-default-features \
    --features "$features"

# One thread on one core.
export OMP_NUM_THREADS=1 VTK_SMP_BACKEND_IN_USE=Sequential
pin=()
if command -v taskset > /dev/null; then
    pin=(taskset --cpu-list "$(($(nproc) - 1))")
fi
"${pin[@]}" "$home/.venv/bin/python" "$home/simplify.py" "$CARGO_TARGET_DIR/release/simplify" "$@"
