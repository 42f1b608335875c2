"""Results: the JSON of the command line with attributes, numbers as NumPy arrays, tables as columns."""
import collections.abc
import difflib

import numpy


def _is_number(value):
    return value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))


def _array(values):
    """A NumPy array of a list of numbers, or of lists of equal length of them; else None."""
    if not values:
        return None
    if all(_is_number(one) for one in values):
        if any(one is None for one in values):  # JSON's word for NaN
            if all(one is None for one in values):
                return None
            return numpy.array([numpy.nan if one is None else one for one in values], dtype=float)
        return numpy.array(values)
    if all(isinstance(one, list) for one in values):
        rows = [_array(one) for one in values]
        if all(row is not None for row in rows) and len({row.shape for row in rows}) == 1:
            return numpy.array(rows)
    return None


def wrapped(value):
    """A dict as Result, a list of numbers as array, other lists item by item."""
    if isinstance(value, dict):
        return Result(value)
    if isinstance(value, list):
        array = _array(value)
        return array if array is not None else [wrapped(one) for one in value]
    return value


class Result(collections.abc.Mapping):
    """What a command found, SI. `result.lift_force` and `result["lift_force"]` are the same; keys are those of the
    command's JSON (docs/conventions.md, section 7).

    columns: the table that goes with it ({name: array}: the motion of `simulate`, the map of `region`), also as
    attributes where the JSON has no such key; remarks: what was said on the way, [(level, text)];
    surface: of `body`, its triangles.
    """

    def __init__(self, data, tables=None, remarks=(), surface=None):
        self._data = data
        self._tables = tables or {}
        self.remarks = list(remarks)
        self.surface = surface

    @property
    def columns(self):
        """The table that goes with it, {name: array or list}: the motion of `simulate`, the map of `region`."""
        return next(iter(self._tables.values()), {})

    def to_dict(self):
        """The JSON as plain dicts and lists."""
        return self._data

    def __getitem__(self, key):
        if key not in self._data:
            raise KeyError(self._no_such(key, [*self._data]))
        return wrapped(self._data[key])

    def __iter__(self):
        return iter(self._data)

    def __len__(self):
        return len(self._data)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._data:
            return wrapped(self._data[name])
        if name in self.columns:
            return self.columns[name]
        # With no object to search, Python adds no suggestion of its own to this one.
        raise AttributeError(self._no_such(name, [*self._data, *self.columns]), name=name, obj=None)

    @staticmethod
    def _no_such(name, known):
        near = difflib.get_close_matches(str(name), known, 1)
        return f"there is no '{name}' in this result; " + (
            f"did you mean '{near[0]}'?" if near else "known: " + ", ".join(known))

    def __dir__(self):
        return [*super().__dir__(), *self._data, *self.columns]

    def __eq__(self, other):
        return self._data == (other._data if isinstance(other, Result) else other)

    def __repr__(self):
        def brief(value):
            if isinstance(value, dict):
                return "{...}"
            if isinstance(value, list):
                return f"[{len(value)}]"
            return repr(value)

        parts = [f"{key}={brief(value)}" for key, value in self._data.items()]
        parts += [f"{name}[{len(column)}]" for name, column in self.columns.items() if name not in self._data]
        return f"<Result {', '.join(parts)}>"
