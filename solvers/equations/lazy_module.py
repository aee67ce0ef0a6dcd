"""Generated modules whose functions are generated when they are first used."""

from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

#: Attributes that depend on the content of all functions.
OF_ALL = ("DIGEST", "VARIABLES", "TIMED", "CALLS_FUNCTIONS", "OPERATIONS", "__file__")


class LazyModule(ModuleType):
    """A generated module that takes each function from a part, when it is first used.

    ``part(names)`` returns a module of the same system with the functions of these names, or with
    some if there are no names; its table ``FUNCTIONS`` names those of all parts. Attributes that
    depend on all functions, such as ``OPERATIONS`` and ``__file__``, are those of a part with all,
    which is generated for them.
    """

    SYSTEM = ""
    FUNCTIONS: tuple[str, ...] = ()

    def __init__(self, part: Callable[[tuple[str, ...]], Any]) -> None:
        first = part(())
        super().__init__(first.__name__, first.__doc__)
        self._part = part
        self._adopt(first)

    def part(self, names: Sequence[str]) -> Any:
        """A module with the functions of these names."""
        return self._part(tuple(name for name in self.FUNCTIONS if name in names))

    def __getattr__(self, name: str) -> Any:
        function = name.removesuffix("_many")
        if function in self.FUNCTIONS:
            self._adopt(self.part([function]))
            return vars(self)[name]
        if name in OF_ALL:
            return getattr(self.part(self.FUNCTIONS), name)
        raise AttributeError(f"the module of {self.SYSTEM} has no attribute {name!r}")

    def _adopt(self, part: Any) -> None:
        """Take the tables and functions of a part."""
        public = (name for name in vars(part) if not name.startswith("_") and name not in OF_ALL)
        vars(self).update({name: getattr(part, name) for name in public})

    def __dir__(self) -> list[str]:
        functions = (f"{name}{kind}" for name in self.FUNCTIONS for kind in ("", "_many"))
        return sorted({*super().__dir__(), *OF_ALL, *functions})

    def __repr__(self) -> str:
        return f"<module {self.__name__!r}, generated as used>"
