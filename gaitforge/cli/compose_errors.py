"""What Hydra, OmegaConf and YAML say about a wrong command line or config file, as `InputError`."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable

from gaitforge.errors import InputError, Problem

COMMAND_LINE = "command line"
TYPES = {"Float": "a number", "Integer": "a whole number", "Boolean": "true or false"}


def is_input_error(error: BaseException) -> bool:
    """Is it the user's command line, config file or folder that `error` speaks of?"""
    import yaml
    from hydra.errors import HydraException
    from omegaconf.errors import OmegaConfBaseException

    return isinstance(error, HydraException | OmegaConfBaseException | yaml.YAMLError | OSError)


def input_error(error: BaseException) -> InputError:
    """The same error as file, key, found and expected."""
    import yaml
    from hydra.errors import MissingConfigException
    from omegaconf.errors import OmegaConfBaseException

    if isinstance(error, MissingConfigException):
        return InputError(_missing_option(error.missing_cfg_file or "", error.options or (), str(error)))
    if isinstance(error, yaml.MarkedYAMLError) and error.problem_mark is not None:
        where = f"line {error.problem_mark.line + 1}"
        return InputError(Problem(error.problem_mark.name, where, error.problem or "no YAML", "valid YAML"))
    if isinstance(error, OSError):
        found = error.strerror or str(error)
        return InputError(Problem(str(error.filename or COMMAND_LINE), "", found, "a file or folder that can be used"))
    for cause in (error, error.__cause__, error.__context__):
        if isinstance(cause, OmegaConfBaseException):
            return InputError(_wrong_key(cause, _source(str(error))))
    return InputError(Problem(_source(str(error)), "", _first_line(error), "what gaitforge --help shows"))


def _missing_option(path: str, options: Iterable[str], message: str) -> Problem:
    group, _, name = path.rpartition("/")
    return Problem(COMMAND_LINE, group, repr(name), _one_of(name, options) if options else _first_line(message))


def _wrong_key(error: BaseException, where: str) -> Problem:
    key = str(getattr(error, "full_key", None) or getattr(error, "key", "") or "")
    name, message = key.rpartition(".")[2], _first_line(error)
    if "is not in struct" in message or re.search(r"Key .* not in '", message):
        return Problem(where, key, "an unknown key", _one_of(name, _known_keys(error)))
    conversion = re.search(r"Value '(.*)' of type .* could not be converted to (\w+)", message)
    if conversion:
        found, wanted = conversion.groups()
        return Problem(where, key, repr(found), TYPES.get(wanted, wanted))
    if "PhaseConf" in message and re.search(r"\[\d+\]$", key):
        return Problem(where, key, "no such entry", "an entry that the list has")
    return Problem(where, key, message, "a value of the type in the config")


def _known_keys(error: BaseException) -> list[str]:
    """Keys of the place where an unknown one was found: of the config node, or of its schema."""
    from dataclasses import fields, is_dataclass

    from omegaconf import DictConfig

    parent, schema = getattr(error, "parent_node", None), getattr(error, "object_type", None)
    if is_dataclass(schema):
        return [f.name for f in fields(schema)]
    return [str(k) for k in parent] if isinstance(parent, DictConfig) else []


def _one_of(name: str, options: Iterable[str]) -> str:
    known = sorted(options)
    near = difflib.get_close_matches(name, known, n=1)
    listed = "one of " + ", ".join(known) if known else "no key here"
    return f"{near[0]} ({listed})" if near and len(known) > 1 else listed


def _source(message: str) -> str:
    named = re.search(r"In '([^']+)'", message)
    return f"{named.group(1)}.yaml" if named and named.group(1) not in ("config", "schema") else COMMAND_LINE


def _first_line(error: object) -> str:
    line = next((line.strip() for line in str(error).splitlines() if line.strip()), type(error).__name__)
    # A KeyError puts quotes around its message.
    return line.strip("\"'") if line.startswith(('"', "'")) else line
