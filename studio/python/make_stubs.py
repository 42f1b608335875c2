"""make_stubs.py OUT: type stubs of the package, its commands from the option tree of the program itself."""
import inspect
import pathlib
import sys

HEAD = '''# Made by make_stubs.py from the commands that there are.
import os
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

import numpy
import numpy.typing

Text = Union[str, "os.PathLike[str]"]
Number = Union[float, str]
Named = Union[str, Mapping[str, Any]]
Value = Union[str, float, "os.PathLike[str]", Mapping[str, Any], Sequence[Any], Field, Table, Model, Study]
Progress = Optional[Callable[[float, str], Any]]
Array = numpy.typing.NDArray[Any]

__version__: str

class Error(Exception):
    kind: str
    problem: str
    hint: str
    file: str
    line: Optional[int]
    column: Optional[int]
    byte: Optional[int]

class InputError(Error, ValueError): ...
class UsageError(Error, ValueError): ...
class SystemError(Error): ...
class Cancelled(Error): ...
class Defect(Error, RuntimeError): ...
class CheckFailed(Error):
    result: Result
class UnderbodyWarning(UserWarning): ...

class Result(Mapping[str, Any]):
    remarks: List[Tuple[int, str]]
    surface: Optional[Surface]
    @property
    def columns(self) -> Dict[str, Any]: ...
    def to_dict(self) -> Dict[str, Any]: ...
    def __getattr__(self, name: str) -> Any: ...
    def __getitem__(self, key: str) -> Any: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...

class ArrayInfo:
    name: str
    unit: str
    original_name: str
    original_unit: str
    on: str
    components: int

class Zone:
    name: str
    id: int
    kind: str
    original_kind: str
    arrays: List[ArrayInfo]
    points: Array
    offsets: Optional[Array]
    connectivity: Optional[Array]
    cell_types: Optional[Array]
    vtk: Any
    def __getitem__(self, name: str) -> Array: ...
    def __contains__(self, name: str) -> bool: ...

class Surface:
    points: Array
    triangles: Array
    patch: Array
    patch_names: List[str]

class Field:
    @property
    def files(self) -> List[str]: ...
    @property
    def format(self) -> str: ...
    @property
    def writer(self) -> str: ...
    @property
    def dimension(self) -> int: ...
    @property
    def density(self) -> Optional[float]: ...
    @property
    def metadata(self) -> Dict[str, str]: ...
    @property
    def zones(self) -> List[Zone]: ...
    @property
    def problems(self) -> List[str]: ...
    @property
    def vtk(self) -> Any: ...
    def __getitem__(self, name: str) -> Zone: ...
    def __iter__(self) -> Iterator[Zone]: ...
    def __len__(self) -> int: ...
    def __contains__(self, name: str) -> bool: ...

class Values:
    value: Any
    sigma: Any
    slope: Dict[str, Any]
    outside: Any
    no_data: Any

class Table:
    @property
    def quantity(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def points(self) -> Dict[str, Any]: ...
    @property
    def axes(self) -> Dict[str, Tuple[str, float, float]]: ...
    def __call__(self, points: Any = ..., **held: Any) -> Any: ...
    def slopes(self, points: Any = ..., **held: Any) -> Dict[str, Any]: ...
    def at(self, points: Any = ..., **held: Any) -> Values: ...
@COMMANDS Table@
class Model:
    path: str
    quantities: List[str]
    jets: List[str]
    effects: List[str]
    def __init__(self, path: Text) -> None: ...
    def table(self, quantity: Optional[str] = ..., **options: Any) -> Table: ...
@COMMANDS Model@
class Study:
    path: str
    def __init__(self, path: Text) -> None: ...
@COMMANDS Study@
def read(path: Text, *, zones: Union[str, Sequence[str]] = ..., arrays: Union[str, Sequence[str]] = ...,
         length_unit: str = ..., unit: Optional[Mapping[str, str]] = ..., mesh: Text = ..., time: Number = ...,
         cgns_base: Union[str, int] = ..., surfaces_only: bool = ..., progress: Progress = ...) -> Field: ...
def model(path: Text) -> Model: ...
def run(words: Sequence[str], *, fields: Any = ..., fitted: Any = ..., progress: Progress = ...,
        threads: Optional[int] = ..., force: bool = ..., depth: int = ...) -> Result: ...
'''


def type_of(command, name):
    if name in ("force",):
        return "bool"
    if name == "threads":
        return "Optional[int]"
    if name == "progress":
        return "Progress"
    for option in command._options():
        if underbody._words.python_name(option["names"][0]) == name:
            if option["flag"]:
                return "bool"
            return "Value" if option["required"] else "Optional[Value]"
    return "Value"


def arguments(command):
    words, starred = ["self"], False
    for name, parameter in command.__signature__.parameters.items():
        if parameter.kind is inspect.Parameter.VAR_POSITIONAL:
            words.append(f"*{name}: Value")
            starred = True
            continue
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY and not starred:
            words.append("*")
            starred = True
        default = "" if parameter.default is inspect.Parameter.empty else " = ..."
        kind = type_of(command, name)
        if default and not kind.startswith("Optional") and kind == "Value":
            kind = "Optional[Value]"
        words.append(f"{name}: {kind}{default}")
    return ", ".join(words)


SPECIAL = {
    "table": "    def __call__(self, path: Text, *, quantity: Optional[str] = ..., where: Optional[Named] = ..., "
             "axes: Optional[Value] = ..., kind: Optional[str] = ..., range: Optional[Named] = ..., "
             "progress: Progress = ...) -> Table: ...\n",
    "study": "    def __call__(self, folder: Text) -> Study: ...\n",
}


def stub(name, command):
    text = f"class _{name}:\n"
    inner = [(key, one) for key, one in vars(command).items() if isinstance(one, underbody._commands.Command)]
    if name in SPECIAL:
        text += SPECIAL[name]
    elif not command._tree["needs_command"]:
        text += f"    def __call__({arguments(command)}) -> Result: ...\n"
    text += "".join(f"    def {key}({arguments(one)}) -> Result: ...\n" for key, one in inner)
    return text + f"{name}: _{name}\n"


def methods(commands):
    """Of an object that gives the first argument of these: {name: Command}."""
    return "".join(f"    def {name}({arguments(one)}) -> Result: ...\n" for name, one in sorted(commands.items()))


if __name__ == "__main__":
    sys.path.pop(0)  # this folder, whose package has no module yet
    import underbody
    commands = {name: value for name, value in vars(underbody).items()
                if isinstance(value, underbody._commands.Command)}
    head = HEAD
    for kind in ("Table", "Model", "Study"):
        head = head.replace(f"@COMMANDS {kind}@", methods(getattr(underbody, kind)._commands_of({"table": ""} if kind == "Table" else "")))
    pathlib.Path(sys.argv[1]).write_text(head + "".join(stub(*one) for one in sorted(commands.items())))
