#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when a page of documentation names what is not there, and when a source names a place in a page that is not there.

Looked at, in every .md of the project:
- links and their anchors: `<a id="x">`, or a heading as GitHub spells it;
- files of the project in backticks and in commands: `tracks/oval.toml`, `race/pilot.cpp`, `config_keys.cpp`;
- commands: `gatefly campaign oval --runs 40`; the command, its flags, its experiments, tracks, configurations;
- keys: `camera.tilt_deg`, `detector.mode = "paper"`, `--set sim.timeout_s=10`;
- names of code in docs/paper and in the pages beside the code: `Pilot::step`, `map_pose`, `kMisfit`;
- tests by name: `Pilot.AllocatesNothingOnceBuilt`.
And `docs/page.md#place` in the comments of sources and configurations.

usage: check_docs.py [ROOT]"""
import functools
import os
import pathlib
import re
import shlex
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
IGNORED = {".git", "build", "out", "shared", "node_modules"}
SOURCES = {".hpp", ".cpp", ".h", ".py", ".sh"}
LIKE_SOURCES = SOURCES | {".toml", ".txt", ".cmake", ".in"}
# Of a file that is named alone: these are ours wherever they are, others (camera.toml, found.csv) may be the reader's.
OURS_BY_SUFFIX = {".hpp", ".cpp", ".sh"}
WORD = re.compile(r"[A-Za-z_]\w*")
NAME = re.compile(r"[A-Za-z_]\w*(::~?\w+)*(\(\))?$")
TEST = re.compile(r"[A-Z]\w+\.(?:[A-Z]\w+(?:…)?|\*)$")
# What a page may say that is no name of ours: functions of other programs, a label of the paper, pictures of a set.
FOREIGN = re.compile(r"solvePnP|solveP3P|rgb2ycbcr|euclid|img_\d+$")


def tree():
    """Every file of the project, by its path from the root. What is built, and hidden folders, are left out."""
    found = []
    for top in sorted(ROOT.iterdir()):
        if top.name in IGNORED or top.name.startswith("."):
            continue
        if not top.is_dir():
            found.append(pathlib.PurePosixPath(top.name))
            continue
        for folder, below, files in os.walk(top):
            below[:] = sorted(name for name in below if name not in IGNORED and not name.startswith((".", "__")))
            found += [pathlib.PurePosixPath(pathlib.Path(folder, name).relative_to(ROOT)) for name in sorted(files)]
    return found


FILES = tree()
FOLDERS = {str(folder) for file in FILES for folder in file.parents}
PATHS = {str(file) for file in FILES} | FOLDERS
NAMES = {file.name for file in FILES} | {pathlib.PurePosixPath(folder).name for folder in FOLDERS}
HOUSES = [pathlib.PurePosixPath("src") / house for house in ("flight", "workshop", "simulator", "studies")]
TOP = {path for path in PATHS if "/" not in path and path != "."}


@functools.cache
def text_of(path):
    return (ROOT / path).read_text(errors="replace")


def without_comments(text):
    return re.sub(r"//[^\n]*", "", text)


@functools.cache
def code():
    """All C++, without comments; texts count, for keys, columns and experiments stand there."""
    return "\n".join(without_comments(text_of(file)) for file in FILES if file.suffix in {".hpp", ".cpp"})


@functools.cache
def words():
    """Everything that is a word somewhere: in code, scripts, CMake, tracks and configurations, and as a file's name."""
    others = [text_of(file) for file in FILES
              if file.suffix in LIKE_SOURCES - {".hpp", ".cpp"} and (file.parts[0] != "tests" or file.suffix != ".py")]
    stems = {file.stem for file in FILES} | {file.parent.name for file in FILES}
    return set(WORD.findall(code())) | set(WORD.findall("\n".join(others))) | stems


# Pages ---------------------------------------------------------------------------------------------------------------


