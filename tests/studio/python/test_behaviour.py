"""Errors, warnings, progress, Ctrl-C, threads, stubs."""
import collections.abc
import inspect
import os
import pathlib
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
import warnings

import pytest
import underbody

FIELD = "fields/ellipse-h5-p0.csv"


@pytest.mark.parametrize("words, call", [
    (["loads", "nothing.csv"], lambda: underbody.loads("nothing.csv")),
    (["loads", FIELD, "--density", "5 mm"], lambda: underbody.loads(FIELD, density="5 mm")),
    (["loads", FIELD, "--fluid", "water"], lambda: underbody.loads(FIELD, fluid="water")),
    (["loads", FIELD, "--zones", "hul"], lambda: underbody.loads(FIELD, zones=["hul"])),
    (["body", "shapes/ellipse.toml", "--gap", "5 kg"], lambda: underbody.body("shapes/ellipse.toml", gap="5 kg")),
    (["simulate", "glide.toml", "--from", "gap=4 mm", "--for", "5 kg"],
     lambda: underbody.simulate("glide.toml", start={"gap": "4 mm"}, duration="5 kg")),
    (["body", "shapes/ellipse.toml", "--gap", "-1"], lambda: underbody.body("shapes/ellipse.toml", gap=-1)),
    (["simulate", "glide.toml", "--from", "gab=1"], lambda: underbody.simulate("glide.toml", start={"gab": 1})),
    (["simulate", "glide.toml", "--from", "gap=3 s"], lambda: underbody.simulate("glide.toml", start={"gap": "3 s"})),
    (["region", "glide.toml", "--draws", "3", "--sweep", "speed=0:1"],
     lambda: underbody.region("glide.toml", draws=3, sweep={"speed": (0, 1)})),
    (["study", "list", "fields"], lambda: underbody.study.list("fields")),
    (["loads", FIELD, "--density", ""], lambda: underbody.loads(FIELD, density="")),
    (["simulate", "glide.toml", "--from", "", "--for", "5"], lambda: underbody.simulate("glide.toml", start={}, duration=5)),
    (["simulate", "glide.toml", "--for", "5"], lambda: underbody.simulate("glide.toml", duration=5)),
    (["control", "heave/model.toml", "--hold", "20 s"], lambda: underbody.control("heave/model.toml", hold="20 s")),
    (["discover", "heave/model.toml", "--data", "heave"], lambda: underbody.discover("heave/model.toml", data="heave")),
    (["loads"], lambda: underbody.loads()),
    (["probe", FIELD, "--point", "0,0,a mm"], lambda: underbody.probe(FIELD, point="0,0,a mm")),
    (["list", "quantitys"], lambda: underbody.list_("quantitys")),
    (["info", FIELD, "--length-unit", "kg"], lambda: underbody.read(FIELD, length_unit="kg")),
    (["info", FIELD, "--time", "abc"], lambda: underbody.read(FIELD, time="abc")),
    (["info", "fields"], lambda: underbody.read("fields")),
    (["region", "glide.toml", "--grid", "0x5"], lambda: underbody.region("glide.toml", grid="0x5")),
    (["region", "glide.toml", "--threads", "-1"], lambda: underbody.region("glide.toml", threads=-1)),
    (["body", "shapes/ellipse.toml", "--panels", "0.5"], lambda: underbody.body("shapes/ellipse.toml", panels=0.5)),
    (["new", "modle"], lambda: underbody.new("modle")),
])
def test_errors_have_the_same_words(program, words, call):
    with pytest.raises(underbody.Error) as raised:
        call()
    assert str(raised.value) == program.sentence(*words)
    expected = underbody.UsageError if program.run(*words).returncode == 2 else underbody.Error
    assert isinstance(raised.value, expected)


def test_errors_say_where(program, tmp_path):
    bad = tmp_path / "bad.csv"
    bad.write_text("gap [mm], lift_force [N]\n5, 1\n6, x\n")
    with pytest.raises(underbody.InputError) as raised:
        underbody.table(bad)
    error = raised.value
    assert (error.file, error.line) == (str(bad), 3) and error.column
    assert str(error) == program.sentence("table", "fit", bad)
    assert isinstance(error, ValueError)
    with pytest.raises(underbody.InputError) as raised:
        underbody.table.fit(bad)
    assert (raised.value.line, raised.value.column, str(raised.value)) == (error.line, error.column, str(error))


