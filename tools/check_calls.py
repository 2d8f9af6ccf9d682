#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whom a function of an x86-64 library can call outside of it, over every way through the code: no allocation, no lock, no system call, no
exception but those listed here, each with the reason why it never happens.

usage: check_calls.py FILE FUNCTION [PATTERN]...   e.g. check_calls.py build/release/c/libgatefly_c.so gatefly_step paper Paper side_bars

Reads the same calls as check_stack.py. A call by pointer, which would hide whom it calls, is refused. Functions whose name matches a PATTERN are left
out, e.g. those of the paper's modes. Exit 0: nothing but what is listed, and all that is listed."""
import re
import subprocess
import sys

import check_stack

# They calculate, or copy what they are given.
HARMLESS = {"memcpy", "memmove", "memset", "memcmp", "sqrt", "sqrtf", "frexp", "frexpf", "floor", "floorf", "ceil", "ceilf", "trunc", "round", "lround", "lroundf", "fmod", "fmodf"}

# (who calls, whom, why it never happens)
RESERVED = "the list has room for all since it was made"
FITS = "the stack holds what is needed (EIGEN_STACK_ALLOCATION_LIMIT is 128 KB, the largest matrix has 71 by 71 numbers, 40 KB)"
CACHE_SIZE = "asks once how large the cache is; the first step pays"
HAS_VALUE = "a phase loses its value by an exception only, and none is thrown"
AT_THE_DOOR = "the C interface's own net, where nothing should arrive"
EXPECTED = [
    ("gatefly::GateDetector::list_gates", r"operator new|operator delete|std::__throw_length_error", RESERVED),
    ("Eigen::internal::", r"malloc|free", FITS),
    ("Eigen::internal::throw_std_bad_alloc", r"__cxa_\w+|std::bad_alloc::.*", FITS),
    ("Eigen::internal::", r"__cxa_guard_\w+", CACHE_SIZE),
    ("gatefly::next_phase", r"__cxa_\w+", HAS_VALUE),
    ("std::__throw_bad_variant_access", r"__cxa_\w+|_Unwind_Resume", HAS_VALUE),
    ("gatefly_step", r"__cxa_(begin|end)_catch", AT_THE_DOOR),
]


def names_of(mangled):
    """{mangled: readable}."""
    listed = sorted(mangled)
    lines = subprocess.run(["c++filt"], input="\n".join(listed), check=True, capture_output=True, text=True).stdout.splitlines()
    return dict(zip(listed, lines, strict=True))


def calls_out(functions, start, left_out):
    """Pairs of a function that can be reached and one of elsewhere that it calls; the functions of which a call by pointer hides the aim."""
    reached, to_do, out, hidden = {start}, [start], set(), set()
    while to_do:
        name = to_do.pop()
        if functions[name].by_pointer:
            hidden.add(name)
        for called in functions[name].calls:
            called = called.removesuffix("@plt")
            if any(pattern in called for pattern in left_out) or called in reached:
                continue
            if called in functions:
                reached.add(called)
                to_do.append(called)
            else:
                out.add((name, called.partition("@")[0] or called))
    return reached, out, hidden


def main(path, start, *left_out):
    functions = check_stack.read(path)
    if start not in functions:
        sys.exit(f"check_calls: {path} has no {start}")
    reached, out, hidden = calls_out(functions, start, left_out)
    readable = names_of({name.removesuffix(".cold") for pair in out for name in pair} | {name.removesuffix(".cold") for name in hidden})
    wrong, met = [f"{readable[each.removesuffix('.cold')]} calls by pointer" for each in sorted(hidden)], set()
    for caller, called in sorted(out):
        who, whom = readable[caller.removesuffix(".cold")], readable[called]
        if whom in HARMLESS:
            continue
        reasons = [i for i, (by, what, _) in enumerate(EXPECTED) if who.startswith(by) and re.match(rf"(?:{what})(?![\w:])", whom)]
        met.update(reasons)
        if not reasons:
            wrong.append(f"{who[:110]} calls {whom}")
    wrong += [f"listed, and called no more: {EXPECTED[i][0]} {EXPECTED[i][1]}" for i in range(len(EXPECTED)) if i not in met]
    for each in wrong:
        print(f"calls: {each}")
    print(f"calls: {len(reached)} functions below {start}, {len(out)} calls of others; {len(wrong)} that should not be")
    for by, what, why in EXPECTED:
        print(f"  {by}: {what}: {why}")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