def fenced(lines):
    """(line, is it a block of commands, is it a block of code) of each line."""
    fence, before_blank, in_list = None, True, False
    for line in lines:
        bare = line.strip()
        if bare.startswith("```"):
            language = bare[3:].strip()
            fence = None if fence is not None else language
            yield line, False, True
            continue
        if fence is not None:
            yield line, fence in {"sh", "bash", "console"}, True
            continue
        in_list = bool(re.match(r"\s*([-*]|\d+\.) ", line)) or (in_list and line.startswith("  "))
        indented = line.startswith("    ") and not in_list and (before_blank is True or before_blank == "code")
        yield line, indented, indented
        before_blank = "code" if indented else not bare


@functools.cache
def places(page):
    """The anchors of a page."""
    found, seen = set(), {}
    for line, _, is_code in fenced(text_of(page).splitlines()):
        if is_code:
            continue
        found |= set(re.findall(r'<a id="([^"]+)"', line))
        if heading := re.match(r"#+ (.*)", line):
            said = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).replace("`", "").strip().lower()
            slug = re.sub(r"[^\w\- ]", "", said).replace(" ", "-")
            count = seen.get(slug, 0)
            seen[slug] = count + 1
            found.add(f"{slug}-{count}" if count else slug)
    return found


def resolved(start, path):
    """`path` seen from the folder `start`, from the root; None when it leads out of the project."""
    parts = []
    for part in [*(start.parts if str(start) != "." else ()), *pathlib.PurePosixPath(path).parts]:
        if part == "..":
            if not parts:
                return None
            parts.pop()
        elif part != ".":
            parts.append(part)
    return "/".join(parts) or "."


def link_errors(page, line):
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "``", line)):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        there = str(page) if not path else resolved(page.parent, path)
        if there is None or there not in PATHS:
            yield f"link {target} leads nowhere"
        elif anchor and anchor not in places(pathlib.PurePosixPath(there)):
            yield f"link {target}: {there} has no place #{anchor}"


# Files ---------------------------------------------------------------------------------------------------------------


def exists(path, page):
    """A path of the project, as somebody on `page` would write it: from the root, from the page, from its house, as an include."""
    path = path.rstrip("/")
    starts = [pathlib.PurePosixPath("."), page.parent, *HOUSES, *(house / "gatefly" for house in HOUSES)]
    for start in starts:
        there = resolved(start, path)
        if there in PATHS:
            return True
        if there and "*" in there and any(pathlib.PurePosixPath(each).match(there) for each in PATHS):
            return True
        # `race/plan` is its header and source
        if there and "." not in path and any(each.startswith(there + ".") for each in PATHS):
            return True
    return False


def is_ours(path, page):
    """Whether a path means a file of the project at all."""
    first = path.split("/")[0]
    if not re.fullmatch(r"[\w.*/+-]+", path) or path.startswith(("/", "..", "-")) or first in IGNORED or "//" in path:
        return False
    suffix = pathlib.PurePosixPath(path).suffix
    if "/" not in path:
        return suffix in OURS_BY_SUFFIX
    beside = {pathlib.PurePosixPath(folder).name for folder in FOLDERS
              if str(pathlib.PurePosixPath(folder).parent) in {str(page.parent), *(str(house / "gatefly") for house in HOUSES)}}
    return first in TOP | beside or suffix in SOURCES


def file_errors(page, token):
    path = token.strip(".,;:()\"'").removeprefix("./")
    if not path or not is_ours(path, page):
        return
    if "/" in path:
        if not exists(path, page):
            yield f"there is no file {path}"
    elif "*" not in path and path not in NAMES:
        yield f"there is no file called {path}"


# Commands ------------------------------------------------------------------------------------------------------------


