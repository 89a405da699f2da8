"""A property computed when first asked for and kept, without a lock.

That of the standard library takes one in Python 3.11, for all objects of a class: a process forked while another thread
computes the property of any of them would wait for it without end. Here two threads may compute one value twice, which
is the same for values that never change.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, Self, TypeVar, overload

T = TypeVar("T")


class computed_once(Generic[T]):  # noqa: N801  it stands as property does
    """Decorates a method without arguments of a class whose objects have a ``__dict__``, frozen ones too."""

    def __init__(self, method: Callable[[Any], T]) -> None:
        self._method, self._name = method, method.__name__
        self.__doc__ = method.__doc__

    @overload
    def __get__(self, owned: None, owner: type) -> Self: ...
    @overload
    def __get__(self, owned: object, owner: type) -> T: ...

    def __get__(self, owned: object | None, owner: type) -> Self | T:
        """The value; from then on the object's own attribute stands before this."""
        if owned is None:
            return self
        return owned.__dict__.setdefault(self._name, self._method(owned))
