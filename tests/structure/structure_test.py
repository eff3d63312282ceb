#!/usr/bin/env python3
"""Holds the tree to the house's rules: who may include whom, what public headers may show, and what
lib never does. Each failure names file and line. Standard library only."""
import functools
import os
import re
import subprocess
import sys
import unittest

TOP = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
LIB = os.path.join(TOP, "lib", "wellgyro")

STAGES = {"calibration", "noise", "alignment", "attitude", "estimate", "depth", "trajectory", "uncertainty"}
LOW = {"base", "math", "earth", "record"}
ALLOWED = {
    "base": set(),
    "math": {"base"},
    "earth": {"base", "math"},
    "record": {"base", "math", "earth"},
    "simulate": {"base", "math", "record"},
    "survey": LOW | STAGES,
    "plan": LOW | STAGES | {"survey"},
    "io": LOW | STAGES | {"survey", "plan", "simulate"},
    "fit": LOW | STAGES | {"survey"},
    "bus": LOW | STAGES | {"survey"},
    "page": LOW | STAGES | {"survey", "io"},
    "live": LOW | STAGES | {"survey", "plan", "io", "bus"},
}
ALLOWED.update({stage: set(LOW) for stage in STAGES})

# The rooms of io/ and of survey/, and what each sees of the others. Those of io/ stand on the sources
# of io/ itself; the services of survey/ stand on its rooms, which see of it only SURVEY_SHOWS.
ROOMS_OF = {
    "io": {
        "": set(),
        "plot": set(),
        "exchange": set(),
        "toml": {"exchange"},
        "sensor": {"exchange"},
        "result": {"exchange", "plot", "toml"},
    },
    "survey": {
        "hole": set(),
        "stations": {"hole"},
        "verdict": {"hole", "stations"},
        "intake": {"stations", "verdict"},
        "run": {"hole", "stations", "verdict", "intake"},
        "wells": {"hole", "verdict"},
        "": {"hole", "stations", "verdict", "intake", "run", "wells"},
    },
}
SURVEY_SHOWS = {"job.h", "job_rules.h", "survey.h", "surveyor.h"}

STD = set("""algorithm array atomic bit cassert cctype cerrno cfloat charconv cinttypes climits cmath
compare complex condition_variable concepts csignal cstddef cstdint cstdio cstdlib cstring deque
exception filesystem fstream functional initializer_list iomanip iosfwd iterator istream limits list
locale map memory mutex new numbers numeric optional ostream queue random ratio regex set span sstream
stack stdexcept streambuf string string_view system_error thread tuple type_traits unordered_map
unordered_set utility valarray variant vector version""".split())

BANS = [
    (r"\b(system_clock|steady_clock|high_resolution_clock)\b|\bclock_gettime\b|\bgettimeofday\b"
     r"|\bstd::time\s*\(|[^_\w.>:]time\s*\(\s*(NULL|nullptr|0)\s*\)", "reads a clock"),
    (r"\brandom_device\b|[^_\w]s?rand\s*\(|\bdrand48\b", "reads a random device"),
    (r"\b(secure_)?getenv\b", "reads the environment"),
    (r"\bM_PI\b", "M_PI: use wellgyro/base/angle.h"),
    (r"\busing namespace\b", "using namespace"),
    (r"^\s*#\s*define\s+(?!WELLGYRO_EXPORT\b)", "defines a macro"),
    (r"TODO|FIXME|XXX", "unfinished"),
]


def Sources(folder, endings=(".h", ".cpp")):
    for where, _, names in os.walk(folder):
        for name in sorted(names):
            if name.endswith(endings):
                yield os.path.join(where, name)


@functools.lru_cache(maxsize=None)
def Lines(path):
    with open(path, encoding="utf-8") as file:
        return file.read().splitlines()


@functools.lru_cache(maxsize=None)
def Code(path):
    """Numbered lines without comments and string contents."""
    numbered = []
    text = "\n".join(Lines(path))
    text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m.group().count("\n"), text, flags=re.S)
    for number, line in enumerate(text.split("\n"), 1):
        if not line.lstrip().startswith("#include"):
            line = re.sub(r'"(\\.|[^"\\])*"', '""', line)
        numbered.append((number, re.sub(r"//.*", "", line)))
    return numbered


def Includes(path):
    for number, line in Code(path):
        found = re.match(r'\s*#\s*include\s+([<"])([^>"]+)[>"]', line)
        if found:
            yield number, found.group(1), found.group(2)


