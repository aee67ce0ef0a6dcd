"""Documents to hand out, in three formats, with exercises."""

from recording import Record

from derive import Derivation, load
from derive.handout.derivation_document import document
from derive.handout.exercises import with_exercises
from derive.handout.formats.notebook import notebook
from derive.handout.formats.page import page
from derive.handout.formats.tex import tex

SYSTEMS = "driven_pendulum", "chaplygin_sleigh", "coupled_pendulums"


def test_handouts_are_as_recorded(record: Record) -> None:
    documents = {name: document(Derivation(load(name))) for name in SYSTEMS}
    for kind in ("blank", "mistakes"):
        exercises = with_exercises(documents["driven_pendulum"], kind, 7)
        documents |= dict(zip((kind, f"{kind}, key"), exercises, strict=True))
    texts = {
        f"{name}.{suffix}": writer(one).replace("\\n", "\n")  # of JSON
        for name, one in documents.items()
        for suffix, writer in (("html", page), ("tex", tex), ("ipynb", notebook))
    }
    record.check_digests(texts)
