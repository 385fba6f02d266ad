#!/usr/bin/env bash
# Fetches what the peers need, each where its tool is there, and measures: docs/peers.md and docs/peers.csv.
# Arguments go to the program: --quick is a glance at whether it runs and writes nothing.
set -euo pipefail
cd "$(dirname "$0")"

if command -v npm > /dev/null; then
    npm ci --silent --no-audit --no-fund
else
    echo "run.sh: npm is missing: no rows of three.ez and three.js" >&2
fi

if command -v python3 > /dev/null; then
    { python3 -m venv .venv && .venv/bin/python -m pip install --quiet --requirement requirements.txt; } ||
        echo "run.sh: highspy cannot be installed: no rows of HiGHS" >&2
else
    echo "run.sh: python3 is missing: no rows of HiGHS" >&2
fi

cargo run --release --locked -- "$@"
