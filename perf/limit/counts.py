"""How often every instruction of a program is executed, and where in the source it comes from."""

import collections
import re
import subprocess

# valgrind's model of a processor is the same on every machine: 32 KiB and 512 KiB of cache.
CACHES = ["--I1=32768,8,64", "--D1=32768,8,64", "--LL=524288,8,64"]
# Addresses closer than this are disassembled in one go.
NEAR = 1 << 14


class Row:
    """One executed instruction."""

    def __init__(self, address, text, previous, events, origin):
        self.address, self.text, self.previous, self.events, self.origin = address, text, previous, events, origin
        self.executed = events["Ir"]


def simulate(command, file, log):
    """Events by address of the program's own code: {address: {event: count}}; None if valgrind failed."""
    words = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={file}", f"--log-file={log}", "--dump-instr=yes"]
    words += ["--compress-pos=no", "--compress-strings=no", "--branch-sim=yes", "--cache-sim=yes", *CACHES]
    if subprocess.run([*words, *map(str, command)], capture_output=True).returncode:
        return None
    return parse(file, str(command[0]))


def parse(file, program):
    found, names, inside, called = {}, [], False, False
    with open(file, encoding="utf-8", errors="replace") as lines:
        for line in lines:
            if line.startswith("0x"):
                # The line after `calls=` holds what the callee cost.
                if inside and not called:
                    address, _, *values = line.split()
                    events = found.setdefault(int(address, 16), collections.Counter())
                    events.update(dict(zip(names, map(int, values))))
                called = False
            elif line.startswith("ob="):
                inside = line[3:].strip() == program
            elif line.startswith("calls="):
                called = True
            elif line.startswith("events:"):
                names = line.split()[1:]
    return found


def difference(long, short, times):
    """What one of `times` repetitions executes: the long run minus the short one."""
    events = {}
    for address, counted in long.items():
        less = short.get(address, {})
        one = {name: (count - less.get(name, 0)) / times for name, count in counted.items()}
        if one.get("Ir", 0) > 0:
            events[address] = collections.Counter(one)
    return events


def rows(program, events):
    """A `Row` for each executed instruction."""
    text, previous = disassemble(program, sorted(events))
    origins = find_origins(program, sorted(events))
    return [
        Row(address, text[address], previous.get(address, ""), counted, origins.get(address, []))
        for address, counted in events.items()
        if address in text
    ]


def disassemble(program, addresses):
    """The text of instructions by address, and the text of the instruction before each."""
    text, previous = {}, {}
    ranges = []
    for address in addresses:
        if ranges and address - ranges[-1][1] < NEAR:
            ranges[-1][1] = address
        else:
            ranges.append([address, address])
    for first, last in ranges:
        limits = [f"--start-address={max(first - 64, 0):#x}", f"--stop-address={last + 16:#x}"]
        command = ["objdump", "-d", "--no-show-raw-insn", "-M", "intel", *limits, program]
        listing = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True).stdout
        before = ""
        for line in listing.splitlines():
            if found := re.match(r"\s*([0-9a-f]+):\t(.*)", line):
                address = int(found[1], 16)
                text[address], previous[address] = found[2], before
                before = found[2]
    return text, previous


def find_origins(program, addresses):
    """The chain of inlined functions of each address, outermost first: [(function, file)]."""
    command = ["addr2line", "-a", "-i", "-f", "-C", "-e", str(program)]
    lines = subprocess.run(
        command, input="\n".join(map(hex, addresses)), capture_output=True, text=True, check=True
    ).stdout.splitlines()
    origins, chain, index = {}, [], 0
    while index < len(lines):
        if re.fullmatch(r"0x[0-9a-f]+", lines[index]):
            chain = origins.setdefault(int(lines[index], 16), [])
            index += 1
        else:
            chain.insert(0, (lines[index], lines[index + 1].rpartition(":")[0]))
            index += 2
    return origins
