"""Fields, force tables, models and studies as objects; what they can do are commands with the first word given."""
import collections.abc
import inspect
import os

import numpy

from . import _errors, _underbody
from ._commands import Command, checked, find, said, say
from ._words import python_name, text_of

_TABLE_OPTIONS = ("quantity", "where", "axes", "kind", "range")


def _path(value):
    if hasattr(value, "__underbody_path__"):
        return value.__underbody_path__()
    try:
        return os.fspath(value)
    except TypeError:
        raise _errors.wrong_use(f"{value!r} ({type(value).__name__}) is no path",
                                "a path is a str or a pathlib.Path") from None


class Field:
    """What a CFD file holds: zones with arrays in SI under canonical names. Made by `read`.

    Arrays look into the field's own memory (no copy, read only) and keep it alive.
    """

    _native_field = True

    def __init__(self, path, native):
        self._given = path
        self._native = native

    def __underbody_path__(self):
        return self._given

    files = property(lambda self: self._native.files, doc="What it was read from.")
    format = property(lambda self: self._native.format, doc="'CFD-Post CSV', 'Fluent HDF5', 'EnSight Gold', ...")
    writer = property(lambda self: self._native.writer, doc="Product and version when the file says so.")
    dimension = property(lambda self: self._native.dimension, doc="3, or 2 for plane cases.")
    density = property(lambda self: self._native.density, doc="kg/m^3, constant, when the file says so; else None.")
    metadata = property(lambda self: dict(self._native.metadata), doc="What else the file says.")
    zones = property(lambda self: self._native.zones, doc="Surfaces, volumes, lines and points, in the file's order.")
    problems = property(lambda self: [text for _, text in self._native.problems], doc="What the reader found.")

    def __getitem__(self, name):
        zones = self.zones
        for zone in zones:
            if zone.name == name:
                return zone
        raise _errors.wrong_use(f"the field has no zone '{name}'",
                                _underbody.did_you_mean(name, [zone.name for zone in zones]), "name")

    def __iter__(self):
        return iter(self.zones)

    def __len__(self):
        return len(self.zones)

    def __contains__(self, name):
        return any(zone.name == name for zone in self.zones)

    @property
    def vtk(self):
        """All zones as a vtkMultiBlockDataSet of vtkmodules, with their names, without a copy."""
        from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkMultiBlockDataSet
        blocks = vtkMultiBlockDataSet()
        for number, zone in enumerate(self.zones):
            blocks.SetBlock(number, zone.vtk)
            blocks.GetMetaData(number).Set(vtkCompositeDataSet.NAME(), zone.name)
        return blocks

    def __repr__(self):
        return f"<Field {self.files[0] if self.files else ''}, {self.format}, {len(self.zones)} zones>"


def _names(argument, value):
    given = [value] if isinstance(value, str) else value
    if not isinstance(given, collections.abc.Iterable) or not all(isinstance(one, str) for one in given):
        raise _errors.wrong_use(f"{argument}={value!r} is neither a name nor a list of names")
    return list(given)


@checked
def read(path, *, zones=(), arrays=(), length_unit="", unit=None, mesh="", time="", cgns_base="",
         surfaces_only=False, progress=None):
    """Reads a CFD file of any known format (by its content) into a Field.

    zones: patterns (* ?) of those to take, all by default; arrays: canonical or original names, all by default;
    length_unit: of coordinates that the file does not say; unit: {"Pressure": "Pa"} of variables it does not say;
    mesh: the mesh or case file that a results file belongs to; time, cgns_base: which of several, default the last;
    surfaces_only: leave volumes out; progress: called with the fraction done and what is being done.
    Raises InputError when the file is damaged or unknown, with file and line or byte.
    """
    path = _path(path)
    names = [_names("zones", zones), _names("arrays", arrays)]
    if not isinstance(unit or {}, collections.abc.Mapping):
        raise _errors.wrong_use(f"unit={unit!r} is no dict", 'for instance {"Pressure": "Pa"}')
    units = [f"{name}={value}" for name, value in (unit or {}).items()]
    native = _underbody.read(path, *names, length_unit, units, _path(mesh) if mesh else "",
                             "" if time in ("", None) else text_of(time), str(cgns_base), surfaces_only, progress)
    say([(0 if level else 2, text) for level, text in native.problems], 4)
    return Field(path, native)


