#!/usr/bin/env bash
# Counts what a ray costs: instructions, branches, cache misses.
#
#   perf/stat.sh [--simulate] rays SCENE [OPTION...]      rays alone, by every traversal or by that of --traversal
#   perf/stat.sh [--simulate] render SCENE [OPTION...]    the rays of whole frames, with shading
#
# OPTIONs are octray's own [default: rays builtin:knot:100000]. Reads hardware counters through Linux perf. If
# there are none, or with --simulate, valgrind's callgrind runs octray on a simple model of a processor: the
# same figures on every machine, however busy. Loading, building and saving are not counted. Exits with 2 if
# there is neither perf nor valgrind.
set -euo pipefail
# shellcheck source=perf/common.sh
source "$(dirname "$0")/common.sh"

simulated=
case ${1:-} in
--help | -h) usage && exit ;;
--simulate) simulated=yes && shift ;;
esac
[ $# -gt 0 ] || set -- rays "$default_scene"
what=$1
words=("$@")
case $what in rays | render) ;; *) say "counts rays or render, not $what; see --help" && exit 2 ;; esac
has() { case " ${words[*]} " in *" $1 "* | *" $1="*) ;; *) return 1 ;; esac; }
for mine in --threads --passes --samples --json --stats; do
    if has $mine; then say "$mine is set by this script" && exit 2; fi
done

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fixed=(--threads 1 --json)
if [ "$what" = render ]; then
    has --bounces || fixed+=(--bounces 4)
    has -o || has --output || fixed+=(-o "$scratch/picture.exr")
fi

# results REPORT: a line for each result in octray's report: kind of ray, traversal, number of rays.
results() {
    sed -nE 's/^ *"(kind|traversal|rays)": "?([^",]*)"?,?$/\1 \2/p' "$1" | awk '
        BEGIN { kind = "all"; way = "-" }
        $1 == "kind" { kind = $2 }
        $1 == "traversal" { way = $2 }
        $1 == "rays" { print kind, way, $2 }'
}

# difference LONG SHORT: the counts of one line minus those of the other.
difference() {
    awk -v short="$2" '{
        split(short, less)
        for (i = 1; i <= NF; i++) printf "%s ", ($i == "-" ? "-" : sprintf("%.0f", $i - less[i]))
    }' <<<"$1"
}

# count_on_machine ARGUMENT...: the counters over a long run minus those over a short one. What both share,
# such as loading, cancels out. Kinds of rays cannot be separated this way.
events=(cycles instructions branches branch-misses L1-dcache-load-misses cache-misses)
count_on_machine() {
    local short long
    if [ "$what" = rays ]; then
        short=$(counters 2 "$@" --passes 2)
        long=$(counters 22 "$@" --passes 22)
    else
        short=$(counters 1 "$@" --samples 8)
        long=$(counters 1 "$@" --samples 88)
    fi
    echo "all $(results "$scratch/report" | awk 'NR == 1 { print $2 }') $(difference "$long" "$short")"
}

# counters TIMES ARGUMENT...: the rays of a run (TIMES those of its report), then the mean count of each
# event.
counters() {
    local times=$1 runs=3
    shift
    perf stat --repeat $runs --field-separator , --event "$(printf ',%s:u' "${events[@]}" | cut -c2-)" \
        --output "$scratch/counts" -- "$octray" "$@" >"$scratch/report" || return
    results "$scratch/report" | awk -v times="$times" -v runs=$runs '{ rays += $3 } END { printf "%.0f", rays / runs * times }'
    awk -F, -v list="${events[*]}" '
        { sub(/:u.*/, "", $3); count[$3] = $1 }
        END {
            wanted = split(list, name, " ")
            for (i = 1; i <= wanted; i++) printf " %s", count[name[i]] ~ /^[0-9]/ ? count[name[i]] : "-"
        }' "$scratch/counts"
}

# count_by_simulation ARGUMENT...: a line for each kind of ray, or one for frames; callgrind's files stay in
# $kept.
kept=$root/target/callgrind/counts
count_by_simulation() {
    local short long kind way rays counts part=1
    if [ "$what" = rays ]; then
        # Only tracing is counted. Each pass begins a new file: the first holds the generation of rays, then
        # follow two for each kind of ray, the second with warm caches.
        simulate "$scratch/out" --dump-before=octray_laboratory::measure::rays::Run::pass \
            --toggle-collect=octray_laboratory::measure::trace::Accelerators::trace_chunk "$octray" "$@" --passes 1
        results "$scratch/report" >"$scratch/results"
        mv "$scratch/out" "$scratch/out.$(($(wc -l <"$scratch/results") * 2 + 1))"
        while read -r kind way rays; do
            part=$((part + 2))
            # Without the calls in progress, which callgrind_annotate would count for the callers.
            awk '/^calls=0 / { getline; next } 1' "$scratch/out.$part" >"$kept/$kind-$way.out"
            counts=$(totals "$kept/$kind-$way.out")
            if [ "$rays" -gt 0 ] && [ "${counts%% *}" = 0 ]; then
                say "nothing counted for $kind rays: is a function that this script names gone?"
                return 1
            fi
            echo "$kind $way $rays $counts"
        done <"$scratch/results"
    else
        # Four frames minus one: loading and saving cancel out.
        simulate "$scratch/out" "$octray" "$@" --samples 1
        short="$(results "$scratch/report" | cut -d' ' -f3) $(totals "$scratch/out")"
        simulate "$kept/frames.out" "$octray" "$@" --samples 4
        long="$(results "$scratch/report" | cut -d' ' -f3) $(totals "$kept/frames.out")"
        echo "all - $(difference "$long" "$short")"
    fi
}

