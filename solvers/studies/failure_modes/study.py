"""The contract of a study, and the studies of this package."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, ClassVar, Generic, Self, TypeVar

from matplotlib.figure import Figure

from solvers.equations.module import GeneratedModule
from solvers.studies import failure_modes

Results = TypeVar("Results")
#: Returns the generated module of a system.
Load = Callable[[str], GeneratedModule]


class Study(ABC, Generic[Results]):
    """A study of one failure mode, in a file of its own; its attributes are its settings."""

    #: Settings with which the study takes a few seconds only.
    SMALL: ClassVar[tuple[Any, ...]] = ()

    @property
    def name(self) -> str:
        """The name of the study's file."""
        return type(self).__module__.rpartition(".")[2]

    @classmethod
    def small(cls) -> Self:
        """The study with the settings of `SMALL`."""
        return cls(*cls.SMALL)

    @abstractmethod
    def run(self, load: Load) -> Results:
        """Results of the study, for the systems that `load` returns."""

    @abstractmethod
    def summary(self, results: Results) -> Iterator[str]:
        """Results as lines of text."""

    @abstractmethod
    def plot(self, results: Results) -> Figure:
        """Results as a figure."""


def studies(*, small: bool = False) -> list[Study[Any]]:
    """All studies in alphabetical order, with full or with small settings."""
    for module in iter_modules(failure_modes.__path__):
        import_module(f"{failure_modes.__name__}.{module.name}")
    result = [kind.small() if small else kind() for kind in Study.__subclasses__()]
    return sorted(result, key=lambda study: study.name)
