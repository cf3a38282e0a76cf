"""Former names of arguments and attributes, which still work, with a DeprecationWarning."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import Any, ClassVar, TypeVar

C = TypeVar("C", bound=Callable[..., Any])


def former_arguments(**names: str) -> Callable[[C], C]:
    """A decorator: the function also takes keywords by their former names.

    A former name goes before the present one: `dataclasses.replace` gives both.

    Args:
        names: the present name of each former one.
    """

    def decorate(function: C) -> C:
        @functools.wraps(function)
        def call(*positional: Any, **keywords: Any) -> Any:
            for former in names.keys() & keywords.keys():
                _warn(former, names[former])
                keywords[names[former]] = keywords.pop(former)
            return function(*positional, **keywords)

        return call  # type: ignore[return-value]

    return decorate


class FormerAttributes:
    """A base class: attributes can also be read by their former names, in `_FORMER`."""

    _FORMER: ClassVar[dict[str, str]] = {}

    def __getattr__(self, name: str) -> Any:
        present = type(self)._FORMER.get(name)
        if present is None:
            return object.__getattribute__(self, name)  # raises the error as it was
        _warn(name, present)
        return getattr(self, present)


def _warn(former: str, present: str) -> None:
    warnings.warn(f"'{former}' is now named '{present}'", DeprecationWarning, stacklevel=3)
