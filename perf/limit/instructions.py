"""What an x86-64 instruction does: its kinds.

Instructions of one kind occupy the same ports; `processors.py` says which. An instruction with a memory
operand is of two kinds: its own, and a load or a store. Legacy SSE, x87 and AVX-512 do not occur in builds for
x86-64-v3 outside libc; they count as scalar.
"""

import re

# The rows of the report: what a graphics programmer asks about. Every kind is in one of them.
CLASSES = {
    "multiply, fma": ["multiply"],
    "add, min, max": ["add", "minimum"],
    "convert, round": ["convert", "round"],
    "compare": ["compare"],
    "divide, root": ["divide", "divide wide", "root", "root wide", "estimate"],
    "logic, blend": ["logic", "blend", "blend by mask"],
    "integer": ["integer", "integer compare", "shift", "shift by register"],
    "integer multiply": ["multiply 32", "multiply 16"],
    "shuffle": ["shuffle", "shuffle across"],
    "to and from scalar": ["to scalar", "from scalar", "test", "extract", "insert", "convert scalar"],
    "gather": ["gather"],
    "load": ["load", "vector load"],
    "store": ["store", "vector store"],
    "scalar, moves": ["scalar", "scalar shift", "scalar multiply", "set", "move", "divide scalar"],
    "branch": ["branch"],
}
CLASS_OF = {kind: name for name, kinds in CLASSES.items() for kind in kinds}
VECTOR_CLASSES = list(CLASSES)[:11]

VECTOR = [
    (r"vf(n?)m(add|sub|addsub|subadd)\d+[ps][sd]|vmul[ps][sd]", "multiply"),
    (r"v(add|sub|addsub)[ps][sd]", "add"),
    (r"v(min|max)[ps][sd]", "minimum"),
    (r"vcvtt?[sd]s2u?si|vcvtu?si2s[sd]", "convert scalar"),
    (r"vcvt\w+", "convert"),
    (r"vround[ps][sd]", "round"),
    (r"vcmp\w*[ps][sd]", "compare"),
    (r"vu?comis[sd]|v?movmskp[sd]|vpmovmskb|vtestp[sd]", "to scalar"),
    (r"vptest", "test"),
    (r"vdiv[ps][sd]", "divide"),
    (r"vsqrt[ps][sd]", "root"),
    (r"vr(cp|sqrt)[ps]s", "estimate"),
    (r"v(and|andn|or|xor)p[sd]|vp(and|andn|or|xor)[dq]?", "logic"),
    (r"vblendv?p[sd]|vpblendv?[bwd]+", "blend"),
    (r"vpmulld", "multiply 32"),
    (r"vpmul\w+|vpmadd\w+", "multiply 16"),
    (r"vp(add|sub)u?s?[bwdq]|vpabs[bwd]|vpsign[bwd]|vpavg[bw]", "integer"),
    (r"vpcmp\w+|vp(min|max)[us][bwd]", "integer compare"),
    (r"vps[lr][la]v?[wdq]", "shift"),
    (r"vpgather\w+|vgather\w+", "gather"),
    (r"vpextr[bwdq]|vextractps", "extract"),
    (r"vpinsr[bwdq]", "insert"),
    (r"vperm(d|q|ps|pd|2f128|2i128)|v(extract|insert)[fi]128|vpack\w+", "shuffle across"),
    (r"vp?broadcast\w+|vpmov[sz]x\w+|vh(add|sub)p[sd]|vdpp[sd]", "shuffle across"),
    (r"v(shuf|unpck[lh]|permil)p[sd]|vp(shuf\w+|unpck\w+|alignr|s[lr]ldq)", "shuffle"),
    (r"vmov[sd][lh]?dup|vinsertps|vmov(hl|lh)ps", "shuffle"),
]
VECTOR = [(re.compile(pattern), kind) for pattern, kind in VECTOR]
MOVE = re.compile(r"v?mov([au]p[sd]|dq[au]|s[sd]|[dq]|[hl]p[sd]|nt\w+)|vlddqu|vp?maskmov(p[sd]|[dq])")
GENERAL = re.compile(r"[re]?[a-d]x|[re]?[sd]i|[re]?bp|r\d+[dwb]?")
BRANCH = re.compile(r"j\w+|call|ret|loop\w*")
FUSES = re.compile(r"cmp|test|and|add|sub|inc|dec")
ZERO = re.compile(r"v?p?xor(p[sd]|[dq])?|vpcmpgt[bwdq]|v?psub[bwdq]|sub")


