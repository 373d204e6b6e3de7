# What record.sh and stat.sh share. Sourced, not run.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# What both look at where nothing is said: a dense mesh.
# shellcheck disable=SC2034
default_scene=builtin:knot:100000

say() { echo "$(basename "$0"): $*" >&2; }

# The comment at the head of the script that runs.
usage() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"; }

# build FLAGS FOLDER: compiles octray with symbols and line tables, and leaves its path in $octray.
build() {
    (cd "$root" && RUSTFLAGS="$1" cargo build --quiet --profile profiling --target-dir "$2" --bin octray)
    # shellcheck disable=SC2034
    octray=$2/profiling/octray
}

# Made for this machine, with frame pointers, by which perf finds who called.
build_for_perf() { build "-C target-cpu=native -C force-frame-pointers=yes" "$root/target"; }

# May perf observe programs here? If not, says why and what to do about it.
perf_works() {
    if ! command -v perf >/dev/null; then
        say "Linux perf is not installed."
        say "  Debian: apt install linux-perf; Ubuntu: apt install linux-tools-generic; Fedora: dnf install perf"
        return 1
    fi
    local answer setting=/proc/sys/kernel/perf_event_paranoid
    answer=$(perf stat --event task-clock:u true 2>&1) && return
    say "perf is refused here. It says: $(sed '/^Error:$/d; /^ *$/d' <<<"$answer" | sed 1q)"
    say "  kernel.perf_event_paranoid is $(cat $setting 2>/dev/null || echo unknown). This lets users observe their own programs, until the next start:"
    say "    sudo sysctl kernel.perf_event_paranoid=1"
    say "  Where it is 1 or less already, a container or sandbox forbids perf_event_open: run this outside, or as its manual says."
    return 1
}

# Does the machine count cycles? Most virtual machines do not.
has_counters() { [[ $(perf stat --field-separator , --event cycles:u true 2>&1 | tail -1) == [0-9]* ]]; }
