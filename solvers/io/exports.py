"""Results for other programs: values for JSON, data frames of pandas, datasets of xarray."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from math import isfinite
from typing import Any

import numpy as np


def jsonable(value: Any) -> Any:
    """`value` as dicts, lists, strings and numbers; NaN and infinity become None."""
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: jsonable(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): jsonable(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | list | tuple):
        return [jsonable(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not isfinite(value) else value


def dataset(
    variables: Mapping[str, Any], coordinates: Mapping[str, Any], attributes: Mapping[str, Any]
) -> Any:
    """An ``xarray.Dataset``; `ImportError` with the name of the extra without xarray."""
    try:
        xarray = import_module("xarray")
    except ImportError as error:
        raise ImportError("xarray is not installed: pip install 'holonomic[xarray]'") from error
    return xarray.Dataset(variables, coordinates, attributes)


def data_frame(columns: Mapping[str, Any]) -> Any:
    """A ``pandas.DataFrame`` of these columns; without pandas, a dict of them."""
    try:
        pandas = import_module("pandas")
    except ImportError:
        return dict(columns)
    return pandas.DataFrame(dict(columns))
