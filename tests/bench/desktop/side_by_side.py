"""side_by_side.py FILE.stl [STUDIO] [RUNS]: the window and ParaView open and turn one surface, both seen from outside.

Each program gets the file on its command line, a home of its own, a new Xvfb of one size and the software renderer, by turns, RUNS times
(default 3). Nothing of either program is asked for its opinion: pictures are read off the display every few milliseconds, the mouse is
moved by events of the X server (XTest), processor time and memory are those of the process in /proc. ParaView is Debian's, without
Python, with its setting Auto Apply and its window as large as makes its 3D view as large as the other's. STUDIO: the program (default
build/release/bin/underbody-studio). Without paraview, xdotool, Xvfb or NumPy nothing is measured, and that is said.
"""
import ctypes
import json
import os
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import numpy as np
except ImportError:
    np = None

SCREEN = (1280, 800)
VIEW = (639, 90, 628, 365)  # px: left, top, width, height of the studio's 3D view in a window as large as the screen
AROUND = (310, 236)  # px: ParaView's panels, bars and menus around its view, as Debian's starts
STILL = 3.0  # s without another picture: at rest
LONGEST = 180  # s
TURN = 3.0  # s
HERE = Path(__file__).resolve().parent


class Display:
    """An Xvfb and a connection to it."""

    def __init__(self):
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "%dx%dx24" % SCREEN], pass_fds=[write],
                                       stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as said:
            self.name = ":" + said.readline().strip()
        self.x = ctypes.CDLL("libX11.so.6")
        self.test = ctypes.CDLL("libXtst.so.6")
        for name, kind in (("XOpenDisplay", ctypes.c_void_p), ("XDefaultRootWindow", ctypes.c_ulong), ("XGetImage", ctypes.c_void_p)):
            getattr(self.x, name).restype = kind
        self.x.XGetImage.argtypes = [ctypes.c_void_p, ctypes.c_ulong] + 4 * [ctypes.c_int] + [ctypes.c_ulong, ctypes.c_int]
        for name in ("XDestroyImage", "XFlush", "XCloseDisplay", "XDefaultRootWindow"):
            getattr(self.x, name).argtypes = [ctypes.c_void_p]
        self.test.XTestFakeMotionEvent.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_ulong]
        self.test.XTestFakeButtonEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]
        self.connection = self.x.XOpenDisplay(self.name.encode())
        self.root = self.x.XDefaultRootWindow(self.connection)

    def picture(self, x, y, width, height):
        """Pixels as they are shown now, height x width, 0xRRGGBB."""
        image = self.x.XGetImage(self.connection, self.root, x, y, width, height, 0xFFFFFFFF, 2)
        data = ctypes.cast(image + 16, ctypes.POINTER(ctypes.c_void_p))[0]  # struct XImage: three ints and one more, then data
        pixels = np.frombuffer(ctypes.string_at(data, 4 * width * height), np.uint32).reshape(height, width) & 0xFFFFFF
        self.x.XDestroyImage(image)
        return pixels

    def move(self, x, y):
        self.test.XTestFakeMotionEvent(self.connection, -1, x, y, 0)
        self.x.XFlush(self.connection)

    def button(self, down):
        self.test.XTestFakeButtonEvent(self.connection, 1, int(down), 0)
        self.x.XFlush(self.connection)

    def close(self):
        self.x.XCloseDisplay(self.connection)
        self.server.terminate()
        self.server.wait()


