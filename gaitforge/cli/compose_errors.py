"""What Hydra and OmegaConf say about a wrong command line or config file, as `InputError`."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable

from omegaconf import DictConfig

from gaitforge.errors import InputError, Problem


def input_error(error: BaseException, where: str = "command line") -> InputError:
    """The same error as file, key, found and expected; `where` names the source when the error does not."""
    from hydra.errors import MissingConfigException
    from omegaconf.errors import OmegaConfBaseException

    cause = error.__cause__ if isinstance(error.__cause__, OmegaConfBaseException) else error
    if isinstance(error, MissingConfigException):
        return InputError(_missing_option(error.missing_cfg_file or "", error.options or (), str(error), where))
    if isinstance(cause, OmegaConfBaseException):
        return InputError(_wrong_key(cause, _source(str(error), where)))
    if isinstance(error, OSError):
        found = error.strerror or str(error)
        return InputError(Problem(str(error.filename or where), "", found, "a file or folder that can be used"))
    return InputError(Problem(where, "", _first_line(error), "what gaitforge --help shows"))


def _missing_option(path: str, options: Iterable[str], message: str, where: str) -> Problem:
    group, _, name = path.rpartition("/")
    return Problem(where, group, repr(name), _one_of(name, options) if options else _first_line(message))


def _wrong_key(error: BaseException, where: str) -> Problem:
    key = str(getattr(error, "full_key", None) or getattr(error, "key", "") or "")
    parent = getattr(error, "parent_node", None)
    name = key.rpartition(".")[2]
    message = _first_line(error)
    # KeyError puts quotes around its message.
    message = message.strip("\"'") if message.startswith(('"', "'")) else message
    unknown = "is not in struct" in message or "not in '" in message
    if unknown and isinstance(parent, DictConfig):
        return Problem(where, key, "an unknown key", _one_of(name, (str(k) for k in parent)))
    return Problem(where, key, message, "a value of the type in the config")


def _one_of(name: str, options: Iterable[str]) -> str:
    known = sorted(options)
    near = difflib.get_close_matches(name, known, n=1)
    listed = "one of " + ", ".join(known) if known else "no key here"
    return f"{near[0]} ({listed})" if near and len(known) > 1 else listed


def _source(message: str, where: str) -> str:
    named = re.search(r"In '([^']+)'", message)
    return f"{named.group(1)}.yaml" if named and named.group(1) not in ("config", "schema") else where


def _first_line(error: object) -> str:
    return next((line.strip() for line in str(error).splitlines() if line.strip()), type(error).__name__)
