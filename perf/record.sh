#!/usr/bin/env bash
# Profiles octray with Linux perf, prints the hottest functions and draws a flame graph.
#
#   perf/record.sh [--graph FILE.svg] [COMMAND...]
#
# COMMAND is any command line of octray [default: render builtin:knot:100000 --samples 256 --threads 1 -o
# target/profiling/knot.exr]. The graph is target/profiling/flame.svg by default; a browser opens it. perf/README.md explains how to read
# both. Exits with 1 if there is no graph, with 2 if perf is missing or refused.
set -euo pipefail
# shellcheck source=perf/common.sh
source "$(dirname "$0")/common.sh"

graph=$root/target/profiling/flame.svg
case ${1:-} in
--help | -h) usage && exit ;;
--graph)
    [ $# -ge 2 ] || { say "--graph needs a file" && exit 2; }
    graph=$2
    shift 2
    ;;
esac
# Rendering hardly runs anything but the engine; `rays` also compares the hits of each pass.
[ $# -gt 0 ] || set -- render "$default_scene" --samples 256 --threads 1 -o "$root/target/profiling/knot.exr"

perf_works || exit 2
if has_counters; then
    event=cycles:u unit=cycles
else
    # A timer's signal comes some instructions late: exact to the function, not to the line.
    event=cpu-clock:u unit=ns
    echo "no hardware counters here: perf samples by timer (cpu-clock)"
fi
build_for_perf

data=$root/target/profiling/perf.data
perf record --quiet --event $event --freq 997 --call-graph fp --output "$data" -- "$octray" "$@"

echo
echo "Hottest functions (self time; inlined code counts for the function that holds it):"
perf report --input "$data" --stdio --quiet --no-children --call-graph none --sort symbol --percent-limit 0.5 2>/dev/null |
    sed -E 's/( +-)* *$//; /^$/d' | sed -n 1,25p

# Draws the recording with inferno, from the PATH or from target/tools.
draw() {
    PATH=$PATH:$root/target/tools/bin
    if ! command -v inferno-collapse-perf >/dev/null || ! command -v inferno-flamegraph >/dev/null; then
        echo "installing inferno in target/tools, once, for the flame graph" >&2
        (cd "$root" && cargo install inferno --quiet --locked --root target/tools) || return
    fi
    perf script --no-inline --input "$data" 2>/dev/null | inferno-collapse-perf --quiet |
        inferno-flamegraph --quiet --title "octray $*" --countname $unit --deterministic >"$graph"
}

echo
drawn=0
draw "$@" || drawn=1
if [ $drawn = 0 ]; then
    echo "Flame graph: $graph"
else
    say "NO FLAME GRAPH: inferno is missing or failed, see above. With a network: cargo install inferno --locked"
fi
cat <<END
More from the same recording:
  perf report --input $data
  perf annotate --input $data --stdio -l -s FUNCTION      source lines, then instructions
END
exit $drawn