# hottest FILE: the functions behind a row, separated by the source file of their instructions, inlined code
# included.
hottest() {
    echo
    case $1 in */frames.out) echo "frames: the whole run, with loading and saving" ;; *) basename "$1" .out ;; esac
    callgrind_annotate --auto=no --show=Ir,Bcm,D1mr,DLmr "$1" |
        sed -nE '/^ *[0-9,]+ .*[^ ]:[^ ]/{s# \[[^]]*\]$##; s#/[^ ]*/library/#library/#; s#core/src/../../##; s#/[^ ]*/registry/src/[^/]*/##; p}' | sed -n 1,10p
}

# simulate FILE ARGUMENT...: 32 KiB of first-level and 512 KiB of second-level cache on every machine.
simulate() {
    local out=$1
    shift
    if ! valgrind --tool=callgrind --callgrind-out-file="$out" --log-file="$scratch/log" --branch-sim=yes --cache-sim=yes \
        --I1=32768,8,64 --D1=32768,8,64 --LL=524288,8,64 "$@" >"$scratch/report" 2>"$scratch/errors"; then
        cat "$scratch/errors" "$scratch/log" >&2
        return 1
    fi
}

# totals FILE: instructions, branches, those mispredicted, misses of both caches.
totals() {
    awk '
        $1 == "events:" { for (i = 2; i <= NF; i++) place[$i] = i }
        $1 == "totals:" {
            printf "%.0f %.0f %.0f %.0f %.0f", $place["Ir"], $place["Bc"] + $place["Bi"], $place["Bcm"] + $place["Bim"],
                $place["D1mr"] + $place["D1mw"], $place["DLmr"] + $place["DLmw"]
        }' "$1"
}

if [ -z "$simulated" ]; then
    if ! perf_works; then
        say "counting with callgrind instead"
        simulated=yes
    elif ! has_counters; then
        say "this machine has no counters: counting with callgrind instead"
        simulated=yes
    fi
fi
if [ -z "$simulated" ]; then
    build_for_perf
    has --size || [ "$what" = rays ] || fixed+=(--size 240x135)
    count=count_on_machine columns=("${events[@]:0:4}" L1-misses LLC-misses)
else
    if ! command -v valgrind >/dev/null; then
        say "valgrind is not installed (Debian: apt install valgrind): nothing was counted"
        exit 2
    fi
    # The same instructions on every machine; valgrind has no AVX-512.
    build "-C target-cpu=x86-64-v3 -C force-frame-pointers=yes" "$root/target/callgrind"
    rm -rf "$kept" && mkdir -p "$kept"
    has --size || fixed+=(--size 240x135)
    count=count_by_simulation columns=(instructions branches mispredicted L1-misses L2-misses)
fi

if [ "$what" = rays ] && ! has --traversal; then
    for way in scalar single packet stream hybrid; do
        $count "${words[@]}" "${fixed[@]}" --traversal "$way" >>"$scratch/rows"
    done
else
    $count "${words[@]}" "${fixed[@]}" >"$scratch/rows"
fi

printf '%-9s%-9s%11s' kind way rays && printf '%14s' "${columns[@]}" && echo
for kind in all primary shadow diffuse; do
    awk -v kind=$kind '$1 == kind {
        line = sprintf("%-9s%-9s%11.0f", $1, $2, $3)
        for (i = 4; i <= NF; i++) line = line ($i == "-" || $3 == 0 ? sprintf("%14s", "-") : sprintf("%14.4g", $i / $3))
        print line
    }' "$scratch/rows"
done
echo
if [ -z "$simulated" ]; then
    echo "Counts per ray, in user mode. Instructions per cycle are the second column over the first."
else
    echo "Counts per ray, simulated."
    if [ "$what" = render ] || has --traversal; then
        echo "Where instructions (Ir), mispredicted branches (Bcm), reading misses of L1 (D1mr) and L2 (DLmr) fall to, most first:"
        for file in "$kept"/*; do hottest "$file"; done
    fi
    echo "By source line: callgrind_annotate --auto=yes --show=Ir,Bcm,D1mr,DLmr FILE, with one of these:"
    printf '  %s\n' "$kept"/*
fi
