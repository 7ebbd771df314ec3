"""Types of LCM as data: drawn at random, or as the modules of a Python package describe themselves."""
import importlib
import struct

PRIMITIVES = ["int8_t", "int16_t", "int32_t", "int64_t", "byte", "boolean", "float", "double", "string"]
LENGTHS = ["int8_t", "int16_t", "int32_t", "int64_t"]
CODES = {"int8_t": 8, "int16_t": 16, "int32_t": 32, "int64_t": 64}
CHARACTERS = "aZ 09\"\\,;\n\t\x01/\u00e4\u20ac\U0001f916"


class Type:
    """`members`: name, type, and dimensions, which are numbers or names of members."""

    def __init__(self, name, members):
        self.name, self.members, self.python = name, members, None
        # Members that hold sizes; their values are drawn small.
        self.lengths = {size for _, _, sizes in members for size in sizes if isinstance(size, str)}

    def load(self):
        package, _, short = self.name.rpartition(".")
        self.python = getattr(importlib.import_module(f"{package}.{short}"), short)

    @staticmethod
    def of_package(package):
        """The types of a package of lcm-gen (LCM 1.5) by their names."""
        types = {}
        for short in sorted(vars(package)):
            python = getattr(package, short)
            if not hasattr(python, "__typenames__"):
                continue
            members = [(name, kind, [int(size) if str(size).isdigit() else size for size in sizes or []])
                       for name, kind, sizes in zip(python.__slots__, python.__typenames__, python.__dimensions__)]
            types[f"{package.__name__}.{short}"] = Type(f"{package.__name__}.{short}", members)
            types[f"{package.__name__}.{short}"].python = python
        return types

    def text(self):
        package, _, short = self.name.rpartition(".")
        lines = [f"package {package};", f"struct {short}", "{"]
        lines += [f"  {kind} {name}{''.join(f'[{size}]' for size in sizes)};" for name, kind, sizes in self.members]
        return "\n".join([*lines, "}", ""])

    @staticmethod
    def write(types, folder):
        folder.mkdir(parents=True)
        for kind in types.values():
            (folder / f"{kind.name}.lcm").write_text(kind.text())

    def draw(self, types, random, depth=0):
        """A message with random values."""
        message = self.python()
        sizes = {}
        for name, kind, dimensions in self.members:
            if name in self.lengths:
                sizes[name] = random.choice([0, 1, 2, 3, 5]) if depth < 2 else random.choice([0, 1])
                setattr(message, name, sizes[name])
                continue
            counts = [sizes[size] if isinstance(size, str) else size for size in dimensions]
            setattr(message, name, draw_array(types, kind, counts, random, depth))
        return message


def draw_array(types, kind, counts, random, depth):
    if not counts:
        return draw_value(types, kind, random, depth)
    if kind == "byte" and len(counts) == 1:
        return bytes(random.randrange(256) for _ in range(counts[0]))
    return [draw_array(types, kind, counts[1:], random, depth) for _ in range(counts[0])]


def draw_value(types, kind, random, depth):
    if kind in CODES:
        half = 1 << (CODES[kind] - 1)
        return random.choice([-half, half - 1, 0, random.randrange(-half, half)])
    if kind == "byte":
        return random.randrange(256)
    if kind == "boolean":
        return random.random() < 0.5
    if kind == "double":
        return random.choice([0.0, -0.0, 0.1, float("nan"), float("-inf"), 1e-310, random.gauss(0, 1e3)])
    if kind == "float":
        number = random.choice([0.1, float("inf"), 1e-42, random.gauss(0, 1e3)])
        return struct.unpack(">f", struct.pack(">f", number))[0]
    if kind == "string":
        return "".join(random.choice(CHARACTERS) for _ in range(random.randrange(8)))
    return types[kind].draw(types, random, depth + 1)


def values_of(types, name, message, path=""):
    """Path, kind and value of each leaf of a decoded message, in order; a last dimension of bytes is one leaf."""
    for member, kind, sizes in types[name].members:
        value = getattr(message, member)
        yield from values_of_array(types, kind, len(sizes), value, f"{path}.{member}" if path else member)


def values_of_array(types, kind, dimensions, value, path):
    if kind == "byte" and dimensions == 1:
        yield path, "bytes", value
    elif dimensions:
        for i, item in enumerate(value):  # lcm-gen 1.3 has an iterator for booleans
            yield from values_of_array(types, kind, dimensions - 1, item, f"{path}[{i}]")
    elif kind in PRIMITIVES:
        yield path, kind, value
    else:
        yield from values_of(types, kind, value, path)


class Draw:
    """Random types: each of the later ones may contain the earlier ones, of two packages."""

    def __init__(self, random):
        self.random = random

    def types(self, folder):
        types = {}
        for i in range(12):
            name = f"{'first' if i % 3 else 'second.deep'}.kind_{i}_t"
            types[name] = self.type(name, list(types))
        folder.mkdir(parents=True)
        names = list(types)
        # Several to a file, with comments, constants, and statements of several members.
        for first in range(0, len(names), 3):
            text = "// Several types.\n\n/* of\n * two packages */\n"
            text += "".join(self.decorated(types[name]) for name in names[first:first + 3])
            (folder / f"file_{first}.lcm").write_text(text)
        return types

    def type(self, name, earlier):
        random, members, lengths = self.random, [], []
        for i in range(random.randint(2, 9)):
            if random.random() < 0.25:
                members.append((f"n{i}", random.choice(LENGTHS), []))
                lengths.append(f"n{i}")
                continue
            kind = random.choice(earlier) if earlier and random.random() < 0.3 else random.choice(PRIMITIVES)
            sizes = [random.choice([1, 2, 3, *lengths, *lengths]) for _ in range(random.choice([0, 0, 1, 1, 2, 3]))]
            members.append((f"m{i}", kind, sizes))
        return Type(name, members)

    def decorated(self, kind):
        lines = kind.text().splitlines()
        at = lines.index("{") + 1
        lines[at:at] = ["  const int32_t ONE = 1, SIXTEEN = 0x10; // constants", "  const double HALF = 5e-1;"]
        return "\n".join(f"{line}  // words; and = {{more}}" if self.random.random() < 0.3 else line for line in lines) + "\n"
