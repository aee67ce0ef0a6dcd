"""Names of quantities and of their rates: ``theta_1``, ``theta_1_dot``, ``theta_1_ddot``."""

import re

#: Endings of the names of a quantity and of its rates.
RATES = ("", "_dot", "_ddot", "_dddot")


def stem(name: str) -> str:
    """The name of a quantity without the ending of its rate."""
    return re.sub(r"_d{1,3}ot\Z", "", name)


def order(name: str) -> int:
    """The order of a rate: 0 for a quantity, 1 for its rate."""
    return RATES.index(name.removeprefix(stem(name)))
