#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How deep the stack gets below a function of an x86-64 program or library, at most, and whether anything in there calls itself.

usage: check_stack.py FILE FUNCTION BYTES [PATTERN]...   e.g. check_stack.py build/release/c/libgatefly_c.so gatefly_step 32768

Reads what objdump prints: each function's frame (pushes and what it subtracts from the stack pointer) and whom it calls; the deepest way down is
the answer. Functions whose readable name has a PATTERN in it are left out, e.g. those of the paper's modes. A function of another library counts as
OUTSIDE. Frames whose size is known at run time only, and calls by pointer, are not in the sum: they are listed, and refused but for VARIABLE.
Exit 0: at most BYTES, no recursion, no call by pointer."""
import re
import subprocess
import sys

OUTSIDE = 512  # memcpy, sqrt, ... [bytes]
FUNCTION = re.compile(r"^([0-9a-f]+) <(.+)>:$")
CALL = re.compile(r"\t(?:\w+ )*(call|jmp|j\w+) +[0-9a-f]+ <([^+>]+(?:\([^>]*\))?.*?)(\+0x[0-9a-f]+)?>$")
ANY_CALL = re.compile(r"\t(?:[\w.]+ )*call\b")
DOWN = re.compile(r"\t(?:(sub|add) +\$0x([0-9a-f]+),%rsp|lea +-0x([0-9a-f]+)\(%rsp\),%rsp)$")
ALIGNED = re.compile(r"\tand +\$0x([0-9a-f]+),%rsp$")
# Other ways to move the stack pointer; back from the frame pointer is none.
MOVED = re.compile(r"\t(?:sub|add|mov|lea|xchg|and) +(?=[^ $]).*,%rsp$")
BACK = re.compile(r"\t(?:lea +-?0x[0-9a-f]+\(%r(?:bp|sp|10)\)|mov +%rbp),%rsp$")
BY_POINTER = re.compile(r"\t(?:call|(?:notrack )?jmp) +\*")
# A switch jumps by a table: it loads how far from the table, and adds where that is.
LOADED, ADDED = re.compile(r"\tmovslq \((%r\w+),%r\w+,4\),(%r\w+)$"), re.compile(r"\tadd +(%r\w+),(%r\w+)$")

# Kernels of Eigen that take memory where they are given none. Matrices here have a largest size, and bring theirs with them
# (gemm_blocking_space of Eigen/src/Core/products/GeneralMatrixMatrix.h).
VARIABLE = ("Eigen::internal::triangular_solve_matrix<", "Eigen::internal::general_matrix_matrix_triangular_product<")


class Function:
    def __init__(self):
        self.frame, self.calls = 8, set()
        self.by_pointer = self.calls_itself = self.variable_frame = self.unclear = False


def is_switch(lines, jump):
    """Whether a jump to a register goes where the instructions before have loaded and added up a place of a table."""
    added = ADDED.search(lines[-1]) if lines else None
    loaded = next((found for line in reversed(lines) if (found := LOADED.search(line))), None)
    if not added or not loaded or "call" in jump or added[2] != jump.rpartition("*")[2]:
        return False
    return {added[1], added[2]} == {loaded[1], loaded[2]}


def read(path):
    """{name: Function} of all code in a file; names as the linker has them."""
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", path], check=True, capture_output=True, text=True).stdout
    functions, here, name, before = {}, None, "", []
    for text_line in text.splitlines():
        line = text_line.rstrip()
        begin = FUNCTION.match(line)
        if begin:
            name, before = begin[2], []
            here = functions.setdefault(name, Function())
            # One of several versions, for this processor or that, is called by way of what chooses it.
            if name.endswith(".resolver"):
                functions[f"*ABS*+0x{int(begin[1], 16):x}"] = functions[name.removesuffix(".resolver")] = Function()
            continue
        if here is None or "\t" not in line:
            continue
        if "\tpush " in line:
            here.frame += 8
        down = DOWN.search(line)
        if down:
            size = int(down[2] or down[3], 16)
            size -= 2**64 if size >= 2**63 else 0
            here.frame += max(0, -size if down[1] == "add" else size)
        aligned = ALIGNED.search(line)
        here.frame += 2**64 - int(aligned[1], 16) if aligned else 0
        here.variable_frame = here.variable_frame or bool(MOVED.search(line) and not BACK.search(line) and not aligned)
        call, by_pointer = CALL.search(line), BY_POINTER.search(line)
        called = call[2].partition("@@")[0] if call else None  # without its version
        if call and (call[3] is None or called.endswith(".cold")):
            here.calls_itself = here.calls_itself or (call[1] == "call" and called == name)
            here.calls.add(called)
        elif not by_pointer and (called != name.removesuffix(".cold") if call else ANY_CALL.search(line)):
            here.unclear = True  # into the middle of another one, or in a form unknown here
        if by_pointer and not is_switch(before, line):
            here.by_pointer = True
        before = [*before[-6:], line]
    for name, function in list(functions.items()):
        if name.endswith(".resolver"):
            versions = {each for each in functions if each.startswith(name.removesuffix("resolver")) and each != name}
            functions[name.removesuffix(".resolver")].calls.update(versions)
        if name + ".cold" in functions:
            function.calls.add(name + ".cold")
    return functions


def readable(names):
    """{name: as in the source}."""
    listed = sorted(names)
    plain = [re.sub(r"\.cold$|\.resolver$", "", each) for each in listed]
    lines = subprocess.run(["c++filt"], input="\n".join(plain), check=True, capture_output=True, text=True).stdout.splitlines()
    return dict(zip(listed, lines, strict=True))


def without(functions, patterns):
    """All but those with a pattern in their readable name, and the calls of them."""
    names = readable(functions)
    gone = {name for name, text in names.items() if any(pattern in text.replace("(anonymous namespace)::", "").partition("(")[0] for pattern in patterns)}
    kept = {name: function for name, function in functions.items() if name not in gone}
    for function in kept.values():
        function.calls = {each for each in function.calls if each not in gone and each.removesuffix("@plt") not in gone}
    return kept


class Depth:
    def __init__(self, functions):
        self.functions = functions
        self.known, self.below, self.on_the_way, self.recursion = {}, {}, [], []

    def of(self, name):
        if name in self.known:
            return self.known[name]
        if name in self.on_the_way:
            self.recursion.append(self.on_the_way[self.on_the_way.index(name):] + [name])
            return 0
        function = self.functions.get(name)
        if function is None or name.endswith("@plt"):
            own = self.functions.get(name.removesuffix("@plt")) if name.endswith("@plt") else None
            return self.of(name.removesuffix("@plt")) if own else OUTSIDE
        if function.calls_itself:
            self.recursion.append([name, name])
        self.on_the_way.append(name)
        deepest, self.below[name] = max(((self.of(each), each) for each in function.calls if each != name), default=(0, None))
        self.on_the_way.pop()
        self.known[name] = function.frame + deepest
        return self.known[name]


def main(path, start, most, *left_out):
    functions = without(read(path), left_out)
    if start not in functions:
        sys.exit(f"check_stack: {path} has no {start}")
    sys.setrecursionlimit(10000)
    depth = Depth(functions)
    total = depth.of(start)
    names = readable(functions)
    print(f"stack: {total} bytes below {start} at most; the deepest way:")
    name = start
    while name in depth.below:
        print(f"  {functions[name].frame:7}  {names[name][:110]}")
        name = depth.below[name]
    wrong = ["recursion: " + " -> ".join(names[each][:110] for each in way) for way in depth.recursion]
    for name in sorted(depth.known):
        if functions[name].by_pointer:
            wrong.append(f"by pointer: {names[name][:110]}")
        if functions[name].unclear:
            wrong.append(f"a call that is not understood: {names[name][:110]}")
        if functions[name].variable_frame:
            known = any(each in names[name] for each in VARIABLE)
            (print if known else wrong.append)(f"{'  ' if known else ''}a frame of variable size: {names[name][:110]}")
    for each in wrong:
        print(each)
    return 0 if total <= int(most) and not wrong else 1


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