@pytest.mark.parametrize("wrong, says", [
    ('channel.gap = { field = "hight", unit = "mm" }', "did you mean 'height'?"),
    ('channel.gap = { feild = "height", unit = "mm" }', "did you mean 'field'?"),
    ('channel.gap = { field = "height", unit = "s" }', "gap"),
    ('channel.gab = { field = "height", unit = "mm" }', "did you mean 'gap'?"),
])
def test_mapping_files_have_the_same_words_and_place(program, tmp_path, wrong, says):
    (tmp_path / "run.csv").write_text("stamp,height\n" + "".join(f"{k / 10},{20 + k % 3}\n" for k in range(50)))
    mapping = tmp_path / "dataset.toml"
    mapping.write_text(f'kind = "time_series"\n\n[log]\nclock = "stamp"\n{wrong}\n\n[[run]]\nfile = "run.csv"\n')
    with pytest.raises(underbody.InputError) as raised:
        underbody.predict("heave/model.toml", data=tmp_path)
    assert str(raised.value) == program.sentence("predict", "heave/model.toml", "--data", tmp_path)
    assert says in str(raised.value)
    assert (raised.value.file, raised.value.line) == (str(mapping), 5)


def test_reading_raises_too(tmp_path):
    path = tmp_path / "no-cfd.bin"
    path.write_bytes(b"\0\1\2\3" * 100)
    with pytest.raises(underbody.InputError) as raised:
        underbody.read(path)
    assert str(path) in str(raised.value)


def test_arguments_that_do_not_exist(program):
    with pytest.raises(underbody.UsageError, match=r"has no argument 'symetry'\s+hint: did you mean 'symmetry'"):
        underbody.loads(FIELD, symetry="y")
    with pytest.raises(underbody.UsageError, match="neither a number"):
        underbody.loads(FIELD, density=object())
    with pytest.raises(underbody.UsageError, match="a range has two ends"):
        underbody.region("glide.toml", axes={"gap": (0, 1, 2)})


@pytest.mark.filterwarnings("ignore::underbody.UnderbodyWarning")
def test_values_that_are_none(program):
    table = underbody.table("tables/base.csv", quantity="lift_force", axes="gap,pitch")
    with pytest.raises(underbody.UsageError) as raised:
        table(gap="5 mm", pitch="1 m")
    assert str(raised.value) == program.sentence("table", "at", "tables/base.csv", "gap=5 mm", "pitch=1 m")
    with pytest.raises(underbody.UsageError, match=r"different shapes: gap \(3,\), pitch \(2,\)"):
        table(gap=[0.003, 0.004, 0.005], pitch=[0, 0.01])
    with pytest.raises(underbody.UsageError, match="gap: .* is no number"):
        table(gap={"from": 1}, pitch=0)
    with pytest.raises(underbody.UsageError, match=r"5 \(int\) is no path"):
        underbody.read(5)
    with pytest.raises(underbody.UsageError, match="zones=5 is neither"):
        underbody.read(FIELD, zones=5)
    with pytest.raises(underbody.UsageError, match="unit='Pa' is no dict"):
        underbody.read(FIELD, unit="Pa")


def test_warnings_are_pythons(program):
    with pytest.warns(underbody.UnderbodyWarning) as said:
        underbody.loads(FIELD)
    line = program.run("loads", FIELD)
    for one in said:
        assert str(one.message) in line.stdout
    assert said[0].filename == __file__


def test_outside_the_table_is_said(program, tmp_path):
    (tmp_path / "lift.csv").write_text("gap [mm], lift_force [N]\n" + "".join(f"{g}, {1 / g}\n" for g in range(2, 12)))
    table = underbody.table(tmp_path / "lift.csv")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table(gap=[0.003, 0.004])
    with pytest.warns(underbody.UnderbodyWarning, match="1 of 2 points lies outside"):
        assert table(gap=["3 mm", "50 mm"])[1] == table(gap="11 mm")
    with pytest.warns(underbody.UnderbodyWarning):
        assert table.at(gap=0.05).outside
    refusing = underbody.table(tmp_path / "lift.csv", range="refuse")
    with pytest.raises(underbody.InputError), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        refusing(gap=0.05)
    with pytest.raises(underbody.UsageError):
        table(gab=0.005)
    with pytest.raises(underbody.Error):
        table(gap="5 s")


