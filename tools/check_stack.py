#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How deep the stack gets below a function of an x86-64 program or library, at most, and whether anything in there calls itself.

usage: check_stack.py FILE FUNCTION BYTES [PATTERN]...   e.g. check_stack.py build/release/c/libgatefly_c.so gatefly_step 32768

Reads what objdump prints: each function's frame (pushes and what it subtracts from the stack pointer) and whom it calls; the deepest way down is
the answer. Functions whose name matches a PATTERN are left out, e.g. those of the paper's modes. A function of another library counts as
OUTSIDE. Calls by pointer are listed: what they lead to is not in the sum. Exit 0: at most BYTES and no recursion."""
import re
import subprocess
import sys

OUTSIDE = 512  # memcpy, sqrt, ... [bytes]
FUNCTION = re.compile(r"^([0-9a-f]+) <(.+)>:$")
CALL = re.compile(r"\t(?:call|jmp|j\w+) +[0-9a-f]+ <([^+>]+(?:\([^>]*\))?.*?)(\+0x[0-9a-f]+)?>$")
DOWN = re.compile(r"\t(?:(sub|add) +\$0x([0-9a-f]+),%rsp|lea +-0x([0-9a-f]+)\(%rsp\),%rsp)$")
BY_POINTER = re.compile(r"\t(?:call|(?:notrack )?jmp) +\*")
# A switch jumps by a table, to what it has added up just before.
SWITCH = re.compile(r"\tadd +%r\w+,(%r\w+)$")


class Function:
    def __init__(self):
        self.frame, self.calls, self.by_pointer = 8, set(), 0


def read(path):
    """{name: Function} of all code in a file."""
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", path], check=True, capture_output=True, text=True).stdout
    functions, here, before = {}, None, ""
    for text_line in text.splitlines():
        line = text_line.rstrip()
        begin = FUNCTION.match(line)
        if begin:
            here = functions.setdefault(begin[2], Function())
            # One of several versions, for this processor or that, is called by way of what chooses it.
            if begin[2].endswith(".resolver"):
                functions[f"*ABS*+0x{int(begin[1], 16):x}"] = functions[begin[2].removesuffix(".resolver")] = Function()
            continue
        if here is None:
            continue
        if "\tpush " in line:
            here.frame += 8
        down = DOWN.search(line)
        if down:
            size = int(down[2] or down[3], 16)
            size -= 2**64 if size >= 2**63 else 0
            here.frame += max(0, -size if down[1] == "add" else size)
        call = CALL.search(line)
        if call and call[2] is None:
            here.calls.add(call[1])
        switched = SWITCH.search(before)
        here.by_pointer += bool(BY_POINTER.search(line)) and not (switched and line.endswith(f" *{switched[1]}"))
        before = line
    for name, function in list(functions.items()):
        if name.endswith(".resolver"):
            versions = {each for each in functions if each.startswith(name.removesuffix("resolver")) and each != name}
            functions[name.removesuffix(".resolver")].calls.update(versions)
    return functions


def shown(name):
    return subprocess.run(["c++filt", name.removesuffix(".cold")], check=True, capture_output=True, text=True).stdout.strip()[:110]


class Depth:
    def __init__(self, functions, left_out):
        self.functions, self.left_out = functions, left_out
        self.known, self.below, self.on_the_way, self.recursion, self.pointers = {}, {}, [], [], set()

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
        if any(pattern in name for pattern in self.left_out):
            return 0
        if function.by_pointer:
            self.pointers.add(name)
        self.on_the_way.append(name)
        deepest, self.below[name] = max(((self.of(each), each) for each in function.calls if each != name), default=(0, None))
        self.on_the_way.pop()
        self.known[name] = function.frame + deepest
        return self.known[name]


def main(path, start, most, *left_out):
    functions = read(path)
    if start not in functions:
        sys.exit(f"check_stack: {path} has no {start}")
    sys.setrecursionlimit(10000)
    depth = Depth(functions, left_out)
    total = depth.of(start)
    print(f"stack: {total} bytes below {start} at most; the deepest way:")
    name = start
    while name in depth.below:
        print(f"  {functions[name].frame:7}  {shown(name)}")
        name = depth.below[name]
    for way in depth.recursion:
        print("recursion: " + " -> ".join(shown(each) for each in way))
    for name in sorted(depth.pointers):
        print(f"by pointer: {shown(name)}")
    return 0 if total <= int(most) and not depth.recursion else 1


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
