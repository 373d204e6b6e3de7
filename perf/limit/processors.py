"""What the ports of a processor do with instructions at best.

A port starts one micro-operation a cycle. Vectors have 256 bits. Sources: A. Abel, J. Reineke, uops.info
(2019); A. Fog, Instruction tables; the scheduling models of LLVM (X86SchedIceLake, X86SchedSapphireRapids,
X86ScheduleZnver4). Where sources differ, the faster figure counts, so that the bound stays one.
"""

from instructions import CLASS_OF


class Processor:
    """The ports that each kind of instruction needs: a character a port, a word a micro-operation that any of
    its ports can do, `*N` for N of them. The divider `d` counts as a port, which a division keeps for cycles.
    """

    def __init__(self, name, front, groups, names, table):
        self.name, self.front, self.groups, self.names = name, front, groups, names
        self.table = {kind: self.operations(words) for kind, words in table.items()}
        missing = set(CLASS_OF) - set(self.table)
        assert not missing, f"{name}: no ports for {missing}"

    @staticmethod
    def operations(words):
        """[(ports, how often)]"""
        split = [(word + "*1").split("*")[:2] for word in words.split()]
        return [(frozenset(ports), int(times)) for ports, times in split]

    def slots(self, kinds):
        """Front-end slots of an instruction: an operation and its load share one, as do the halves of a store."""
        own = [kind for kind in kinds if CLASS_OF[kind] not in ("load", "store")]
        computed = sum(times for kind in own for ports, times in self.table[kind] if ports != frozenset("d"))
        return max(computed + sum(CLASS_OF[kind] == "store" for kind in kinds), 1)

    def pressure(self, counts):
        """Micro-operations by the set of ports that can do them. `counts`: how often each kind is executed."""
        need = {}
        for kind, count in counts.items():
            for ports, times in self.table[kind]:
                need[ports] = need.get(ports, 0) + count * times
        return need

    def bound(self, counts, slots):
        """Cycles that front end and ports need at least, and which of them decides.

        Distributed at best over the ports, the micro-operations need max over sets S of ports of
        (operations that only S can do) / |S| cycles; unions of the sets that occur are enough (P. Hall 1935).
        """
        need = self.pressure(counts)
        unions = set()
        for ports in need:
            unions |= {ports | other for other in unions} | {ports}
        bounds = [(slots / self.front, "front end")]
        for union in unions:
            inside = sum(count for ports, count in need.items() if ports <= union)
            bounds.append((inside / len(union), self.label(union)))
        return max(bounds)

    def occupied(self, counts, slots):
        """Cycles for which the front end, and each group of ports alone, is busy at least: [(name, cycles)]."""
        need = self.pressure(counts)
        rows = [("front end", slots / self.front)]
        for name, letters in self.groups.items():
            inside = sum(count for ports, count in need.items() if ports <= frozenset(letters))
            rows.append((name, inside / len(letters)))
        return rows

    def label(self, ports):
        for name, letters in self.groups.items():
            if frozenset(letters) == ports:
                return name
        return "ports " + " ".join(sorted(self.names.get(port, port) for port in ports))


INTEL_PORTS = {"a": "10", "b": "11", "d": "divider"}
ICE_LAKE = {
    "multiply": "01", "add": "01", "minimum": "01", "convert": "01", "round": "01*2", "compare": "01",
    "divide": "0 d*3", "divide wide": "0 d*5", "root": "0 d*3", "root wide": "0 d*6", "estimate": "0",
    "logic": "015", "blend": "015", "blend by mask": "015*2",
    "integer": "015", "integer compare": "01", "shift": "01", "shift by register": "01 5",
    "multiply 32": "01*2", "multiply 16": "01", "shuffle": "15", "shuffle across": "5",
    "to scalar": "0", "from scalar": "5", "test": "0 5", "extract": "0 5", "insert": "5 15",
    "convert scalar": "01 5",
    "gather": "0 015 5 23*8", "load": "23", "vector load": "23", "store": "49 78", "vector store": "49 78",
    "scalar": "0156", "scalar shift": "06", "scalar multiply": "1", "set": "06", "move": "",
    "divide scalar": "1*4", "branch": "06",
}
GOLDEN_COVE = {
    **ICE_LAKE, "add": "15", "blend by mask": "015*3", "gather": "0 015 5 23b*8", "load": "23b",
    "vector load": "23b", "scalar": "0156a",
}
# FP pipes 0 to 3, integer pipes A to D and the branch pipe E, pipes 4 and 5 between both register files;
# memory pipes l, m, n, of which two (4, 5) load vectors, and one (s) stores them.
ZEN_4 = {
    "multiply": "01", "add": "23", "minimum": "01", "convert": "23", "round": "23", "compare": "01",
    "divide": "1*3", "divide wide": "1*3", "root": "1*5", "root wide": "1*5", "estimate": "01",
    "logic": "0123", "blend": "01", "blend by mask": "01",
    "integer": "0123", "integer compare": "0123", "shift": "12", "shift by register": "12",
    "multiply 32": "03", "multiply 16": "03", "shuffle": "12", "shuffle across": "12",
    "to scalar": "45", "from scalar": "45", "test": "12 45", "extract": "12 45", "insert": "12 45",
    "convert scalar": "23 45", "gather": "0123*8 lmn*8", "load": "lmn", "vector load": "lmn 45",
    "store": "lmn", "vector store": "lmn s",
    "scalar": "ABCD", "scalar shift": "BC", "scalar multiply": "B", "set": "AD", "move": "",
    "divide scalar": "A*10", "branch": "AE",
}
PROCESSORS = {
    "icelake": Processor(
        "Ice Lake", 5,
        {"vector ports 0 1 5": "015", "ports 0 1": "01", "port 5": "5", "divider": "d", "load ports": "23",
         "store ports": "49", "all computing ports": "0156"},
        INTEL_PORTS, ICE_LAKE,
    ),
    "goldencove": Processor(
        "Golden Cove (Sapphire Rapids, Emerald Rapids, Alder Lake)", 6,
        {"vector ports 0 1 5": "015", "ports 0 1": "01", "port 5": "5", "divider": "d", "load ports": "23b",
         "store ports": "49", "all computing ports": "0156a"},
        INTEL_PORTS, GOLDEN_COVE,
    ),
    "zen4": Processor(
        "Zen 4", 6,
        {"vector pipes 0 1 2 3": "0123", "pipes 0 1": "01", "pipes 1 2": "12", "pipe 1": "1", "memory pipes": "lmn",
         "vector stores": "s", "integer pipes": "ABCD"},
        {}, ZEN_4,
    ),
}
# By the family and model that /proc/cpuinfo gives.
MODELS = {
    ("GenuineIntel", 6): {
        "icelake": {106, 108, 125, 126, 140, 141, 167},
        "goldencove": {143, 151, 154, 183, 186, 191, 207},
    },
    ("AuthenticAMD", 25): {"zen4": {*range(0x10, 0x20), *range(0x60, 0x80), *range(0xA0, 0xB0)}},
}


def this_machine():
    """The name of this machine's table, or None."""
    found = {}
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            for line in lines:
                name, _, value = line.partition(":")
                found.setdefault(name.strip(), value.strip())
        families = MODELS[found["vendor_id"], int(found["cpu family"])]
        return next(name for name, models in families.items() if int(found["model"]) in models)
    except (OSError, KeyError, ValueError, StopIteration):
        return None