def Functions(path):
    """First line and length of every function that has a body; lambdas count as their owner's."""
    text = re.sub(r"'(\\.|[^'\\])'", "' '", "\n".join(line for _, line in Code(path)))
    found, open_braces, head, begin, number = [], [], "", 1, 1
    for c in text:
        if c == "\n":
            number += 1
        if c == "{":
            inside = any(is_function for is_function, _ in open_braces)
            named = re.search(r"\b(class|struct|union|enum|namespace)\b", head)
            method = re.search(r"\)\s*((const|noexcept|override|final)\s*)*$", head)
            value = re.search(r"=\s*(\[.*)?$", head, re.S)
            open_braces.append((not inside and "(" in head and not value
                                and (not named or method is not None), begin))
            head = ""
        elif c == "}":
            if open_braces:
                is_function, first = open_braces.pop()
                if is_function:
                    found.append((first, number - first + 1))
            head = ""
        elif c == ";":
            head = ""
        else:
            if not head.strip() and not c.isspace():
                begin = number
            head += c
    return found


def Unnamed(path):
    """Line, name and kind of what stands in a source's unnamed namespace. A function's kind is its
    parameters' types in brackets, an alias's what it stands for."""
    text = re.sub(r"'(\\.|[^'\\])'", "' '", "\n".join(line for _, line in Code(path)))
    text = re.sub(r"^\s*#.*", "", text, flags=re.M)
    found, scopes, head, begin, number = [], [], "", 1, 1

    def Take():
        code = re.sub(r"^template <.*?> (?=\w)|\[\[.*?\]\]", "", " ".join(head.split())).strip()
        defined = re.match(r"(?:struct|class|enum class|enum|union) (\w+)", code)
        alias = re.match(r"using (\w+) = (.*)", code)
        function = re.match(r"[^=(]*?([\w:]+)\((.*)\)", code)
        value = re.match(r"[^=({]*?([A-Za-z_]\w*)(?:\[.*?\])*(?: = .*|)$", code)
        if defined:
            found.append((begin, defined.group(1), "type"))
        elif alias:
            found.append((begin, alias.group(1), f"alias {alias.group(2)}"))
        elif function and "::" not in function.group(1) and "=" not in code.split("(")[0]:
            types = re.sub(r" = [^,]*|(?<=[\w>&*]) ?\b\w+(?=,|$)", "", function.group(2))
            found.append((begin, function.group(1), f"({types})"))
        elif value and not code.startswith(("using ", "namespace ")):
            found.append((begin, value.group(1), "value"))

    for c in text:
        if c == "\n":
            number += 1
        if c not in "{};":
            begin = number if not head.strip() and not c.isspace() else begin
            head += c
            continue
        here = "unnamed" in scopes and "inside" not in scopes
        name = re.search(r"\bnamespace( [\w:]+)?\s*$", head)
        if here and head.strip() and c != "}" and not name:
            Take()
        if c == "{":
            scopes.append(("named" if name.group(1) else "unnamed") if name else "inside")
        elif c == "}" and scopes:
            scopes.pop()
        head = ""
    return found


def PublicHeaders():
    """Of lib/public-headers.txt, as included: "wellgyro/base/angle.h" and so on."""
    rows = [line.split() for line in Lines(os.path.join(TOP, "lib", "public-headers.txt"))
            if line and not line.startswith("#")]
    return [f"wellgyro/{header}" for _, header in rows]


# Frames of the conventions in README.md, and of single blocks of sensors.
FRAMES = "IEWLTHGASMB"
ROTATION = r"R_([A-Z])([A-Z])(?:_[a-z]\w*)?(\.transpose\(\)|\.inverse\(\))?"
VECTOR = rf"[a-z]\w*_([{FRAMES}])_?"
PRODUCT = re.compile(rf"\b{ROTATION} \* (?=(?:\w+(?:\.|->))*(?:{ROTATION}|{VECTOR})(?!\w))")

# Three numbers that may be a vector in space, and nine that may turn one.
THREE = r"Vector3[df]|Matrix<(?:double|float), 3, 1\b[^<>]*>|array<(?:double|float), 3>"
NINE = r"Matrix3[df]|Matrix<(?:double|float), 3, 3\b[^<>]*>|Quaternion[df]|AngleAxis[df]"

