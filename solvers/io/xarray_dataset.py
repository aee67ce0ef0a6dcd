"""Datasets of xarray, an optional package."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any


def dataset(
    variables: Mapping[str, Any], coordinates: Mapping[str, Any], attributes: Mapping[str, Any]
) -> Any:
    """An ``xarray.Dataset``; `ImportError` with the name of the extra without xarray."""
    try:
        xarray = import_module("xarray")
    except ImportError as error:
        raise ImportError("xarray is not installed: pip install 'holonomic[xarray]'") from error
    return xarray.Dataset(variables, coordinates, attributes)
