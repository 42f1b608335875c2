"""bench_python.py: the Python module against the command line; PYTHONPATH=build/release/python, Debian's python3.

Goals: import in 0.3 s; 10^6 points of a table in 20 ms; loads of a field of many faces within 5 % of the command line's
(both from the file, by turns, RUNS times, medians; the module in a fresh process each time as well). FACES=5000000 for the full
size; LOADS=only leaves the rest out.
"""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy

PROGRAM = os.environ.get("UNDERBODY_PROGRAM", "build/release/bin/underbody")
FACES = int(os.environ.get("FACES", "1000000"))
RUNS = int(os.environ.get("RUNS", "9"))
QUIET = [sys.executable, "-W", "ignore", "-c"]


def cpu():
    """Processor time of this process and its children: what a busy machine does not change much."""
    own, children = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime


def best(work, times=5):
    """Shortest wall-clock and processor time."""
    took, used = [], []
    for _ in range(times):
        begin, before = time.perf_counter(), cpu()
        work()
        took.append(time.perf_counter() - begin)
        used.append(cpu() - before)
    return numpy.array([min(took), min(used)])


def spent(work):
    """Wall-clock and processor time of one call, s, and the pages that it touched for the first time."""
    def so_far():
        own, children = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
        return numpy.array([time.perf_counter(), cpu(), own.ru_minflt + children.ru_minflt])
    before = so_far()
    work()
    return so_far() - before


def compare_loads(underbody, field):
    """The command line and the module by turns, RUNS times, so that what else the machine does meets both alike."""
    line, own, fresh = [], [], []
    script = f"import underbody; underbody.loads({str(field)!r})"
    for _ in range(RUNS):
        line.append(spent(lambda: subprocess.run([PROGRAM, "loads", field, "--json"], check=True, capture_output=True)))
        own.append(spent(lambda: underbody.loads(field)))
        fresh.append(spent(lambda: subprocess.run([*QUIET, script], check=True)))
    read = underbody.read(field)
    again = best(lambda: underbody.loads(read))
    line, own, fresh = (numpy.array(one) for one in (line, own, fresh))
    print(f"loads of {FACES} faces from the file ({field.stat().st_size / 1e6:.0f} MB), medians of {RUNS} by turns:")
    for name, one in (("command line", line), ("module", own), ("a script with its import", fresh)):
        wall, used, pages = numpy.median(one, axis=0)
        ratio = numpy.median(one / line, axis=0)
        print(f"  {name}: {wall:.3f} s, {ratio[0]:.3f} of the command line's; {used:.3f} s of processor, {ratio[1]:.3f}; "
              f"{pages:.0f} pages")
    print(f"  goal 1.05; of the field in memory {both(again)} s")


def both(times, scale=1, digits=3):
    return f"{scale * times[0]:.{digits}f} ({scale * times[1]:.{digits}f} processor)"


def sphere_csv(path, faces):
    """A CFD-Post export of a sphere of quads with the pressure of a linear field: force = -gradient times volume."""
    across = int((faces / 2) ** 0.5)
    theta = numpy.linspace(0, numpy.pi, across + 1)
    phi = numpy.linspace(0, 2 * numpy.pi, 2 * across, endpoint=False)
    t, p = (one.ravel() for one in numpy.meshgrid(theta, phi, indexing="ij"))
    x, y, z = numpy.sin(t) * numpy.cos(p), numpy.sin(t) * numpy.sin(p), numpy.cos(t)
    i, j = (one.ravel() for one in numpy.meshgrid(numpy.arange(across), numpy.arange(2 * across), indexing="ij"))
    n = 2 * across
    quads = numpy.stack([i * n + j, (i + 1) * n + j, (i + 1) * n + (j + 1) % n, i * n + (j + 1) % n], axis=1)
    with open(path, "w") as out:
        out.write("\n[Name]\nhull\n\n[Data]\nNode Number, X [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]\n")
        numpy.savetxt(out, numpy.column_stack([numpy.arange(len(x)), x, y, z, 100 * z]),
                      fmt="%d, %.9e, %.9e, %.9e, %.9e")
        out.write("\n[Faces]\n")
        numpy.savetxt(out, quads, fmt="%d, %d, %d, %d")


def main():
    if os.environ.get("LOADS") != "only":
        measure_import()
    import underbody
    import warnings
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        if os.environ.get("LOADS") != "only":
            measure_table(underbody, pathlib.Path(folder))
        field = pathlib.Path(folder) / "sphere.csv"
        sphere_csv(field, FACES)
        compare_loads(underbody, field)


def measure_import():
    nothing = best(lambda: subprocess.run([*QUIET, "pass"], check=True))
    alone = best(lambda: subprocess.run([*QUIET, "import underbody"], check=True))
    with_numpy = best(lambda: subprocess.run([*QUIET, "import numpy"], check=True))
    print(f"import underbody: {both(alone - nothing)} s, NumPy alone {both(with_numpy - nothing)} s; goal 0.3 s")


def measure_table(underbody, folder):
    gaps, pitches = numpy.linspace(0.002, 0.05, 40), numpy.radians(numpy.linspace(-4, 4, 20))
    with open(folder / "lift.csv", "w") as out:
        out.write("gap [m], pitch [rad], lift_force [N]\n")
        for gap in gaps:
            for pitch in pitches:
                out.write(f"{gap!r}, {pitch!r}, {0.01 / gap * numpy.cos(9 * pitch)!r}\n")
    table = underbody.table(folder / "lift.csv")
    random = numpy.random.default_rng(1)
    points = numpy.column_stack([random.uniform(0.002, 0.05, 1_000_000), random.uniform(-0.06, 0.06, 1_000_000)])
    print(f"10^6 points, two axes: {both(best(lambda: table(points)), 1e3, 1)} ms, by names "
          f"{both(best(lambda: table(gap=points[:, 0], pitch=points[:, 1])), 1e3, 1)} ms, with slopes "
          f"{both(best(lambda: table.slopes(points)), 1e3, 1)} ms; goal 20 ms")


if __name__ == "__main__":
    main()
