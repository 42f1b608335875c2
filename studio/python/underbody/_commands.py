"""The commands of the command line as functions: the same options, the same figures, the same errors."""
import functools
import inspect
import json
import keyword
import logging
import os
import shutil
import warnings

from . import _errors, _underbody
from ._results import Result
from ._words import option_words, python_name, words_of

log = logging.getLogger("underbody")

COMMON = {"threads": "threads to use (default: all cores)",
          "force": "replace files that underbody did not write, or that were changed since",
          "progress": "called with the fraction done (0 to 1) and what is being done; what it raises ends the work"}
_HIDDEN = {"--help", "--version", "--json", "--quiet", "--verbose", "--threads", "--force"}


def _program():
    """`underbody`, which jobs of a cluster call later: beside a build, or installed."""
    beside = os.path.join(os.path.dirname(__file__), "..", "..", "bin", "underbody")
    return os.path.abspath(beside) if os.access(beside, os.X_OK) else shutil.which("underbody") or ""


def say(remarks, depth):
    """Warnings as Python's warnings, the rest to the log 'underbody'."""
    for level, text in remarks:
        if level == 0:
            warnings.warn(text, _errors.UnderbodyWarning, stacklevel=depth)
        else:
            log.log(logging.INFO if level == 1 else logging.DEBUG, "%s", text)


def run(words, *, fields=None, fitted=None, progress=None, threads=None, force=False, depth=3):
    """Runs a command given by its words, as on the command line without `underbody`."""
    words = [*words, *([f"--threads={threads}"] if threads is not None else []), *(["--force"] if force else [])]
    code, document, remarks, tables, surface, error_class, error = _underbody.run(
        words, fields or {}, fitted or {}, _program(), progress)
    say(remarks, depth)
    data = json.loads(document) if document else {}
    if error_class:
        parts = data["error"]
        raise getattr(_errors, error_class)(
            error, kind=parts["kind"], problem=parts["message"], hint=parts["hint"], file=parts.get("file", ""),
            line=parts.get("line"), column=parts.get("column"), byte=parts.get("byte"))
    result = Result(data if isinstance(data, dict) else {"items": data}, tables, remarks, surface)
    if code == 4:
        said = [text for level, text in remarks if level < 2]
        raise _errors.CheckFailed(said[-1] if said else "a check failed", result)
    return result


def said(name, signature, values, options):
    """The arguments bound to their names. What is wrong with them is an error of use that names the nearest one."""
    try:
        return signature.bind(*values, **options)
    except TypeError as wrong:
        known = list(signature.parameters)
        for one in options:
            if one not in known:
                raise _errors.wrong_use(f"'{name}' has no argument '{one}'",
                                        _underbody.did_you_mean(one, known)) from None
        raise _errors.wrong_use(f"{name}: {wrong}") from None


def checked(function, name=None):
    """The same function, whose wrong arguments are errors of use as those of a command are."""
    signature = inspect.signature(function)

    @functools.wraps(function)
    def call(*values, **options):
        bound = said(name or function.__name__, signature, values, options)
        return function(*bound.args, **bound.kwargs)

    return call


class Command:
    """A command: call it, or its sub-commands by their names. See `help()` of each."""

    def __init__(self, tree, path, given=None, objects=None):
        self._tree = tree
        self._path = path
        self._given = given or {}  # arguments that an object gives
        self._objects = objects or {}
        self.__name__ = python_name(tree["name"])
        self.__qualname__ = ".".join(path)
        self.__doc__ = self._help()
        self.__signature__ = self._signature()
        # What is missing, the command says.
        self._lenient = self.__signature__.replace(parameters=[
            one if one.kind is one.VAR_POSITIONAL else one.replace(default=None)
            for one in self.__signature__.parameters.values()])
        for command in tree["commands"]:
            setattr(self, python_name(command["name"]), Command(command, [*path, command["name"]], given, objects))

    def _options(self):
        return [one for one in self._tree["options"] if one["names"][0] not in _HIDDEN]

    def _signature(self):
        kinds = inspect.Parameter
        parameters, needed = [], True
        for one in self._tree["positionals"]:
            name = python_name(one["name"])
            if name in self._given:
                continue
            if one["several"]:
                parameters.append(kinds(name, kinds.VAR_POSITIONAL))
                needed = False
            else:
                needed = needed and one["required"]
                parameters.append(kinds(name, kinds.POSITIONAL_OR_KEYWORD,
                                        default=kinds.empty if needed else None))
        for one in self._options():
            name = python_name(one["names"][0])
            default = kinds.empty if one["required"] else (False if one["flag"] else None)
            parameters.append(kinds(name, kinds.KEYWORD_ONLY, default=default))
        for name in COMMON:
            parameters.append(kinds(name, kinds.KEYWORD_ONLY, default=False if name == "force" else None))
        return inspect.Signature(parameters, return_annotation=Result)

    def _help(self):
        lines = [self._tree["description"] or self._tree["name"], ""]
        for one in self._tree["positionals"]:
            lines.append(f"{python_name(one['name'])}: {one['description']}")
        for one in self._options():
            lines.append(f"{python_name(one['names'][0])}: {one['description']}")
        lines += [f"{name}: {text}" for name, text in COMMON.items()]
        return "\n".join([*lines, "", "On the command line:", self._tree["examples"]])

    def __call__(self, *values, **options):
        if values and not options and self._tree["needs_command"]:  # which names the nearest command
            return run([*self._path, *map(str, values)], depth=4, **self._objects)
        bound = said(self.__qualname__, self._lenient, values, options)
        given = {**self._given, **bound.arguments}
        options_words, fields = [], {}
        common = {name: given.pop(name) for name in COMMON if name in given}
        try:
            for one in self._options():
                value = given.get(python_name(one["names"][0]))
                if value is not None and value is not False:
                    options_words += option_words(one, value)
            places, missing = [], ""
            for one in self._tree["positionals"]:
                value = given.get(python_name(one["name"]))
                if value is None:
                    missing = missing or (one["name"] if one["required"] else "")
                elif missing:  # what stands behind would be taken for it
                    raise _errors.wrong_use(f"{missing} is required")
                else:
                    fields.update(_fields_of(value if one["several"] else [value]))
                    places += words_of(value, one["several"])
        except TypeError as wrong:
            raise _errors.wrong_use(str(wrong)) from None
        # Options that take several words would take the places too, were these behind them.
        words = [*self._path, *places, *options_words]
        if any(word.startswith("-") for word in places):
            words = [*self._path, *options_words, "--", *places]
        return run(words, fields=fields, depth=4, **self._objects, **common)

    def __repr__(self):
        return f"<command {self.__qualname__}{self.__signature__}>"


def _fields_of(values):
    return {one.__underbody_path__(): one._native for one in values if hasattr(one, "_native_field")}


TREE = json.loads(_underbody.tree())


def find(*names):
    """The part of the tree of a command."""
    tree = TREE
    for name in names:
        tree = next(one for one in tree["commands"] if one["name"] == name)
    return tree


def all_commands():
    """{name in Python: Command}"""
    import builtins
    found = {}
    for tree in TREE["commands"]:
        name = python_name(tree["name"])
        name += "_" if hasattr(builtins, name) and not keyword.iskeyword(tree["name"]) else ""
        found[name] = Command(tree, [tree["name"]])
    return found