@functools.cache
def commands():
    """Each command's flags. Those of files that several commands share belong to all."""
    main = text_of(pathlib.PurePosixPath("apps/gatefly/main.cpp"))
    names = re.findall(r'Listed\{"([\w-]+)"', main)
    flags, shared = {name: {"--help"} for name in names}, {"-h", "-q", "--quiet"}
    for file in FILES:
        if file.parts[:2] != ("apps", "gatefly") or file.suffix != ".cpp":
            continue
        said = set(re.findall(r'"(--[a-z][a-z-]*)', text_of(file)))
        for spelled in re.findall(r'"((?:-\w,)?--[a-z][a-z,-]*)"', text_of(file)):
            said |= set(spelled.split(","))
        owner = file.stem.removesuffix("_command").replace("_", "-")
        if owner in flags:
            flags[owner] |= said
        else:
            shared |= said
    for name in names:
        flags[name] |= shared
    script = text_of(pathlib.PurePosixPath("gatefly")) if "gatefly" in PATHS else ""
    flags |= {"help": {"--man"}, "version": set(), "package": set(), "test": set(re.findall(r"--[a-z-]+", script))}
    return flags


@functools.cache
def experiments():
    listed = text_of(pathlib.PurePosixPath("src/studies/gatefly/experiments/experiment.cpp"))
    return set(re.findall(r'\{"([\w-]+)",\s*"', listed))


@functools.cache
def keys():
    """{key: its choices, or None}."""
    found = {}
    for file in FILES:
        if file.parts[:4] != ("src", "workshop", "gatefly", "config") or file.suffix != ".cpp":
            continue
        text = without_comments(text_of(file))
        for choice in re.finditer(r'choice<\w+>\(\s*"([a-z]+\.\w+)",\s*\{([^}]*)\}', text):
            found[choice[1]] = set(re.findall(r'"([^"]*)"', choice[2]))
        for key in re.findall(r'"([a-z]+\.\w+)"', text):
            found.setdefault(key, None)
        if file.stem == "randomize_keys":
            for key in re.findall(r'sigma\(\s*"(\w+)"', text):
                found["randomize." + key] = None
            level = re.search(r'randomize\.level".*?choices = \{([^}]*)\}', text, re.S)
            found["randomize.level"] = set(re.findall(r'"([^"]*)"', level[1])) if level else None
        if file.stem == "track_keys":
            for section, key in re.findall(r'\{"(room|start)", "(\w+)"', text):
                found.setdefault(f"{section}.{key}", None)
    return found


@functools.cache
def old_keys():
    """{old name: name} of keys that were renamed; the old name still works, but belongs into the changelog only."""
    found = re.findall(r'\{"([a-z]+\.\w+)",\s*"([a-z]+\.\w+)"\}', text_of(pathlib.PurePosixPath("src/workshop/gatefly/config/config.cpp")))
    return {old: new for old, new in found if old != new}


def key_errors(said):
    """`camera.tilt_deg`, `camera.tilt_deg=20`, `detector.mode = "paper"`."""
    match = re.match(r'([a-z]+)\.([a-z]\w*)\s*(?:=\s*"?([^"]*)"?)?$', said)
    if not match or match[1] not in {key.split(".")[0] for key in keys()}:
        return
    key = f"{match[1]}.{match[2]}"
    if f".{match[2]}" in LIKE_SOURCES | {".md", ".csv", ".json", ".png", ".yaml", ".jpg", ".npy"}:
        return
    if key in old_keys():
        yield f"{key} is the old name of {old_keys()[key]}"
    elif key not in keys():
        yield f"there is no key {key}"
    elif match[3] and keys()[key] and match[3] not in keys()[key]:
        yield f"{key} is never {match[3]}"


def is_placeholder(word):
    return bool(re.fullmatch(r"[A-Z][A-Z0-9_.]*|\.\.\.|…|<.*>", word))


def positional_errors(command, word, page):
    if is_placeholder(word):
        return
    if command == "reproduce" and word not in experiments():
        yield f"there is no experiment {word}"
    if command in {"fly", "campaign", "track"} and not word.endswith(".toml") and f"tracks/{word}.toml" not in PATHS:
        yield f"there is no track {word}"
    if command == "help" and word not in commands():
        yield f"there is no command {word}"
    yield from file_errors(page, word)


