#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whom functions of an x86-64 library can call outside of it, over every way through the code: no allocation, no lock, no system call, no exception
but those listed here, each with the reason why it does not happen in flight, or does no harm.

usage: check_calls.py FILE FUNCTION[,FUNCTION]... [PATTERN]...   e.g. check_calls.py build/release/c/libgatefly_c.so gatefly_step,gatefly_push_image paper

Reads the same calls as check_stack.py. What would hide whom it calls is refused: a call by pointer, one that is not understood, and a library that
looks its functions up when they are first called. Functions whose readable name has a PATTERN in it are left out, e.g. those of the paper's modes.
Exit 0: nothing but what is listed, and all that is listed."""
import re
import subprocess
import sys

import check_stack

# They calculate, or copy what they are given.
HARMLESS = {"memcpy", "memmove", "memset", "memcmp", "sqrt", "sqrtf", "frexp", "frexpf", "floor", "floorf", "ceil", "ceilf", "trunc", "round", "lround", "lroundf", "fmod", "fmodf"}

# They end in an exception: who calls them has to say why not.
THROWS = re.compile(r"^(?:std::__throw_\w+|Eigen::internal::throw_std_bad_alloc)\(")

RESERVED = "the list has had room for all since it was made"
GIVEN = "these kernels are given their memory: the matrices have a largest size and bring it with them; they take some where they are given none"
CACHE_SIZE = "it asks once how large the cache is, at the first update of its kind; nobody else does, so that the flag is never waited for"
HAS_VALUE = "a variant loses its value by an exception only, and none is thrown"
AT_THE_DOOR = "the C interface's own net, in which nothing should arrive"
KERNELS = r"Eigen::internal::(?:triangular_solve_matrix|triangular_solver_selector|general_matrix_matrix_triangular_product)<.*>::run"
# (who calls, whom, why it does no harm in flight): regular expressions of whole readable names up to their arguments; those of `whom` apart by |
EXPECTED = [
    (r"gatefly::GateDetector::list_gates", r"operator new|operator delete|std::__throw_length_error", RESERVED),
    (KERNELS, r"malloc|free|Eigen::internal::throw_std_bad_alloc", GIVEN),
    (KERNELS, r"__cxa_guard_acquire|__cxa_guard_release", CACHE_SIZE),
    (r"gatefly::(?:AnyCamera|ChosenLookout|ChosenGuidance)::\w+", r"std::__throw_bad_variant_access", HAS_VALUE),
    (r"gatefly::next_phase", r"__cxa_allocate_exception|__cxa_throw", HAS_VALUE),
    (r"gatefly_\w+", r"__cxa_begin_catch|__cxa_end_catch", AT_THE_DOOR),
]


def name_of(text):
    """Without arguments, and without the type that it returns."""
    plain = text.replace("(anonymous namespace)::", "")
    depth, begin = 0, 0
    for i, letter in enumerate(plain):
        depth += (letter == "<") - (letter == ">" and not plain[:i].endswith("-"))
        if depth == 0 and letter == " " and not plain[:i].endswith("operator"):
            begin = i + 1
        if depth == 0 and letter == "(" and i > begin:
            return plain[begin:i]
    return plain[begin:]


def calls_out(functions, starts):
    """What can be reached; pairs of one of them and one of elsewhere that it calls; those of which nobody can tell whom they call."""
    names = check_stack.readable(functions)
    outside = {name for name in functions if THROWS.match(names[name])}
    reached, to_do, out = set(starts), list(starts), set()
    while to_do:
        name = to_do.pop()
        for called in (each.removesuffix("@plt") for each in functions[name].calls):
            if called in reached:
                continue
            if called in functions and called not in outside:
                reached.add(called)
                to_do.append(called)
            else:
                out.add((name, called.partition("@")[0] or called))
    hidden = {name for name in reached if functions[name].by_pointer or functions[name].unclear}
    return reached, out, hidden


def judged(functions, starts, expected):
    """(what should not be, how many functions and calls were looked at)"""
    reached, out, hidden = calls_out(functions, starts)
    names = check_stack.readable({each for pair in out for each in pair} | hidden)
    wrong, met = [f"nobody can tell whom {names[each][:110]} calls" for each in sorted(hidden)], set()
    for caller, called in sorted(out):
        who, whom = name_of(names[caller]), name_of(names[called])
        if whom in HARMLESS:
            continue
        reasons = {(i, each) for i, (by, what, _) in enumerate(expected) for each in what.split("|") if re.fullmatch(by, who) and re.fullmatch(each, whom)}
        met |= reasons
        if not reasons:
            wrong.append(f"{who} calls {whom}")
    wrong += [f"listed, and called no more: {by} {each}" for i, (by, what, _) in enumerate(expected) for each in what.split("|") if (i, each) not in met]
    return wrong, len(reached), len(out)


def binds_at_once(path):
    flags = subprocess.run(["readelf", "-d", path], check=True, capture_output=True, text=True).stdout
    return bool(re.search(r"BIND_NOW|FLAGS_1.*\bNOW\b", flags))


def main(path, starts, *left_out):
    functions = check_stack.without(check_stack.read(path), left_out)
    starts = starts.split(",")
    for start in starts:
        if start not in functions:
            sys.exit(f"check_calls: {path} has no {start}")
    wrong, reached, out = judged(functions, starts, EXPECTED)
    if not binds_at_once(path):
        wrong.append("it looks its functions up when they are first called (-Wl,-z,now)")
    for each in wrong:
        print(f"calls: {each}")
    print(f"calls: {reached} functions from {', '.join(starts)} on, {out} calls of others; {len(wrong)} that should not be")
    for by, what, why in EXPECTED:
        print(f"  {by}: {what}: {why}")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
