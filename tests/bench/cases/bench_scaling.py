"""bench_scaling.py PROGRAM [N...]: studies of N cases made by this script, as many as a design campaign may have.

Each case is a closed cube of six faces with a pressure gradient of its own, so that what is timed is what a case costs beside
its field: the name, the condition, the store, the table, the report. Printed for each N: the first run, a run with nothing
changed, a run after one file changed, list, compare; the largest memory of each; the store on disk. Lift is checked against
Archimedes: gradient times volume.
"""
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

CUBE = [(x, y, z) for x in (-.05, .05) for y in (-.05, .05) for z in (0, .1)]
FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def write_case(path, gradient):
    rows = "".join(f"{x}, {y}, {z}, {-gradient * z!r}\n" for x, y, z in CUBE)
    faces = "".join(", ".join(map(str, face)) + "\n" for face in FACES)
    path.write_text(f"\n[Name]\nbody\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]\n{rows}\n[Faces]\n{faces}")


def make_study(folder, count):
    """Variants of ten gaps each, two of which are compared."""
    (folder / "fields").mkdir(parents=True)
    for i in range(count):
        variant, gap = f"v{i // 10}", 5 + i % 10
        write_case(folder / "fields" / f"{variant}-h{gap}.csv", 100 + gap + 0.01 * (i // 10))
    (folder / "study.toml").write_text(
        'title = "scaling"\n\n[[case]]\nfiles = "fields/{variant}-h{gap:mm}.csv"\n\n'
        '[[table]]\nname = "lift"\nquantity = "lift_force"\naxes = ["gap"]\nwhere = { variant = "v0" }\n')


def processor():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def timed(words):
    """Wall-clock and processor seconds, and the output of a command."""
    begin, before = time.perf_counter(), processor()
    child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    output, errors = child.communicate()
    took = time.perf_counter() - begin
    if child.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: {errors[-2000:]}")
    return took, processor() - before, output


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else "build/release/bin/underbody"
    for count in [int(word) for word in sys.argv[2:]] or [1000, 10000]:
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch) / "study"
            make_study(folder, count)
            line = [f"{count} cases:"]
            for name, words in (("first run", ["study", "run", folder]), ("nothing changed", ["study", "run", folder]),
                                ("one changed", ["study", "run", folder]), ("list", ["study", "list", folder])):
                if name == "one changed":
                    write_case(folder / "fields" / "v0-h5.csv", 150)
                took, used, output = timed([program, *map(str, words), "--json", "--quiet"])
                line.append(f"{name} {took:.2f} s ({used:.2f} processor),")
            cases = json.loads(output).get("cases", [])
            line.append(f"{len(cases)} listed,")
            memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
            store = sum(os.path.getsize(path) for path in folder.rglob(".underbody/*") if path.is_file())
            line.append(f"largest memory {memory:.0f} MB, store {store / 1e6:.1f} MB ({store / count:.0f} B a case)")
            print(" ".join(line), flush=True)


if __name__ == "__main__":
    main()
