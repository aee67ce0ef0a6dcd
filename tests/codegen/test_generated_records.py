"""Generated files of systems that do not ship."""

import constrained_systems as constrained
import velocity_constraints as mechanisms
from cart_pole import cart_pole
from linked_block import block
from recording import Record

from derive import Derivation, reduced
from derive.codegen.module_files import texts


def test_generated_files_are_as_recorded(record: Record) -> None:
    systems = (
        block(), cart_pole, constrained.swing(), constrained.lifted(), constrained.sleigh(),
        constrained.pinned(), mechanisms.yoke(),
    )  # fmt: skip
    found: dict[str, str] = {}
    for system in systems:
        found |= texts(Derivation(reduced(system)))
    record.check_digests(found)