# Words in names of three numbers that are no vector in space, and of covariances of none.
NO_VECTOR = {
    "bias": "one of each sensor",
    "scale": "one of each sensor",
    "raw": "one reading of each sensor",
    "sigma": "one along each axis",
    "var": "one along each axis",
    "square": "one along each axis",
    "attitude": "inclination, azimuth and toolface",
    "inc": "depth, inclination and azimuth",
}
# And of nine that are no rotation.
NO_ROTATION = {
    "sensitivity": "a row of each sensor",
    "misalignment": "a row of each sensor",
}


def Types(code):
    """What a type is by its name: of three numbers in group 1, of nine in 2, of one in 3. An alias
    is what it stands for, or holds, whichever header has it."""
    three, nine, known = [THREE], [NINE], 0
    while known < len(three) + len(nine):
        known = len(three) + len(nine)
        for types in (three, nine):
            alias = rf"\busing (\w+) = [^;(]*?\b(?:{'|'.join(types)})(?!\w)[^;(]*;"
            types[1:] = sorted({*types[1:], *re.findall(alias, code)})
    return rf"\b(?:({'|'.join(three)})|({'|'.join(nine)})|(double|float))(?!\w)"


def Triples(text, types):
    """Where, name and whether nine of what is declared to be three or nine numbers, or several such:
    variables, members, parameters and accessors."""
    for kind in re.finditer(types + r"(?:[>&*]|, [\w:<]+)*\s+(?=[A-Za-z])", text):
        depth, pieces, begin = 0, [], kind.end()
        for mark in re.compile(r"[][(){},;]").finditer(text, kind.end()):
            at = mark.start()
            depth += (mark.group() in "([{") - (mark.group() in ")]}")
            if depth < 0 or (depth == 0 and mark.group() in ",;"):
                pieces.append((begin, text[begin:at]))
                begin = at + 1
            if depth < 0 or (depth == 0 and mark.group() == ";"):
                break
        for begin, piece in pieces[:1] if depth < 0 else pieces:  # what follows has its own type
            declared = re.match(r"\s*(\w+)((?:\[\w+\])*)\s*(?:[={].*)?$", piece, re.S)
            if not declared:
                accessor = re.match(r"(R(?:_\w+)?|[a-z]\w*)\(", piece)
                if accessor and not kind.group(3):
                    yield begin, accessor.group(1), bool(kind.group(2))
                break  # of a function, or of the next parameter
            name, sizes = declared.groups()
            if not kind.group(3) or sizes in ("[3]", "[3][3]"):
                yield begin + declared.start(1), name, bool(kind.group(2)) or sizes == "[3][3]"


def Frameless(path):
    """Lines of paragraphs whose comment says "any frame" (of what holds in each) or "no frame" (of
    rows, and of what is not right-handed)."""
    free, begin = set(), 0
    for end, line in enumerate(Lines(path) + [""]):
        if not line.strip():
            said = " ".join(line.strip(" /") for line in Lines(path)[begin:end])
            if re.search(r"\b(any|no) frame\b", said):
                free.update(range(begin + 1, end + 1))
            begin = end + 1
    return free


def Misnamed(name, nine):
    """Why the name does not say the frame; what excuses it, if any."""
    words = set(name.strip("_").split("_"))
    ends = re.search(rf"_[{FRAMES}]_?$", name)
    if nine and not re.match("covs?_", name):
        if re.fullmatch(rf"R_[{FRAMES}]{{2}}(_[a-z]\w*)?_?", name) or ("by" in words and ends):
            return None, set()
        return "is no R_AB, cov_ or derivative x_by_y_A", words & NO_ROTATION.keys()
    return (None if ends else "does not end in its frame"), words & NO_VECTOR.keys()


def Room(path):
    return os.path.relpath(path, LIB).split(os.sep)[0]


def RoomWithin(path):
    """Of "io/exchange/las.h" "exchange", of "io/words.h" ""."""
    return (path.split("/") + [""])[1] if path.count("/") > 1 else ""


def Place(path, number):
    return f"{os.path.relpath(path, TOP)}:{number}"


