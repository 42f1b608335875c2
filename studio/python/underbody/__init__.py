"""Underbody: CFD post-processing and ground-effect design, from Python.

    import underbody
    field = underbody.read("body.csv")
    underbody.loads(field, symmetry="y").lift_force            # N
    lift = underbody.table("lift.csv")
    lift(gap="5 mm"), lift.at(gap=[0.004, 0.005]).sigma
    underbody.simulate("model.toml", start={"gap": "20 mm"}, duration=30).gap
    underbody.study("cases/evie").run()

Every command of the command line is a function here, with its options as arguments (`--max-error` is `max_error`,
`--from` is `start`, `--for` is `duration`), the same figures and the same errors. Numbers are SI; a text may carry a unit
("5 mm"). Conditions and starts are dicts ({"gap": "5 mm"}), ranges pairs ({"gap": (0, "1 m")}), files pathlib or str.
"""
from . import _underbody
from ._commands import all_commands as _all_commands, checked as _checked, run
from ._errors import CheckFailed, Cancelled, Defect, Error, InputError, SystemError, UnderbodyWarning, UsageError
from ._objects import Field, Model, Study, StudyCommand as _StudyCommand, Table, TableCommand as _TableCommand, Values, read
from ._results import Result

__version__ = _underbody.version

globals().update(_all_commands())
table = _TableCommand(table._tree, ["table"])  # noqa: F821
study = _StudyCommand(study._tree, ["study"])  # noqa: F821


@_checked
def model(path):
    """Reads and checks a model (model.toml): a Model."""
    return Model(path)


__all__ = [name for name in dir() if not name.startswith("_") and name != "SystemError"]