def split(text):
    """The mnemonic and the operands of a line of objdump's disassembly, Intel syntax, without prefixes."""
    text = re.sub(r"^(?:(?:lock|rep\w*|notrack|bnd|data16|cs|ds|es|fs|gs|addr32|\{\w+\})\s+)+", "", text)
    text = re.sub(r"<.*?>|#.*", "", text).strip()
    name, _, rest = text.partition(" ")
    return name, [operand.strip() for operand in rest.split(",")] if rest.strip() else []


def memory(name, operands):
    """The kinds of an instruction's access to memory."""
    place = next((index for index, operand in enumerate(operands) if "[" in operand), None)
    kind = "vector " if name.startswith("v") and name not in ("vmovd", "vmovq") else ""
    if name in ("push", "call"):
        return ["store"] + (["load"] if place is not None else [])
    if name in ("pop", "ret"):
        return ["load"]
    if place is None or name in ("lea", "nop", "nopw", "nopl") or name.startswith("prefetch"):
        return ["load"] if name.startswith("prefetch") else []
    if place > 0 or name in ("cmp", "test", "bt", "mul", "imul", "div", "idiv") or BRANCH.fullmatch(name):
        return [kind + "load"]
    if MOVE.fullmatch(name) or name.startswith(("mov", "set", "vextract", "vpextr", "vcvtps2ph")):
        return [kind + "store"]
    return ["load", "store"]


def kinds(name, operands):
    """All kinds of an instruction: what it computes, and what it loads and stores."""
    access = memory(name, operands)
    if BRANCH.fullmatch(name):
        return ["branch"] + access
    if name in ("nop", "nopw", "nopl", "endbr64", "ud2", "int3", "vzeroupper") or name.startswith("prefetch"):
        return access
    if name in ("push", "pop"):
        return access
    registers = [operand for operand in operands if "[" not in operand]
    if ZERO.fullmatch(name) and len(registers) >= 2 and len(set(registers[-2:])) == 1:
        return ["move"]
    if name.startswith("v"):
        return vector(name, operands, access)
    if name.startswith("mov") and not name.startswith("movmsk"):
        plain = name in ("mov", "movabs", "movaps", "movups", "movdqa", "movdqu")
        return access or (["move"] if plain and not operands[-1].startswith("0x") else ["scalar"])
    if re.fullmatch(r"s[ah][lr][dx]?|ro[lr]x?|rc[lr]", name):
        return ["scalar shift"] + access
    if re.fullmatch(r"i?mulx?|popcnt|[lt]zcnt|bs[fr]|pdep|pext|bswap|bextr", name):
        return ["scalar multiply"] + access
    if re.fullmatch(r"i?div", name):
        return ["divide scalar"] + access
    if re.fullmatch(r"set\w+|cmov\w+|adc|sbb", name):
        return ["set"] + access
    return ["scalar"] + access


def vector(name, operands, access):
    if MOVE.fullmatch(name):
        general = [operand for operand in operands if GENERAL.fullmatch(operand)]
        if access:
            return access
        if general:
            return ["from scalar" if general[0] == operands[-1] else "to scalar"]
        return ["blend"] if name in ("vmovss", "vmovsd") else ["move"]
    kind = next((kind for pattern, kind in VECTOR if pattern.fullmatch(name)), "scalar")
    if access and kind == "shuffle across" and name.startswith(("vbroadcast", "vpbroadcastd", "vpbroadcastq")):
        return access  # the load port does it
    if access and access[0].endswith("store") and name.startswith("vextract"):
        return access
    if kind in ("divide", "root") and operands[0].startswith("ymm"):
        kind += " wide"
    if kind == "blend" and "v" in name[5:8]:
        kind = "blend by mask"
    if kind == "shift" and "v" not in name[4:] and not access and operands[-1].startswith("xmm"):
        kind = "shift by register"
    if kind == "gather":
        return ["gather"]
    return [kind] + access


def operations(name, operands):
    """Operations on single floats, two for a fused multiply-add."""
    found = next((kind for pattern, kind in VECTOR if pattern.fullmatch(name)), None)
    if found not in ("multiply", "add", "minimum", "divide", "root"):
        return 0
    wide = {"y": 32, "x": 16}.get(operands[0][:1], 0)
    lanes = 1 if name[-2] == "s" else wide // (8 if name.endswith("d") else 4)
    return lanes * (2 if name.startswith("vf") else 1)