class Values:
    """A table at points: value, sigma, slope ({axis: array}), outside, no_data; arrays in the shape of the points."""

    __slots__ = {"value": "SI.", "sigma": "Standard deviation.", "slope": "{axis: d value / d axis}, SI.",
                 "outside": "Whether the point lies outside the axes' ranges.",
                 "no_data": "Whether no points of the table lie around."}

    def __init__(self, value, sigma, slope, outside, no_data):
        self.value, self.sigma, self.slope, self.outside, self.no_data = value, sigma, slope, outside, no_data

    def __repr__(self):
        return f"<Values value={self.value!r}, sigma={self.sigma!r}>"


def _shaped(array, shape):
    return array.reshape(shape) if shape else array.item()


class Table:
    """A force table, fitted once: call it for values, `at()` also for slopes and errors. Made by `table`.

    table(gap="5 mm"), table(gap=numpy.linspace(0.002, 0.02, 100), pitch="1 deg"), or table(points) with (n, axes) in SI
    in the order of `axes`. An axis that is not named is held as the command line holds it (a pitch at 0), else that is
    an error. Outside its range the table does what its `range` says, with a warning.
    """

    def __init__(self, native, given):
        self._native = native
        self._given = given
        vars(self).update(self._commands_of(given, {"fitted": {given["table"]: native}}))

    @staticmethod
    def _commands_of(given, objects=None):
        """The commands that take a table, by name."""
        found = {}
        for tree in (*find("table")["commands"], find("export")):
            if tree["name"] in ("fit", "at") or not any(one["name"] == "table" for one in tree["positionals"]):
                continue
            path = [tree["name"]] if tree["name"] == "export" else ["table", tree["name"]]
            names = {python_name(one["names"][0]) for one in tree["options"]}
            own = {name: value for name, value in given.items() if name == "table" or name in names}
            found[python_name(tree["name"])] = Command(tree, path, own, objects)
        return found

    def __underbody_path__(self):
        return self._given["table"]

    quantity = property(lambda self: self._native.quantity, doc="lift_force, pitch_moment, ...")
    unit = property(lambda self: self._native.unit, doc="SI unit of the values.")
    kind = property(lambda self: self._native.kind, doc="How it was fitted.")
    source = property(lambda self: self._native.source, doc="The file it came from.")
    points = property(lambda self: self._native.points, doc="The points it was fitted to, {column: array}, SI.")

    @property
    def axes(self):
        """{name: (unit, lower, upper)}, SI, in the order of the columns of points."""
        return {name: (unit, lower, upper) for name, unit, lower, upper in self._native.axes}

    def _points(self, points, held):
        axes = self._native.axes
        if points is not None:
            if held:
                raise _errors.wrong_use("give points or axes by name, not both")
            points = numpy.asarray(points, dtype=float)
            if points.ndim == 1 and len(axes) == 1:
                return [points], points.shape
            return list(points.reshape(-1, points.shape[-1] if points.ndim else 1).T), points.shape[:-1]
        units = {name: unit for name, unit, _, _ in axes}
        columns = {name: _column(name, value, units.get(name, "1")) for name, value in held.items()}
        firsts = [(name, float(one.flat[0]) if one.size else 0.0) for name, one in columns.items()]
        point, remarks = self._native.held_point(firsts)
        say([(0, text) for text in remarks], 5)
        try:
            shape = numpy.broadcast_shapes(*(one.shape for one in columns.values()))
        except ValueError:
            shapes = ", ".join(f"{name} {one.shape}" for name, one in columns.items())
            raise _errors.wrong_use(f"the arrays are of different shapes: {shapes}",
                                    "give one shape, or a single number for an axis that does not vary",
                                    "shape") from None
        numbers = [columns.get(name, numpy.array(point[k])) for k, (name, _, _, _) in enumerate(axes)]
        # One number stands for all points by itself.
        return [(one if one.size == 1 else numpy.broadcast_to(one, shape)).reshape(-1) for one in numbers], shape

    def _look(self, points, held, how):
        """What `how` finds at the points, and the shape of these; says whether some lie outside."""
        columns, shape = self._points(points, held)
        *found, outside = how(columns)
        if outside:
            say([(0, self._native.outside_remark(columns))], 4)
        return found, shape

    def _slopes(self, slope, shape):
        return {axis[0]: _shaped(slope[:, k], shape) for k, axis in enumerate(self._native.axes)}

    def __call__(self, points=None, **held):
        (value, _), shape = self._look(points, held, lambda columns: self._native.values(columns, False))
        return _shaped(value, shape)

    def slopes(self, points=None, **held):
        """{axis: d value / d axis}, SI."""
        (_, slope), shape = self._look(points, held, lambda columns: self._native.values(columns, True))
        return self._slopes(slope, shape)

    def at(self, points=None, **held):
        """Value, standard deviation, slopes, and whether each point lies outside or has no data around: Values."""
        (value, sigma, slope, outside, no_data), shape = self._look(points, held, self._native.at)
        return Values(_shaped(value, shape), _shaped(sigma, shape), self._slopes(slope, shape), _shaped(outside, shape),
                      _shaped(no_data, shape))

    def __repr__(self):
        axes = ", ".join(f"{name} {lower:g} to {upper:g} {unit}" for name, unit, lower, upper in self._native.axes)
        return f"<Table {self.quantity} [{self.unit}] against {axes}; {self.kind}>"


