# Shared by record.sh and stat.sh, which source it.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# The default scene: a dense mesh.
# shellcheck disable=SC2034
default_scene=builtin:knot:100000

say() { echo "$(basename "$0"): $*" >&2; }

# Prints the comment at the head of the running script.
usage() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"; }

# build FLAGS FOLDER: compiles octray with symbols and line tables, and shows what cargo says; the program's path
# is then in $octray.
build() {
    say "building octray with symbols in $2/profiling: minutes the first time"
    (cd "$root" && RUSTFLAGS="$1" cargo build --profile profiling --target-dir "$2" --bin octray)
    # shellcheck disable=SC2034
    octray=$2/profiling/octray
}

# As in .cargo/config.toml: for this processor, with the frame pointers that perf's call graphs need too.
build_for_perf() { build "-C target-cpu=native -C force-frame-pointers=yes" "$root/target"; }

# Succeeds if perf can profile here; otherwise prints the reason and the remedy.
perf_works() {
    if ! command -v perf >/dev/null; then
        say "Linux perf is not installed."
        say "  Debian: apt install linux-perf; Ubuntu: apt install linux-tools-generic; Fedora: dnf install perf"
        return 1
    fi
    local answer setting=/proc/sys/kernel/perf_event_paranoid
    answer=$(perf stat --event task-clock:u true 2>&1) && return
    say "perf is refused here: $(sed '/^Error:$/d; /^ *$/d' <<<"$answer" | sed 1q)"
    say "  kernel.perf_event_paranoid is $(cat $setting 2>/dev/null || echo unknown). This lets users profile their own programs until the next boot:"
    say "    sudo sysctl kernel.perf_event_paranoid=1"
    say "  Where it is 1 or less already, a container or sandbox forbids perf_event_open: run this outside, or see its manual."
    return 1
}

# Succeeds if the machine has hardware counters; most virtual machines have none.
has_counters() { [[ $(perf stat --field-separator , --event cycles:u true 2>&1 | tail -1) == [0-9]* ]]; }
