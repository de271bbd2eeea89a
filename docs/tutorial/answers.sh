#!/usr/bin/env bash
# Answers of the tutorial's long commands, which a test compares with what the page shows:
#   bash docs/tutorial/answers.sh target/release/granulens > docs/tutorial/answers.txt
set -euo pipefail
granulens=$(realpath "$1")
files=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$files"/*.toml "$files"/pad.csv "$work"
cd "$work"
for command in "study run pad-study.toml" "tolerance pad.csv --design pad.toml --out pad-made" "check pad.csv --design pad.toml --gate"; do
  echo "\$ granulens $command"
  # shellcheck disable=SC2086
  $granulens $command --quiet 2>/dev/null
done
cmp reports/pad-study/best.csv pad.csv >&2