def words_of(line):
    """A command line as words, without its comment and what comes behind a pipe."""
    line = re.sub(r"\s#\s.*$|\s+#$", "", line)
    line = re.split(r"\s[|>&]+\s|;\s", line)[0]
    try:
        return shlex.split(line)
    except ValueError:
        return line.split()


def command_errors(line, page):
    """`line` begins with a command's name: campaign oval --runs 40."""
    command, *rest = words_of(line)
    if command in {"--version", "--help"}:
        return
    if command not in commands():
        if not is_placeholder(command):
            yield f"there is no command gatefly {command}"
        return
    before = ""
    for word in rest:
        flag = word.split("=")[0]
        if word.startswith("-") and word != "-" and not re.match(r"-[\d.]", word):
            if flag not in commands()[command]:
                yield f"gatefly {command} has no {flag}"
        elif before == "--set":
            yield from key_errors(word)
        elif before == "--config":
            if not word.endswith(".toml") and not is_placeholder(word) and f"configs/{word}.toml" not in PATHS:
                yield f"there is no configuration {word}"
            yield from file_errors(page, word)
        elif not before.startswith("--") or command in {"reproduce"} and before in {"--quick", "--json"}:
            yield from positional_errors(command, word, page)
        else:
            yield from file_errors(page, word)
        before = word


def command_in(said):
    """What comes after "gatefly", or all of it when a command of ours comes first and more behind it."""
    for start in ("./gatefly ", "gatefly ", "build/release/apps/gatefly/gatefly "):
        if said.startswith(start):
            return said.removeprefix(start)
    first, _, rest = said.partition(" ")
    return said if first in commands() and rest and re.match(r"(--|[a-z-]+( |$)|[A-Z]+( |$))", rest) else None


# Names of code -------------------------------------------------------------------------------------------------------


def has_member(scope, last):
    return re.search(rf"\b(struct|class|enum|enum class|namespace|union)\s+{scope}\b", code()) and re.search(rf"\b{last}\b", code())


def name_errors(said):
    if not NAME.match(said) or FOREIGN.match(said):
        return
    parts = said.removesuffix("()").split("::")
    for part in parts:
        if part.strip("~") not in words():
            yield f"{said} is nowhere in the sources"
            return
    if len(parts) > 1 and parts[-2] not in {"std", "cv", "sim", "io"} and not has_member(parts[-2], parts[-1]):
        yield f"{said} is nowhere in the sources"


@functools.cache
def tests():
    return set(re.findall(r"\bTEST(?:_[PF])?\(\s*(\w+),\s*(\w+)\s*\)", code()))


def test_errors(said):
    suite, _, name = said.partition(".")
    mine = [each for of, each in tests() if of == suite or of.removesuffix("Test") == suite]
    if not any(name in {"*", each} or name.endswith("…") and each.startswith(name[:-1]) for each in mine):
        yield f"there is no test {said}"


@functools.cache
def command_line_tests():
    return [name for file in FILES if file.parts[0] == "tests" and file.suffix == ".py"
            for name in re.findall(r"def test_(\w+)", text_of(file))]


def table_errors(page):
    """In tables with a column "test": the tests of the command line are named there without backticks, shortened."""
    column = None
    for number, line in enumerate(text_of(page).splitlines(), 1):
        cells = [cell.strip() for cell in line.strip("|").split(" | ")] if line.startswith("|") else []
        if "test" in cells:
            column = cells.index("test")
        elif not cells:
            column = None
        elif column is not None and column < len(cells):
            for name in re.findall(r"\b[a-z]+(?:_[a-z]+)+\b", re.sub(r"`[^`]*`", "", cells[column])):
                if not any(name in each for each in command_line_tests()):
                    yield number, f"there is no test {name}"


