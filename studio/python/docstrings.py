"""docstrings.py ROOT OUT: the comments of public headers as C++ strings, so that Python's help says what they say.

For `struct Zone` the comment above it becomes docs::Zone, for its member `name` (comment above or beside it)
docs::Zone_name. Members that share a name share the first comment.
"""
import pathlib
import re
import sys

HEADERS = ("postproc/field/field.h", "surrogates/tables/fit/force_table.h", "geometry/mesh/surface_mesh.h")


def comments(text):
    """(name, comment) of the types of a header and of their members."""
    holder, above = None, []
    for line in text.splitlines():
        stripped = line.strip()
        if stripped.startswith("///"):
            above.append(stripped[3:].strip())
            continue
        beside = re.search(r"///<\s*(.*)", line)
        head = re.match(r"(?:struct|class)\s+(\w+)\s*{", line)
        member = re.match(r"\s{4}(?:\[\[nodiscard\]\]\s+)?(?:static\s+)?[\w:<>, *&]+?\s+[*&]?(\w+)\s*(?:[;={(]|$)", line)
        if head:
            holder = head.group(1)
            yield holder, " ".join(above)
        elif line.startswith("};"):
            holder = None
        elif member and holder:
            words = " ".join(above + ([beside.group(1)] if beside else []))
            if words and member.group(1).isidentifier() and member.group(1) != "const":
                yield f"{holder}_{member.group(1)}", words
        elif beside and holder and last:
            yield last, beside.group(1)
        above = []
        last = f"{holder}_{member.group(1)}" if member and holder else None


def main(root, out):
    found = {}
    for header in HEADERS:
        for name, words in comments((root / header).read_text()):
            found.setdefault(name, words)
    text = "// Made by docstrings.py from the public headers.\n#pragma once\n\nnamespace underbody::python::docs {\n"
    for name, words in found.items():
        words = words.replace("\\", "\\\\").replace('"', '\\"')
        text += f'[[maybe_unused]] inline constexpr const char* {name} = "{words}";\n'
    text += "}  // namespace underbody::python::docs\n"
    if not out.exists() or out.read_text() != text:
        out.write_text(text)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
