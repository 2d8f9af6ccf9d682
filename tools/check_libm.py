#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when a source of the flight code calls a function of libm that tools/libm_allowed.txt does not list
for it, or no longer calls one that is listed: the list only gets shorter.

The last bit of exp, log, pow ... differs from one libm to the next; a flight that is replayed elsewhere must
come out the same. Write with geometry/math.hpp, or with +, -, *, / and sqrt, which are the same everywhere.

usage: check_libm.py NM LIST LIBRARY...    the libraries are libgatefly_<folder>.a, optimised (at -O0, x² is a call of pow)"""
import pathlib
import re
import subprocess
import sys

# Correctly rounded or without rounding, so free to use: sqrt fabs fmin fmax fmod remainder fma copysign floor
# ceil trunc round lround llround rint lrint nearbyint frexp ldexp scalbn modf ilogb logb nextafter.
BASE = ("sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp exp2 exp10 expm1 log log2 log10 log1p "
        "pow cbrt hypot erf erfc tgamma lgamma").split()
INEXACT = {name + suffix for name in [*BASE, "atan2", "sincos", "lgamma_r", *("c" + name for name in BASE), "cabs", "carg",
                                      "csqrt", "j0", "j1", "jn", "y0", "y1", "yn"] for suffix in ("", "f", "l")}
UNDEFINED = re.compile(r"libgatefly_(\w+)\.a\[(.+?)(?:\.o)?\]: (\w+) [Uw]")


def calls(nm_output):
    """{(folder/source, function)} of what `nm -A -P -u` printed."""
    return {(f"{folder}/{source}", function) for folder, source, function in UNDEFINED.findall(nm_output)
            if function in INEXACT}


def allowed(text):
    """{(folder/source, function)} of a list: a source and its functions on a line, # starts a comment."""
    lines = [line.split("#")[0].split() for line in text.splitlines()]
    return {(words[0], function) for words in lines if words for function in words[1:]}


def complaints(found, listed):
    for source, function in sorted(found - listed):
        yield f"{source} calls {function} of libm, whose last bit is not the same everywhere: see geometry/math.hpp"
    for source, function in sorted(listed - found):
        yield f"{source} calls {function} no more: take it off tools/libm_allowed.txt"


def main(nm, path, *libraries):
    output = subprocess.run([nm, "-A", "-P", "-u", *libraries], check=True, capture_output=True, text=True).stdout
    found = list(complaints(calls(output), allowed(pathlib.Path(path).read_text())))
    print("\n".join(found) or f"libm: ok, {len(libraries)} libraries")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
