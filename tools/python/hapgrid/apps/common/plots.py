"""The house style of hapgrid's plots."""

from types import ModuleType

from hapgrid import style as house

from .files import Failed


def style() -> ModuleType:
    """The module hapgrid.style. Errors: Failed, where matplotlib is not there."""
    try:
        house.matplotlib()
    except ImportError as why:
        raise Failed(str(why)) from None
    return house
