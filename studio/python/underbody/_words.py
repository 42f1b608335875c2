"""Python values as the words of a command line: 0.005, "5 mm", {"gap": "5 mm"}, {"gap": (0, 1)}, pathlib.Path."""
import keyword
import numbers
import os

# Options whose names are keywords of Python, and read better so.
RENAMED = {"from": "start", "for": "duration"}


def python_name(option):
    """'--max-error' -> max_error, '--from' -> start, '--with' -> with_"""
    name = option.lstrip("-").replace("-", "_")
    name = RENAMED.get(name, name)
    return name + "_" if keyword.iskeyword(name) else name


def text_of(value):
    """One value as one word. A number is SI, digits enough to read back to the same double."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        raise TypeError(f"{value!r} is neither a number nor a text")
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, dict):
        return ",".join(f"{name}={_range_or_value(one)}" for name, one in value.items())
    if hasattr(value, "tolist"):  # NumPy
        return text_of(value.tolist())
    if isinstance(value, (list, tuple)):
        return ",".join(text_of(one) for one in value)
    if hasattr(value, "__underbody_path__"):
        return value.__underbody_path__()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{value!r} ({type(value).__name__}) is neither a number, a text, a path, a list nor a dict")


def _range_or_value(value):
    if isinstance(value, (list, tuple)):
        if len(value) != 2:
            raise TypeError(f"{value!r}: a range has two ends")
        return ":".join(text_of(one) for one in value)
    return text_of(value)


def words_of(value, several):
    """The words of an option or argument: one, or one for each item where it may be given several times."""
    if several and isinstance(value, (list, tuple)):
        return [text_of(one) for one in value]
    return [text_of(value)]


def option_words(option, value):
    """['--name=value', ...] of one option of the tree."""
    name = option["names"][0]
    if option["flag"]:
        if not isinstance(value, bool):
            raise TypeError(f"{python_name(name)} is True or False, not {value!r}")
        return [name] if value else []
    if option["several"] and isinstance(value, dict):
        return [f"{name}={key}={_range_or_value(one)}" for key, one in value.items()]
    return [f"{name}={word}" for word in words_of(value, option["several"])]