@pytest.mark.filterwarnings("ignore::underbody.UnderbodyWarning")
def test_progress_is_told_and_may_stop(program):
    told = []
    underbody.region("glide.toml", grid="60x60", progress=lambda fraction, what: told.append((fraction, what)))
    assert told and all(0 <= fraction <= 1 for fraction, _ in told) and isinstance(told[0][1], str)

    class Enough(Exception):
        pass

    def stop(fraction, what):
        raise Enough(what)

    with pytest.raises(Enough):
        underbody.region("glide.toml", grid="400x400", progress=stop)
    assert underbody.region("glide.toml", grid="5x5").classes  # and the next call is as good as ever


LONG = """import underbody
said = []
underbody.region('glide.toml', grid='3000x3000', threads=1,
                 progress=lambda fraction, what: said or said.append(print('at work', flush=True)))
"""


def own_time(pid):
    """Processor seconds of a running process, without the kernel's."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return int(fields[11]) / os.sysconf("SC_CLK_TCK")


def test_ctrl_c_stops_within_a_second_of_work(program):
    # What a shell starts in the background is deaf to Ctrl-C, and so is what that starts.
    running = subprocess.Popen([sys.executable, "-W", "ignore", "-c", LONG], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    assert running.stdout.readline() == "at work\n", running.stderr.read()
    before = own_time(running.pid)
    running.send_signal(signal.SIGINT)
    errors = running.stderr.read()
    _, status, used = os.wait4(running.pid, 0)
    running.returncode = os.waitstatus_to_exitcode(status)
    assert used.ru_utime - before < 1
    assert "KeyboardInterrupt" in errors and running.returncode in (1, 130, -signal.SIGINT)


@pytest.mark.filterwarnings("ignore::underbody.UnderbodyWarning")
def test_python_runs_on_meanwhile(program):
    """Another thread counts while a call computes; two calls at once give what each gives alone."""
    alone = underbody.region("glide.toml", grid="200x200", threads=1)
    results, counted, stop = [None, None], [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    def work(k):
        results[k] = underbody.region("glide.toml", grid="200x200", threads=1)

    threads = [threading.Thread(target=count), *(threading.Thread(target=work, args=(k,)) for k in range(2))]
    for one in threads:
        one.start()
    for one in threads[1:]:
        one.join()
    stop.set()
    threads[0].join()
    assert results[0] == results[1] == alone
    assert counted[0] > 5


def test_results_tell_their_keys(program):
    result = underbody.info(FIELD)
    assert "zones" in dir(result) and "format" in result and len(result) > 3
    with pytest.raises(AttributeError, match="did you mean 'format'"):
        result.formatt
    assert result.zones[0].name
    assert "<Result" in repr(result)


def test_what_went_wrong_reads_as_it_is_called(program):
    def last_line(script):
        done = subprocess.run([sys.executable, "-W", "ignore", "-c", "import underbody\n" + script], capture_output=True,
                              text=True)
        assert done.returncode == 1
        return done.stderr.rstrip().splitlines()[-1]

    assert last_line("underbody.loads('none.csv')") == "underbody.InputError: none.csv: there is no such file"
    told = last_line(f"underbody.info('{FIELD}').formatt")
    assert told == "AttributeError: there is no 'formatt' in this result; did you mean 'format'?"
    with pytest.raises(KeyError, match="did you mean 'format'"):
        underbody.info(FIELD)["formatt"]
    with pytest.raises(underbody.InputError) as caught:
        underbody.info("none.csv")
    again = pickle.loads(pickle.dumps(caught.value))  # as it comes out of another process
    assert str(again) == str(caught.value) and again.file == "none.csv"


def test_every_command_is_here_with_help():
    for name in ("read", "loads", "body", "table", "model", "simulate", "region", "discover", "study", "import_", "info",
                 "predict", "export", "learn", "estimate", "control", "linear", "sweep", "solve", "theory", "probe"):
        assert callable(getattr(underbody, name)), name
        assert getattr(underbody, name).__doc__, name
    assert "symmetry" in inspect.signature(underbody.loads).parameters
    assert "half model" in underbody.loads.__doc__
    assert underbody._underbody.Zone.__doc__.startswith("A surface, a volume")  # the header's own words
    assert "list" not in vars(underbody)  # Python's own stays


def test_every_public_name_has_words_and_a_type(program):
    stub = (pathlib.Path(underbody.__file__).parent / "__init__.pyi").read_text()
    classes = {match[1]: match[0] for match in re.finditer(r"^class (\w+)\b.*?(?=^\S)", stub, re.S | re.M)}
    native = underbody._underbody
    known = {name: getattr(underbody, name) for name in underbody.__all__}
    for name, one in known.items():
        assert inspect.getdoc(one), name
        assert re.search(rf"^(def {name}\(|class {name}\b|{name}: )", stub, re.M), f"{name}: no type"
    for owner in (underbody.Field, underbody.Table, underbody.Model, underbody.Study, underbody.Values, underbody.Result,
                  native.Zone, native.ArrayInfo, native.Surface):
        for name in (name for name in dir(owner) if not name.startswith("_")):
            if hasattr(collections.abc.Mapping, name):
                continue
            assert inspect.getdoc(inspect.getattr_static(owner, name)), f"{owner.__name__}.{name}: no words"
            assert re.search(rf"\b{name}\b", classes[owner.__name__]), f"{owner.__name__}.{name}: no type"
    for owner, made in (("Model", underbody.model("heave/model.toml")), ("Study", underbody.study("."))):
        for name in vars(made):
            assert re.search(rf"\b{name}\b", classes[owner]), f"{owner}.{name}: no type"


@pytest.mark.parametrize("call, says", [
    (lambda: underbody.table(), "table: missing a required argument: 'path'"),
    (lambda: underbody.table("lift.csv", knd="gp"), "did you mean 'kind'"),
    (lambda: underbody.read("a.csv", lenght_unit="mm"), "did you mean 'length_unit'"),
    (lambda: underbody.study("a", "b"), "study: too many positional arguments"),
    (lambda: underbody.model(), "model: missing a required argument: 'path'"),
    (lambda: underbody.study.set(), "is required"),
])
def test_arguments_of_objects_are_told_as_those_of_commands(program, call, says):
    with pytest.raises(underbody.UsageError, match=says):
        call()


def test_stubs_are_those_of_the_module(tmp_path):
    pytest.importorskip("mypy", reason="the Debian package python3-mypy is not installed")
    package = pathlib.Path(underbody.__file__).parent
    stub = (package / "__init__.pyi").read_text()
    for name, parameter in inspect.signature(underbody.loads).parameters.items():
        assert f"{name}: " in stub
    script = tmp_path / "user.py"
    script.write_text("import underbody\n"
                      "lift: float = underbody.loads('a.csv', symmetry='y', stations=3).lift_force\n"
                      "table = underbody.table('lift.csv', kind='gp')\n"
                      "print(table(gap='5 mm'), underbody.read('a.csv').zones[0]['pressure'].mean())\n"
                      "underbody.region('m.toml', axes={'gap': (0, 1)}, force=True)\n"
                      "underbody.model('m.toml').simulate(start={'gap': 1}, duration='5 s').columns['gap']\n"
                      "table.equilibria(weight='0.3 N'), underbody.study('.').run(report='a.html')\n"
                      "underbody.loads('a.csv', symetry='y')\n"
                      "underbody.model('m.toml').simulte(start={'gap': 1})\n"
                      "table.equilibria(wieght='0.3 N')\n")
    done = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path / "cache"), str(script)],
                          capture_output=True, text=True, env={**os.environ, "MYPYPATH": str(package.parent)})
    errors = [line for line in done.stdout.splitlines() if "error" in line and "Found" not in line]
    wrong = ("symetry", "simulte", "wieght")
    assert len(errors) == 3 and all(word in error for word, error in zip(wrong, errors)), done.stdout
