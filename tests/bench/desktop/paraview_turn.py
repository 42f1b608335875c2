"""pvpython paraview_turn.py FILE.stl [WIDTHxHEIGHT]: how long ParaView takes to open a surface and how fast it turns, beside bench_desktop.

Both on one display with the same renderer and a view of the same size (LIBGL_ALWAYS_SOFTWARE=1). "turning" is ParaView's own picture while
a mouse button is held (its stand-in, where its settings have one), "whole" the picture at rest.
"""
import sys
import time

from paraview import simple


def main():
    begin = time.perf_counter()
    surface = simple.STLReader(FileNames=[sys.argv[1]])
    size = [int(side) for side in sys.argv[2].split("x")] if len(sys.argv) > 2 else [1280, 800]
    view = simple.CreateRenderView(ViewSize=size)
    simple.Show(surface, view)
    simple.ResetCamera(view)
    simple.Render(view)
    print(f"open to the first picture {time.perf_counter() - begin:.2f} s, of processor {time.process_time():.2f} s")
    camera = view.GetActiveCamera()
    drawn = [0]
    view.GetRenderWindow().AddObserver("EndEvent", lambda *_: drawn.__setitem__(0, drawn[0] + 1))
    # Of the proxy: methods of the same names on the view itself draw nothing.
    for name, draw, count in (("whole", view.SMProxy.StillRender, 5), ("turning", view.SMProxy.InteractiveRender, 20)):
        draw()  # what a first one makes (a stand-in) is not counted
        drawn[0] = 0
        begin, used = time.perf_counter(), time.process_time()
        for _ in range(count):
            camera.Azimuth(2)
            draw()
        taken = time.perf_counter() - begin
        if drawn[0] != count:
            sys.exit(f"{name}: {drawn[0]} of {count} pictures were drawn")
        print(f"{name}: {count / taken:.2f} pictures a second, "
              f"{1000 * (time.process_time() - used) / count:.0f} ms of processor each")
    with open("/proc/self/status") as status:
        print("".join(line for line in status if line.startswith("VmRSS")).strip())


if __name__ == "__main__":
    main()