class Structure(unittest.TestCase):
    def Report(self, problems):
        self.assertFalse(problems, "\n" + "\n".join(problems))

    def test_rooms_include_only_along_the_arrows(self):
        problems = []
        for path in Sources(LIB):
            room = Room(path)
            for number, _, target in Includes(path):
                found = re.match(r"wellgyro/(\w+)/", target)
                if found and found.group(1) != room and found.group(1) not in ALLOWED[room]:
                    problems.append(f"{Place(path, number)}: {room} may not include {target}")
        self.Report(problems)

    def test_rooms_within_include_only_along_the_arrows(self):
        problems = []
        for top, allowed in ROOMS_OF.items():
            for path in Sources(os.path.join(LIB, top)):
                room = RoomWithin(os.path.relpath(path, LIB))
                for number, _, target in Includes(path):
                    if not target.startswith(f"wellgyro/{top}/"):
                        continue
                    other = RoomWithin(target.removeprefix("wellgyro/"))
                    hidden = (top == "survey" and room and not other
                              and os.path.basename(target) not in SURVEY_SHOWS)
                    if hidden or (other and other not in allowed[room] | {room}):
                        problems.append(f"{Place(path, number)}: {top}/{room} may not include "
                                        f"{target}")
        self.Report(problems)

    def test_every_room_is_known(self):
        def Rooms(top):
            return {d for d in os.listdir(top) if os.path.isdir(os.path.join(top, d))}

        self.assertFalse(Rooms(LIB) - set(ALLOWED))
        for top, allowed in ROOMS_OF.items():
            self.assertFalse(Rooms(os.path.join(LIB, top)) - set(allowed))

    def test_public_headers_show_only_std_eigen_and_ours(self):
        problems = []
        for path in Sources(LIB, (".h",)):
            if path.endswith("_internal.h"):
                continue
            for number, kind, target in Includes(path):
                ours = kind == '"' and target.startswith("wellgyro/")
                eigen = kind == "<" and target.startswith("Eigen/")
                if not (ours or eigen or (kind == "<" and target in STD)):
                    problems.append(f"{Place(path, number)}: a header may not include {target}")
        self.Report(problems)

    def test_public_headers_stand_on_public_headers(self):
        public, problems = PublicHeaders(), []
        self.assertEqual(len(set(public)), len(public))
        for header in public:
            path = os.path.join(TOP, "lib", header)
            if not os.path.isfile(path):
                problems.append(f"public-headers.txt: there is no {header}")
                continue
            for number, kind, target in Includes(path):
                if kind == '"' and target not in public:
                    problems.append(f"{Place(path, number)}: {target} is not public")
        self.Report(problems)

    def test_internal_headers_stay_inside(self):
        problems = []
        for path in Sources(LIB, (".h",)):
            for number, _, target in Includes(path):
                if target.endswith("_internal.h") and not path.endswith("_internal.h"):
                    problems.append(f"{Place(path, number)}: shows {target}")
        self.Report(problems)

    def test_lib_keeps_the_bans(self):
        problems = []
        for path in Sources(LIB):
            for number, line in Code(path):
                for pattern, why in BANS:
                    if re.search(pattern, line):
                        problems.append(f"{Place(path, number)}: {why}")
        self.Report(problems)

    def test_third_parties_stay_in_their_rooms(self):
        homes = {"ceres/": {"fit"}, "lcm/": {"bus"}, "GeographicLib/": {"earth"},
                 "toml++/": {"io"}, "pugixml": {"io"}, "openssl/": {"io"}}
        problems = []
        for path in Sources(LIB):
            for number, kind, target in Includes(path):
                for start, rooms in homes.items():
                    if kind == "<" and target.startswith(start) and Room(path) not in rooms:
                        problems.append(f"{Place(path, number)}: {target} belongs to {rooms}")
        self.Report(problems)

    def test_posix_only_in_bus_and_one_file_of_io(self):
        posix = re.compile(r"^(unistd\.h|fcntl\.h|poll\.h|pthread\.h|sys/.*|netinet/.*|arpa/.*)$")
        io_files, problems = set(), []
        for path in Sources(LIB):
            for number, _, target in Includes(path):
                if not posix.match(target):
                    continue
                if Room(path) == "io":
                    io_files.add(os.path.relpath(path, TOP))
                elif Room(path) != "bus":
                    problems.append(f"{Place(path, number)}: POSIX outside bus/")
        if len(io_files) > 1:
            problems.append(f"POSIX in more than one file of io/: {sorted(io_files)}")
        self.Report(problems)

    def test_headers_are_small(self):
        problems, sizes = [], []
        for path in [path for top in (LIB, os.path.join(TOP, "apps"), os.path.join(TOP, "tests"))
                     for path in Sources(top, (".h",))]:
            lines = Lines(path)
            if path.startswith(LIB):
                sizes.append(len(lines))
            if len(lines) > 300:
                problems.append(f"{os.path.relpath(path, TOP)}: {len(lines)} lines, 300 is the stop")
            if "#pragma once" not in lines:
                problems.append(f"{os.path.relpath(path, TOP)}: no #pragma once")
        self.Report(problems)
        self.assertLessEqual(sorted(sizes)[len(sizes) // 2], 110, "median length of a header")

    def test_functions_of_headers_and_of_the_program_stay_short(self):
        def Lengths(top, endings):
            return sorted(length for path in Sources(os.path.join(TOP, top), endings)
                          for _, length in Functions(path))

        self.assertLessEqual(Lengths("lib", (".h",))[-1], 18, "the longest function of a header")
        program = Lengths("apps", (".h", ".cpp"))
        self.assertGreater(len(program), 300)
        self.assertLessEqual(program[int(0.9 * len(program))], 23, "nine tenths of the program's")

    def test_functions_and_sources_are_short(self):
        problems, lengths = [], []
        for path in [path for top in ("lib", "apps", "tests")
                     for path in Sources(os.path.join(TOP, top))]:
            if len(Lines(path)) >= 500:
                problems.append(f"{os.path.relpath(path, TOP)}: {len(Lines(path))} lines")
            for number, length in Functions(path):
                if not os.path.relpath(path, TOP).startswith("tests"):
                    lengths.append(length)
                if length > 60:
                    problems.append(f"{Place(path, number)}: a function of {length} lines")
        self.Report(problems)
        self.assertGreater(len(lengths), 1000)
        short = sum(length <= 40 for length in lengths) / len(lengths)
        self.assertGreaterEqual(short, 0.95, "share of functions of at most 40 lines")
        print(f"{len(lengths)} functions, {100 * short:.1f} % of at most 40 lines, "
              f"the longest of {max(lengths)}")

    def test_an_unnamed_namespace_shares_no_name_with_another_of_its_room(self):
        def Collide(one, other):
            if one[0] == other[0] == "(":  # functions of one name may differ in their parameters
                return one == other
            return not (one == other and one.startswith("alias"))

        problems, rooms, count = [], {}, 0
        for path in (p for top in (LIB, os.path.join(TOP, "apps")) for p in Sources(top, (".cpp",))):
            namespace = re.findall(r"^namespace (.*) {", "\n".join(Lines(path)), re.M)[0]
            for number, name, kind in Unnamed(path):
                count += 1
                known = rooms.setdefault((os.path.dirname(path), namespace, name), [])
                for other, there in known:
                    if other != path and Collide(kind, there):
                        problems.append(f"{Place(path, number)}: {name} is also "
                                        f"{os.path.basename(other)}'s; say in the name what it is of")
                        break
                known.append((path, kind))
        self.Report(problems)
        self.assertGreater(count, 2000)

    def test_a_type_is_defined_once(self):
        """Two types of one name in one namespace break the one-definition rule across sources that
        never see each other: the linker takes the members of either for both, and no one says so."""
        problems, types = [], {}
        for path in (p for top in (LIB, os.path.join(TOP, "apps")) for p in Sources(top)):
            scopes = []
            for number, line in enumerate(Lines(path), 1):
                opened = re.match(r"(?:inline )?namespace ?([\w:]*) \{", line)
                named = re.match(r"(?:struct|class|union|enum class|enum) (?:WELLGYRO_EXPORT )?(\w+)"
                                 r"(?: final)?(?: : [^;]*)? \{", line)
                if opened:
                    scopes.append(opened.group(1) or path)
                elif line.startswith("}  // namespace"):
                    scopes.pop()
                elif named:
                    known = types.setdefault(("::".join(scopes), named.group(1)), path)
                    if known != path:
                        problems.append(f"{Place(path, number)}: {named.group(1)} is also defined in "
                                        f"{known[len(TOP) + 1:]}; say in the name what it is of")
        self.Report(problems)
        self.assertGreater(len(types), 900)

    def test_what_math_has_is_defined_there_alone(self):
        named = re.compile(r"^(?:inline |constexpr |static )*[\w:<>]+&? "
                           r"(Skew|Exp|Log|Sinc|Square|LeftJacobian)\(")
        problems, known = [], 0
        for path in Sources(LIB):
            for number, line in Code(path):
                found = named.match(line)
                known += bool(found)
                if found and Room(path) != "math":
                    problems.append(f"{Place(path, number)}: {found.group(1)} stands in math/")
        self.Report(problems)
        self.assertGreater(known, 5)

    def test_arguments_draw_no_two_random_numbers(self):
        """C++ leaves open which argument is worked out first, so that one seed would give each
        compiler other numbers: a braced list or a variable each has an order."""
        draw = re.compile(r"\b\w*(random|rng)_?(\.[A-Z]\w*\(|[,)])")
        problems, draws = [], 0
        for path in (p for top in (LIB, os.path.join(TOP, "tests")) for p in Sources(top)):
            text = "\n".join(line for _, line in Code(path))
            if "random" not in text:
                continue
            opened = []  # where the arguments of each bracket begin
            for mark in re.finditer(r"[][(){},]", text):
                if mark.group() in "([{":
                    opened.append([mark.end()])
                elif mark.group() == "," and opened:
                    opened[-1].append(mark.end())
                elif opened:
                    begins = opened.pop()
                    if text[begins[0] - 1] != "(" or not draw.search(text, begins[0], mark.end()):
                        continue
                    arguments = [text[a:b] for a, b in zip(begins, begins[1:] + [mark.end()])]
                    drawing = [a for a in arguments if draw.search(a) and "&" not in a
                               and not re.fullmatch(r"\s*\w+[,)]\s*", a)]
                    draws += len(drawing)
                    if len(drawing) > 1:
                        line = text.count("\n", 0, begins[0]) + 1
                        problems.append(f"{Place(path, line)}: draws in two arguments")
        self.Report(problems)
        self.assertGreater(draws, 200)

    def test_chains_of_frames_telescope(self):
        problems, products = [], 0
        for path in Sources(LIB):
            for number, line in Code(path):
                for name in re.findall(r"\bR_([A-Z]{2})(?![A-Z\d])", line):
                    if set(name) - set(FRAMES):
                        problems.append(f"{Place(path, number)}: R_{name} has no such frame")
                for a, b, turned, c, d, turned_2, vector in PRODUCT.findall(line):
                    products += 1
                    right = a if turned else b
                    left = vector or (d if turned_2 else c)
                    if right != left:
                        problems.append(f"{Place(path, number)}: {right} meets {left}")
        self.Report(problems)
        self.assertGreater(products, 12)

    def test_vectors_and_rotations_of_headers_name_their_frames(self):
        code = {path: "\n".join(line for _, line in Code(path))
                for top in (LIB, os.path.join(TOP, "apps")) for path in Sources(top, (".h",))}
        types, problems, excused, count = Types("\n".join(code.values())), [], set(), 0
        for path in (path for path in code if Room(path) != "math"):
            free = Frameless(path)
            for at, name, nine in Triples(code[path], types):
                number = code[path].count("\n", 0, at) + 1
                why, words = Misnamed(name, nine)
                count += 1
                excused |= words if why else set()
                if why and not words and number not in free:
                    problems.append(f"{Place(path, number)}: {name} {why}")
        self.Report(problems)
        self.assertGreater(count, 250)
        self.assertEqual({*NO_VECTOR, *NO_ROTATION} - excused, set(), "words that excuse nothing")

    def test_wrong_names_of_vectors_and_rotations_are_seen(self):
        code = """
            using Axis = Eigen::Vector3d; using Axes = std::vector<Axis>;
            using Turn = Eigen::Matrix3d;
            Eigen::Vector3d b1 = Eigen::Vector3d::Zero(), ok_W, b2; Eigen::Vector3f b3, sigma_ok;
            double ok, b4[3] = {}, b5[3][3], ok[4]; std::array<double, 3> b6; float b7[3];
            Eigen::Matrix<double, 3, 1> b8; Axis b9; const Axes& b10_K; std::vector<Axis> ok_T;
            std::vector<Eigen::Vector3d> b11; std::array<std::vector<Eigen::Vector3d>, 2> b12;
            std::array<Eigen::Vector3d, kSize> b13; std::pair<Eigen::Vector3d, double> b14;
            Eigen::Matrix3d rotation_b15, R_LT, R_LT_end, R_LX, attitude_b16, sensitivity_ok;
            Eigen::Matrix3d cov_b17, cov_ok_W, p_by_b18, p_by_ok_W; Turn b19_W;
            Eigen::Quaterniond b20_LT; Eigen::Matrix<double, 3, 3> b21;
            void Ok(const Eigen::Vector3d& b22, double ok, std::span<const Axis> b23 = {});
            const Eigen::Vector3d& b24() const; Eigen::Matrix3d R(int k), R_LX_at(int k);
        """
        seen = [name for _, name, nine in Triples(code, Types(code))
                if Misnamed(name, nine)[0] and not Misnamed(name, nine)[1]]
        self.assertEqual(seen, re.findall(r"\b\w*b\d+\w*|\bR\b|R_LX(?!_)", code))

    def test_comments_that_are_held_up_as_examples_stand_in_the_sources(self):
        problems, known, source = [], 0, ""
        for line in Lines(os.path.join(TOP, ".github", "comments.md")):
            named, after = re.match(r"\d+\. `(.*)`", line), re.match(r"   - after: (.*)", line)
            if named:
                text = "\n".join(Lines(os.path.join(LIB, named.group(1))))
                source = " ".join(re.sub(r"^\s*//[/<]*", "", text, flags=re.M).split())
            if after:
                known += 1
                if " ".join(after.group(1).split()) not in source.replace("///< ", ""):
                    problems.append(f"comments.md: no longer there: {after.group(1)[:80]}")
        self.Report(problems)
        self.assertGreaterEqual(known, 20)

    def test_every_source_is_built(self):
        problems = []
        for path in Sources(LIB, (".cpp",)):
            lists = os.path.join(os.path.dirname(path), "CMakeLists.txt")
            name = os.path.relpath(path, os.path.dirname(lists))
            if not re.search(rf"(?<![\w/]){re.escape(name)}\b", "\n".join(Lines(lists))):
                problems.append(f"{os.path.relpath(path, TOP)}: stands in no CMakeLists.txt")
        self.Report(problems)

    def test_apps_do_no_arithmetic_rooms(self):
        problems = []
        for path in Sources(os.path.join(TOP, "apps")):
            for number, line in Code(path):
                if re.search(r"std::(sin|cos|tan|atan2?|sqrt|exp|log)\s*\(", line):
                    problems.append(f"{Place(path, number)}: arithmetic belongs to lib")
        self.Report(problems)

    def test_every_key_of_a_result_is_explained(self):
        writers = {"lib/wellgyro/io/result/run_file.cpp", "lib/wellgyro/io/toml/run_lesson_file.cpp",
                   "lib/wellgyro/live/session_files.cpp", "apps/wellgyro/recorded_survey.cpp"}
        writes = re.compile(r"""(?:toml\.(?:Text|Texts|Whole|Number|Numbers|Flag|Rows|Lines)\(|\bdeg\(
                                |\brate\(|\.counts\[)"(\w+)\"""", re.VERBOSE)
        page = "\n".join(Lines(os.path.join(LIB, "..", "docs", "files.md")))
        problems = []
        for writer in sorted(writers):
            keys = set(writes.findall("\n".join(Lines(os.path.join(TOP, writer)))))
            self.assertTrue(keys, writer)
            problems += [f"lib/docs/files.md: no `{key}`, which {writer} writes"
                         for key in sorted(keys) if f"`{key}`" not in page]
        self.Report(problems)

    def test_top_level_holds_nothing_else(self):
        listed = subprocess.run(["git", "ls-tree", "--name-only", "HEAD"], cwd=TOP, text=True,
                                capture_output=True, check=False).stdout.split()
        allowed = {"CMakeLists.txt", "CMakePresets.json", "lib", "apps", "proto", "tests", "data",
                   "README.md", "LICENSE"}
        self.Report([name for name in listed if name not in allowed and not name.startswith(".")])

    def test_no_path_of_a_machine(self):
        files = subprocess.run(["git", "ls-files"], cwd=TOP, text=True, capture_output=True,
                               check=False).stdout.split("\n")
        pattern = re.compile(r"/(work|home|root|Users|farm)/\w")
        problems = []
        for name in files:
            path = os.path.join(TOP, name)
            if not name or not os.path.isfile(path) or name == "tests/structure/structure_test.py":
                continue
            try:
                for number, line in enumerate(Lines(path), 1):
                    if pattern.search(line):
                        problems.append(f"{name}:{number}: {line.strip()[:80]}")
            except UnicodeDecodeError:
                continue
        self.Report(problems)


if __name__ == "__main__":
    sys.exit(0 if unittest.main(verbosity=1, exit=False).result.wasSuccessful() else 1)
