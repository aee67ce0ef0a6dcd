"""Statuses of motions."""

from solvers.integration.problem.status import Status

ENDS = (status.name.lower().replace("_", " ") for status in Status)
#: Status of a motion, by its number in ``status.npy``.
STATUSES = ("not done yet", *ENDS, "proved", "no such energy", "no configuration")
CODES = {status: code for code, status in enumerate(Status, 1)}
#: Those of motions that have values in the maps.
GOOD = ("finished", "event", "proved")
PROVED, NO_SUCH_ENERGY = STATUSES.index("proved"), STATUSES.index("no such energy")
#: That of motions whose start no configuration satisfies.
NO_CONFIGURATION = STATUSES.index("no configuration")
