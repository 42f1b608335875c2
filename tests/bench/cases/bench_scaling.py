"""bench_scaling.py PROGRAM [N | NxR...]: studies of N cases made by this script, as many as a design campaign may have.

Each case is a closed cube of six faces with a pressure gradient of its own, so that what is timed is what a case costs beside
its field: the name, the condition, the store, the table, the report. Printed for each N: the first run, a run with nothing
changed, a run after one file changed, list, compare with itself as stored; the largest memory of each; the store on disk. NxR: the
store then holds R results of each case, as after R - 1 earlier versions of all files (rows copied under other keys by this script),
and what needs no computing is measured again.
"""
import json
import os
import pathlib
import resource
import sqlite3
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
        if i % 10 == 0:
            (folder / "fields" / variant).mkdir()
        write_case(folder / "fields" / variant / f"h{gap}.csv", 100 + gap + 0.01 * (i // 10))
    (folder / "study.toml").write_text(
        'title = "scaling"\n\n[[case]]\nfiles = "fields/{variant}/h{gap:mm}.csv"\n\n'
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


def largest_memory(words):
    """MB that a command holds at most, measured in a process of its own."""
    code = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True); "
            "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")
    return int(subprocess.run([sys.executable, "-c", code, *words], stdout=subprocess.PIPE, text=True, check=True).stdout) / 1024


def grow(folder, results):
    """Earlier results beside those there: the same values under other keys, with smaller numbers, so that they are older."""
    database = sqlite3.connect(folder / ".underbody" / "store.sqlite")
    (most,) = database.execute("SELECT max(id) FROM result").fetchone()
    database.execute("PRAGMA synchronous = OFF")
    for generation in range(1, results):
        shift = -generation * most
        database.execute("INSERT INTO result SELECT id + ?, kind, name, key || ?, inputs, about, summary, made FROM result "
                         "WHERE id > 0", (shift, f"-{generation}"))
        database.execute("INSERT INTO result_value SELECT id + ?, bytes FROM result_value WHERE id > 0", (shift,))
        database.commit()
    rows = database.execute("SELECT count(*) FROM result").fetchone()[0]
    database.close()
    return rows


def measure(program, folder, steps):
    line = []
    for name, words in steps:
        if name == "one changed":
            write_case(folder / "fields" / "v0" / "h5.csv", 150)
        words = [program, *map(str, words), "--json", "--quiet"]
        took, used, output = timed(words)
        if name == "list":
            line.append(f"{len(json.loads(output)['cases'])} listed")
        line.append(f"{name} {took:.2f} s ({used:.2f} processor)")
        if name in ("nothing changed", "list", "compare"):
            line[-1] += f" {largest_memory(words):.0f} MB"
    return ", ".join(line)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else "build/release/bin/underbody"
    for word in sys.argv[2:] or ["1000", "10000"]:
        count, _, results = word.partition("x")
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch) / "study"
            begin = time.perf_counter()
            make_study(folder, int(count))
            print(f"{count} cases (made in {time.perf_counter() - begin:.1f} s):", flush=True)
            run = ["study", "run", folder]
            still = [("nothing changed", run), ("list", ["study", "list", folder]),
                     ("compare", ["study", "compare", folder, folder, "--as-stored"])]
            print("  " + measure(program, folder, [("first run", run), ("one changed", run), *still]), flush=True)
            size = sum(os.path.getsize(path) for path in folder.rglob(".underbody/*") if path.is_file())
            report = max((path.stat().st_size for path in folder.rglob("*.html")), default=0)
            print(f"  store {size / 1e6:.1f} MB ({size / int(count):.0f} B a case), report {report / 1e6:.1f} MB", flush=True)
            if results:
                begin = time.perf_counter()
                rows = grow(folder, int(results))
                print(f"  {rows} results (made in {time.perf_counter() - begin:.1f} s): {measure(program, folder, still)}",
                      flush=True)


if __name__ == "__main__":
    main()