class Program:
    """A program with a home of its own and the display."""

    def __init__(self, words, home, display):
        surroundings = dict(os.environ, HOME=str(home), DISPLAY=display.name, LIBGL_ALWAYS_SOFTWARE="1", QT_QPA_PLATFORM="xcb")
        for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"):
            surroundings.pop(name, None)
        self.began = time.perf_counter()
        self.process = subprocess.Popen(words, env=surroundings, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def processor(self):
        """s, of all its threads."""
        with open(f"/proc/{self.process.pid}/stat") as stat:
            words = stat.read().rsplit(")", 1)[1].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    def memory(self):
        """MB, resident."""
        with open(f"/proc/{self.process.pid}/status") as status:
            return next(int(line.split()[1]) / 1024 for line in status if line.startswith("VmRSS"))

    def close(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()


def like(one, other):
    """Share of the pixels that are nearly the same."""
    far = [np.abs(((one >> shift) & 255).astype(int) - ((other >> shift) & 255).astype(int)) for shift in (16, 8, 0)]
    return float((np.max(far, axis=0) <= 24).mean())


def until_still(program, display, box):
    """Every picture of a part of the display until none has come for a while and the program rests: (s, pixels, s of processor)."""
    seen = []
    while time.perf_counter() - program.began < LONGEST:
        pixels = display.picture(*box)
        now, used = time.perf_counter() - program.began, program.processor()
        if not seen or not np.array_equal(pixels, seen[-1][1]):
            seen.append((now, pixels, used))
        if len(seen) > 1 and now - seen[-1][0] > STILL and used - seen[-1][2] < 0.1 * (now - seen[-1][0]):
            return seen
        if program.process.poll() is not None:
            sys.exit(f"{program.process.args[0]} ended by itself")
        time.sleep(0.004)
    sys.exit(f"{program.process.args[0]} was not at rest within {LONGEST} s")


def drag(program, display, box):
    """Pictures while the mouse moves with its button held, from the middle of the view, and after it is let go."""
    x, y, width, height = box
    middle = (x + width // 2 - 60, y + height // 2 - 40)
    display.move(*middle)
    time.sleep(0.5)
    last, frames, moves, answered = display.picture(*box), 0, 0, 0
    display.button(True)
    used, began = program.processor(), time.perf_counter()
    while (now := time.perf_counter() - began) < TURN:
        if 100 * now > moves:  # a hand: a hundred places a second
            moves += 1
            display.move(middle[0] + moves % 160, middle[1] + moves % 90)
        pixels = display.picture(*box)
        if not np.array_equal(pixels, last):
            frames, last = frames + 1, pixels
            answered = answered or now
        time.sleep(0.002)
    used = program.processor() - used
    display.button(False)
    let_go, whole = time.perf_counter(), 0
    while (now := time.perf_counter() - let_go) < whole + STILL:
        pixels = display.picture(*box)
        if not np.array_equal(pixels, last):
            whole, last = now, pixels
        time.sleep(0.004)
    if frames == 0:
        sys.exit(f"{program.process.args[0]}: nothing turned in its view")
    return {"first answer to the hand, s": answered, "pictures a second while turning": frames / TURN,
            "of processor each, ms": 1000 * used / frames, "let go to the last picture, s": whole}


def opened(words, home, box):
    """One start of a program with the file, its view at `box`."""
    display = Display()
    program = Program(words, home, display)
    try:
        seen = until_still(program, display, box)
        final = seen[-1][1]
        inside = (slice(box[3] * 2 // 5, box[3] * 3 // 5), slice(box[2] * 2 // 5, box[2] * 3 // 5))  # the surface alone
        first = next(one for one in seen if like(one[1][inside], final[inside]) > 0.9)
        result = {"start to the first picture, s": first[0], "of processor until then, s": first[2], "start to the last picture, s": seen[-1][0]}
        result["memory at rest, MB"] = program.memory()
        result.update(drag(program, display, box))
        second = drag(program, display, box)  # what a first turn makes (a stand-in) is there
        result.update({"again: " + name: number for name, number in second.items()})
        result["memory after two turns, MB"] = program.memory()
        return result, first[1], final
    finally:
        program.close()
        display.close()


def started(words, home):
    """s from a start without a file to the window as it stays."""
    display = Display()
    program = Program(words, home, display)
    try:
        seen = until_still(program, display, (0, 0) + SCREEN)
        return next(at for at, pixels, _ in seen if like(pixels, seen[-1][1]) > 0.98)
    finally:
        program.close()
        display.close()


def home_of_paraview(folder):
    """Its window of that size, no welcome, no Apply to press."""
    settings = folder / ".config" / "ParaView"
    settings.mkdir(parents=True)
    (settings / "ParaView-UserSettings.json").write_text(json.dumps({"settings": {"GeneralSettings": {"AutoApply": 1, "AutoApplyDelay": 0}}}))
    version = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", "paraview"], capture_output=True, text=True, check=True).stdout
    size = "%d %d" % (VIEW[2] + AROUND[0], VIEW[3] + AROUND[1])
    (settings / f"ParaView{version.split('+')[0]}.ini").write_text(
        f"[General]\nGeneralSettings.ShowWelcomeDialog=false\n\n[MainWindow]\nSize=@Size({size})\nPosition=@Point(0 0)\n")


def run(surface, studio, runs):
    programs = {"window": ([studio, "--width", str(SCREEN[0]), "--height", str(SCREEN[1])], [surface], VIEW, lambda folder: None),
                "ParaView": (["paraview"], ["--data=" + surface], (303, 200) + VIEW[2:], home_of_paraview)}
    found = {name: [] for name in programs}
    for _ in range(runs):
        for name, (words, file, box, make_home) in programs.items():
            with tempfile.TemporaryDirectory() as folder:
                make_home(Path(folder))
                start = started(words, folder)
                result, first, final = opened(words + file, folder, box)
                found[name].append({"start to the window, without a file, s": start} | result)
            if pictures := os.environ.get("UNDERBODY_WRITE_PICTURES"):
                for what, pixels in (("first", first), ("last", final)):
                    rgb = np.stack([(pixels >> shift) & 255 for shift in (16, 8, 0)], axis=2).astype(np.uint8)
                    Path(pictures, f"{name}-{what}.ppm").write_bytes(b"P6 %d %d 255\n" % (box[2], box[3]) + rgb.tobytes())
            print(f"{name}: load {os.getloadavg()[0]:.1f}, " + ", ".join(f"{what} {number:.3g}" for what, number in found[name][-1].items()),
                  flush=True)
    print(f"\nmedians of {runs} (least to most); view {VIEW[2]} x {VIEW[3]} px\n| what | window | ParaView | ParaView to window |\n|---|---|---|---|")
    for what in found["window"][0]:
        numbers = [[one[what] for one in found[name]] for name in programs]
        ours, theirs = (statistics.median(one) for one in numbers)
        spread = [f"{statistics.median(one):.3g} ({min(one):.3g} to {max(one):.3g})" for one in numbers]
        print(f"| {what} | {spread[0]} | {spread[1]} | {theirs / ours:.2g} |" if ours else f"| {what} | {spread[0]} | {spread[1]} | |")


def main():
    for program in ("paraview", "xdotool", "Xvfb"):
        if shutil.which(program) is None:
            print(f"skipped: {program} is not installed")  # xdotool comes with the library that moves the mouse
            return
    if np is None:
        print("skipped: NumPy is not installed")
        return
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    studio = sys.argv[2] if len(sys.argv) > 2 else str(HERE.parents[2] / "build/release/bin/underbody-studio")
    run(str(Path(sys.argv[1]).resolve()), studio, int(sys.argv[3]) if len(sys.argv) > 3 else 3)


if __name__ == "__main__":
    main()
