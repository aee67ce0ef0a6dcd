"""Results that one worker computes and all workers use."""

import fcntl
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Shared:
    """A folder of results; a lock for each lets other workers wait."""

    folder: Path

    def __call__(self, name: str, compute: Callable[[], Any]) -> Any:
        """The result of this name, computed by the first who asks for it."""
        path = self.folder / f"{name}.pickle"
        with open(self.folder / f"{name}.lock", "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not path.exists():
                path.write_bytes(pickle.dumps(compute()))
            return pickle.loads(path.read_bytes())