def _numbers(value, unit):
    """SI numbers of a number, a text with a unit, or arrays and lists of them."""
    if isinstance(value, str):
        return numpy.array(_underbody.parse_in(value, unit))
    if isinstance(value, (list, tuple)):
        return numpy.array([_numbers(one, unit) for one in value], dtype=float)
    return numpy.asarray(value, dtype=float)


def _column(name, value, unit):
    """The same for an axis, which a mistake is told with."""
    try:
        return _numbers(value, unit)
    except _errors.Error as error:
        raise _errors.wrong_use(f"{name}: {error.problem}", error.hint, error.kind) from None
    except (TypeError, ValueError):
        raise _errors.wrong_use(f"{name}: {value!r} is no number, text with a unit or array of numbers", kind="parse") \
            from None


class TableCommand(Command):
    """`table(path)` fits a force table and gives a Table; its sub-commands are those of the command line."""

    def __call__(self, *values, **options):
        bound = said(self.__qualname__, self.__signature__, values, options)
        return self._fit(*bound.args, **bound.kwargs)

    def _fit(self, path, *, quantity=None, where=None, axes=None, kind=None, range=None, progress=None):
        given = {"table": path, "quantity": quantity, "where": where, "axes": axes, "kind": kind, "range": range}
        try:
            words = {name: text_of(value) for name, value in given.items() if value is not None}
        except TypeError as wrong:
            raise _errors.wrong_use(str(wrong)) from None
        native, remarks = _underbody.fit(words, progress)
        say(remarks, 4)
        return Table(native, words)

    def _signature(self):
        return inspect.signature(self._fit)


class _Bound:
    """A file or folder, and the commands that take it first."""

    def __init__(self, path):
        self.path = _path(path)
        vars(self).update(self._commands_of(self.path))

    @classmethod
    def _commands_of(cls, path):
        """Those commands, by name."""
        found = {}
        for names in cls._commands():
            tree = find(*names)
            first = python_name(tree["positionals"][0]["name"])
            found[python_name(names[-1])] = Command(tree, list(names), {first: path})
        return found

    def __underbody_path__(self):
        return self.path

    def __repr__(self):
        return f"<{type(self).__name__} {self.path}>"


class Model(_Bound):
    """A model (model.toml), read and checked. Its commands: simulate, predict, region, linear, learn, estimate, control
    and discover, and `table()` of the forces as it simulates them."""

    @staticmethod
    def _commands():
        return [(name,) for name in
                ("simulate", "predict", "region", "linear", "learn", "estimate", "control", "discover")]

    def __init__(self, path):
        super().__init__(path)
        native = _underbody.read_model(self.path)
        self.quantities, self.jets, self.effects = native

    def table(self, quantity=None, **options):
        """The forces of the model as a Table; options as those of `table`."""
        from . import table
        return table(self.path, quantity=quantity, **options)


class Study(_Bound):
    """A study's folder; its commands are those of `underbody study`."""

    @staticmethod
    def _commands():
        return [*(("study", tree["name"]) for tree in find("study")["commands"] if tree["positionals"]), ("sweep",)]


class StudyCommand(Command):
    """`study(folder)` gives a Study; its sub-commands are those of the command line."""

    def __call__(self, *values, **options):
        return Study(*said(self.__qualname__, self.__signature__, values, options).args)

    def _signature(self):
        return inspect.signature(lambda folder: None)