# All of it -----------------------------------------------------------------------------------------------------------


def wants_names(page):
    return page.parts[:2] == ("docs", "paper") or page.parts[:1] == ("src",) or page.name in {"README.md", "CONTRIBUTING.md"}


def span_errors(page, said):
    """What stands between two backticks."""
    command = command_in(said)
    if command is not None:
        yield from command_errors(command, page)
        return
    if page.name != "CHANGELOG.md":
        yield from key_errors(said)
    if TEST.match(said):
        yield from test_errors(said)
        return
    for token in said.split():
        yield from file_errors(page, token)
        if token.startswith("--") and re.fullmatch(r"--[a-z][a-z-]*", token) and said.startswith("--"):
            if not any(token in flags for flags in commands().values()):
                yield f"no command has {token}"
    if said.startswith("--set "):
        yield from key_errors(said.split()[1])
    if wants_names(page) and re.search(r"[a-z]", said) and not is_ours(said, page):
        yield from name_errors(said)


def spans_across_lines(text):
    """(line number, span) of everything in backticks; a span may go over the end of a line."""
    lines = list(fenced(text.splitlines()))
    kept = "\n".join("" if is_code else line for line, _, is_code in lines)
    for match in re.finditer(r"(?<!`)`([^`]+)`(?!`)", kept):
        if "\n\n" not in match[1]:
            yield kept.count("\n", 0, match.start()) + 1, " ".join(match[1].split())


def page_errors(page):
    text = text_of(page)
    continued, started = "", 0
    for number, (line, is_command, is_code) in enumerate(fenced(text.splitlines()), 1):
        if not is_code:
            for error in link_errors(page, line):
                yield number, error
        if not is_command:
            continue
        continued, started = (continued + " " + line.strip(), started) if continued else (line.strip(), number)
        if continued.endswith("\\"):
            continued = continued[:-1].strip()
            continue
        said, continued = continued, ""
        command = command_in(said) if said.startswith(("gatefly", "./gatefly", "build/")) else None
        if command is not None:
            for error in command_errors(command, page):
                yield started, error
        else:
            for token in said.split(" # ")[0].split():
                for error in file_errors(page, token):
                    yield started, error
    yield from table_errors(page)
    for number, said in spans_across_lines(text):
        for error in span_errors(page, said):
            yield number, error


def reference_errors(file):
    """docs/paper/deviations.md#eq-31, deviations.md#eq-31, simulation.md in a source."""
    pages = {each for each in PATHS if each.endswith(".md")}
    for number, line in enumerate(text_of(file).splitlines(), 1):
        for match in re.finditer(r"(?<![\w/.-])((?:\.\./)*(?:[\w-]+/)*([\w-]+\.md))(?:#([\w-]+))?", line):
            said, name, anchor = match.groups()
            if file.suffix == ".py" and "tests" in file.parts:
                continue  # the tests of checks like this one write pages of their own
            said = re.sub(r"^(\.\./)+", "", said)
            there = [each for each in pages if each == said or ("/" not in said and each.endswith("/" + name))]
            if not there:
                yield number, f"there is no page {said}"
            elif anchor and not any(anchor in places(pathlib.PurePosixPath(each)) for each in there):
                yield number, f"{said} has no place #{anchor}"


def violations():
    for page in FILES:
        if page.suffix == ".md":
            for number, error in sorted(set(page_errors(page))):
                yield f"{page}:{number}: {error}"
        elif page.suffix in LIKE_SOURCES and page.name != "check_docs.py":
            for number, error in reference_errors(page):
                yield f"{page}:{number}: {error}"
    if not experiments() or not keys() or not commands():
        yield "neither experiments, keys nor commands were found where they are listed"


if __name__ == "__main__":
    errors = list(violations())
    print("\n".join(errors) or "docs: ok")
    sys.exit(bool(errors))
